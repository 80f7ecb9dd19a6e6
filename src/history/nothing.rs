use super::{History, Rerun, Usage};
use crate::integrators::{Recorder, RunError, StartRecord, StepRecord, Steps};

/// Counts steps and keeps none.
#[derive(Clone, Debug, Default)]
pub struct Nothing {
    steps: usize,
}

impl Recorder<f64> for Nothing {
    fn start(&mut self, _start: StartRecord<f64>) -> Result<(), RunError> {
        Ok(())
    }
    fn step(&mut self, _step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.steps += 1;
        Ok(true)
    }
}

fn not_kept<T>() -> Result<T, RunError> {
    Err(RunError::Input(
        "the run kept no history, and a gradient needs one: keep it in memory, in a file or as checkpoints".into(),
    ))
}

impl History for Nothing {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        None
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn forward<'h>(&'h self, _rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        not_kept()
    }
    fn backward<'h>(&'h self, _rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        not_kept()
    }
    fn usage(&self) -> Usage {
        Usage::default()
    }
}
