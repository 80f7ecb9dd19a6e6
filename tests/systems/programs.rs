//! What a program of one's own is made of: loads with named numbers, functions of time of one's own, results by name.

use costate::internals::{AppliedForce, AppliedTorque};
use costate::prelude::*;
use costate::scenes::built_in;

/// f = A sin(w t + r t^2 / 2).
#[derive(Hash)]
struct Chirp;
impl TimeFormula for Chirp {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("amplitude", "N"), Parameter::new("w", "rad/s"), Parameter::new("r", "rad/s2")];
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        p[0] * ((p[1] + p[2] * t * 0.5) * t).sin()
    }
}

/// Whose curvature alone jumps at a breakpoint: (t - 0.5)^2 from there on.
#[derive(Hash)]
struct Start;
impl TimeFormula for Start {
    fn value<S: Scalar>(&self, t: S, _p: &[S]) -> S {
        let late = (t - 0.5).max(S::zero());
        late * late
    }
}

/// Which looks at a value.
#[derive(Hash)]
struct Branching;
impl TimeFormula for Branching {
    fn value<S: Scalar>(&self, t: S, _p: &[S]) -> S {
        if t.value() > 0.5 { t } else { S::zero() }
    }
}

/// A bar on a hinge at the origin, released level, with a spring of torsion and a shaker at its end.
struct Arm;

impl Scene for Arm {
    fn name(&self) -> String {
        "arm".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [
            ("length", 1.2, "m"),
            ("stiffness", 8.0, "N m/rad"),
            ("amplitude", 3.0, "N"),
            ("w", 2.0, "rad/s"),
            ("r", 1.5, "rad/s2"),
        ]
        .map(|(name, value, unit)| DesignVariable::new(name, value, (0.0, 10.0), unit))
        .to_vec()
    }
    fn settings(&self) -> Settings {
        // the name of a method may be made at run time
        Settings::new(1.0, 200).with_method(["sdirk", "3"].concat())
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, stiffness, shaker @ ..] = x else { return Err("5 variables".into()) };
        let zero = S::zero();
        let [along, up, hinge] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let (ground, tip) = (m.ground(), along * *length);
        let arm = m.body("arm", tip * S::from(0.5), Quaternion::identity());
        let lateral = *length * *length * (2.0 / 12.0);
        m.rigid_body("arm", arm, S::from(2.0), Vector3::zeros(), [S::from(1e-3), lateral, lateral, zero, zero, zero]);
        m.revolute("hinge", [ground, arm], Vector3::zeros(), hinge);
        let spring = SpringDamper { stiffness: *stiffness, damping: S::from(0.1), rest: zero };
        m.torsion_spring_damper("spring", [ground, arm], hinge, spring);
        let size = Signal::own(Chirp, shaker)?;
        m.force("shaker", Force { on: arm, point: tip, direction: up, frame: LoadFrame::Body, size });
        m.gravity(up * S::from(-9.81));
        m.position_functional("tip height", Over::Terminal, arm, tip, up);
        m.position_functional("mean height", Over::Integral, arm, tip, up);
        m.joint_angle_functional("largest angle", Over::smooth_maximum(20.0), [ground, arm], hinge);
        Ok(())
    }
}

#[test]
fn a_function_of_ones_own_has_exact_derivatives_by_its_parameters() -> Result<(), RunError> {
    let scene = Prepared::new(&Arm)?;
    assert_eq!(scene.method.table.name, "sdirk3");
    let run = scene.run()?;
    let (gradient, check) = (run.gradient()?, scene.analysis().complex_step(&scene.x, &run.forward)?);
    for (name, (own, exact)) in
        ["tip height", "mean height", "largest angle"].iter().zip(gradient.rows.iter().zip(&check.rows))
    {
        assert!(largest_difference(own, exact) < 1e-12, "{name}: {own:?} {exact:?}");
        assert!(own.iter().all(|entry| entry.abs() > 1e-6), "{name}: every variable matters: {own:?}");
    }
    // r alone moves the shaker late: a derivative that is not that of another number
    let by = |name: &str| gradient.rows[0][scene.variable(name).expect("a variable")];
    let step = 1e-5;
    let at = |r: f64| {
        let mut x = scene.x.clone();
        x[scene.variable("r").expect("a variable")] = r;
        scene.analysis().values(&x).expect("runs")[0]
    };
    let quotient = (at(1.5 + step) - at(1.5 - step)) / (2.0 * step);
    assert!((quotient - by("r")).abs() < 1e-8, "{quotient} {}", by("r"));
    Ok(())
}

#[test]
fn histories_of_functionals_nodes_and_joints_are_found_by_name() -> Result<(), RunError> {
    let scene = Prepared::new(&Arm)?;
    let run = scene.run()?;
    let (height, arm, hinge) = (run.history("tip height")?, run.node("arm")?, run.joint("hinge")?);
    assert_eq!((height.unit, height.times.len(), height.times[0], height.times[200]), ("m", 201, 0.0, 1.0));
    assert!(height.times == arm.times && height.times == hinge.times);
    assert_eq!(height.values[200], run.value("tip height")?);
    // what is integrated, by the trapezoidal rule
    let mean = run.history("mean height")?;
    let sum: f64 = mean.values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) / 200.0).sum();
    assert!((sum - run.value("mean height")?).abs() < 1e-4, "{sum}");
    let angle = run.history("largest angle")?;
    for k in 0..=200 {
        let ([x, y, _], [_, _, turning]) = (arm.positions[k], arm.angular_velocities[k]);
        let [[c, s, _], ..] = arm.axes[k];
        // the middle of the arm, its velocity and its angle, from the same rotation
        assert!((x - 0.6 * c).abs() < 1e-10 && (y - 0.6 * s).abs() < 1e-10, "step {k}");
        let [vx, vy, _] = arm.velocities[k];
        assert!((vx + turning * y).abs() < 1e-9 && (vy - turning * x).abs() < 1e-9, "step {k}");
        assert!((height.values[k] - 1.2 * s).abs() < 1e-10 && (angle.values[k] - s.atan2(c)).abs() < 1e-10, "step {k}");
        assert_eq!([arm.coordinates[k].len(), arm.rates[k].len(), hinge.multipliers[k].len()], [7, 7, 5]);
    }
    // Newton's law at the start, where the shaker does not push yet: the hinge carries what the arm's acceleration leaves of its weight
    let ([fx, fy, _], [ax, ay, _]) = (hinge.forces[0], arm.accelerations[0]);
    assert!((fx - 2.0 * ax).abs() < 1e-9 && (fy - 2.0 * (ay + 9.81)).abs() < 1e-9, "{fx} {fy} {ax} {ay}");
    assert!(fy > 4.0 && hinge.moments[0].iter().all(|moment| moment.abs() < 1e-9));

    // points cannot turn
    let pendulum = Prepared::new(built_in::named("pendulum")?)?;
    let run = pendulum.run()?;
    let bob = run.node("bob")?;
    assert!(bob.axes.is_empty() && bob.angular_velocities.is_empty() && bob.positions.len() == bob.times.len());
    assert!(run.joint("rod")?.moments.is_empty());
    Ok(())
}

#[test]
fn what_was_built_is_at_hand_by_its_name() -> Result<(), RunError> {
    let scene = Prepared::new(&Arm)?;
    let arm = scene.node("arm")?;
    assert_eq!(scene.model().node(arm).name, "arm");
    assert_eq!((scene.functional("mean height")?, scene.variable("w")?), (1, 3));
    assert!(scene.joint("hinge").is_ok());
    let messages = [
        scene.node("am").unwrap_err(),
        scene.joint("hing").unwrap_err(),
        scene.functional("tip hight").unwrap_err(),
        scene.variable("lenght").unwrap_err(),
        scene.run()?.history("mean").unwrap_err(),
    ]
    .map(|error| error.to_string());
    let meant = ["arm", "hinge", "tip height", "length"];
    for (message, meant) in messages.iter().zip(meant) {
        assert!(message.contains(&format!("did you mean \"{meant}\"?")), "{message}");
    }
    assert!(messages[4].contains("known: tip height, mean height, largest angle"), "{}", messages[4]);
    Ok(())
}

#[test]
fn what_main_prints_of_an_error_is_its_sentence() {
    let five_bar = built_in::named("five-bar").unwrap();
    let error = Prepared::new(five_bar).and_then(|scene| scene.node("bar")).unwrap_err();
    assert_eq!(format!("{error:?}"), error.to_string());
    assert!(error.to_string().starts_with("node \"bar\" is not known"), "{error}");
}

#[test]
fn loads_with_named_numbers_are_the_elements_that_they_stand_for() {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let turned = Quaternion::about(Vector3::new(0.6, 0.0, 0.8), 0.7);
    let (place, point, direction) =
        (Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.5, 0.1, -0.2), Vector3::new(0.3, -0.4, 1.1));
    for frame in [LoadFrame::World, LoadFrame::Body] {
        let mut m = MechanismBuilder::<f64>::default();
        let body = m.body("body", place, turned);
        m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let ramp = || Signal::SmoothRamp { from: 1.0, to: 2.0, start: 0.5, duration: 3.0 };
        let first = m.numbers.p.len();
        m.force("force", Force { on: body, point, direction, frame, size: ramp() });
        let started = Signal::SmoothStart { of: Box::new(ramp()), duration: 0.25 };
        m.torque("torque", Torque { on: body, axis: direction, frame, size: started });
        let own = axes.map(|axis| turned.rotate(axis).dot(&direction));
        let d = if frame == LoadFrame::Body { own } else { [0.3, -0.4, 1.1] };
        let at = axes.map(|axis| turned.rotate(axis).dot(&(point - place)));
        let expected = [&d[..], &at, &[1.0, 2.0, 0.5, 3.0], &d, &[1.0, 2.0, 0.5, 3.0, 0.25]].concat();
        let given = &m.numbers.p[first..];
        assert!(given.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{given:?} {expected:?}");
        assert_eq!(given.len(), expected.len());
        // the same by hand
        let size = TimeFunction::SmoothRamp;
        m.element("by hand", &[body], AppliedForce { on: NodeKind::Body, frame, size: size.clone() }, &expected[..10]);
        let p = [&d[..], &[1.0, 2.0, 0.5, 3.0]].concat();
        m.element("by hand, torque", &[body], AppliedTorque { on: NodeKind::Body, frame, size }, &p);
        assert!(m.finish().is_ok());
    }
}

/// What is wrong with a scene of one body.
fn mistake(add: impl FnOnce(&mut MechanismBuilder<f64>, [NodeId; 3]) -> Result<(), String>) -> String {
    let mut m = MechanismBuilder::<f64>::default();
    let (ground, body) = (m.ground(), m.body("body", Vector3::zeros(), Quaternion::identity()));
    let point = m.point("point", Vector3::x());
    m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    m.point_mass("point", point, 1.0);
    match add(&mut m, [ground, body, point]) {
        Ok(()) => m.finish().err().expect("a mistake that nobody found"),
        Err(why) => why,
    }
}

#[test]
fn wrong_loads_and_functions_are_told_by_name() {
    let table = |times: &[f64], values: &[f64]| Signal::Table {
        times: times.to_vec(),
        values: values.to_vec(),
        interpolant: Interpolant::Monotone,
    };
    let torque = |on, size| Torque { on, axis: Vector3::z(), frame: LoadFrame::World, size };
    let of_body = |size: Signal<f64>| {
        mistake(|m, [_, body, _]| {
            m.torque("push", torque(body, size));
            Ok(())
        })
    };
    let cases = [
        (of_body(table(&[0.0, 1.0], &[1.0])), "\"push\": there are 2 times, but 1 values; give one for each"),
        (of_body(table(&[0.0, 0.0], &[1.0, 2.0])), "\"push\": "),
        (of_body(Signal::own(Chirp, &[1.0]).expect("sound")), "\"push\" has 6 parameters, but 4 values were given"),
        (
            mistake(|m, [_, _, point]| {
                m.torque("push", torque(point, Signal::Constant(1.0)));
                Ok(())
            }),
            "\"push\" needs a body, which has axes, but node \"point\" is none",
        ),
        (
            mistake(|_, _| Signal::<f64>::own(Branching, &[]).map(drop)),
            "a function of time: its formula looks at the value of a number",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}");
    }
    // a jump of the curvature is a breakpoint of a driver like others
    let mut m = MechanismBuilder::<f64>::default();
    let (ground, body) = (m.ground(), m.body("body", Vector3::zeros(), Quaternion::identity()));
    m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    m.revolute("hinge", [ground, body], Vector3::zeros(), Vector3::z());
    m.prescribed_rotation("drive", [ground, body], Vector3::z(), Signal::own(Start, &[]).expect("sound"));
    assert_eq!(m.finish().expect("sound").breakpoints(1.0).expect("few"), [0.5]);
}
