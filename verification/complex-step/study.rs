//! Adjoint and tangent gradients against complex step and difference quotients, over the lists of everything.

mod measures;
mod scenes;

use crate::verification::{Report, Study};
use costate::integrators::{ConstraintLevel, Method, RunError, Table, tables};
use costate::scenes::{AnyScene, Prepared, Scene};
use costate::sensitivity::{Analysis, Gradient, largest_difference};
use rayon::prelude::*;
use scenes::Case;

/// Largest difference of the exact gradients, relative to the largest entry of each row.
const EXACT: f64 = 1e-12;
/// How many times the spread of a gradient under round-off its versions may differ, where that spread is above [`EXACT`].
const SPREADS: f64 = 10.0;
/// What no spread excuses.
const LARGEST_LIMIT: f64 = 1e-8;
/// Largest difference from a difference quotient, relative to the largest term of the directional derivative.
const QUOTIENT: f64 = 1e-6;
/// Step of the difference quotient, relative to the variables.
const STEP: f64 = 1e-3;
/// A second step at position level, where forces carry round-off of 1e-10: which of the two is limited by round-off and which by
/// the length of the step differs from scene to scene, and a wrong gradient would agree with neither.
const LONG_STEP: f64 = 2.5e-3;

/// The study.
pub struct ComplexStep;

impl Study for ComplexStep {
    fn name(&self) -> &'static str {
        "complex-step"
    }
    fn summary(&self) -> &'static str {
        "every element, functional, integrator and constraint level: adjoint, tangent, complex step and differences agree"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let cases = scenes::list();
        let combinations: Vec<(&Case, Table, ConstraintLevel)> = cases
            .iter()
            .flat_map(|case| tables().into_iter().map(move |table| (case, table)))
            .flat_map(|(case, table)| ConstraintLevel::ALL.map(|level| (case, table.clone(), level)))
            .collect();
        let outcomes: Vec<Result<Outcome, RunError>> =
            combinations.par_iter().map(|(case, table, level)| compare(case, Method::new(table.clone(), *level))).collect();

        let mut total = Outcome::default();
        let mut by_level = ConstraintLevel::ALL.map(|_| Outcome::default());
        for ((case, table, level), outcome) in combinations.iter().zip(outcomes) {
            let name = format!("{}/{}/{}", case.name, table.name, level.name());
            let outcome = outcome.unwrap_or_else(|error| {
                report.note(format!("{name}: {error}"));
                Outcome { adjoint: f64::NAN, tangent: f64::NAN, quotient: f64::NAN, ..Outcome::default() }
            });
            let limit = EXACT.max((SPREADS * outcome.spread).min(LARGEST_LIMIT));
            report.at_most(format!("{name}/adjoint"), outcome.adjoint, limit);
            report.at_most(format!("{name}/tangent"), outcome.tangent, limit);
            report.at_most(format!("{name}/difference-quotient"), outcome.quotient, QUOTIENT);
            for line in &outcome.lines {
                report.note(format!("{name}: {line}"));
            }
            let level = ConstraintLevel::ALL.iter().position(|own| own == level).unwrap_or(0);
            by_level[level].add(&outcome);
            total.add(&outcome);
        }
        for (level, worst) in ConstraintLevel::ALL.iter().zip(&by_level) {
            report.inform(format!("worst/{}/adjoint", level.name()), worst.adjoint);
            report.inform(format!("worst/{}/tangent", level.name()), worst.tangent);
            report.inform(format!("worst/{}/difference-quotient", level.name()), worst.quotient);
            report.inform(format!("worst/{}/spread-under-round-off", level.name()), worst.spread);
            report.inform(format!("combinations-above-1e-12/{}", level.name()), worst.above as f64);
        }
        report.inform("combinations", combinations.len() as f64);
        report.inform("entries", total.entries as f64);
        report.inform("entries-declared-zero", total.zeros as f64);
        report.at_most("entries-declared-zero-but-not", total.not_zero as f64, 0.0);
        report.at_most("entries-zero-but-not-declared", total.not_declared as f64, 0.0);
        Ok(())
    }
}

/// What one combination showed.
#[derive(Default)]
struct Outcome {
    adjoint: f64,
    tangent: f64,
    quotient: f64,
    /// How far the gradient moves when the design moves by round-off; measured only where it may matter.
    spread: f64,
    /// 1 if the exact gradients differ by more than [`EXACT`].
    above: usize,
    entries: usize,
    zeros: usize,
    not_zero: usize,
    not_declared: usize,
    lines: Vec<String>,
}

impl Outcome {
    fn add(&mut self, other: &Outcome) {
        self.adjoint = worse(self.adjoint, other.adjoint);
        self.tangent = worse(self.tangent, other.tangent);
        self.quotient = worse(self.quotient, other.quotient);
        self.spread = worse(self.spread, other.spread);
        self.above += other.above;
        self.entries += other.entries;
        self.zeros += other.zeros;
        self.not_zero += other.not_zero;
        self.not_declared += other.not_declared;
    }
}

/// The larger one, or NaN.
fn worse(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// All functionals of one scene with one method, four ways.
fn compare(case: &Case, method: Method) -> Result<Outcome, RunError> {
    let scene: &dyn AnyScene = case;
    let variables = scene.design_variables();
    let x: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
    let steps: &[f64] = if method.level == ConstraintLevel::Position { &[STEP, LONG_STEP] } else { &[STEP] };
    let prepared = Prepared::with(scene, &x, method, case.settings())?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x)?;
    let adjoint = analysis.adjoint(&x, &forward)?;
    let tangent = analysis.tangent(&x, &forward)?;
    let complex = analysis.complex_step(&x, &forward)?;
    // one generic direction through all variables at which the motion is differentiable
    let direction: Vec<f64> = variables
        .iter()
        .zip(1..)
        .map(|(variable, i)| {
            let left_out = case.one_sided.contains(&variable.name.as_str());
            if left_out { 0.0 } else { f64::from(3 * i).cos() * variable.initial.abs().max(0.1) }
        })
        .collect();
    let quotients: Vec<Vec<f64>> =
        steps.iter().map(|&step| analysis.central_difference(&x, &direction, step)).collect::<Result<_, _>>()?;

    let reaches = case.reaches();
    let mut outcome = Outcome::default();
    for (index, entry) in measures::LIST.into_iter().enumerate() {
        let rows = [&complex.rows[index], &adjoint.rows[index], &tangent.rows[index]];
        outcome.adjoint = worse(outcome.adjoint, largest_difference(rows[0], rows[1]));
        outcome.tangent = worse(outcome.tangent, largest_difference(rows[0], rows[2]));
        let terms: Vec<f64> = rows[1].iter().zip(&direction).map(|(g, d)| g * d).collect();
        let largest = terms.iter().fold(0.0, |s: f64, term| s.max(term.abs()));
        let slope: f64 = terms.iter().sum();
        let misses = quotients.iter().map(|quotient| (slope - quotient[index]).abs());
        let miss = misses.fold(f64::INFINITY, f64::min);
        outcome.quotient = worse(outcome.quotient, if miss == 0.0 { 0.0 } else { miss / largest });
        for (place, (variable, &reach)) in variables.iter().zip(&reaches).enumerate() {
            let entries = rows.map(|row| row[place]);
            outcome.entries += 1;
            let declared = measures::is_zero(entry, reach);
            outcome.zeros += usize::from(declared);
            if declared && entries.iter().any(|&entry| entry != 0.0) {
                outcome.not_zero += 1;
                outcome.lines.push(format!("{} by {} is not zero: {entries:?}", measures::name(entry), variable.name));
            }
            if !declared && entries.contains(&0.0) {
                outcome.not_declared += 1;
                outcome.lines.push(format!("{} by {} is zero: {entries:?}", measures::name(entry), variable.name));
            }
        }
    }
    if outcome.adjoint.max(outcome.tangent) > EXACT {
        outcome.above = 1;
        outcome.spread = spread(&analysis, &x, &direction, &tangent)?;
    }
    Ok(outcome)
}

/// Largest change of a gradient row, relative to its largest entry, when variables along the direction move by a unit in the last
/// place.
///
/// No two ways to a gradient can agree better than it agrees with itself.
fn spread(analysis: &Analysis, x: &[f64], direction: &[f64], tangent: &Gradient) -> Result<f64, RunError> {
    let moved: Vec<f64> =
        x.iter().zip(direction).map(|(x, &along)| if along == 0.0 { *x } else { x * (1.0 + f64::EPSILON) }).collect();
    let other = analysis.tangent(&moved, &analysis.forward(&moved)?)?;
    let changes = tangent.rows.iter().zip(&other.rows).map(|(row, other)| largest_difference(row, other));
    Ok(changes.fold(0.0, worse))
}
