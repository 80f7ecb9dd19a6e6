use super::hermite::{COMPONENTS, NODES, STRAINS_AT_THREE, THREE_WEIGHTS};
use crate::elements::{Field, Flexible, Interpolation, Parameter, State};
use crate::scalar::{Dual, Scalar, Vec3};
use std::ops::Range;

/// Cable-beam of two nodes with position r and slope r_x = dr/dx, in space, without torsion and shear: absolute nodal coordinates
/// with the exact curvature.
///
/// r is a cubic of the reference length x, straight in the reference, and
///
/// V = integral of EA/2 eps^2 + EI/2 kappa^2 dx,   eps = (r_x . r_x - 1) / 2,   kappa = |r_x x r_xx| / |r_x|^3,
///
/// with the same EI about every axis at right angles to the cable. Three Gauss points: the fewest without a mode of no energy; with more,
/// stretching that bending brings with it and a cubic cannot avoid makes coarse elements too stiff (locking).
///
/// Damping proportional to stiffness adds the axial force eta EA deps/dt and, with the curvature vector k = r_x x r_xx / |r_x|^3, the
/// moment eta EI (k (k . dk/dt) + delta^2 dk/dt) / (k . k + delta^2): for kappa well above delta the rate of kappa alone, which a rigid
/// motion leaves zero; below it, where a direction is not defined, the rate of k, with delta = 1 / (1000 l).
///
/// * `length`  l of the element [m], greater than 0
/// * `axial stiffness`  EA [N], 0 or greater
/// * `bending stiffness`  EI [N m2], 0 or greater
/// * `damping`  eta [s], with [`damped`](CableField::damped)
///
/// Source: Ebrahimi et al., eqs. (28), (29), (31), (32); Gerstmayr & Shabana (2006).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CableField {
    /// With damping proportional to stiffness.
    pub damped: bool,
}

/// The cable as an element.
pub type Cable = Flexible<CableField>;

/// Curvature below which damping does not tell its direction, times the length of the element.
const STRAIGHT: f64 = 1e-3;

/// The parameters of both cables.
pub(super) fn cable_parameters(damped: bool) -> Vec<Parameter> {
    let mut list = vec![
        Parameter::positive("length", "m"),
        Parameter::non_negative("axial stiffness", "N"),
        Parameter::non_negative("bending stiffness", "N m2"),
    ];
    if damped {
        list.push(Parameter::non_negative("damping", "s"));
    }
    list
}

/// r_x and r_xx from h = (shares of positions and of slopes in the first derivative, the same in the second).
#[inline(always)]
fn derivatives<S: Scalar>(h: &[S], length: S) -> [Vec3<S>; 2] {
    let inverse = length.recip();
    let first = Vec3::from_slice(h) * inverse + Vec3::from_slice(&h[3..]);
    let second = (Vec3::from_slice(&h[6..]) * inverse + Vec3::from_slice(&h[9..])) * inverse;
    [first, second]
}

/// eps.
#[inline(always)]
pub fn green_strain<S: Scalar>(first: Vec3<S>) -> S {
    (first.dot(first) - 1.0) * 0.5
}

/// kappa^2 [1/m2].
#[inline(always)]
pub fn square_of_curvature<S: Scalar>(first: Vec3<S>, second: Vec3<S>) -> S {
    let (normal, square) = (first.cross(second), first.dot(first));
    normal.dot(normal) / (square * square * square)
}

/// Adds what forces conjugate to r_x and r_xx do to h.
#[inline(always)]
fn add_conjugate<S: Scalar>([of_first, of_second]: [Vec3<S>; 2], length: S, r: &mut [S]) {
    let inverse = length.recip();
    for i in 0..3 {
        let second = of_second.0[i] * inverse;
        r[i] += of_first.0[i] * inverse;
        r[3 + i] += of_first.0[i];
        r[6 + i] += second * inverse;
        r[9 + i] += second;
    }
}

impl CableField {
    /// Adds the damping forces at a point of weight `weight` [m]: with a and b for r_x and r_xx, B^T of the stresses above.
    #[inline(always)]
    fn add_damping<S: Scalar>(v: &[S], h: &[S], p: &[S], weight: S, r: &mut [S]) {
        let ([a, b], [a_rate, b_rate]) = (derivatives(h, p[0]), derivatives(v, p[0]));
        let moving = |x: Vec3<S>, rate: Vec3<S>| -> Vec3<Dual<S, 1>> {
            Vec3([0, 1, 2].map(|i| Dual { re: x.0[i], eps: [rate.0[i]] }))
        };
        let (first, second) = (moving(a, a_rate), moving(b, b_rate));
        let square = first.dot(first);
        let scale = (square * square.sqrt()).recip();
        let curvature = first.cross(second) * scale;
        let (k, k_rate) = (Vec3(curvature.0.map(|x| x.re)), Vec3(curvature.0.map(|x| x.eps[0])));
        let limit = (p[0].recip() * STRAIGHT) * (p[0].recip() * STRAIGHT);
        let direct = (k * k.dot(k_rate) + k_rate * limit) * (k.dot(k) + limit).recip();
        let (tension, moment) = (a.dot(a_rate) * p[1] * p[3] * weight, direct * (p[2] * p[3] * weight));
        // m . k is linear in b: m . (a x b) / |a|^3
        let scale = scale.re;
        let along = moment.dot(k) * 3.0 / a.dot(a);
        let of_first = a * tension + b.cross(moment) * scale - a * along;
        add_conjugate([of_first, moment.cross(a) * scale], p[0], r);
    }
}

impl Field for CableField {
    const NODES: usize = NODES;
    const COMPONENTS: usize = COMPONENTS;
    const POINTS: &'static [&'static [Interpolation]] = &[&STRAINS_AT_THREE[0], &STRAINS_AT_THREE[1], &STRAINS_AT_THREE[2]];
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        cable_parameters(self.damped)
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..if self.damped { 4 } else { 3 }
    }
    fn reads(&self, _point: usize, _number: usize) -> [bool; 3] {
        [false, self.damped, true]
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, point: usize, h: &[S], p: &[S]) -> S {
        let [first, second] = derivatives(h, p[0]);
        let strain = green_strain(first);
        let twice = strain * strain * p[1] + square_of_curvature(first, second) * p[2];
        twice * p[0] * (0.5 * THREE_WEIGHTS[point])
    }
    fn add_force<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S], _t: S, force: &mut [S]) {
        if self.damped {
            Self::add_damping(v, h, p, p[0] * -THREE_WEIGHTS[point], force);
        }
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, point: usize, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let [a, b] = derivatives(s.q, p[0]);
        let weight = p[0] * THREE_WEIGHTS[point];
        let (square, normal) = (a.dot(a), a.cross(b));
        let inverse = square.recip();
        let cube = inverse * inverse * inverse;
        let (axial, bending) = (weight * p[1] * green_strain(a), weight * p[2] * cube);
        // gradients of |a x b|^2 / 2: b x n and n x a
        let along = normal.dot(normal) * inverse * 3.0;
        let of_first = a * axial + (b.cross(normal) - a * along) * bending;
        add_conjugate([of_first, normal.cross(a) * bending], p[0], r);
        if self.damped {
            Self::add_damping(s.v, s.q, p, weight, r);
        }
    }
}
