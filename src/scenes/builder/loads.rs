//! Forces and moments of joints.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::forces::LoadFrame;
use crate::functionals::{Functional, JointLoad, LoadKind, Measured, Over};
use crate::scalar::{Scalar, SpatialVector, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A functional of the power with which a joint or driver works on what it holds \[W\], or on one of its nodes alone: that of a joint on both
    /// is zero, that of a driver is what it puts into the mechanism. Its integral is a work \[J\].
    pub fn joint_power_functional(&mut self, name: &str, over: Over, joint: ConstraintId, on: Option<NodeId>) {
        if !self.has_joint(name, joint) || !self.check_over(name, over) {
            return;
        }
        let constraint = &self.model.constraints[joint.0];
        let mut nodes = 0..constraint.physics.dof_count();
        if let Some(on) = on {
            let Some(place) = constraint.nodes.iter().position(|&node| node == on) else {
                let mistake =
                    format!("\"{name}\" asks for the power of \"{}\" on a node that it does not hold", constraint.name);
                self.mistakes.push(mistake);
                return;
            };
            let first = self.model.dof_count(&constraint.nodes[..place]);
            nodes = first..first + self.model.dof_count(&[on]);
        }
        let parameters = self.add_numbers(&[S::zero(); JointLoad::PARAMETERS]);
        let measured = Measured::Load { joint, parameters, load: JointLoad::power(nodes) };
        self.functionals.push(Functional { name: name.into(), unit: "W", measured, over });
    }

    /// A functional of the force \[N\] or moment [N m] with which a joint or driver acts on one of its nodes, along a world direction
    /// that stays in the world or turns with the node; moments about a world point of the node. Norms ignore the direction.
    pub fn joint_load_functional(
        &mut self,
        name: &str,
        over: Over,
        (joint, on): (ConstraintId, NodeId),
        (kind, frame): (LoadKind, LoadFrame),
        direction: Vector3<S>,
        point: Vector3<S>,
    ) {
        let (Some(kind_on), true) = (self.kind_of(name, on), self.has_joint(name, joint)) else { return };
        let constraint = &self.model.constraints[joint.0];
        let Some(place) = constraint.nodes.iter().position(|&node| node == on) else {
            let (joint, node) = (&constraint.name, &self.model.nodes[on.0].name);
            self.mistakes.push(format!("\"{name}\" asks for the load of \"{joint}\" on \"{node}\", which it does not hold"));
            return;
        };
        let first = self.model.dof_count(&constraint.nodes[..place]);
        let node = first..first + self.model.dof_count(&[on]);
        let body = kind_on.has_axes();
        let moment = matches!(kind, LoadKind::Moment | LoadKind::MomentNorm);
        let held = kind_on.in_space().filter(|_| body || !moment);
        let Some(held) = held else {
            let (node, what) = (&self.model.nodes[on.0].name, if moment { "moment" } else { "force" });
            self.mistakes.push(format!("\"{name}\" asks for a {what} on \"{node}\", which takes none"));
            return;
        };
        let turns = body && frame == LoadFrame::Body;
        let direction = if turns { self.local_direction(on, direction) } else { direction };
        let p = [direction.components(), self.local_point(on, point).components()].concat();
        let parameters = self.add_numbers(&p);
        let measured = Measured::Load { joint, parameters, load: JointLoad::new(kind, frame, node, held) };
        let unit = if moment { "N m" } else { "N" };
        self.functionals.push(Functional { name: name.into(), unit, measured, over });
    }
}
