//! Pairs of models with the same names and numbers, whose laws differ in one thing or in none: runs of one for the other.

use crate::{Noise, Report};
use costate::history::{Keep, Watch};
use costate::integrators::{StepRecord, tables};
use costate::prelude::*;
use costate::sensitivity::Forward;
use std::path::Path;

/// The bar that both are, and what may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Laws {
    frame: LoadFrame,
    /// Of the moment's signal.
    signal: usize,
    /// Knots of a table, and the time of a jump [s].
    times: [f64; 2],
    /// Kind of the element beside the bar.
    element: usize,
    /// What the functional makes over time.
    over: usize,
    /// Method and level.
    table: usize,
    level: ConstraintLevel,
    /// Direction that the functional reads.
    weight: usize,
}

/// Number of things that may differ.
const THINGS: usize = 9;

impl Laws {
    fn drawn(between: &mut impl FnMut(f64, f64) -> f64) -> Self {
        let mut one_of = |count: usize| between(0.0, count as f64) as usize % count;
        let frame = [LoadFrame::World, LoadFrame::Body][one_of(2)];
        let (signal, element, over, weight) = (one_of(3), one_of(4), one_of(3), one_of(3));
        let (table, level) = (one_of(moving().count()), ConstraintLevel::ALL[one_of(2)]);
        Laws { frame, signal, times: [0.03 + 0.01 * one_of(5) as f64, 0.11], element, over, table, level, weight }
    }

    /// With one thing changed; whether states of runs are others.
    fn changed(self, thing: usize) -> (Self, bool) {
        let mut other = self;
        match thing {
            0 => other.frame = if self.frame == LoadFrame::World { LoadFrame::Body } else { LoadFrame::World },
            1 => other.signal = (self.signal + 1) % 3,
            2 => other.times[0] += 0.001,
            3 => other.times[1] += 0.001,
            4 => other.element = (self.element + 1) % 4,
            5 => other.over = (self.over + 1) % 3,
            6 => other.table = (self.table + 1) % moving().count(),
            7 => other.weight = (self.weight + 1) % 3,
            _ => {
                let place = ConstraintLevel::ALL.iter().position(|own| *own == self.level).unwrap_or(0);
                other.level = ConstraintLevel::ALL[(place + 1) % 2];
            }
        }
        (other, !matches!(thing, 5 | 7))
    }
}

/// Tables of motions.
fn moving() -> impl Iterator<Item = costate::integrators::Table> {
    tables().into_iter().filter(|table| !table.is_static())
}

/// A force on one coordinate whose laws have the same numbers.
#[derive(Clone, Copy, Hash)]
struct Force1(usize);

impl Element for Force1 {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg"), Parameter::positive("stiffness", "N/m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let law = [p[1] * s.q[0], p[1] * s.q[0].sin(), p[1] * s.q[0] * s.q[0], p[1] * s.v[0]][self.0];
        r[0] += p[0] * s.a[0] + law;
    }
}

impl Scene for Laws {
    fn name(&self) -> String {
        "bar".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("force", 2.0, (0.5, 8.0), "N")]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.15, 12)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let bar = m.body("bar", at([0.5, 0.0, 0.0]), Quaternion::identity());
        m.rigid_body("bar", bar, S::one(), Vector3::zeros(), [0.01, 0.1, 0.1, 0.0, 0.0, 0.0].map(S::from));
        let ground = m.ground();
        m.revolute("hinge", [ground, bar], Vector3::zeros(), at([0.0, 0.0, 1.0]));
        let size = match self.signal {
            0 => Signal::Sine { offset: x[0], amplitude: x[0], angular_frequency: x[0], phase: x[0] },
            1 => Signal::SmoothRamp { from: x[0], to: x[0] * 2.0, start: x[0] * 0.01, duration: x[0] },
            _ => Signal::Step { before: x[0], after: x[0] * 0.5, switch: self.times[1] },
        };
        let point = at([0.5, 0.0, 0.0]);
        m.force("push", Force { on: bar, point, direction: at([0.0, 1.0, 0.0]), frame: self.frame, size });
        let (times, values) = (vec![0.0, self.times[0], 0.15], vec![S::zero(), x[0], S::zero()]);
        let size = Signal::Table { times, values, interpolant: Interpolant::Smooth };
        let frame = LoadFrame::World;
        m.force("table", Force { on: bar, point, direction: at([0.0, 1.0, 0.0]), frame, size });
        let jump = Signal::Step { before: x[0], after: x[0] * 0.5, switch: self.times[1] };
        m.force("jump", Force { on: bar, point, direction: at([0.0, 1.0, 0.0]), frame, size: jump });
        let node = m.coordinates("mass", &[S::from(0.3)], &[x[0]]);
        m.element("law", &[node], Force1(self.element), &[S::one(), x[0]]);
        let over = [Over::Terminal, Over::Integral, Over::smooth_maximum(3.0)][self.over];
        let mut direction = [0.0; 3];
        direction[self.weight] = 1.0;
        m.position_functional("end", over, bar, point, at(direction));
        Ok(())
    }
}

fn prepared(laws: &Laws) -> Result<Prepared<'_>, RunError> {
    let table = moving().nth(laws.table).ok_or_else(|| RunError::Input("no such table".into()))?;
    let x: Vec<f64> = Scene::variables(laws).iter().map(|variable| variable.initial).collect();
    Prepared::with(laws, &x, Method::new(table, laws.level), Scene::settings(laws))
}

fn run(laws: &Laws, keep: Keep) -> Result<Forward, RunError> {
    let prepared = Prepared { keep, ..prepared(laws)? };
    prepared.analysis().forward(&prepared.x)
}

/// A run that ends after some steps, as one that is killed.
fn interrupt(laws: &Laws, path: &Path, steps: usize) -> Result<(), RunError> {
    let prepared = Prepared { keep: Keep::File(path.into()), ..prepared(laws)? };
    let mut taken = 0;
    let mut observer = Watch(|_: &StepRecord<f64>| {
        taken += 1;
        taken < steps
    });
    prepared.analysis().observed(&prepared.x, &mut observer).map(|_| ())
}

/// Whether each use of a run under other laws is refused, and each under its own is not; so is a run that was interrupted.
fn is_right(own: &Laws, thing: Option<usize>, path: &Path, interrupted: usize) -> Result<bool, RunError> {
    let (other, other_states) = thing.map_or((*own, false), |thing| own.changed(thing));
    // values that cannot differ are no other law: directions are numbers
    let is_other = thing.is_some_and(|thing| thing != 7);
    let forward = run(own, Keep::File(path.into()))?;
    let analysed = prepared(&other)?;
    let (analysis, x) = (analysed.analysis(), &analysed.x);
    let uses = [
        analysis.adjoint(x, &forward).is_err(),
        analysis.tangent(x, &forward).is_err(),
        analysis.complex_step(x, &forward).is_err(),
    ];
    drop(forward);
    let finished = run(&other, Keep::Resumed(path.into())).is_err();
    interrupt(own, path, interrupted)?;
    let unfinished = run(&other, Keep::Resumed(path.into())).is_err();
    let _ = std::fs::remove_file(path);
    let numbers_differ = thing == Some(7);
    let resumed = [finished, unfinished].iter().all(|refused| *refused == (other_states || numbers_differ));
    Ok(uses.iter().all(|refused| *refused == (is_other || numbers_differ)) && resumed)
}

/// Counts them.
pub fn count(report: &mut Report, cases: usize) -> Result<(), String> {
    let mut noise = Noise::new(3);
    let mut between = |from: f64, to: f64| from + 0.5 * (to - from) * (noise.next() + 1.0);
    let path = std::env::temp_dir().join(format!("costate-robustness-laws-{}.history", std::process::id()));
    let [mut refused, mut taken, mut wrong] = [0; 3];
    for case in 0..cases {
        let own = Laws::drawn(&mut between);
        // one in ten is the same
        let thing = Some(case % (THINGS + 1)).filter(|thing| *thing < THINGS);
        match is_right(&own, thing, &path, 1 + case % 11) {
            Ok(true) if thing.is_some() => refused += 1,
            Ok(true) => taken += 1,
            Ok(false) => {
                wrong += 1;
                report.note(format!("laws, case {case}: {own:?}, with {thing:?} changed"));
            }
            Err(error) => {
                wrong += 1;
                report.note(format!("laws, case {case}: {own:?}: {error}"));
            }
        }
    }
    report.inform("laws/other ones, as they must be", f64::from(refused));
    report.inform("laws/the same ones, taken", f64::from(taken));
    report.at_most("laws/wrong", f64::from(wrong), 0.0);
    Ok(())
}
