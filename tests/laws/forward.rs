//! Forward runs, histories and designs of other laws: refused by name, and never a gradient of something else.

use costate::history::{Keep, Watch};
use costate::prelude::*;
use costate::sensitivity::{Analysis, Forward};
use std::path::PathBuf;

/// A bar on a hinge at the origin with a force on it, whose laws can be chosen while names and numbers stay.
#[derive(Clone)]
struct Bar {
    frame: fn(f64) -> LoadFrame,
    /// Of a jump of the force [s].
    switch: fn(f64) -> f64,
    /// Knots of a moment [s].
    knot: f64,
    over: Over,
    functionals: usize,
    /// By which a bead misses its stop, as a share of the variable beyond its initial value.
    gap: f64,
    /// Turns the kind of the force's signal over.
    is_sine: bool,
}

const BAR: Bar = Bar {
    frame: |_| LoadFrame::World,
    switch: |_| 0.3,
    knot: 0.4,
    over: Over::Terminal,
    functionals: 2,
    gap: 0.0,
    is_sine: false,
};
const FORCE: f64 = 2.0;

/// A unit mass of one coordinate.
#[derive(Hash)]
struct Bead;

impl Element for Bead {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        r[0] = s.a[0];
    }
}

/// It stays at 0.
#[derive(Hash)]
struct AtZero;

impl Constraint for AtZero {
    const EQUATIONS: usize = 1;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn g<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, g: &mut [S]) {
        g[0] = q[0];
    }
}

impl Scene for Bar {
    fn name(&self) -> String {
        "bar".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("force", FORCE, (0.5, 8.0), "N")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 50)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (ground, z) = (m.ground(), Vector3::<S>::from_f64([0.0, 0.0, 1.0]));
        let bar = m.body("bar", Vector3::from_f64([0.5, 0.0, 0.0]), Quaternion::identity());
        if self.gap != 0.0 {
            let bead = m.coordinates("bead", &[(x[0] - FORCE) * self.gap], &[S::zero()]);
            m.element("bead", &[bead], Bead, &[]);
            m.constraint("stop", &[bead], AtZero, &[]);
        }
        let inertia = [0.01, 0.1, 0.1, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("bar", bar, S::one(), Vector3::zeros(), inertia);
        m.revolute("hinge", [ground, bar], Vector3::zeros(), z);
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let size = match self.is_sine {
            true => Signal::Sine { offset: x[0], amplitude: x[0], angular_frequency: x[0], phase: x[0] },
            false => Signal::SmoothRamp { from: x[0], to: x[0], start: x[0], duration: x[0] },
        };
        let frame = (self.frame)(x[0].value());
        m.force("push", Force { on: bar, point: at([0.5, 0.0, 0.0]), direction: at([0.0, 1.0, 0.0]), frame, size });
        let jump = Signal::Step { before: x[0], after: x[0] * 0.5, switch: (self.switch)(x[0].value()) };
        let direction = at([0.0, 1.0, 0.0]);
        m.force("jump", Force { on: bar, point: Vector3::zeros(), direction, frame: LoadFrame::World, size: jump });
        let times = vec![0.0, self.knot, 1.0];
        let size = Signal::Table { times, values: vec![S::zero(), x[0], S::zero()], interpolant: Interpolant::Smooth };
        m.force("table", Force { on: bar, point: Vector3::zeros(), direction, frame: LoadFrame::World, size });
        for (k, direction) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate().take(self.functionals) {
            m.position_functional(&format!("end {k}"), self.over, bar, at([0.5, 0.0, 0.0]), at(direction));
        }
        Ok(())
    }
}

/// Neighbours of the bar: each with other laws, but with the same names and numbers.
fn others() -> Vec<(&'static str, Bar)> {
    vec![
        ("push", Bar { frame: |_| LoadFrame::Body, ..BAR }),
        ("jump", Bar { switch: |_| 0.35, ..BAR }),
        ("table", Bar { knot: 0.45, ..BAR }),
        ("push", Bar { is_sine: true, ..BAR }),
    ]
}

fn prepared<'s>(scene: &'s Bar, method: &str) -> Prepared<'s> {
    let settings = scene.settings().with_method(method);
    Prepared::with(scene, &[FORCE], Prepared::method_of(&settings).expect("listed"), settings).expect("a sound scene")
}

pub fn assert_says(error: &RunError, words: &[&str]) {
    let text = error.to_string();
    assert!(words.iter().all(|word| text.contains(word)), "{text}");
}

/// All that an analysis does with a forward run.
fn uses(analysis: &Analysis, forward: &Forward) -> Vec<Option<RunError>> {
    let x = [FORCE];
    vec![
        analysis.adjoint(&x, forward).err(),
        analysis.tangent(&x, forward).err(),
        analysis.complex_step(&x, forward).err(),
        analysis.tangent_over_time(&x, forward).err(),
        analysis.complex_step_over_time(&x, forward).err(),
        analysis.motion(forward, &[0.5]).err(),
        analysis.for_each_sample(forward, |_| ()).err(),
        analysis.check_values(forward).err(),
    ]
}

fn assert_refused(analysis: &Analysis, forward: &Forward, words: &[&str]) {
    for refusal in uses(analysis, forward) {
        assert_says(&refusal.expect("is refused"), &[words, &["belongs to another analysis"]].concat());
    }
}

#[test]
fn a_forward_run_of_another_method_is_refused() {
    let methods = ["esdirk4", "bdf2", "bdf3", "dirk3", "generalized-alpha", "midpoint", "variational"];
    for own in methods {
        let analysed = prepared(&BAR, own);
        for other in methods {
            let run = prepared(&BAR, other);
            let forward = run.analysis().forward(&[FORCE]).expect("runs");
            match own == other {
                true => assert!(uses(&analysed.analysis(), &forward).iter().all(Option::is_none), "{own}"),
                false => assert_refused(&analysed.analysis(), &forward, &["method", own]),
            }
        }
    }
}

#[test]
fn a_forward_run_of_other_laws_or_functionals_is_refused() {
    let own = prepared(&BAR, "esdirk4");
    for (part, other) in others() {
        let run = prepared(&other, "esdirk4");
        let forward = run.analysis().forward(&[FORCE]).expect("runs");
        assert_refused(&own.analysis(), &forward, &["the law of", part]);
    }
    let integral = Bar { over: Over::Integral, ..BAR };
    let run = prepared(&integral, "esdirk4");
    let forward = run.analysis().forward(&[FORCE]).expect("runs");
    assert_refused(&own.analysis(), &forward, &["functional \"end 0\""]);
    // parts of another model: neither a panic nor a number
    let mixed = Analysis { functionals: run.functionals(), ..own.analysis() };
    assert_refused(&mixed, &own.analysis().forward(&[FORCE]).expect("runs"), &["functional \"end 0\""]);
}

#[test]
fn a_run_is_not_resumed_under_another_law() {
    let path: PathBuf = std::env::temp_dir().join(format!("costate-laws-{}.history", std::process::id()));
    let part = path.with_extension("history.part");
    for stop in [20, usize::MAX] {
        let run = |scene: &Bar| -> Result<Option<RunError>, RunError> {
            let mut prepared = prepared(scene, "esdirk4");
            prepared.keep = Keep::Resumed(path.clone());
            let mut seen = 0;
            let mut watch = Watch(|_: &StepRecord<f64>| {
                seen += 1;
                seen < stop
            });
            Ok(prepared.analysis().observed(&[FORCE], &mut watch)?.1)
        };
        run(&BAR).expect("begins");
        for (_, other) in others() {
            assert_says(&run(&other).expect_err("is refused"), &["cannot go on with it", "another scene", "law of a part"]);
        }
        run(&BAR).expect("goes on");
        // another functional reads the same states
        run(&Bar { over: Over::Integral, ..BAR }).expect("goes on");
        for file in [&path, &part] {
            let _ = std::fs::remove_file(file);
        }
    }
}

#[test]
fn a_scene_whose_options_depend_on_the_design_is_refused_by_name() {
    for (part, scene) in [
        ("push", Bar { frame: |x| if x > 3.0 { LoadFrame::Body } else { LoadFrame::World }, ..BAR }),
        ("jump", Bar { switch: |x| if x > 3.0 { 0.5 } else { 0.3 }, ..BAR }),
    ] {
        let prepared = prepared(&scene, "esdirk4");
        let error = prepared.analysis().forward(&[4.0]).expect_err("another design has other options");
        assert_says(&error, &["\"bar\"", part, "depend on design variables"]);
        // on this side of the jump derivatives are right
        let forward = prepared.analysis().forward(&[FORCE]).expect("runs");
        prepared.analysis().adjoint(&[FORCE], &forward).expect("has a gradient");
    }
    let moving = Bar { switch: |x| 0.15 * x, ..BAR };
    let prepared = prepared(&moving, "esdirk4");
    let forward = prepared.analysis().forward(&[FORCE]).expect("runs");
    for error in [
        prepared.analysis().adjoint(&[FORCE], &forward).expect_err("the jump moves"),
        prepared.analysis().complex_step(&[FORCE], &forward).expect_err("the jump moves"),
    ] {
        assert_says(&error, &["\"bar\"", "jump", "depend on design variables"]);
    }
}

#[test]
fn the_start_of_another_design_is_examined_like_the_first() {
    let scene = Bar { gap: 0.05, ..BAR };
    let prepared = prepared(&scene, "esdirk4");
    let error = prepared.analysis().forward(&[4.0]).expect_err("a gap of 0.1 m");
    assert_says(&error, &["the start violates its constraints", "stop"]);
    let settings = scene.settings();
    let with = Prepared::with(&scene, &[4.0], Prepared::default_method(), settings).err().expect("a gap of 0.1 m");
    assert_eq!(error, with);
}

#[cfg(unix)]
#[test]
fn histories_are_written_where_a_regular_file_or_nothing_stands() {
    let folder = std::env::temp_dir().join(format!("costate-laws-places-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("can be made");
    let pipe = folder.join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there");
    assert!(made.success());
    let dangling = folder.join("dangling");
    std::os::unix::fs::symlink(folder.join("nowhere"), &dangling).expect("can be made");
    for (place, what) in [(PathBuf::from("/dev/null"), "a device"), (pipe, "a pipe"), (dangling, "a link")] {
        for keep in [Keep::File(place.clone()), Keep::Resumed(place.clone())] {
            let prepared = Prepared { keep, ..prepared(&BAR, "esdirk4") };
            let error = prepared.analysis().forward(&[FORCE]).expect_err("is refused");
            assert!(matches!(error, RunError::Input(_)), "{error}");
            assert_says(&error, &[what, "regular file"]);
        }
        let is_file = std::fs::symlink_metadata(&place).expect("is still there").is_file();
        assert!(!is_file, "{} was replaced", place.display());
    }
    std::fs::remove_dir_all(folder).expect("can be removed");
}
