//! What the last bit of the variables does to a gradient.

use costate::integrators::RunError;
use costate::sensitivity::{Analysis, largest_difference};

/// How many times what a rounding does two ways to the same number may differ.
pub const SCATTER: f64 = 4.0;

/// The larger one, or NaN.
pub fn worse(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// Adjoint gradients at the designs next to one, up and down.
pub struct NearbyAdjoints([Vec<Vec<f64>>; 2]);

impl NearbyAdjoints {
    /// On the steps of the analysis.
    ///
    /// # Errors
    /// As for the adjoint.
    pub fn of(analysis: &Analysis, x: &[f64]) -> Result<Self, RunError> {
        let at = |rounded: fn(f64) -> f64| -> Result<Vec<Vec<f64>>, RunError> {
            let x: Vec<f64> = x.iter().map(|&x| rounded(x)).collect();
            Ok(analysis.adjoint(&x, &analysis.forward(&x)?)?.rows)
        };
        Ok(NearbyAdjoints([at(f64::next_up)?, at(f64::next_down)?]))
    }

    /// The largest difference of two of the rows of a functional, there and here, by the largest entry; each row in the units of `scaled`.
    pub fn scatter(&self, functional: usize, here: &[f64], scaled: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
        let [up, down] = self.0.each_ref().map(|rows| scaled(&rows[functional]));
        let here = scaled(here);
        let pairs = [(&up, &down), (&up, &here), (&down, &here)];
        pairs.iter().fold(0.0, |most, (one, other)| worse(most, largest_difference(one, other)))
    }
}
