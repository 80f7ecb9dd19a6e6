//! Points from which the systems of a step start: they follow from the vectors carried into it and from the solutions before them.

use super::march::{Method, add_scaled, combine};
use super::record::{SolveRecord, StageRecord, StepRecord};
use super::table::Table;
use crate::assembly::{Equations, VectorsAvq};
use crate::elements::RunScalar;

/// What all steps of a run have in common.
#[derive(Clone, Copy)]
pub struct StepRule<'r> {
    pub method: &'r Method,
    pub constrained: bool,
}

impl<'r> StepRule<'r> {
    pub fn table<S>(&self, step: &StepRecord<S>) -> &'r Table {
        self.method.table.scheme(step.scheme)
    }
}

impl<S: RunScalar> StepRecord<S> {
    /// Writes point, equations and time of a stage; of a known one its acceleration as well.
    pub(super) fn begin_stage(&mut self, rule: StepRule, index: usize) {
        let (table, StepRecord { t, h, end, carried, stages, .. }) = (rule.table(self), self);
        let stage = &table.stages[index];
        let (earlier, own) = stages.split_at_mut(index);
        let StageRecord { solve, known } = &mut own[0];
        let VectorsAvq { a, v, q } = &mut solve.base;
        for (order, combination, sum) in [(2, &stage.a, a), (1, &stage.v, v), (0, &stage.q, q)] {
            combine(table, order, combination, *h, carried, earlier, sum);
        }
        solve.equations = rule.method.stage_equations(table, index, *h, rule.constrained);
        // a stage at the end of the step lies before the breakpoint that may be there, whatever t + h rounds to
        solve.t =
            if stage.c <= 1.0 + crate::tolerances::LONG_SUM { (*t + stage.c * *h).min(*end) } else { *t + stage.c * *h };
        *known = stage.known;
        if let Some(place) = stage.known {
            solve.unknowns.x.clone_from(&carried[place]);
        }
    }

    /// Writes the first of the carried vectors behind the stages, as many as there are, before projections.
    pub(super) fn update(&self, rule: StepRule, updated: &mut [Vec<S>]) {
        let table = rule.table(self);
        let StepRecord { h, carried, stages, .. } = self;
        for ((update, kind), new) in table.update.iter().zip(&table.carried).zip(&mut *updated) {
            combine(table, kind.order(), update, *h, carried, stages, new);
        }
    }

    /// The carried vectors behind the step.
    pub fn carried_behind(&self, rule: StepRule) -> Vec<Vec<S>> {
        let mut all = vec![Vec::new(); rule.table(self).carried.len()];
        self.update(rule, &mut all);
        all[0].clone_from(&self.q);
        all[1].clone_from(&self.v);
        all
    }

    /// Writes point, equations and time of a projection of coordinates or of velocities, whichever is `order` times derived. Both share the
    /// last stage's matrix.
    pub(super) fn begin_projection(&mut self, rule: StepRule, order: usize, [q, v]: [&[S]; 2]) -> &mut SolveRecord<S> {
        let table = rule.table(self);
        let shift = table.shift(table.stages.len() - 1, self.h);
        let (own, equations) = match order {
            0 => (&mut self.position_projection, Equations::position_projection(shift)),
            _ => (&mut self.velocity_projection, Equations::velocity_projection(shift)),
        };
        let own = own.get_or_insert_with(SolveRecord::default);
        (own.t, own.equations) = (self.end, equations);
        let a = self.stages.last().map_or(&[][..], |last| &last.solve.unknowns.x);
        for (base, values) in [(&mut own.base.a, a), (&mut own.base.v, v), (&mut own.base.q, q)] {
            base.clear();
            base.extend_from_slice(values);
        }
        own
    }

    pub(super) fn end_projection(projection: &SolveRecord<S>, order: usize, [q, v]: [&mut [S]; 2]) {
        let shift = projection.equations.constraint;
        let x = &projection.unknowns.x;
        if order == 0 { add_scaled(q, x, shift.alpha) } else { add_scaled(v, x, shift.beta) }
    }

    /// Writes all that follows from the carried vectors and the solutions, as it was when the step was made.
    pub fn follow(&mut self, rule: StepRule) {
        for index in 0..self.stages.len() {
            self.begin_stage(rule, index);
        }
        let mut updated = [&mut self.q, &mut self.v].map(std::mem::take);
        self.update(rule, &mut updated);
        let [q, v] = &mut updated;
        for order in 0..2 {
            let is_made = if order == 0 { &self.position_projection } else { &self.velocity_projection }.is_some();
            if is_made {
                let own = self.begin_projection(rule, order, [q, v]);
                Self::end_projection(own, order, [q, v]);
            }
        }
        [self.q, self.v] = updated;
    }
}
