use super::builder::{MechanismBuilder, OutlinedLine};
use crate::assembly::NodeId;
use crate::elements::{NodeKind, Parameter};
use crate::functionals::Measured;
use crate::scalar::{Quaternion, SpatialVector, Vector3};
use std::ops::Range;

/// A point that moves with a node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodePoint {
    dofs: Range<usize>,
    kind: NodeKind,
    fixed: bool,
    /// In the frame of the body \[m\]; zero for other nodes.
    local: [f64; 3],
}

impl NodePoint {
    /// Its place in the world \[m\] at coordinates `q` of the whole mechanism.
    pub fn at(&self, q: &[f64]) -> [f64; 3] {
        self.kind.position(&q[self.dofs.clone()], Vector3::from(self.local)).components()
    }
    /// First coordinate of its node and the bits of its place there: the same for equal points alone.
    pub fn identity(&self) -> (usize, [u64; 3]) {
        (self.dofs.start, self.local.map(f64::to_bits))
    }
    /// Coordinates of its node among those of the whole mechanism.
    pub fn coordinates<'q>(&self, q: &'q [f64]) -> &'q [f64] {
        &q[self.dofs.clone()]
    }
    /// A vector of its frame in the world.
    pub fn turned(&self, q: &[f64], vector: [f64; 3]) -> [f64; 3] {
        let axes = self.kind.axes(self.coordinates(q));
        let sum = axes.into_iter().zip(vector).fold(Vector3::zeros(), |sum, (axis, part)| sum + axis * part);
        sum.components()
    }
    /// Rotation vector from one pose of the node to another, in world components \[rad\]; zero for nodes without axes.
    pub fn rotation(&self, from: &[f64], to: &[f64]) -> [f64; 3] {
        let [before, after] = [from, to].map(|q| Quaternion::of_columns(&self.kind.axes(self.coordinates(q))));
        let (real, vector) = after.times(before.conjugate()).parts();
        let length = vector.length();
        // the shorter way around
        let angle = 2.0 * if real < 0.0 { f64::atan2(-length, -real) } else { f64::atan2(length, real) };
        let scale = if length > 0.0 { angle / length } else { 2.0 };
        (vector * scale).components()
    }
}

/// What a line of a picture stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// A line that the scene drew with a body or the ground, a beam or a cable.
    Body,
    /// A line between the elements of a shell, which its surface shows as well.
    Shell,
    /// An edge of a solid, which its surface shows as well.
    Solid,
    /// A part between two points: spring, damper, link.
    Link,
}

/// Lines, fixed points and points to follow of a mechanism: enough for a picture at any coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// Lines and what they stand for.
    pub lines: Vec<(Drawn, Vec<NodePoint>)>,
    /// Points that hold the mechanism to the ground \[m\].
    pub anchors: Vec<[f64; 3]>,
    /// Points whose path is of interest, with their names.
    pub followed: Vec<(String, NodePoint)>,
}

impl MechanismBuilder<f64> {
    /// The mechanism as lines: its drawings, a line for every part between two points that lie apart at the start, anchors where
    /// joints and links meet the ground, and the points of functionals and point nodes to follow.
    #[doc(hidden)]
    pub fn sketch(&self) -> Sketch {
        let mut sketch = Sketch::default();
        let nodes = (0..self.model.nodes.len()).map(|index| self.model.node_id(index));
        let places = nodes.filter_map(|node| Some(self.node_point(node, [0.0; 3])?.at(&self.numbers.q)));
        let near = crate::tolerances::CONSISTENT * places.flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
        for drawing in &self.drawings {
            let points: Vec<_> = drawing.points.iter().filter_map(|&(node, point)| self.node_point(node, point)).collect();
            match &points[..] {
                [only] if only.fixed => sketch.add_anchor(only.at(&self.numbers.q)),
                [_, _, ..] => sketch.lines.push((drawing.drawn, points)),
                _ => {}
            }
        }
        for solid in &self.solids {
            let point = |place| self.node_point(solid.node, place);
            let lines = solid.facets.few_lines().into_iter();
            sketch.lines.extend(lines.map(|line| (Drawn::Solid, line.into_iter().filter_map(point).collect())));
        }
        let elements = self.model.elements.iter().map(|e| (&e.nodes, e.parameters.clone(), e.physics.parameter_list()));
        let joints = self.model.constraints.iter().filter(|c| !c.physics.is_driver());
        let joints = joints.map(|c| (&c.nodes, c.parameters.clone(), c.physics.parameter_list()));
        for (nodes, places, parameters) in elements.chain(joints) {
            let &[a, b] = &nodes[..] else { continue };
            let end = |node, name| self.node_point(node, self.named_vector(&parameters, places.clone(), name)?);
            if let (Some(from), Some(to)) = (end(a, "point a"), end(b, "point b")) {
                sketch.add_link(from, to, &self.numbers.q, near);
            }
        }
        for functional in &self.functionals {
            if let Measured::Local { nodes, parameters, quantity, .. } = &functional.measured
                && let (&[node], list) = (&nodes[..], quantity.parameter_list())
                && let Some(local) = self.named_vector(&list, parameters.clone(), "point")
                && let Some(point) = self.node_point(node, local)
            {
                sketch.follow(self.point_name(node, &point, near), point);
            }
        }
        for node in self.model.nodes.iter().filter(|node| node.kind == NodeKind::Point) {
            let (dofs, kind) = (node.dofs.clone(), NodeKind::Point);
            sketch.follow(node.name.clone(), NodePoint { dofs, kind, fixed: node.fixed, local: [0.0; 3] });
        }
        if sketch.followed.is_empty() {
            // of a beam its ends
            let lines = self.drawings.iter().filter(|drawing| drawing.joins_nodes());
            let inner: Vec<NodeId> =
                lines.flat_map(|line| &line.points[1..line.points.len() - 1]).map(|corner| corner.0).collect();
            for index in (0..self.model.nodes.len()).filter(|&index| !inner.contains(&self.model.node_id(index))) {
                if let Some(point) = self.node_point(self.model.node_id(index), [0.0; 3]) {
                    sketch.follow(self.point_name(self.model.node_id(index), &point, near), point);
                }
            }
        }
        sketch
    }

    /// The name of the node with which a point moves.
    pub(crate) fn node_of(&self, point: &NodePoint) -> &str {
        // coordinates of nodes follow each other
        let first = self.model.nodes.partition_point(|node| node.dofs.end <= point.dofs.start);
        let own = self.model.nodes.get(first).filter(|node| node.dofs.start == point.dofs.start);
        own.map_or("", |node| &node.name)
    }

    /// What a point is called: its node where it is near, or a point on that.
    fn point_name(&self, node: NodeId, point: &NodePoint, near: f64) -> String {
        if point.local.iter().any(|x| x.abs() > near) {
            return format!("point on {}", self.model.nodes[node.0].name);
        }
        self.label(node)
    }

    /// What a node is called where curves are read: by its name, or as the end of a beam or cable that made it for itself.
    #[doc(hidden)]
    pub fn label(&self, node: NodeId) -> String {
        let ends = |line: &OutlinedLine| {
            let [first, last] = [line.rings.first()?, line.rings.last()?].map(|ring| ring.node);
            let end = if last == node { "end" } else { "start" };
            (first == node || last == node).then(|| format!("{end} of {}", line.name))
        };
        let of_member = self.nodes_of_members.contains(&node).then(|| self.outlined.iter().find_map(ends)).flatten();
        of_member.unwrap_or_else(|| self.model.nodes[node.0].name.clone())
    }

    /// A place in the frame of a node \[m\]; `None` for a node without a place in space.
    #[doc(hidden)]
    pub fn node_point(&self, node: NodeId, local: [f64; 3]) -> Option<NodePoint> {
        let node = &self.model.nodes[node.0];
        let kind = node.kind.in_space()?;
        let local = if kind.has_axes() { local } else { [0.0; 3] };
        Some(NodePoint { dofs: node.dofs.clone(), kind, fixed: node.fixed, local })
    }

    /// The three parameters `name x`, `name y`, `name z`.
    pub(super) fn named_vector(&self, parameters: &[Parameter], places: Range<usize>, name: &str) -> Option<[f64; 3]> {
        let first = parameters.iter().position(|parameter| parameter.name == format!("{name} x"))?;
        let values = self.numbers.p[places].get(first..first + 3)?;
        Some([values[0], values[1], values[2]])
    }
}

impl Sketch {
    fn add_anchor(&mut self, place: [f64; 3]) {
        if !self.anchors.contains(&place) {
            self.anchors.push(place);
        }
    }

    fn add_link(&mut self, from: NodePoint, to: NodePoint, q: &[f64], near: f64) {
        for end in [&from, &to].into_iter().filter(|end| end.fixed) {
            self.add_anchor(end.at(q));
        }
        let (a, b) = (from.at(q), to.at(q));
        let apart = a.iter().zip(b).any(|(a, b)| (a - b).abs() > near);
        let line = (Drawn::Link, vec![from, to]);
        // a spring and a damper side by side are one line
        if apart && !self.lines.contains(&line) {
            self.lines.push(line);
        }
    }

    fn follow(&mut self, name: String, point: NodePoint) {
        if point.fixed || self.followed.iter().any(|(_, known)| *known == point) {
            return;
        }
        let known = |name: &str| self.followed.iter().any(|(own, _)| own == name);
        let numbered = (2..).map(|number| format!("{name} ({number})")).find(|numbered| !known(numbered));
        let name = if known(&name) { numbered.unwrap_or(name) } else { name };
        self.followed.push((name, point));
    }
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;
    use crate::elements::flexible::Section;
    use crate::scenes::{AnyScene, BeamLine, Signal, built_in};

    fn mechanism(name: &str) -> MechanismBuilder<f64> {
        let scene = built_in::named(name).unwrap();
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        scene.build_real(&x).unwrap()
    }

    #[test]
    fn the_five_bar_is_four_bars_and_two_springs_between_two_anchors() {
        let five_bar = mechanism("five-bar");
        let sketch = five_bar.sketch();
        let count = |kind| sketch.lines.iter().filter(|line| line.0 == kind).count();
        assert_eq!([count(Drawn::Body), count(Drawn::Link)], [4, 2]);
        assert_eq!(sketch.anchors, [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
        let [(name, point)] = &sketch.followed[..] else { panic!("{:?}", sketch.followed) };
        assert_eq!(name, "point on bar 2");
        let tip = point.at(&five_bar.numbers.q);
        assert!(tip.iter().zip([0.0, 2.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{tip:?}");
    }

    #[test]
    fn drivers_measure_from_places_where_no_ground_is() {
        let mut m = MechanismBuilder::<f64>::default();
        let (ground, wheel, hub) = (m.ground(), m.point("wheel", Vector3::x()), Vector3::x());
        m.point_mass("wheel", wheel, 1.0);
        let road = Signal::ConstantRate { offset: 0.0, rate: 1.0 };
        m.prescribed_translation("road", [ground, wheel], [Vector3::zeros(), hub], Vector3::y(), road);
        let sketch = m.finish().unwrap().sketch();
        assert!(sketch.anchors.is_empty() && sketch.lines.is_empty(), "{sketch:?}");
    }

    #[test]
    fn trails_are_called_by_what_they_follow() {
        let mut m = MechanismBuilder::<f64>::default();
        let line = BeamLine::straight([Vector3::zeros(), Vector3::x()], 2, Vector3::y());
        let beam = m.beam("arm", line, &Section::new([1.0; 6]));
        let body = m.body("rod", Vector3::x(), Quaternion::identity());
        m.rigid_body("rod", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let over = crate::functionals::Over::Terminal;
        let places = [(beam.end(), 1.0), (beam.nodes[1], 0.25), (body, 1.0), (body, 2.0), (body, 3.0)];
        for (number, (node, x)) in places.into_iter().enumerate() {
            m.position_functional(&format!("{number}"), over, node, Vector3::new(x, 0.0, 0.0), Vector3::y());
        }
        let names: Vec<String> = m.finish().unwrap().sketch().followed.into_iter().map(|own| own.0).collect();
        assert_eq!(names, ["end of arm", "arm[1]", "rod", "point on rod", "point on rod (2)"]);
    }

    #[test]
    fn lines_of_shells_are_told_from_others_on_the_same_nodes() {
        let mut plate = mechanism("plate-pendulum");
        let points = plate.drawings[0].points.clone();
        plate.drawings.push(crate::scenes::builder::Drawing { drawn: Drawn::Body, points });
        let kinds: Vec<Drawn> = plate.sketch().lines.into_iter().map(|(drawn, _)| drawn).collect();
        // five elements along and one across
        assert_eq!(kinds, [vec![Drawn::Shell; 8], vec![Drawn::Body]].concat());
    }
}
