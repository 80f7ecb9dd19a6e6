//! What a mechanism looks like in space: beams and cables with their sections, shells with their thickness, bodies and links as rods.

use super::builder::{MechanismBuilder, OutlinedLine, Ring};
use super::sketch::{Drawn, NodePoint};
use super::surfaces::Surface;
use crate::assembly::NodeId;
use crate::elements::NodeKind;
use crate::elements::flexible::Outline;
use crate::tolerances::{CONSISTENT, LONG_SUM};
use std::collections::{HashMap, HashSet};

type Vector = [f64; 3];

fn combined(terms: impl IntoIterator<Item = (f64, Vector)>) -> Vector {
    terms.into_iter().fold([0.0; 3], |sum, (weight, own)| [0, 1, 2].map(|k| sum[k] + weight * own[k]))
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

/// Each number once, in increasing order.
fn sorted(numbers: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut numbers: Vec<usize> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Where a vertex stands.
#[derive(Clone, Debug)]
enum Place {
    /// In the frame of a node.
    Node(NodePoint),
    /// Beside a cable's node: across its slope, by two directions at the start.
    AcrossSlope { node: NodePoint, start: Vector, offset: Vector },
    /// On a shell, at the shape functions of its nodes: on its lower (0) or upper (1) side.
    Shell { surface: usize, weights: Vec<f64>, side: usize },
}

/// Where a stress is read; of several places their mean.
#[derive(Clone, Debug)]
enum StressPlace {
    /// A part of a shell around a Gauss point.
    Shell { surface: usize, piece: usize },
    /// An end or the middle of an element of a beam or cable.
    Line { line: usize, element: usize, place: f64, outline: Outline },
}

/// A rod through points that move.
#[derive(Clone, Debug)]
pub struct Rod {
    /// What it stands for.
    pub drawn: Drawn,
    /// What it is a part of, among [`Solids::parts`].
    pub part: usize,
    /// Vertices.
    pub vertices: Vec<usize>,
}

/// A corner of what is drawn.
struct Vertex {
    place: Place,
    /// Elements that it belongs to, by their places in the model.
    elements: Vec<usize>,
    /// Its stress among all, where it has one.
    stress: Option<usize>,
    /// The part that it belongs to, among [`Solids::parts`], where that is told by its colour.
    part: Option<usize>,
}

/// Vertices that move with the mechanism, and what is spanned between them.
pub struct Solids<'m> {
    mechanism: &'m MechanismBuilder<f64>,
    surfaces: Vec<Surface>,
    /// Elements by the nodes that they act on, by first coordinates in their order.
    elements_on: HashMap<Vec<usize>, Vec<usize>>,
    /// Places among [`Solids::parts`].
    pub part_numbers: HashMap<&'m str, usize>,
    vertices: Vec<Vertex>,
    stress_places: Vec<Vec<StressPlace>>,
    /// Surfaces of beams, cables and shells.
    pub triangles: Vec<[usize; 3]>,
    /// Lines on these surfaces: outlines of sections and edges of elements.
    pub edges: Vec<[usize; 2]>,
    /// Bodies and links.
    pub rods: Vec<Rod>,
    /// Point masses: a vertex, and the place among [`Solids::parts`].
    pub points: Vec<(usize, usize)>,
    /// Names of the bodies and point masses.
    pub parts: Vec<String>,
    /// Points to follow, with their names.
    pub followed: Vec<(String, usize)>,
    /// Points that hold the mechanism to the ground \[m\].
    pub anchors: Vec<Vector>,
}

impl MechanismBuilder<f64> {
    /// The mechanism in space.
    #[doc(hidden)]
    pub fn solids(&self) -> Solids<'_> {
        let mut solids = Solids {
            mechanism: self,
            surfaces: self.surfaces(),
            elements_on: self.elements_on_nodes(),
            part_numbers: HashMap::new(),
            vertices: Vec::new(),
            stress_places: Vec::new(),
            triangles: Vec::new(),
            edges: Vec::new(),
            rods: Vec::new(),
            points: Vec::new(),
            parts: Vec::new(),
            followed: Vec::new(),
            anchors: Vec::new(),
        };
        for line in 0..self.outlined.len() {
            solids.add_line(line);
        }
        solids.add_shells();
        solids.add_bodies();
        solids.add_rods();
        solids
    }

    fn elements_on_nodes(&self) -> HashMap<Vec<usize>, Vec<usize>> {
        let mut elements: HashMap<Vec<usize>, Vec<usize>> = HashMap::new();
        for (number, element) in self.model.elements.iter().enumerate() {
            let nodes = sorted(element.nodes.iter().map(|node| self.model.nodes[node.0].dofs.start));
            elements.entry(nodes).or_default().push(number);
        }
        elements
    }

    fn start_of(&self, node: NodeId) -> Option<NodePoint> {
        self.node_point(node, [0.0; 3])
    }

    /// A corner of the section of a beam or cable at one of its nodes.
    fn corner(&self, ring: &Ring, node: &NodePoint, [x2, x3]: [f64; 2]) -> Option<Place> {
        if let Some([second, third]) = ring.axes {
            let local = combined([(x2, second), (x3, third)]);
            return Some(Place::Node(self.node_point(ring.node, local)?));
        }
        let slope = unit(slope(node, &self.numbers.q));
        let along = (0..3).min_by(|&a, &b| slope[a].abs().total_cmp(&slope[b].abs()))?;
        let second = unit(cross(slope, [0, 1, 2].map(|k| f64::from(u8::from(k == along)))));
        let offset = combined([(x2, second), (x3, cross(slope, second))]);
        Some(Place::AcrossSlope { node: node.clone(), start: slope, offset })
    }
}

impl Solids<'_> {
    /// Whether nothing has a place in space.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Number of vertices.
    pub fn count(&self) -> usize {
        self.vertices.len()
    }

    fn add(&mut self, place: Place, elements: Vec<usize>, stress: Option<usize>) -> usize {
        self.vertices.push(Vertex { place, elements, stress, part: None });
        self.vertices.len() - 1
    }

    /// Of each vertex the part among [`Solids::parts`] whose colour it has, if it has one's.
    pub fn parts_of_vertices(&self) -> Vec<Option<usize>> {
        self.vertices.iter().map(|own| own.part).collect()
    }

    /// Bodies that are described by solids.
    fn add_bodies(&mut self) {
        let mechanism = self.mechanism;
        for solid in &mechanism.solids {
            let Some(origin) = mechanism.start_of(solid.node) else { continue };
            let elements = self.elements_between(std::slice::from_ref(&origin), Drawn::Body);
            let (part, first) = (self.part(&origin), self.vertices.len());
            for &vertex in &solid.facets.vertices {
                let Some(point) = mechanism.node_point(solid.node, vertex) else { continue };
                let vertex = self.add(Place::Node(point), elements.clone(), None);
                self.vertices[vertex].part = Some(part);
            }
            self.triangles.extend(solid.facets.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
            let lines = solid.facets.lines.iter().flat_map(|line| line.windows(2));
            self.edges.extend(lines.map(|pair| [first + pair[0], first + pair[1]]));
        }
    }

    /// Rings of a beam or cable, its surface and its ends.
    fn add_line(&mut self, index: usize) {
        let mechanism = self.mechanism;
        let OutlinedLine { rings, elements, field, .. } = &mechanism.outlined[index];
        let per_element = field.places().len() - 1;
        let mut last: Option<Vec<usize>> = None;
        for (i, ring) in rings.iter().enumerate() {
            let Some(node) = mechanism.start_of(ring.node) else { return };
            let mut places = Vec::new();
            // the element before a node between two of them, and the one behind
            for element in i.saturating_sub(1) / per_element..=(i / per_element).min(elements.len() - 1) {
                let place = field.places()[i - element * per_element];
                places.push(StressPlace::Line { line: index, element, place, outline: ring.outline });
            }
            let own = vec![elements[(i / per_element).min(elements.len() - 1)].0];
            let stress = ring.outline.young.map(|_| {
                self.stress_places.push(places);
                self.stress_places.len() - 1
            });
            let points = ring.outline.points();
            let ends = i == 0 || i + 1 == rings.len();
            // corners have a vertex for each face, so that they are sharp
            let copies = if ring.outline.round { 1 } else { 2 };
            let corners: Vec<Place> = points.iter().filter_map(|&point| mechanism.corner(ring, &node, point)).collect();
            let now: Vec<usize> = corners
                .iter()
                .flat_map(|place| vec![place.clone(); copies])
                .map(|place| self.add(place, own.clone(), stress))
                .collect();
            let count = corners.len();
            let face = |ring: &[usize], k: usize| [ring[copies * k + copies - 1], ring[copies * ((k + 1) % count)]];
            if let Some(before) = last.as_ref().filter(|before| before.len() == now.len()) {
                for k in 0..count {
                    let ([a, b], [c, d]) = (face(before, k), face(&now, k));
                    self.triangles.extend([[a, b, d], [a, d, c]]);
                    if copies > 1 {
                        self.edges.push([before[copies * k], now[copies * k]]);
                    }
                }
            }
            if ends || i % per_element == 0 {
                self.edges.extend((0..count).map(|k| face(&now, k)));
            }
            if ends {
                let lid: Vec<usize> = corners.into_iter().map(|place| self.add(place, own.clone(), stress)).collect();
                for k in 1..count.saturating_sub(1) {
                    let [a, b, c] = [lid[0], lid[k], lid[k + 1]];
                    self.triangles.push(if i == 0 { [a, c, b] } else { [a, b, c] });
                }
            }
            last = Some(now);
        }
    }

    /// Both sides of shells, joined along free edges.
    fn add_shells(&mut self) {
        let q = &self.mechanism.numbers.q;
        let size = self.surfaces.iter().flat_map(|surface| surface.nodes.iter().flat_map(|node| node.at(q)));
        let grid = 1e-7 * size.fold(f64::MIN_POSITIVE, |most, x| x.abs().max(most));
        // vertices of two elements are one where seven digits of their places, which mesh files may hold, and directors are
        let mut known: HashMap<[i64; 6], [usize; 2]> = HashMap::new();
        let mut sides: HashMap<[usize; 2], ([usize; 4], usize)> = HashMap::new();
        for surface in 0..self.surfaces.len() {
            let shape = self.surfaces[surface].kind.face.shape();
            let element = self.surfaces[surface].element.0;
            for (piece, own) in shape.pieces.iter().enumerate() {
                let corners = own.corners.map(|[r, s]| {
                    let weights = (shape.values)(r, s).to_vec();
                    let (middle, director, _) = self.shell_place(surface, &weights, q);
                    let identity = [0, 1, 2].map(|k| (middle[k] / grid).round() as i64);
                    let turned = unit(director).map(|x| (x * 20.0).round() as i64);
                    let key = [identity[0], identity[1], identity[2], turned[0], turned[1], turned[2]];
                    let pair = *known.entry(key).or_insert_with(|| {
                        self.stress_places.push(Vec::new());
                        let stress = Some(self.stress_places.len() - 1);
                        [0, 1].map(|side| {
                            let place = Place::Shell { surface, weights: weights.clone(), side };
                            self.add(place, Vec::new(), stress)
                        })
                    });
                    for vertex in pair {
                        let elements = &mut self.vertices[vertex].elements;
                        if !elements.contains(&element) {
                            elements.push(element);
                        }
                    }
                    if let Some(stress) = self.vertices[pair[0]].stress {
                        self.stress_places[stress].push(StressPlace::Shell { surface, piece });
                    }
                    pair
                });
                let [a, b, c, d] = corners;
                for side in 0..2 {
                    let [a, b, c, d] = [a[side], b[side], c[side], d[side]];
                    let faces = if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                    self.triangles.extend(faces.into_iter().filter(|[a, b, c]| a != b && b != c && a != c));
                }
                for k in 0..4 {
                    let (from, to) = (corners[k], corners[(k + 1) % 4]);
                    if own.at_edge[k] {
                        self.edges.extend([[from[0], to[0]], [from[1], to[1]]]);
                    }
                    let key = [from[0].min(to[0]), from[0].max(to[0])];
                    sides.entry(key).or_insert(([from[0], to[0], to[1], from[1]], 0)).1 += 1;
                }
            }
        }
        let free: Vec<[usize; 4]> = sides.into_values().filter(|(_, count)| *count == 1).map(|(quad, _)| quad).collect();
        for quad in free {
            // of their own, so that the rim is sharp
            let [a, b, c, d] = quad.map(|vertex| {
                let Vertex { place, elements, stress, .. } = &self.vertices[vertex];
                self.add(place.clone(), elements.clone(), *stress)
            });
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Lines of bodies, springs, dampers and links, point masses, and what is followed.
    fn add_rods(&mut self) {
        let mechanism = self.mechanism;
        let sketch = mechanism.sketch();
        let lines: HashSet<Vec<(usize, [u64; 3])>> = mechanism
            .outlined
            .iter()
            .map(|line| line.rings.iter().filter_map(|ring| Some(mechanism.start_of(ring.node)?.identity())).collect())
            .collect();
        for (drawn, points) in &sketch.lines {
            let identities: Vec<_> = points.iter().map(NodePoint::identity).collect();
            // what has a section is there already
            if matches!(drawn, Drawn::Shell | Drawn::Solid) || lines.contains(&identities) {
                continue;
            }
            let elements = self.elements_between(points, *drawn);
            let part = if *drawn == Drawn::Link { 0 } else { self.part(&points[0]) };
            let vertices = points.iter().map(|point| self.add(Place::Node(point.clone()), elements.clone(), None)).collect();
            self.rods.push(Rod { drawn: *drawn, part, vertices });
        }
        for (index, node) in mechanism.model.nodes.iter().enumerate().filter(|(_, node)| node.kind == NodeKind::Point) {
            let Some(point) = mechanism.start_of(mechanism.model.node_id(index)).filter(|_| !node.fixed) else { continue };
            let elements = self.elements_between(std::slice::from_ref(&point), Drawn::Body);
            let part = self.part(&point);
            let vertex = self.add(Place::Node(point), elements, None);
            self.points.push((vertex, part));
        }
        for (name, point) in sketch.followed {
            let vertex = self.add(Place::Node(point), Vec::new(), None);
            self.followed.push((name, vertex));
        }
        self.anchors = sketch.anchors;
    }

    /// The place of a point's node among the parts, to which it is added.
    fn part(&mut self, point: &NodePoint) -> usize {
        let name = self.mechanism.node_of(point);
        *self.part_numbers.entry(name).or_insert_with(|| {
            self.parts.push(name.into());
            self.parts.len() - 1
        })
    }

    /// Elements that act on just the nodes of a line: masses of a body, springs and dampers of a link.
    fn elements_between(&self, points: &[NodePoint], drawn: Drawn) -> Vec<usize> {
        let nodes = sorted(points.iter().map(|point| point.identity().0));
        let own = self.elements_on.get(&nodes).filter(|_| drawn != Drawn::Link || nodes.len() == 2);
        own.cloned().unwrap_or_default()
    }

    /// A place among the nodes of a shell, its director, and how far its lower and upper side are along it.
    fn shell_place(&self, surface: usize, weights: &[f64], q: &[f64]) -> (Vector, Vector, [f64; 2]) {
        let own = &self.surfaces[surface];
        let p = &self.mechanism.numbers.p;
        let middle = combined(own.nodes.iter().zip(weights).map(|(node, &weight)| (weight, node.at(q))));
        let directors = own.directors(p);
        let turned = own.nodes.iter().zip(&directors).map(|(node, &director)| node.turned(q, director));
        let director = combined(weights.iter().copied().zip(turned));
        // where no thickness is known its two sides are told apart all the same
        let edge = combined([(CONSISTENT, own.nodes[0].at(q)), (-CONSISTENT, own.nodes[1].at(q))]);
        let half = edge.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        (middle, director, own.sides(p, weights).unwrap_or([-half, half]))
    }

    /// All vertices \[m\] at coordinates of the mechanism.
    pub fn positions(&self, q: &[f64]) -> Vec<Vector> {
        let place = |place: &Place| match place {
            Place::Node(point) => point.at(q),
            Place::AcrossSlope { node, start, offset } => {
                let now = unit(slope(node, q));
                let axis = cross(*start, now);
                let cosine: f64 = (0..3).map(|k| start[k] * now[k]).sum();
                let (once, centre) = (cross(axis, *offset), node.at(q));
                // the least rotation from the slope at the start to that of now
                let twice = cross(axis, once);
                combined([(1.0, centre), (1.0, *offset), (1.0, once), (1.0 / (1.0 + cosine).max(LONG_SUM), twice)])
            }
            Place::Shell { surface, weights, side } => {
                let (middle, director, sides) = self.shell_place(*surface, weights, q);
                combined([(1.0, middle), (sides[*side], director)])
            }
        };
        self.vertices.iter().map(|own| place(&own.place)).collect()
    }

    /// Whether any vertex has a stress.
    pub fn have_stress(&self) -> bool {
        self.vertices.iter().any(|own| own.stress.is_some())
    }

    /// Stress of each vertex [N/m2], not a number where there is none: von Mises of shells, the largest axial one of a section.
    pub fn stresses(&self, q: &[f64]) -> Vec<f64> {
        let p = &self.mechanism.numbers.p;
        let shells: Vec<Option<Vec<f64>>> = self.surfaces.iter().map(|surface| surface.stresses(q, p)).collect();
        let at = |place: &StressPlace| match place {
            StressPlace::Shell { surface, piece } => shells[*surface].as_ref().map(|own| own[*piece]),
            StressPlace::Line { line, element, place, outline } => self.line_stress(*line, *element, *place, outline, q),
        };
        let mean = |places: &Vec<StressPlace>| {
            let values: Vec<f64> = places.iter().filter_map(at).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        let all: Vec<f64> = self.stress_places.iter().map(mean).collect();
        self.vertices.iter().map(|own| own.stress.map_or(f64::NAN, |place| all[place])).collect()
    }

    fn line_stress(&self, line: usize, element: usize, place: f64, outline: &Outline, q: &[f64]) -> Option<f64> {
        let OutlinedLine { elements, field, .. } = &self.mechanism.outlined[line];
        let own = self.mechanism.model.find_element(elements[element])?;
        let coordinates: Vec<f64> =
            own.nodes.iter().flat_map(|&node| q[self.mechanism.model.node(node).dofs.clone()].to_vec()).collect();
        let p = &self.mechanism.numbers.p[own.parameters.clone()];
        field.largest_stress(outline, place, &coordinates, p)
    }

    /// The elements that are shown, by their places in the model, each once.
    pub fn shown_elements(&self) -> Vec<usize> {
        sorted(self.vertices.iter().flat_map(|own| own.elements.iter().copied()))
    }

    /// For each vertex what its elements have of a number for each element; not a number where it has none. Between elements of a shell it is
    /// their mean; of what acts on the same part, as inertia and weight of a body, the sum.
    pub fn of_elements(&self, values: &[f64]) -> Vec<f64> {
        let own = |Vertex { place, elements, .. }: &Vertex| {
            let finite: Vec<f64> = elements.iter().map(|&element| values[element]).filter(|value| !value.is_nan()).collect();
            let sum = finite.iter().sum::<f64>();
            match (place, finite.len()) {
                (_, 0) => f64::NAN,
                (Place::Shell { .. }, count) => sum / count as f64,
                _ => sum,
            }
        };
        self.vertices.iter().map(own).collect()
    }
}

/// Slope of a cable's node.
fn slope(node: &NodePoint, q: &[f64]) -> Vector {
    let own = node.coordinates(q);
    [own[3], own[4], own[5]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::flexible::{CableSection, Laminate, Material, Ply, Section, Shape};
    use crate::scalar::{Quaternion, SpatialVector, Vector3};
    use crate::scenes::{BeamLine, CableLine, ShellMesh};

    #[test]
    fn shells_of_plies_are_as_thick_as_these_and_stand_where_they_do() {
        let ply = |thickness| Ply {
            thickness,
            angle: 0.0,
            young: [YOUNG; 2],
            poisson: 0.3,
            shear: [YOUNG / 2.6; 3],
            density: 1.0,
        };
        let laminate = Laminate::new(vec![ply(0.01), ply(0.03)]).offset(0.05);
        let mut m = MechanismBuilder::<f64>::default();
        let mesh = ShellMesh::plate(Vector3::zeros(), [Vector3::x(), Vector3::y()], [1, 1]);
        m.laminate_shell("plate", mesh, &laminate, Vector3::x());
        let m = m.finish().unwrap();
        let (solids, places) = (m.solids(), m.solids().positions(&m.numbers.q));
        let heights: Vec<f64> = solids.triangles.iter().flatten().map(|&vertex| places[vertex][2]).collect();
        assert!(heights.iter().all(|z| (z - 0.03).abs() < 1e-12 || (z - 0.07).abs() < 1e-12), "{heights:?}");
        let [least, most] = [f64::min, f64::max].map(|of| heights.iter().copied().reduce(of).unwrap());
        assert!((most - least - 0.04).abs() < 1e-12);
        assert!((m.surfaces()[0].thickness(&m.numbers.p).unwrap() - 0.04).abs() < 1e-15);
    }

    #[test]
    fn what_acts_on_one_body_adds_up_and_neighbours_in_a_shell_are_averaged() {
        let mut m = MechanismBuilder::<f64>::default();
        let body = m.body("body", Vector3::zeros(), Quaternion::identity());
        m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        m.draw(body, &[Vector3::zeros(), Vector3::x()]);
        m.gravity(Vector3::z());
        let m = m.finish().unwrap();
        assert_eq!(m.model.elements.len(), 2, "inertia and weight");
        // its line, and the point that is followed
        let values = m.solids().of_elements(&[2.0, 5.0]);
        assert!(values[..2] == [7.0, 7.0] && values[2..].iter().all(|value| value.is_nan()), "{values:?}");
        let mut m = MechanismBuilder::<f64>::default();
        let mesh = ShellMesh::plate(Vector3::zeros(), [Vector3::x(), Vector3::y()], [2, 1]);
        m.shell("plate", mesh, &MATERIAL, 0.1);
        let m = m.finish().unwrap();
        let (solids, values) = (m.solids(), m.solids().of_elements(&[2.0, 5.0]));
        let values: Vec<f64> = solids.triangles.iter().flatten().map(|&vertex| values[vertex]).collect();
        assert!(values.contains(&2.0) && values.contains(&5.0) && values.contains(&3.5), "{values:?}");
        assert!(values.iter().all(|value| [2.0, 3.5, 5.0].contains(value)), "{values:?}");
    }

    const YOUNG: f64 = 2e11;
    const MATERIAL: Material<f64> = Material { young: YOUNG, poisson: 0.3, density: 7800.0 };

    fn beam(shape: Shape<f64>) -> MechanismBuilder<f64> {
        let mut m = MechanismBuilder::default();
        let line =
            BeamLine::straight([[0.0; 3], [2.0, 1.0, -2.0]].map(Vector3::from_f64), 2, Vector3::from_f64([0.0, 0.0, 1.0]));
        m.beam("beam", line, &Section::of(MATERIAL, shape));
        m
    }

    /// Of a closed surface that is seen from outside, by the divergence theorem \[m3\].
    fn volume(solids: &Solids, q: &[f64]) -> f64 {
        let places = solids.positions(q);
        let piece = |[a, b, c]: [usize; 3]| -> f64 {
            let across = cross(places[b], places[c]);
            (0..3).map(|k| places[a][k] * across[k]).sum::<f64>() / 6.0
        };
        solids.triangles.iter().map(|&triangle| piece(triangle)).sum()
    }

    #[test]
    fn surfaces_of_beams_hold_the_volume_of_their_sections() {
        // twelve corners on a circle of radius r: 3 r^2
        for (shape, area) in [(Shape::rectangle(0.1, 0.2, 0.3), 0.02), (Shape::circle(0.2, 0.3), 0.03)] {
            let mechanism = beam(shape);
            let solids = mechanism.solids();
            let own = volume(&solids, &mechanism.numbers.q);
            assert!((own - 3.0 * area).abs() < 1e-12, "{own} {area}");
        }
    }

    #[test]
    fn surfaces_of_shells_hold_the_volume_of_the_plate() {
        let mut m = MechanismBuilder::<f64>::default();
        let mesh = ShellMesh::plate(Vector3::zeros(), [Vector3::x(), Vector3::y()], [3, 2]);
        m.shell("plate", mesh, &MATERIAL, 0.1);
        let own = volume(&m.solids(), &m.numbers.q);
        assert!((own - 0.1).abs() < 1e-12, "{own}");
    }

    #[test]
    fn a_stretched_line_has_the_stress_of_its_strain_everywhere() {
        let mut cable = MechanismBuilder::<f64>::default();
        let line = CableLine::straight([[0.0; 3], [2.0, 1.0, -2.0]].map(Vector3::from_f64), 3);
        cable.cable("cable", line, &CableSection::of(MATERIAL, Shape::circle(0.01, 0.3)));
        // Green's strain of cables, and that of the line itself
        let stretch = 1.001_f64;
        for (mechanism, strain) in
            [(beam(Shape::rectangle(0.1, 0.2, 0.3)), stretch - 1.0), (cable, 0.5 * (stretch * stretch - 1.0))]
        {
            let mut q = mechanism.numbers.q.clone();
            for node in &mechanism.model.nodes {
                let count = if node.kind == NodeKind::Slope { 6 } else { 3 };
                q[node.dofs.start..node.dofs.start + count].iter_mut().for_each(|x| *x *= stretch);
            }
            let solids = mechanism.solids();
            let stresses = solids.stresses(&q);
            assert!(solids.have_stress());
            let at_rest = solids.stresses(&mechanism.numbers.q);
            for &vertex in solids.triangles.iter().flatten() {
                let stress = stresses[vertex] / (YOUNG * strain);
                assert!((stress - 1.0).abs() < 1e-9 && at_rest[vertex].abs() < 1e-3 * YOUNG * strain, "{stress}");
            }
        }
    }
}
