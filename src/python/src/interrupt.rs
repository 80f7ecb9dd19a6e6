//! Ctrl-C in the middle of a run.

use costate::history::Observer;
use costate::integrators::{RunError, StepRecord};
use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// How long a run goes on before it looks for Ctrl-C again.
const BETWEEN: Duration = Duration::from_millis(50);

/// Stops a run after the step in which Python got a signal.
pub struct Signals {
    last: Instant,
    /// What Python makes of it.
    pub caught: Option<PyErr>,
}

impl Signals {
    /// From now on.
    pub fn new() -> Self {
        Signals { last: Instant::now(), caught: None }
    }
}

impl Observer for Signals {
    fn step(&mut self, _step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.last.elapsed() < BETWEEN {
            return Ok(true);
        }
        self.last = Instant::now();
        self.caught = Python::attach(|py| py.check_signals()).err();
        Ok(self.caught.is_none())
    }
}
