//! Least squares within bounds by Levenberg and Marquardt's method.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::NoValue;
use crate::scenes::Loss;
use nalgebra::{DMatrix, DVector};

/// Damping of the first step, by the squares of the columns of the Jacobian.
///
/// Source: Nielsen, Damping parameter in Marquardt's method (1999), as are the factors by which it goes on.
const FIRST_DAMPING: f64 = 1e-3;
/// Least damping, below the square of round-off of a Jacobian.
const LEAST_DAMPING: f64 = 1e-14;
/// Share of the decrease that the linear model promises above which a step is taken.
const ACCEPTED: f64 = 1e-3;
/// A step that changes no variable by more than this share of its size, or promises no decrease above the other share of the sum, ends the search.
const SMALL_STEP: f64 = 1e-10;
const SMALL_DECREASE: f64 = 1e-13;
/// An end is an optimum if a step without damping from there is as small as this, or promises as little: errors of estimates by their deviations are
/// the root of that.
const OPTIMAL_STEP: f64 = 1e-6;
const OPTIMAL_DECREASE: f64 = 1e-8;

/// Residuals r(x) and dr/dx.
pub(super) trait Residuals {
    /// What a Jacobian needs of a point.
    type Evaluated;
    /// Residuals at a point.
    fn residuals(&mut self, x: &[f64]) -> Result<(DVector<f64>, Self::Evaluated), NoValue>;
    /// Their derivatives there.
    fn jacobian(&mut self, x: &[f64], evaluated: &Self::Evaluated) -> Result<DMatrix<f64>, NoValue>;
    /// What residuals cost.
    fn loss(&self, row: usize) -> Loss;
    /// By what changes of a variable are measured.
    fn size(&self, variable: usize, x: f64) -> f64;
    /// An iteration has led to a point, with half the sum of all rho.
    fn reached(&mut self, x: &[f64], half_sum: f64);
}

/// Where a search ended.
pub(super) struct Least<E> {
    pub x: Vec<f64>,
    pub evaluated: E,
    pub residuals: DVector<f64>,
    pub jacobian: DMatrix<f64>,
    /// The same with rows by the curvature of their loss: J^T J is the matrix of second derivatives of half the sum, but for the curvature of residuals.
    /// Outliers, whose loss is straight or concave, count for nothing.
    pub curved: DMatrix<f64>,
    pub half_sum: f64,
    pub iterations: usize,
    /// Whether no step promises less, or the limit of iterations, or neither.
    pub is_optimum: bool,
    pub is_limit: bool,
}

/// Goes from a point within bounds to one of least sum of rho(r^2) / 2.
///
/// A step s minimizes |r + J s|^2 + damping |D s|^2 within the bounds, with D the largest norms of the columns of J so far: without damping it is that of
/// Gauss and Newton, with much of it one along the gradient. Points that fail are those where the step was too long.
///
/// With a loss, rows and residuals count by the root of rho': the sum of these squares is above that of the losses and touches it, however far away a
/// residual is.
///
/// Source: Marquardt (1963); More, The Levenberg-Marquardt algorithm (1978), section 6 for D; Holland & Welsch, Robust regression using iteratively
/// reweighted least-squares (1977).
///
/// # Errors
/// A start without residuals or Jacobian, and the wish to stop.
pub(super) fn levenberg_marquardt<R: Residuals>(
    problem: &mut R,
    start: &[f64],
    bounds: &[(f64, f64)],
    iterations: usize,
) -> Result<Least<R::Evaluated>, NoValue> {
    let (mut x, mut sizes) = (start.to_vec(), vec![0.0; start.len()]);
    let (mut residuals, mut evaluated) = problem.residuals(&x)?;
    let (mut damping, mut growth, mut taken) = (FIRST_DAMPING, 2.0, 0);
    loop {
        let half_sum = half_sum(problem, &residuals);
        problem.reached(&x, half_sum);
        let jacobian = problem.jacobian(&x, &evaluated)?;
        let model = LinearModel::new(problem, (&x, bounds), &residuals, &jacobian, &mut sizes);
        let variable_sizes: Vec<f64> = x.iter().enumerate().map(|(i, &x)| problem.size(i, x)).collect();
        let is_small = |step: &DVector<f64>, share: f64| {
            step.iter().zip(&variable_sizes).all(|(step, size)| step.abs() <= share * size)
        };
        let full = model.step(LEAST_DAMPING);
        let is_optimum = is_small(&full, OPTIMAL_STEP) || model.decrease(&full) <= OPTIMAL_DECREASE * half_sum;
        let is_limit = !is_optimum && taken == iterations;
        let mut next = None;
        while next.is_none() && taken < iterations {
            let step = model.step(damping);
            let decrease = model.decrease(&step);
            // a NaN ends, too
            if is_small(&step, SMALL_STEP) || !(decrease > SMALL_DECREASE * half_sum) {
                break;
            }
            let inside = |i: usize| (x[i] + step[i]).clamp(bounds[i].0, bounds[i].1);
            let trial: Vec<f64> = (0..x.len()).map(inside).collect();
            let found = match problem.residuals(&trial) {
                Err(NoValue::Stop) => return Err(NoValue::Stop),
                found => found.ok(),
            };
            let gain = found.as_ref().map_or(-1.0, |own| (half_sum - self::half_sum(problem, &own.0)) / decrease);
            if gain > ACCEPTED {
                next = found.map(|own| (trial, own));
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0)).max(LEAST_DAMPING);
                growth = 2.0;
            } else {
                damping *= growth;
                growth *= 2.0;
            }
        }
        let Some((trial, found)) = next else {
            let curvature = |row: usize, z: f64| {
                let [_, slope, change] = problem.loss(row).rho(z);
                (slope + 2.0 * change * z).max(0.0)
            };
            let curved = by_roots(&jacobian, &residuals, curvature);
            let iterations = taken;
            return Ok(Least { x, evaluated, residuals, jacobian, curved, half_sum, iterations, is_optimum, is_limit });
        };
        (x, taken) = (trial, taken + 1);
        (residuals, evaluated) = found;
    }
}

fn half_sum<R: Residuals>(problem: &R, residuals: &DVector<f64>) -> f64 {
    0.5 * residuals.iter().enumerate().map(|(row, r)| problem.loss(row).rho(r * r)[0]).sum::<f64>()
}

/// Rows times the roots of numbers by their squared residuals.
fn by_roots(jacobian: &DMatrix<f64>, residuals: &DVector<f64>, number: impl Fn(usize, f64) -> f64) -> DMatrix<f64> {
    let mut rows = jacobian.clone();
    for (row, r) in residuals.iter().enumerate() {
        rows.row_mut(row).scale_mut(number(row, r * r).sqrt());
    }
    rows
}

/// Half the sum of squares of r + J s, within bounds of s.
struct LinearModel<'s> {
    /// R and Q^T r of J = Q R.
    triangle: DMatrix<f64>,
    rest: DVector<f64>,
    sizes: &'s [f64],
    /// Bounds of steps.
    bounds: Vec<(f64, f64)>,
}

impl<'s> LinearModel<'s> {
    /// At a point, by the slopes of losses; `sizes` grow to the norms of columns.
    fn new<R: Residuals>(
        problem: &R,
        (x, bounds): (&[f64], &[(f64, f64)]),
        residuals: &DVector<f64>,
        jacobian: &DMatrix<f64>,
        sizes: &'s mut [f64],
    ) -> Self {
        let slope = |row: usize, z: f64| problem.loss(row).rho(z)[1];
        let matrix = by_roots(jacobian, residuals, slope);
        let mut rest =
            DVector::from_fn(residuals.len(), |row, _| slope(row, residuals[row].powi(2)).sqrt() * residuals[row]);
        for (size, column) in sizes.iter_mut().zip(matrix.column_iter()) {
            *size = size.max(column.norm());
        }
        let qr = matrix.qr();
        qr.q_tr_mul(&mut rest);
        let triangle = qr.r();
        let rest = rest.rows(0, triangle.nrows()).into_owned();
        let bounds = x.iter().zip(bounds).map(|(x, (lower, upper))| (lower - x, upper - x)).collect();
        LinearModel { triangle, rest, sizes, bounds }
    }

    /// The step for a damping: where it would leave bounds it stops at them, and the other variables make the best of that.
    fn step(&self, damping: f64) -> DVector<f64> {
        let count = self.bounds.len();
        let (mut step, mut free) = (DVector::zeros(count), (0..count).collect::<Vec<_>>());
        while !free.is_empty() {
            let rows = self.triangle.nrows();
            let mut matrix = DMatrix::zeros(rows + free.len(), free.len());
            let mut target = DVector::zeros(rows + free.len());
            target.rows_mut(0, rows).copy_from(&-(&self.rest + &self.triangle * &step));
            for (place, &variable) in free.iter().enumerate() {
                matrix.view_mut((0, place), (rows, 1)).copy_from(&self.triangle.column(variable));
                // a variable that changes nothing stays
                let size = if self.sizes[variable] > 0.0 { self.sizes[variable] } else { 1.0 };
                matrix[(rows + place, place)] = damping.sqrt() * size;
            }
            let qr = matrix.qr();
            qr.q_tr_mul(&mut target);
            let found = qr.r().solve_upper_triangular(&target.rows(0, free.len()).into_owned());
            let found = found.unwrap_or_else(|| DVector::from_element(free.len(), f64::NAN));
            let is_outside = |place: usize| {
                let (lower, upper) = self.bounds[free[place]];
                found[place] < lower || found[place] > upper
            };
            let outside: Vec<usize> = (0..free.len()).filter(|&place| is_outside(place)).collect();
            if outside.is_empty() {
                free.iter().zip(found.iter()).for_each(|(&variable, found)| step[variable] = *found);
                break;
            }
            for &place in outside.iter().rev() {
                let variable = free.remove(place);
                step[variable] = found[place].clamp(self.bounds[variable].0, self.bounds[variable].1);
            }
        }
        step
    }

    /// By how much half the sum becomes less along a step.
    fn decrease(&self, step: &DVector<f64>) -> f64 {
        let along = &self.triangle * step;
        -(self.rest.dot(&along) + 0.5 * along.norm_squared())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals of two variables by formulas, all with one loss.
    struct Formulas {
        residuals: fn([f64; 2]) -> Option<Vec<f64>>,
        jacobian: fn([f64; 2]) -> Vec<[f64; 2]>,
        loss: Loss,
    }

    impl Residuals for Formulas {
        type Evaluated = ();
        fn residuals(&mut self, x: &[f64]) -> Result<(DVector<f64>, ()), NoValue> {
            (self.residuals)([x[0], x[1]]).map(|own| (own.into(), ())).ok_or(NoValue::Failed)
        }
        fn jacobian(&mut self, x: &[f64], (): &()) -> Result<DMatrix<f64>, NoValue> {
            let rows = (self.jacobian)([x[0], x[1]]);
            Ok(DMatrix::from_fn(rows.len(), 2, |i, j| rows[i][j]))
        }
        fn loss(&self, _: usize) -> Loss {
            self.loss
        }
        fn size(&self, _: usize, x: f64) -> f64 {
            x.abs().max(1.0)
        }
        fn reached(&mut self, _: &[f64], _: f64) {}
    }

    const ROSENBROCK: Formulas = Formulas {
        residuals: |[x, y]| Some(vec![10.0 * (y - x * x), 1.0 - x]),
        jacobian: |[x, _]| vec![[-20.0 * x, 10.0], [-1.0, 0.0]],
        loss: Loss::Linear,
    };

    fn least(mut problem: Formulas, start: [f64; 2], bounds: [(f64, f64); 2]) -> Least<()> {
        levenberg_marquardt(&mut problem, &start, &bounds, 100).unwrap()
    }

    #[test]
    fn the_valley_of_rosenbrock_ends_at_its_lowest_place_within_bounds() {
        let far = (-10.0, 10.0);
        let own = least(ROSENBROCK, [-1.2, 1.0], [far; 2]);
        assert!(own.is_optimum && (own.x[0] - 1.0).abs() < 1e-9 && own.half_sum < 1e-18, "{:?}", own.x);
        // on x = 0.5 the best y is 0.25
        let own = least(ROSENBROCK, [-1.2, 1.0], [(-10.0, 0.5), far]);
        assert!(own.is_optimum && own.x[0] == 0.5 && (own.x[1] - 0.25).abs() < 1e-9, "{:?}", own.x);
        assert!((own.half_sum - 0.125).abs() < 1e-12);
    }

    #[test]
    fn a_step_that_fails_is_too_long() {
        let walled = Formulas { residuals: |[x, y]| (x < 1.05).then(|| vec![10.0 * (y - x * x), 1.0 - x]), ..ROSENBROCK };
        let own = least(walled, [-1.2, 1.0], [(-10.0, 10.0); 2]);
        assert!(own.is_optimum && (own.x[0] - 1.0).abs() < 1e-9, "{:?}", own.x);
    }

    #[test]
    fn losses_have_the_stationary_points_of_their_sums() {
        // a mean of ten values near 1 and one of 100 by which it is moved the less the later the loss is concave
        for (loss, most) in [(Loss::Linear, 10.0), (Loss::Huber, 1.12), (Loss::SoftL1, 1.2), (Loss::Cauchy, 1.01)] {
            const VALUES: [f64; 11] = [0.9, 1.1, 0.95, 1.05, 1.0, 0.98, 1.02, 0.97, 1.03, 1.0, 100.0];
            let mean = Formulas {
                residuals: |[x, _]| Some(VALUES.iter().map(|value| x - value).collect()),
                jacobian: |_| vec![[1.0, 0.0]; 11],
                loss,
            };
            let own = least(mean, [3.0, 0.0], [(-1e3, 1e3); 2]);
            let slope: f64 = VALUES.iter().map(|v| loss.rho((own.x[0] - v).powi(2))[1] * (own.x[0] - v)).sum();
            // of terms that sum to as much as 180
            assert!(own.is_optimum && slope.abs() < 1e-4 && own.x[0] <= most, "{loss:?} {:?} {slope}", own.x);
            assert!(own.x[1].abs() < 1e-9, "what changes nothing stays");
        }
    }

    #[test]
    fn derivatives_of_losses_are_those_of_rho() {
        for loss in Loss::ALL {
            for z in [0.3, 0.9, 1.1, 4.0, 1e4] {
                let (step, [_, slope, curvature]) = (1e-5 * z, loss.rho(z));
                let [up, down] = [z + step, z - step].map(|z| loss.rho(z));
                assert!(((up[0] - down[0]) / (2.0 * step) - slope).abs() < 1e-8, "{loss:?} {z}");
                assert!(((up[1] - down[1]) / (2.0 * step) - curvature).abs() < 1e-8, "{loss:?} {z}");
            }
        }
    }
}
