//! How well equal steps resolve a motion.

use super::march::{add_scaled, combine};
use super::record::StepRecord;
use super::{Embedded, Table};
use crate::elements::RunScalar;

/// The largest error of one step that an embedded solution estimates, in coordinates by the model's length, in velocities by the largest
/// velocity of the run; angular ones count by the model's length, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// Of the length or velocity.
    pub share: f64,
    /// Number of the step, from 1 on.
    pub step: usize,
    /// Start of the step \[s\].
    pub t: f64,
    /// Coordinate of the model.
    pub dof: usize,
    /// Whether it is the velocity of that coordinate.
    pub in_velocity: bool,
}

/// The largest errors of the steps so far.
#[derive(Debug)]
pub(super) struct Resolution<S> {
    /// In coordinates and in velocities \[m, m/s\].
    worst: [Option<StepError>; 2],
    /// Largest coordinate and velocity \[m, m/s\].
    sizes: [f64; 2],
    difference: Vec<S>,
}

impl<S> Default for Resolution<S> {
    fn default() -> Self {
        Resolution { worst: [None; 2], sizes: [0.0; 2], difference: Vec::new() }
    }
}

impl<S: RunScalar> Resolution<S> {
    /// Takes note of a step: its number, the carried vectors before it, and the scales of coordinates.
    pub fn note(
        &mut self,
        table: &Table,
        number: usize,
        step: &StepRecord<S>,
        carried: &[Vec<S>],
        (scales, length): (&[f64], f64),
    ) {
        let Some(Embedded { q, v, rates, .. }) = &table.embedded else { return };
        for (order, weights, states) in [(0, q, &step.q), (1, v, &step.v)] {
            combine(table, order, weights, step.h, carried, &step.stages, &mut self.difference);
            if order == 0 {
                for (stage, weight) in step.stages.iter().zip(rates) {
                    add_scaled(&mut self.difference, &stage.rate, step.h * weight);
                }
            }
            let place = order as usize;
            let scaled = |values: &[S], i: usize| values[i].value().abs() * scales[i];
            for i in 0..states.len() {
                self.sizes[place] = self.sizes[place].max(scaled(states, i));
                let share = scaled(&self.difference, i);
                if self.worst[place].is_none_or(|worst| share > worst.share) {
                    self.worst[place] = Some(StepError { share, step: number, t: step.t, dof: i, in_velocity: order == 1 });
                }
            }
        }
        self.sizes[0] = self.sizes[0].max(length);
    }

    /// The larger one of both.
    pub fn worst(&self) -> Option<StepError> {
        let shares = self.worst.iter().zip(self.sizes).filter_map(|(worst, size)| {
            worst.filter(|_| size > 0.0).map(|worst| StepError { share: worst.share / size, ..worst })
        });
        shares.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
