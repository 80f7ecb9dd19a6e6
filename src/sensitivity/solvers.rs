//! The solvers of one step's systems: what needs no adjoint can be done ahead, for many systems at once.

use super::transposed::TransposedSolver;
use crate::assembly::System;
use crate::integrators::{Counters, Method, RunError, SolveRecord, StepRecord};
use rayon::prelude::*;
use std::sync::Arc;

/// Solvers of the systems of one step.
///
/// Where other threads factor ahead, small stages have one each; on one thread they share one, whose memory stays in the caches. Numbers are
/// the same: they use no factors of each other, and what was learned of trials goes from step to step. Large stages, whose factorizations
/// employ all threads themselves and take most of the memory, share one, also with what has the same pattern beside them; so do the tiny
/// ones, and those of a linear system, whose matrix is factored once.
pub(super) struct StepSolvers<'m> {
    pub are_apart: bool,
    /// Of projections and accelerations, where they do not share that of the stages: both projections of a step mostly have the same matrix.
    plain: Option<TransposedSolver<'m>>,
    stages: Vec<TransposedSolver<'m>>,
    /// Whether a system takes so long, or threads are so many, that they share those of a step; shorter ones stay with one thread, whose
    /// caches have their numbers.
    pub are_shared: bool,
    /// Whether the first step has told which matrices need care to be scaled.
    has_care: bool,
}

/// Multiplications of a factorization from which on the systems of a step are shared: about a tenth of a millisecond.
const SHARED: f64 = 2.5e5;

impl<'m> StepSolvers<'m> {
    pub fn new(system: &Arc<System<'m>>, method: &Method, active: &'m [bool]) -> Result<Self, RunError> {
        let stage = TransposedSolver::new(system.clone(), method, active)?;
        let are_apart = !stage.is_alone && rayon::current_num_threads() > 1;
        let are_shared = rayon::current_num_threads() > 2 || stage.multiplications() > SHARED;
        let plain = if stage.is_large() { None } else { Some(stage.clone_analysis()?) };
        let mut solvers = StepSolvers { stages: vec![stage], plain, are_apart, are_shared, has_care: false };
        if are_apart {
            let starter = method.table.starter.as_ref().map_or(0, |starter| starter.table.stages.len());
            for _ in 1..method.table.stages.len().max(starter) {
                solvers.stages.push(solvers.stages[0].clone_analysis()?);
            }
        }
        Ok(solvers)
    }

    pub fn clone_analysis(&self) -> Result<Self, RunError> {
        let stages = self.stages.iter().map(TransposedSolver::clone_analysis).collect::<Result<Vec<_>, _>>()?;
        let plain = self.plain.as_ref().map(TransposedSolver::clone_analysis).transpose()?;
        Ok(StepSolvers { stages, plain, are_apart: self.are_apart, are_shared: self.are_shared, has_care: false })
    }

    /// Takes over from the solvers of the step before what they have learned.
    pub fn learn_from(&mut self, others: &Self) {
        let solvers = self.stages.iter_mut().chain(&mut self.plain);
        solvers.zip(others.stages.iter().chain(&others.plain)).for_each(|(own, other)| own.trials = other.trials);
    }

    /// After the first step: matrices of stages are scaled with the care that the one solved last needed, the first stage's, whichever solver
    /// had it, and those of projections likewise.
    pub fn settle_care(&mut self, ahead: Option<&mut Self>) {
        if self.has_care {
            return;
        }
        let of_stages = self.stages.iter().find_map(TransposedSolver::has_needed_care);
        let of_plain = self.plain.as_ref().and_then(TransposedSolver::has_needed_care);
        if of_stages.or(of_plain).is_none() {
            return;
        }
        for solvers in ahead.into_iter().chain([self]) {
            solvers.has_care = true;
            solvers.stages.iter_mut().for_each(|solver| solver.refined_scaling = of_stages.unwrap_or(false));
            solvers.plain.iter_mut().for_each(|solver| solver.refined_scaling = of_plain.unwrap_or(false));
        }
    }

    pub fn stage(&mut self, stage: usize) -> &mut TransposedSolver<'m> {
        &mut self.stages[if self.are_apart { stage } else { 0 }]
    }

    pub fn plain(&mut self) -> &mut TransposedSolver<'m> {
        match &mut self.plain {
            Some(plain) => plain,
            None => &mut self.stages[0],
        }
    }

    /// Factors the systems of a step whose adjoints were needed in the last one that these solvers served.
    pub fn factor(&mut self, step: &StepRecord<f64>, p: &[f64]) {
        let stages = step.stages.iter().map(|stage| stage.known.is_none().then_some(&stage.solve));
        // the one that comes first on the way back
        let projection = step.velocity_projection.as_ref().or(step.position_projection.as_ref());
        let all = self.stages.iter_mut().zip(stages).chain(self.plain.iter_mut().map(|solver| (solver, projection)));
        let needed: Vec<(&mut TransposedSolver<'m>, &SolveRecord<f64>)> =
            all.filter(|(solver, _)| solver.needed).filter_map(|(solver, record)| Some((solver, record?))).collect();
        if self.are_shared {
            needed.into_par_iter().for_each(|(solver, record)| solver.factor(record, p));
        } else {
            needed.into_iter().for_each(|(solver, record)| solver.factor(record, p));
        }
    }

    /// Gives the memory of the stages back, behind the first step, unless the accelerations of the start need it.
    pub fn end_steps(&mut self, counters: &mut Counters) {
        self.forget(counters);
        if self.plain.is_some() {
            self.stages.clear();
        }
    }

    /// Forgets what was factored ahead and not asked for, and counts the work done so far.
    pub fn forget(&mut self, counters: &mut Counters) {
        self.stages.iter_mut().chain(&mut self.plain).for_each(|solver| solver.forget(counters));
    }
}
