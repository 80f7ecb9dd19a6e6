//! A search in which no correction may leave more than there was: for friction in two directions, whose direction turns the faster the slower slip is.

use super::Newton;
use super::failure::{Failure, FailureKind};
use crate::assembly::{StageSystem, Unknowns};
use crate::elements::RunScalar;

/// Share of what a correction is to take away that it has to.
const TAKEN: f64 = 0.1;
/// Least share of a correction that is tried.
const LEAST: f64 = 1e-6;
/// Relative correction from which a search without shares ends.
const NEAR: f64 = 1e-6;
const MOST_DAMPED: usize = 100;

impl<S: RunScalar> Newton<'_, S> {
    /// Comes near to a solution by shares of corrections; with monotone equations, as those of friction are beside inertia, from anywhere.
    ///
    /// Source: Deuflhard (2011), Newton Methods for Nonlinear Problems, section 3.1.
    pub(super) fn approach_damped(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        self.evaluate(stage, unknowns);
        let mut left = self.residual_size();
        let fail = |how, iterations, correction| Err(Failure { how, iterations, correction });
        for iteration in 1..=MOST_DAMPED {
            if !left.is_finite() {
                return fail(FailureKind::NotFinite, iteration, left);
            }
            self.kept.factored = None;
            self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, iteration))?;
            self.counters.iterations += 1;
            let before = unknowns.clone();
            let step = self.step(None, unknowns);
            let full = unknowns.clone();
            let mut share = 1.0;
            let now = loop {
                self.evaluate(stage, unknowns);
                let now = self.residual_size();
                if now <= (1.0 - TAKEN * share) * left {
                    break now;
                }
                share *= 0.5;
                if share < LEAST {
                    // what is left is round-off, or no smaller
                    return fail(FailureKind::Stagnated, iteration, step);
                }
                *unknowns = between(&before, &full, share);
            };
            left = now;
            if share == 1.0 && step <= NEAR * self.size(&unknowns.x) {
                return Ok(());
            }
        }
        fail(FailureKind::Stagnated, MOST_DAMPED, left)
    }
}

/// Unknowns a share of the way from some to others.
fn between<S: RunScalar>(some: &Unknowns<S>, others: &Unknowns<S>, share: f64) -> Unknowns<S> {
    let list = |some: &[S], others: &[S]| some.iter().zip(others).map(|(&x, &y)| x + (y - x) * share).collect();
    Unknowns {
        x: list(&some.x, &others.x),
        mu: list(&some.mu, &others.mu),
        local_mu: list(&some.local_mu, &others.local_mu),
    }
}
