//! Functions of one number given by values at knots: each is a sum of values times weights of the knots.

use std::sync::{OnceLock, RwLock};

/// How values are joined between knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolant {
    /// Straight lines, constant beyond the ends.
    Lines,
    /// A natural cubic spline, of constant slope beyond the ends.
    Cubic,
}

/// Knots and the way between them: f(t) = sum over the knots of f_i w_i(t).
#[derive(Debug, PartialEq)]
pub struct Curve {
    knots: Vec<f64>,
    /// Of a spline the matrix from values to second derivatives, row-major; empty for lines.
    second: Vec<f64>,
}

/// A curve among all that were made, the same for the same knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CurveId(pub(crate) u32);

fn curves() -> &'static RwLock<Vec<&'static Curve>> {
    static CURVES: OnceLock<RwLock<Vec<&'static Curve>>> = OnceLock::new();
    CURVES.get_or_init(RwLock::default)
}

impl CurveId {
    /// A curve over the given knots.
    ///
    /// # Errors
    /// Fewer than two knots, or knots that are not finite or do not increase; the message shows which.
    pub fn new(knots: &[f64], interpolant: Interpolant) -> Result<Self, String> {
        if knots.len() < 2 {
            return Err(format!("a table over time needs at least 2 knots, not {}", knots.len()));
        }
        if let Some(i) = knots.iter().position(|t| !t.is_finite()) {
            return Err(format!("table times must be finite: knot {i} is {}", knots[i]));
        }
        if let Some(i) = (1..knots.len()).find(|&i| knots[i] <= knots[i - 1]) {
            return Err(format!("table times must increase: knot {i} is {} after {}", knots[i], knots[i - 1]));
        }
        let second = if interpolant == Interpolant::Cubic { second_derivatives(knots) } else { Vec::new() };
        let own = Curve { knots: knots.to_vec(), second };
        let mut all = curves().write().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(place) = all.iter().position(|curve| **curve == own) {
            return Ok(CurveId(place as u32));
        }
        // as many as there are different tables in a process
        all.push(Box::leak(Box::new(own)));
        Ok(CurveId(all.len() as u32 - 1))
    }

    /// The curve.
    pub fn curve(self) -> &'static Curve {
        curves().read().unwrap_or_else(std::sync::PoisonError::into_inner)[self.0 as usize]
    }
}

impl Curve {
    /// The knots.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Whether it consists of straight lines, whose slope jumps at the knots.
    pub(crate) fn is_of_lines(&self) -> bool {
        self.second.is_empty()
    }

    /// Number of the piece at `t`.
    pub(crate) fn piece(&self, t: f64) -> usize {
        self.knots.partition_point(|&own| own <= t)
    }

    /// Bits of all that it is made of: lines have knots alone.
    pub(crate) fn knot_bits(&self) -> (Vec<u64>, bool) {
        (self.knots.iter().map(|knot| knot.to_bits()).collect(), self.second.is_empty())
    }

    /// Derivative of order `order` of the weight w_i of knot `knot` at `t`: for orders 0 to 3, beyond which it is zero.
    ///
    /// At a knot the piece to the right counts; before the first knot and from the last one on, the piece beyond.
    pub fn weight(&self, knot: usize, order: usize, t: f64) -> f64 {
        let last = self.knots.len() - 1;
        let value = |k: usize| f64::from(u8::from(k == knot));
        let curvature = |k: usize| self.second.get(k * (last + 1) + knot).copied().unwrap_or(0.0);
        let k = self.knots.partition_point(|&own| own <= t).clamp(1, last) - 1;
        let h = self.knots[k + 1] - self.knots[k];
        let slope = (value(k + 1) - value(k)) / h;
        let beyond = if t < self.knots[0] {
            Some((0, slope - (curvature(0) * 2.0 + curvature(1)) * (h / 6.0)))
        } else if t > self.knots[last] || (self.second.is_empty() && t == self.knots[last]) {
            Some((last, slope + (curvature(last - 1) + curvature(last) * 2.0) * (h / 6.0)))
        } else {
            None
        };
        if let Some((end, slope)) = beyond {
            // lines are constant there
            let slope = if self.second.is_empty() { 0.0 } else { slope };
            return match order {
                0 => value(end) + slope * (t - self.knots[end]),
                1 => slope,
                _ => 0.0,
            };
        }
        let (right, left) = ((t - self.knots[k]) / h, (self.knots[k + 1] - t) / h);
        let (m0, m1) = (curvature(k), curvature(k + 1));
        match order {
            0 => {
                let bend = (left * left * left - left) * m0 + (right * right * right - right) * m1;
                value(k) * left + value(k + 1) * right + bend * (h * h / 6.0)
            }
            1 => slope + ((1.0 - 3.0 * left * left) * m0 + (3.0 * right * right - 1.0) * m1) * (h / 6.0),
            2 => left * m0 + right * m1,
            3 => (m1 - m0) / h,
            _ => 0.0,
        }
    }
}

/// Matrix from knot values to second derivatives of the natural spline: the tridiagonal system solved for each unit value.
fn second_derivatives(knots: &[f64]) -> Vec<f64> {
    let n = knots.len();
    let mut matrix = vec![0.0; n * n];
    let h = |i: usize| knots[i + 1] - knots[i];
    for unit in 0..n {
        let f = |i: usize| f64::from(u8::from(i == unit));
        // forward elimination of h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i - slope_{i-1})
        let (mut upper, mut rhs) = (vec![0.0; n], vec![0.0; n]);
        for i in 1..n - 1 {
            let jump = 6.0 * ((f(i + 1) - f(i)) / h(i) - (f(i) - f(i - 1)) / h(i - 1));
            let pivot = 2.0 * (h(i - 1) + h(i)) - h(i - 1) * upper[i - 1];
            upper[i] = h(i) / pivot;
            rhs[i] = (jump - h(i - 1) * rhs[i - 1]) / pivot;
        }
        let mut above = 0.0;
        for i in (1..n.saturating_sub(1)).rev() {
            above = rhs[i] - upper[i] * above;
            matrix[i * n + unit] = above;
        }
    }
    matrix
}
