//! Runs that end before their time and are taken up again.

use super::course::Course;
use super::record::Recorder;
use super::step::Stepper;
use super::{Checkpoint, Counters, RunError, StepErrors};
use crate::elements::RunScalar;

/// How a run goes on to its next step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
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
    pub pace: Pace,
    /// Largest estimated errors.
    pub errors: StepErrors,
    /// Work done.
    pub counters: Counters,
}

/// Where a run is taken up.
pub(super) struct TakenUp<S> {
    pub pause: Pause<S>,
    /// Starts of the steps before \[s\].
    begins: Vec<f64>,
}

impl<S: RunScalar> TakenUp<S> {
    /// Brings a run, whose start has reached the recorder, to where the recorder has its steps from; `None` if it has none.
    pub fn by(stepper: &mut Stepper<S>, recorder: &mut dyn Recorder<S>) -> Result<Option<Self>, RunError> {
        let mut begins = Vec::new();
        let pause = recorder.take_up(stepper.rule(), &mut |step| {
            begins.push(step.t);
            Ok(true)
        })?;
        let Some(pause) = pause else { return Ok(None) };
        stepper.take_up(&pause)?;
        Ok(Some(TakenUp { pause, begins }))
    }

    /// Lays the steps before into a course, which goes on at their pace.
    pub fn follow(&self, course: &mut Course) {
        let ends = self.begins.iter().skip(1).chain([&self.pause.t]);
        ends.take(self.begins.len()).for_each(|&end| course.advance(end));
        course.pace = self.pause.pace;
    }
}
