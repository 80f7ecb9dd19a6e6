use super::{Direction, History, Rerun};
use crate::integrators::{RunError, SolveRecord, StartRecord, StepRecord};

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

/// One end of a step.
#[derive(Clone, Debug)]
struct End {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    /// Solved acceleration; `None` where the method has no stage there.
    a: Option<Vec<f64>>,
    /// Multipliers of the last stage.
    mu: Vec<f64>,
    /// An equilibrium, not a motion.
    is_static: bool,
}

impl End {
    fn start(start: &StartRecord<f64>) -> Self {
        let SolveRecord { t, base, unknowns, .. } = &start.acceleration;
        End {
            t: *t,
            q: base.q.clone(),
            v: base.v.clone(),
            a: Some(unknowns.x.clone()),
            mu: unknowns.mu.clone(),
            is_static: false,
        }
    }

    fn of(step: &StepRecord<f64>) -> Self {
        let t = step.t + step.h;
        let mut end = End { t, q: step.q.clone(), v: step.v.clone(), a: None, mu: Vec::new(), is_static: false };
        if let Some(last) = step.stages.last() {
            end.a = ((t - last.solve.t).abs() <= 1e-9 * step.h).then(|| last.solve.unknowns.x.clone());
            end.mu.clone_from(&last.solve.unknowns.mu);
            end.is_static = last.solve.equations.is_static();
        }
        end
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
    /// Before the first step.
    pub fn new(start: &StartRecord<f64>) -> Self {
        Dense { start: End::start(start), end: End::start(start) }
    }

    /// Moves on to the next step.
    pub fn step(&mut self, step: &StepRecord<f64>) {
        self.start = std::mem::replace(&mut self.end, End::of(step));
        if let Some(restart) = &step.restart {
            self.start.a = Some(restart.unknowns.x.clone());
            self.start.mu.clone_from(&restart.unknowns.mu);
        }
    }

    /// Start and end of the latest step \[s\]; twice the start of the run before the first.
    pub fn span(&self) -> (f64, f64) {
        (self.start.t, self.end.t)
    }

    /// The state at a time; outside the latest step that of the nearer end.
    pub fn at(&self, t: f64) -> Snapshot {
        let Dense { start, end } = self;
        let h = end.t - start.t;
        let share = if h > 0.0 { ((t - start.t) / h).clamp(0.0, 1.0) } else { 0.0 };
        let zeros = vec![0.0; end.q.len()];
        let mut moment = Snapshot { t, q: zeros.clone(), v: zeros.clone(), a: zeros, mu: end.mu.clone() };
        if h == 0.0 {
            (moment.q, moment.v) = (start.q.clone(), start.v.clone());
            moment.a = start.a.clone().unwrap_or_default();
            return moment;
        }
        let between = |ends: [f64; 2]| ends[0] + share * (ends[1] - ends[0]);
        if end.is_static {
            moment.q = start.q.iter().zip(&end.q).map(|(a, b)| between([*a, *b])).collect();
            moment.mu = start.mu.iter().zip(&end.mu).map(|(a, b)| between([*a, *b])).collect();
            return moment;
        }
        let accelerations = start.a.as_ref().zip(end.a.as_ref());
        for i in 0..end.q.len() {
            let ends = [[start.q[i], start.v[i]], [end.q[i], end.v[i]]];
            let second = accelerations.map(|(a, b)| [a[i], b[i]]);
            [moment.q[i], moment.v[i], moment.a[i]] = hermite(h, share, ends, second);
        }
        if accelerations.is_some() {
            moment.mu = start.mu.iter().zip(&end.mu).map(|(a, b)| between([*a, *b])).collect();
        }
        moment
    }
}

/// The states of a kept run at given times, which increase and lie within it, whatever its steps: see [`Dense`].
///
/// # Errors
/// [`RunError::Input`] for other times or a run without steps; what the history says where it can't give a step.
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
        if !(from <= t && t <= to + 1e-9 * (to - start)) {
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
