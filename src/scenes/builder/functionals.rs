//! What is measured.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::NodeKind;
use crate::functionals::quantities::{
    Coordinate, Distance, JointAngle, JointDisplacement, JointRate, JointSpeed, Position, Reaction, ReactionNorm,
    TargetDistance, Velocity,
};
use crate::functionals::{Functional, Measured, Over};
use crate::scalar::{Scalar, SpatialVector, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A functional of the position of a world point of a node along a direction \[m\].
    pub fn position_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vector3<S>, direction: Vector3<S>) {
        let of = self.kind_in_space(name, node);
        let p = [self.local_point(node, point).components(), direction.components()].concat();
        self.add_functional(name, "m", over, (&[node], &[]), Position { of }.into(), &p);
    }

    /// A functional of the velocity of a world point of a node along a direction [m/s].
    pub fn velocity_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vector3<S>, direction: Vector3<S>) {
        let of = self.kind_in_space(name, node);
        let p = [self.local_point(node, point).components(), direction.components()].concat();
        self.add_functional(name, "m/s", over, (&[node], &[]), Velocity { of }.into(), &p);
    }

    /// A functional of the squared distance of a world point of a node from a target \[m2\].
    pub fn target_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vector3<S>, target: Vector3<S>) {
        let of = self.kind_in_space(name, node);
        let p = [self.local_point(node, point).components(), target.components()].concat();
        self.add_functional(name, "m2", over, (&[node], &[]), TargetDistance { of }.into(), &p);
    }

    /// A functional of the distance between world points of two nodes \[m\].
    pub fn distance_functional(&mut self, name: &str, over: Over, nodes: [NodeId; 2], points: [Vector3<S>; 2]) {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let p = self.points_between(nodes, points);
        self.add_functional(name, "m", over, (&nodes, &[]), Distance { a, b }.into(), &p);
    }

    /// A functional of a weighted sum of a joint's multipliers: forces \[N\], or moments [N m] of equations between axes and angles.
    pub fn reaction_functional(&mut self, name: &str, over: Over, joint: ConstraintId, weights: &[S]) {
        if self.has_joint(name, joint) {
            let equations = self.model.constraints[joint.0].equations.len();
            let unit = if self.are_moments(joint, weights) { "N m" } else { "N" };
            self.add_functional(name, unit, over, (&[], &[joint]), Reaction { equations }.into(), weights);
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
            let count = self.model.constraints[joint.0].equations.len();
            let weights = |own: usize| (0..count).map(|i| S::from(f64::from(u8::from(i == own)))).collect::<Vec<S>>();
            let (moments, forces): (Vec<usize>, Vec<usize>) =
                (0..count).partition(|&i| self.are_moments(joint, &weights(i)));
            let (equations, unit) = if forces.is_empty() { (moments, "N m") } else { (forces, "N") };
            self.add_functional(name, unit, over, (&[], &[joint]), ReactionNorm { equations }.into(), &[]);
        }
    }

    /// A functional of the angle of b against a about a world axis, in (-pi, pi] and zero at the start \[rad\].
    ///
    /// Over several turns take [`joint_angle`](MechanismBuilder::joint_angle) and the functional of its coordinate.
    pub fn joint_angle_functional(&mut self, name: &str, over: Over, nodes: [NodeId; 2], axis: Vector3<S>) {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let p = self.angle_frame(name, nodes, axis);
        self.add_functional(name, "rad", over, (&nodes, &[]), JointAngle { a, b }.into(), &p);
    }

    /// A functional of the angular velocity of b against a along a world axis fixed in a [rad/s].
    pub fn joint_rate_functional(&mut self, name: &str, over: Over, nodes: [NodeId; 2], axis: Vector3<S>) {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let axis = self.unit(name, axis);
        let p = self.local_direction(nodes[0], axis).components();
        self.add_functional(name, "rad/s", over, (&nodes, &[]), JointRate { a, b }.into(), &p);
    }

    /// A functional of the displacement of a world point of b along a world axis fixed in a, from the start on \[m\].
    pub fn joint_displacement_functional(
        &mut self,
        name: &str,
        over: Over,
        nodes: [NodeId; 2],
        point: Vector3<S>,
        axis: Vector3<S>,
    ) {
        let ([a, b], p) = self.slide(name, nodes, point, axis);
        self.add_functional(name, "m", over, (&nodes, &[]), JointDisplacement { a, b }.into(), &p);
    }

    /// A functional of the rate of that displacement [m/s].
    pub fn joint_speed_functional(
        &mut self,
        name: &str,
        over: Over,
        nodes: [NodeId; 2],
        point: Vector3<S>,
        axis: Vector3<S>,
    ) {
        let ([a, b], p) = self.slide(name, nodes, point, axis);
        self.add_functional(name, "m/s", over, (&nodes, &[]), JointSpeed { a, b }.into(), &p);
    }

    fn slide(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ([NodeKind; 2], Vec<S>) {
        let axis = self.unit(name, axis);
        let p = [&self.points_between(nodes, [point; 2])[..], &self.local_direction(nodes[0], axis).components()].concat();
        ([self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])], p)
    }

    /// A functional of one coordinate of a node.
    pub fn coordinate_functional(&mut self, name: &str, over: Over, node: NodeId, index: usize) {
        if let Some(of) = self.kind_of(name, node).map(NodeKind::dofs) {
            self.add_functional(name, "-", over, (&[node], &[]), Coordinate { of, index }.into(), &[]);
        }
    }

    /// A functional of the energy of all elements \[J\].
    pub fn energy_functional(&mut self, name: &str, over: Over) {
        self.functionals.push(Functional { name: name.into(), unit: "J", measured: Measured::energy(), over });
    }
}
