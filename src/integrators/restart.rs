//! Runs that end early and are resumed.

use super::{Checkpoint, Counters, StepErrors};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSizeState {
    /// Size of the next step, where it is chosen \[s\].
    pub h: f64,
    /// Error of the last step, as a share of the allowed one.
    pub last_error: f64,
    /// Steps that were tried and given up for shorter ones.
    pub rejected: usize,
    pub halvings: usize,
    pub left: usize,
}

/// A run between two steps: all that it takes to go on, and what it has counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Pause<S> {
    pub checkpoint: Checkpoint<S>,
    pub t: f64,
    pub step_size: StepSizeState,
    pub errors: StepErrors,
    pub counters: Counters,
}
