//! Breakpoints drawn by lot: some that design variables move, and some at which nothing happens.

use crate::verification::Report;
use costate::integrators::tables;
use costate::prelude::*;
use costate::scenes::FileScene;

/// Difference of adjoint and complex step, and of complex step and difference quotients, as shares of the largest entry.
const LIMITS: [f64; 2] = [1e-11, 1e-5];
/// Change of the end [m] by a breakpoint at which nothing happens: what another number of steps does.
const NO_CHANGE: f64 = 5e-3;

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

/// A run of the bar: its settings are drawn, its method is the next one.
fn prepared<'s>(scene: &'s FileScene, x: &[f64], case: usize) -> Result<Prepared<'s>, RunError> {
    let all: Vec<_> = tables().into_iter().filter(|table| !table.is_static()).collect();
    let method = Method::new(all[case % all.len()].clone(), ConstraintLevel::ALL[case / all.len() % 3]);
    Prepared::with(scene, x, method, Scene::settings(scene).without_method())
}

/// Whether all derivatives by the durations agree.
fn is_right(x: &[f64; 2], case: usize) -> Result<bool, RunError> {
    let scene = lifted_bar("").map_err(RunError::Input)?;
    let prepared = prepared(&scene, x, case)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(x)?;
    let (adjoint, complex) = (analysis.adjoint(x, &forward)?.rows, analysis.complex_step(x, &forward)?.rows);
    let quotients = [[1.0, 0.0], [0.0, 1.0]].map(|direction| analysis.central_difference(x, &direction, 5e-4));
    let [by_duration, by_beginning] = quotients;
    let (by_duration, by_beginning) = (by_duration?, by_beginning?);
    let near = |a: f64, b: f64, limit: f64| (a - b).abs() <= limit;
    Ok((0..complex.len()).all(|k| {
        let size = complex[k].iter().fold(0.0, |size: f64, d| size.max(d.abs()));
        let quotients = [by_duration[k], by_beginning[k]];
        (0..2).all(|i| {
            near(adjoint[k][i], complex[k][i], LIMITS[0] * size) && near(quotients[i], complex[k][i], LIMITS[1] * size)
        })
    }))
}

/// Whether a force that becomes 0 N after 0 N, near or beside an end of a step, changes nothing.
fn is_unchanged(x: &[f64; 2], t: f64, case: usize) -> Result<bool, RunError> {
    let force = format!(
        "[[force]]\nname = \"nothing\"\non = \"bob\"\ndirection = [0, 1, 0]\nsize = {{ type = \"step\", before = 0, after = 0, at = {t:?} }}\n"
    );
    let (without, with) = (lifted_bar("").map_err(RunError::Input)?, lifted_bar(&force).map_err(RunError::Input)?);
    let values = |scene: &FileScene| prepared(scene, x, case)?.analysis().values(x);
    let (own, other) = (values(&with)?, values(&without)?);
    Ok(own.iter().zip(&other).all(|(own, other)| (own - other).abs() <= NO_CHANGE * other.abs().max(1.0)))
}

/// Counts both.
pub fn count(report: &mut Report, cases: usize) {
    let mut lot = Lot(0);
    let [mut right, mut wrong, mut errors, mut conditioned] = [0; 4];
    let tables = tables().into_iter().filter(|table| !table.is_static()).count();
    for case in 0..cases {
        let x = [lot.between(0.1, 0.95), lot.between(0.1, 0.95)];
        // between ends of steps, or next to one
        let step = lot.between(5.0, 55.0).floor() / 60.0;
        let t = step + [1e-5, -1e-5, 1e-8, 0.0, lot.between(0.0, 1.0 / 60.0)][case % 5];
        for outcome in [is_right(&x, case), is_unchanged(&x, t, case)] {
            match outcome {
                Ok(true) => right += 1,
                // at position level the condition of systems grows with 1/h2
                Ok(false) if ConstraintLevel::ALL[case / tables % 3] == ConstraintLevel::Position => conditioned += 1,
                Ok(false) => wrong += 1,
                Err(_) => errors += 1,
            }
        }
    }
    report.inform("breakpoints/right", f64::from(right));
    report.at_most("breakpoints/errors", f64::from(errors), 0.0);
    report.inform("breakpoints/beyond the limits at position level", f64::from(conditioned));
    // open: one of the 90 drawn runs is beyond the limits
    report.inform("breakpoints/beyond the limits at other levels", f64::from(wrong));
}
