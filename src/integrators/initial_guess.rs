//! Solutions of single systems, from where their search starts.

use super::RunError;
use super::newton::Newton;
use super::record::SolveRecord;
use crate::assembly::{Residual, StageSystem, Unknowns};
use crate::elements::RunScalar;

#[derive(Clone, Copy)]
pub(super) enum InitialGuess<'g> {
    Zero,
    Given,
    Solved(&'g Unknowns<f64>),
}

impl<'g> InitialGuess<'g> {
    pub(super) fn guided(record: Option<&'g SolveRecord<f64>>) -> Self {
        record.map_or(InitialGuess::Zero, |record| InitialGuess::Solved(&record.unknowns))
    }
}

/// Solves the system of a record, whose time, equations and base are given, and keeps there what the adjoint needs.
pub(super) fn solve<S: RunScalar>(
    newton: &mut Newton<S>,
    record: &mut SolveRecord<S>,
    first: InitialGuess,
    p: &[S],
    place: &dyn Fn() -> String,
) -> Result<(), RunError> {
    let SolveRecord { t, equations, base, unknowns } = record;
    match first {
        InitialGuess::Zero => Residual::shape(&newton.system, unknowns, true),
        InitialGuess::Given => Residual::shape(&newton.system, unknowns, false),
        InitialGuess::Solved(real) => *unknowns = lifted(real),
    }
    let stage = StageSystem { equations, base, p, t: *t };
    let solved = match first {
        InitialGuess::Solved(_) => newton.solve_guided(stage, unknowns),
        _ => newton.solve(stage, unknowns),
    };
    solved.map_err(|failure| newton.describe(&failure, equations, &place()))
}

fn lifted<S: RunScalar>(real: &Unknowns<f64>) -> Unknowns<S> {
    let lift = |values: &[f64]| values.iter().map(|&value| S::from(value)).collect();
    Unknowns { x: lift(&real.x), mu: lift(&real.mu), local_mu: lift(&real.local_mu) }
}
