use crate::integrators::{Combination, StepRecord, Table};
use std::collections::VecDeque;

/// How much one stage of a step counts over a run.
#[derive(Clone, Copy, Debug)]
pub struct StageWeight {
    /// In an integral.
    pub integral: f64,
    /// In an aggregate, never negative: see [`Table::aggregate_weights`].
    pub aggregate: f64,
}

/// Weights of stages in an integral over a run, handed out from the last step to the first: the table's recursion for z' = f,
/// transposed.
///
/// For a one-step table they are h b_i; for one that looks further back they are known only when all later steps are.
#[derive(Clone, Debug)]
pub struct QuadratureWeights<'t> {
    table: &'t Table,
    /// d z_end / d z for the integral after the next step to go back through, and for earlier ones.
    latest: VecDeque<f64>,
}

impl<'t> QuadratureWeights<'t> {
    /// At the end of a run with a table.
    pub fn at_end(table: &'t Table) -> Self {
        QuadratureWeights { table, latest: VecDeque::from([1.0]) }
    }

    /// Goes back through a step: the weight of each of its stages \[s\].
    pub fn back_through<S>(&mut self, step: &StepRecord<S>) -> Vec<StageWeight> {
        let scheme = self.table.scheme(step.scheme);
        let Combination { carried, stages } = &scheme.quadrature;
        let own = self.latest.pop_front().unwrap_or(0.0);
        self.latest.resize(self.latest.len().max(carried.len()), 0.0);
        self.latest.iter_mut().zip(carried).for_each(|(earlier, factor)| *earlier += own * factor);
        let over = |weight: &f64| own * (step.h * weight);
        let pairs = stages.iter().zip(&scheme.aggregate_weights);
        pairs.map(|(integral, aggregate)| StageWeight { integral: over(integral), aggregate: over(aggregate) }).collect()
    }
}
