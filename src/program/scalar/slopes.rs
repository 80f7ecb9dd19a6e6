//! Slopes at the knots of tables: formulas of the values, in any number.

use super::Scalar;

fn secants<S: Scalar>(knots: &[f64], values: &[S]) -> Vec<S> {
    (1..knots.len()).map(|i| (values[i] - values[i - 1]) / (knots[i] - knots[i - 1])).collect()
}

/// Slopes with which a cubic stays between the values of neighbouring knots: that of the parabola through three knots, cut to twice the
/// smaller of the two secants, and zero where these have unlike signs.
///
/// Source: Steffen (1990), A simple method for monotonic interpolation in one dimension, eqs. (8), (11), (24) to (26).
pub fn monotone_slopes<S: Scalar>(knots: &[f64], values: &[S]) -> Vec<S> {
    let (secants, h) = (secants(knots, values), |i: usize| knots[i + 1] - knots[i]);
    if let [only] = secants[..] {
        return vec![only; 2];
    }
    // at an end the parabola through it and its two neighbours
    let end = |near: S, far: S, width: f64, other: f64| {
        let share = width / (width + other);
        let slope = near * (1.0 + share) - far * share;
        let sign = near.sign();
        sign * (sign * slope).max(S::zero()).min(near.abs() * 2.0)
    };
    let inner = (1..secants.len()).map(|i| {
        let (before, after) = (secants[i - 1], secants[i]);
        let parabola = (before * h(i) + after * h(i - 1)) / (h(i - 1) + h(i));
        (before.sign() + after.sign()) * before.abs().min(after.abs()).min(parabola.abs() * 0.5)
    });
    let last = secants.len() - 1;
    let first = end(secants[0], secants[1], h(0), h(1));
    let final_slope = end(secants[last], secants[last - 1], h(last), h(last - 1));
    std::iter::once(first).chain(inner).chain([final_slope]).collect()
}

/// Slopes of the natural cubic spline: without curvature at its ends, twice continuously differentiable between.
///
/// The rows m_{i-1} / h_{i-1} + 2 m_i (1 / h_{i-1} + 1 / h_i) + m_{i+1} / h_i = 3 (s_{i-1} / h_{i-1} + s_i / h_i) of the slopes m and secants s
/// are eliminated from the first to the last.
pub fn natural_slopes<S: Scalar>(knots: &[f64], values: &[S]) -> Vec<S> {
    let secants = secants(knots, values);
    let inverse = |i: usize| 1.0 / (knots[i + 1] - knots[i]);
    let (last, mut slopes, mut upper) = (secants.len(), Vec::with_capacity(knots.len()), Vec::with_capacity(knots.len()));
    for i in 0..=last {
        // the row of an end has one neighbour
        let (left, right) = (if i > 0 { inverse(i - 1) } else { 0.0 }, if i < last { inverse(i) } else { 0.0 });
        let mut sum = S::zero();
        if i > 0 {
            sum += secants[i - 1] * (3.0 * left) - slopes[i - 1] * left;
        }
        if i < last {
            sum += secants[i] * (3.0 * right);
        }
        let before = if i > 0 { upper[i - 1] } else { 0.0 };
        let pivot = 2.0 * (left + right) - left * before;
        slopes.push(sum / pivot);
        upper.push(right / pivot);
    }
    for i in (0..last).rev() {
        let above = slopes[i + 1];
        slopes[i] -= above * upper[i];
    }
    slopes
}
