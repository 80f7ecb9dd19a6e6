//! Joints and motion drivers, by their entries.

use super::MechanismBuilder;
use super::entries::{entry, methods_by_entry};
use crate::assembly::{ConstraintId, ElementId, NodeId};
use crate::elements::TimeFunction;
use crate::elements::entries::{GivenValue, JointPart, Values};
use crate::elements::joints::{AngleCoordinate, DRIVERS, HeldSlope, JOINTS};
use crate::scalar::{Scalar, Vector3};
use crate::scenes::Signal;

impl<S: Scalar> MechanismBuilder<S> {
    /// Adds a joint or driver by its entry, one of a list or of your own: `m.joint(&JointPart::of::<MyJoint>(), "name", &[a, b], keys)`.
    pub fn joint(&mut self, part: &JointPart, name: &str, nodes: &[NodeId], keys: impl Into<Values<S>>) -> ConstraintId {
        match self.build_part(part, name, nodes, keys.into()) {
            Some((law, p)) => self.add_constraint(name, nodes, law.rigid(), &p),
            None => self.model.refused_constraint(),
        }
    }

    /// The same joint softly: springs and dampers with a stiffness and a damping for each of its equations
    /// (`elements::forces::Soft`).
    pub fn soft_joint(
        &mut self,
        part: &JointPart,
        name: &str,
        nodes: &[NodeId],
        keys: impl Into<Values<S>>,
        [stiffness, damping]: [&[S]; 2],
    ) -> ElementId {
        let Some((law, p)) = self.build_part(part, name, nodes, keys.into()) else { return self.model.refused_element() };
        let count = law.equations();
        if [stiffness.len(), damping.len()] != [count; 2] {
            let (stiffnesses, dampings) = (stiffness.len(), damping.len());
            self.mistakes.push(format!(
                "\"{name}\" has {count} equations, but {stiffnesses} stiffnesses and {dampings} dampings were given"
            ));
            return self.model.refused_element();
        }
        self.add_element(name, nodes, law.soft(), &[stiffness, damping, &p].concat())
    }

    /// The value of a key that is a function of time; what is wrong with it is told with the other mistakes.
    pub(super) fn function_value(&mut self, name: &str, signal: Signal<S>) -> GivenValue<S> {
        let (function, numbers) = signal.parts().unwrap_or_else(|why| {
            self.mistakes.push(format!("\"{name}\": {why}"));
            (TimeFunction::Constant, vec![S::zero()])
        });
        GivenValue::Function(function, numbers)
    }

    /// A coordinate that counts the angle of b against a about a world axis over any number of turns \[rad\], zero at the start.
    ///
    /// It is a node: for gears, springs, drivers and functionals of the angle. A joint must hold the axis.
    pub fn joint_angle(&mut self, name: &str, nodes: [NodeId; 2], axis: Vector3<S>) -> NodeId {
        let angle = self.coordinates(name, &[S::zero()], &[S::zero()]);
        if nodes.iter().any(|&node| self.kind_of(name, node).is_none()) {
            return angle;
        }
        let ([a, b], axis, p) = self.asked(name, &nodes, |given| {
            let (bodies, axis) = (given.bodies(), given.unit_of(axis));
            (bodies, axis, given.angle_frame(axis))
        });
        self.add_constraint(name, &[nodes[0], nodes[1], angle], AngleCoordinate([a, b]).into(), &p);
        self.angles.push((angle, nodes, axis));
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
        self.joint(entry(JOINTS, "gear"), name, &angles, [("radii", GivenValue::Numbers(radii.to_vec()))])
    }

    /// Drives the angle of b against a about a world axis \[rad\]; the angle is zero at the start of the geometry.
    pub fn prescribed_rotation(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        axis: Vector3<S>,
        angle: Signal<S>,
    ) -> ConstraintId {
        let angle = self.function_value(name, angle);
        self.joint(entry(DRIVERS, "rotation"), name, &nodes, [("axis", axis.into()), ("angle", angle)])
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
        let path = self.function_value(name, displacement);
        let keys = [("axis", axis.into()), ("origin", origin.into()), ("point", point.into()), ("displacement", path)];
        self.joint(entry(DRIVERS, "translation"), name, &nodes, keys)
    }

    /// A cable's node welded to a body as it stands at the start: nodes (body, cable's node).
    ///
    /// [`HeldSlope::Direction`] leaves the stretch free; [`HeldSlope::Vector`] keeps it.
    pub fn cable_weld(&mut self, name: &str, nodes: [NodeId; 2], held: HeldSlope) -> ConstraintId {
        let held = match held {
            HeldSlope::Direction => "direction",
            HeldSlope::Vector => "vector",
            HeldSlope::Plane => {
                self.mistakes
                    .push(format!("\"{name}\": a weld holds the direction or the vector of the slope; take cable_hinge"));
                return self.model.refused_constraint();
            }
        };
        self.joint(entry(JOINTS, "cable_weld"), name, &nodes, [("holds", GivenValue::Word(held.into()))])
    }
}

methods_by_entry! { JOINTS.joint -> ConstraintId;
    /// A spherical joint at a world point \[m\].
    spherical "spherical" (nodes: [NodeId; 2], point: Vector3<S>) on &nodes => point;
    /// A massless link between two world points \[m\], as long as they are apart at the start.
    distance "distance" (nodes: [NodeId; 2], points: [Vector3<S>; 2]) on &nodes => points;
    /// A revolute joint at a world point \[m\] about a world axis.
    revolute "revolute" (nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) on &nodes => point, axis;
    /// Two bodies welded together at a world point \[m\].
    fixed "fixed" (nodes: [NodeId; 2], point: Vector3<S>) on &nodes => point;
    /// Node b, a point or a body, carried along by body a as it stands at the start.
    rigid_link "rigid_link" (nodes: [NodeId; 2]) on &nodes => ;
    /// A prismatic joint: b slides along a world axis of a without turning; the world point \[m\] is where forces are measured.
    prismatic "prismatic" (nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) on &nodes => point, axis;
    /// A cylindrical joint: b slides along and turns about a world axis through a world point \[m\].
    cylindrical "cylindrical" (nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) on &nodes => point, axis;
    /// A planar joint: b slides on the plane of a through a world point \[m\] with a world normal, and turns about the normal.
    planar "planar" (nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) on &nodes => point, normal;
    /// A universal joint at a world point \[m\]; its cross has one pin in a and one in b, at right angles.
    universal "universal" (nodes: [NodeId; 2], point: Vector3<S>, [pin_a, pin_b]: [Vector3<S>; 2])
        on &nodes => point, pin_a, pin_b;
    /// A screw along a world axis through a world point \[m\]: b advances by the pitch [m per turn], negative for a left-handed thread.
    helical "helical" (nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>, pitch: S) on &nodes => point, axis, pitch;
    /// A world point \[m\] of b, a point or a body, on the line of a through it along a world direction.
    point_on_line "point_on_line" (nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) on &nodes => point, axis;
    /// A world point \[m\] of b, a point or a body, in the plane of a through it with a world normal.
    point_in_plane "point_in_plane" (nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) on &nodes => point, normal;
    /// A rack on a pinion, nodes [carrier, pinion, rack]: the pinion turns about a world axis through `centre`, and its pitch circle
    /// touches the rack at `contact` \[m\]. Radius and direction follow; guide both by joints to the carrier.
    rack_and_pinion "rack_and_pinion" (nodes: [NodeId; 3], [centre, contact]: [Vector3<S>; 2], axis: Vector3<S>)
        on &nodes => centre, contact, axis;
    /// A cable's node on a hinge of a body about a world axis, which must be at right angles to the cable: nodes (body, cable's node).
    cable_hinge "cable_hinge" (nodes: [NodeId; 2], axis: Vector3<S>) on &nodes => axis;
    /// Nodes of two cables welded to each other as they stand at the start, at any angle but 0 and 180 degrees.
    cable_corner "cable_corner" (nodes: [NodeId; 2]) on &nodes => ;
}
