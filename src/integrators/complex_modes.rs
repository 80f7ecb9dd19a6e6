//! Small vibrations of what is damped, turns, or has states of first order: (lambda^2 M + lambda C + K) x + A^T nu = 0, A x = 0.
//!
//! With R and A at (0, 0, q): M = dR/da, C = dR/dv, K = d(R + A^T mu)/dq; in a frame that turns C holds Coriolis and K centrifugal terms. With
//! w = lambda x the values nearest to a real shift s are the largest theta = 1 / (lambda - s) of the operator (x, w) -> (y, z),
//!
//! ```text
//! (K + s C + s^2 M) y + A^T nu = -(M w + C x + s M x),  A y = 0,    z = x + s y
//! ```
//!
//! (shift and invert of the linearized quadratic problem; Tisseur & Meerbergen 2001). M may be singular: what it leaves out vibrates infinitely fast,
//! but for states of first order, which have one value each by C (see [`AtRest`](crate::elements::AtRest)).

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::krylov::{Space, add, dot, largest_pairs};
use super::march::{Method, Problem};
use super::vibrations::{Mode, Operator, is_rigid};
use super::{RunError, StartPlan};
use crate::assembly::{Equations, Jacobian, Level, StageCoefficients};
use crate::linalg::Eigenpair;

/// Most shifts that are tried.
const MOST_SHIFTS: usize = 12;
/// The first shift, as a share of the root of the largest ratio of stiffness and inertia: below most modes, which one far above would not tell apart.
const FIRST_SHIFT: f64 = 1e-7;
/// By how much it grows where rigid motions hide all others.
const GROWTH: f64 = 30.0;
/// A shift this many times smaller or larger than the lowest value that is not zero is chosen anew.
const FAR: f64 = 3.0;
/// theta below this share of the largest one is none.
const INFINITE: f64 = 1e-10;
/// Modes that are sought beyond those asked for.
const SPARE: usize = 2;
/// What the operator may leave of a mode beside theta times itself.
const LEFT: f64 = 1e-6;
/// Growth that is round-off of none, by the distance from the shift: a hundred times what values are converged to.
const NO_GROWTH: f64 = 1e-9;
/// Rigid motions that differ by this share of their size are the same.
const SAME: f64 = 1e-3;

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
    fn first(&mut self, vector: &[f64]) -> Vec<f64> {
        // the rate of the result has the vector in it
        let once = self.apply(vector);
        self.apply(&once)
    }
    fn obey_constraints(&mut self, vector: &mut [f64]) {
        let (x, rate) = vector.split_at_mut(self.operator.nodes);
        [x, rate].into_iter().for_each(|part| self.operator.obey(part));
    }
}

fn size(Eigenpair { value: [re, im], .. }: &Eigenpair) -> f64 {
    re.hypot(*im)
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
    let (ritz, shift) = near_zero(&mut operator, (&damping, largest), count)?;
    let mut damped = Damped { operator: &mut operator, damping: &damping, shift };
    let mut is_state = vec![false; problem.model.dofs];
    problem.model.state_dofs().for_each(|dof| is_state[dof] = true);
    let (mut modes, mut rigid_shapes) = (Vec::new(), Vec::new());
    for pair in &ritz {
        let vectors = pair.vector.each_ref().map(|part| damped.apply(part));
        let [mut growth, frequency] = value(pair, shift);
        let is_rigid = is_rigid(growth * growth + frequency * frequency, shift * shift, largest);
        let left = left_over(&vectors, pair);
        if !(is_rigid || left <= LEFT) {
            return Err(RunError::Input(format!(
                "a mode is known to a share of {left:.1e} only: masses, stiffnesses or dampings differ by more than the digits of a number hold; \
                 ask for fewer modes"
            )));
        }
        let nodes = damped.operator.nodes;
        let [shape, ahead] = damped.operator.in_coordinates(vectors.map(|vector| vector[..nodes].to_vec()));
        if is_rigid {
            // a motion and its rate are two values 0 with one vector
            if is_motion(&shape, &is_state) && is_new(&mut rigid_shapes, &shape) {
                modes.push(Mode { frequency: 0.0, growth: 0.0, ahead: vec![0.0; shape.len()], shape });
            }
            continue;
        }
        if growth.abs() <= NO_GROWTH * frequency.hypot(growth - shift) {
            growth = 0.0;
        }
        // of a pair the value with a positive imaginary part, and its vector
        let turned = if frequency < 0.0 { ahead.iter().map(|part| -part).collect() } else { ahead };
        modes.push(Mode { frequency: frequency.abs(), growth, shape, ahead: turned });
    }
    let absolute = |mode: &Mode| mode.frequency.hypot(mode.growth);
    modes.sort_by(|a, b| absolute(a).total_cmp(&absolute(b)).then(a.growth.total_cmp(&b.growth)));
    Ok(modes)
}

/// Pairs of the operator with the values nearest to zero, and the shift: of the size of what is sought, as rates are counted by it.
fn near_zero(
    operator: &mut Operator,
    (damping, largest): (&Jacobian, f64),
    count: usize,
) -> Result<(Vec<Eigenpair>, f64), RunError> {
    let mut shift = if largest > 0.0 { FIRST_SHIFT * largest.sqrt() } else { 1.0 };
    for attempt in 1.. {
        operator.set_shift([shift * shift, shift])?;
        let mut ritz = largest_pairs(&mut Damped { operator, damping, shift }, count, SPARE)?;
        let most = ritz.first().map_or(0.0, size);
        // what is not there for want of inertia is infinitely fast
        ritz.retain(|pair| size(pair) > INFINITE * most);
        let values = ritz.iter().map(|pair| value(pair, shift));
        let squares = values.clone().map(|[re, im]| re * re + im * im).filter(|own| !is_rigid(*own, shift * shift, largest));
        let lowest = squares.fold(f64::INFINITY, f64::min).sqrt();
        if (shift <= FAR * lowest && lowest <= FAR * shift) || attempt == MOST_SHIFTS {
            return Ok((ritz, shift));
        }
        // at the shift of a mode that grows the matrix is singular
        let grows = values.clone().any(|[re, im]| re > 0.0 && im.abs() < re);
        shift = match (lowest.is_finite(), grows) {
            // rigid motions hide what is far from the shift
            (false, _) => shift * GROWTH,
            (true, true) => 0.7 * lowest,
            (true, false) => lowest,
        };
    }
    unreachable!("the last attempt returns")
}

/// Whether anything moves but states: one that nothing reads goes on by itself.
fn is_motion(shape: &[f64], is_state: &[bool]) -> bool {
    let moving = shape.iter().zip(is_state).filter(|(_, is_state)| !**is_state).map(|(own, _)| own * own).sum::<f64>();
    moving > SAME * SAME * dot(shape, shape)
}

/// Adds a vector to orthonormal ones unless it depends on them.
fn is_new(known: &mut Vec<Vec<f64>>, vector: &[f64]) -> bool {
    let (mut left, size) = (vector.to_vec(), dot(vector, vector).sqrt());
    for own in &*known {
        let share = dot(own, &left);
        add(&mut left, -share, own);
    }
    let length = dot(&left, &left).sqrt();
    if !(length > SAME * size) {
        return false;
    }
    left.iter_mut().for_each(|entry| *entry /= length);
    known.push(left);
    true
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
