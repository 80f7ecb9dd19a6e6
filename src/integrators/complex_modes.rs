//! Small vibrations of what is damped, turns, or has states of first order: (lambda^2 M + lambda C + K) x + A^T nu = 0, A x = 0.
//!
//! With R and A at (0, 0, q): M = dR/da, C = dR/dv, K = d(R + A^T mu)/dq; in a frame that turns C holds Coriolis and K centrifugal terms. With
//! w = lambda x the values nearest to a real shift s are the largest theta = 1 / (lambda - s) of the operator (x, w) -> (y, z),
//!
//! ```text
//! (K + s C + s^2 M) y + A^T nu = -(M w + C x + s M x),  A y = 0,    z = x + s y
//! ```
//!
//! (shift and invert of the linearized quadratic problem; Tisseur & Meerbergen 2001). M may be singular: what it leaves out vibrates infinitely fast.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::krylov::{Space, add, largest_pairs};
use super::march::{Method, Problem};
use super::vibrations::{Mode, Operator, chosen_shift, first_shift, is_rigid};
use super::{RunError, StartPlan};
use crate::assembly::{Equations, Jacobian, Level, StageCoefficients};
use crate::linalg::Eigenpair;

/// Most shifts that are tried.
const MOST_SHIFTS: usize = 6;
/// Modes that are sought beyond those asked for.
const SPARE: usize = 2;
/// What the operator may leave of a mode beside theta times itself.
const LEFT: f64 = 1e-7;

/// The operator with a damping matrix, on pairs of a vector and its rate by the shift.
struct Damped<'o, 'm> {
    operator: &'o mut Operator<'m>,
    damping: &'o Jacobian,
    shift: f64,
}

impl Space for Damped<'_, '_> {
    fn size(&self) -> usize {
        2 * self.operator.nodes
    }
    fn is_symmetric(&self) -> bool {
        false
    }
    fn image(&self, vector: &[f64]) -> Vec<f64> {
        vector.to_vec()
    }
    fn apply(&mut self, image: &[f64]) -> Vec<f64> {
        let (x, rate) = image.split_at(self.operator.nodes);
        let mut both = x.to_vec();
        add(&mut both, 1.0, rate);
        let mut rhs = self.operator.times_mass(&both);
        rhs.iter_mut().for_each(|entry| *entry *= -self.shift);
        add(&mut rhs, -1.0, &self.operator.times(self.damping, x));
        let y = self.operator.solve_nodes(&rhs);
        let z: Vec<f64> = y.iter().zip(x).map(|(y, x)| y + x / self.shift).collect();
        [y, z].concat()
    }
    fn obey_constraints(&mut self, vector: &mut [f64]) {
        let (x, rate) = vector.split_at_mut(self.operator.nodes);
        [x, rate].into_iter().for_each(|part| self.operator.obey(part));
    }
}

/// lambda = s + 1 / theta.
fn value(pair: &Eigenpair, shift: f64) -> [f64; 2] {
    let [re, im] = pair.value;
    let size = re * re + im * im;
    [shift + re / size, -im / size]
}

/// The modes of a problem about its start, which must be an equilibrium at time (or load factor) `t`, with damping and whatever else depends on
/// velocities: up to `count` whose values lambda are nearest to zero, in the order of their sizes; fewer where there are no more. One of each
/// conjugate pair is given.
///
/// # Errors
/// As for [`vibrations`](super::vibrations()); modes that the operator does not keep.
pub fn complex_modes(
    problem: &Problem<f64>,
    method: &Method,
    plan: &StartPlan,
    t: f64,
    count: usize,
) -> Result<Vec<Mode>, RunError> {
    let mut operator = Operator::new(problem, method, plan, (t, count))?;
    if operator.nodes == 0 {
        return Ok(Vec::new());
    }
    let largest = operator.largest_ratio();
    let equations = Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity);
    let damping = operator.assembled(&equations);
    let mut shift = first_shift(largest).sqrt();
    let mut ritz = Vec::new();
    for _ in 0..MOST_SHIFTS {
        operator.set_shift([shift * shift, shift])?;
        ritz = largest_pairs(&mut Damped { operator: &mut operator, damping: &damping, shift }, count, SPARE)?;
        let values = ritz.iter().map(|pair| value(pair, shift));
        let squares: Vec<f64> = values.clone().map(|[re, im]| re * re + im * im).collect();
        let grows = values.clone().any(|[re, _]| re > 0.0 && !is_rigid(re * re, shift * shift, largest));
        match chosen_shift(&squares, (shift * shift, largest), grows) {
            Some(other) => shift = other.sqrt(),
            None => break,
        }
    }
    let mut damped = Damped { operator: &mut operator, damping: &damping, shift };
    let mut modes = Vec::new();
    for pair in &ritz {
        let vectors = pair.vector.each_ref().map(|part| damped.apply(part));
        let left = left_over(&vectors, pair);
        if !(left <= LEFT) {
            return Err(RunError::Input(format!(
                "a mode is known to a share of {left:.1e} only: masses, stiffnesses or dampings differ by more than the digits of a number hold; \
                 ask for fewer modes"
            )));
        }
        let [re, im] = value(pair, shift);
        let rigid = is_rigid(re * re + im * im, shift * shift, largest);
        // of a pair the value with a positive imaginary part, and its vector
        let [growth, frequency] = if rigid { [0.0; 2] } else { [re, im.abs()] };
        let nodes = damped.operator.nodes;
        let [x, mut y] = vectors.map(|vector| vector[..nodes].to_vec());
        if im < 0.0 {
            y.iter_mut().for_each(|part| *part = -*part);
        }
        // the operator's result is theta x: its phase is none of the mode's
        let [shape, ahead] = damped.operator.in_coordinates([x, y]);
        modes.push(Mode { frequency, growth, shape, ahead });
    }
    let size = |mode: &Mode| mode.frequency.hypot(mode.growth);
    modes.sort_by(|a, b| size(a).total_cmp(&size(b)).then(a.growth.total_cmp(&b.growth)));
    Ok(modes)
}

/// What is left of the operator's result less theta times the vector, as a share of it.
fn left_over(applied: &[Vec<f64>; 2], Eigenpair { value: [re, im], vector: [x, y] }: &Eigenpair) -> f64 {
    let (mut off, mut size) = (0.0, 0.0);
    for (place, (x, y)) in x.iter().zip(y).enumerate() {
        let [own, other] = [applied[0][place], applied[1][place]];
        off += (own - (re * x - im * y)).powi(2) + (other - (re * y + im * x)).powi(2);
        size += own * own + other * other;
    }
    (off / size).sqrt()
}
