//! Formulas of nodes, of which a file makes elements, states, joints and functionals.

use super::entry_context::{Builder, Entry, EntryContext, Result};
use super::fields::{NamedNode, Value};
use super::formula::{Formula, Law, Quantity};
use super::keys::one_form;
use super::mistake::Mistake;
use super::section::OfNode;
use super::tables::TABLE;
use crate::assembly::NodeId;
use crate::elements::entries::Type::{Fixed, Node, Vector};
use crate::elements::entries::{self, Forms, Key, Type, at_least, may, need};
use crate::elements::{Frame, NodeKind, Output, Parameter};
use crate::program::Recorded;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

const POINT_OF_NODE: Forms = one_form![
    need("on", Node, "node"),
    need("point", Vector("m"), "point of the node, in the world at the start: place, velocity and force are those there"),
];
pub(super) const NAMED_NODES: Type = Type::NamedNodes(&POINT_OF_NODE);
pub(super) const NODES: Key =
    need("nodes", NAMED_NODES, "nodes, or points of them, by the names that the formulas give them");
pub(super) const DEFINITIONS: Key = may(
    "define",
    Type::Definitions,
    "names for formulas that the other formulas here use, later ones those before them; none",
);
pub(super) const OWN_TABLES: Key =
    may("table", Type::NamedTables(&TABLE), "tables that the formulas here call by their names, as those of [table]; none");
pub(super) const BREAKPOINTS: Key = may(
    "breakpoints",
    at_least(0, &Fixed("s", entries::Range::Any)),
    "from the times when jumps and bends of formulas of t were not found from these: not needed, any",
);

/// What histories tell of a formula: its number, or the components of its vector.
pub(super) fn outputs_of(name: &str, unit: &'static str, is_vector: bool) -> Vec<Output> {
    match is_vector {
        false => vec![Output::new(name.to_string(), unit)],
        true => ["x", "y", "z"].map(|axis| Output::new(format!("{name}_{axis}"), unit)).into(),
    }
}

pub(super) const OF_POINT: &[OfNode] = &[("position", true, false), ("velocity", true, true)];
pub(super) const OF_BODY: &[OfNode] = &[
    OF_POINT[0],
    OF_POINT[1],
    ("x_axis", true, false),
    ("y_axis", true, false),
    ("z_axis", true, false),
    ("angular_velocity", true, true),
];
pub(super) const OF_COORDINATE: &[OfNode] = &[("value", false, false), ("rate", false, true)];

/// A node as formulas know it.
#[derive(Clone, Copy, Hash)]
pub(super) struct KnownNode {
    pub kind: NodeKind,
    /// Place, velocity and force are those of a point of it.
    pub has_point: bool,
}

impl KnownNode {
    /// What formulas know of it.
    fn known(self) -> Vec<OfNode> {
        match self.kind {
            NodeKind::States(count) => vec![("state", false, true); count],
            NodeKind::Body | NodeKind::Natural => OF_BODY.into(),
            NodeKind::Point | NodeKind::Slope => OF_POINT.into(),
            NodeKind::Coordinates(_) => OF_COORDINATE.into(),
        }
    }
}

/// Formulas of nodes. Parameters: the points of nodes in their frames, where they have one, then those of each formula.
#[derive(Hash)]
pub(super) struct Formulas {
    pub nodes: Vec<KnownNode>,
    pub all: Vec<Law>,
}

impl Formulas {
    pub fn parameters(&self) -> Vec<Parameter> {
        let axes = ["x", "y", "z"];
        let points = (1..=self.points()).flat_map(|i| axes.map(|axis| Parameter::named(format!("point {i} {axis}"), "m")));
        let numbered = (1..).zip(&self.all);
        points.chain(numbered.flat_map(|(number, own)| own.numbers(&format!("formula {number}")))).collect()
    }
    fn points(&self) -> usize {
        self.nodes.iter().filter(|node| node.has_point).count()
    }
    pub fn point<S: Scalar>(&self, node: usize, p: &[S]) -> Vector3<S> {
        match self.nodes[node].has_point {
            true => Vector3::first_three(&p[3 * self.nodes[..node].iter().filter(|node| node.has_point).count()..]),
            false => Vector3::zeros(),
        }
    }
    /// What formulas know of all nodes, and the time behind it.
    pub fn arguments<S: Scalar>(&self, [v, q]: [&[S]; 2], t: S, p: &[S]) -> Vec<S> {
        let mut all = Vec::new();
        for (node, &KnownNode { kind, .. }) in self.nodes.iter().enumerate() {
            let (v, q) = (&v[self.place(node)], &q[self.place(node)]);
            match kind {
                NodeKind::States(_) => all.extend_from_slice(v),
                NodeKind::Coordinates(_) => all.extend([q[0], v[0]]),
                _ => {}
            }
            if kind.in_space().is_none() {
                continue;
            }
            let point = self.point(node, p);
            let mut vectors = vec![kind.position(q, point), kind.velocity(v, q, point)];
            if kind.has_axes() {
                vectors.extend(Frame::of(kind, q).axes);
                vectors.push(kind.angular_velocity(v, q));
            }
            all.extend(vectors.into_iter().flat_map(SpatialVector::components));
        }
        all.push(t);
        all
    }
    pub fn kinds(&self) -> Vec<NodeKind> {
        self.nodes.iter().map(|node| node.kind).collect()
    }
    pub fn dofs(&self) -> usize {
        self.nodes.iter().map(|node| node.kind.dofs()).sum()
    }
    pub fn value<S: Scalar>(&self, which: usize, arguments: &[S], p: &[S]) -> Quantity<S> {
        let before: usize = self.all[..which].iter().map(|own| own.count).sum();
        self.all[which].at(arguments, &p[3 * self.points() + before..])
    }
    pub fn number<S: Scalar>(&self, which: usize, arguments: &[S], p: &[S]) -> S {
        self.value(which, arguments, p).number()
    }
    /// The numbers of all formulas, one behind the other.
    pub fn numbers<'a, S: Scalar>(&'a self, arguments: &'a [S], p: &'a [S]) -> impl Iterator<Item = S> + 'a {
        (0..self.all.len()).flat_map(|which| self.value(which, arguments, p).components())
    }
    /// Places of the coordinates of a node.
    pub fn place(&self, node: usize) -> Range<usize> {
        let first: usize = self.nodes[..node].iter().map(|node| node.kind.dofs()).sum();
        first..first + self.nodes[node].kind.dofs()
    }
}

/// The nodes of formulas, and the formulas as they are read.
pub(super) struct Reading<'f> {
    context: &'f EntryContext<'f>,
    pub names: Vec<&'f str>,
    pub nodes: Vec<NodeId>,
    pub formulas: Formulas,
    /// Parameters of points and formulas.
    pub p: Vec<Recorded>,
}

impl<'f> Reading<'f> {
    pub fn new(e: Entry<'f>, m: &mut Builder) -> Result<Self> {
        let given: &[_] = match e.fields.get("nodes") {
            Some((_, Value::NamedNodes(given))) => given,
            _ => &[],
        };
        // these were read with the formulas
        ["define", "table", "breakpoints"].iter().for_each(|key| _ = e.get(key));
        let formulas = Formulas { nodes: Vec::new(), all: Vec::new() };
        let mut own = Reading { context: e.context, names: Vec::new(), nodes: Vec::new(), formulas, p: Vec::new() };
        for NamedNode { name, at, place, point } in given {
            let [node] = e.nodes_at(*at, place, m)?[..] else {
                return Err(Mistake::new(*at, "one node is wanted"));
            };
            let kind = m.model.find_node(node).map(|own| own.kind);
            own.add(name, node, kind.ok_or_else(|| Mistake::new(*at, "this is no node"))?);
            if let Some(point) = point {
                own.add_point(*at, point, m)?;
            }
        }
        Ok(own)
    }

    pub fn add(&mut self, name: &'f str, node: NodeId, kind: NodeKind) {
        self.names.push(name);
        self.nodes.push(node);
        self.formulas.nodes.push(KnownNode { kind, has_point: false });
    }

    fn add_point(&mut self, at: usize, point: &Formula, m: &Builder) -> Result<()> {
        if point.uses_from(self.context.numbers.len()) {
            return Err(Mistake::new(at, "a point is one of the start, which depends on the design alone"));
        }
        let (Some(node), Some(&id)) = (self.formulas.nodes.last_mut(), self.nodes.last()) else { return Ok(()) };
        let place = point.value(|place| self.context.numbers[place]).vector();
        if !node.kind.has_axes() {
            return Err(Mistake::new(at, format!("this is {}, which has no points but itself", node.kind.words())));
        }
        node.has_point = true;
        self.p.extend(m.local_point(id, place).components());
        Ok(())
    }

    /// Takes a formula, which may depend on rates and on the time or not, and returns its number.
    pub fn take(&mut self, at: usize, formula: &Formula, [rates, time]: [bool; 2]) -> Result<usize> {
        let mut place = self.context.numbers.len();
        for (name, node) in self.names.iter().zip(&self.formulas.nodes) {
            for (what, is_vector, is_rate) in node.known() {
                let next = place + if is_vector { 3 } else { 1 };
                if is_rate && !rates && formula.taken().iter().any(|own| (place..next).contains(own)) {
                    return Err(Mistake::new(at, format!("this depends on places alone: {name}.{what} cannot stand here")));
                }
                place = next;
            }
        }
        if !time && formula.taken().contains(&place) {
            return Err(Mistake::new(at, "this cannot depend on the time t; a force can"));
        }
        Ok(self.add_formula(formula))
    }

    /// Takes a formula of anything, and returns its number.
    pub fn add_formula(&mut self, formula: &Formula) -> usize {
        let (own, numbers) = formula.law(&self.context.numbers);
        self.formulas.all.push(own);
        self.p.extend(numbers);
        self.formulas.all.len() - 1
    }

    /// Takes the formula of a key, if it is given.
    pub fn take_key(&mut self, e: Entry, key: &str, may: [bool; 2]) -> Result<Option<usize>> {
        match e.get(key) {
            Some((at, Value::Formula(formula, _))) => self.take(at, formula, may).map(Some),
            _ => Ok(None),
        }
    }
}
