//! Runs that end early and are resumed.

use super::{Checkpoint, Counters, StepErrors};

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
