use super::{History, Rerun, Usage};
use crate::integrators::{Recorder, RunError, StartRecord, StepRecord, Steps};
use crate::scalar::Scalar;

/// A run in memory.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    /// What happened before the first step.
    pub start: Option<StartRecord<S>>,
    /// All steps.
    pub steps: Vec<StepRecord<S>>,
}

impl<S> Default for Memory<S> {
    fn default() -> Self {
        Memory { start: None, steps: Vec::new() }
    }
}

impl<S: Scalar> Recorder<S> for Memory<S> {
    fn start(&mut self, start: StartRecord<S>) -> Result<(), RunError> {
        self.start = Some(start);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        self.steps.push(step.clone());
        Ok(true)
    }
}

/// Steps that are all in memory, in some order.
pub(super) struct Listed<'h>(pub Box<dyn Iterator<Item = &'h StepRecord<f64>> + 'h>);

impl Steps for Listed<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        Ok(self.0.next())
    }
}

impl History for Memory<f64> {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        self.start.as_ref()
    }
    fn steps(&self) -> usize {
        self.steps.len()
    }
    fn forward<'h>(&'h self, _rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(Box::new(Listed(Box::new(self.steps.iter()))))
    }
    fn backward<'h>(&'h self, _rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(Box::new(Listed(Box::new(self.steps.iter().rev()))))
    }
    fn usage(&self) -> Usage {
        Usage { steps: self.steps.len(), ..Usage::default() }
    }
}
