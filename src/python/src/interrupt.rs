//! What Python has to say, and is told, in the middle of a run.

use costate::history::Observer;
use costate::integrators::{RunError, StepRecord};
use costate::optimize::{DesignHistory, Watcher};
use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// How long a run goes on before it looks for Ctrl-C again, and says how far it is.
const BETWEEN: Duration = Duration::from_millis(50);

/// Stops a run after the step in which Python got a signal, and tells a function of Python the time that is reached.
pub struct Signals {
    last: Instant,
    progress: Option<Py<PyAny>>,
    /// What Python makes of it.
    pub caught: Option<PyErr>,
}

impl Signals {
    /// From now on.
    pub fn new(progress: Option<Py<PyAny>>) -> Self {
        Signals { last: Instant::now(), progress, caught: None }
    }
}

impl Observer for Signals {
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.last.elapsed() < BETWEEN {
            return Ok(true);
        }
        self.last = Instant::now();
        let told = Python::attach(|py| {
            py.check_signals()?;
            self.progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (step.t + step.h,)).map(drop))
        });
        self.caught = told.err();
        Ok(self.caught.is_none())
    }
}

impl Watcher for Signals {
    /// A design was simulated.
    fn changed(&mut self, _: &DesignHistory) -> bool {
        self.caught = Python::attach(|py| py.check_signals()).err();
        self.caught.is_none()
    }
}
