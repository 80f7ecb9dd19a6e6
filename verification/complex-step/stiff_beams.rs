//! Stiff beams with the default method: what a difference quotient can show, functional by functional.

use super::QUOTIENT;
use crate::Report;
use crate::rounding::SCATTER;
use costate::integrators::RunError;
use costate::internals::{DesignMap, ModelNumbers, Recorded};
use costate::scenes::{AnyScene, Prepared, built_in};
use costate::sensitivity::Analysis;

/// Name of a functional of a section's axial force in the list of scenes.
const AXIAL: &str = "axial force";
/// Axial stiffness of the spin-up beam by its name there, its value, and a soft one [N].
const STIFFNESS: (&str, [f64; 2]) = ("EA", [2.8e7, 1e6]);
/// Its largest coordinate and the length of its elements [m].
const EXTENT: [f64; 2] = [10.0, 1.25];
/// Steps at which the quotient of an axial force is nothing but rounding, relative to the direction.
const SMALL_STEPS: [f64; 3] = [1e-6, 1e-7, 1e-8];

/// The same design with the places of all nodes rounded up or down by turns.
struct Rounded<'a> {
    map: &'a dyn DesignMap,
    up: usize,
}

impl DesignMap for Rounded<'_> {
    fn real(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String> {
        let mut numbers = self.map.real(x)?;
        for (place, q) in numbers.q.iter_mut().enumerate() {
            *q = if place % 2 == self.up { q.next_up() } else { q.next_down() };
        }
        Ok(numbers)
    }
    fn recorded(&self, x: &[Recorded]) -> Result<ModelNumbers<Recorded>, String> {
        self.map.recorded(x)
    }
}

/// How far functionals are apart when the places of the nodes are rounded.
fn scatter(analysis: &Analysis, x: &[f64]) -> Result<Vec<f64>, RunError> {
    let with = |up: usize| Analysis { map: &Rounded { map: analysis.map, up }, ..*analysis }.values(x);
    let (one, other) = (with(0)?, with(1)?);
    Ok(one.iter().zip(&other).map(|(a, b)| (a - b).abs()).collect())
}

/// Adjoint and quotients of both scenes, and what makes those of axial forces scatter.
pub fn run(report: &mut Report) -> Result<(), RunError> {
    for axial in STIFFNESS.1 {
        of_scene(report, built_in::named("spin-up-beam")?, 4.0, Some(axial))?;
    }
    of_scene(report, built_in::named("right-angle-cantilever")?, 3.0, None)
}

/// One scene up to an end [s] with steps of 0.01 s.
fn of_scene(report: &mut Report, scene: &dyn AnyScene, end: f64, axial: Option<f64>) -> Result<(), RunError> {
    let mut settings = scene.settings().without_method();
    (settings.end, settings.steps) = (end, (100.0 * end) as usize);
    let variables = scene.variables();
    let at = |name: &str, initial: f64| axial.filter(|_| name == STIFFNESS.0).unwrap_or(initial);
    let x: Vec<f64> = variables.iter().map(|variable| at(&variable.name, variable.initial)).collect();
    let direction: Vec<f64> = x.iter().zip(1..).map(|(x, i)| f64::from(3 * i).cos() * x.abs()).collect();
    let prepared = Prepared::with(scene, &x, Prepared::default_method(), settings)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x)?;
    let adjoint = analysis.adjoint(&x, &forward)?;
    let (quotients, noise) = (analysis.quotients(&x, &direction)?, analysis.noise(&x, &direction)?);
    let scatter = scatter(&analysis, &x)?;
    let stiffness = axial.map_or(String::new(), |axial| format!(", EA = {axial:.1e} N"));
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let name = format!("stiff/{}{stiffness}/{}", scene.name(), functional.name);
        let terms = || adjoint.rows[k].iter().zip(&direction).map(|(g, d)| g * d);
        let (slope, largest) = (terms().sum::<f64>(), terms().fold(0.0, |s: f64, term| s.max(term.abs())));
        let (miss, floor) = ((slope - quotients[k].value).abs() / largest, SCATTER * quotients[k].floor / largest);
        report.inform(format!("{name}/step of the quotient"), quotients[k].step);
        report.inform(format!("{name}/noise of the value"), noise[k]);
        report.inform(format!("{name}/scatter of the value, places of nodes rounded"), scatter[k]);
        let Some(axial) = axial.filter(|_| functional.name.starts_with(AXIAL)) else {
            report.at_most(format!("{name}/difference-quotient"), miss, QUOTIENT);
            continue;
        };
        report.at_most(format!("{name}/difference-quotient"), miss, floor.max(QUOTIENT));
        let rounding = axial * f64::EPSILON * EXTENT[0] / EXTENT[1];
        report.inform(format!("{name}/EA eps r / L [N]"), rounding);
        report.at_most(format!("{name}/noise by EA eps r / L"), noise[k] / rounding, 10.0);
        for step in SMALL_STEPS {
            let miss = (analysis.central(&x, &direction, step)?[k] - slope).abs();
            report.inform(format!("{name}/step {step:.0e}: difference, relative"), miss / largest);
            report.inform(format!("{name}/step {step:.0e}: EA eps r / L by the step, relative"), rounding / step / largest);
            report.at_most(
                format!("{name}/step {step:.0e}: difference by the noise over the step"),
                miss * step / noise[k],
                SCATTER,
            );
        }
    }
    Ok(())
}
