//! Gradients against quotients of whole runs.

use super::Report;
use costate::integrators::RunError;
use costate::scenes::{AnyScene, DesignVariable, Prepared};
use costate::sensitivity::{Forward, Gradient, Quotient};

/// As a share of the derivative along a direction.
const QUOTIENT: f64 = 1e-6;
/// Derivatives below this share of the functional itself are compared by it.
const SLIGHT: f64 = 1e-4;

/// A design away from bounds, on which a scene begins.
pub fn inside(scene: &dyn AnyScene) -> Vec<f64> {
    let inwards = |own: &DesignVariable| own.initial + 0.1 * (0.5 * (own.lower + own.upper) - own.initial);
    scene.variables().iter().map(inwards).collect()
}

/// Compares the gradients of some functionals along a direction in which all variables change.
pub fn compare_with_whole_runs(
    report: &mut Report,
    name: &str,
    prepared: &Prepared,
    (forward, gradient): (&Forward, &Gradient),
    wanted: impl Fn(usize) -> bool,
) -> Result<(), RunError> {
    let x = &prepared.x;
    let direction: Vec<f64> = x.iter().enumerate().map(|(k, x)| x * if k % 3 == 1 { -0.3 } else { 0.2 }).collect();
    let quotients = prepared.analysis().quotients(x, &direction)?;
    for (k, functional) in prepared.functionals().iter().enumerate().filter(|own| wanted(own.0)) {
        let own: f64 = gradient.rows[k].iter().zip(&direction).map(|(own, d)| own * d).sum();
        // beyond what roundings leave of the quotient
        let Quotient { value, floor, .. } = quotients[k];
        let off = ((own - value).abs() - floor).max(0.0) / own.abs().max(SLIGHT * forward.values[k].abs());
        report.at_most(format!("{name}/gradient of {} against whole runs, share", functional.name), off, QUOTIENT);
    }
    Ok(())
}
