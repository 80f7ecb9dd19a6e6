use super::{Event, JointFriction};
use crate::elements::{AnyConstraint, AnyElement, ConstraintPhysics, ElementPhysics, NodeKind};
use crate::program::Formula;
use std::any::TypeId;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Tells models apart, so that what belongs to one is not taken for a part of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[doc(hidden)]
pub struct ModelIdentity(u64);

impl Default for ModelIdentity {
    /// One that no other model has.
    fn default() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        ModelIdentity(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// A node of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub(crate) usize, pub(crate) ModelIdentity);
/// An element of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub(crate) usize, pub(crate) ModelIdentity);
/// A constraint of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConstraintId(#[doc(hidden)] pub usize, #[doc(hidden)] pub ModelIdentity);

/// A set of coordinates with a name.
#[derive(Clone)]
pub struct Node {
    /// Name for messages and output.
    pub name: String,
    /// Meaning of the coordinates.
    pub kind: NodeKind,
    /// True for ground: its coordinates never move.
    pub fixed: bool,
    /// Place of its coordinates in q, v and a.
    pub dofs: Range<usize>,
}

/// An element or constraint with its name, nodes and parameters.
#[derive(Clone)]
pub struct Attached<P> {
    /// Name for messages and output.
    pub name: String,
    /// The nodes, in the order in which it sees their coordinates.
    pub nodes: Vec<NodeId>,
    /// Place of its parameters in p.
    pub parameters: Range<usize>,
    /// Place of its equations in mu; empty for elements.
    pub equations: Range<usize>,
    /// The physics.
    pub physics: P,
}

/// Nodes that turn steadily about an axis of the world.
#[derive(Clone)]
pub struct Spin {
    /// The nodes.
    pub nodes: Vec<NodeId>,
    /// GatherMap in p of a point of the axis \[m\], its direction, and the rate of the turn [rad/s].
    pub parameters: Range<usize>,
}

/// The topology of a mechanism: nodes, elements and constraints, without any physical number.
///
/// A clone is the same model: what belongs to one belongs to the other.
#[derive(Clone, Default)]
pub struct Model {
    /// Nodes, in the order of their coordinates.
    pub nodes: Vec<Node>,
    /// Bodies, springs, loads.
    pub elements: Vec<Attached<ElementPhysics>>,
    /// Joints and drivers.
    pub constraints: Vec<Attached<ConstraintPhysics>>,
    /// What holds parts while the equilibrium at the start is found, and lets them go then; their equations are counted by `Model::at_rest`.
    pub holds: Vec<Attached<ConstraintPhysics>>,
    /// Formulas of functionals whose switches steps end at, with the sides behind their parameters.
    pub(crate) measured: Vec<Attached<Arc<Formula>>>,
    /// What happens at instants of the motion.
    pub(crate) events: Vec<Event>,
    /// Joints with friction.
    pub(crate) frictions: Vec<JointFriction>,
    /// Their limits for a load of 1 N, in which steps look for jumps and bends over time.
    pub(crate) limits_of_friction: Vec<Attached<Arc<Formula>>>,
    /// Joints that come and go, and whether they are there at the start.
    pub(crate) presence: Vec<(usize, bool)>,
    /// What turns steadily where a motion begins.
    pub spin: Option<Spin>,
    /// States of first order stand in q, their rates in v, as at rest.
    pub(crate) states_are_coordinates: bool,
    /// Length of q.
    pub dofs: usize,
    /// Length of mu.
    pub equations: usize,
    /// Length of p.
    pub parameters: usize,
    /// Elements of types that have no options.
    without_options: HashMap<TypeId, ElementPhysics>,
    identity: ModelIdentity,
}

impl Model {
    /// Whether its energy is constant in every exact motion: no loss, no force beside energies, no drive, no event, no rolling contact (which may
    /// be conservative, but does not tell).
    pub fn is_conservative(&self) -> bool {
        let elements = self.elements.iter().all(|element| element.physics.is_conservative());
        self.events.is_empty() && elements && self.constraints.iter().all(|joint| joint.physics.is_scleronomic())
    }

    /// Adds a node behind the others.
    pub fn add_node(&mut self, name: &str, kind: NodeKind, fixed: bool) -> NodeId {
        let dofs = self.dofs..self.dofs + kind.dofs();
        self.dofs = dofs.end;
        self.nodes.push(Node { name: name.to_string(), kind, fixed, dofs });
        self.node_id(self.nodes.len() - 1)
    }

    /// What no other model has.
    #[doc(hidden)]
    pub fn identity(&self) -> ModelIdentity {
        self.identity
    }

    /// The node with a number.
    #[doc(hidden)]
    pub fn node_id(&self, index: usize) -> NodeId {
        NodeId(index, self.identity)
    }

    /// All elements, in their order.
    pub fn element_ids(&self) -> impl Iterator<Item = ElementId> {
        let identity = self.identity;
        (0..self.elements.len()).map(move |index| ElementId(index, identity))
    }

    /// What stands for an element that was refused: none has this number.
    pub(crate) fn refused_element(&self) -> ElementId {
        ElementId(usize::MAX, self.identity)
    }

    /// The same for a constraint.
    pub(crate) fn refused_constraint(&self) -> ConstraintId {
        ConstraintId(usize::MAX, self.identity)
    }

    /// The node, unless it is one of another model.
    pub(crate) fn find_node(&self, id: NodeId) -> Option<&Node> {
        self.nodes.get(id.0).filter(|_| id.1 == self.identity)
    }

    /// The element, unless it was refused or is one of another model.
    pub(crate) fn find_element(&self, id: ElementId) -> Option<&Attached<ElementPhysics>> {
        self.elements.get(id.0).filter(|_| id.1 == self.identity)
    }

    /// The same for a constraint.
    pub(crate) fn find_constraint(&self, id: ConstraintId) -> Option<&Attached<ConstraintPhysics>> {
        self.constraints.get(id.0).filter(|_| id.1 == self.identity)
    }

    /// The node with a name.
    pub fn node_named(&self, name: &str) -> Option<NodeId> {
        self.nodes.iter().position(|own| own.name == name).map(|place| NodeId(place, self.identity))
    }

    /// The joint or other constraint with a name.
    pub fn constraint_named(&self, name: &str) -> Option<ConstraintId> {
        self.constraints.iter().position(|own| own.name == name).map(|place| ConstraintId(place, self.identity))
    }

    /// Reserves `count` places in p.
    pub fn add_parameters(&mut self, count: usize) -> Range<usize> {
        let range = self.parameters..self.parameters + count;
        self.parameters = range.end;
        range
    }

    /// Adds an element; the caller has checked the number of coordinates.
    pub fn add_element(&mut self, name: &str, nodes: &[NodeId], physics: Arc<dyn AnyElement>) -> ElementId {
        // types without options have the same formulas everywhere: they are recorded once
        let physics = if std::mem::size_of_val(&*physics) == 0 {
            let kind = physics.as_any().type_id();
            self.without_options.entry(kind).or_insert_with(|| ElementPhysics::new(physics)).clone()
        } else {
            ElementPhysics::new(physics)
        };
        let parameters = self.add_parameters(physics.parameter_count());
        self.elements.push(Attached { name: name.into(), nodes: nodes.into(), parameters, equations: 0..0, physics });
        ElementId(self.elements.len() - 1, self.identity)
    }

    /// Adds an element with the formulas of one that is there, and other nodes of the same kinds: they are recorded once.
    ///
    /// # Panics
    /// If that element is not one of this model.
    pub fn add_element_like(&mut self, name: &str, nodes: &[NodeId], like: ElementId) -> ElementId {
        let physics = self.elements[like.0].physics.clone();
        let parameters = self.add_parameters(physics.parameter_count());
        self.elements.push(Attached { name: name.into(), nodes: nodes.into(), parameters, equations: 0..0, physics });
        ElementId(self.elements.len() - 1, self.identity)
    }

    /// Adds a constraint; the caller has checked the number of coordinates.
    pub fn add_constraint(&mut self, name: &str, nodes: &[NodeId], physics: Arc<dyn AnyConstraint>) -> ConstraintId {
        let physics = ConstraintPhysics::new(physics);
        let parameters = self.add_parameters(physics.parameter_count());
        let equations = self.equations..self.equations + physics.equation_count();
        self.equations = equations.end;
        self.constraints.push(Attached { name: name.into(), nodes: nodes.into(), parameters, equations, physics });
        ConstraintId(self.constraints.len() - 1, self.identity)
    }

    /// Puts another law with as many equations in the place of that of a constraint, with new places of its parameters.
    pub(crate) fn replace_constraint(&mut self, id: ConstraintId, physics: Arc<dyn AnyConstraint>) {
        let physics = ConstraintPhysics::new(physics);
        let parameters = self.add_parameters(physics.parameter_count());
        let own = &mut self.constraints[id.0];
        (own.parameters, own.physics) = (parameters, physics);
    }

    /// Adds what holds parts in the equilibrium at the start; the caller has checked the number of coordinates.
    pub(crate) fn add_hold(&mut self, name: &str, nodes: &[NodeId], physics: Box<dyn AnyConstraint>) {
        let physics = ConstraintPhysics::new(physics.into());
        let parameters = self.add_parameters(physics.parameter_count());
        self.holds.push(Attached { name: name.into(), nodes: nodes.into(), parameters, equations: 0..0, physics });
    }

    /// A node.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0]
    }

    /// Number of coordinates of some nodes together.
    pub fn dof_count(&self, nodes: &[NodeId]) -> usize {
        nodes.iter().map(|node| self.nodes[node.0].dofs.len()).sum()
    }

    /// Name of a coordinate: node and component.
    pub fn dof_name(&self, dof: usize) -> String {
        let node = self.nodes.iter().find(|node| node.dofs.contains(&dof));
        node.map_or_else(String::new, |node| {
            format!("\"{}\", {}", node.name, node.kind.coordinate_name(dof - node.dofs.start))
        })
    }

    /// The joint of a constraint equation.
    pub(crate) fn joint_of(&self, equation: usize) -> Option<&Attached<ConstraintPhysics>> {
        let joint = self.constraints.get(self.constraints.partition_point(|joint| joint.equations.end <= equation));
        joint.filter(|joint| joint.equations.contains(&equation))
    }

    /// Name of a constraint equation: joint and number, counted from 1.
    pub fn equation_name(&self, equation: usize) -> String {
        self.joint_of(equation).map_or_else(String::new, |joint| {
            format!("joint \"{}\", constraint {}", joint.name, equation - joint.equations.start + 1)
        })
    }
}
