//! Right and left vectors of modes that are known by their values, with the multipliers of all constraints: what derivatives of the values need.
//!
//! With P(lambda) = lambda^2 M + lambda C + K and the constraints, P z = 0 and P^T w = 0. Iterations z <- P^-1 P' z and w <- P^-T P'^T w beside
//! lambda, for all modes of one value together, leave nothing but these: each makes what else is there smaller by the distance from lambda, as a
//! share of the distance of the next mode.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::RunError;
use super::amplitudes::{Amplitudes, Pencil, left_over};
use super::krylov::noise;
use super::vibrations::{Mode, Operator, RestingProblem};
use crate::assembly::{Equations, Jacobian, Level, Residual, StageCoefficients, System, Unknowns};
use crate::scalar::Complex64;
use nalgebra::DMatrix;

const PLACE: &str = "derivatives of modes";
/// Shift at which the equilibrium is looked for where something moves freely, as a share of the lowest omega^2 that is not zero.
pub(crate) const SHIFT: f64 = 1e-4;
/// Values that differ by this share of their size are the same.
pub(crate) const SAME: f64 = 1e-8;
/// Distances from the value at which its vectors are sought, as shares of it: the first at which the matrix has factors.
const BESIDE: [f64; 3] = [1e-10, 1e-8, 1e-6];
const MOST_ITERATIONS: usize = 12;
/// What vectors may leave of their equations, by the largest term, ...
pub(super) const LEFT: f64 = 1e-9;
/// ... and what is round-off.
const ROUND_OFF: f64 = 1e-15;
/// By how much of itself a known value may be improved.
const WANDERED: f64 = 1e-2;
/// Iterations of one more vector, ...
const CHECKS: usize = 3;
/// ... and how much of it may lie outside of those of the known modes.
const MISSING: f64 = 1e-3;

/// A vector of the system: coordinates of the model, multipliers of its constraints, those inside nodes last.
#[derive(Clone, Debug)]
pub(crate) struct Amplitude {
    pub x: Vec<Complex64>,
    pub mu: Vec<Complex64>,
}

pub(crate) struct ModeGroup {
    pub modes: Vec<usize>,
    pub lambda: Complex64,
    /// As many vectors z as modes.
    pub right: Vec<Amplitude>,
    /// As many w.
    pub left: Vec<Amplitude>,
    /// w_i^T P' z_j.
    pub slope: DMatrix<Complex64>,
}

/// Vectors of modes about an equilibrium, in a system in which constraints inside nodes are such as others.
pub(crate) struct ModeVectors {
    pub q: Vec<f64>,
    /// Its reactions, without displacements.
    pub reactions: Unknowns<f64>,
    pub groups: Vec<ModeGroup>,
}

pub(crate) fn value_of(mode: &Mode) -> Complex64 {
    Complex64::new(mode.growth, mode.frequency)
}

/// Modes of one value, the groups that have one of the first `asked` alone; rigid motions are in none.
fn grouped(modes: &[Mode], asked: usize) -> Vec<(Complex64, Vec<usize>)> {
    let mut groups: Vec<(Complex64, Vec<usize>)> = Vec::new();
    for (place, mode) in modes.iter().enumerate() {
        let lambda = value_of(mode);
        if lambda == Complex64::ZERO {
            continue;
        }
        match groups.iter_mut().find(|(own, _)| (lambda - *own).norm() <= SAME * own.norm()) {
            Some((_, members)) => members.push(place),
            None => groups.push((lambda, vec![place])),
        }
    }
    groups.retain(|(_, members)| members[0] < asked);
    groups
}

/// Whether another mode, which would be behind the last one, could have the value of one of the first `asked`.
pub(crate) fn is_cut(modes: &[Mode], asked: usize) -> bool {
    let last = modes.len().saturating_sub(1);
    grouped(modes, asked).iter().any(|(_, members)| members.contains(&last))
}

/// Vectors of the first `asked` modes about an equilibrium, with all that have the value of one of them: modes of
/// [`vibrations`](super::vibrations()), or of [`complex_modes`](super::complex_modes()) with damping.
pub(crate) fn mode_vectors(
    resting: RestingProblem,
    (modes, asked): (&[Mode], usize),
    is_damped: bool,
) -> Result<ModeVectors, RunError> {
    let method = resting.method.unreduced();
    let mut operator = Operator::new(RestingProblem { method: &method, ..resting }, modes.len().max(1))?;
    let found = grouped(modes, asked);
    let lowest = found.iter().map(|(lambda, _)| lambda.norm_sqr()).fold(f64::INFINITY, f64::min);
    let shift = if lowest.is_finite() { SHIFT * lowest } else { 1.0 };
    // states that integrate what moves have a place in C alone
    operator.set_shift([shift, if is_damped { shift.sqrt() } else { 0.0 }])?;
    let stiffness = operator.stiffness();
    let damping =
        is_damped.then(|| operator.assembled(&Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity)));
    let system = operator.newton.system.clone();
    let pencil = Pencil::new(&system, operator.nodes, [&stiffness, &operator.mass], damping.as_ref());
    let turns = found.iter().any(|(lambda, _)| lambda.re != 0.0 && lambda.im != 0.0);
    let amplitudes = Amplitudes::new(&pencil, turns).map_err(|singular| RunError::of_pattern(PLACE, singular))?;
    let mut amplitudes = amplitudes.beside_modes();
    let mut groups = Vec::new();
    for (mut lambda, members) in found {
        // the value of a list is as good as the search for many of them at once
        if members.len() == 1 {
            let any = (0..pencil.size).map(|i| noise(i, 0).into()).collect();
            lambda = improved(&mut amplitudes, &pencil, (lambda, any)).0;
        }
        let [right, left] = vectors(&mut amplitudes, &pencil, lambda, members.len())?;
        let slopes: Vec<Vec<Complex64>> = right.iter().map(|own| pencil.slope(lambda, own, false)).collect();
        let slope = DMatrix::from_fn(members.len(), members.len(), |i, j| dot(&left[i], &slopes[j]));
        let whole = |list: Vec<Vec<Complex64>>| list.iter().map(|own| amplitude(&system, &stiffness, own)).collect();
        groups.push(ModeGroup { modes: members, lambda, right: whole(right), left: whole(left), slope });
    }
    Ok(ModeVectors { q: operator.base.q, reactions: operator.reactions, groups })
}

/// The value of a mode near one that is known, with its vector, by inverse iteration from any vector with shift s: P(s)^-1 P' z = z / (s - lambda).
pub(super) fn improved(
    amplitudes: &mut Amplitudes,
    pencil: &Pencil,
    (lambda, vector): (Complex64, Vec<Complex64>),
) -> (Complex64, Vec<Complex64>) {
    let mut value = lambda;
    let mut own = vec![vector];
    for _ in 0..MOST_ITERATIONS {
        let shift = value * (1.0 + BESIDE[0]);
        if amplitudes.set(shift).is_err() {
            break;
        }
        // the first brings a vector, the second its value
        let mut share = Complex64::ZERO;
        for _ in 0..2 {
            orthonormalize(&mut own);
            let next = amplitudes.solve(&pencil.slope(shift, &own[0], false));
            share = own[0].iter().zip(&next).map(|(own, next)| own.conj() * next).sum();
            own[0] = next;
        }
        let mut next = shift - share.inv();
        // along the real axis the matrix of an undamped mode would get another structure
        next.re *= f64::from(u8::from(lambda.re != 0.0));
        next.im *= f64::from(u8::from(lambda.im != 0.0));
        // another mode is none of this one's
        if !((next - lambda).norm() <= WANDERED * lambda.norm()) {
            break;
        }
        let is_settled = (next - value).norm() <= BESIDE[0] * value.norm();
        value = next;
        if is_settled {
            break;
        }
    }
    orthonormalize(&mut own);
    (value, own.swap_remove(0))
}

fn vectors(
    amplitudes: &mut Amplitudes,
    pencil: &Pencil,
    lambda: Complex64,
    count: usize,
) -> Result<[Vec<Vec<Complex64>>; 2], RunError> {
    let unsettled = || {
        RunError::Input(format!(
            "{PLACE}: the vectors of the mode at {:.6e} rad/s do not settle: masses, stiffnesses or dampings differ by more than the digits of a number \
             hold",
            lambda.norm()
        ))
    };
    let missing = || {
        RunError::Input(format!(
            "{PLACE}: more modes than were found have the value at {:.6e} rad/s: ask for more modes",
            lambda.norm()
        ))
    };
    // along the real axis the matrix of an undamped mode would get another structure
    let beside = BESIDE.iter().map(|share| lambda * (1.0 + share)).find(|beside| amplitudes.set(*beside).is_ok());
    let beside = beside.ok_or_else(unsettled)?;
    let mut of_side = |transposed: bool| {
        let start = |k: usize| (0..pencil.size).map(|i| noise(i, k).into()).collect::<Vec<Complex64>>();
        let mut vectors: Vec<Vec<Complex64>> = (0..count).map(start).collect();
        let (mut before, mut own) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            for vector in &mut vectors {
                let rhs = pencil.slope(beside, vector, transposed);
                *vector = if transposed { amplitudes.solve_transposed(&rhs) } else { amplitudes.solve(&rhs) };
            }
            orthonormalize(&mut vectors);
            let nothing = vec![Complex64::ZERO; pencil.size];
            let left = vectors.iter().map(|own| left_over(pencil, lambda, (own, &nothing), transposed));
            own = left.fold(0.0, |most: f64, left| if left > most || left.is_nan() { left } else { most });
            if own <= ROUND_OFF || !(own < 0.5 * before) {
                break;
            }
            before = own;
        }
        if !(own.min(before) <= LEFT) {
            return Err(unsettled());
        }
        // one more that does not lie in them has the same value: the modes were not all known
        let mut other = start(count);
        for _ in 0..CHECKS {
            let rhs = pencil.slope(beside, &other, transposed);
            other = if transposed { amplitudes.solve_transposed(&rhs) } else { amplitudes.solve(&rhs) };
            orthonormalize(std::slice::from_mut(&mut other));
        }
        for known in &vectors {
            subtract_share(&mut other, known);
        }
        let is_missing = other.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt() > MISSING;
        if is_missing { Err(missing()) } else { Ok(vectors) }
    };
    Ok([of_side(false)?, of_side(true)?])
}

fn dot(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Subtracts what a vector has along another one of length 1.
fn subtract_share(own: &mut [Complex64], known: &[Complex64]) {
    let share: Complex64 = known.iter().zip(&*own).map(|(known, own)| known.conj() * own).sum();
    own.iter_mut().zip(known).for_each(|(own, known)| *own -= share * *known);
}

/// Makes vectors such that a^H b = 0 and a^H a = 1.
fn orthonormalize(vectors: &mut [Vec<Complex64>]) {
    for k in 0..vectors.len() {
        let (known, rest) = vectors.split_at_mut(k);
        let own = &mut rest[0];
        for known in known {
            subtract_share(own, known);
        }
        let size = own.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
        own.iter_mut().for_each(|own| *own /= size);
    }
}

fn amplitude(system: &System, matrix: &Jacobian, own: &[Complex64]) -> Amplitude {
    let scales = vec![1.0; system.model.dofs];
    let part = |part: fn(&Complex64) -> f64| {
        let mut unknowns = Residual::<f64>::unknowns(system);
        matrix.add_step(system, &own.iter().map(part).collect::<Vec<f64>>(), None, &mut unknowns, &scales);
        unknowns
    };
    let (re, im) = (part(|own| own.re), part(|own| own.im));
    let joined = |re: &[f64], im: &[f64]| re.iter().zip(im).map(|(&re, &im)| Complex64::new(re, im)).collect();
    Amplitude { x: joined(&re.x, &im.x), mu: joined(&re.mu, &im.mu) }
}
