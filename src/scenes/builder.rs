mod beams;
mod cables;
mod carriers;
mod contacts;
mod entries;
mod events;
mod forces;
mod free_mesh;
mod functionals;
mod groups;
mod holds;
mod joints;
mod line_stress;
mod loads;
mod mesh_gaps;
mod mortar;
mod outlined;
mod rolling;
mod shell_joining;
mod shell_mesh;
mod shells;
mod solid_bodies;
mod spin;
mod surface_mesh;
mod surface_search;
mod thin_walls;
mod ties;
mod weights;

pub use beams::{BeamLine, BeamMember};
pub use cables::{CableLine, CableMember};
pub use contacts::{ContactShape, SoftLaw};
pub use events::StopLaw;
pub use forces::{BushingRates, Force, SpringDamper, Torque};
pub use free_mesh::FreeMesh;
pub use line_stress::LineElement;
pub use outlined::{LineField, OutlinedLine, Ring};
pub use shell_mesh::{Edge, ShellMesh};
pub use shells::{DRILLING, MeshedShell, ShellMember, ShellPart};
pub(crate) use solid_bodies::DrawnSolid;
pub use surface_mesh::SurfaceMesh;
pub use thin_walls::{Extrusion, Profile, ThinWalls};

use crate::assembly::{Attached, ConstraintId, ElementId, Model, Node, NodeId};
use crate::design::{ModelNumbers, repeated};
use crate::elements::bodies::inertia_tensor::{self, Inadmissible};
use crate::elements::bodies::{NaturalBody, PointMass, RigidBody};
use crate::elements::entries::{Given, Placed};
use crate::elements::{AnyConstraint, AnyElement, NodeKind, Nonholonomic, NonholonomicConstraint};
use crate::functionals::{AnyQuantity, Functional, Measured, MeasuredQuantity, Over};
use crate::integrators::Table;
use crate::program::Recorded;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::Drawn;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use weights::Heavy;

/// A line of the picture of the motion, through points that move with nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// What the line stands for.
    pub drawn: Drawn,
    /// Corners: nodes, and places in their frames \[m\].
    pub points: Vec<(NodeId, [f64; 3])>,
}

impl Drawing {
    /// True for a line that bends with its nodes.
    pub(crate) fn joins_nodes(&self) -> bool {
        self.points.iter().any(|corner| corner.0 != self.points[0].0)
    }
}

/// Collects a mechanism: nodes with their start, elements, joints, functionals, and lines to draw.
///
/// Geometry is given in the world at t = 0; the builder turns it into body frames. Mistakes are collected by name and
/// reported by [`finish`](MechanismBuilder::finish), so that a scene function reads without question marks.
pub struct MechanismBuilder<S> {
    /// Topology.
    pub model: Model,
    /// Parameters and start.
    pub numbers: ModelNumbers<S>,
    /// Functionals.
    pub functionals: Vec<Functional>,
    /// Lines of the picture.
    pub(crate) drawings: Vec<Drawing>,
    /// Solids of bodies.
    pub(crate) solids: Vec<DrawnSolid>,
    /// Nodes that beams and cables made for themselves, which nobody gave a name.
    #[doc(hidden)]
    pub nodes_of_members: Vec<NodeId>,
    ground: Option<NodeId>,
    /// What was asked for, with how many of what is heavy have this weight.
    gravities: Vec<(Vector3<S>, usize)>,
    heavy: Vec<Heavy<S>>,
    /// Beams and cables, for what is shown of them.
    pub(crate) outlined: Vec<OutlinedLine>,
    /// Elements of beams and cables, with what gives their stresses.
    line_stresses: HashMap<ElementId, line_stress::LineStress<S>>,
    /// Shells, for what is shown of them.
    pub(super) shells: Vec<MeshedShell>,
    /// Nodes that follow faces.
    ties: HashMap<NodeId, ties::Tied>,
    /// Joint angles with their bodies and axes.
    angles: Vec<(NodeId, [NodeId; 2], Vector3<S>)>,
    names_of_nodes: NamesOfNodes,
    /// Joints that come and go with others: the contact of what rolls.
    companions: HashMap<ConstraintId, ConstraintId>,
    mistakes: Vec<String>,
    /// Those in values of keys: name, key, and what is wrong.
    wrong_keys: Vec<(String, &'static str, String)>,
}

/// Names that nodes have already.
#[derive(Default)]
struct NamesOfNodes {
    names: HashSet<String>,
    /// Nodes whose names are among them.
    count: usize,
}

crate::assembly::empty_fields!(MechanismBuilder {
    model,
    numbers,
    functionals,
    drawings,
    solids,
    nodes_of_members,
    ground,
    gravities,
    heavy,
    outlined,
    line_stresses,
    shells,
    ties,
    angles,
    names_of_nodes,
    companions,
    mistakes,
    wrong_keys
});

/// What is read of a node that is not there.
fn no_vector<S: Scalar>() -> Vector3<S> {
    Vector3::from_f64([f64::NAN; 3])
}

impl<S: Scalar> MechanismBuilder<S> {
    fn add_node(&mut self, name: &str, kind: NodeKind, fixed: bool, q: &[S]) -> NodeId {
        let NamesOfNodes { names, count } = &mut self.names_of_nodes;
        names.extend(self.model.nodes[*count..].iter().map(|node| node.name.clone()));
        *count = self.model.nodes.len();
        if names.contains(name) {
            self.mistakes.push(format!("two nodes are named \"{name}\""));
        }
        self.numbers.q.extend_from_slice(q);
        self.numbers.v.resize(self.numbers.q.len(), S::zero());
        self.model.add_node(name, kind, fixed)
    }

    /// A node of a beam or cable that the scene did not give.
    fn add_node_of_member(&mut self, name: &str, kind: NodeKind, fixed: bool, q: &[S]) -> NodeId {
        let node = self.add_node(name, kind, fixed, q);
        self.nodes_of_members.push(node);
        node
    }

    /// A rigid body's node at rest: position of its frame \[m\] and Euler parameters.
    pub fn body(&mut self, name: &str, position: Vector3<S>, rotation: Quaternion<S>) -> NodeId {
        let q: Vec<S> = position.components().into_iter().chain(rotation.0).collect();
        self.add_node(name, NodeKind::Body, false, &q)
    }

    /// A rigid body's node in natural coordinates, at rest: position of its frame \[m\] and rotation, by Euler parameters of unit length.
    pub fn natural_body(&mut self, name: &str, position: Vector3<S>, rotation: Quaternion<S>) -> NodeId {
        let q: Vec<S> = position
            .components()
            .into_iter()
            .chain(rotation.columns().into_iter().flat_map(|axis| axis.components()))
            .collect();
        self.add_node(name, NodeKind::Natural, false, &q)
    }

    /// A point's node at rest \[m\].
    pub fn point(&mut self, name: &str, position: Vector3<S>) -> NodeId {
        self.add_node(name, NodeKind::Point, false, &position.components())
    }

    /// A node of coordinates that the scene's own elements give a meaning to, with their rates.
    pub fn coordinates(&mut self, name: &str, q: &[S], v: &[S]) -> NodeId {
        self.with_rates(name, NodeKind::Coordinates(q.len()), q, v)
    }

    fn with_rates(&mut self, name: &str, kind: NodeKind, q: &[S], v: &[S]) -> NodeId {
        let node = self.add_node(name, kind, false, q);
        if q.len() != v.len() {
            self.mistakes.push(format!("\"{name}\" has {} coordinates but {} velocities", q.len(), v.len()));
        }
        let dofs = self.model.nodes[node.0].dofs.clone();
        for (place, &v) in dofs.zip(v) {
            self.numbers.v[place] = v;
        }
        node
    }

    /// A node of states z of first order ([`NodeKind::States`]), with their start: an element of one's own gives z' = f, by the residual a - f with
    /// z = v. They have no energy. An equilibrium at which a motion begins finds them with the coordinates, f = 0: the start is where the search
    /// begins, and stays what a state has that no other number of the equilibrium depends on, or whose rate depends on none of these.
    pub fn states(&mut self, name: &str, initial: &[S]) -> NodeId {
        self.with_rates(name, NodeKind::States(initial.len()), &vec![S::zero(); initial.len()], initial)
    }

    /// The mechanism as an integrator sees it: in statics states of first order are unknowns like coordinates.
    pub(super) fn for_table(mut self, table: &Table) -> Self {
        let states: Vec<usize> = self.model.state_dofs().collect();
        if states.is_empty() || !table.is_static() {
            return self;
        }
        let ModelNumbers { q, v, .. } = &mut self.numbers;
        states.iter().for_each(|&dof| q[dof] = std::mem::replace(&mut v[dof], S::zero()));
        let functionals = std::mem::take(&mut self.functionals).into_iter().map(|mut own| {
            if let Measured::Local { nodes, constraints, parameters, quantity } = own.measured {
                let dofs = nodes.iter().flat_map(|node| self.model.nodes[node.0].dofs.clone());
                let places = dofs.enumerate().filter(|(_, dof)| states.contains(dof)).map(|(place, _)| place).collect();
                own.measured = Measured::Local { nodes, constraints, parameters, quantity: quantity.at_rest(places) };
            }
            own
        });
        self.functionals = functionals.collect();
        self.model = self.model.with_states_as_coordinates();
        self
    }

    /// The ground: a body at the origin that never moves.
    pub fn ground(&mut self) -> NodeId {
        if let Some(ground) = self.ground {
            return ground;
        }
        let q: Vec<S> = Vector3::zeros().components().into_iter().chain(Quaternion::identity().0).collect();
        let ground = self.add_node("ground", NodeKind::Body, true, &q);
        self.ground = Some(ground);
        ground
    }

    /// Gives a node a velocity [m/s] and, if it is a body or a cable's node, an angular velocity in world components [rad/s].
    pub fn set_velocity(&mut self, node: NodeId, velocity: Vector3<S>, omega_world: Vector3<S>) {
        let Some(kind) = self.kind_of("set_velocity", node) else { return };
        if kind.in_space().is_none() {
            let name = &self.model.nodes[node.0].name;
            self.mistakes
                .push(format!("\"{name}\" has no place in space: give the rates of its coordinates where it is made"));
            return;
        }
        let first = self.model.nodes[node.0].dofs.start;
        for (place, v) in (first..).zip(velocity.components()) {
            self.numbers.v[place] = v;
        }
        let rates: Vec<S> = match kind {
            NodeKind::Body => {
                let e = Quaternion::from_slice(&self.numbers.q[first + 3..]);
                e.rate_of_body_velocity(e.rotate_back(omega_world)).to_vec()
            }
            NodeKind::Natural | NodeKind::Slope => {
                let own = &self.numbers.q[self.model.nodes[node.0].dofs.clone()][3..];
                own.chunks_exact(3)
                    .flat_map(|vector| omega_world.cross(&Vector3::first_three(vector)).components())
                    .collect()
            }
            _ => Vec::new(),
        };
        for (place, rate) in (first + 3..).zip(rates) {
            self.numbers.v[place] = rate;
        }
        self.set_angle_rates();
    }

    /// Initial angular velocity of a body in world components [rad/s]; not a number for a node of another mechanism, as are the
    /// following.
    pub fn angular_velocity(&self, node: NodeId) -> Vector3<S> {
        let Some(Node { kind, dofs, .. }) = self.model.find_node(node) else { return no_vector() };
        let (v, q) = (&self.numbers.v[dofs.clone()], &self.numbers.q[dofs.clone()]);
        kind.angular_velocity(v, q)
    }

    /// A node where it stands at the start.
    fn placed(&self, node: NodeId) -> Option<Placed<'_, S>> {
        let Node { kind, dofs, .. } = self.model.find_node(node)?;
        Some(Placed { kind: *kind, q: &self.numbers.q[dofs.clone()] })
    }

    /// Initial position of a node's frame \[m\]; that of the world where it has no place in space.
    pub fn position(&self, node: NodeId) -> Vector3<S> {
        self.placed(node).map_or_else(no_vector, Placed::position)
    }

    /// Initial Euler parameters of a body; other nodes have the axes of the world.
    pub fn rotation(&self, node: NodeId) -> Quaternion<S> {
        self.placed(node).map_or(Quaternion([S::from(f64::NAN); 4]), Placed::rotation)
    }

    /// A world point \[m\] in the frame of a body; zero for other nodes, whose own position it is.
    pub fn local_point(&self, node: NodeId, point: Vector3<S>) -> Vector3<S> {
        self.placed(node).map_or_else(no_vector, |own| own.local_point(point))
    }

    /// A world direction in the frame of a body.
    pub fn local_direction(&self, node: NodeId, direction: Vector3<S>) -> Vector3<S> {
        self.placed(node).map_or_else(no_vector, |own| own.local_direction(direction))
    }

    /// What `owner` takes hold of belongs to another builder.
    fn refuse_stranger(&mut self, owner: &str, what: &str) {
        let text = format!("\"{owner}\" takes hold of {what} of another mechanism: take what this builder returned");
        if !self.mistakes.contains(&text) {
            self.mistakes.push(text);
        }
    }

    /// The kind of a node, unless it is one of another mechanism.
    fn kind_of(&mut self, owner: &str, node: NodeId) -> Option<NodeKind> {
        let kind = self.model.find_node(node).map(|node| node.kind);
        if kind.is_none() {
            self.refuse_stranger(owner, "a node");
        }
        kind
    }

    /// Whether a joint was added; one that was refused has been reported already.
    fn has_joint(&mut self, owner: &str, joint: ConstraintId) -> bool {
        let there = self.model.find_constraint(joint).is_some();
        if !there && joint != self.model.refused_constraint() {
            self.refuse_stranger(owner, "a joint");
        }
        there
    }

    /// Parameters of an element from its first one on, `count` of them; an element that was refused has been reported already.
    fn first_parameters(&mut self, owner: &str, element: ElementId, count: usize) -> Option<Vec<S>> {
        let places = self.model.find_element(element).map(|element| element.parameters.clone());
        let parameters = places.and_then(|places| Some(self.numbers.p[places].get(..count)?.to_vec()));
        if parameters.is_none() && element != self.model.refused_element() {
            self.refuse_stranger(owner, "an element");
        }
        parameters
    }

    /// What is asked of nodes and of values without an entry; what is wrong is told with the other mistakes.
    fn asked<T>(&mut self, owner: &str, nodes: &[NodeId], ask: impl FnOnce(&mut Given<S>) -> T) -> T {
        let mut given = self.given(owner, nodes, Vec::new());
        let answer = ask(&mut given);
        self.keep_mistakes(owner, given.mistakes());
        answer
    }

    fn kind_in_space(&mut self, owner: &str, node: NodeId) -> NodeKind {
        let Some(kind) = self.kind_of(owner, node) else { return NodeKind::Point };
        kind.in_space().unwrap_or_else(|| self.asked(owner, &[node], |given| given.in_space(0)))
    }

    /// A vector of length one along an axis or normal.
    fn unit(&mut self, owner: &str, direction: Vector3<S>) -> Vector3<S> {
        self.asked(owner, &[], |given| given.unit_of(direction))
    }

    fn check_parameters(&mut self, name: &str, parameters: usize, given: usize) -> bool {
        if parameters != given {
            self.mistakes.push(format!("\"{name}\" has {parameters} parameters, but {given} values were given"));
        }
        parameters == given
    }

    fn check_nodes(&mut self, name: &str, nodes: &[NodeId], kinds: &[NodeKind]) -> bool {
        let Some(have) = nodes.iter().map(|&node| self.kind_of(name, node)).collect::<Option<Vec<NodeKind>>>() else {
            return false;
        };
        // a node of the wrong kind may have been noticed where its frame was asked for
        let reported = format!("\"{name}\" needs ");
        if have != kinds && !self.mistakes.iter().any(|mistake| mistake.starts_with(&reported)) {
            let list = |kinds: &[NodeKind]| match kinds {
                [] => "nothing".to_string(),
                _ => kinds.iter().map(|kind| kind.words()).collect::<Vec<_>>().join(", "),
            };
            let (wanted, have) = (list(kinds), list(&have));
            self.mistakes.push(format!("\"{name}\" takes hold of {wanted}, but its nodes are {have}"));
        }
        have == kinds
    }

    /// Adds any element with its parameters.
    pub fn element(&mut self, name: &str, nodes: &[NodeId], element: impl AnyElement + 'static, p: &[S]) -> ElementId {
        self.add_element(name, nodes, Box::new(element), p)
    }

    fn add_element(&mut self, name: &str, nodes: &[NodeId], element: Box<dyn AnyElement>, p: &[S]) -> ElementId {
        let sound = self.check_parameters(name, element.parameter_list().len(), p.len())
            & self.check_nodes(name, nodes, &element.node_kinds());
        if !sound {
            return self.model.refused_element();
        }
        self.numbers.p.extend_from_slice(p);
        let added = self.model.add_element(name, nodes, element.into());
        // sides of switches, which runs tell
        self.numbers.p.resize(self.model.parameters, S::zero());
        added
    }

    /// Adds any constraint with its parameters.
    pub fn constraint(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        constraint: impl AnyConstraint + 'static,
        p: &[S],
    ) -> ConstraintId {
        self.add_constraint(name, nodes, Box::new(constraint), p)
    }

    fn add_constraint(&mut self, name: &str, nodes: &[NodeId], constraint: Box<dyn AnyConstraint>, p: &[S]) -> ConstraintId {
        let sound = self.check_parameters(name, constraint.parameter_list().len(), p.len())
            & self.check_nodes(name, nodes, &constraint.node_kinds());
        if !sound {
            return self.model.refused_constraint();
        }
        self.numbers.p.extend_from_slice(p);
        self.model.add_constraint(name, nodes, constraint.into())
    }

    /// Adds any nonholonomic constraint with its parameters.
    pub fn nonholonomic(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        constraint: impl NonholonomicConstraint,
        p: &[S],
    ) -> ConstraintId {
        self.constraint(name, nodes, Nonholonomic(constraint), p)
    }

    /// Inertia of a body, in Euler parameters or natural coordinates: mass \[kg\], mass centre in the body frame \[m\], tensor about it
    /// (xx, yy, zz, xy, xz, yz) [kg m2].
    pub fn rigid_body(&mut self, name: &str, node: NodeId, mass: S, centre: Vector3<S>, inertia: [S; 6]) -> ElementId {
        let inertia = self.checked_inertia(name, mass, centre, inertia);
        let p: Vec<S> = [mass].into_iter().chain(centre.components()).chain(inertia).collect();
        let kind = self.kind_of(name, node).map(|_| self.asked(name, &[node], |given| given.body(0)));
        let law = if kind == Some(NodeKind::Natural) { NaturalBody.into() } else { RigidBody.into() };
        let body = self.add_element(name, &[node], law, &p);
        self.heavy.extend((body.0 != usize::MAX).then_some(Heavy::Mass(node, mass, centre)));
        body
    }

    /// A tensor whose principal moments are those of a body, and where a moment of it is negative by round-off, zero.
    fn checked_inertia(&mut self, name: &str, mass: S, centre: Vector3<S>, inertia: [S; 6]) -> [S; 6] {
        let (weight, place, values) =
            (mass.value(), Vector3::from_f64(centre.components().map(Scalar::value)), inertia.map(Scalar::value));
        // what is not finite is told with the other parameters
        if ![&[weight], &place.components()[..], &values].concat().iter().all(|number| number.is_finite()) {
            return inertia;
        }
        if let Err(Inadmissible { moments: [least, middle, largest], .. }) = inertia_tensor::check(weight, place, values) {
            let why = match least < 0.0 {
                true => "none can be negative".into(),
                false => format!(
                    "the largest exceeds the sum of the others by {:.3e}, which no body's does",
                    largest - middle - least
                ),
            };
            self.mistakes.push(format!(
                "the inertia of \"{name}\" has the principal moments {least:.3e}, {middle:.3e} and {largest:.3e} kg m2: {why}; give the \
                 tensor about the mass centre in body axes, products with the sign of its entries"
            ));
        }
        let round_off = inertia_tensor::round_off(weight, place, values);
        std::array::from_fn(|k| match values[k] {
            moment if k < 3 && (-round_off..0.0).contains(&moment) => inertia[k] - S::from(moment),
            _ => inertia[k],
        })
    }

    /// A mass \[kg\] at a point.
    pub fn point_mass(&mut self, name: &str, node: NodeId, mass: S) -> ElementId {
        let point = self.add_element(name, &[node], PointMass.into(), &[mass]);
        self.heavy.extend((point.0 != usize::MAX).then_some(Heavy::Mass(node, mass, Vector3::zeros())));
        point
    }

    /// A functional of any quantity.
    pub fn functional(
        &mut self,
        name: &str,
        over: Over,
        (nodes, constraints): (&[NodeId], &[ConstraintId]),
        quantity: impl AnyQuantity + 'static,
        p: &[S],
    ) {
        self.add_functional(name, over, (nodes, constraints), Box::new(quantity), p);
    }

    fn add_functional(
        &mut self,
        name: &str,
        over: Over,
        (nodes, constraints): (&[NodeId], &[ConstraintId]),
        quantity: Box<dyn AnyQuantity>,
        p: &[S],
    ) {
        let known = nodes.iter().all(|&node| self.kind_of(name, node).is_some())
            & constraints.iter().all(|&joint| self.has_joint(name, joint));
        if !known {
            return;
        }
        let (have, wanted) = (self.model.dof_count(nodes), quantity.dof_count());
        if !self.check_over(name, over) {
            return;
        }
        if have != wanted {
            self.mistakes.push(format!("\"{name}\" works on {wanted} coordinates, but its nodes have {have}"));
        }
        if !self.check_parameters(name, quantity.parameter_list().len(), p.len()) || have != wanted {
            return;
        }
        let (nodes, constraints) = (nodes.to_vec(), constraints.to_vec());
        let equations = |id: &ConstraintId| self.model.constraints[id.0].equations.clone();
        let multipliers = constraints.iter().map(|id| equations(id).len()).sum();
        let (unit, mut quantity) = (quantity.unit(), MeasuredQuantity::new(quantity, multipliers));
        let mu = constraints.first().map_or(0..0, equations);
        // aggregates take kinks as they are
        if over == Over::Integral && constraints.len() <= 1 {
            quantity = quantity.with_sides();
        }
        let sides = quantity.sides();
        let parameters = self.add_numbers(&[p, &vec![S::zero(); sides]].concat());
        if sides > 0 {
            let (nodes, parameters, physics) = (nodes.clone(), parameters.clone(), Arc::clone(quantity.formula()));
            self.model.measured.push(Attached { name: name.into(), nodes, parameters, equations: mu, physics });
        }
        let measured = Measured::Local { nodes, constraints, parameters, quantity };
        self.functionals.push(Functional { name: name.into(), unit, measured, over });
    }

    /// Takes the mistakes that were collected so far.
    #[cfg(feature = "files")]
    pub(super) fn take_mistakes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.mistakes)
    }

    /// Takes those in values of keys.
    #[cfg(feature = "files")]
    pub(super) fn take_wrong_keys(&mut self) -> Vec<(String, &'static str, String)> {
        std::mem::take(&mut self.wrong_keys)
    }

    /// Draws a line through world points with a node.
    pub fn draw(&mut self, node: NodeId, points: &[Vector3<S>]) {
        if self.kind_of("draw", node).is_none() {
            return;
        }
        let corner = |&point: &Vector3<S>| (node, self.local_point(node, point).components().map(Scalar::value));
        let points = points.iter().map(corner).collect();
        self.drawings.push(Drawing { drawn: Drawn::Body, points });
    }

    /// Adds the weights and checks what was collected.
    ///
    /// # Errors
    /// All mistakes, one after the other.
    pub fn finish(mut self) -> Result<Self, String> {
        for (gravity, weighed) in std::mem::take(&mut self.gravities) {
            self.add_weights(gravity, weighed);
        }
        self.check_locks();
        if self.functionals.iter().any(|f| matches!(f.measured, Measured::Energy(_))) {
            for element in self.model.elements.iter().filter(|element| !element.physics.has_energies()) {
                let name = &element.name;
                self.mistakes
                    .push(format!("an energy functional needs the energies of \"{name}\", which it does not state"));
            }
        }
        let functionals = repeated(self.functionals.iter().map(|functional| &*functional.name));
        let joints = repeated(self.model.constraints.iter().map(|joint| &*joint.name));
        for (what, name) in [("functionals", functionals), ("joints", joints)] {
            self.mistakes.extend(name.map(|name| format!("two {what} are named \"{name}\"")));
        }
        if self.model.nodes.iter().all(|node| node.fixed) {
            self.mistakes.push("the scene has no node that can move".into());
        }
        let wrong_keys = self.wrong_keys.iter().map(|(name, key, what)| format!("\"{name}\", {key}: {what}"));
        self.mistakes.extend(wrong_keys);
        if self.mistakes.is_empty() { Ok(self) } else { Err(self.mistakes.join("; ")) }
    }
}

impl MechanismBuilder<Recorded> {
    /// The finished mechanism with values in place of what is recorded, without what is of use while it is built alone.
    pub(super) fn in_real_numbers(self) -> MechanismBuilder<f64> {
        let MechanismBuilder { model, functionals, drawings, solids, nodes_of_members, outlined, shells, .. } = self;
        let ModelNumbers { p, q, v } = self.numbers;
        let [p, q, v] = [p, q, v].map(|numbers| numbers.into_iter().map(Recorded::number).collect());
        let stresses = self.line_stresses.into_iter().map(|(element, own)| (element, own.in_real_numbers()));
        MechanismBuilder {
            model,
            numbers: ModelNumbers { p, q, v },
            functionals,
            drawings,
            solids,
            nodes_of_members,
            outlined,
            line_stresses: stresses.collect(),
            shells,
            ..Default::default()
        }
    }
}
