//! Scenes whose measurements are made: runs at known numbers, with errors that are drawn.

use crate::Noise;
use costate::integrators::RunError;
use costate::optimize::{Case, Fit};
use costate::scenes::{AnyScene, FileScene, FitProblem, Measurement, Scenario};
use std::f64::consts::TAU;

/// A scene with what is measured of it.
pub struct Made {
    pub name: &'static str,
    pub text: &'static str,
    /// Numbers of the variables by which the measurements are made; fits start at others.
    pub truth: &'static [f64],
    /// Functionals with the standard deviations of their errors, and how often each is measured.
    pub measured: &'static [(&'static str, f64)],
    pub count: usize,
}

/// A mass of 2 kg between a spring and a damper, let go from a place.
pub const OSCILLATOR: Made = Made {
    name: "oscillator",
    text: r#"version = 1
settings = { end = 3.0, steps = 300 }
[variable]
stiffness = { initial = 50, bounds = [1, 500], unit = "N/m" }
damping = { initial = 0.5, bounds = [0, 20], unit = "N s/m" }
release = { initial = 0.05, bounds = [0.01, 0.5], unit = "m" }
mass = { initial = 2, bounds = [0.1, 10], unit = "kg" }
delay = { initial = 0, bounds = [0, 0.04], unit = "s" }
[[point]]
name = "mass"
position = ["release", 0, 0]
mass = "mass"
[[joint]]
name = "rail"
type = "point_on_line"
between = ["ground", "mass"]
axis = [1, 0, 0]
[[spring]]
name = "spring"
type = "line"
between = ["ground", "mass"]
points = [[-1, 0, 0], ["release", 0, 0]]
stiffness = "stiffness"
rest_length = 1.0
[[damper]]
name = "damper"
type = "line"
between = ["ground", "mass"]
points = [[-1, 0, 0], ["release", 0, 0]]
damping = "damping"
[[functional]]
name = "place"
type = "position"
on = "mass"
direction = [1, 0, 0]
over = "terminal"
"#,
    truth: &[80.0, 1.6, 0.1, 2.0, 0.0],
    measured: &[("place", 0.002)],
    count: 60,
};

/// Five masses of 1 kg between five springs, of which the first hangs on the ground and the last mass is struck; three of them are measured.
pub const CHAIN: Made = Made {
    name: "chain of five springs",
    text: r#"version = 1
settings = { end = 4.0, steps = 400 }
[variable]
k = { name = "stiffness", count = 5, initial = 150, bounds = [10, 1000], unit = "N/m" }
[[point]]
name = "mass {i}"
for = { i = { from = 1, to = 5 } }
position = ["{i}", 0, 0]
velocity = ["if_less({i}, 4.5, 0, 1)", 0, 0]
mass = 1
[[joint]]
name = "rail {i}"
for = { i = { from = 1, to = 5 } }
type = "point_on_line"
between = ["ground", "mass {i}"]
axis = [1, 0, 0]
[[spring]]
name = "spring 1"
type = "line"
between = ["ground", "mass 1"]
points = [[0, 0, 0], [1, 0, 0]]
stiffness = "k[0]"
rest_length = 1
[[damper]]
name = "damper"
type = "line"
between = ["ground", "mass 1"]
damping = 0.3
[[spring]]
name = "spring {i + 1}"
for = { i = { from = 1, to = 4 } }
type = "line"
between = ["mass {i}", "mass {i + 1}"]
stiffness = "k[{i}]"
rest_length = 1
[[functional]]
name = "place {i}"
for = { i = [1, 3, 5] }
type = "position"
on = "mass {i}"
direction = [1, 0, 0]
over = "terminal"
"#,
    truth: &[100.0, 140.0, 200.0, 90.0, 250.0],
    measured: &[("place 1", 0.005), ("place 3", 0.005), ("place 5", 0.005)],
    count: 100,
};

/// The quarter car on its measured road: accelerations of body and wheel.
pub const QUARTER_CAR: Made = Made {
    name: "quarter car on a measured road",
    text: r#"
[[functional]]
name = "acceleration of the body"
type = "acceleration"
on = "body"
direction = [0, 0, 1]
over = "terminal"
[[functional]]
name = "acceleration of the wheel"
type = "acceleration"
on = "wheel"
direction = [0, 0, 1]
over = "terminal"
"#,
    truth: &[2.6e4, 1.3e3, 0.22, 2e5, 2.1e5],
    measured: &[("acceleration of the body", 0.1), ("acceleration of the wheel", 0.5)],
    count: 300,
};

/// A flexible arm with a mass at its tip, let go from a bent shape: the curvature at its root, as strain gauges tell it, and the acceleration at its tip.
pub const ARM: Made = Made {
    name: "flexible arm by strain and acceleration",
    text: r#"version = 1
settings = { end = 1.0, steps = 500 }
[variable]
young = { initial = 60e9, bounds = [20e9, 300e9], unit = "Pa" }
loss = { name = "damping", initial = 1e-3, bounds = [1e-5, 2e-2], unit = "s" }
tip = { name = "tip mass", initial = 0.15, bounds = [0.02, 1], unit = "kg" }
[material.aluminium]
density = 2700
young = "young"
poisson = 0.33
[section.bar]
type = "rectangle"
damping = "loss"
width = 0.03
height = 0.003
material = "aluminium"
[[beam]]
name = "arm"
from = [0, 0, 0]
to = [0.6, 0, 0]
elements = 4
section = "bar"
second_axis = [0, 1, 0]
clamped = "start"
[[body]]
name = "tip"
position = [0.6, 0, 0]
mass = "tip"
inertia = [1e-5, 1e-5, 1e-5]
[[joint]]
name = "weld"
type = "fixed"
between = ["tip", "arm.end"]
[[force]]
name = "knock"
on = "tip"
direction = [0, 0, 1]
size = { type = "formula", value = "if_less(t, 0.02, 5 * sin(t * 157.0796)^2, 0)" }
[[functional]]
name = "curvature at the root"
type = "section_strain"
beam = "arm"
share = 0.125
component = "bending_2"
over = "terminal"
[[functional]]
name = "acceleration of the tip"
type = "acceleration"
on = "tip"
direction = [0, 0, 1]
over = "terminal"
"#,
    truth: &[70e9, 2e-3, 0.1],
    measured: &[("curvature at the root", 0.002), ("acceleration of the tip", 0.2)],
    count: 200,
};

/// The scene of a case; one without a version is what is added to a built-in one.
pub fn read(case: &Made) -> Result<FileScene, String> {
    match case.text.starts_with("version") {
        true => FileScene::parse("made.toml", case.text),
        false => costate::scenes::built_in::changed("quarter-car", case.text),
    }
}

/// Numbers with a normal distribution of deviation 1.
///
/// Source: Box & Muller (1958).
pub fn normal(noise: &mut Noise) -> f64 {
    let [u, v] = [(); 2].map(|()| 0.5 * (noise.next() + 1.0));
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

/// Measurements of the functionals of a case that are zero at times which do not end steps.
fn blank(case: &Made, end: f64) -> Vec<Measurement> {
    let times: Vec<f64> = (1..=case.count).map(|k| end * k as f64 / case.count as f64).collect();
    let one = |(functional, deviation): &(&str, f64)| Measurement {
        name: (*functional).into(),
        functional: (*functional).into(),
        unit: None,
        times: times.clone(),
        values: vec![0.0; case.count],
        deviations: Some(vec![*deviation; case.count]),
        delay: None,
    };
    case.measured.iter().map(one).collect()
}

/// A fit of some variables to measurements.
pub fn fit_to<'s>(scene: &'s dyn AnyScene, problem: FitProblem) -> Result<Fit<'s>, RunError> {
    let cases = Scenario::all_of(scene).into_iter().map(Case::of).collect::<Result<_, _>>()?;
    Fit::new(scene, problem, cases)
}

/// What a case measures at a design, without errors.
pub fn exact(scene: &dyn AnyScene, case: &Made, x: &[f64]) -> Result<Vec<Measurement>, RunError> {
    let mut measurements = blank(case, scene.settings().end);
    let problem = FitProblem { measurements: measurements.clone(), ..FitProblem::default() };
    let values = fit_to(scene, problem)?.residuals(x)?;
    for (own, (values, (_, deviation))) in measurements.iter_mut().zip(values.chunks(case.count).zip(case.measured)) {
        own.values = values.iter().map(|value| value * deviation).collect();
    }
    Ok(measurements)
}

/// The same with errors, as they are drawn.
pub fn drawn(exact: &[Measurement], noise: &mut Noise) -> Vec<Measurement> {
    let with_errors = |own: &Measurement| {
        let deviations = own.deviations.iter().flatten();
        let values = own.values.iter().zip(deviations).map(|(value, deviation)| value + deviation * normal(noise)).collect();
        Measurement { values, ..own.clone() }
    };
    exact.iter().map(with_errors).collect()
}
