use super::Parameter;
use crate::scalar::Scalar;
use std::sync::Arc;

/// A function of time f(t) for motion drivers and loads; its numbers are parameters of the element that holds it.
#[derive(Clone, Debug)]
pub enum TimeFunction {
    /// f = c. Parameters: value.
    Constant,
    /// f = f0 + r t. Parameters: offset, rate.
    ConstantRate,
    /// f = f0 + A sin(w t + phi). Parameters: offset, amplitude, angular frequency, phase.
    Sine,
    /// From f0 at t0 to f1 at t1 along 10 s^3 - 15 s^4 + 6 s^5, twice continuously differentiable. Parameters: from, to,
    /// start, duration.
    SmoothRamp,
    /// f = c before the switch, d from it on; for loads only. Parameters: before, after; the switch time is topology.
    Step {
        /// Time of the jump [s].
        switch: f64,
    },
    /// Any of the others, started from rest: f(s(t)), with ds/dt going from 0 to 1 along 10 x^3 - 15 x^4 + 6 x^5, x = t / T.
    ///
    /// s = T (5/2 x^4 - 3 x^5 + x^6) until T, t - T/2 from there on, 0 before 0. Parameters: those of f, start duration T. If f jumps,
    /// T moves the jump, which gradients by T leave out.
    SmoothStart(Arc<TimeFunction>),
    /// Straight lines through (t_i, f_i), constant outside; for loads only. Parameters: the values f_i; the times are topology.
    Lines(Arc<[f64]>),
    /// Natural cubic spline through (t_i, f_i), constant slope outside. Parameters: the values f_i; the times are topology.
    Table(Arc<CubicTable>),
}

/// Knots of a natural cubic spline and the matrix that maps values to second derivatives.
#[derive(Debug)]
pub struct CubicTable {
    times: Vec<f64>,
    /// Row-major, knots by knots.
    second: Vec<f64>,
}

impl TimeFunction {
    /// A table over the given knots.
    ///
    /// # Errors
    /// Fewer than two knots, or times that are not finite or do not increase; the message shows which.
    pub fn table(times: Vec<f64>) -> Result<TimeFunction, String> {
        check_knots(&times)?;
        let second = second_derivative_matrix(&times);
        Ok(TimeFunction::Table(Arc::new(CubicTable { times, second })))
    }

    /// Straight lines between the given knots.
    ///
    /// # Errors
    /// As for [`TimeFunction::table`].
    pub fn lines(times: Vec<f64>) -> Result<TimeFunction, String> {
        check_knots(&times)?;
        Ok(TimeFunction::Lines(times.into()))
    }

    /// The parameters, their unit being `unit` for values of f.
    pub fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let new = Parameter::new;
        match self {
            TimeFunction::Constant => vec![new("value", unit)],
            TimeFunction::ConstantRate => vec![new("offset", unit), new("rate", "per s")],
            TimeFunction::Sine => {
                vec![new("offset", unit), new("amplitude", unit), new("angular frequency", "rad/s"), new("phase", "rad")]
            }
            TimeFunction::SmoothRamp => {
                vec![new("from", unit), new("to", unit), new("start", "s"), Parameter::positive("duration", "s")]
            }
            TimeFunction::Step { .. } => vec![new("before", unit), new("after", unit)],
            TimeFunction::SmoothStart(inner) => {
                inner.parameters(unit).into_iter().chain([Parameter::positive("start duration", "s")]).collect()
            }
            TimeFunction::Table(table) => knot_values(table.times.len(), unit),
            TimeFunction::Lines(times) => knot_values(times.len(), unit),
        }
    }

    /// f(t) for parameters `p`.
    pub fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        match self {
            TimeFunction::Constant => p[0],
            TimeFunction::ConstantRate => p[0] + p[1] * t,
            TimeFunction::Sine => p[0] + p[1] * (p[2] * t + p[3]).sin(),
            TimeFunction::SmoothRamp => {
                let s = (t - p[2]) / p[3];
                if s.value() <= 0.0 {
                    p[0]
                } else if s.value() >= 1.0 {
                    p[1]
                } else {
                    p[0] + (p[1] - p[0]) * (s * s * s * ((s * 6.0 - 15.0) * s + 10.0))
                }
            }
            TimeFunction::Step { switch } => p[usize::from(t.value() >= *switch)],
            TimeFunction::SmoothStart(inner) => match p {
                [own @ .., duration] => inner.value(started_time(t, *duration), own),
                [] => unreachable!("the start duration is the last parameter"),
            },
            TimeFunction::Table(table) => table.value(t, p),
            TimeFunction::Lines(times) => {
                let last = times.len() - 1;
                if t.value() <= times[0] {
                    p[0]
                } else if t.value() >= times[last] {
                    p[last]
                } else {
                    let k = times.partition_point(|&knot| knot <= t.value()) - 1;
                    p[k] + (p[k + 1] - p[k]) * ((t - times[k]) / (times[k + 1] - times[k]))
                }
            }
        }
    }

    /// Times at which f or one of its first two derivatives jumps.
    pub fn kinks(&self, p: &[f64]) -> Vec<f64> {
        match self {
            TimeFunction::SmoothRamp => vec![p[2], p[2] + p[3]],
            TimeFunction::Step { switch } => vec![*switch],
            TimeFunction::Lines(times) => times.to_vec(),
            TimeFunction::SmoothStart(inner) => match p {
                [own @ .., duration] => {
                    let mapped = inner.kinks(own).into_iter().filter(|kink| *kink > 0.0);
                    mapped.map(|kink| time_started_at(kink, *duration)).chain([*duration]).collect()
                }
                [] => unreachable!("the start duration is the last parameter"),
            },
            _ => Vec::new(),
        }
    }

    /// Time of a jump of the value, if there is one.
    pub fn jump(&self) -> Option<f64> {
        match self {
            TimeFunction::Step { switch } => Some(*switch),
            TimeFunction::SmoothStart(inner) => inner.jump(),
            _ => None,
        }
    }

    /// Time at which the value or its rate jumps, if there is one: no driven motion can follow.
    pub fn rate_jump(&self) -> Option<f64> {
        match self {
            TimeFunction::Step { switch } => Some(*switch),
            TimeFunction::Lines(times) => Some(times[0]),
            TimeFunction::SmoothStart(inner) => inner.rate_jump(),
            _ => None,
        }
    }
}

fn check_knots(times: &[f64]) -> Result<(), String> {
    if times.len() < 2 {
        return Err(format!("a table over time needs at least 2 knots, not {}", times.len()));
    }
    if let Some(i) = times.iter().position(|t| !t.is_finite()) {
        return Err(format!("table times must be finite: knot {i} is {}", times[i]));
    }
    if let Some(i) = (1..times.len()).find(|&i| times[i] <= times[i - 1]) {
        return Err(format!("table times must increase: knot {i} is {} after {}", times[i], times[i - 1]));
    }
    Ok(())
}

fn knot_values(count: usize, unit: &'static str) -> Vec<Parameter> {
    (0..count).map(|i| Parameter::named(format!("value {i}"), unit)).collect()
}

/// s(t) of a smooth start [s].
fn started_time<S: Scalar>(t: S, duration: S) -> S {
    if t.value() <= 0.0 {
        return S::zero();
    }
    let x = t / duration;
    if x.value() >= 1.0 { t - duration * 0.5 } else { duration * (x.powi(4) * ((x - 3.0) * x + 2.5)) }
}

/// The first time at which s(t) has reached `s` > 0, to the last bit: s grows from 0 on, so halving finds it.
fn time_started_at(s: f64, duration: f64) -> f64 {
    let (mut before, mut after) = (0.0, s + duration);
    loop {
        let middle = 0.5 * (before + after);
        if !(before < middle && middle < after) {
            return after;
        }
        if started_time(middle, duration) < s {
            before = middle;
        } else {
            after = middle;
        }
    }
}

impl CubicTable {
    fn value<S: Scalar>(&self, t: S, values: &[S]) -> S {
        let n = self.times.len();
        // beyond the ends the last cubic's end slope goes on: natural ends have no curvature there
        let time = t.value().clamp(self.times[0], self.times[n - 1]);
        let k = self.times.partition_point(|&knot| knot <= time).clamp(1, n - 1) - 1;
        let h = self.times[k + 1] - self.times[k];
        let curvature = |row: usize| {
            let weights = &self.second[row * n..(row + 1) * n];
            weights.iter().zip(values).map(|(&w, &f)| f * w).sum::<S>()
        };
        let (m0, m1) = (curvature(k), curvature(k + 1));
        let slope = (values[k + 1] - values[k]) / h;
        if t.value() < self.times[0] {
            return values[0] + (slope - (m0 * 2.0 + m1) * (h / 6.0)) * (t - self.times[0]);
        }
        if t.value() > self.times[n - 1] {
            return values[n - 1] + (slope + (m0 + m1 * 2.0) * (h / 6.0)) * (t - self.times[n - 1]);
        }
        let (right, left) = ((t - self.times[k]) / h, (-t + self.times[k + 1]) / h);
        let bend = (left * left * left - left) * m0 + (right * right * right - right) * m1;
        values[k] * left + values[k + 1] * right + bend * (h * h / 6.0)
    }
}

/// Matrix from knot values to second derivatives of the natural spline: the tridiagonal system solved for each unit value.
fn second_derivative_matrix(times: &[f64]) -> Vec<f64> {
    let n = times.len();
    let mut matrix = vec![0.0; n * n];
    let h = |i: usize| times[i + 1] - times[i];
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
