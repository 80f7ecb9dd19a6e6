//! The model of second derivatives that steps teach.

// `!(x > 0)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// A positive definite matrix made of steps and the changes of the Lagrangian's gradient along them (BFGS).
///
/// Until there are as many steps as variables, it has the size of the curvature seen last along directions that no step has taken, so
/// that round-off there, as in a symmetric problem's asymmetry, hardly grows.
///
/// Source: Powell (1978), "A fast algorithm for nonlinearly constrained optimization calculations" (damping).
pub(super) struct Curvature {
    pub matrix: Vec<Vec<f64>>,
    /// The first steps, as many as there are variables, and the changes of the gradient along them.
    learned: Vec<(Vec<f64>, Vec<f64>)>,
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Curvature {
    /// The same along all directions.
    pub fn of_size(n: usize, size: f64) -> Self {
        Curvature { matrix: multiple_of_identity(n, size), learned: Vec::new() }
    }

    /// Whether no step has taught anything yet.
    pub fn is_new(&self) -> bool {
        self.learned.is_empty()
    }

    /// d . H d.
    pub fn along(&self, step: &[f64]) -> f64 {
        dot(step, &turned(&self.matrix, step))
    }

    /// Learns from the change of the Lagrangian's gradient along a step.
    pub fn learn(&mut self, step: &[f64], mut change: Vec<f64>) {
        let n = step.len();
        let curvature = dot(step, &change);
        if !(self.along(step) > 0.0) {
            return;
        }
        if curvature > 0.0 && self.learned.len() < n {
            // along directions that no step has taken yet: the mean of both usual estimates, |y|^2 / s . y and s . y / |s|^2
            let size = (dot(&change, &change) / dot(step, step)).sqrt();
            self.matrix = multiple_of_identity(n, size);
            for (step, change) in &self.learned {
                update(&mut self.matrix, step, change);
            }
        }
        let of_model = turned(&self.matrix, step);
        let modelled = dot(step, &of_model);
        if curvature < 0.2 * modelled {
            // mixed with the model's own so that the matrix stays positive definite
            let share = 0.8 * modelled / (modelled - curvature);
            for (change, turned) in change.iter_mut().zip(&of_model) {
                *change = share * *change + (1.0 - share) * turned;
            }
        }
        update(&mut self.matrix, step, &change);
        if self.learned.len() < n {
            self.learned.push((step.to_vec(), change));
        }
    }
}

fn multiple_of_identity(n: usize, size: f64) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| if i == j { size } else { 0.0 }).collect()).collect()
}

fn turned(matrix: &[Vec<f64>], step: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, step)).collect()
}

/// Updates a matrix so that it takes a step to a change of the gradient.
fn update(matrix: &mut [Vec<f64>], step: &[f64], change: &[f64]) {
    let turned = turned(matrix, step);
    let (modelled, curvature) = (dot(step, &turned), dot(step, change));
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += change[i] * change[j] / curvature - turned[i] * turned[j] / modelled;
        }
    }
}
