use super::{Direction, History, Rerun, Usage};
use crate::integrators::{Observer, RunError, StartRecord, StepRecord, Steps};

#[derive(Debug, Default)]
pub struct Nothing {
    steps: usize,
}

impl Observer for Nothing {
    fn step(&mut self, _step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.steps += 1;
        Ok(true)
    }
}

impl History for Nothing {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        None
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn read<'h>(&'h self, _rerun: &'h Rerun<'_>, _direction: Direction) -> Result<Box<dyn Steps + 'h>, RunError> {
        Err(RunError::Input(
            "the run kept no history, and a gradient needs one: keep it in memory, in a file or as checkpoints".into(),
        ))
    }
    fn usage(&self) -> Usage {
        Usage::default()
    }
}
