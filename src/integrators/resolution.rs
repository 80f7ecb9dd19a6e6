//! How well equal steps resolve a motion.

use super::lists::largest_scaled;
use super::march::embedded_difference;
use super::record::{SolveRecord, StepRecord};
use super::{StabilityCourse, Table};
use crate::assembly::Level;
use crate::elements::RunScalar;
use smallvec::SmallVec;

/// The largest estimated error of one step: in coordinates by the model's length, in velocities by the largest velocity of the run; angular
/// ones count by the model's length, too.
///
/// It is that of an embedded solution, and in a step that begins with an acceleration solved for anew that of one without the explicit first
/// stage, too, if that is larger; where the method of order p has none, its leading error terms C h^(p+1) d^(p+1)q/dt^(p+1) and
/// C h^(p+1) d^(p+1)v/dt^(p+1), whose derivatives are those of a polynomial through the mean accelerations of the latest steps, and whose
/// factors are those of the table for a given acceleration. Constraints that several stages keep on coordinates make such a method one of first
/// order (Hairer, Lubich & Roche, The numerical solution of differential-algebraic systems by Runge-Kutta methods (1989)): its error
/// is what velocities at both ends differ by from the change of coordinates, too. What round-off makes of it does not count.
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
    /// Share above which a motion counts as unresolved. Of motions drawn by lot and held against runs of another method with many more steps, at
    /// most one in a hundred below it may have values that are off by more than a tenth, and many above it are off by more than a hundredth: study `random-scenes`.
    pub const COARSE: f64 = 2e-3;
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// In coordinates and in velocities \[m, m/s\].
    pub worst: [Option<StepError>; 2],
    /// Largest coordinate and velocity \[m, m/s\].
    pub sizes: [f64; 2],
    /// Mean accelerations of the latest steps, latest first, and their times, for methods without an embedded solution; the acceleration that
    /// was solved for at the start, or last anew, stands behind those after it [s, m/s2].
    pub accelerations: Vec<(f64, Vec<f64>)>,
    /// Sign of the determinant of the constraints' rows, of a mechanism whose motion its drives determine, when it was looked at last: 1 or
    /// -1, that before a singular pose while it stands in one, 0 where not known.
    pub orientation: f64,
    /// Start of the first step in which it changed, and its number.
    pub leap: Option<(f64, usize)>,
    pub stability: Option<StabilityCourse>,
}

/// Rounding of coordinates by the model's length, with what the tables make of it at stages: up to 300 times as much.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

pub(super) struct Measures<'m> {
    pub scales: &'m [f64],
    pub length: f64,
    /// What round-off may do to accelerations [m/s2].
    pub round_off: f64,
}

impl StepErrors {
    /// Weights by which the kept accelerations give their derivative of an order by time, if they are enough of them: that of the polynomial
    /// through them, k! sum a_j / prod (t_j - t_i).
    fn weights_of_derivative(&self, order: usize) -> Option<SmallVec<[f64; 8]>> {
        let list = self.accelerations.get(..=order)?;
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        let weight = |(j, (own, _)): (usize, &(f64, Vec<f64>))| {
            let others = list.iter().enumerate().filter(|(i, _)| *i != j);
            factorial / others.map(|(_, (other, _))| own - other).product::<f64>()
        };
        Some(list.iter().enumerate().map(weight).collect())
    }

    /// Writes what velocities at both ends of a step are off by beside the change of coordinates, (v0 + v1)/2 - h/12 (a1 - a0) - (q1 - q0)/h,
    /// their mean along the step but for h^4: the slope of the accelerations is that of the polynomial through the latest ones.
    fn velocity_offset<S: RunScalar>(&self, step: &StepRecord<S>, offset: &mut Vec<S>) {
        let list = &self.accelerations;
        let half = list.get(1).map_or(0.0, |before| (list[0].0 - before.0) / 2.0);
        let [chord, curvature] = [1, 2].map(|order| self.weights_of_derivative(order).unwrap_or_default());
        let of = |weights: &[f64], place: usize| weights.get(place).copied().unwrap_or(0.0);
        let weights: [f64; 3] = std::array::from_fn(|place| of(&chord, place) + half * of(&curvature, place));
        self.combine(&weights, -step.h * step.h / 12.0, offset);
        let ends = step.q.iter().zip(&step.carried[0]).zip(step.v.iter().zip(&step.carried[1]));
        for (offset, ((&q, &q_before), (&v, &v_before))) in offset.iter_mut().zip(ends) {
            *offset += S::from(0.5 * (v.value() + v_before.value()) - (q.value() - q_before.value()) / step.h);
        }
    }

    fn combine<S: RunScalar>(&self, weights: &[f64], factor: f64, sum: &mut Vec<S>) {
        let lists = || weights.iter().zip(&self.accelerations);
        let of_dof = |dof: usize| lists().map(|(weight, (_, list))| weight * list[dof]).sum::<f64>() * factor;
        sum.clear();
        sum.extend((0..self.accelerations[0].1.len()).map(|dof| S::from(of_dof(dof))));
    }
}

/// Share of the change of coordinates in a step that their rates at both ends may leave open where it passes a singular pose on its own
/// branch: where it leaps from a dead point it is a quarter or more.
const SMOOTH: f64 = 1e-2;

/// Whether coordinates change in a step of size `h` as their rates at its start and end say.
pub(super) fn is_smooth<S: RunScalar>(before: [&[S]; 2], after: [&[S]; 2], h: f64, scales: &[f64]) -> bool {
    let ([old_q, old_v], [q, v]) = (before, after);
    let (mut change, mut open) = (0.0_f64, 0.0_f64);
    for (dof, scale) in scales.iter().enumerate().take(q.len()) {
        let own = q[dof].value() - old_q[dof].value();
        change = change.max(own.abs() * scale);
        open = open.max((own - 0.5 * h * (old_v[dof].value() + v[dof].value())).abs() * scale);
    }
    open <= SMOOTH * change
}

/// Whether several stages of a step keep constraints on coordinates.
fn loses_order<S>(step: &StepRecord<S>) -> bool {
    let holds = |SolveRecord { equations, unknowns, .. }: &SolveRecord<S>| {
        equations.level == Level::Position && !(unknowns.mu.is_empty() && unknowns.local_mu.is_empty())
    };
    step.stages.iter().filter(|stage| stage.known.is_none() && holds(&stage.solve)).count() > 1
}

#[derive(Debug)]
pub(super) struct Resolution<S> {
    pub errors: StepErrors,
    difference: Vec<S>,
    /// Factors of the leading error terms of coordinates and velocities, once a step has asked for them.
    factors: Option<[f64; 2]>,
}

crate::assembly::empty_fields!(Resolution { errors, difference, factors });

impl<S: RunScalar> Resolution<S> {
    pub fn begin(&mut self, t: f64, acceleration: &[S]) {
        self.errors.accelerations.clear();
        self.errors.accelerations.push((t, acceleration.iter().map(|a| a.value()).collect()));
    }

    pub fn note(&mut self, table: &Table, number: usize, step: &StepRecord<S>, measures: &Measures) {
        if table.is_static() {
            return;
        }
        let mut difference = std::mem::take(&mut self.difference);
        if let Some(embedded) = &table.embedded {
            let implicit = embedded.implicit.as_deref().filter(|_| step.begins_anew(number - 1));
            for solution in [Some(embedded), implicit].into_iter().flatten() {
                for (order, in_velocity) in [(0, false), (1, true)] {
                    embedded_difference((table, solution), order, step, &mut difference);
                    self.judge(in_velocity, number, step, &difference, measures);
                }
            }
        } else {
            self.note_acceleration(table.order, step);
            let factors = *self.factors.get_or_insert_with(|| table.error_factors());
            let factors = factors.map(|factor| factor * step.h.powi(table.order as i32 + 1));
            for (in_velocity, factor) in [false, true].into_iter().zip(factors) {
                let order = if in_velocity { table.order } else { table.order - 1 };
                if let Some(weights) = self.errors.weights_of_derivative(order) {
                    self.errors.combine(&weights, factor, &mut difference);
                    self.judge(in_velocity, number, step, &difference, measures);
                }
            }
            if loses_order(step) {
                self.errors.velocity_offset(step, &mut difference);
                self.judge(true, number, step, &difference, measures);
            }
        }
        self.difference = difference;
        self.errors.sizes[0] = self.errors.sizes[0].max(measures.length);
    }

    /// Adds the mean acceleration of a step, of which as many are kept as an order asks for.
    fn note_acceleration(&mut self, order: usize, step: &StepRecord<S>) {
        if let Some(solved) = &step.restart {
            self.begin(step.t, &solved.unknowns.x);
        }
        let list = &mut self.errors.accelerations;
        if list.len() > order {
            list.truncate(order + 1);
            list.rotate_right(1);
        } else {
            list.insert(0, Default::default());
        }
        let (t, mean) = &mut list[0];
        *t = step.t + 0.5 * step.h;
        mean.clear();
        mean.extend(step.v.iter().zip(&step.carried[1]).map(|(end, start)| (end.value() - start.value()) / step.h));
    }

    /// Errors of coordinates or of velocities, and how large these are.
    fn judge(&mut self, in_velocity: bool, number: usize, step: &StepRecord<S>, errors: &[S], measures: &Measures) {
        let Measures { scales, length, round_off, .. } = *measures;
        let place = usize::from(in_velocity);
        let states = if in_velocity { &step.v } else { &step.q };
        let StepErrors { worst, sizes, .. } = &mut self.errors;
        let (worst, size) = (&mut worst[place], &mut sizes[place]);
        let scaled = |x: S, scale: f64| x.value().abs() * scale;
        *size = size.max(largest_scaled(states, scales, scaled));
        // an estimate that is no number says nothing good of a step
        let off = |x: S, scale: f64| if scaled(x, scale).is_nan() { f64::INFINITY } else { scaled(x, scale) };
        let largest = largest_scaled(errors, scales, off);
        // constraints that are kept on coordinates are rounded as these are, and velocities follow by the size of the step
        let rounded = if in_velocity { step.h * round_off + ROUNDINGS * (length / step.h) } else { ROUNDINGS * length };
        let share = if largest > rounded { largest } else { 0.0 };
        if worst.is_none_or(|worst| share > worst.share) {
            let dof = errors.iter().zip(scales).position(|(&error, &scale)| off(error, scale) == largest).unwrap_or(0);
            *worst = Some(StepError { share, step: number, t: step.t, dof, in_velocity });
        }
    }

    /// Takes note of the sides on which a driven mechanism is before and after a step in which coordinates do not change as their rates say, by
    /// the determinant of the rows of its constraints and drives; 0 is neither. A mechanism whose coordinates change as their rates say goes
    /// through a singular pose as a parallelogram does: that is no leap.
    pub fn note_sides(&mut self, [start, end]: [f64; 2], (t, number): (f64, usize)) {
        let StepErrors { orientation, leap, .. } = &mut self.errors;
        let start = if start == 0.0 { *orientation } else { start };
        if start * end < 0.0 {
            *leap = leap.or(Some((t, number)));
        }
        *orientation = if end == 0.0 { start } else { end };
    }

    /// Takes note that the side is not known: other equations are left out.
    pub fn forget_side(&mut self) {
        self.errors.orientation = 0.0;
    }

    pub fn worst(&self) -> Option<StepError> {
        let shares = self.errors.worst.iter().zip(self.errors.sizes).filter_map(|(worst, size)| {
            worst.filter(|_| size > 0.0).map(|worst| StepError { share: worst.share / size, ..worst })
        });
        shares.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_that_is_no_number_is_no_small_one() {
        let mut resolution = Resolution::<f64>::default();
        let (mut step, scales) = (StepRecord::default(), [1.0; 2]);
        (step.h, step.q, step.v) = (0.1, vec![1.0, 0.5], vec![2.0, 0.1]);
        let measures = Measures { scales: &scales, length: 1.0, round_off: 0.0 };
        for errors in [[1e-6, 1e-7], [f64::NAN, 1e-7], [1e-6, f64::INFINITY]] {
            resolution.errors = StepErrors::default();
            resolution.judge(false, 1, &step, &errors, &measures);
            let worst = resolution.worst().expect("judged");
            assert_eq!(worst.share > StepError::COARSE, errors[0] + errors[1] != 1e-6 + 1e-7, "{errors:?}: {worst:?}");
            assert_eq!(worst.dof, errors.iter().position(|error| !error.is_finite()).unwrap_or(0));
        }
    }
}
