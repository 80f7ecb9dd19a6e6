//! Runs that end early and are resumed.

use super::record::Observer;
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::{Checkpoint, Counters, RunError, StepErrors};
use crate::elements::RunScalar;

/// What the selection of the next step size knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSizeState {
    /// Size of the next step, where it is chosen \[s\].
    pub h: f64,
    /// Error of the last step, as a share of the allowed one.
    pub last_error: f64,
    /// Steps that were tried and given up for shorter ones.
    pub rejected: usize,
    /// How often the given step was halved.
    pub halvings: usize,
    /// Parts of the given step that are left.
    pub left: usize,
}

/// A run between two steps: all that it takes to go on, and what it has counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Pause<S> {
    /// All that later steps depend on.
    pub checkpoint: Checkpoint<S>,
    /// End of the last step \[s\].
    pub t: f64,
    /// The next step.
    pub step_size: StepSizeState,
    /// Largest estimated errors.
    pub errors: StepErrors,
    /// Work done.
    pub counters: Counters,
}

/// A resumed run.
pub(super) struct Resumed<S> {
    pub pause: Pause<S>,
    /// Starts of the steps before \[s\].
    begins: Vec<f64>,
}

impl<S: RunScalar> Resumed<S> {
    /// Brings a run, whose start has reached the recorder, to where the recorder has its steps from; `None` if it has none.
    pub fn by(stepper: &mut Stepper<S>, recorder: &mut dyn Observer<S>) -> Result<Option<Self>, RunError> {
        let mut begins = Vec::new();
        let pause = recorder.take_up(stepper.rule(), &mut |step| {
            begins.push(step.t);
            Ok(true)
        })?;
        let Some(pause) = pause else { return Ok(None) };
        stepper.take_up(&pause)?;
        Ok(Some(Resumed { pause, begins }))
    }

    /// Lays the steps before into a interval, which goes on at their step_size.
    pub fn follow(&self, interval: &mut RunInterval) {
        let ends = self.begins.iter().skip(1).chain([&self.pause.t]);
        ends.take(self.begins.len()).for_each(|&end| interval.advance(end));
        interval.step_size = self.pause.step_size;
    }
}
