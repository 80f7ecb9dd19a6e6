//! Breakpoints drawn by lot: some that design variables move, and some at which nothing happens.

use crate::verification::Report;
use costate::integrators::{StepError, tables};
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::FileScene;

/// Difference of adjoint and complex step, but for round-off that steps hand on, and of complex step and difference quotients, as shares of
/// the largest entry.
const LIMITS: [f64; 2] = [1e-12, 1e-5];
/// Numbers of steps near that of a run, whose errors say what another place of the ends of steps may do.
const NEAR: std::ops::RangeInclusive<usize> = 57..=63;
/// Share of this error that a breakpoint at which nothing happens may have, and what a method of several steps may lose by starting anew there, as a
/// share of a value, or of 1 N s, m, J.
const AS_OTHERS: f64 = 2.0;
const NOTHING: f64 = 1e-3;
/// Gravity [m/s2]: no accelerations of this mechanism are smaller.
const ACCELERATIONS: f64 = 9.81;

/// What becomes of a case.
enum Outcome {
    Right,
    /// Beyond the limits, but the program warns of the error of the run.
    Warned,
    Wrong(String),
}

/// Numbers that look drawn by lot, the same in every run: multiples of the golden ratio.
struct Lot(u32);

impl Lot {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 += 1;
        from + (to - from) * (f64::from(self.0) * 0.618_033_988_749_894_9).fract()
    }
}

/// A bar that a motor turns up within `duration`, a weight on a rod and a spring, and a force on it that begins to swing within `beginning`.
fn lifted_bar(more: &str) -> Result<FileScene, String> {
    let text = r#"
version = 1
name = "lifted bar"
summary = "a bar that a motor turns up"
gravity = [0, -9.81, 0]
settings = { end = 1.0, steps = 60 }
variable.duration = { initial = 0.4, bounds = [0.01, 2], unit = "s" }
variable.beginning = { initial = 0.3, bounds = [0.01, 2], unit = "s" }
body = [{ name = "bar", position = [0.5, 0, 0], mass = 1, inertia = [0.001, 0.083, 0.083] }]
point = [{ name = "bob", position = [1, 0.5, 0], mass = 0.3 }]
spring = [{ name = "spring", type = "line", between = ["bar", "bob"], stiffness = 40, rest_length = 0.4 }]
joint = [
    { name = "hinge", type = "revolute", between = ["ground", "bar"], point = [0, 0, 0], axis = [0, 0, 1] },
    { name = "rod", type = "distance", between = ["ground", "bob"] },
]
functional = [
    { name = "moment", type = "reaction", joint = "motor", weights = [1], over = "integral" },
    { name = "x", type = "position", on = "bob", direction = [1, 0, 0], over = "terminal" },
    { name = "energy", type = "energy", over = "terminal" },
]
[[driver]]
name = "motor"
type = "rotation"
between = ["ground", "bar"]
axis = [0, 0, 1]
angle = { type = "smooth_ramp", to = 1.2, duration = "duration" }
[[force]]
name = "swing"
on = "bob"
direction = [0, 0, 1]
size = { type = "sine", amplitude = 3, angular_frequency = 9, phase = 0.7, smooth_start = "beginning" }
"#;
    FileScene::parse("lifted bar", &format!("{text}{more}"))
}

/// The method of a case: the next one.
fn method(case: usize) -> Method {
    let all: Vec<_> = tables().into_iter().filter(|table| !table.is_static()).collect();
    Method::new(all[case % all.len()].clone(), ConstraintLevel::ALL[case / all.len() % 3])
}

/// A run of the bar: values, and whether the estimated error of its steps asks for a warning.
fn run(scene: &FileScene, x: &[f64], method: Method, steps: usize) -> Result<(Vec<f64>, bool), RunError> {
    let settings = Settings { steps, ..AnyScene::settings(scene).without_method() };
    let forward = Prepared::with(scene, x, method, settings)?.analysis().forward(x)?;
    Ok((forward.values, forward.error.is_some_and(|error| error.share > StepError::COARSE)))
}

/// Whether all derivatives by the durations agree. Adjoint and complex step do so up to what their steps make of one rounding of the
/// coordinates: accelerations that follow from constraints on coordinates are off by it over h2, and a rule that does not damp sums these up.
fn derivatives(x: &[f64; 2], case: usize) -> Result<Outcome, RunError> {
    let (scene, method) = (lifted_bar("").map_err(RunError::Input)?, method(case));
    let settings = AnyScene::settings(&scene).without_method();
    let prepared = Prepared::with(&scene, x, method.clone(), settings)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(x)?;
    let (adjoint, complex) = (analysis.adjoint(x, &forward)?.rows, analysis.complex_step(x, &forward)?.rows);
    let quotients = [[1.0, 0.0], [0.0, 1.0]].map(|direction| analysis.central_difference(x, &direction, 5e-4));
    let [by_duration, by_beginning] = quotients;
    let (by_duration, by_beginning) = (by_duration?, by_beginning?);
    let mut apart = [0.0; 2];
    for (k, row) in complex.iter().enumerate() {
        let size = row.iter().fold(f64::MIN_POSITIVE, |size: f64, d| size.max(d.abs()));
        for (i, quotient) in [by_duration[k], by_beginning[k]].into_iter().enumerate() {
            for (most, other) in apart.iter_mut().zip([adjoint[k][i], quotient]) {
                *most = f64::max(*most, (other - row[i]).abs() / size);
            }
        }
    }
    let rounded = method.table.round_off(method.level, &forward.grid, f64::EPSILON).acceleration;
    let limits = [LIMITS[0] + rounded / ACCELERATIONS, LIMITS[1]];
    Ok(match apart.iter().zip(limits).all(|(&apart, limit)| apart <= limit) {
        true => Outcome::Right,
        false => Outcome::Wrong(format!("derivatives are apart by {apart:?}, {limits:?} allowed")),
    })
}

/// Whether a force that becomes 0 N after 0 N, near or beside an end of a step, changes values by no more than other numbers of steps do: all are
/// held against a run by short steps of a method of order 5.
fn nothing_happens(x: &[f64; 2], t: f64, case: usize) -> Result<Outcome, RunError> {
    let force = format!(
        "[[force]]\nname = \"nothing\"\non = \"bob\"\ndirection = [0, 1, 0]\nsize = {{ type = \"step\", before = 0, after = 0, at = {t:?} }}\n"
    );
    let (without, with) = (lifted_bar("").map_err(RunError::Input)?, lifted_bar(&force).map_err(RunError::Input)?);
    let fine = table_by_name("esdirk5").ok_or_else(|| RunError::Input("esdirk5 is listed".into()))?;
    let (exact, _) = run(&without, x, Method::new(fine, ConstraintLevel::Acceleration), 240)?;
    let off = |values: &[f64], k: usize| (values[k] - exact[k]).abs();
    let mut allowed: Vec<f64> = exact.iter().map(|value| NOTHING * value.abs().max(1.0)).collect();
    for steps in NEAR {
        let (values, _) = run(&without, x, method(case), steps)?;
        allowed.iter_mut().enumerate().for_each(|(k, most)| *most = most.max(AS_OTHERS * off(&values, k)));
    }
    let (values, warned) = run(&with, x, method(case), 60)?;
    Ok(match (0..values.len()).find(|&k| off(&values, k) > allowed[k]) {
        None => Outcome::Right,
        Some(_) if warned => Outcome::Warned,
        Some(k) => Outcome::Wrong(format!("value {k} is off by {:.1e}, {:.1e} allowed", off(&values, k), allowed[k])),
    })
}

/// Counts both.
pub fn count(report: &mut Report, cases: usize) {
    let mut lot = Lot(0);
    let [mut right, mut warned, mut wrong, mut errors] = [0; 4];
    for case in 0..cases {
        let x = [lot.between(0.1, 0.95), lot.between(0.1, 0.95)];
        // between ends of steps, or next to one
        let step = lot.between(5.0, 55.0).floor() / 60.0;
        let t = step + [1e-5, -1e-5, 1e-8, 0.0, lot.between(0.0, 1.0 / 60.0)][case % 5];
        let Method { table, level, .. } = method(case);
        let named = format!("breakpoints {case}, {} at {} level, at {x:?} and {t}", table.name, level.name());
        for outcome in [derivatives(&x, case), nothing_happens(&x, t, case)] {
            match outcome {
                Ok(Outcome::Right) => right += 1,
                Ok(Outcome::Warned) => warned += 1,
                Ok(Outcome::Wrong(why)) => {
                    wrong += 1;
                    report.note(format!("{named}: {why}"));
                }
                Err(error) => {
                    errors += 1;
                    report.note(format!("{named}: {error}"));
                }
            }
        }
    }
    report.inform("breakpoints/right", f64::from(right));
    report.inform("breakpoints/beyond what other steps do, with a warning", f64::from(warned));
    report.at_most("breakpoints/errors", f64::from(errors), 0.0);
    report.at_most("breakpoints/wrong", f64::from(wrong), 0.0);
}
