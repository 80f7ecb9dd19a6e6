//! What is measured.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::functionals::quantities::{Coordinate, Position, Reaction, TargetDistance, Velocity};
use crate::functionals::{Functional, Measured, Over};
use crate::scalar::{Scalar, Vec3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A functional of the position of a world point of a node along a direction [m].
    pub fn position_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vec3<S>, direction: Vec3<S>) {
        let of = self.anchor(name, node);
        let p = [self.local_point(node, point).0, direction.0].concat();
        self.add_functional(name, "m", over, (&[node], &[]), Position { of }.into(), &p);
    }

    /// A functional of the velocity of a world point of a node along a direction [m/s].
    pub fn velocity_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vec3<S>, direction: Vec3<S>) {
        let of = self.anchor(name, node);
        let p = [self.local_point(node, point).0, direction.0].concat();
        self.add_functional(name, "m/s", over, (&[node], &[]), Velocity { of }.into(), &p);
    }

    /// A functional of the squared distance of a world point of a node from a target [m2].
    pub fn target_functional(&mut self, name: &str, over: Over, node: NodeId, point: Vec3<S>, target: Vec3<S>) {
        let of = self.anchor(name, node);
        let p = [self.local_point(node, point).0, target.0].concat();
        self.add_functional(name, "m2", over, (&[node], &[]), TargetDistance { of }.into(), &p);
    }

    /// A functional of a weighted sum of a joint's multipliers.
    pub fn reaction_functional(&mut self, name: &str, over: Over, joint: ConstraintId, weights: &[S]) {
        if let Some(constraint) = self.model.constraints.get(joint.0) {
            let equations = constraint.equations.len();
            self.add_functional(name, "N", over, (&[], &[joint]), Reaction { equations }.into(), weights);
        }
    }

    /// A functional of one coordinate of a node.
    pub fn coordinate_functional(&mut self, name: &str, over: Over, node: NodeId, index: usize) {
        let of = self.model.nodes[node.0].dofs.len();
        self.add_functional(name, "-", over, (&[node], &[]), Coordinate { of, index }.into(), &[]);
    }

    /// A functional of the energy of all elements [J].
    pub fn energy_functional(&mut self, name: &str, over: Over) {
        self.functionals.push(Functional { name: name.into(), unit: "J", measured: Measured::Energy, over });
    }

    /// A functional of the mass of all elements [kg].
    pub fn mass_functional(&mut self, name: &str, over: Over) {
        self.functionals.push(Functional { name: name.into(), unit: "kg", measured: Measured::Mass, over });
    }
}
