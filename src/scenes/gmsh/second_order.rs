//! Elements of other orders, made second order: shells have faces with one node in the middle of an edge.

use super::kinds::Kind;
use crate::scenes::mesh_data::MeshData;
use std::collections::HashMap;

/// Middles of edges by the ends of these, the smaller first.
#[derive(Default)]
pub(super) struct Middles {
    of_edges: HashMap<[usize; 2], usize>,
}

impl Middles {
    /// The points of an element of second order through those of one of a higher order; the middle of an edge with an odd number of parts is
    /// a new point of the curve through its nodes, in common with the neighbours, and the middle of a quadrilateral one of its surface.
    ///
    /// Gmsh lists the corners, then the nodes inside each edge, then those inside as an element of an order that is less by 2 (by 3 in triangles).
    pub fn lower(&mut self, kind: Kind, own: &[usize], points: &mut Vec<[f64; 3]>) -> Vec<usize> {
        let Kind { corners, order, .. } = kind;
        let mut lowered = own[..corners].to_vec();
        let edges = if kind.dimension == 1 { 1 } else { corners };
        for k in 0..edges {
            let ends = [own[k], own[(k + 1) % corners]];
            let inside = &own[corners + k * (order - 1)..corners + (k + 1) * (order - 1)];
            lowered.push(if order % 2 == 0 {
                inside[order / 2 - 1]
            } else {
                let along = [&ends[..1], inside, &ends[1..]].concat();
                self.between(ends, along.into_iter().zip((0..=order).map(|i| at_middle(order, i))), points)
            });
        }
        if kind.dimension == 2 && corners == 4 && kind.is_complete() {
            lowered.push(if order % 2 == 0 {
                own[own.len() - 1]
            } else {
                let weight = |[i, j]: [usize; 2]| at_middle(order, i) * at_middle(order, j);
                added(own.iter().copied().zip(places(order, 0).into_iter().map(weight)), points)
            });
        }
        lowered
    }

    /// Raises triangles of three points to six, and quadrilaterals of four points beside them, whose edges would not fit, to nine.
    ///
    /// Faces, and lines of node sets, share the middles of their edges, with faces of second order, too. Says what was raised.
    pub fn raise<'l>(mut self, mesh: &mut MeshData, lines: impl Iterator<Item = &'l mut Vec<usize>>) -> Option<String> {
        let count = |corners: usize| mesh.faces.iter().filter(|face| face.len() == corners).count();
        let [triangles, quadrilaterals] = [3, 4].map(count);
        if triangles == 0 {
            return None;
        }
        for face in &mesh.faces {
            let corners = match face.len() {
                6 => 3,
                8 | 9 => 4,
                _ => continue,
            };
            let edge = |k: usize| (sorted([face[k], face[(k + 1) % corners]]), face[corners + k]);
            self.of_edges.extend((0..corners).map(edge));
        }
        for face in mesh.faces.iter_mut().filter(|face| matches!(face.len(), 3 | 4)) {
            let corners = face.clone();
            for (k, &from) in corners.iter().enumerate() {
                let ends = [from, corners[(k + 1) % corners.len()]];
                face.push(self.between(ends, ends.map(|end| (end, 0.5)), &mut mesh.points));
            }
            if corners.len() == 4 {
                face.push(added(corners.into_iter().map(|corner| (corner, 0.25)), &mut mesh.points));
            }
        }
        for line in lines {
            if let &mut [from, to] = &mut line[..]
                && let Some(&middle) = self.of_edges.get(&sorted([from, to]))
            {
                line.push(middle);
            }
        }
        let words = match quadrilaterals {
            0 => String::new(),
            count => format!(", and quadrilaterals of 4 nodes beside them to 9 ({count})"),
        };
        Some(format!("triangles of 3 nodes raised to 6 ({triangles}){words}"))
    }

    /// The middle of an edge, which may be new: then a weighed sum of points.
    fn between(
        &mut self,
        ends: [usize; 2],
        weighed: impl IntoIterator<Item = (usize, f64)>,
        points: &mut Vec<[f64; 3]>,
    ) -> usize {
        *self.of_edges.entry(sorted(ends)).or_insert_with(|| added(weighed, points))
    }
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// A new point, the weighed sum of others.
fn added(weighed: impl IntoIterator<Item = (usize, f64)>, points: &mut Vec<[f64; 3]>) -> usize {
    let sum = |sum: [f64; 3], (point, weight): (usize, f64)| [0, 1, 2].map(|axis| sum[axis] + weight * points[point][axis]);
    let place = weighed.into_iter().fold([0.0; 3], sum);
    points.push(place);
    points.len() - 1
}

/// The polynomial that is 1 at node i of an edge with `order` equal parts and 0 at the others, at its middle.
fn at_middle(order: usize, i: usize) -> f64 {
    let other = (0..=order).filter(|j| *j != i).map(|j| j as f64);
    other.map(|j| (0.5 * order as f64 - j) / (i as f64 - j)).product()
}

/// Where the nodes of a complete quadrilateral stand in the grid of its nodes, in their order.
fn places(order: usize, from: usize) -> Vec<[usize; 2]> {
    let to = from + order;
    match order {
        0 => vec![[from; 2]],
        _ => {
            let corners = [[from, from], [to, from], [to, to], [from, to]];
            let edges = [
                (from + 1..to).map(|i| [i, from]).collect::<Vec<_>>(),
                (from + 1..to).map(|j| [to, j]).collect(),
                (from + 1..to).rev().map(|i| [i, to]).collect(),
                (from + 1..to).rev().map(|j| [from, j]).collect(),
            ];
            let inside = if order == 1 { Vec::new() } else { places(order - 2, from + 1) };
            corners.into_iter().chain(edges.into_iter().flatten()).chain(inside).collect()
        }
    }
}
