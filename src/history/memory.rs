use super::flat::Put;
use super::packed::PackedSteps;
use super::sliced::most_kept;
use super::{History, Rerun, Usage};
use crate::design::shortest;
use crate::integrators::{Recorder, RunError, StartRecord, StepRecord, Steps, Stop};

/// A run of any number of steps in memory, which ends with an error where it would take more than it may.
#[derive(Debug)]
pub struct Memory {
    /// What happened before the first step.
    start: Option<StartRecord<f64>>,
    /// All steps.
    steps: PackedSteps,
    /// Most bytes of all steps.
    most: usize,
    /// Most bytes of one step that this rank keeps; known after the first.
    step_bytes: usize,
}

impl Memory {
    /// Steps of at most so many bytes.
    pub fn new(most: usize) -> Self {
        Memory { start: None, steps: PackedSteps::default(), most, step_bytes: 0 }
    }
}

impl Recorder<f64> for Memory {
    fn start(&mut self, start: StartRecord<f64>) -> Result<(), RunError> {
        self.start = Some(start);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.steps.len() == 0 {
            self.step_bytes = most_kept(step.bytes().len());
        }
        let steps = self.steps.len() + 1;
        if steps.saturating_mul(self.step_bytes) > self.most {
            return Err(RunError::stopped(
                Stop::History,
                format!("step {steps} (t = {} s), memory", shortest(step.t)),
                format!("{steps} steps of {} bytes take more than the {} bytes allowed", self.step_bytes, self.most),
                "keep the run in a file, or as checkpoints",
            ));
        }
        self.steps.push(step);
        Ok(true)
    }
}

impl History for Memory {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        self.start.as_ref()
    }
    fn steps(&self) -> usize {
        self.steps.len()
    }
    fn forward<'h>(&'h self, rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(self.steps.forward(rerun))
    }
    fn backward<'h>(&'h self, rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(self.steps.backward(rerun))
    }
    fn usage(&self) -> Usage {
        Usage { steps: self.steps.len(), bytes: self.steps.bytes(), ..Usage::default() }
    }
}
