//! The largest accelerations, velocities and coordinates of a run so far, and the largest derivative parts of each.

use super::Newton;
use crate::assembly::{Equations, Level, VectorsAvq};
use crate::elements::RunScalar;
use crate::integrators::lists::largest_scaled;

/// Sizes of what has moved: where a motion comes to rest, and where derivatives fade, what is left has no size of its own.
///
/// The first entry is that of values, behind it those of derivative parts: accelerations, velocities, coordinates, each scaled.
#[derive(Clone, Debug, Default)]
pub(in crate::integrators) struct RunSizes(Vec<[f64; 3]>);

impl RunSizes {
    /// Takes note of what another solver of the same run has seen.
    pub fn join(&mut self, other: &RunSizes) {
        self.0.resize(self.0.len().max(other.0.len()), [0.0; 3]);
        for (own, other) in self.0.iter_mut().flatten().zip(other.0.iter().flatten()) {
            *own = own.max(*other);
        }
    }

    fn note<S: RunScalar>(&mut self, VectorsAvq { a, v, q }: &VectorsAvq<S>, scales: &[f64]) {
        self.0.resize(1 + S::PARTS, [0.0; 3]);
        for (place, sizes) in self.0.iter_mut().enumerate() {
            let read = |x: S| if place == 0 { x.value() } else { x.part(place - 1) };
            for (size, list) in sizes.iter_mut().zip([a, v, q]) {
                *size = size.max(largest_scaled(list, scales, |x, scale| read(x).abs() * scale));
            }
        }
    }
}

impl<S: RunScalar> Newton<'_, S> {
    /// Takes note of the point at which the residual was evaluated last.
    pub(super) fn note_sizes(&mut self) {
        self.run_sizes.note(&self.residual.at, &self.coordinate_scales);
    }

    /// Whether a correction of derivative part `part` changes neither accelerations nor velocities nor coordinates by more than a rounding of
    /// the largest derivatives of the run.
    pub(super) fn is_no_part(&self, part: usize, equations: &Equations, step: f64) -> bool {
        let Some(sizes) = self.run_sizes.0.get(1 + part) else { return false };
        let coefficients = equations.residual;
        let moved = [coefficients.gamma, coefficients.beta, coefficients.alpha].map(|factor| factor.abs() * step);
        moved.iter().zip(sizes).all(|(moved, size)| *moved <= f64::EPSILON * size)
    }

    /// Whether a correction of values is as small against those of the run so far as a solution of the same problem has it.
    pub(super) fn is_near_in_run(&self, equations: &Equations, correction: f64) -> bool {
        let Some(&[a, v, q]) = self.run_sizes.0.first() else { return false };
        let (factor, size) = match equations.level {
            Level::Position if equations.metric => (equations.constraint.alpha, q),
            Level::Velocity if equations.metric => (equations.constraint.beta, v),
            _ => (1.0, a),
        };
        factor.abs() * correction <= crate::tolerances::NO_ROUND_OFF * size
    }
}
