//! Given steps, divided where Newton's method cannot make them.

use super::march::{Method, Problem, Run};
use super::record::Observer;
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::time_loop::{RunStart, StepSelection, TrialOutcome, TrialStep, time_loop};
use super::{Checkpoint, RunError, StartPlan, StepSizeState, TimeGrid};

/// How often a step is halved before the run is given up.
const MOST_HALVINGS: usize = 8;

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
    let mut grid = TimeGrid::begin(steps.times[0], steps.asked);
    let interval = RunInterval::new(steps, &mut grid, WHOLE);
    let run = time_loop(problem, method, RunStart::of(plan), (Dividing, interval), recorder);
    (grid, run)
}

/// A given step is one part of itself until it is halved.
const WHOLE: StepSizeState = StepSizeState { h: f64::INFINITY, last_error: 0.0, rejected: 0, halvings: 0, left: 1 };

struct Dividing;

impl StepSelection<f64> for Dividing {
    const GOES_BACK: bool = true;

    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<f64>) -> Result<TrialStep<'_>, RunError> {
        let h = interval.step_size.h;
        Ok(TrialStep { h, scheme: interval.scheme(&stepper.method.table, h), guided: None })
    }

    fn accepts(
        &mut self,
        TrialOutcome { span, reached, made }: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<f64>,
        _before: &Checkpoint<f64>,
    ) -> Result<bool, RunError> {
        let StepSizeState { rejected, halvings, left, .. } = interval.step_size;
        let stability = if made.is_ok() { stepper.stability() } else { None };
        let is_divided = halvings < MOST_HALVINGS
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
        interval.step_size.left -= 1;
        if interval.step_size.left == 0 {
            interval.step_size = StepSizeState { rejected, ..WHOLE };
        }
        Ok(true)
    }
}
