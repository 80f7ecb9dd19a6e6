//! Steps that are given.

use super::march::{Method, Problem, Run};
use super::record::{Guide, Observer, Steps};
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::time_loop::{RunStart, StepSelection, TrialOutcome, TrialStep, time_loop};
use super::{Checkpoint, Clocks, RunError, StartPlan, StepSizeState, TimeGrid};
use crate::elements::RunScalar;

/// Runs a problem over a grid and hands every step to the recorder.
///
/// # Errors
/// [`RunError`] with step and time; steps before it have reached the recorder.
pub fn march<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    grid: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    march_along(problem, method, (grid, &Vec::new()), plan, None, recorder)
}

/// As [`march`], with the values of a finished real run of the same problem where a guide is given: only derivative parts are
/// solved for, so that they belong to exactly the states of that run. Clocks have the derivative parts of the ends of steps.
///
/// # Errors
/// As for [`march`]; also a guide that does not solve the problem.
pub fn march_along<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    (grid, clocks): (&TimeGrid, &Clocks<S>),
    plan: &StartPlan,
    guide: Option<Guide>,
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    let (guided, steps) = guide.map_or((None, None), |guide| (Some(guide.start), Some(guide.steps)));
    let mut taken = TimeGrid::begin(grid.times[0], grid.asked);
    taken.times.reserve_exact(grid.steps());
    let interval = RunInterval::new(grid, &mut taken, StepSizeState::default());
    time_loop(problem, method, RunStart { plan, clocks: Some(clocks), guided }, (Given { steps }, interval), recorder)
}

/// Each stretch of the interval is a step.
struct Given<'g> {
    /// Those of a finished real run.
    steps: Option<&'g mut dyn Steps>,
}

impl<S: RunScalar> StepSelection<S> for Given<'_> {
    const GOES_BACK: bool = false;

    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<S>) -> Result<TrialStep<'_>, RunError> {
        let guided = match &mut self.steps {
            Some(steps) => steps.next()?,
            None => None,
        };
        let h = f64::INFINITY;
        Ok(TrialStep { h, scheme: interval.scheme(&stepper.method.table, h), guided })
    }

    fn accepts(
        &mut self,
        trial: TrialOutcome,
        _interval: &mut RunInterval,
        stepper: &mut Stepper<S>,
        _before: &Checkpoint<S>,
    ) -> Result<bool, RunError> {
        trial.made?;
        if self.steps.is_none() {
            stepper.note_error();
            let stability = stepper.stability();
            stepper.note_stability(stability);
        }
        Ok(true)
    }
}
