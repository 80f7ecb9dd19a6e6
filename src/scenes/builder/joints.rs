//! Joints and motion drivers.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, Node, NodeId};
use crate::elements::joints::{
    AngleCoordinate, CylindricalJoint, DistanceJoint, FixedJoint, GearJoint, HelicalJoint, PlanarJoint, PointInPlane,
    PointOnLine, PrescribedRotation, PrescribedTranslation, PrismaticJoint, RackAndPinion, RevoluteJoint, RigidLink,
    SphericalJoint, UniversalJoint,
};
use crate::elements::{NodeKind, TimeFunction};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::Signal;

/// How far from a right angle the pins of a universal joint may be.
const RIGHT_ANGLE: f64 = 1e-9;

impl<S: Scalar> MechanismBuilder<S> {
    pub(super) fn points_between(&self, [a, b]: [NodeId; 2], [on_a, on_b]: [Vector3<S>; 2]) -> Vec<S> {
        self.local_point(a, on_a).components().into_iter().chain(self.local_point(b, on_b).components()).collect()
    }

    /// A spherical joint at a world point \[m\].
    pub fn spherical(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let p = self.points_between(nodes, [point, point]);
        self.add_constraint(name, &nodes, SphericalJoint { a, b }.into(), &p)
    }

    /// A massless link between two world points \[m\], as long as they are apart at the start.
    pub fn distance(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vector3<S>; 2]) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let mut p = self.points_between(nodes, ends);
        p.push((ends[1] - ends[0]).length());
        self.add_constraint(name, &nodes, DistanceJoint { a, b }.into(), &p)
    }

    /// Two unit vectors of a at right angles to the axis, and the axis in b: what guides along or about an axis.
    fn guide(&self, [a, b]: [NodeId; 2], axis: Vector3<S>) -> Vec<S> {
        let [u, w] = axis.perpendiculars();
        [self.local_direction(a, u), self.local_direction(a, w), self.local_direction(b, axis)]
            .map(|v| v.components())
            .concat()
    }

    /// Euler parameters of b relative to a.
    fn relative_rotation(&self, [a, b]: [NodeId; 2]) -> Quaternion<S> {
        self.rotation(a).conjugate().times(self.rotation(b))
    }

    /// A revolute joint at a world point \[m\] about a world axis.
    pub fn revolute(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let axis = self.unit(name, axis);
        let p = [self.points_between(nodes, [point; 2]), self.guide(nodes, axis)].concat();
        self.add_constraint(name, &nodes, RevoluteJoint { a, b }.into(), &p)
    }

    /// Two bodies welded together at a world point \[m\].
    pub fn fixed(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let p = [self.points_between(nodes, [point; 2]), self.relative_rotation(nodes).0.to_vec()].concat();
        self.add_constraint(name, &nodes, FixedJoint { a, b }.into(), &p)
    }

    /// Node b, a point or a body, carried along by body a as it stands at the start.
    pub fn rigid_link(&mut self, name: &str, nodes: [NodeId; 2]) -> ConstraintId {
        let [a, b] = [self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])];
        let mut p = self.local_point(nodes[0], self.position(nodes[1])).components().to_vec();
        if b.has_axes() {
            p.extend(self.relative_rotation(nodes).0);
        }
        self.add_constraint(name, &nodes, RigidLink { a, b }.into(), &p)
    }

    /// A prismatic joint: b slides along a world axis of a without turning; the world point \[m\] is where forces are measured.
    pub fn prismatic(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let axis = self.unit(name, axis);
        let normals = &self.guide(nodes, axis)[..6];
        let p = [&self.points_between(nodes, [point; 2])[..], normals, &self.relative_rotation(nodes).0].concat();
        self.add_constraint(name, &nodes, PrismaticJoint { a, b }.into(), &p)
    }

    /// A cylindrical joint: b slides along and turns about a world axis through a world point \[m\].
    pub fn cylindrical(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let axis = self.unit(name, axis);
        let p = [self.points_between(nodes, [point; 2]), self.guide(nodes, axis)].concat();
        self.add_constraint(name, &nodes, CylindricalJoint { a, b }.into(), &p)
    }

    /// A planar joint: b slides on the plane of a through a world point \[m\] with a world normal, and turns about the normal.
    pub fn planar(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let normal = self.unit(name, normal);
        let p = [self.points_between(nodes, [point; 2]), self.guide(nodes, normal)].concat();
        self.add_constraint(name, &nodes, PlanarJoint { a, b }.into(), &p)
    }

    /// A universal joint at a world point \[m\]; its cross has one pin in a and one in b, at right angles.
    pub fn universal(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, pins: [Vector3<S>; 2]) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let [pin_a, pin_b] = pins.map(|pin| self.unit(name, pin));
        let cosine = pin_a.dot(&pin_b).value();
        if cosine.abs() > RIGHT_ANGLE {
            let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            self.mistakes.push(format!(
                "the pins of universal joint \"{name}\" are at {angle:.6} degrees; \
                 they must be at 90: take from one of them its part along the other"
            ));
        }
        let pins = [self.local_direction(nodes[0], pin_a).components(), self.local_direction(nodes[1], pin_b).components()]
            .concat();
        let p = [self.points_between(nodes, [point; 2]), pins].concat();
        self.add_constraint(name, &nodes, UniversalJoint { a, b }.into(), &p)
    }

    /// A screw along a world axis through a world point \[m\]: b advances by the pitch [m per turn], negative for a left-handed thread.
    pub fn helical(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        point: Vector3<S>,
        axis: Vector3<S>,
        pitch: S,
    ) -> ConstraintId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let axis = self.unit(name, axis);
        let reference = self.local_direction(nodes[1], axis.perpendiculars()[0]).components();
        let points = self.points_between(nodes, [point; 2]);
        let p = [&points[..], &self.guide(nodes, axis), &reference, &[pitch]].concat();
        self.add_constraint(name, &nodes, HelicalJoint { a, b }.into(), &p)
    }

    /// A world point \[m\] of b, a point or a body, on the line of a through it along a world direction.
    pub fn point_on_line(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, along: Vector3<S>) -> ConstraintId {
        let [a, b] = [self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])];
        let normals =
            self.unit(name, along).perpendiculars().map(|normal| self.local_direction(nodes[0], normal).components());
        let p = [self.points_between(nodes, [point; 2]), normals.concat()].concat();
        self.add_constraint(name, &nodes, PointOnLine { a, b }.into(), &p)
    }

    /// A world point \[m\] of b, a point or a body, in the plane of a through it with a world normal.
    pub fn point_in_plane(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) -> ConstraintId {
        let [a, b] = [self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])];
        let normal = self.unit(name, normal);
        let p = [&self.points_between(nodes, [point; 2])[..], &self.local_direction(nodes[0], normal).components()].concat();
        self.add_constraint(name, &nodes, PointInPlane { a, b }.into(), &p)
    }

    /// A rack on a pinion, nodes [carrier, pinion, rack]: the pinion turns about a world axis through `centre`, and its pitch circle
    /// touches the rack at `contact` \[m\]. Radius and direction follow; guide both by joints to the carrier.
    pub fn rack_and_pinion(
        &mut self,
        name: &str,
        nodes: [NodeId; 3],
        [centre, contact]: [Vector3<S>; 2],
        axis: Vector3<S>,
    ) -> ConstraintId {
        let kinds = nodes.map(|node| self.kind_of_body(name, node));
        let [carrier, pinion, rack] = nodes;
        let axis = self.unit(name, axis);
        let arm = contact - centre;
        let arm = arm - axis * axis.dot(&arm);
        let radius = arm.length();
        let points = self.points_between([carrier, rack], [contact; 2]);
        let direction = axis.cross(&self.unit(name, arm));
        let direction = self.local_direction(carrier, direction).components();
        let p = [&points[..], &self.angle_frame(name, [carrier, pinion], axis), &direction, &[radius]].concat();
        self.add_constraint(name, &nodes, RackAndPinion { nodes: kinds }.into(), &p)
    }

    /// A coordinate that counts the angle of b against a about a world axis over any number of turns \[rad\], zero at the start.
    ///
    /// It is a node: for gears, springs, drivers and functionals of the angle. A joint must hold the axis.
    pub fn joint_angle(&mut self, name: &str, nodes: [NodeId; 2], axis: Vector3<S>) -> NodeId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let angle = self.coordinates(name, &[S::zero()], &[S::zero()]);
        let p = self.angle_frame(name, nodes, axis);
        self.add_constraint(name, &[nodes[0], nodes[1], angle], AngleCoordinate { a, b }.into(), &p);
        self.angles.push((angle, nodes, axis.unit()));
        self.set_angle_rates();
        angle
    }

    /// Rates of all joint angles, from the angular velocities of their bodies.
    pub(super) fn set_angle_rates(&mut self) {
        for (angle, [a, b], axis) in &self.angles {
            let rate = axis.dot(&(self.angular_velocity(*b) - self.angular_velocity(*a)));
            self.numbers.v[self.model.nodes[angle.0].dofs.start] = rate;
        }
    }

    /// Gears on two joint angles with pitch radii \[m\], as they stand at the start: r1 phi1 + r2 phi2 stays.
    ///
    /// External gears on parallel axes have radii of one sign, internal ones of opposite signs.
    pub fn gear(&mut self, name: &str, angles: [NodeId; 2], radii: [S; 2]) -> ConstraintId {
        let mut offset = S::zero();
        for (node, radius) in angles.into_iter().zip(radii) {
            let Some(kind) = self.kind_of(name, node) else { return self.model.refused_constraint() };
            let Node { name: own, dofs, .. } = &self.model.nodes[node.0];
            if kind != NodeKind::Coordinates(1) {
                let text =
                    format!("gear \"{name}\" needs two joint angles, but node \"{own}\" is none: add one by joint_angle");
                self.mistakes.push(text);
                return self.model.refused_constraint();
            }
            offset += radius * self.numbers.q[dofs.start];
        }
        self.add_constraint(name, &angles, GearJoint.into(), &[radii[0], radii[1], offset])
    }

    /// A motion driver needs a function with two derivatives.
    fn check_driver(&mut self, name: &str, function: &TimeFunction, parameters: &[S]) {
        let values: Vec<f64> = parameters.iter().map(|own| own.value()).collect();
        if let Some(switch) = function.rate_jump(&values).filter(|_| function.parameters("").len() == values.len()) {
            self.mistakes.push(format!(
                "driver \"{name}\" or its rate would jump at t = {switch} s; give it a smooth ramp or a table"
            ));
        }
    }

    /// Drives the angle of b against a about a world axis \[rad\]; the angle is zero at the start of the geometry.
    pub fn prescribed_rotation(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        axis: Vector3<S>,
        angle: Signal<S>,
    ) -> ConstraintId {
        let (angle, function_parameters) = self.function_of(name, angle);
        self.check_driver(name, &angle, &function_parameters);
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let p = [self.angle_frame(name, nodes, axis), function_parameters].concat();
        self.add_constraint(name, &nodes, PrescribedRotation { a, b, angle }.into(), &p)
    }

    /// Drives a world point of b along a world axis fixed in a, measured from the world point `origin` \[m\].
    pub fn prescribed_translation(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        [origin, point]: [Vector3<S>; 2],
        axis: Vector3<S>,
        displacement: Signal<S>,
    ) -> ConstraintId {
        let (displacement, function_parameters) = self.function_of(name, displacement);
        self.check_driver(name, &displacement, &function_parameters);
        let [a, b] = [self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])];
        let axis = self.unit(name, axis);
        let axis = self.local_direction(nodes[0], axis);
        let p = [self.points_between(nodes, [origin, point]), axis.components().to_vec(), function_parameters].concat();
        self.add_constraint(name, &nodes, PrescribedTranslation { a, b, displacement }.into(), &p)
    }
}
