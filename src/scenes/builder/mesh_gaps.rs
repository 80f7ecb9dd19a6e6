//! Meshes whose faces look joined and are not, or stand twice.

use super::FreeMesh;
use super::surface_search::{ALONG, PlaceIndex, PlacedFace, Point, Surfaces, cosine, length, shown};
use crate::scalar::{Scalar, Vector3};
use crate::tolerances::SAME_VERTEX;
use std::collections::{HashMap, HashSet};

impl<S: Scalar> FreeMesh<S> {
    /// Where a point stands \[m\].
    pub(super) fn value_of(&self, point: usize) -> Point {
        self.points[point].map(Scalar::value)
    }
    /// Its faces with the places of their nodes.
    pub(super) fn placed(&self) -> Vec<PlacedFace> {
        let placed = |face: &super::free_mesh::MeshFace| PlacedFace {
            shape: face.kind.shape(),
            nodes: face.points.iter().map(|&point| self.value_of(point)).collect(),
        };
        self.faces.iter().map(placed).collect()
    }

    /// Points of its outer edges.
    pub(super) fn outer_points(&self) -> Vec<usize> {
        let single = self.edges().into_iter().filter(|edge| edge.faces.len() == 1);
        let mut points: Vec<usize> = single.flat_map(|edge| edge.points).collect();
        points.sort_unstable();
        points.dedup();
        points
    }

    /// Two points of faces that stand at the same place: faces on both sides are not joined there.
    fn coincident(&self) -> Option<[usize; 2]> {
        let near = (SAME_VERTEX * self.size()).max(f64::MIN_POSITIVE);
        let mut used: Vec<usize> = self.faces.iter().flat_map(|face| face.points.iter().copied()).collect();
        used.sort_unstable();
        used.dedup();
        let mut by_place = PlaceIndex::new(near);
        used.into_iter().find_map(|point| {
            let other = by_place.find(self.value_of(point));
            by_place.add(point, self.value_of(point));
            Some([other?, point])
        })
    }

    /// Faces that lie on each other: the directions from a common edge into both of them are the same.
    fn doubled(&self, normals: &[Vec<Vector3<S>>]) -> Option<String> {
        let inward = |face: usize, ends: [usize; 2]| -> Option<Point> {
            let own = &self.faces[face];
            let of_ends = |edge: &&&[usize]| {
                let [a, b] = [edge[0], edge[edge.len() - 1]].map(|place| own.points[place]);
                [a, b] == ends || [b, a] == ends
            };
            let edge = own.kind.shape().edges.iter().find(of_ends)?;
            let [from, to] = [edge[0], edge[edge.len() - 1]];
            let [a, b] = [from, to].map(|place| normals[face][place].map(Scalar::value));
            let along = self.value_of(own.points[to]) - self.value_of(own.points[from]);
            Some((a + b).cross(&along))
        };
        for edge in self.edges().iter().filter(|edge| edge.faces.len() > 1) {
            let ends = [edge.points[0], edge.points[edge.points.len() - 1]];
            for (place, &(first, _)) in edge.faces.iter().enumerate() {
                for &(second, _) in &edge.faces[..place] {
                    let ([Some(a), Some(b)], names) =
                        ([inward(first, ends), inward(second, ends)], [second, first].map(|face| self.element_place(face)))
                    else {
                        continue;
                    };
                    if cosine(a, b) > ALONG.cos() {
                        let [first_name, second_name] = names;
                        let set = |face: usize| self.faces[face].points.iter().copied().collect::<HashSet<_>>();
                        return Some(if set(first) == set(second) {
                            format!(
                                "{first_name} and {second_name} have the same points: a face that stands twice counts twice; leave one out"
                            )
                        } else {
                            let [from, to] = ends.map(|point| self.point_number(point));
                            format!(
                                "{first_name} and {second_name} lie on each other beside their edge from point {from} to point {to}: where faces \
                                 overlap, both count; leave one out"
                            )
                        });
                    }
                }
            }
        }
        None
    }

    /// A point on the outer edges that lies on a face, or along an edge, to which it does not belong.
    fn hanging_point(&self) -> Option<String> {
        let edges = self.edges();
        let outer: Vec<_> = edges.iter().filter(|edge| edge.faces.len() == 1).collect();
        let mut at_point: HashMap<usize, Vec<(usize, usize)>> = HashMap::new();
        for edge in &outer {
            let ends = [edge.points[0], edge.points[edge.points.len() - 1]];
            for [own, other] in [ends, [ends[1], ends[0]]] {
                at_point.entry(own).or_default().push((other, edge.faces[0].0));
            }
        }
        let tells = |point: usize, face: usize, distance: f64| {
            let (number, place, name) = (self.point_number(point), shown(self.value_of(point)), self.element_place(face));
            format!(
                "point {number} at {place} lies on {name}, {distance:.1e} m from its surface, and is no point of it, so that faces are not joined \
                 there: divide both sides alike, or let it with coincident = true (with_coincident_points) if it is a slit or a tie closes it"
            )
        };
        // the sides of a slit between edges of different lengths, which curved ones do not lie on
        let mut points: Vec<usize> = at_point.keys().copied().collect();
        points.sort_unstable();
        for point in points {
            let own = &at_point[&point];
            for (place, &(second, second_face)) in own.iter().enumerate() {
                for &(first, first_face) in &own[..place] {
                    let [a, b] = [first, second].map(|other| self.value_of(other) - self.value_of(point));
                    let run_along = cosine(a, b) > ALONG.cos();
                    if first_face == second_face || !run_along || self.is_tip(point, own.len()) {
                        continue;
                    }
                    let (short, face, distance) = if length(a) < length(b) {
                        (first, second_face, length(a - b * a.dot(&b) / b.dot(&b)))
                    } else {
                        (second, first_face, length(b - a * a.dot(&b) / a.dot(&a)))
                    };
                    return Some(tells(short, face, distance));
                }
            }
        }
        let surfaces = Surfaces::new(self.placed(), SAME_VERTEX * self.size());
        self.outer_points().into_iter().find_map(|point| {
            let foot = surfaces.nearest(self.value_of(point), |face| !self.faces[face].points.contains(&point))?;
            Some(tells(point, foot.face, foot.distance))
        })
    }

    /// Whether the faces around a point of two outer edges are a narrow tip, and not nearly all that is around it.
    fn is_tip(&self, point: usize, outer: usize) -> bool {
        let angle = |face: &super::free_mesh::MeshFace| {
            let corners = &face.kind.shape().cyclic[..face.kind.shape().corners];
            let place = corners.iter().position(|&corner| face.points[corner] == point)?;
            let beside = [1, corners.len() - 1].map(|step| face.points[corners[(place + step) % corners.len()]]);
            let [a, b] = beside.map(|other| self.value_of(other) - self.value_of(point));
            Some(cosine(a, b).clamp(-1.0, 1.0).acos())
        };
        outer == 2 && self.faces.iter().filter_map(angle).sum::<f64>() < std::f64::consts::FRAC_PI_2
    }

    /// Where it is not joined though it looks so, in words.
    pub(super) fn gaps(&self, normals: &[Vec<Vector3<S>>]) -> Option<String> {
        if let Some(doubled) = self.doubled(normals) {
            return Some(doubled);
        }
        if self.may_coincide {
            return None;
        }
        if let Some([a, b]) = self.coincident() {
            let place = shown(self.value_of(a));
            let [a, b] = [a, b].map(|point| self.point_number(point));
            return Some(format!(
                "points {a} and {b} stand at the same place, {place}, so that faces on both sides are not joined there: make them one (Coherence Mesh \
                 in Gmsh), or let them with coincident = true (with_coincident_points) if it is a slit"
            ));
        }
        self.hanging_point()
    }
}
