//! Spatial loops whose equations depend on each other.

use super::{prepare, watch, worse};
use crate::Report;
use costate::functionals::Sample;
use costate::internals::{Measured, VectorsAvq};
use costate::scenes::{Prepared, Violation, built_in};

/// What is conserved over a run.
pub struct Conserved {
    /// Largest change of the energy by the range of the potential energy.
    pub energy: f64,
    /// Largest violation of all equations, those that were dropped included.
    pub worst: Violation,
}

/// Energy and constraints after every step.
pub fn conserved(prepared: &Prepared) -> Result<Conserved, String> {
    let (model, numbers) = (prepared.model(), &prepared.mechanism.numbers);
    let measured = Measured::energy();
    let energy = |q: &[f64], v: &[f64]| {
        let at = VectorsAvq { a: Vec::new(), v: v.to_vec(), q: q.to_vec() };
        measured.value(model, &Sample { at, ..Sample::empty() }, &numbers.p)
    };
    let rest = vec![0.0; numbers.v.len()];
    let start = energy(&numbers.q, &numbers.v);
    let at_rest = energy(&numbers.q, &rest);
    let (mut change, mut low, mut high) = (0.0, at_rest, at_rest);
    let mut worst = Violation::default();
    watch(prepared, |_, t, q, v| {
        worst = worst.worse(prepared.violation(t, q, v));
        change = worse(change, (energy(q, v) - start).abs());
        let potential = energy(q, &rest);
        (low, high) = (potential.min(low), potential.max(high));
        true
    })?;
    Ok(Conserved { energy: change / (high - low), worst })
}

/// Order 4, h = 1 ms: energy and constraints over 10 s; the motion against a method of order 5 with the same step.
pub fn bricard(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("bricard")?, "sdirk4", 10.0, 10_000)?;
    report.compare("iftomm-a04/equations left out", prepared.plan.dropped.len() as f64, 1.0, 0.0);
    let Conserved { energy, worst } = conserved(&prepared)?;
    report.at_most("iftomm-a04/largest change of energy over 10 s by the range of the potential energy", energy, 1e-8);
    report.at_most("iftomm-a04/largest |g| over 10 s, the equation left out included", worst.position, 1e-13);
    let mut course = Vec::new();
    watch(&prepared, |_, _, q, _| {
        course.push(q.to_vec());
        true
    })?;
    let mut apart = 0.0;
    watch(&prepare(built_in::named("bricard")?, "esdirk5", 10.0, 10_000)?, |step, _, q, _| {
        apart = q.iter().zip(&course[step - 1]).fold(apart, |most, (a, b)| worse(most, (a - b).abs()));
        true
    })?;
    report.at_most("iftomm-a04/largest difference of coordinates over 10 s, orders 4 and 5", apart, 1e-9);
    Ok(())
}
