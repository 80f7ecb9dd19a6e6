//! A run that stopped, for whatever reason, goes on as if it had not.

use super::{Folder, assert_says, bits, prepared, scene};
use costate::history::{Keep, Watch};
use costate::integrators::{ConstraintLevel, Counters, Method, RunError, StepControl, StepError, StepRecord, table_by_name};
use costate::internals::{FileHistory, table_named};
use costate::prelude::*;
use costate::sensitivity::Forward;
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

/// All that a run gives, bit by bit.
#[derive(Debug, PartialEq)]
struct Outcome {
    rows: Vec<Vec<Vec<u64>>>,
    rejected: usize,
    error: Option<StepError>,
    counters: Counters,
    /// Steps that the observer saw.
    seen: usize,
}

/// Runs until the observer has seen so many steps.
fn observed(prepared: &Prepared, steps: usize) -> (Forward, Option<RunError>, usize) {
    let mut seen = 0;
    let mut watch = Watch(|_: &StepRecord<f64>| {
        seen += 1;
        seen < steps
    });
    let (forward, stopped) = prepared.analysis().observed(&prepared.x, &mut watch).expect("begins");
    (forward, stopped, seen)
}

fn outcome(prepared: &Prepared, place: &str) -> (Outcome, Forward) {
    let (forward, stopped, seen) = observed(prepared, usize::MAX);
    assert_eq!(stopped, None, "{place}");
    let adjoint = prepared.analysis().adjoint(&prepared.x, &forward).expect(place);
    let Forward { rejected, error, counters, .. } = forward;
    let rows = [vec![forward.grid.times.clone()], vec![forward.values.clone()], adjoint.rows].map(|rows| bits(&rows));
    (Outcome { rows: rows.into(), rejected, error, counters, seen }, forward)
}

fn part_of(path: &Path) -> PathBuf {
    path.with_extension("bin.part")
}

/// Stops a run twice, then cuts its file off at many lengths, as a crash does, and goes on each time.
fn goes_on(prepared: &mut Prepared, place: &str) {
    // tests may share a process
    let folder = Folder::new(&format!("resumed {place}"));
    prepared.keep = Keep::File(folder.0.join("whole.bin"));
    let (whole, forward) = outcome(prepared, place);
    let steps = forward.history.steps();
    assert!(steps >= 6 && forward.history.usage().taken_over == 0, "{place}: {steps} steps");

    let path = folder.0.join("run.bin");
    prepared.keep = Keep::Resumed(path.clone());
    for (stop, done) in [(steps / 3, steps / 3), (2 * steps / 3, 2 * steps / 3)] {
        let (forward, stopped, _) = observed(prepared, stop);
        assert!(matches!(stopped, Some(RunError::Interrupted { .. })), "{place}: {stopped:?}");
        assert_eq!(forward.history.steps(), done, "{place}");
    }
    let part = fs::read(part_of(&path)).expect("is there");
    let (again, forward) = outcome(prepared, place);
    assert_eq!(whole, again, "{place}: stopped twice");
    assert!(forward.history.usage().taken_over > 0, "{place}");

    // the finished one is taken as it is
    let finished = fs::read(&path).expect("is there");
    let (again, forward) = outcome(prepared, place);
    assert_eq!(whole, again, "{place}: finished");
    assert_eq!(forward.history.usage().taken_over, steps, "{place}");
    assert_eq!(finished, fs::read(&path).expect("is there"), "{place}");

    for cut in 1..=7 {
        fs::remove_file(&path).expect("was finished");
        fs::write(part_of(&path), &part[..part.len() * cut / 7 - cut % 2]).expect("can be written");
        let (again, _) = outcome(prepared, place);
        assert_eq!(whole, again, "{place}: cut off at {cut}/7");
    }
}

#[test]
fn given_steps_go_on_bit_by_bit() {
    // with Euler parameters, a breakpoint, redundant joints
    for (name, end, steps) in
        [("pendulum", 0.4, 24), ("five-bar", 0.3, 18), ("double-pendulum", 0.15, 12), ("bricard", 0.1, 12)]
    {
        let scene = scene(name);
        for (table, level) in [
            ("esdirk4", ConstraintLevel::Position),
            ("bdf3", ConstraintLevel::Acceleration),
            ("generalized-alpha", ConstraintLevel::Position),
            ("variational", ConstraintLevel::Position),
        ] {
            let method = Method::new(table_by_name(table).expect("listed"), level);
            goes_on(&mut prepared(scene, method, end, steps), &format!("{name}, {table}"));
        }
    }
}

#[test]
fn chosen_and_divided_steps_go_on_bit_by_bit() {
    let scene = scene("five-bar");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Method::new(table_by_name("esdirk4").expect("listed"), ConstraintLevel::Acceleration);
    let settings = Settings { end: 2.5, ..scene.settings().without_method() };
    let chosen = settings.clone().choosing_steps(StepControl::new(1e-3));
    let mut chosen = Prepared::with(scene, &x, method, chosen).expect("a sound scene");
    goes_on(&mut chosen, "chosen steps");
    let rejected = outcome(&chosen, "chosen steps").0.rejected;
    assert!(rejected > 0, "no step was given up: too few to tell");

    // so long that Newton's method fails in some of them
    let table = table_by_name("midpoint").expect("listed");
    let method = Method::new(table, ConstraintLevel::Acceleration);
    let mut divided = Prepared::with(scene, &x, method, Settings { end: 2.5, steps: 12, ..settings }.dividing_steps())
        .expect("a sound scene");
    goes_on(&mut divided, "divided steps");
    let rejected = outcome(&divided, "divided steps").0.rejected;
    assert!(rejected > 0, "no step was divided: too few to tell");

    // load steps that grow and are given up
    let scene = super::scene("princeton-beam");
    let settings = scene.settings().without_method().choosing_steps(StepControl { longest: 0.1, ..StepControl::new(1e-3) });
    let method = Method::new(table_named("static").expect("listed").expect("listed"), ConstraintLevel::Acceleration);
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    goes_on(&mut Prepared::with(scene, &x, method, settings).expect("a sound scene"), "load steps");
}

#[test]
fn a_file_of_something_else_is_refused_in_words() {
    let folder = Folder::new("other");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    prepared.keep = Keep::Resumed(path.clone());
    let (_, stopped, _) = observed(&prepared, 20);
    assert!(stopped.is_some());
    let refusal = |prepared: &Prepared, x: &[f64]| prepared.analysis().forward(x).expect_err("is refused").to_string();
    let mut other = prepared.x.clone();
    other[0] *= 1.0 + f64::EPSILON;
    assert_says(&refusal(&prepared, &other), &["run.bin.part", "another scene, design, method", "name another file"]);
    let coarse = super::prepared(scene, Prepared::default_method(), 0.5, 29);
    let coarse = Prepared { keep: prepared.keep.clone(), ..coarse };
    assert_says(&refusal(&coarse, &prepared.x), &["run.bin.part", "grid of steps"]);
    // while it is being written
    let going_on = FileHistory::create(&folder.0.join("run.bin"), 7).expect("keeps the part as unfinished");
    fs::copy(folder.0.join("run.bin.unfinished"), folder.0.join("copy.bin.part")).expect("is there");
    drop(going_on);
    let file = fs::File::open(folder.0.join("copy.bin.part")).expect("is there");
    file.lock().expect("is free");
    prepared.keep = Keep::Resumed(folder.0.join("copy.bin"));
    assert_says(&refusal(&prepared, &prepared.x), &["copy.bin.part", "another run is writing it"]);
    drop(file);
    prepared.analysis().forward(&prepared.x).expect("goes on");
}

/// A ball on which a force acts that is no parameter: its recorded formula alone shows it.
struct Pushed(f64);

impl Hash for Pushed {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.to_bits().hash(state);
    }
}

impl Element for Pushed {
    const PARAMETERS: &'static [Parameter] = &[];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point]
    }
    fn residual<S: Scalar>(&self, _s: State<S>, _p: &[S], t: S, r: &mut [S]) {
        r[0] -= t * self.0;
    }
}

impl Scene for Pushed {
    fn name(&self) -> String {
        "pushed".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 40)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ball = m.point("ball", Vector3::zeros());
        m.point_mass("ball", ball, S::one());
        m.element("push", &[ball], Pushed(self.0), &[]);
        Ok(())
    }
}

#[test]
fn a_law_that_changed_is_refused_before_a_step_is_made() {
    let folder = Folder::new("changed");
    let path = folder.0.join("run.bin");
    let (first, second) = (Pushed(1.0), Pushed(1.0 + 1e-12));
    let kept = |scene| {
        let prepared = Prepared::new(scene).expect("a sound scene");
        Prepared { keep: Keep::Resumed(path.clone()), ..prepared }
    };
    assert!(matches!(observed(&kept(&first), 25).1, Some(RunError::Interrupted { steps: 25 })));
    let refusal = kept(&second).analysis().forward(&[]).expect_err("another force").to_string();
    assert_says(&refusal, &["run.bin.part", "cannot go on with it", "law of a part"]);
    assert_eq!(observed(&kept(&first), usize::MAX).1, None);
}
