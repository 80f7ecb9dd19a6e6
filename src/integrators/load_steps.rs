//! Load steps as long as Newton's method finds the next equilibrium.

use super::run_interval::RunInterval;
use super::step::Stepper;
use super::time_loop::{StepSelection, TrialOutcome, TrialStep};
use super::{Checkpoint, RunError, Scheme, StepControl, StepSizeState};

const FIRST: f64 = 0.1;
/// Steps below this share of the load, and arcs below this share of the first one, find no equilibrium any more.
pub(super) const SHORTEST: f64 = 1e-6;
/// Steps below this share of the load are taken where their end is unstable, too: it is the path that loses its stability.
const SHORT: f64 = 1e-3;
/// Newton iterations up to which the next step may be longer.
const QUICK: usize = 8;
/// By how much a step grows after quick convergence; a failed one is divided by it.
const GROWTH: f64 = 2.0;

pub(super) fn first_step_size(duration: f64) -> StepSizeState {
    StepSizeState { h: FIRST * duration, ..StepSizeState::default() }
}

/// Steps are halved where Newton's method fails and doubled where it converges quickly; of the control only the longest step counts.
pub(super) struct Loading<'c> {
    control: &'c StepControl,
    failed: bool,
    iterations: usize,
}

impl<'c> Loading<'c> {
    pub fn new(control: &'c StepControl) -> Self {
        Loading { control, failed: false, iterations: 0 }
    }
}

impl StepSelection<f64> for Loading<'_> {
    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<f64>) -> Result<TrialStep<'_>, RunError> {
        interval.step_size.h = interval.step_size.h.min(self.control.longest);
        self.iterations = stepper.counters().iterations;
        Ok(TrialStep { h: interval.step_size.h, scheme: Scheme::Main, guided: None })
    }

    fn accepts(
        &mut self,
        TrialOutcome { span, reached, made }: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<f64>,
        _before: &Checkpoint<f64>,
    ) -> Result<bool, RunError> {
        let h = reached - span.0;
        if made.is_ok() {
            let stability = stepper.stability();
            if h < SHORT * interval.duration() || !stepper.loses(stability) {
                stepper.note_stability(stability);
                if !self.failed && stepper.counters().iterations - self.iterations <= QUICK {
                    interval.step_size.h *= GROWTH;
                }
                self.failed = false;
                return Ok(true);
            }
        }
        self.failed = true;
        interval.step_size.rejected += 1;
        interval.step_size.h = h / GROWTH;
        match made {
            Err(cause) if !cause.is_of_step() => Err(cause),
            Err(cause) if interval.step_size.h < SHORTEST * interval.duration() => Err(limit(cause, interval)),
            _ => Ok(false),
        }
    }
}

/// Why the path ends; the very first equilibrium fails for reasons of its own.
fn limit(cause: RunError, interval: &RunInterval) -> RunError {
    if interval.grid.steps() == 0 {
        return cause;
    }
    let hint = "the load may have reached its limit; follow the path by its arc length, or simulate the motion";
    RunError::NoEquilibrium { t: interval.t(), h: interval.step_size.h, hint, cause: cause.to_string() }
}
