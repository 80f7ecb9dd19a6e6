use super::Placed;
use crate::elements::{Characteristic, NodeKind, TimeFunction};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};

/// The value of a key.
#[derive(Clone, Debug)]
pub enum GivenValue<S> {
    /// A number.
    Number(S),
    /// Several numbers.
    Numbers(Vec<S>),
    /// A vector of the world.
    Vector(Vector3<S>),
    /// Several vectors of the world.
    Vectors(Vec<Vector3<S>>),
    /// Axes of a frame in the world, as Euler parameters.
    Rotation(Quaternion<S>),
    /// A whole number.
    Count(usize),
    /// One of some words.
    Word(String),
    /// A function of time with its numbers.
    Function(TimeFunction, Vec<S>),
    /// A law of s, its rate and the time, with its numbers.
    Law(Characteristic, Vec<S>),
}

impl<S: Scalar> From<S> for GivenValue<S> {
    fn from(own: S) -> Self {
        GivenValue::Number(own)
    }
}

impl<S: Scalar> From<Vector3<S>> for GivenValue<S> {
    fn from(own: Vector3<S>) -> Self {
        GivenValue::Vector(own)
    }
}

impl<S: Scalar> From<[Vector3<S>; 2]> for GivenValue<S> {
    fn from(own: [Vector3<S>; 2]) -> Self {
        GivenValue::Vectors(own.to_vec())
    }
}

/// Values of keys by their names.
pub type Values<S> = Vec<(&'static str, GivenValue<S>)>;

/// A node with its name.
#[derive(Clone, Debug)]
struct GivenNode<S> {
    name: String,
    kind: NodeKind,
    q: Vec<S>,
}

/// What an entry makes its parameters of: nodes as they stand at the start, and the values of its keys. Mistakes are collected, so that
/// an entry reads without question marks; what is made after one is not used.
#[derive(Clone, Debug)]
pub struct Given<S> {
    owner: String,
    nodes: Vec<GivenNode<S>>,
    values: Values<S>,
    mistakes: Vec<(Option<&'static str>, String)>,
}

impl<S: Scalar> Given<S> {
    /// Nodes with their names, kinds and coordinates; values of keys.
    pub fn new<'n>(owner: &str, nodes: impl IntoIterator<Item = (&'n str, Placed<'n, S>)>, values: Values<S>) -> Self {
        let node = |(name, Placed { kind, q }): (&str, Placed<S>)| GivenNode { name: name.into(), kind, q: q.to_vec() };
        Given { owner: owner.into(), nodes: nodes.into_iter().map(node).collect(), values, mistakes: Vec::new() }
    }

    /// What was wrong, with the key where that is one of it.
    pub fn mistakes(self) -> Vec<(Option<&'static str>, String)> {
        self.mistakes
    }

    /// Something is wrong with what was given.
    pub fn wrong(&mut self, what: String) {
        self.mistakes.push((None, what));
    }

    /// Something is wrong with a key.
    pub fn wrong_key(&mut self, key: &'static str, what: String) {
        self.mistakes.push((Some(key), what));
    }

    /// The name of what is made.
    pub fn owner(&self) -> &str {
        &self.owner
    }

    /// The name of a node.
    pub fn name(&self, node: usize) -> &str {
        &self.nodes[node].name
    }

    /// A node as it stands.
    pub fn node(&self, node: usize) -> Placed<'_, S> {
        let GivenNode { kind, q, .. } = &self.nodes[node];
        Placed { kind: *kind, q }
    }

    /// Places of all nodes \[m\].
    pub fn positions(&self) -> Vec<Vector3<S>> {
        (0..self.nodes.len()).map(|node| self.node(node).position()).collect()
    }

    /// All nodes must be of a kind, as those of `what` are.
    pub fn all_are(&mut self, kind: NodeKind, what: &str) {
        let others = self.nodes.iter().filter(|node| node.kind != kind);
        let told = others.map(|own| format!("\"{}\" needs nodes of {what}, but node \"{}\" is none", self.owner, own.name));
        told.collect::<Vec<_>>().into_iter().for_each(|text| self.wrong(text));
    }

    /// The kind of a node that must be a body.
    pub fn body(&mut self, node: usize) -> NodeKind {
        let kind = self.nodes[node].kind;
        if kind.has_axes() {
            return kind;
        }
        let (owner, name) = (&self.owner, &self.nodes[node].name);
        self.wrong(format!(
            "\"{owner}\" needs a body, which has axes, but node \"{name}\" is none: make it a body, or take a joint for points"
        ));
        NodeKind::Body
    }

    /// The kind of a node that must have a place in space.
    pub fn in_space(&mut self, node: usize) -> NodeKind {
        self.nodes[node].kind.in_space().unwrap_or_else(|| {
            let (owner, name) = (&self.owner, &self.nodes[node].name);
            self.wrong(format!("\"{owner}\" needs a point or a body, but node \"{name}\" is neither"));
            NodeKind::Point
        })
    }

    /// Kinds of two nodes that must be bodies.
    pub fn bodies(&mut self) -> [NodeKind; 2] {
        [self.body(0), self.body(1)]
    }

    /// Kinds of a body, and of anything that has a place in space.
    pub fn body_and_guided(&mut self) -> [NodeKind; 2] {
        [self.body(0), self.in_space(1)]
    }

    fn value(&self, key: &str) -> Option<&GivenValue<S>> {
        self.values.iter().find(|own| own.0 == key).map(|own| &own.1)
    }

    /// Whether a key is given.
    pub fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    fn missing<T>(&mut self, key: &'static str, what: &str, instead: T) -> T {
        let text = format!("\"{}\" needs {what} for {key}", self.owner);
        self.wrong_key(key, text);
        instead
    }

    /// What a key is without being given; a mistake where it has a value that is not `what`.
    fn without<T>(&mut self, key: &'static str, what: &str, value: T) -> T {
        if self.has(key) { self.missing(key, what, value) } else { value }
    }

    /// A number.
    pub fn number(&mut self, key: &'static str) -> S {
        match self.value(key) {
            Some(GivenValue::Number(own)) => *own,
            _ => self.missing(key, "a number", S::one()),
        }
    }

    /// As many numbers.
    pub fn numbers<const N: usize>(&mut self, key: &'static str) -> [S; N] {
        let own = match self.value(key) {
            Some(GivenValue::Numbers(own)) => own.clone().try_into().ok(),
            _ => None,
        };
        own.unwrap_or_else(|| self.missing(key, &format!("{N} numbers"), [S::one(); N]))
    }

    /// A number, or what it is without the key.
    pub fn number_or(&mut self, key: &'static str, without: S) -> S {
        if self.has(key) { self.number(key) } else { without }
    }

    /// As many numbers, zeros without the key.
    pub fn numbers_or_zero<const N: usize>(&mut self, key: &'static str) -> [S; N] {
        if self.has(key) { self.numbers(key) } else { [S::zero(); N] }
    }

    /// A whole number, 0 without the key.
    pub fn count(&mut self, key: &'static str) -> usize {
        match self.value(key) {
            Some(GivenValue::Count(own)) => *own,
            _ => self.without(key, "a whole number", 0),
        }
    }

    /// Axes of a frame, those of the world without the key.
    pub fn rotation(&mut self, key: &'static str) -> Quaternion<S> {
        match self.value(key) {
            Some(GivenValue::Rotation(own)) => *own,
            _ => self.without(key, "axes of a frame", Quaternion::identity()),
        }
    }

    /// A vector of the world.
    pub fn vector(&mut self, key: &'static str) -> Vector3<S> {
        match self.value(key) {
            Some(GivenValue::Vector(own)) => *own,
            _ => self.missing(key, "a vector", Vector3::from_f64([1.0, 0.0, 0.0])),
        }
    }

    /// A vector of the world, or what it is without the key.
    pub fn vector_or(&mut self, key: &'static str, without: Vector3<S>) -> Vector3<S> {
        if self.has(key) { self.vector(key) } else { without }
    }

    /// The kind of the first node, and which of its coordinates the key `index` means.
    pub fn coordinate(&mut self) -> (NodeKind, usize) {
        let (kind, index) = (self.nodes[0].kind, self.count("index"));
        let count = kind.dofs();
        if index >= count {
            let (owner, own) = (&self.owner, &self.nodes[0].name);
            let text = format!("\"{owner}\" asks for coordinate {index} of \"{own}\", which has {count}: count from 0");
            self.wrong_key("index", text);
        }
        (kind, index)
    }

    /// A vector of length one along a direction.
    pub fn unit(&mut self, key: &'static str) -> Vector3<S> {
        let direction = self.vector(key);
        self.unit_of(direction)
    }

    /// A vector of length one along a direction.
    pub fn unit_of(&mut self, direction: Vector3<S>) -> Vector3<S> {
        let length = direction.length().value();
        if length > 0.0 && length.is_finite() {
            return direction.unit();
        }
        let (owner, components) = (&self.owner, direction.components().map(Scalar::value));
        self.wrong(format!("\"{owner}\": a direction cannot be {components:?}; give a vector of any length but zero"));
        Vector3::from_f64([1.0, 0.0, 0.0])
    }

    /// A world point \[m\] on a node; without the key the place of the node.
    pub fn point(&mut self, key: &'static str, node: usize) -> Vector3<S> {
        match self.value(key) {
            Some(GivenValue::Vector(own)) => self.on_node(key, node, *own),
            _ => self.without(key, "a vector", self.node(node).position()),
        }
    }

    /// World points \[m\], one on each of both nodes; without the key their places.
    pub fn points(&mut self, key: &'static str) -> [Vector3<S>; 2] {
        match self.value(key) {
            Some(GivenValue::Vectors(own)) => match own[..] {
                [a, b] => [self.on_node(key, 0, a), self.on_node(key, 1, b)],
                _ => {
                    let text = format!("{key} has {} places; give two, one on each node", own.len());
                    self.wrong_key(key, text);
                    [Vector3::zeros(); 2]
                }
            },
            _ => self.without(key, "two vectors", [0, 1].map(|node| self.node(node).position())),
        }
    }

    /// A world point that a key gives on a node.
    fn on_node(&mut self, key: &'static str, node: usize, point: Vector3<S>) -> Vector3<S> {
        if let Err(text) = self.node(node).check_point(self.name(node), point) {
            self.wrong_key(key, text);
        }
        point
    }

    /// Whether a key says this word.
    pub fn says(&mut self, key: &'static str, word: &str) -> bool {
        match self.value(key) {
            Some(GivenValue::Word(own)) => own == word,
            _ => self.without(key, "a word", false),
        }
    }

    /// A law with its numbers, if the key is given.
    pub fn law(&mut self, key: &'static str) -> Option<(Characteristic, Vec<S>)> {
        let (law, numbers) = match self.value(key) {
            Some(GivenValue::Law(law, numbers)) => (law.clone(), numbers.clone()),
            _ => return self.without(key, "a law", None),
        };
        let [wanted, count] = [law.parameters().len(), numbers.len()];
        if wanted != count {
            self.wrong_key(key, format!("the law has {wanted} parameters, but {count} numbers were given"));
            return None;
        }
        Some((law, numbers))
    }

    /// A function of time with its numbers.
    pub fn function(&mut self, key: &'static str) -> (TimeFunction, Vec<S>) {
        match self.value(key) {
            Some(GivenValue::Function(function, numbers)) => (function.clone(), numbers.clone()),
            _ => self.missing(key, "a function of time", (TimeFunction::Constant, vec![S::zero()])),
        }
    }

    /// World points on two nodes in their frames.
    pub fn local_points(&self, nodes: [usize; 2], [a, b]: [Vector3<S>; 2]) -> Vec<S> {
        [self.node(nodes[0]).local_point(a), self.node(nodes[1]).local_point(b)].map(|own| own.components()).concat()
    }

    /// World directions in the frame of a node.
    pub fn local_directions<const N: usize>(&self, node: usize, directions: [Vector3<S>; N]) -> Vec<S> {
        directions.into_iter().flat_map(|own| self.node(node).local_direction(own).components()).collect()
    }

    /// Two unit vectors of a at right angles to a world axis, and the axis in b: what guides along or about an axis.
    pub fn guide(&self, axis: Vector3<S>) -> Vec<S> {
        [self.local_directions(0, axis.perpendiculars()), self.local_directions(1, [axis])].concat()
    }

    /// The key `point` in both frames, and what guides along or about the axis or normal of a key.
    pub fn point_and_guide(&mut self, axis: &'static str) -> Vec<S> {
        let (point, axis) = (self.point("point", 1), self.unit(axis));
        [self.local_points([0, 1], [point; 2]), self.guide(axis)].concat()
    }

    /// The key `point` in both frames, and the direction of a key in that of the first node.
    pub fn point_and_direction(&mut self, direction: &'static str) -> Vec<S> {
        let (point, direction) = (self.point("point", 1), self.unit(direction));
        [self.local_points([0, 1], [point; 2]), self.local_directions(0, [direction])].concat()
    }

    /// Axis and zero mark in the frame of the first node and zero mark in that of the second, for an angle that is zero as they stand.
    pub fn angle_frame(&self, axis: Vector3<S>) -> Vec<S> {
        let [mark, _] = axis.perpendiculars();
        [self.local_directions(0, [axis, mark]), self.local_directions(1, [mark])].concat()
    }

    /// Euler parameters of b relative to a.
    pub fn relative_rotation(&self) -> Quaternion<S> {
        self.node(0).rotation().conjugate().times(self.node(1).rotation())
    }

    /// Stiffness, damping, and where the spring is free.
    pub fn spring_damper(&mut self, rest: &'static str) -> Vec<S> {
        vec![self.number("stiffness"), self.number_or("damping", S::zero()), self.number_or(rest, S::zero())]
    }

    /// By how many degrees two unit vectors are apart, unless they are at right angles.
    pub fn angle_if_not_right(a: Vector3<S>, b: Vector3<S>) -> Option<f64> {
        let cosine = a.dot(&b).value();
        (cosine.abs() > crate::tolerances::CONSISTENT).then(|| cosine.clamp(-1.0, 1.0).acos().to_degrees())
    }
}
