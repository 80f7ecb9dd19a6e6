//! States kept for the way back and for output.

use crate::integrators::{Guide, Recorder, StartRecord, StepRecord};
use crate::scalar::Scalar;

/// A run in memory: everything for a gradient.
#[derive(Clone, Debug)]
pub struct History<S> {
    /// What happened before the first step.
    pub start: Option<StartRecord<S>>,
    /// All steps.
    pub steps: Vec<StepRecord<S>>,
}

impl<S> Default for History<S> {
    fn default() -> Self {
        History { start: None, steps: Vec::new() }
    }
}

impl History<f64> {
    /// The run as a guide for runs with derivative parts; `None` if it has no start.
    pub fn guide(&self) -> Option<Guide<'_>> {
        self.start.as_ref().map(|start| Guide { start, steps: &self.steps })
    }
}

impl<S: Scalar> Recorder<S> for History<S> {
    fn start(&mut self, start: StartRecord<S>) {
        self.start = Some(start);
    }
    fn step(&mut self, step: StepRecord<S>) -> bool {
        self.steps.push(step);
        true
    }
}

/// Hands every finished step to a function and keeps nothing; the function returns `false` to stop.
pub struct Watch<F>(pub F);

impl<S: Scalar, F: FnMut(&StepRecord<S>) -> bool> Recorder<S> for Watch<F> {
    fn start(&mut self, _start: StartRecord<S>) {}
    fn step(&mut self, step: StepRecord<S>) -> bool {
        self.0(&step)
    }
}
