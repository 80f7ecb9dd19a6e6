// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::evaluations::violation;
use super::{ConstraintKind, Gradients, Stopping, Values};
use crate::tolerances::LONG_SUM;
use nalgebra::{DMatrix, DVector};

/// The first-order conditions of optimality at a point, found from its values and gradients alone, whatever led there.
///
/// With L = f + sum of lambda c, lambda at least 0 where c <= 0, and the multipliers that satisfy the conditions best in the sense of least
/// squares: dL/dx = 0 where a variable is free, at least 0 where it is at its lower bound, at most 0 at its upper one; c is satisfied;
/// lambda c = 0.
///
/// Source: Nocedal & Wright (2006), theorem 12.1; least squares: Lawson & Hanson (1974), chapter 23.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Multipliers of the constraints.
    pub multipliers: Vec<f64>,
    /// dL/dx.
    pub slopes: Vec<f64>,
    /// Largest size of its entries that no bound forbids to follow, relative to the largest term of dL/dx, or to 1 if that is larger.
    pub stationarity: f64,
    /// Largest violation of a constraint.
    pub violation: f64,
    /// Largest product of a multiplier and the distance from its limit, relative to the size of the objective, or to 1.
    pub complementarity: f64,
    /// Stationarity and complementarity up to this count as none: the root of [`Stopping::change`], by which a change of the objective
    /// that counts as none bounds a slope.
    pub tolerance: f64,
    /// Violations up to this count as none.
    pub allowed: f64,
}

/// Changes of the set of variables held by their bounds that are made.
const ROUNDS: usize = 40;

/// What is known at a point.
struct Place<'p> {
    x: &'p [f64],
    bounds: &'p [(f64, f64)],
    kinds: &'p [ConstraintKind],
    values: &'p Values,
    gradients: &'p Gradients,
}

impl Conditions {
    /// At a point.
    pub(super) fn at(
        (x, bounds): (&[f64], &[(f64, f64)]),
        kinds: &[ConstraintKind],
        (values, gradients): (&Values, &Gradients),
        stopping: &Stopping,
    ) -> Self {
        let place = Place { x, bounds, kinds, values, gradients };
        let mut counted: Vec<bool> = (0..x.len()).map(|i| place.allowed(i, -1.0) && place.allowed(i, 1.0)).collect();
        let mut multipliers = place.multipliers(&counted);
        let mut slopes = place.slopes(&multipliers);
        for _ in 0..ROUNDS {
            // bounds whose multipliers would have the wrong sign do not hold
            let next: Vec<bool> = (0..x.len()).map(|i| place.allowed(i, -slopes[i])).collect();
            if next == counted {
                break;
            }
            counted = next;
            multipliers = place.multipliers(&counted);
            slopes = place.slopes(&multipliers);
        }
        let reduced: Vec<f64> =
            slopes.iter().enumerate().map(|(i, &slope)| if place.allowed(i, -slope) { slope } else { 0.0 }).collect();
        let largest = |list: &[f64]| list.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let terms = gradients.constraints.iter().zip(&multipliers).map(|(row, multiplier)| largest(row) * multiplier.abs());
        let size = terms.fold(largest(&gradients.objective).max(1.0), f64::max);
        let products = multipliers.iter().enumerate().map(|(k, multiplier)| (multiplier * place.distance(k)).abs());
        Conditions {
            stationarity: largest(&reduced) / size,
            violation: violation(kinds, &values.constraints),
            complementarity: products.fold(0.0, f64::max) / values.objective.abs().max(1.0),
            multipliers,
            slopes,
            tolerance: stopping.change.sqrt(),
            allowed: stopping.violation,
        }
    }

    /// Whether all of them hold.
    pub fn hold(&self) -> bool {
        self.stationarity <= self.tolerance && self.complementarity <= self.tolerance && self.violation <= self.allowed
    }
}

impl Place<'_> {
    /// Whether variable `i` may move in the direction of a sign.
    fn allowed(&self, i: usize, sign: f64) -> bool {
        let (lower, upper) = self.bounds[i];
        !((sign < 0.0 && self.x[i] <= lower) || (sign > 0.0 && self.x[i] >= upper))
    }

    /// How far an inequality is from its limit on the allowed side.
    fn distance(&self, k: usize) -> f64 {
        match self.kinds[k] {
            ConstraintKind::Equality => 0.0,
            ConstraintKind::AtMostZero => (-self.values.constraints[k]).max(0.0),
        }
    }

    /// dL/dx.
    fn slopes(&self, multipliers: &[f64]) -> Vec<f64> {
        let rows = || self.gradients.constraints.iter().zip(multipliers);
        let slope = |(i, g): (usize, &f64)| g + rows().map(|(row, multiplier)| row[i] * multiplier).sum::<f64>();
        self.gradients.objective.iter().enumerate().map(slope).collect()
    }

    /// The multipliers that make dL/dx of the counted variables and the products with distances least.
    fn multipliers(&self, counted: &[bool]) -> Vec<f64> {
        let m = self.kinds.len();
        let rows: Vec<usize> = (0..counted.len()).filter(|&i| counted[i]).collect();
        let matrix = DMatrix::from_fn(rows.len() + m, m, |i, k| match rows.get(i) {
            Some(&variable) => self.gradients.constraints[k][variable],
            None if i - rows.len() == k => self.distance(k),
            None => 0.0,
        });
        let target = DVector::from_fn(rows.len() + m, |i, _| rows.get(i).map_or(0.0, |&i| -self.gradients.objective[i]));
        let free: Vec<bool> = self.kinds.iter().map(|kind| *kind == ConstraintKind::Equality).collect();
        least_squares(&matrix, &target, &free)
    }
}

/// The x of least |A x - b| whose entries are at least 0 unless they are free.
fn least_squares(matrix: &DMatrix<f64>, target: &DVector<f64>, free: &[bool]) -> Vec<f64> {
    let m = free.len();
    let mut x = DVector::zeros(m);
    let mut chosen = free.to_vec();
    for _ in 0..3 * m + 3 {
        // back to where the first entry becomes 0, until none wants to be negative
        loop {
            let wanted = on_columns(matrix, target, &chosen);
            let blocking = (0..m).filter(|&k| chosen[k] && !free[k] && !(wanted[k] > 0.0));
            let gap = |k: usize| -> f64 { x[k] - wanted[k] };
            let share = blocking.clone().map(|k| x[k] / gap(k).max(f64::MIN_POSITIVE)).fold(1.0, f64::min);
            let none = blocking.clone().next().is_none();
            let released: Vec<usize> = blocking.filter(|&k| !(x[k] + share * (wanted[k] - x[k]) > 0.0)).collect();
            x += (wanted - &x) * if none { 1.0 } else { share };
            if none || released.is_empty() {
                break;
            }
            released.into_iter().for_each(|k| (x[k], chosen[k]) = (0.0, false));
        }
        let rest = target - matrix * &x;
        let pull = |k: usize| {
            let column = matrix.column(k);
            (column.dot(&rest), column.norm() * target.norm() * LONG_SUM)
        };
        let next = (0..m).filter(|&k| !chosen[k]).map(|k| (pull(k), k)).filter(|((pull, floor), _)| pull > floor);
        match next.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) {
            Some((_, k)) => chosen[k] = true,
            None => break,
        }
    }
    x.as_slice().to_vec()
}

/// Least squares on some columns, of least norm; 0 for the others.
fn on_columns(matrix: &DMatrix<f64>, target: &DVector<f64>, chosen: &[bool]) -> DVector<f64> {
    let places: Vec<usize> = (0..chosen.len()).filter(|&k| chosen[k]).collect();
    let mut x = DVector::zeros(chosen.len());
    if places.is_empty() || matrix.nrows() == 0 {
        return x;
    }
    let svd = matrix.select_columns(&places).svd(true, true);
    let floor = LONG_SUM * svd.singular_values.max();
    if let Ok(found) = svd.solve(target, floor) {
        places.iter().zip(found.iter()).for_each(|(&k, value)| x[k] = *value);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::ConstraintKind::{AtMostZero, Equality};
    use super::*;

    fn conditions(x: &[f64], objective: &[f64], kinds: &[ConstraintKind], c: &[f64], rows: &[[f64; 2]]) -> Conditions {
        let values = Values { objective: 1.0, constraints: c.to_vec() };
        let gradients =
            Gradients { objective: objective.to_vec(), constraints: rows.iter().map(|row| row.to_vec()).collect() };
        Conditions::at((x, &[(0.0, 1.0); 2]), kinds, (&values, &gradients), &Stopping::default())
    }

    #[test]
    fn bounds_hold_what_pulls_outwards_and_nothing_else() {
        // at the lower bound of the first, inside of the second
        assert!(conditions(&[0.0, 0.5], &[2.0, 0.0], &[], &[], &[]).hold());
        assert!(!conditions(&[0.0, 0.5], &[-2.0, 0.0], &[], &[], &[]).hold());
        assert!(conditions(&[1.0, 0.5], &[-2.0, 0.0], &[], &[], &[]).hold());
        // the heaviest design of all, where mass grows with the variable
        let heaviest = conditions(&[1.0, 0.5], &[9.3, 0.0], &[AtMostZero], &[-0.88], &[[-0.1, 0.0]]);
        assert!(!heaviest.hold() && heaviest.stationarity > 0.9, "{heaviest:?}");
    }

    #[test]
    fn multipliers_of_inequalities_have_their_sign_and_belong_to_active_ones() {
        let of = |objective: [f64; 2], c: f64| conditions(&[0.5, 0.5], &objective, &[AtMostZero], &[c], &[[-2.0, 0.0]]);
        let active = of([4.0, 0.0], 0.0);
        assert!(active.hold() && (active.multipliers[0] - 2.0).abs() < 1e-14, "{active:?}");
        let wrong_sign = of([-4.0, 0.0], 0.0);
        assert!(!wrong_sign.hold() && wrong_sign.multipliers[0] == 0.0, "{wrong_sign:?}");
        assert!(!of([4.0, 0.0], -0.3).hold(), "an inactive limit holds nothing");
        assert!(!of([4.0, 0.0], 0.3).hold(), "a violated limit");
        let equality = |c| conditions(&[0.5, 0.5], &[-4.0, 2.0], &[Equality], &[c], &[[-2.0, 1.0]]);
        assert!(equality(0.0).hold() && (equality(0.0).multipliers[0] + 2.0).abs() < 1e-14);
        assert!(!equality(1e-3).hold());
    }

    #[test]
    fn dependent_gradients_and_a_bound_that_a_limit_replaces_are_no_obstacle() {
        // the same limit twice
        let twice = conditions(&[0.5, 0.5], &[1.0, 1.0], &[AtMostZero; 2], &[0.0; 2], &[[-1.0, -1.0]; 2]);
        assert!(twice.hold(), "{twice:?}");
        // at the lower bound of the first, where the limit pulls the first up and the second along with it
        let replaced = conditions(&[0.0, 0.5], &[1.0, 1.0], &[AtMostZero], &[0.0], &[[-3.0, -1.0]]);
        assert!(!replaced.hold() && replaced.stationarity > 0.1, "{replaced:?}");
    }
}
