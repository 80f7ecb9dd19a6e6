use super::newton::KeptFactorization;
use super::record::SolveRecord;
use super::table::SAME_SIZE;
use super::{Carried, Prediction, Scheme, SideChange};
use crate::assembly::{Unknowns, clone_fields};
use crate::elements::RunScalar;

/// What goes from one step to the next, beside the kept factorizations.
#[derive(Debug, PartialEq)]
pub struct StepState<S> {
    pub step: usize,
    /// Which table made the increments.
    pub scheme: Scheme,
    /// Redundant constraint equations that are left out.
    pub dropped: Vec<usize>,
    /// They were chosen anew after the last step: the acceleration is solved for once more.
    pub chosen_anew: bool,
    /// Sides of switches, and those that changed at the end of the last step.
    pub sides: Vec<f64>,
    pub switched: Vec<SideChange>,
    /// Those that change at the same time by themselves, in steps of their own that are no longer than a rounding.
    pub waiting: Vec<SideChange>,
    /// The table's carried vectors, q and v first.
    pub carried: Vec<Vec<S>>,
    pub last: Unknowns<S>,
    /// Multipliers of the state itself, where they tell whether something lets go; otherwise none.
    pub forces: Vec<S>,
    /// First guesses for the stages of the next step, then for its projections of coordinates and of velocities.
    pub prediction: Prediction<S>,
    /// What the systems of a step may leave in coordinates \[m\] and velocities \[m/s\], where round-off is not asked for, and the size of the
    /// step for which it holds \[s\].
    pub allowed: Option<[f64; 3]>,
}

impl<S: RunScalar> StepState<S> {
    /// The acceleration solved last, at the start or in the last stage.
    pub(super) fn acceleration(&self) -> &[S] {
        &self.last.x
    }

    /// Takes over an acceleration that was solved for: every carried acceleration starts with it.
    pub(super) fn set_acceleration(&mut self, kinds: &[Carried], solved: &SolveRecord<S>) {
        for (carried, _) in self.carried.iter_mut().zip(kinds).filter(|(_, kind)| **kind == Carried::A) {
            carried.clone_from(&solved.unknowns.x);
        }
        self.last.x.clone_from(&solved.unknowns.x);
        self.last.mu.clone_from(&solved.unknowns.mu);
        self.forces.clone_from(&solved.unknowns.mu);
        self.forget_course();
    }

    /// What comes is not foretold by the steps before. The solution of the last one stays as a first guess: where a method carries no
    /// acceleration, that of a state by itself has fast vibrations in it that its stages have not.
    pub(super) fn forget_course(&mut self) {
        self.prediction.clear(0);
        self.allowed = None;
    }

    /// Equilibria go on in proportion to the load: the displacements h^2 x of a step are expected to be to those of the last one as their
    /// sizes. Behind a breakpoint the last step says nothing.
    pub(super) fn expect_in_proportion(&mut self, t: f64, h: f64, breakpoint: bool) {
        if breakpoint {
            self.last.x.fill(S::zero());
            self.prediction.clear(0);
            return;
        }
        let before = self.prediction.tracks.first().and_then(|track| track.times.first()).map(|start| t - start);
        if let Some(before) = before.filter(|before| (before - h).abs() > SAME_SIZE * h) {
            self.last.x.iter_mut().for_each(|x| *x = *x * (before / h));
            self.prediction.clear(0);
        }
    }

    /// Stages of another table say nothing about those of this one.
    pub(super) fn prepare_guesses(&mut self, scheme: Scheme, stages: usize) {
        if self.scheme != scheme || self.prediction.tracks.len() != stages + 2 {
            self.prediction.clear(stages + 2);
            (self.scheme, self.allowed) = (scheme, None);
        }
    }
}

clone_fields!(StepState {
    step,
    scheme,
    dropped,
    chosen_anew,
    sides,
    switched,
    waiting,
    carried,
    last,
    forces,
    prediction,
    allowed
});

/// A run between two steps: all that later steps depend on.
///
/// Solutions depend in their last bits on first guesses and on the matrix that Newton's method kept, so both belong to it; of
/// a factorization only the point is stored at which it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<S> {
    pub between: StepState<S>,
    /// Of the accelerations, and of the stages with their projections.
    pub kept: [KeptFactorization<S>; 2],
}

crate::assembly::empty_fields!(Checkpoint { between, kept });
