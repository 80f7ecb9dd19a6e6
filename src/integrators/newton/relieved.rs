//! A search with stresses that are relieved: for slender beams, whose stresses amid a search would stiffen every matrix.

use super::Newton;
use super::convergence::LOST;
use super::failure::{Failure, FailureKind};
use crate::assembly::{Equations, Jacobian, StageSystem, Unknowns};
use crate::elements::RunScalar;

/// Displacement in one correction, by the model's length, beyond which it is shortened: what is linear at its start turns by no more than a fifth
/// of a radian.
const FARTHEST: f64 = 0.1;
const MOST_RELIEVED: usize = 60;

impl<S: RunScalar> Newton<'_, S> {
    /// Whether stresses can be kept apart from displacements in a search for these unknowns.
    pub(super) fn can_relieve(&mut self, equations: &Equations) -> bool {
        let displaces = equations.residual.alpha != 0.0 && !equations.metric && equations.variational.is_none();
        displaces && self.has_stresses()
    }

    /// Whether elements have stresses that a search can relieve.
    pub(super) fn has_stresses(&mut self) -> bool {
        *self.relievable.get_or_insert_with(|| Jacobian::can_relieve(&self.system))
    }

    /// Comes near to a solution with stresses that follow the strains only as far as each correction foresees it
    /// ([`Jacobian::relieve`]): from coordinates whose stresses are trusted.
    pub(super) fn approach_relieved(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let StageSystem { equations, p, t, .. } = stage;
        let mut before = std::mem::take(&mut self.trusted);
        let trusted = before.clone();
        let mut previous = f64::INFINITY;
        // at first stresses are those at the place that is trusted
        let mut change = vec![0.0; self.system.model.dofs];
        let mut approach = || {
            for iteration in 1..=MOST_RELIEVED {
                let fail = |how, correction| Err(Failure { how, iterations: iteration, correction });
                self.kept.factored = None;
                self.evaluate(stage, unknowns);
                let size = self.residual_size();
                if !size.is_finite() {
                    return fail(FailureKind::NotFinite, size);
                }
                let values = |list: &[S]| list.iter().map(|x| x.value()).collect::<Vec<_>>();
                let after = values(&self.residual.at.q);
                if before.len() != after.len() {
                    before.clone_from(&after);
                }
                self.jacobian.relieve(&self.system, &self.residual, [&before, &change], &values(p), t);
                let factored = self.factorize(stage, unknowns);
                factored.map_err(|singular| Failure::singular(singular, iteration))?;
                before = after;
                self.counters.iterations += 1;
                let alpha = equations.residual.alpha;
                change.iter_mut().zip(&unknowns.x).for_each(|(change, x)| *change = -alpha * x.value());
                self.work.x.clone_from(&unknowns.x);
                let step = self.step(None, unknowns);
                let displacement = self.displacement(equations, step);
                if !(step.is_finite() && displacement <= LOST) {
                    return fail(FailureKind::Diverged, step);
                }
                if displacement > FARTHEST {
                    let left = 1.0 - FARTHEST / displacement;
                    unknowns.x.iter_mut().zip(&self.work.x).for_each(|(x, before)| *x -= (*x - *before) * left);
                }
                change.iter_mut().zip(&unknowns.x).for_each(|(change, x)| *change += alpha * x.value());
                if displacement <= crate::tolerances::NO_ROUND_OFF {
                    return Ok(());
                }
                previous = step;
            }
            Err(Failure { how: FailureKind::Stagnated, iterations: MOST_RELIEVED, correction: previous })
        };
        let result = approach();
        self.trusted = trusted;
        self.jacobian.end_relief();
        self.kept.factored = None;
        result
    }
}
