// equations, state, parameters, time and targets are arguments
#![allow(clippy::too_many_arguments)]

use super::{Analysis, Forward};
use crate::integrators::RunError;

/// Largest difference of two rows, relative to the largest entry of the first.
pub fn largest_difference(reference: &[f64], other: &[f64]) -> f64 {
    let scale = reference.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    // a NaN stays: no later entry may hide it
    let worse = |d: f64, (a, b): (&f64, &f64)| if d.is_nan() || (a - b).abs() <= d { d } else { (a - b).abs() };
    let difference = reference.iter().zip(other).fold(0.0, worse);
    if difference == 0.0 { 0.0 } else { difference / scale }
}

/// Taylor remainders of a functional along a direction: with a right gradient the second falls with the square of the step.
#[derive(Clone, Debug, PartialEq)]
pub struct TaylorTest {
    /// Steps along the direction.
    pub steps: Vec<f64>,
    /// |f(x + s d) - f(x)|.
    pub first: Vec<f64>,
    /// |f(x + s d) - f(x) - s df . d|.
    pub second: Vec<f64>,
}

impl TaylorTest {
    /// Remainders of functional `index` for steps `largest` / 2^k.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn run(
        analysis: &Analysis,
        forward: &Forward,
        x: &[f64],
        gradient: &[f64],
        direction: &[f64],
        index: usize,
        largest: f64,
        count: usize,
    ) -> Result<Self, RunError> {
        let slope: f64 = gradient.iter().zip(direction).map(|(g, d)| g * d).sum();
        let mut test = TaylorTest { steps: Vec::new(), first: Vec::new(), second: Vec::new() };
        for k in 0..count {
            let step = largest / f64::powi(2.0, k as i32);
            let moved: Vec<f64> = x.iter().zip(direction).map(|(x, d)| x + step * d).collect();
            let change = analysis.values(&moved)?[index] - forward.values[index];
            test.steps.push(step);
            test.first.push(change.abs());
            test.second.push((change - step * slope).abs());
        }
        Ok(test)
    }

    /// Observed order of the second remainder between successive steps; 2 for a right gradient.
    pub fn orders(&self) -> Vec<f64> {
        self.second.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::largest_difference;

    #[test]
    fn a_nan_is_never_hidden_by_a_later_entry() {
        assert!(largest_difference(&[1.0, 2.0, 3.0], &[1.0, f64::NAN, 3.5]).is_nan());
        assert_eq!(largest_difference(&[1.0, -4.0], &[1.0, -3.0]), 0.25);
        assert_eq!(largest_difference(&[0.0], &[0.0]), 0.0);
    }
}
