//! The host of every subject: an arm on a spherical joint under oblique gravity, and on it what the subject needs.

use super::cable::CableSubject;
use super::measures::Seen;
use super::scenes::{Case, Subject};
use costate::elements::entries::{GivenValue, JointPart, Values};
use costate::elements::forces::{DAMPERS, SPRINGS};
use costate::elements::{NodeKind, TimeFunction, joints};
use costate::internals::{AppliedForce, AppliedTorque};
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{BushingRates, ConstraintId, MechanismBuilder, NodeId, SpringDamper};
use std::ops::Range;

/// Where a joint between arm and link stands.
struct Host<'f, S> {
    both: [NodeId; 2],
    /// On the other side of the arm, with place and axis of its joint.
    third: NodeId,
    other: (Vector3<S>, Vector3<S>),
    elbow: Vector3<S>,
    /// The elbow, or the place of a point mass.
    held: Vector3<S>,
    ends: [Vector3<S>; 2],
    axis: Vector3<S>,
    /// Parameters of the function of time.
    function: &'f [S],
}

/// The name of what is tested.
const NAME: &str = "subject";

/// The entry of a joint between both bodies, and the values of its keys.
fn entry<S: Scalar>(kind: &Subject, host: &Host<S>) -> Option<(&'static JointPart, Values<S>)> {
    use Subject::*;
    let Host { elbow, held, ends, axis, function, .. } = *host;
    let (at_elbow, along) = (("point", elbow.into()), ("axis", axis.into()));
    let motion = |of: &TimeFunction| GivenValue::Function(of.clone(), function.to_vec());
    let (name, values) = match kind {
        Spherical(_) => ("spherical", vec![("point", held.into())]),
        Revolute => ("revolute", vec![at_elbow, along]),
        Fixed => ("fixed", vec![at_elbow]),
        Distance => ("distance", vec![("points", GivenValue::Vectors(ends.to_vec()))]),
        Prismatic => ("prismatic", vec![at_elbow, along]),
        Cylindrical => ("cylindrical", vec![at_elbow, along]),
        Planar => ("planar", vec![at_elbow, ("normal", axis.into())]),
        Universal => ("universal", vec![at_elbow, ("pin_a", axis.into()), ("pin_b", axis.perpendiculars()[0].into())]),
        Helical => ("helical", vec![at_elbow, along, ("pitch", S::from(0.8).into())]),
        RigidLink(_) => ("rigid_link", vec![]),
        PointOnLine(_) => ("point_on_line", vec![("point", held.into()), along]),
        PointInPlane(_) => ("point_in_plane", vec![("point", held.into()), ("normal", axis.into())]),
        Rotation(angle) => ("rotation", vec![along, ("angle", motion(angle))]),
        Translation(path) => {
            ("translation", vec![along, ("origin", elbow.into()), at_elbow, ("displacement", motion(path))])
        }
        _ => return None,
    };
    Some((joints::named(name)?, values))
}

/// Adds a joint of the list, with the hinges that it needs before it.
fn add_joint<S: Scalar>(kind: &Subject, host: &Host<S>, m: &mut MechanismBuilder<S>) -> ConstraintId {
    use Subject::*;
    let Host { both, third, elbow, axis, other: (hinge, _), .. } = *host;
    let name = NAME;
    if matches!(kind, Rotation(_)) {
        m.revolute("hinge", both, elbow, axis);
    }
    if let Some((part, values)) = entry(kind, host) {
        return m.joint(part, name, &both, values);
    }
    match kind {
        TiedNode => {
            let weights = [0.6, 0.4].map(S::from);
            let start = m.rotation(both[0]);
            let mean = m.position(both[0]) * weights[0] + m.position(third) * weights[1];
            let offset = start.rotate_back(m.position(both[1]) - mean).components();
            let relative = start.conjugate().times(m.rotation(both[1])).0;
            let p: Vec<S> = weights.into_iter().chain(offset).chain(relative).collect();
            let tied = costate::internals::TiedNode { carriers: 2, b: NodeKind::Body };
            m.constraint(name, &[both[0], third, both[1]], tied, &p)
        }
        RackAndPinion => {
            let [across, along] = axis.perpendiculars();
            m.revolute("hinge", both, elbow, axis);
            m.prismatic("guide", [both[0], third], hinge, along);
            let contact = elbow + across * S::from(0.3);
            m.rack_and_pinion(name, [both[0], both[1], third], [elbow, contact], axis)
        }
        JointAngle => {
            let angles = joint_angles([name, "other angle"], host, m);
            m.gear("gear", angles, RADII.map(S::from))
        }
        Gear => {
            let angles = joint_angles(["angle", "other angle"], host, m);
            m.gear(name, angles, RADII.map(S::from))
        }
        DiscOnPlane | RollingDisc => {
            let [along, across] = axis.perpendiculars();
            let rim = elbow - across * S::from(0.2);
            let subject = usize::from(matches!(kind, RollingDisc));
            let names = [[name, "rolling"], ["contact", name]][subject];
            m.rolling_disc(names, both, (elbow, along), (rim, axis + across), S::from(0.3))[subject]
        }
        RollingSphere => m.rolling_sphere(["contact", name], both, elbow, axis, S::from(0.3))[1],
        other => unreachable!("{other:?} is no joint"),
    }
}

/// Pitch radii of the gears [m].
const RADII: [f64; 2] = [0.3, 0.2];

/// Hinges on both sides of the arm, with coordinates for their angles.
fn joint_angles<S: Scalar>(names: [&str; 2], host: &Host<S>, m: &mut MechanismBuilder<S>) -> [NodeId; 2] {
    let Host { both, third, elbow, axis, other: (hinge, other_axis), .. } = *host;
    let other = [both[0], third];
    m.revolute("hinge", both, elbow, axis);
    m.revolute("other hinge", other, hinge, other_axis);
    [m.joint_angle(names[0], both, axis), m.joint_angle(names[1], other, other_axis)]
}

/// Adds the soft version of a joint.
fn softened<S: Scalar>(kind: &Subject, host: &Host<S>, m: &mut MechanismBuilder<S>) {
    let equations = match kind {
        Subject::Spherical(_) => 3,
        Subject::Universal => 4,
        Subject::Revolute | Subject::Prismatic | Subject::Helical => 5,
        _ => 1,
    };
    let [stiffness, damping] = [60.0, 1.5].map(|c| vec![S::from(c); equations]);
    let rates = [&stiffness[..], &damping];
    if let Subject::Gear = kind {
        let angles = joint_angles(["angle", "other angle"], host, m);
        let radii = GivenValue::Numbers(RADII.map(S::from).to_vec());
        m.soft_joint(joints::named("gear").expect("an entry"), NAME, &angles, [("radii", radii)], rates);
        return;
    }
    if let Subject::Rotation(_) = kind {
        m.revolute("hinge", host.both, host.elbow, host.axis);
    }
    let (part, values) = entry(kind, host).expect("an entry");
    m.soft_joint(part, NAME, &host.both, values, rates);
}

impl Case {
    /// The host mechanism with the subject, a beam by its numbers; returns the place of the subject's parameters.
    pub fn mechanism<S: Scalar>(&self, start: &[S], beam: &[S], m: &mut MechanismBuilder<S>) -> (Seen, Range<usize>) {
        use Subject::*;
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let [turn, spin] = start else { unreachable!("two start variables") };
        let spin = &(if self.statics { S::zero() } else { *spin });
        // everything turns about the shoulder with `turn`, and every velocity grows with `spin`
        let whole = Quaternion::about(at([1.0, 2.0, -1.0]).unit(), *turn);
        let shoulder = at([0.1, -0.2, 0.3]);
        let place = |x: [f64; 3]| shoulder + whole.rotate(at(x));
        let elbow = place([0.6, 0.3, -0.5]);
        let omega = at([1.1, -0.7, 0.9]) * *spin;
        let axis = whole.rotate(at([0.3, 1.0, 0.4])).unit();
        // an angle about an axis needs a hinge that keeps it: a free link would pass poses without an angle
        let geared = matches!(self.kind(), RackAndPinion | JointAngle | Gear);
        let hinged = geared
            || matches!(self.kind(), Spring("torsion") | Spring("torsion_law") | Spring("angle"))
            || matches!(&self.subject, Soft(joint) if matches!(**joint, Rotation(_)));
        let second_omega = if hinged { omega + axis * (*spin * 1.5) } else { at([-0.8, 0.6, 1.3]) * *spin };
        let elbow_velocity = omega.cross(&(elbow - shoulder));

        let ground = m.ground();
        let arm_rotation = whole.times(Quaternion::about(at([2.0, -1.0, 2.0]).unit(), S::from(0.7)));
        let arm = m.body("arm", place([0.3, 0.1, -0.2]), arm_rotation);
        m.set_velocity(arm, omega.cross(&(m.position(arm) - shoulder)), omega);
        let inertia = [0.21, 0.17, 0.12, 0.02, -0.03, 0.015].map(S::from);
        m.rigid_body("arm", arm, S::from(1.3), at([0.05, -0.04, 0.07]), inertia);
        let shoulder_joint = m.spherical("shoulder", [ground, arm], shoulder);

        // a subject on one body needs no second one
        let alone = matches!(
            self.subject,
            RigidBody | GravityOnBody | Force(NodeKind::Body, ..) | Torque(..) | Beam(_) | Cable(_) | Shell(_)
        );
        let position = place([0.8, -0.2, -0.8]);
        let velocity = elbow_velocity + second_omega.cross(&(position - elbow));
        let light = matches!(
            self.kind(),
            PointMass
                | GravityOnPoint
                | Damper("vector")
                | Force(NodeKind::Point, ..)
                | Spherical(NodeKind::Point)
                | RigidLink(NodeKind::Point)
                | PointOnLine(NodeKind::Point)
                | PointInPlane(NodeKind::Point)
        );
        let second = if alone {
            arm
        } else if light {
            let bob = m.point("bob", position);
            m.set_velocity(bob, velocity, Vector3::zeros());
            m.point_mass("bob", bob, S::from(0.4));
            bob
        } else {
            let rotation = whole.times(Quaternion::about(at([-1.0, 2.0, 2.0]).unit(), S::from(-0.5)));
            let natural = matches!(self.kind(), NaturalBody | Spherical(NodeKind::Natural));
            let link = if natural { m.natural_body("link", position, rotation) } else { m.body("link", position, rotation) };
            m.set_velocity(link, velocity, second_omega);
            let inertia = [0.06, 0.09, 0.07, -0.01, 0.012, 0.008].map(S::from);
            m.rigid_body("link", link, S::from(0.6), at([-0.03, 0.06, 0.02]), inertia);
            link
        };
        // gears and racks have a third body, on the other side of the arm, and so has what two bodies carry
        let tied = matches!(self.kind(), TiedNode);
        let third = (geared || tied).then(|| {
            let rotation = if tied { arm_rotation } else { whole.times(arm_rotation) };
            let third = m.body("third", place([-0.3, 0.4, 0.2]), rotation);
            m.set_velocity(third, omega.cross(&(m.position(third) - shoulder)), omega);
            let inertia = [0.05, 0.07, 0.06, 0.008, -0.01, 0.006].map(S::from);
            m.rigid_body("third", third, S::from(0.5), at([0.02, 0.03, -0.04]), inertia);
            third
        });
        let f: Vec<S> = self.function.iter().map(|&f| S::from(f)).collect();
        let flexible = match &self.subject {
            Beam(subject) => {
                let own = subject.add(m, [shoulder, elbow], beam, &f);
                // as if it were stretched: nodes in between are slower than the elbow
                for (i, &node) in own.nodes.iter().enumerate().skip(1) {
                    m.set_velocity(node, elbow_velocity * S::from(0.25 * i as f64), Vector3::zeros());
                }
                m.revolute("elbow", [own.end(), arm], elbow, axis);
                Some(own)
            }
            _ => None,
        };
        let mut joint = None;
        let cable = match &self.subject {
            Cable(subject) => {
                let (own, [corner, end]) = subject.add(m, [shoulder, elbow], arm);
                match subject {
                    CableSubject::Corner => joint = Some(corner),
                    CableSubject::End(_) => joint = Some(end),
                    _ => {}
                }
                m.set_velocity(own.nodes[1], elbow_velocity * S::from(0.3), omega * S::from(0.2));
                Some(own)
            }
            _ => None,
        };
        let shell = match &self.subject {
            Shell(subject) => {
                let own = subject.add(m, arm, arm_rotation, &f);
                for &node in &own.nodes[1..] {
                    m.set_velocity(node, omega.cross(&(m.position(node) - shoulder)), omega);
                }
                Some(own)
            }
            _ => None,
        };
        m.gravity(at([0.6, -0.9, -9.7]));

        let both = [arm, second];
        let ends = [place([0.2, 0.4, 0.1]), if light { position } else { place([0.9, -0.5, -0.6]) }];
        let name = NAME;
        let hinge = place([-0.2, 0.3, 0.1]);
        let host = Host {
            both,
            third: third.unwrap_or(arm),
            elbow,
            held: if light { position } else { elbow },
            ends,
            axis,
            other: (hinge, whole.rotate(at([-0.2, 0.5, 1.0]))),
            function: &f,
        };
        match &self.subject {
            RigidBody | NaturalBody | Cable(_) | Shell(_) | PointMass | GravityOnBody | GravityOnPoint | Beam(_) => {}
            Spring("line") => drop(m.line_spring(name, both, ends, S::from(60.0), S::from(0.7))),
            Damper("line") => drop(m.line_damper(name, both, ends, S::from(3.0))),
            Damper("vector") => drop(m.vector_damper(name, both, ends, S::from(2.0))),
            Spring("torsion") => drop(m.torsion_spring_damper(name, both, axis, spring_damper([8.0, 0.5, -0.4]))),
            Force(on, frame, size) => {
                let p = [vec![0.5, -0.3, 0.8].into_iter().chain([0.2, -0.1, 0.3]).map(S::from).collect(), f].concat();
                let node = if *on == NodeKind::Body { arm } else { second };
                m.element(name, &[node], AppliedForce { on: *on, frame: *frame, size: size.clone() }, &p);
            }
            Torque(frame, size) => {
                let p = [[0.7, 0.4, -0.5].map(S::from).to_vec(), f].concat();
                m.element(name, &[arm], AppliedTorque { on: NodeKind::Body, frame: *frame, size: size.clone() }, &p);
            }
            Spring("slide") => drop(m.slide_spring_damper(name, both, ends, axis, spring_damper([60.0, 2.0, 0.1]))),
            Spring("angle") => {
                let angle = m.joint_angle("angle", both, axis);
                m.coordinate_spring_damper(name, angle, 0, spring_damper([8.0, 0.5, -0.4]));
            }
            Spring("bushing") => {
                let rates = BushingRates {
                    stiffness_along: [60.0, 50.0, 70.0].map(S::from),
                    stiffness_about: [8.0, 7.0, 9.0].map(S::from),
                    damping_along: [2.0, 1.0, 1.5].map(S::from),
                    damping_about: [0.5, 0.6, 0.4].map(S::from),
                };
                m.bushing(name, both, elbow, arm_rotation, rates);
            }
            // as in its example
            Spring(kind) | Damper(kind) => {
                let list = if matches!(self.subject, Spring(_)) { SPRINGS } else { DAMPERS };
                let Some(part) = list.iter().find(|part| part.form.name == *kind) else { unreachable!("no {kind} is made") };
                m.spring(part, name, &both, part.example_values(shoulder, whole));
            }
            Soft(kind) => softened(kind, &host, m),
            kind => joint = Some(add_joint(kind, &host, m)),
        }
        if joint.is_none() && !alone && !matches!(self.subject, Soft(_) | Spring("bushing")) {
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
            NaturalBody => "link",
            Cable(subject) => subject.part(),
            Shell(subject) => subject.part(),
            PointMass => "bob",
            GravityOnBody => "weight of arm",
            GravityOnPoint => "weight of bob",
            Beam(subject) => subject.part().unwrap_or(name),
            _ => name,
        };
        let element = m.model.elements.iter().find(|e| e.name == subject);
        // without the sides of its switches behind them
        let element = element.map(|e| e.parameters.start..e.parameters.start + e.physics.parameter_list().len());
        let constraint = m.model.constraints.iter().find(|c| c.name == subject);
        let places = constraint.map_or(element.unwrap_or(0..0), |constraint| constraint.parameters.clone());
        let equations = constraint.map_or(3, |constraint| constraint.equations.len());
        let second_is = m.model.node(second).kind.in_space().unwrap_or(NodeKind::Body);
        let joint = joint.unwrap_or(shoulder_joint);
        let shoulder = shoulder_joint;
        (Seen { arm, second, second_is, ground, shoulder, joint, equations, beam: flexible, cable, shell }, places)
    }
}

fn spring_damper<S: Scalar>([stiffness, damping, rest]: [f64; 3]) -> SpringDamper<S> {
    SpringDamper { stiffness: S::from(stiffness), damping: S::from(damping), rest: S::from(rest) }
}
