//! Steps that are given, divided where Newton's method cannot make them if that is asked for.

use super::march::{Method, Problem, Run};
use super::record::{Observer, StartRecord, Steps};
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::time_loop::{RunStart, StepSelection, TrialOutcome, TrialStep, time_loop};
use super::{Checkpoint, Clocks, RunError, StartPlan, StepSizeState, TimeGrid};
use crate::elements::RunScalar;

/// How often a step is halved before the run is given up.
const MOST_HALVINGS: usize = 8;

/// Runs a problem over a grid and hands every step to the recorder.
pub fn march<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    grid: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    march_along(problem, method, (grid, &Vec::new()), plan, None, recorder)
}

/// As [`march`], with the values of a finished real run of the same problem where its start and steps are given as a guide: only derivative
/// parts are solved for, so that they belong to exactly the states of that run. Clocks have the derivative parts of the ends of steps.
pub fn march_along<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    (grid, clocks): (&TimeGrid, &Clocks<S>),
    plan: &StartPlan,
    guide: Option<(&StartRecord<f64>, &mut dyn Steps)>,
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    let (guided, steps) = guide.unzip();
    let mut taken = TimeGrid::begin(grid.times[0], grid.asked);
    taken.times.reserve_exact(grid.steps());
    let interval = RunInterval::new(grid, &mut taken, StepSizeState::default());
    let start = RunStart { plan, clocks: Some(clocks), guided };
    time_loop(problem, method, start, (Given { steps, halvings: 0 }, interval), recorder)
}

/// Runs a problem over a grid, each step of which is halved, and its halves again, where Newton's method finds no solution: a snap
/// that is faster than the step leaves none near by.
///
/// Returns the steps taken and what `march` returns; the run counts the attempts that were given up. A run over the steps
/// taken gives the same numbers bit by bit.
pub fn march_dividing(
    problem: &Problem<f64>,
    method: &Method,
    steps: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Observer<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    march_given(problem, method, (steps, MOST_HALVINGS), plan, recorder)
}

/// The same with so many halvings.
pub(crate) fn march_given(
    problem: &Problem<f64>,
    method: &Method,
    (steps, halvings): (&TimeGrid, usize),
    plan: &StartPlan,
    recorder: &mut dyn Observer<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    let mut grid = TimeGrid::begin(steps.times[0], steps.asked);
    grid.times.reserve(steps.times.len());
    let interval = RunInterval::new(steps, &mut grid, WHOLE);
    let selection = Given { steps: None, halvings };
    let run = time_loop(problem, method, RunStart { plan, clocks: None, guided: None }, (selection, interval), recorder);
    (grid, run)
}

/// A given step is one part of itself until it is halved.
const WHOLE: StepSizeState = StepSizeState { h: f64::INFINITY, last_error: 0.0, rejected: 0, halvings: 0, left: 1 };

/// Each stretch of the interval is a step.
struct Given<'g> {
    steps: Option<&'g mut dyn Steps>,
    halvings: usize,
}

impl<S: RunScalar> StepSelection<S> for Given<'_> {
    fn goes_back(&self) -> bool {
        self.halvings > 0
    }

    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<S>) -> Result<TrialStep<'_>, RunError> {
        let guided = match &mut self.steps {
            Some(steps) => steps.next()?,
            None => None,
        };
        let h = if self.halvings > 0 { interval.step_size.h } else { f64::INFINITY }.min(interval.laid);
        Ok(TrialStep { h, scheme: interval.scheme(&stepper.method.table, h), guided })
    }

    fn accepts(
        &mut self,
        TrialOutcome { span, reached, made }: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<S>,
        _before: &Checkpoint<S>,
    ) -> Result<bool, RunError> {
        if self.steps.is_some() {
            return made.map(|()| true);
        }
        let StepSizeState { rejected, halvings, left, .. } = interval.step_size;
        let stability = if made.is_ok() { stepper.stability() } else { None };
        let is_divided = halvings < self.halvings
            && match &made {
                // a shorter step tells a path that loses its stability from a leap onto another one
                Ok(()) => stepper.loses(stability),
                Err(error) => error.is_of_step(),
            };
        if is_divided {
            let h = 0.5 * (reached - span.0);
            interval.step_size =
                StepSizeState { h, rejected: rejected + 1, halvings: halvings + 1, left: 2 * left, ..WHOLE };
            return Ok(false);
        }
        made?;
        stepper.note_error();
        stepper.note_stability(stability);
        if left > 1 {
            interval.step_size.left -= 1;
        } else if self.halvings > 0 {
            interval.step_size = StepSizeState { rejected, ..WHOLE };
        }
        Ok(true)
    }
}
