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
//!
//! Of a small model all values are found. Its rigid motions are what x -> (K + s C + s^2 M)^-1 K x takes to zero: each is one mode, whether zero is
//! one value of it or, with a rate that stays, two.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::RunError;
use super::amplitudes::{self, Amplitudes, Pencil};
use super::krylov::{Space, WholeBasis, ZERO, add, all_pairs, dot, in_order, largest_pairs};
use super::mode_vectors::{LEFT, improved};
use super::vibrations::{Mode, Modes, NOISE, Operator, RestingProblem};
use super::whole_basis::Motions;
use crate::assembly::{Equations, Jacobian, Level, StageCoefficients};
use crate::linalg::Eigenpair;
use crate::scalar::Complex64;
use nalgebra::{DMatrix, SVD};

const MOST_SHIFTS: usize = 12;
/// The first shift, as a share of the root of the largest ratio of stiffness and inertia: below most modes, which one far above would not tell apart.
const FIRST_SHIFT: f64 = 1e-7;
/// By how much it grows where rigid motions hide all others.
const GROWTH: f64 = 30.0;
/// A shift this many times smaller or larger than the lowest value that is not zero is chosen anew.
const FAR: f64 = 3.0;
/// By how much lambda may be larger than the shift at which it is found.
const RANGE: f64 = 1e3;
/// Values that are zero of a body that nothing holds: it has six motions, each with a rate that stays.
const FREE: usize = 12;
/// Share of K x in (K + s C + s^2 M) x up to which x may be rigid.
const RIGID: f64 = 1e-3;
const SPARE: usize = 2;
/// Growth and rate of a mode, and the parts of its vector.
type Pair = ([f64; 2], [Vec<f64>; 2]);

/// What the operator may leave of a mode beside theta times itself, where stiff members leave more of the equations of the mode.
const OF_OPERATOR: f64 = 1e-6;
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

/// The modes about an equilibrium with damping and whatever else depends on velocities: the first `count`, fewer where there are no more. One of each
/// conjugate pair is given.
pub(crate) fn complex_modes(resting: RestingProblem, count: usize) -> Result<Modes, RunError> {
    let (mut operator, model) = (Operator::new(resting, count)?, resting.problem.model);
    if operator.nodes == 0 {
        return Ok(Modes { list: Vec::new(), proved: true });
    }
    let largest = operator.largest_ratio();
    let first = if largest > 0.0 { FIRST_SHIFT * largest.sqrt() } else { 1.0 };
    operator.set_shift([first * first, first])?;
    let damping = operator.assembled(&Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity));
    let motions = operator.motions(Some(&damping), 2);
    let stiffness = operator.stiffness();
    let mut search = Search { operator, stiffness, damping, whole: motions.as_ref().map(with_rates), shift: first };
    let mut is_state = vec![false; model.dofs];
    model.state_dofs().for_each(|dof| is_state[dof] = true);
    let mut sought = count + FREE;
    loop {
        let (ritz, shift, matrix) = search.near_zero(sought, first)?;
        let is_all = ritz.len() < sought;
        let (mut list, mut rigid) = (Vec::new(), Vec::new());
        if let (Some(matrix), Some(motions)) = (&matrix, &motions) {
            for shape in search.rigid_shapes(matrix, motions, shift) {
                if is_motion(&shape, &is_state) {
                    list.push(Mode { frequency: 0.0, growth: 0.0, ahead: vec![0.0; shape.len()], shape });
                }
            }
        }
        let placed = match matrix {
            Some(_) => in_order((ritz, shift), (2 * count, RANGE), &place, &mut |shift| Ok(search.pairs(sought, shift)?.0))?,
            None => ritz.into_iter().map(|pair| (pair, shift)).collect(),
        };
        for (pair, shift) in &placed {
            let (mode, is_rigid) = search.mode(pair, *shift)?;
            // a motion and its rate are two values 0 with one vector
            if !is_rigid || matrix.is_none() && is_motion(&mode.shape, &is_state) && is_new(&mut rigid, &mode.shape) {
                list.push(mode);
            }
        }
        if list.len() >= count || is_all || motions.is_some() {
            return Ok(Modes::first(list, count, motions.is_some()));
        }
        sought += count - list.len();
    }
}

/// What modes are ordered by: |lambda|, negative for those that topple.
fn place(pair: &Eigenpair, shift: f64) -> f64 {
    let [re, im] = value(pair, shift);
    if re > 0.0 && im == 0.0 { -re } else { re.hypot(im) }
}

/// Directions of coordinates, and those with inertia once more for their rates.
fn with_rates(Motions { inertial, following }: &Motions) -> WholeBasis {
    let both = |inertial: &Vec<Vec<f64>>, following: &Vec<Vec<f64>>| {
        let zeros = || vec![0.0; inertial.first().or(following.first()).map_or(0, Vec::len)];
        let coordinates = inertial.iter().chain(following).map(|own| [&own[..], &zeros()].concat());
        let rates = inertial.iter().map(|own| [&zeros(), &own[..]].concat());
        coordinates.chain(rates).collect()
    };
    WholeBasis { basis: both(&inertial.basis, &following.basis), dual: both(&inertial.dual, &following.dual) }
}

/// Pairs with the values nearest to zero, the shift, and the operator's matrix in the basis of a small model.
type NearZero = (Vec<Eigenpair>, f64, Option<DMatrix<f64>>);

struct Search<'m> {
    operator: Operator<'m>,
    stiffness: Jacobian,
    damping: Jacobian,
    whole: Option<WholeBasis>,
    shift: f64,
}

impl Search<'_> {
    /// Pairs of the operator with a shift, all with its matrix in the basis of a small model.
    fn pairs(&mut self, sought: usize, shift: f64) -> Result<(Vec<Eigenpair>, Option<DMatrix<f64>>), RunError> {
        self.operator.set_shift([shift * shift, shift])?;
        self.shift = shift;
        let Search { operator, damping, whole, .. } = self;
        let mut damped = Damped { operator, damping, shift };
        if let Some(whole) = whole {
            let (matrix, pairs) = all_pairs(&mut damped, whole)?;
            return Ok((pairs, Some(matrix)));
        }
        let mut ritz = largest_pairs(&mut damped, sought, SPARE)?;
        let most = ritz.first().map_or(0.0, size);
        // what is not there for want of inertia is infinitely fast
        ritz.retain(|pair| size(pair) > ZERO * most);
        Ok((ritz, None))
    }

    /// Those with the values nearest to zero, and the shift: of the size of what is sought, as rates are counted by it.
    fn near_zero(&mut self, sought: usize, first: f64) -> Result<NearZero, RunError> {
        let mut shift = first;
        for attempt in 1.. {
            let (pairs, matrix) = self.pairs(sought, shift)?;
            let values = pairs.iter().map(|pair| value(pair, shift));
            let moving = pairs.iter().filter(|pair| !self.is_zero(pair, shift)).map(|pair| place(pair, shift).abs());
            let lowest = moving.fold(f64::INFINITY, f64::min);
            if (shift <= FAR * lowest && lowest <= FAR * shift) || attempt == MOST_SHIFTS {
                return Ok((pairs, shift, matrix));
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

    /// What x -> (K + s C + s^2 M)^-1 K x = x + s y takes to zero, of the operator's matrix.
    fn rigid_shapes(&mut self, matrix: &DMatrix<f64>, motions: &Motions, shift: f64) -> Vec<Vec<f64>> {
        let Search { operator, stiffness, damping, .. } = self;
        let count = motions.inertial.basis.len() + motions.following.basis.len();
        let own = DMatrix::identity(count, count) + matrix.view((0, 0), (count, count)) * shift;
        let found = SVD::new(own, false, true);
        let Some(vectors) = found.v_t.filter(|_| count > 0) else { return Vec::new() };
        let basis: Vec<&Vec<f64>> = motions.inertial.basis.iter().chain(&motions.following.basis).collect();
        let nodes = operator.nodes;
        let mut damped = Damped { operator, damping, shift };
        let mut shapes = Vec::new();
        for (own, share) in vectors.row_iter().zip(&found.singular_values) {
            let mut both = vec![0.0; 2 * nodes];
            basis.iter().zip(own.iter()).for_each(|(own, share)| add(&mut both[..nodes], *share, own));
            let whole = [damped.apply(&both)[..nodes].to_vec(), vec![0.0; nodes]];
            // at a shift near the lowest value the share of what moves against a force is far from zero
            if *share <= ZERO || *share <= RIGID && damped.operator.is_rigid(stiffness, &whole) {
                shapes.push(damped.operator.in_coordinates(whole)[0].clone());
            }
        }
        shapes
    }

    /// Whether the value of a pair is zero but for round-off of the operator or of the stiffness: |lambda^2 x^H M x| and |lambda x^H C x| are then
    /// round-off of x^H K x.
    fn is_zero(&self, pair: &Eigenpair, shift: f64) -> bool {
        let (size, nodes) = (place(pair, shift).abs(), self.operator.nodes);
        let x = pair.vector.each_ref().map(|part| part[..nodes].to_vec());
        let of = |matrix: &Jacobian| self.operator.along(matrix, &x);
        let round_off = NOISE * of(&self.stiffness)[1];
        let is_round_off = size * size * of(&self.operator.mass)[0] <= round_off && size * of(&self.damping)[0] <= round_off;
        size * size <= ZERO * shift * shift || is_round_off
    }

    fn mode(&mut self, pair: &Eigenpair, shift: f64) -> Result<(Mode, bool), RunError> {
        if shift != self.shift {
            self.operator.set_shift([shift * shift, shift])?;
            self.shift = shift;
        }
        let is_rigid = self.is_zero(pair, shift);
        let Search { operator, damping, .. } = self;
        let [mut growth, mut frequency] = value(pair, shift);
        let nodes = operator.nodes;
        let mut damped = Damped { operator, damping, shift };
        let applied = pair.vector.each_ref().map(|part| damped.apply(part));
        let mut vectors = pair.vector.each_ref().map(|part| part[..nodes].to_vec());
        // beside what is much slower the operator leaves few digits to a mode, which has them by its own equations
        let left = left_over(&applied, pair);
        if !is_rigid && !(left <= LEFT) {
            match self.refined([growth, frequency], &vectors)? {
                Ok((value, refined)) => ([growth, frequency], vectors) = (value, refined),
                Err(_) if left <= OF_OPERATOR => {}
                Err(left) => {
                    return Err(RunError::Input(format!(
                        "a mode is known to a share of {left:.1e} only: masses, stiffnesses or dampings differ by more than the digits of a number \
                         hold; ask for fewer modes"
                    )));
                }
            }
        }
        let [shape, ahead] = self.operator.in_coordinates(vectors);
        if is_rigid {
            return Ok((Mode { frequency: 0.0, growth: 0.0, ahead: vec![0.0; shape.len()], shape }, true));
        }
        if growth.abs() <= NO_GROWTH * frequency.hypot(growth - shift) {
            growth = 0.0;
        }
        // of a pair the value with a positive imaginary part, and its vector
        let turned = if frequency < 0.0 { ahead.iter().map(|part| -part).collect() } else { ahead };
        Ok((Mode { frequency: frequency.abs(), growth, shape, ahead: turned }, false))
    }

    /// A value and the vector of its mode by (lambda^2 M + lambda C + K) x + A^T nu = 0, from those that the operator gave; or the share of its terms
    /// that is left, where it is more than round-off.
    fn refined(&self, [growth, frequency]: [f64; 2], [re, im]: &[Vec<f64>; 2]) -> Result<Result<Pair, f64>, RunError> {
        let Search { operator, stiffness, damping, .. } = self;
        let (system, nodes) = (&operator.newton.system, operator.nodes);
        let pencil = Pencil::new(system, nodes, [stiffness, &operator.mass], Some(damping));
        let amplitudes = Amplitudes::new(&pencil, true).map_err(|singular| RunError::of_pattern("modes", singular))?;
        let mut vector: Vec<Complex64> = re.iter().zip(im).map(|(&re, &im)| Complex64::new(re, im)).collect();
        vector.resize(pencil.size, Complex64::ZERO);
        let known = (Complex64::new(growth, frequency), vector);
        let (value, vector) = improved(&mut amplitudes.beside_modes(), &pencil, known);
        let nothing = vec![Complex64::ZERO; pencil.size];
        let left = amplitudes::left_over(&pencil, value, (&vector, &nothing), false);
        if !(left <= LEFT) {
            return Ok(Err(left));
        }
        let part = |part: fn(&Complex64) -> f64| vector[..nodes].iter().map(part).collect();
        Ok(Ok(([value.re, value.im], [part(|own| own.re), part(|own| own.im)])))
    }
}

/// Whether anything moves but states: one that nothing reads goes on by itself.
fn is_motion(shape: &[f64], is_state: &[bool]) -> bool {
    let moving = shape.iter().zip(is_state).filter(|(_, is_state)| !**is_state).map(|(own, _)| own * own).sum::<f64>();
    moving > SAME * SAME * dot(shape, shape)
}

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
