//! Beams: lines with sections, their weight and loads, and what is read in their sections.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::entries::entry;
use super::line_stress::LineStress;
use super::weights::Heavy;
use super::{Drawing, LineField, MechanismBuilder, OutlinedLine, Ring};
use crate::assembly::{ElementId, NodeId};
use crate::elements::flexible::shape::{THREE, THREE_WEIGHTS, TWO, slopes, values};
use crate::elements::flexible::{BeamField, STRAINS, Section, TYING_POINTS};
use crate::elements::forces::{LOADS, LoadFrame};
use crate::elements::{Flexible, NodeKind};
use crate::functionals::quantities::{SectionMeasure, SectionQuantity};
use crate::functionals::{ElementGroup, Over};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{Drawn, Signal};

/// The reference line of a beam at t = 0, in the world, by the places of its nodes: both ends and one in the middle of each element.
#[derive(Clone, Debug)]
pub struct BeamLine<S> {
    /// Nodes \[m\]: an odd number.
    points: Vec<Vector3<S>>,
    /// At each node, a direction that with the tangent spans the plane of axes 1 and 2 of the section.
    second_axes: Vec<Vector3<S>>,
    ends: [End; 2],
}

/// What a beam or a cable ends in.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// A node of its own.
    Free,
    /// A node that never moves.
    Clamped,
    /// A node that is there already.
    Node(NodeId),
}

/// What lines of beams and cables end in, and what their members are made of.
macro_rules! line_and_member {
    ($line:ident, $member:ident) => {
        impl<S> $line<S> {
            /// Starts in a node that is there, at the place of the line's first point: of a beam a rigid body or an end of another one, of a cable
            /// the end of another one, in the same direction.
            #[must_use]
            pub fn from_node(mut self, node: NodeId) -> Self {
                self.ends[0] = End::Node(node);
                self
            }
            /// Ends in a node that is there.
            #[must_use]
            pub fn to_node(mut self, node: NodeId) -> Self {
                self.ends[1] = End::Node(node);
                self
            }
            /// Starts in a node that never moves; of a cable slope and stretch included.
            #[must_use]
            pub fn clamped_start(mut self) -> Self {
                self.ends[0] = End::Clamped;
                self
            }
            /// Ends in a node that never moves; of a cable slope and stretch included.
            #[must_use]
            pub fn clamped_end(mut self) -> Self {
                self.ends[1] = End::Clamped;
                self
            }
        }

        impl $member {
            /// All its elements.
            pub fn group(&self) -> ElementGroup {
                ElementGroup::new(&self.name, self.elements.iter().copied())
            }
            /// First node.
            pub fn start(&self) -> NodeId {
                self.nodes[0]
            }
            /// Last node.
            pub fn end(&self) -> NodeId {
                self.nodes[self.nodes.len() - 1]
            }
        }
    };
}
pub(super) use line_and_member;

line_and_member!(BeamLine, BeamMember);

impl<S: Scalar> BeamLine<S> {
    /// A line through given points, two for each element and one; `second_axis` is turned at right angles to the line.
    pub fn through(points: &[Vector3<S>], second_axis: Vector3<S>) -> Self {
        BeamLine { points: points.to_vec(), second_axes: vec![second_axis; points.len()], ends: [End::Free; 2] }
    }

    /// A straight line of equal elements.
    pub fn straight([from, to]: [Vector3<S>; 2], elements: usize, second_axis: Vector3<S>) -> Self {
        let last = (2 * elements).max(1);
        let point = |i: usize| from + (to - from) * S::from(i as f64 / last as f64);
        Self::through(&(0..=last).map(point).collect::<Vec<_>>(), second_axis)
    }

    /// An arc of a circle of equal elements, from a point by `angle` \[rad\] about the unit vector `axis` through `centre`; section axis 2
    /// along `axis`.
    pub fn arc(from: Vector3<S>, centre: Vector3<S>, axis: Vector3<S>, angle: S, elements: usize) -> Self {
        let last = (2 * elements).max(1);
        let turned = |i: usize| Quaternion::about(axis, angle * (i as f64 / last as f64)).rotate(from - centre);
        Self::through(&(0..=last).map(|i| centre + turned(i)).collect::<Vec<_>>(), axis)
    }

    /// Turns the sections about the line, by an angle \[rad\] that grows linearly from 0 at the first node.
    #[must_use]
    pub fn twisted(mut self, angle: S) -> Self {
        let last = self.points.len().saturating_sub(1);
        for i in 0..self.points.len() {
            let (before, after) = (self.points[i.saturating_sub(1)], self.points[(i + 1).min(last)]);
            let [_, second, third] = triad(after - before, self.second_axes[i]);
            let (s, c) = (angle * (i as f64 / last as f64)).sin_cos();
            self.second_axes[i] = second * c + third * s;
        }
        self
    }
}

/// A beam of a mechanism: its nodes from end to end and its elements.
#[derive(Clone, Debug)]
pub struct BeamMember {
    /// Two for each element, and one.
    pub nodes: Vec<NodeId>,
    /// In the same order.
    pub elements: Vec<ElementId>,
    field: BeamField,
    name: String,
}

impl BeamMember {
    /// Names for a load on each element, and the nodes of these.
    pub(in crate::scenes) fn carriers(&self, load: &str) -> Vec<(String, Vec<NodeId>)> {
        let one = |element| (format!("{load}, element {}", element + 1), self.nodes_of(element).to_vec());
        (0..self.elements.len()).map(one).collect()
    }
    /// The three nodes of an element.
    fn nodes_of(&self, element: usize) -> [NodeId; 3] {
        [self.nodes[2 * element], self.nodes[2 * element + 1], self.nodes[2 * element + 2]]
    }
}

/// Elements of a line of so many and the place in each, whose ends have some coordinates, at a share of its length: both where two meet.
pub(super) fn places_at(share: f64, count: usize, [start, end]: [f64; 2]) -> Vec<(usize, f64)> {
    let place = share * count as f64;
    let nearest = place.round();
    // a share such as 1/3 of three elements is an end of elements in spite of its last digit
    if (place - nearest).abs() < crate::tolerances::CONSISTENT && nearest > 0.0 && nearest < count as f64 {
        return vec![(nearest as usize - 1, end), (nearest as usize, start)];
    }
    let element = (place as usize).min(count.saturating_sub(1));
    vec![(element, (end - start) * (place - element as f64) + start)]
}

/// Unit tangent, `second` at right angles to it, and the axis that completes them.
fn triad<S: Scalar>(tangent: Vector3<S>, second: Vector3<S>) -> [Vector3<S>; 3] {
    let tangent = tangent.unit();
    let second = (second - tangent * tangent.dot(&second)).unit();
    [tangent, second, tangent.cross(&second)]
}

/// Metric and section axes of an element of the reference at xi.
fn reference<S: Scalar>(points: &[Vector3<S>], axes: &[Vector3<S>], xi: f64) -> (S, [Vector3<S>; 3]) {
    let combine = |vectors: &[Vector3<S>], weights: [f64; 3]| {
        vectors.iter().zip(weights).fold(Vector3::zeros(), |sum, (&vector, weight)| sum + vector * S::from(weight))
    };
    let slope = combine(points, slopes(xi));
    (slope.length(), triad(slope, combine(axes, values(xi))))
}

/// Parameters of an element whose points and axes and sections these are, and those of inertia, which come last among them.
fn element_parameters<S: Scalar>(
    field: BeamField,
    (points, axes): (&[Vector3<S>], &[Vector3<S>]),
    rotation: Quaternion<S>,
    section: &dyn Fn(f64) -> Section<S>,
) -> (Vec<S>, Vec<S>) {
    let mut p = Vec::new();
    for xi in TWO {
        let (metric, axes) = reference(points, axes, xi);
        let [tangent, second, _] = axes.map(|axis| rotation.rotate_back(axis));
        let own = section(xi);
        p.push(metric);
        p.extend(tangent.components().into_iter().chain(second.components()));
        p.extend((0..STRAINS).map(|i| own.stiffness[i][i]));
        if field.coupled {
            (0..STRAINS).for_each(|i| p.extend_from_slice(&own.stiffness[i][i + 1..]));
        }
        if field.damped {
            p.push(own.damping);
        }
    }
    let mut inertia = Vec::new();
    for (xi, weight) in THREE.into_iter().zip(THREE_WEIGHTS) {
        let (metric, axes) = reference(points, axes, xi);
        let axes = axes.map(|axis| rotation.rotate_back(axis));
        inertia.extend(section_inertia(&section(xi), axes).map(|number| number * metric * weight));
    }
    p.extend_from_slice(&inertia);
    (p, inertia)
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A beam along a line, with the same section everywhere: see [`Section`].
    pub fn beam(&mut self, name: &str, line: BeamLine<S>, section: &Section<S>) -> BeamMember {
        self.tapered_beam(name, line, |_| *section)
    }

    /// A beam whose section depends on the share of its length, from 0 to 1; all sections are of one kind.
    ///
    /// Nodes of its own start with the rotation of the node that it starts or ends in, or that of the world.
    pub fn tapered_beam(&mut self, name: &str, line: BeamLine<S>, section: impl Fn(f64) -> Section<S>) -> BeamMember {
        self.add_beam(name, &line, &section)
    }

    // not generic over the section
    fn add_beam(&mut self, name: &str, line: &BeamLine<S>, section: &dyn Fn(f64) -> Section<S>) -> BeamMember {
        let count = line.points.len();
        let kind = section(0.0).kind;
        let field = BeamField { coupled: kind.coupled, damped: kind.damped, eccentric: kind.eccentric };
        let mut member = BeamMember { nodes: Vec::new(), elements: Vec::new(), field, name: name.to_string() };
        let sound = self.check_line(name, line) && self.check_sections(name, count / 2, section);
        let given = line.ends.iter().find_map(|end| if let End::Node(node) = end { Some(*node) } else { None });
        let rotation = given.map_or_else(Quaternion::identity, |node| self.rotation(node));
        for (i, &point) in line.points.iter().enumerate() {
            let end = [(0, line.ends[0]), (count - 1, line.ends[1])].into_iter().find(|(place, _)| *place == i);
            let fixed = matches!(end, Some((_, End::Clamped)));
            let q: Vec<S> = point.components().into_iter().chain(rotation.0).collect();
            member.nodes.push(match end {
                Some((_, End::Node(node))) => node,
                _ => self.add_node_of_member(&format!("{name}[{i}]"), NodeKind::Body, fixed, &q),
            });
        }
        if !sound {
            // what the scene adds to this beam still finds its ends
            if member.nodes.is_empty() {
                member.nodes.push(self.body(&format!("{name}[0]"), Vector3::zeros(), rotation));
            }
            return member;
        }
        let elements = count / 2;
        for element in 0..elements {
            let range = 2 * element..2 * element + 3;
            let (points, axes) = (&line.points[range.clone()], &line.second_axes[range]);
            let share = |xi: f64| (element as f64 + 0.5 * (xi + 1.0)) / elements as f64;
            let (p, inertia) = element_parameters(field, (points, axes), rotation, &|xi| section(share(xi)));
            let nodes = member.nodes_of(element);
            let own = format!("{name}, element {}", element + 1);
            let id = self.add_element(&own, &nodes, Flexible(field).into(), &p);
            let [start, end] = [-1.0, 1.0].map(|xi| section(share(xi)));
            self.line_stresses.insert(id, LineStress::of_beam([&start, &end]));
            member.elements.push(id);
            self.heavy.push(Heavy::Beam(own, nodes, inertia, field.eccentric));
        }
        let ring = |(i, &node): (usize, &NodeId)| {
            let first = 2 * (i / 2).min(elements - 1);
            let (points, axes) = (&line.points[first..first + 3], &line.second_axes[first..first + 3]);
            let (_, axes) = reference(points, axes, (i - first) as f64 - 1.0);
            let [_, second, third] = axes.map(|axis| rotation.rotate_back(axis).components().map(Scalar::value));
            Ring { node, axes: Some([second, third]), outline: section(i as f64 / (count - 1) as f64).outline() }
        };
        let rings = member.nodes.iter().enumerate().map(ring).collect();
        let (name, elements, field) = (name.into(), member.elements.clone(), LineField::Beam(field));
        self.outlined.push(OutlinedLine { name, rings, elements, field });
        let points = member.nodes.iter().map(|&node| (node, [0.0; 3])).collect();
        self.drawings.push(Drawing { drawn: Drawn::Body, points });
        member
    }

    fn check_line(&mut self, name: &str, line: &BeamLine<S>) -> bool {
        let mistakes = self.mistakes.len();
        let count = line.points.len();
        if count < 3 || count.is_multiple_of(2) {
            self.mistakes
                .push(format!("\"{name}\" has {count} points; a beam needs two for each element and one: 3, 5, 7, ..."));
            return false;
        }
        for element in 0..count / 2 {
            let range = 2 * element..2 * element + 3;
            let (points, axes) = (&line.points[range.clone()], &line.second_axes[range]);
            for xi in TWO.into_iter().chain(THREE) {
                let (metric, [_, second, _]) = reference(points, axes, xi);
                if !(metric.value() > 0.0) || second.iter().any(|x| !x.value().is_finite()) {
                    self.mistakes.push(format!(
                        "\"{name}\", element {}: its points coincide, or axis 2 of the section lies along the line; \
                         give points that lie apart and another second axis",
                        element + 1
                    ));
                    return false;
                }
            }
        }
        let length = (0..count - 1).fold(0.0, |sum, i| sum + (line.points[i + 1] - line.points[i]).length().value());
        let mut start = None;
        for (end, point) in [(line.ends[0], line.points[0]), (line.ends[1], line.points[count - 1])] {
            if let End::Node(node) = end {
                self.check_given_node(name, node, (point, length), &mut start);
            }
        }
        self.mistakes.len() == mistakes
    }

    /// Sections are possible, and what their formulas take into account is topology: the same all along the beam.
    fn check_sections(&mut self, name: &str, elements: usize, section: &dyn Fn(f64) -> Section<S>) -> bool {
        let first = section(0.0).kind;
        let shares = (0..elements).flat_map(|element| {
            let share = move |xi: f64| (element as f64 + 0.5 * (xi + 1.0)) / elements as f64;
            TWO.into_iter().chain(THREE).map(share)
        });
        if let Some((share, why)) = shares.clone().find_map(|share| Some((share, section(share).mistake()?))) {
            self.mistakes.push(format!("the section of \"{name}\" at {share:.4} of its length: {why}"));
            return false;
        }
        let Some((share, other)) = shares.map(|share| (share, section(share).kind)).find(|(_, kind)| *kind != first) else {
            return true;
        };
        self.mistakes.push(format!(
            "the section of \"{name}\" is {first:?} at its start and {other:?} at {share:.4} of its length; make all its sections \
             with the same functions, an offset or a damping may be zero"
        ));
        false
    }

    /// A load for each length of a beam, `direction` times a function of time [N/m]: in the world, or turning with the sections
    /// (`direction` as at the start).
    pub fn distributed_load(
        &mut self,
        name: &str,
        beam: &BeamMember,
        (frame, direction): (LoadFrame, Vector3<S>),
        size: Signal<S>,
    ) {
        let keys = [&[("direction", direction.into())], &self.load_keys(name, frame, size)[..]].concat();
        self.load(entry(LOADS, "distributed_load"), &beam.carriers(name), &keys);
    }

    /// Gives nodes the velocities of a rigid motion: that of a world point [m/s] and the angular velocity in the world [rad/s].
    pub fn set_rigid_motion(&mut self, nodes: &[NodeId], point: Vector3<S>, velocity: Vector3<S>, omega: Vector3<S>) {
        for &node in nodes {
            if self.model.find_node(node).is_some_and(|node| node.fixed) {
                continue;
            }
            self.set_velocity(node, velocity + omega.cross(&(self.position(node) - point)), omega);
        }
    }

    /// A functional of a section force \[N\], moment [N m] or strain of a beam at a share of its length, from 0 to 1.
    pub fn section_functional(&mut self, name: &str, over: Over, beam: &BeamMember, share: f64, measure: SectionMeasure) {
        if measure == SectionMeasure::FibreStress {
            self.mistakes.push(format!("\"{name}\": the stress of a fibre needs its place: take fibre_stress_functional"));
            return;
        }
        self.add_section(name, over, (beam, share), measure, &[]);
    }

    /// A functional of the axial stress of a fibre at (x2, x3) \[m\] of a section, for Young's modulus E [N/m2].
    pub fn fibre_stress_functional(
        &mut self,
        name: &str,
        over: Over,
        (beam, share): (&BeamMember, f64),
        young: S,
        [x2, x3]: [S; 2],
    ) {
        self.add_section(name, over, (beam, share), SectionMeasure::FibreStress, &[young, x2, x3]);
    }

    fn add_section(
        &mut self,
        name: &str,
        over: Over,
        (beam, share): (&BeamMember, f64),
        measure: SectionMeasure,
        fibre: &[S],
    ) {
        let component = match measure {
            SectionMeasure::Force(i) | SectionMeasure::Strain(i) => i,
            SectionMeasure::FibreStress => 0,
        };
        if !(0.0..=1.0).contains(&share) || component >= STRAINS {
            let of = &beam.name;
            self.mistakes.push(format!(
                "\"{name}\" asks for component {component} at {share} of the length of \"{of}\"; components are 0 to 5, shares 0 to 1"
            ));
            return;
        }
        let places = places_at(share, beam.elements.len(), [-1.0, 1.0]);
        let own = TYING_POINTS * beam.field.tying_parameters();
        let (mut nodes, mut p) = (Vec::new(), Vec::new());
        for &(element, _) in &places {
            // a beam that was refused has been reported already
            let Some(&id) = beam.elements.get(element) else { return };
            let Some(parameters) = self.first_parameters(name, id, own) else { return };
            nodes.extend(beam.nodes_of(element));
            p.extend(parameters);
        }
        p.extend_from_slice(fibre);
        let places = places.into_iter().map(|(_, xi)| xi).collect();
        let quantity = SectionQuantity { measure, beam: beam.field, places };
        self.add_functional(name, over, (&nodes, &[]), quantity.into(), &p);
    }
}

/// Mass, first moment and inertia about the reference line of a section, for each length, in the frame of the given axes.
fn section_inertia<S: Scalar>(section: &Section<S>, axes: [Vector3<S>; 3]) -> [S; 10] {
    let [about_2, about_3, product] = section.inertia;
    let first = (axes[1] * section.centre[0] + axes[2] * section.centre[1]) * section.mass;
    // the tensor in section axes: its entry 23 is minus the product
    let own = [(0, 0, about_2 + about_3), (1, 1, about_2), (2, 2, about_3), (1, 2, -product), (2, 1, -product)];
    let entry = |i: usize, j: usize| own.iter().fold(S::zero(), |sum, &(k, l, value)| sum + axes[k][i] * axes[l][j] * value);
    let [x, y, z] = first.components();
    [section.mass, x, y, z, entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)]
}
