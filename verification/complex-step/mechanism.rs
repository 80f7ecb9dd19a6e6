//! The host of every subject: an arm on a spherical joint under oblique gravity, and on it what the subject needs.

use super::measures::Seen;
use super::scenes::{Case, Subject};
use costate::elements::Anchor;
use costate::elements::forces::{AppliedForce, AppliedTorque};
use costate::scalar::{Quaternion, Scalar, Vec3};
use costate::scenes::MechanismBuilder;
use std::ops::Range;

impl Case {
    /// The host mechanism with the subject; returns the place of the subject's parameters.
    pub fn mechanism<S: Scalar>(&self, start: &[S], m: &mut MechanismBuilder<S>) -> (Seen, Range<usize>) {
        use Subject::*;
        let at = |x: [f64; 3]| Vec3::<S>::from_f64(x);
        let [turn, spin] = start else { unreachable!("two start variables") };
        // everything turns about the shoulder with `turn`, and every velocity grows with `spin`
        let whole = Quaternion::about(at([1.0, 2.0, -1.0]).normalized(), *turn);
        let shoulder = at([0.1, -0.2, 0.3]);
        let place = |x: [f64; 3]| shoulder + whole.rotate(at(x));
        let elbow = place([0.6, 0.3, -0.5]);
        let omega = at([1.1, -0.7, 0.9]) * *spin;
        let axis = whole.rotate(at([0.3, 1.0, 0.4])).normalized();
        // an angle about an axis needs a hinge that keeps it: a free link would pass poses without an angle
        let geared = matches!(self.subject, RackAndPinion | JointAngle | Gear);
        let hinged = geared || matches!(self.subject, TorsionSpringDamper);
        let second_omega = if hinged { omega + axis * (*spin * 1.5) } else { at([-0.8, 0.6, 1.3]) * *spin };
        let elbow_velocity = omega.cross(elbow - shoulder);

        let ground = m.ground();
        let arm_rotation = whole.times(Quaternion::about(at([2.0, -1.0, 2.0]).normalized(), S::from(0.7)));
        let arm = m.body("arm", place([0.3, 0.1, -0.2]), arm_rotation);
        m.set_velocity(arm, omega.cross(m.position(arm) - shoulder), omega);
        let inertia = [0.21, 0.17, 0.12, 0.02, -0.03, 0.015].map(S::from);
        m.rigid_body("arm", arm, S::from(1.3), at([0.05, -0.04, 0.07]), inertia);
        let shoulder_joint = m.spherical("shoulder", [ground, arm], shoulder);

        // a subject on one body needs no second one
        let alone = matches!(self.subject, RigidBody | GravityOnBody | Force(Anchor::Body, ..) | Torque(..));
        let position = place([0.8, -0.2, -0.8]);
        let velocity = elbow_velocity + second_omega.cross(position - elbow);
        let light = matches!(
            self.subject,
            PointMass
                | GravityOnPoint
                | VectorDamper
                | Force(Anchor::Point, ..)
                | Spherical(Anchor::Point)
                | RigidLink(Anchor::Point)
                | PointOnLine(Anchor::Point)
                | PointInPlane(Anchor::Point)
        );
        let second = if alone {
            arm
        } else if light {
            let bob = m.point("bob", position);
            m.set_velocity(bob, velocity, Vec3::zero());
            m.point_mass("bob", bob, S::from(0.4));
            bob
        } else {
            let rotation = whole.times(Quaternion::about(at([-1.0, 2.0, 2.0]).normalized(), S::from(-0.5)));
            let link = m.body("link", position, rotation);
            m.set_velocity(link, velocity, second_omega);
            let inertia = [0.06, 0.09, 0.07, -0.01, 0.012, 0.008].map(S::from);
            m.rigid_body("link", link, S::from(0.6), at([-0.03, 0.06, 0.02]), inertia);
            link
        };
        // gears and racks have a third body, on the other side of the arm
        let third = geared.then(|| {
            let third = m.body("third", place([-0.3, 0.4, 0.2]), whole.times(arm_rotation));
            m.set_velocity(third, omega.cross(m.position(third) - shoulder), omega);
            let inertia = [0.05, 0.07, 0.06, 0.008, -0.01, 0.006].map(S::from);
            m.rigid_body("third", third, S::from(0.5), at([0.02, 0.03, -0.04]), inertia);
            third
        });
        m.gravity(at([0.6, -0.9, -9.7]));

        let both = [arm, second];
        let ends = [place([0.2, 0.4, 0.1]), place([0.9, -0.5, -0.6])];
        let f: Vec<S> = self.function.iter().map(|&f| S::from(f)).collect();
        let name = "subject";
        let held = if light { position } else { elbow };
        let mut joint = None;
        match &self.subject {
            RigidBody | PointMass | GravityOnBody | GravityOnPoint => {}
            LineSpring => drop(m.line_spring(name, both, ends, S::from(60.0), S::from(0.7))),
            LineDamper => drop(m.line_damper(name, both, ends, S::from(3.0))),
            VectorDamper => drop(m.vector_damper(name, both, ends, S::from(2.0))),
            TorsionSpringDamper => drop(m.torsion_spring_damper(name, both, axis, [8.0, 0.5, -0.4].map(S::from))),
            Force(on, frame, size) => {
                let p = [vec![0.5, -0.3, 0.8].into_iter().chain([0.2, -0.1, 0.3]).map(S::from).collect(), f].concat();
                let node = if *on == Anchor::Body { arm } else { second };
                m.element(name, &[node], AppliedForce { on: *on, frame: *frame, size: size.clone() }, &p);
            }
            Torque(frame, size) => {
                let p = [[0.7, 0.4, -0.5].map(S::from).to_vec(), f].concat();
                m.element(name, &[arm], AppliedTorque { frame: *frame, size: size.clone() }, &p);
            }
            Spherical(_) => joint = Some(m.spherical(name, both, held)),
            Prismatic => joint = Some(m.prismatic(name, both, elbow, axis)),
            Cylindrical => joint = Some(m.cylindrical(name, both, elbow, axis)),
            Planar => joint = Some(m.planar(name, both, elbow, axis)),
            Universal => joint = Some(m.universal(name, both, elbow, [axis, axis.perpendiculars()[0]])),
            Helical => joint = Some(m.helical(name, both, elbow, axis, S::from(0.8))),
            RigidLink(_) => joint = Some(m.rigid_link(name, both)),
            PointOnLine(_) => joint = Some(m.point_on_line(name, both, held, axis)),
            PointInPlane(_) => joint = Some(m.point_in_plane(name, both, held, axis)),
            RackAndPinion => {
                let [across, along] = axis.perpendiculars();
                let rack = third.unwrap_or(arm);
                m.revolute("hinge", both, elbow, axis);
                m.prismatic("guide", [arm, rack], place([-0.2, 0.3, 0.1]), along);
                joint = Some(m.rack_and_pinion(name, [arm, second, rack], [elbow, elbow + across * S::from(0.3)], axis));
            }
            JointAngle | Gear => {
                let other = [arm, third.unwrap_or(arm)];
                let other_axis = whole.rotate(at([-0.2, 0.5, 1.0]));
                m.revolute("hinge", both, elbow, axis);
                m.revolute("other hinge", other, place([-0.2, 0.3, 0.1]), other_axis);
                let [counted, teeth] = if matches!(self.subject, Gear) { ["angle", name] } else { [name, "gear"] };
                let angles = [m.joint_angle(counted, both, axis), m.joint_angle("other angle", other, other_axis)];
                let gear = m.gear(teeth, angles, [0.3, 0.2].map(S::from));
                joint = Some(gear);
            }
            Revolute => joint = Some(m.revolute(name, both, elbow, axis)),
            Fixed => joint = Some(m.fixed(name, both, elbow)),
            Distance => joint = Some(m.distance(name, both, ends)),
            Rotation(angle) => {
                m.revolute("hinge", both, elbow, axis);
                joint = Some(m.prescribed_rotation(name, both, axis, angle.clone(), &f));
            }
            Translation(path) => joint = Some(m.prescribed_translation(name, both, [elbow; 2], axis, path.clone(), &f)),
        }
        if joint.is_none() && !alone {
            if hinged {
                m.revolute("elbow", both, elbow, axis);
            } else if light {
                m.distance("elbow", both, [elbow, position]);
            } else {
                m.spherical("elbow", both, elbow);
            }
        }
        let subject = match &self.subject {
            RigidBody => "arm",
            PointMass => "bob",
            GravityOnBody => "weight of arm",
            GravityOnPoint => "weight of bob",
            _ => name,
        };
        let element = m.model.elements.iter().find(|e| e.name == subject).map(|e| e.parameters.clone());
        let constraint = m.model.constraints.iter().find(|c| c.name == subject);
        let places = constraint.map_or(element.unwrap_or(0..0), |constraint| constraint.parameters.clone());
        let equations = constraint.map_or(3, |constraint| constraint.equations.len());
        let second_is = if light { Anchor::Point } else { Anchor::Body };
        (Seen { arm, second, second_is, joint: joint.unwrap_or(shoulder_joint), equations }, places)
    }
}
