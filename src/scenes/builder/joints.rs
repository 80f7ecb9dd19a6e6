//! Joints and motion drivers.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::TimeFunction;
use crate::elements::joints::{
    DistanceJoint, FixedJoint, PrescribedRotation, PrescribedTranslation, RevoluteJoint, SphericalJoint,
};
use crate::scalar::{Scalar, Vec3};

impl<S: Scalar> MechanismBuilder<S> {
    pub(super) fn points_between(&self, [a, b]: [NodeId; 2], [on_a, on_b]: [Vec3<S>; 2]) -> Vec<S> {
        self.local_point(a, on_a).0.into_iter().chain(self.local_point(b, on_b).0).collect()
    }

    /// A spherical joint at a world point [m].
    pub fn spherical(&mut self, name: &str, nodes: [NodeId; 2], point: Vec3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.anchor(name, node));
        let p = self.points_between(nodes, [point, point]);
        self.constraint(name, &nodes, SphericalJoint { a, b }, &p)
    }

    /// A massless link between two world points [m], as long as they are apart at the start.
    pub fn distance(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vec3<S>; 2]) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.anchor(name, node));
        let mut p = self.points_between(nodes, ends);
        p.push((ends[1] - ends[0]).norm());
        self.constraint(name, &nodes, DistanceJoint { a, b }, &p)
    }

    /// A revolute joint at a world point [m] about a world axis.
    pub fn revolute(&mut self, name: &str, nodes: [NodeId; 2], point: Vec3<S>, axis: Vec3<S>) -> ConstraintId {
        let axis = axis.normalized();
        let [u, w] = axis.perpendiculars();
        let mut p = self.points_between(nodes, [point, point]);
        let [a, b] = nodes;
        for vector in [self.local_direction(a, u), self.local_direction(a, w), self.local_direction(b, axis)] {
            p.extend(vector.0);
        }
        self.constraint(name, &nodes, RevoluteJoint, &p)
    }

    /// Two bodies welded together at a world point [m].
    pub fn fixed(&mut self, name: &str, nodes: [NodeId; 2], point: Vec3<S>) -> ConstraintId {
        let relative = self.rotation(nodes[0]).conjugate().times(self.rotation(nodes[1]));
        let p = [self.points_between(nodes, [point, point]), relative.0.to_vec()].concat();
        self.constraint(name, &nodes, FixedJoint, &p)
    }

    /// A motion driver needs a function with two derivatives.
    fn check_driver(&mut self, name: &str, function: &TimeFunction) {
        if let TimeFunction::Step { switch } = function {
            self.mistakes.push(format!("driver \"{name}\" would jump at t = {switch} s; give it a smooth ramp or a table"));
        }
    }

    /// Drives the angle of b against a about a world axis [rad]; the angle is zero at the start of the geometry.
    pub fn prescribed_rotation(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        axis: Vec3<S>,
        angle: TimeFunction,
        function_parameters: &[S],
    ) -> ConstraintId {
        self.check_driver(name, &angle);
        let p = [self.angle_frame(nodes, axis), function_parameters.to_vec()].concat();
        self.constraint(name, &nodes, PrescribedRotation { angle }, &p)
    }

    /// Drives a world point of b along a world axis fixed in a, measured from the world point `origin` [m].
    pub fn prescribed_translation(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        [origin, point]: [Vec3<S>; 2],
        axis: Vec3<S>,
        displacement: TimeFunction,
        function_parameters: &[S],
    ) -> ConstraintId {
        self.check_driver(name, &displacement);
        let b = self.anchor(name, nodes[1]);
        let axis = self.local_direction(nodes[0], axis.normalized());
        let p = [self.points_between(nodes, [origin, point]), axis.0.to_vec(), function_parameters.to_vec()].concat();
        self.constraint(name, &nodes, PrescribedTranslation { b, displacement }, &p)
    }
}
