use super::{Direction, History, Rerun};
use crate::integrators::{RunError, SolveRecord, StageRecord, StartRecord, StepRecord};
use crate::tolerances::SAME_TIME;

/// The state at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Time \[s\].
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Multipliers.
    pub mu: Vec<f64>,
}

#[derive(Clone, Debug)]
struct End {
    /// The state; its acceleration is empty where the method has no stage there, its multipliers are those of the last stage.
    state: Snapshot,
    is_static: bool,
}

impl End {
    fn start(start: &StartRecord<f64>) -> Self {
        let SolveRecord { t, base, unknowns, .. } = &start.acceleration;
        let (a, mu) = (unknowns.x.clone(), unknowns.mu.clone());
        End { state: Snapshot { t: *t, q: base.q.clone(), v: base.v.clone(), a, mu }, is_static: false }
    }

    fn of(step: &StepRecord<f64>) -> Self {
        let t = step.t + step.h;
        let mut state = Snapshot { t, q: step.q.clone(), v: step.v.clone(), a: Vec::new(), mu: Vec::new() };
        let mut is_static = false;
        if let Some(StageRecord { solve, .. }) = step.stages.last() {
            if (t - solve.t).abs() <= SAME_TIME * step.h {
                state.a.clone_from(&solve.unknowns.x);
            }
            state.mu.clone_from(&solve.unknowns.mu);
            is_static = solve.equations.is_static();
        }
        End { state, is_static }
    }
}

/// Follows a run and gives the state at any time of its latest step.
///
/// Coordinates are the polynomial that meets coordinates, velocities and accelerations at both ends of the step (degree 5);
/// without a stage at the ends of steps, coordinates and velocities (degree 3). Velocities and accelerations are its
/// derivatives. Equilibria and multipliers are linear between the ends, or those of the last stage.
#[derive(Clone, Debug)]
pub struct Dense {
    start: End,
    end: End,
}

impl Dense {
    pub fn new(start: &StartRecord<f64>) -> Self {
        Dense { start: End::start(start), end: End::start(start) }
    }

    pub fn step(&mut self, step: &StepRecord<f64>) {
        self.start = std::mem::replace(&mut self.end, End::of(step));
        // behind an event the step starts elsewhere, or under other forces
        self.start.state.q.clone_from(&step.carried[0]);
        self.start.state.v.clone_from(&step.carried[1]);
        if !step.switched.is_empty() {
            self.start.state.a.clear();
        }
        if let Some(restart) = &step.restart {
            self.start.state.a.clone_from(&restart.unknowns.x);
            self.start.state.mu.clone_from(&restart.unknowns.mu);
        }
    }

    /// Start and end of the latest step \[s\]; twice the start of the run before the first.
    pub fn span(&self) -> (f64, f64) {
        (self.start.state.t, self.end.state.t)
    }

    /// The state at a time; outside the latest step that of the nearer end.
    pub fn at(&self, t: f64) -> Snapshot {
        let (start, end) = (&self.start.state, &self.end.state);
        let h = end.t - start.t;
        let share = if h > 0.0 { ((t - start.t) / h).clamp(0.0, 1.0) } else { 0.0 };
        if h == 0.0 {
            return Snapshot { t, mu: end.mu.clone(), ..start.clone() };
        }
        let between = |start: &[f64], end: &[f64]| start.iter().zip(end).map(|(a, b)| a + share * (b - a)).collect();
        let zeros = || vec![0.0; end.q.len()];
        if self.end.is_static {
            let (q, mu) = (between(&start.q, &end.q), between(&start.mu, &end.mu));
            return Snapshot { t, q, v: zeros(), a: zeros(), mu };
        }
        let are_solved = !start.a.is_empty() && !end.a.is_empty();
        let mu = if are_solved { between(&start.mu, &end.mu) } else { end.mu.clone() };
        let mut moment = Snapshot { t, q: zeros(), v: zeros(), a: zeros(), mu };
        for i in 0..end.q.len() {
            let ends = [[start.q[i], start.v[i]], [end.q[i], end.v[i]]];
            let second = are_solved.then(|| [start.a[i], end.a[i]]);
            [moment.q[i], moment.v[i], moment.a[i]] = hermite(h, share, ends, second);
        }
        moment
    }
}

/// The states of a kept run at given times, which increase and lie within it, whatever its steps: see [`Dense`].
pub fn moments(history: &dyn History, rerun: &Rerun<'_>, times: &[f64]) -> Result<Vec<Snapshot>, RunError> {
    let mut steps = history.read(rerun, Direction::Forward)?;
    let start = history.start_record().ok_or_else(|| RunError::Input("a run that was not begun has no motion".into()))?;
    let mut dense = Dense::new(start);
    let mut moments: Vec<Snapshot> = Vec::with_capacity(times.len());
    let mut latest = dense.span().0;
    for &t in times {
        // at the end of a step it is the next one that tells
        let mut more = true;
        while more && dense.span().1 <= t {
            let step = steps.next()?;
            more = step.is_some();
            step.into_iter().for_each(|step| dense.step(step));
        }
        let ((start, to), from) = (dense.span(), latest);
        // the last step may end within round-off of the end that was asked for
        if !(from <= t && t <= to + SAME_TIME * (to - start)) {
            return Err(RunError::Input(format!(
                "the motion is asked for at {t} s, after {from} s and within a run to {to} s"
            )));
        }
        latest = t;
        moments.push(dense.at(t));
    }
    Ok(moments)
}

/// Value, first and second derivative at a share of a step of the polynomial through values, rates and second rates at its ends.
fn hermite(h: f64, share: f64, [start, end]: [[f64; 2]; 2], second: Option<[f64; 2]>) -> [f64; 3] {
    // c0 + c1 s + c2 s^2 + s^3 (c3 + c4 s + c5 s^2), with rates in units of the step
    let (value, rate) = (start[0], h * start[1]);
    let coefficients = match second {
        Some([a, b]) => {
            let (curve, end_curve) = (h * h * a / 2.0, h * h * b / 2.0);
            let x = end[0] - value - rate - curve;
            let y = h * end[1] - rate - 2.0 * curve;
            let z = end_curve - curve;
            [value, rate, curve, 10.0 * x - 4.0 * y + z, -15.0 * x + 7.0 * y - 2.0 * z, 6.0 * x - 3.0 * y + z]
        }
        None => {
            let x = end[0] - value - rate;
            let y = h * end[1] - rate;
            [value, rate, 3.0 * x - y, y - 2.0 * x, 0.0, 0.0]
        }
    };
    let (mut value, mut first, mut half_second) = (0.0, 0.0, 0.0);
    for &c in coefficients.iter().rev() {
        half_second = half_second * share + first;
        first = first * share + value;
        value = value * share + c;
    }
    [value, first / h, 2.0 * half_second / (h * h)]
}

#[cfg(test)]
mod tests {
    use super::hermite;

    #[test]
    fn polynomials_of_its_degree_are_met_exactly() {
        let coefficients = [0.3, -1.2, 0.7, 2.1, -0.4, 0.9];
        for (degree, with_second) in [(5, true), (3, false)] {
            let at = |t: f64| {
                let c = &coefficients[..=degree];
                let term = |(i, c): (usize, &f64), drop: usize| -> f64 {
                    let falling: f64 = (0..drop).map(|k| i as f64 - k as f64).product();
                    if i < drop { 0.0 } else { c * falling * t.powi((i - drop) as i32) }
                };
                [0, 1, 2].map(|drop| c.iter().enumerate().map(|own| term(own, drop)).sum::<f64>())
            };
            let h = 0.7;
            let (start, end) = (at(0.0), at(h));
            let second = with_second.then_some([start[2], end[2]]);
            for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let found = hermite(h, share, [[start[0], start[1]], [end[0], end[1]]], second);
                for (found, exact) in found.iter().zip(at(share * h)) {
                    assert!((found - exact).abs() < 1e-13, "degree {degree}, {share}: {found} {exact}");
                }
            }
        }
    }
}
