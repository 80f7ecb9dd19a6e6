//! What is measured.

use super::MechanismBuilder;
use super::entries::{entry, methods_by_entry};
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::entries::{GivenValue, Values};
use crate::functionals::quantities::{QUANTITIES, Reaction, ReactionNorm};
use crate::functionals::{Functional, Measured, Over, QuantityPart};
use crate::scalar::{Scalar, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A functional of a quantity by its entry, one of [`QUANTITIES`] or of your own:
    /// `m.measure(&QuantityPart::of::<MyQuantity>(), "name", Over::Terminal, &[node], keys)`.
    pub fn measure(&mut self, part: &QuantityPart, name: &str, over: Over, nodes: &[NodeId], keys: impl Into<Values<S>>) {
        if let Some((quantity, p)) = self.build_part(part, name, nodes, keys.into()) {
            self.add_functional(name, over, (nodes, &[]), quantity, &p);
        }
    }

    /// A functional of a weighted sum of a joint's multipliers: forces \[N\], or moments [N m] of equations between axes and angles.
    pub fn reaction_functional(&mut self, name: &str, over: Over, joint: ConstraintId, weights: &[S]) {
        if self.has_joint(name, joint) {
            let equations = self.model.constraints[joint.0].equations.len();
            let unit = if self.are_moments(joint, weights) { "N m" } else { "N" };
            self.add_functional(name, over, (&[], &[joint]), Reaction { equations, unit }.into(), weights);
        }
    }

    /// Whether the weighted multipliers are moments: forces of their equations turn bodies and move no point.
    fn are_moments(&self, joint: ConstraintId, weights: &[S]) -> bool {
        let joint = &self.model.constraints[joint.0];
        let nodes = || joint.nodes.iter().map(|node| &self.model.nodes[node.0]);
        if joint.physics.refused().is_some() || !nodes().any(|node| node.kind.has_axes()) {
            return false;
        }
        let values = |list: &[S]| list.iter().map(|number| number.value()).collect::<Vec<f64>>();
        let q: Vec<f64> = nodes().flat_map(|node| values(&self.numbers.q[node.dofs.clone()])).collect();
        let moves = nodes().flat_map(|node| {
            let is_in_space = node.kind.in_space().is_some();
            (0..node.dofs.len()).map(move |place| is_in_space && place < 3)
        });
        let moves: Vec<bool> = moves.collect();
        let rows = joint.physics.rows(&q, &values(&self.numbers.p[joint.parameters.clone()]), 0.0);
        let mut weighted = rows.chunks_exact(q.len()).zip(weights).filter(|(_, weight)| weight.value() != 0.0).peekable();
        weighted.peek().is_some()
            && weighted.all(|(row, _)| {
                row.iter().any(|force| *force != 0.0) && row.iter().zip(&moves).all(|(force, moves)| !moves || *force == 0.0)
            })
    }

    /// A functional of the size of a joint's force: the length of those of its multipliers that are forces \[N\]; of a joint that has none,
    /// as one between angles, of its moments [N m].
    pub fn reaction_norm_functional(&mut self, name: &str, over: Over, joint: ConstraintId) {
        if self.has_joint(name, joint) {
            let (equations, unit) = self.forces_of(joint);
            self.add_functional(name, over, (&[], &[joint]), ReactionNorm { equations, unit }.into(), &[]);
        }
    }

    /// Equations of a joint whose multipliers are forces, or all of one that has none, with their unit.
    pub(super) fn forces_of(&self, joint: ConstraintId) -> (Vec<usize>, &'static str) {
        let count = self.model.constraints[joint.0].equations.len();
        let weights = |own: usize| (0..count).map(|i| S::from(f64::from(u8::from(i == own)))).collect::<Vec<S>>();
        let (moments, forces): (Vec<usize>, Vec<usize>) = (0..count).partition(|&i| self.are_moments(joint, &weights(i)));
        if forces.is_empty() { (moments, "N m") } else { (forces, "N") }
    }

    /// A functional of one coordinate of a node.
    pub fn coordinate_functional(&mut self, name: &str, over: Over, node: NodeId, index: usize) {
        self.measure(entry(QUANTITIES, "coordinate"), name, over, &[node], [("index", GivenValue::Count(index))]);
    }

    /// A functional of the energy of all elements \[J\].
    pub fn energy_functional(&mut self, name: &str, over: Over) {
        self.functionals.push(Functional { name: name.into(), unit: "J", measured: Measured::energy(), over });
    }
}

methods_by_entry! { QUANTITIES.measure -> ();
    /// A functional of the position of a world point of a node along a direction \[m\].
    position_functional "position" (over: Over, node: NodeId, point: Vector3<S>, direction: Vector3<S>)
        on over, &[node] => point, direction;
    /// A functional of the velocity of a world point of a node along a direction [m/s].
    velocity_functional "velocity" (over: Over, node: NodeId, point: Vector3<S>, direction: Vector3<S>)
        on over, &[node] => point, direction;
    /// A functional of the acceleration of a world point of a node along a direction that turns with it, less gravity, as a sensor shows it [m/s2].
    acceleration_functional "acceleration"
        (over: Over, node: NodeId, point: Vector3<S>, direction: Vector3<S>, gravity: Vector3<S>)
        on over, &[node] => point, direction, gravity;
    /// A functional of the squared distance of a world point of a node from a target \[m2\].
    target_functional "target" (over: Over, node: NodeId, point: Vector3<S>, target: Vector3<S>)
        on over, &[node] => point, target;
    /// A functional of the distance between world points of two nodes \[m\].
    distance_functional "distance" (over: Over, nodes: [NodeId; 2], points: [Vector3<S>; 2]) on over, &nodes => points;
    /// A functional of the angle of b against a about a world axis, in (-pi, pi] and zero at the start \[rad\].
    ///
    /// Over several turns take [`joint_angle`](MechanismBuilder::joint_angle) and the functional of its coordinate.
    joint_angle_functional "joint_angle" (over: Over, nodes: [NodeId; 2], axis: Vector3<S>) on over, &nodes => axis;
    /// A functional of the angular velocity of b against a along a world axis fixed in a [rad/s].
    joint_rate_functional "joint_rate" (over: Over, nodes: [NodeId; 2], axis: Vector3<S>) on over, &nodes => axis;
    /// A functional of the displacement of a world point of b along a world axis fixed in a, from the start on \[m\].
    joint_displacement_functional "joint_displacement" (over: Over, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>)
        on over, &nodes => point, axis;
    /// A functional of the rate of that displacement [m/s].
    joint_speed_functional "joint_speed" (over: Over, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>)
        on over, &nodes => point, axis;
    /// A functional of the deflection of a cable's node from the tangent at another, in the plane with a world normal \[m\]: nodes (tangent,
    /// deflected).
    cable_deflection_functional "cable_deflection" (over: Over, nodes: [NodeId; 2], normal: Vector3<S>)
        on over, &nodes => normal;
}
