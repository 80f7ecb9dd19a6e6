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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// In coordinates and in velocities \[m, m/s\].
    pub worst: [Option<StepError>; 2],
    /// Largest coordinate and velocity \[m, m/s\].
    pub sizes: [f64; 2],
}

/// How well the steps so far resolve the motion.
#[derive(Debug)]
pub(super) struct Resolution<S> {
    pub errors: StepErrors,
    difference: Vec<S>,
}

impl<S> Default for Resolution<S> {
    fn default() -> Self {
        Resolution { errors: StepErrors::default(), difference: Vec::new() }
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
                let StepErrors { worst, sizes } = &mut self.errors;
                sizes[place] = sizes[place].max(scaled(states, i));
                let share = scaled(&self.difference, i);
                if worst[place].is_none_or(|worst| share > worst.share) {
                    worst[place] = Some(StepError { share, step: number, t: step.t, dof: i, in_velocity: order == 1 });
                }
            }
        }
        self.errors.sizes[0] = self.errors.sizes[0].max(length);
    }

    /// The larger one of both.
    pub fn worst(&self) -> Option<StepError> {
        let shares = self.errors.worst.iter().zip(self.errors.sizes).filter_map(|(worst, size)| {
            worst.filter(|_| size > 0.0).map(|worst| StepError { share: worst.share / size, ..worst })
        });
        shares.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
