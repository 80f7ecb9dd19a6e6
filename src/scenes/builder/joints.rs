//! Joints and motion drivers, by their entries.

use super::MechanismBuilder;
use super::entries::{Wrong, entry};
use crate::assembly::{ConstraintId, ElementId, NodeId};
use crate::elements::TimeFunction;
use crate::elements::entries::{GivenValue, JointPart, Values};
use crate::elements::joints::{AngleCoordinate, DRIVERS, HeldSlope, JOINTS};
use crate::scalar::{Scalar, Vector3};
use crate::scenes::Signal;

impl<S: Scalar> MechanismBuilder<S> {
    /// Adds a joint or driver by its entry.
    ///
    /// # Errors
    /// What is wrong with its nodes or the values of its keys.
    pub(in crate::scenes) fn rigid_part(
        &mut self,
        part: &JointPart,
        name: &str,
        nodes: &[NodeId],
        values: Values<S>,
    ) -> Result<ConstraintId, Vec<Wrong>> {
        let (law, p) = self.made(part, name, nodes, values)?;
        Ok(self.add_constraint(name, nodes, law.rigid(), &p))
    }

    /// Adds springs and dampers in place of the equations of a joint.
    ///
    /// # Errors
    /// What is wrong with its nodes, the values of its keys, or the numbers of stiffnesses and dampings.
    pub(in crate::scenes) fn soft_part(
        &mut self,
        part: &JointPart,
        name: &str,
        nodes: &[NodeId],
        values: Values<S>,
        [stiffness, damping]: [&[S]; 2],
    ) -> Result<ElementId, Vec<Wrong>> {
        let (law, p) = self.made(part, name, nodes, values)?;
        let count = law.equations();
        if [stiffness.len(), damping.len()] != [count; 2] {
            let (stiffnesses, dampings) = (stiffness.len(), damping.len());
            let text = format!(
                "\"{name}\" has {count} equations, but {stiffnesses} stiffnesses and {dampings} dampings were given"
            );
            return Err(vec![(None, text)]);
        }
        Ok(self.add_element(name, nodes, law.soft(), &[stiffness, damping, &p].concat()))
    }

    /// Adds a joint or driver by its entry, one of a list or of your own: `m.joint(&JointPart::of::<MyJoint>(), "name", &[a, b], keys)`.
    pub fn joint(&mut self, part: &JointPart, name: &str, nodes: &[NodeId], keys: impl Into<Values<S>>) -> ConstraintId {
        self.rigid_part(part, name, nodes, keys.into()).unwrap_or_else(|wrong| {
            self.tell(name, wrong);
            self.model.refused_constraint()
        })
    }

    /// The same joint softly: springs and dampers with a stiffness and a damping for each of its equations
    /// (`elements::forces::Soft`).
    pub fn soft_joint(
        &mut self,
        part: &JointPart,
        name: &str,
        nodes: &[NodeId],
        keys: impl Into<Values<S>>,
        rates: [&[S]; 2],
    ) -> ElementId {
        self.soft_part(part, name, nodes, keys.into(), rates).unwrap_or_else(|wrong| {
            self.tell(name, wrong);
            self.model.refused_element()
        })
    }

    /// The value of a key that is a function of time; what is wrong with it is told with the other mistakes.
    pub(super) fn function_value(&mut self, name: &str, signal: Signal<S>) -> GivenValue<S> {
        let (function, numbers) = signal.parts().unwrap_or_else(|why| {
            self.mistakes.push(format!("\"{name}\": {why}"));
            (TimeFunction::Constant, vec![S::zero()])
        });
        GivenValue::Function(function, numbers)
    }

    /// A spherical joint at a world point \[m\].
    pub fn spherical(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "spherical"), name, &nodes, [("point", point.into())])
    }

    /// A massless link between two world points \[m\], as long as they are apart at the start.
    pub fn distance(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vector3<S>; 2]) -> ConstraintId {
        self.joint(entry(JOINTS, "distance"), name, &nodes, [("points", ends.into())])
    }

    /// A revolute joint at a world point \[m\] about a world axis.
    pub fn revolute(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "revolute"), name, &nodes, [("point", point.into()), ("axis", axis.into())])
    }

    /// Two bodies welded together at a world point \[m\].
    pub fn fixed(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "fixed"), name, &nodes, [("point", point.into())])
    }

    /// Node b, a point or a body, carried along by body a as it stands at the start.
    pub fn rigid_link(&mut self, name: &str, nodes: [NodeId; 2]) -> ConstraintId {
        self.joint(entry(JOINTS, "rigid_link"), name, &nodes, [])
    }

    /// A prismatic joint: b slides along a world axis of a without turning; the world point \[m\] is where forces are measured.
    pub fn prismatic(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "prismatic"), name, &nodes, [("point", point.into()), ("axis", axis.into())])
    }

    /// A cylindrical joint: b slides along and turns about a world axis through a world point \[m\].
    pub fn cylindrical(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "cylindrical"), name, &nodes, [("point", point.into()), ("axis", axis.into())])
    }

    /// A planar joint: b slides on the plane of a through a world point \[m\] with a world normal, and turns about the normal.
    pub fn planar(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "planar"), name, &nodes, [("point", point.into()), ("normal", normal.into())])
    }

    /// A universal joint at a world point \[m\]; its cross has one pin in a and one in b, at right angles.
    pub fn universal(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, pins: [Vector3<S>; 2]) -> ConstraintId {
        let keys = [("point", point.into()), ("pin_a", pins[0].into()), ("pin_b", pins[1].into())];
        self.joint(entry(JOINTS, "universal"), name, &nodes, keys)
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
        let keys = [("point", point.into()), ("axis", axis.into()), ("pitch", pitch.into())];
        self.joint(entry(JOINTS, "helical"), name, &nodes, keys)
    }

    /// A world point \[m\] of b, a point or a body, on the line of a through it along a world direction.
    pub fn point_on_line(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, along: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "point_on_line"), name, &nodes, [("point", point.into()), ("axis", along.into())])
    }

    /// A world point \[m\] of b, a point or a body, in the plane of a through it with a world normal.
    pub fn point_in_plane(&mut self, name: &str, nodes: [NodeId; 2], point: Vector3<S>, normal: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "point_in_plane"), name, &nodes, [("point", point.into()), ("normal", normal.into())])
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
        let keys = [("centre", centre.into()), ("contact", contact.into()), ("axis", axis.into())];
        self.joint(entry(JOINTS, "rack_and_pinion"), name, &nodes, keys)
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

    /// A cable's node on a hinge of a body about a world axis, which must be at right angles to the cable: nodes (body, cable's node).
    pub fn cable_hinge(&mut self, name: &str, nodes: [NodeId; 2], axis: Vector3<S>) -> ConstraintId {
        self.joint(entry(JOINTS, "cable_hinge"), name, &nodes, [("axis", axis.into())])
    }

    /// Nodes of two cables welded to each other as they stand at the start, at any angle but 0 and 180 degrees.
    pub fn cable_corner(&mut self, name: &str, nodes: [NodeId; 2]) -> ConstraintId {
        self.joint(entry(JOINTS, "cable_corner"), name, &nodes, [])
    }
}
