//! How well equal steps resolve a motion.

use super::lists::largest_scaled;
use super::march::embedded_difference;
use super::record::StepRecord;
use super::{StabilityCourse, Table};
use crate::elements::RunScalar;
use crate::linalg::sign_of_determinant;

/// The largest estimated error of one step: in coordinates by the model's length, in velocities by the largest velocity of the run; angular
/// ones count by the model's length, too.
///
/// It is that of an embedded solution; where the method has none, the error in the coordinates of the trapezoidal rule, h^3/12 of the third
/// derivative from the mean accelerations of this step and the one before: about that of a method of second order, more than that of one of
/// higher order.
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

impl StepError {
    /// Share above which a motion counts as unresolved: where a chain of 100 bars cracks like a whip and loses a third of its energy in a step
    /// of 1 ms, it is 5.6e-3; a step that leaps from one branch of a mechanism to another one has far more.
    pub const COARSE: f64 = 2e-3;
}

/// The largest errors of the steps so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// In coordinates and in velocities \[m, m/s\].
    pub worst: [Option<StepError>; 2],
    /// Largest coordinate and velocity \[m, m/s\].
    pub sizes: [f64; 2],
    /// Mean acceleration in the last step, before the first one that of the start, for methods without an embedded solution \[m/s2\].
    pub acceleration: Vec<f64>,
    /// It is that of the start.
    pub fresh: bool,
    /// Sign of the determinant of the constraints' rows, of a mechanism whose motion its drives determine: 1 or -1, 0 where not known.
    pub orientation: f64,
    /// Start of the first step in which it changed, and its number.
    pub leap: Option<(f64, usize)>,
    /// Of equilibria: whether they stand.
    pub stability: Option<StabilityCourse>,
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
    /// Begins with the acceleration of the start.
    pub fn begin(&mut self, acceleration: &[S]) {
        self.errors.acceleration.clear();
        self.errors.acceleration.extend(acceleration.iter().map(|a| a.value()));
        self.errors.fresh = true;
    }

    /// Takes note of a step: its number, the carried vectors before it, and the scales of coordinates.
    pub fn note(
        &mut self,
        table: &Table,
        number: usize,
        step: &StepRecord<S>,
        carried: &[Vec<S>],
        (scales, length): (&[f64], f64),
    ) {
        if table.is_static() {
            return;
        }
        let mut difference = std::mem::take(&mut self.difference);
        match &table.embedded {
            Some(embedded) => {
                for (order, in_velocity) in [(0, false), (1, true)] {
                    embedded_difference((table, embedded), order, step, carried, &mut difference);
                    self.judge(in_velocity, number, step, &difference, scales);
                }
            }
            None => {
                difference.clear();
                if let Some(solved) = &step.restart {
                    self.begin(&solved.unknowns.x);
                }
                // the middle of the step before is a step away, the acceleration that was solved for half a step
                let factor = if self.errors.fresh { 2.0 } else { 1.0 } * step.h * step.h / 12.0;
                let velocities = step.v.iter().zip(&carried[1]);
                for ((end, start), last) in velocities.zip(&mut self.errors.acceleration) {
                    let mean = (end.value() - start.value()) / step.h;
                    difference.push(S::from((mean - *last) * factor));
                    *last = mean;
                }
                self.judge(false, number, step, &difference, scales);
                self.errors.fresh = false;
            }
        }
        self.difference = difference;
        self.errors.sizes[0] = self.errors.sizes[0].max(length);
    }

    /// Errors of coordinates or of velocities, and how large these are.
    fn judge(&mut self, in_velocity: bool, number: usize, step: &StepRecord<S>, errors: &[S], scales: &[f64]) {
        let place = usize::from(in_velocity);
        let states = if in_velocity { &step.v } else { &step.q };
        let StepErrors { worst, sizes, .. } = &mut self.errors;
        let (worst, size) = (&mut worst[place], &mut sizes[place]);
        let scaled = |x: S, scale: f64| x.value().abs() * scale;
        *size = size.max(largest_scaled(states, scales, scaled));
        let share = largest_scaled(errors, scales, scaled);
        if worst.is_none_or(|worst| share > worst.share) {
            let dof = errors.iter().zip(scales).position(|(&error, &scale)| scaled(error, scale) == share).unwrap_or(0);
            *worst = Some(StepError { share, step: number, t: step.t, dof, in_velocity });
        }
    }

    /// Takes note of the side on which a driven mechanism is after a step, by the rows of its constraints and drives.
    pub fn note_side(&mut self, rows: &mut [f64], size: usize, t: f64, number: usize) {
        let sign = sign_of_determinant(rows, size);
        let StepErrors { orientation, leap, .. } = &mut self.errors;
        if *orientation * sign < 0.0 {
            *leap = leap.or(Some((t, number)));
        }
        *orientation = sign;
    }

    /// Takes note that the side is not known: other equations are left out.
    pub fn forget_side(&mut self) {
        self.errors.orientation = 0.0;
    }

    /// The larger one of both.
    pub fn worst(&self) -> Option<StepError> {
        let shares = self.errors.worst.iter().zip(self.errors.sizes).filter_map(|(worst, size)| {
            worst.filter(|_| size > 0.0).map(|worst| StepError { share: worst.share / size, ..worst })
        });
        shares.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
