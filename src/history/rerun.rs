use crate::assembly::System;
use crate::integrators::{Method, Problem, RunError, StartPlan, StepRule, Stepper, TimeGrid};
use std::sync::{Arc, OnceLock};

/// The run that a history belongs to: what it takes to compute some of it again.
pub struct Rerun<'r> {
    pub problem: &'r Problem<'r, f64>,
    pub method: &'r Method,
    pub grid: &'r TimeGrid,
    pub plan: &'r StartPlan,
    system: OnceLock<Arc<System<'r>>>,
}

impl<'r> Rerun<'r> {
    pub fn new(problem: &'r Problem<'r, f64>, method: &'r Method, grid: &'r TimeGrid, plan: &'r StartPlan) -> Self {
        Rerun { problem, method, grid, plan, system: OnceLock::new() }
    }

    pub fn system(&self) -> &Arc<System<'r>> {
        self.system.get_or_init(|| self.method.system(self.problem.model, &self.plan.dropped))
    }

    pub fn rule(&self) -> StepRule<'_> {
        StepRule { method: self.method, constrained: self.system().is_constrained() }
    }

    pub fn stepper(&self) -> Result<Stepper<'_, f64>, RunError> {
        Stepper::new(self.problem, self.method, self.system(), self.plan)
    }
}
