//! The model of second derivatives that steps teach.

// `!(x > 0)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use nalgebra::{DMatrix, DVector};

/// A positive definite matrix made of steps and the changes of the Lagrangian's gradient along them (BFGS).
///
/// Until there are as many steps as variables, it has the size of the curvature seen last along directions that no step has taken, so
/// that round-off there, as in a symmetric problem's asymmetry, hardly grows.
///
/// Source: Powell (1978), "A fast algorithm for nonlinearly constrained optimization calculations" (damping).
pub(super) struct Curvature {
    pub matrix: DMatrix<f64>,
    /// The first steps, as many as there are variables, and the changes of the gradient along them.
    learned: Vec<(DVector<f64>, DVector<f64>)>,
}

impl Curvature {
    /// The same along all directions.
    pub fn of_size(n: usize, size: f64) -> Self {
        Curvature { matrix: DMatrix::from_diagonal_element(n, n, size), learned: Vec::new() }
    }

    /// Whether no step has taught anything yet.
    pub fn is_new(&self) -> bool {
        self.learned.is_empty()
    }

    /// d . H d.
    pub fn along(&self, step: &DVector<f64>) -> f64 {
        step.dot(&(&self.matrix * step))
    }

    /// Learns from the change of the Lagrangian's gradient along a step.
    pub fn learn(&mut self, step: DVector<f64>, mut change: DVector<f64>) {
        let n = step.len();
        let curvature = step.dot(&change);
        if !(self.along(&step) > 0.0) {
            return;
        }
        if curvature > 0.0 && self.learned.len() < n {
            // along directions that no step has taken yet: the mean of both usual estimates, |y|^2 / s . y and s . y / |s|^2
            self.matrix = DMatrix::from_diagonal_element(n, n, (change.norm_squared() / step.norm_squared()).sqrt());
            for (step, change) in &self.learned {
                update(&mut self.matrix, step, change);
            }
        }
        let of_model = &self.matrix * &step;
        let modelled = step.dot(&of_model);
        if curvature < 0.2 * modelled {
            // mixed with the model's own so that the matrix stays positive definite
            let share = 0.8 * modelled / (modelled - curvature);
            change = share * change + (1.0 - share) * of_model;
        }
        update(&mut self.matrix, &step, &change);
        if self.learned.len() < n {
            self.learned.push((step, change));
        }
    }
}

/// Updates a matrix so that it takes a step to a change of the gradient.
fn update(matrix: &mut DMatrix<f64>, step: &DVector<f64>, change: &DVector<f64>) {
    let turned = &*matrix * step;
    let (modelled, curvature) = (step.dot(&turned), step.dot(change));
    *matrix += change * change.transpose() / curvature - &turned * turned.transpose() / modelled;
}
