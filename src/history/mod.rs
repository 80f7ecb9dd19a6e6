//! Steps of a run kept for the way back: not at all, in memory, in a file, or as checkpoints from which they are computed again.
//!
//! A [`History`] records a real run and hands its steps out again, first to last (guides of runs with derivative parts) or last to
//! first (the adjoint). The steps are the same bit by bit, wherever they were kept.

pub(crate) mod checkpoints;
mod dense;
pub(crate) mod file;
mod first_rank;
mod flat;
mod frames;
mod free_memory;
pub(crate) mod nothing;
mod packed;
pub(crate) mod rerun;
pub(crate) mod schedule;
mod sliced;

pub(crate) use checkpoints::Checkpoints;
pub use dense::Snapshot;
#[doc(hidden)]
pub use dense::{Dense, moments};
pub(crate) use file::FileHistory;
use first_rank::FirstRankHistory;
#[doc(hidden)]
pub use frames::check_place;
pub(crate) use nothing::Nothing;
pub(crate) use rerun::Rerun;

use crate::exchange;
pub use crate::integrators::record::Observer;
use crate::integrators::{RunError, StartRecord, StepRecord, Steps};
use crate::scalar::Scalar;
use std::fmt;
use std::path::PathBuf;

/// How a run keeps its steps.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Keep {
    /// Not at all: values of functionals, no gradients.
    Nothing,
    /// As [`Keep::Within`] a third of the memory that is free when the run begins; in memory where the system does not tell how much.
    #[default]
    Auto,
    /// In memory up to so many bytes. A run that would take more keeps checkpoints there, if the number of its steps is known before; one
    /// whose steps are chosen or divided ends with an error that says so.
    Within(usize),
    /// In memory, whatever it takes.
    Memory,
    /// In a file, which stays.
    File(PathBuf),
    /// In a file in which the run goes on where it stopped before, if it did; one that reached its end is not simulated again.
    Resumed(PathBuf),
    /// As checkpoints in this many bytes; what lies between them is computed again.
    Checkpoints(usize),
}

/// Share of the free memory that steps may take: their lists take more than their numbers, and the way back some too.
const SHARE: f64 = 1.0 / 3.0;

impl Keep {
    /// As [`Keep::Auto`] for each of several runs at once.
    pub fn shared_by(runs: usize) -> Self {
        // ranks may share the memory of a machine; what one of them computes again, all have to
        let runs = runs * exchange::processes();
        let free = exchange::of_first(free_memory::free_memory().map_or(f64::NAN, |free| free as f64));
        if free.is_nan() { Keep::Memory } else { Keep::Within((SHARE * free / runs as f64) as usize) }
    }

    /// A history for a run of `steps` steps, if their number is known and none will be divided. `run` is a number that tells what is
    /// simulated, and how.
    pub(crate) fn history(&self, steps: Option<usize>, run: u64) -> Result<Box<dyn History>, RunError> {
        Ok(match self {
            Keep::Nothing => Box::new(Nothing::default()),
            Keep::Auto => return Keep::shared_by(1).history(steps, run),
            Keep::Within(bytes) if steps.is_none() => Box::new(Checkpoints::of_all_steps(*bytes)),
            Keep::Within(bytes) | Keep::Checkpoints(bytes) => Box::new(Checkpoints::new(*bytes, steps)),
            Keep::Memory => return Keep::Within(usize::MAX).history(steps, run),
            Keep::File(path) => return in_file(|| FileHistory::create(path, run)),
            Keep::Resumed(path) => return in_file(|| FileHistory::resume(path, run)),
        })
    }
}

/// A file, which the first of several ranks has for all.
fn in_file(file: impl FnOnce() -> Result<FileHistory, RunError>) -> Result<Box<dyn History>, RunError> {
    let world = exchange::world();
    Ok(if world.ranks() == 1 { Box::new(file()?) } else { Box::new(FirstRankHistory::new(world, file)?) })
}

/// What a history took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Most steps kept in memory at once.
    pub steps: usize,
    /// Most checkpoints kept at once.
    pub checkpoints: usize,
    /// Most bytes of steps and checkpoints in memory at once.
    pub bytes: usize,
    /// Bytes written to a file.
    pub written: u64,
    /// Steps computed again so far.
    pub recomputed: usize,
    /// Steps that an earlier run left in the file.
    pub taken_over: usize,
}

/// In which order steps are handed out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the first to the last.
    Forward,
    /// From the last to the first.
    Backward,
}

impl Direction {
    fn next_of<I: DoubleEndedIterator>(self, items: &mut I) -> Option<I::Item> {
        match self {
            Direction::Forward => items.next(),
            Direction::Backward => items.next_back(),
        }
    }
}

/// A kept run: records steps, and hands them out again.
pub trait History: Observer + fmt::Debug + Send + Sync {
    /// What happened before the first step; `None` before a run.
    fn start_record(&self) -> Option<&StartRecord<f64>>;
    /// Number of finished steps.
    fn steps(&self) -> usize;
    /// All steps.
    ///
    /// # Errors
    /// Steps that were not kept, or cannot be found again.
    fn read<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Result<Box<dyn Steps + 'h>, RunError>;
    /// What it took so far.
    fn usage(&self) -> Usage;
}

/// Hands every finished step to a function and keeps nothing; the function returns `false` to stop.
pub struct Watch<F>(pub F);

impl<S: Scalar, F: FnMut(&StepRecord<S>) -> bool> Observer<S> for Watch<F> {
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        Ok(self.0(step))
    }
}
