//! The list of small scenes: one element or constraint each, in unsymmetric spatial motion.

use super::measures::{self, Reach, Seen};
use costate::design::DesignVariable;
use costate::elements::forces::{AppliedForce, AppliedTorque, LoadFrame};
use costate::elements::{Anchor, TimeFunction};
use costate::scalar::{Quaternion, Scalar, Vec3};
use costate::scenes::{MechanismBuilder, Scene, Settings};
use std::ops::Range;

/// Length of every run [s].
pub const END: f64 = 1.0;
/// Steps of every run.
pub const STEPS: usize = 50;

/// What a scene puts to the test; all its parameters are design variables.
#[derive(Clone, Debug)]
pub enum Subject {
    RigidBody,
    PointMass,
    GravityOnBody,
    GravityOnPoint,
    LineSpring,
    LineDamper,
    VectorDamper,
    TorsionSpringDamper,
    Force(Anchor, LoadFrame, TimeFunction),
    Torque(LoadFrame, TimeFunction),
    Spherical(Anchor),
    Revolute,
    Fixed,
    Distance,
    Rotation(TimeFunction),
    Translation(TimeFunction),
}

/// One scene of the list.
pub struct Case {
    /// Name in the table.
    pub name: &'static str,
    /// What it tests.
    pub subject: Subject,
    /// Values of the time function, if the subject has one.
    function: Vec<f64>,
    /// The start violates the constraints and is projected onto them.
    projected: bool,
    /// Variables at which the motion has no derivative: they stay out of the difference quotient.
    pub one_sided: &'static [&'static str],
}

/// All scenes. A new element or constraint is one more subject and one line here.
///
/// # Panics
/// Not: the knots of the table increase.
pub fn list() -> Vec<Case> {
    use Subject::*;
    use TimeFunction::*;
    let element = |name, subject, function: &[f64]| Case {
        name,
        subject,
        function: function.into(),
        projected: false,
        one_sided: &[],
    };
    let constraint =
        |name, subject, function: &[f64]| Case { name, subject, function: function.into(), projected: true, one_sided: &[] };
    let table = TimeFunction::table(vec![-0.1, 0.12, 0.31, 0.6]).expect("the knots increase");
    let (world, body) = (LoadFrame::World, LoadFrame::Body);
    let inside = constraint("prescribed-translation-ramp", Translation(SmoothRamp), &[0.02, 0.2, 0.1, 0.3]);
    vec![
        element("rigid-body", RigidBody, &[]),
        constraint("rigid-body-projected", RigidBody, &[]),
        element("point-mass", PointMass, &[]),
        element("gravity-body", GravityOnBody, &[]),
        element("gravity-point", GravityOnPoint, &[]),
        element("line-spring", LineSpring, &[]),
        element("line-damper", LineDamper, &[]),
        element("vector-damper-point", VectorDamper, &[]),
        element("torsion-spring-damper", TorsionSpringDamper, &[]),
        element("force-world-step", Force(Anchor::Body, world, Step { switch: 0.205 }), &[4.0, -6.0]),
        element("force-body-table", Force(Anchor::Body, body, table), &[2.0, 7.0, -3.0, 5.0]),
        element("force-point-sine", Force(Anchor::Point, world, Sine), &[1.0, 4.0, 9.0, 0.4]),
        element("torque-world-rate", Torque(world, ConstantRate), &[0.3, 2.0]),
        element("torque-body-constant", Torque(body, Constant), &[0.7]),
        constraint("spherical", Spherical(Anchor::Body), &[]),
        constraint("spherical-point", Spherical(Anchor::Point), &[]),
        constraint("revolute", Revolute, &[]),
        constraint("fixed", Fixed, &[]),
        constraint("distance", Distance, &[]),
        constraint("prescribed-rotation-rate", Rotation(ConstantRate), &[0.05, 2.0]),
        constraint("prescribed-rotation-sine", Rotation(Sine), &[0.02, 0.4, 5.0, 0.2]),
        constraint("prescribed-rotation-ramp", Rotation(SmoothRamp), &[-0.1, 1.2, -0.2, 1.4]),
        constraint("prescribed-translation-sine", Translation(Sine), &[0.02, 0.1, 5.0, 0.2]),
        // its second derivative has corners at both ends: a start or duration moves them off the steps' ends
        Case { one_sided: &["start", "duration"], ..inside },
    ]
}

impl Case {
    /// The parameters of the subject as they are designed, before anything is varied.
    fn nominal(&self) -> (Vec<f64>, Vec<String>) {
        let mut m = MechanismBuilder::default();
        let places = self.mechanism(&START.map(|(_, value)| value), &mut m).1;
        let model = &m.model;
        let elements = model.elements.iter().map(|e| (&e.parameters, e.physics.parameter_list()));
        let joints = model.constraints.iter().map(|c| (&c.parameters, c.physics.parameter_list()));
        let mut parameters =
            elements.chain(joints).find(|(range, _)| **range == places).map_or(Vec::new(), |(_, list)| list);
        let own = parameters.len() - self.function.len();
        let mut values = m.numbers.p[places].to_vec();
        // nothing special: no unit vectors, right angles or closed loops that a wrong derivative could hide behind
        for (i, value) in values.iter_mut().take(own).enumerate() {
            let phase = i as f64;
            *value = *value * (1.0 + 0.04 * (phase + 1.0).sin()) + 0.02 * value.abs().min(1.0) + 0.01 * (2.0 * phase).cos();
        }
        (values, parameters.drain(..).map(|parameter| parameter.name.into_owned()).collect())
    }

    /// What each design variable can reach.
    pub fn reaches(&self) -> Vec<Reach> {
        use Reach::*;
        let own = |count: usize, reach: Reach| vec![reach; count];
        let load = |function: &TimeFunction| match function {
            TimeFunction::Sine => vec![Force, Force, Later, Force],
            TimeFunction::Step { .. } | TimeFunction::ConstantRate => vec![Force, Later],
            _ => vec![Force; self.function.len()],
        };
        let drive = |function: &TimeFunction| match function {
            TimeFunction::Sine => vec![Geometry, Geometry, Rate, Geometry],
            TimeFunction::ConstantRate => vec![Geometry, Rate],
            TimeFunction::SmoothRamp if !self.one_sided.is_empty() => vec![Geometry, Later, Later, Later],
            _ => vec![Geometry; self.function.len()],
        };
        let inertia = if self.projected { ProjectedInertia } else { Inertia };
        let of_subject = match &self.subject {
            Subject::RigidBody => [vec![if self.projected { ProjectedMass } else { Mass }], own(9, inertia)].concat(),
            Subject::PointMass => vec![Mass],
            Subject::GravityOnBody => own(7, Stored),
            Subject::GravityOnPoint => [own(4, Stored), own(3, Nothing)].concat(),
            Subject::LineSpring => own(8, Stored),
            Subject::LineDamper => own(7, Force),
            Subject::VectorDamper => [own(4, Force), own(3, Nothing)].concat(),
            Subject::TorsionSpringDamper => [vec![Stored, Force], own(10, Stored)].concat(),
            Subject::Force(Anchor::Body, _, f) => [own(6, Force), load(f)].concat(),
            Subject::Force(Anchor::Point, _, f) => [own(3, Force), own(3, Nothing), load(f)].concat(),
            Subject::Torque(_, f) => [own(3, Force), load(f)].concat(),
            Subject::Spherical(Anchor::Body) => own(6, Geometry),
            Subject::Spherical(Anchor::Point) => [own(3, Geometry), own(3, Nothing)].concat(),
            Subject::Revolute => own(15, Geometry),
            Subject::Fixed => own(10, Geometry),
            Subject::Distance => own(7, Geometry),
            Subject::Rotation(f) => [own(9, Geometry), drive(f)].concat(),
            Subject::Translation(f) => [own(9, Geometry), drive(f)].concat(),
        };
        [of_subject, vec![StartPosition, StartVelocity, Sensor]].concat()
    }

    /// The host mechanism with the subject; returns the place of the subject's parameters.
    fn mechanism<S: Scalar>(&self, start: &[S], m: &mut MechanismBuilder<S>) -> (Seen, Range<usize>) {
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
        let hinged = matches!(self.subject, TorsionSpringDamper);
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
            PointMass | GravityOnPoint | VectorDamper | Force(Anchor::Point, ..) | Spherical(Anchor::Point)
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
        m.gravity(at([0.6, -0.9, -9.7]));

        let both = [arm, second];
        let ends = [place([0.2, 0.4, 0.1]), place([0.9, -0.5, -0.6])];
        let f: Vec<S> = self.function.iter().map(|&f| S::from(f)).collect();
        let name = "subject";
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
            Spherical(_) => joint = Some(m.spherical(name, both, if light { position } else { elbow })),
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
        let (places, equations) = match constraint {
            Some(constraint) => (constraint.parameters.clone(), constraint.equations.len()),
            None => (element.unwrap_or(0..0), 3),
        };
        let second_is = if light { Anchor::Point } else { Anchor::Body };
        (Seen { arm, second, second_is, joint: joint.unwrap_or(shoulder_joint), equations }, places)
    }
}

/// Variables of every scene behind the parameters of its subject, with their values.
const START: [(&str, f64); 2] = [("turn of the start", 0.2), ("spin of the start", 0.6)];

impl Scene for Case {
    fn name(&self) -> String {
        self.name.into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let (values, names) = self.nominal();
        let start = START.map(|(name, value)| (name.to_string(), value));
        let all = names.into_iter().zip(values).chain(start).chain([("sensor".to_string(), 1.0)]);
        all.map(|(name, value)| DesignVariable::new(name, value, (value - 1.0, value + 1.0), "")).collect()
    }
    fn settings(&self) -> Settings {
        let settings = Settings::new(END, STEPS);
        if self.projected { settings.projecting_start() } else { settings }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let Some(own) = x.len().checked_sub(3) else { return Err(format!("too few variables: {}", x.len())) };
        let (subject, rest) = x.split_at(own);
        let (seen, places) = self.mechanism(&rest[..2], m);
        if places.len() != own {
            return Err(format!("{} variables for {} parameters", own, places.len()));
        }
        m.numbers.p[places].copy_from_slice(subject);
        if self.projected {
            // off the constraints, so that the projection moves something
            for node in m.model.nodes.iter().filter(|node| !node.fixed) {
                for i in node.dofs.clone() {
                    m.numbers.q[i] += S::from(0.01 * (3.0 * i as f64).sin());
                    m.numbers.v[i] += S::from(0.05 * (2.0 * i as f64).cos());
                }
            }
        }
        measures::add(m, &seen, rest[2]);
        Ok(())
    }
}
