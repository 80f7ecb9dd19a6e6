// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::CableInertia;
use super::hermite::{CURVATURES_AT_THREE, NODES, SLOPES_AT_THREE, THREE_WEIGHTS};
use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Cable-beam of two nodes with position r and slope r_x = dr/dx, in space, without torsion and shear: absolute nodal coordinates
/// with the exact curvature, inertia and weight.
///
/// r is a cubic of the reference length x, straight in the reference, and
///
/// V = integral of EA/2 eps^2 + EI/2 kappa^2 - m g . r dx,   eps = (r_x . r_x - 1) / 2,   kappa = |r_x x r_xx| / |r_x|^3,
///
/// with the same EI about every axis at right angles to the cable. Three Gauss points for eps and kappa: the fewest without a mode of no
/// energy; with more, stretching that bending brings with it and a cubic cannot avoid makes coarse elements too stiff (locking). Inertia and
/// weight are integrated exactly: M (d2q/dt2 - g) with the constant matrix of [`CableInertia`](super::CableInertia) and the coordinates g of
/// a uniform acceleration.
///
/// Damping proportional to stiffness adds the axial force eta EA deps/dt and, with the curvature vector k = r_x x r_xx / |r_x|^3, the
/// moment eta EI (k (k . dk/dt) + delta^2 dk/dt) / (k . k + delta^2): for kappa well above delta the rate of kappa alone, which a rigid
/// motion leaves zero; below it, where a direction is not defined, the rate of k, with delta = 1 / (1000 l).
///
/// * `length`  l of the element \[m\], greater than 0
/// * `axial stiffness`  EA \[N\], 0 or greater
/// * `bending stiffness`  EI [N m2], 0 or greater
/// * `mass`  m, for each length [kg/m], greater than 0
/// * `gravity x, y, z`  g [m/s2]
/// * `damping`  eta \[s\], with [`damped`](Cable::damped)
///
/// Source: Ebrahimi et al., eqs. (28) to (32), (35), (58); Gerstmayr & Shabana (2006).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Cable {
    /// With damping proportional to stiffness.
    pub damped: bool,
}

/// Curvature below which damping does not tell its direction, times the length of the element.
const STRAIGHT: f64 = 1e-3;

/// Places of parameters.
pub(super) const LENGTH: usize = 0;
pub(super) const AXIAL: usize = 1;
pub(super) const BENDING: usize = 2;
pub(super) const MASS: usize = 3;
/// The first component of gravity.
pub(crate) const GRAVITY: usize = 4;
const DAMPING: usize = 7;

/// Length and stiffnesses, of any cable.
pub(super) fn elastic_parameters() -> Vec<Parameter> {
    vec![
        Parameter::positive("length", "m"),
        Parameter::non_negative("axial stiffness", "N").as_size(),
        Parameter::non_negative("bending stiffness", "N m2").as_size(),
    ]
}

/// eps.
#[inline(always)]
pub fn green_strain<S: Scalar>(first: Vector3<S>) -> S {
    (first.dot(&first) - 1.0) * 0.5
}

/// kappa^2 [1/m2].
#[inline(always)]
pub fn square_of_curvature<S: Scalar>(first: Vector3<S>, second: Vector3<S>) -> S {
    let (normal, square) = (first.cross(&second), first.dot(&first));
    normal.dot(&normal) / (square * square * square)
}

/// What the line's derivatives are made of: the chord (r_2 - r_1) / l and the slopes at both ends.
pub(super) type Line<S> = [Vector3<S>; 3];

/// Weights of chord and slopes in r_x and in l r_xx at each Gauss point.
pub(super) const WEIGHTS: [[[f64; 3]; 2]; 3] = {
    let mut weights = [[[0.0; 3]; 2]; 3];
    let mut point = 0;
    while point < 3 {
        let [[_, chord], [first, second]] = SLOPES_AT_THREE[point];
        weights[point][0] = [chord, first, second];
        let [[_, chord], [first, second]] = CURVATURES_AT_THREE[point];
        weights[point][1] = [chord, first, second];
        point += 1;
    }
    weights
};

/// Chord and slopes of coordinates or their rates, from the inverse of the length.
#[inline(always)]
pub(super) fn line<S: Scalar>(q: &[S], inverse: S) -> Line<S> {
    let vector = |place: usize| Vector3::first_three(&q[3 * place..]);
    [(vector(2) - vector(0)) * inverse, vector(1), vector(3)]
}

/// r_x and r_xx at a Gauss point.
#[inline(always)]
pub(super) fn derivatives<S: Scalar>(line: &Line<S>, point: usize, inverse: S) -> [Vector3<S>; 2] {
    let [chord, first, second] = *line;
    let sum = |i: usize, [a, b, c]: [f64; 3]| chord[i] * a + first[i] * b + second[i] * c;
    let vector = |weights: [f64; 3]| Vector3::new(sum(0, weights), sum(1, weights), sum(2, weights));
    [vector(WEIGHTS[point][0]), vector(WEIGHTS[point][1]) * inverse]
}

impl Cable {
    fn strains_at_a_point(&self) -> usize {
        if self.damped { 4 } else { 1 }
    }
}

impl Element for Cable {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Slope; NODES]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = elastic_parameters();
        list.push(Parameter::positive("mass", "kg/m"));
        list.extend(["gravity x", "gravity y", "gravity z"].map(|name| Parameter::new(name, "m/s2")));
        if self.damped {
            list.push(Parameter::non_negative("damping", "s"));
        }
        list
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        CableInertia.kinetic(v, q, &[p[LENGTH], p[MASS]])
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        // the integral of r: that of a cubic
        let vector = |place: usize| Vector3::first_three(&q[3 * place..]);
        let middle = (vector(0) + vector(2)) * S::from(0.5) + (vector(1) - vector(3)) * (p[LENGTH] / 12.0);
        -p[LENGTH] * p[MASS] * middle.dot(&Vector3::first_three(&p[GRAVITY..]))
    }
    #[inline(always)]
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let inverse = p[LENGTH].recip();
        let own = line(q, inverse);
        let mut energy = S::zero();
        for point in 0..3 {
            let [first, second] = derivatives(&own, point, inverse);
            energy += square_of_curvature(first, second) * p[BENDING] * p[LENGTH] * (0.5 * THREE_WEIGHTS[point]);
        }
        energy
    }
    fn strain_count(&self) -> usize {
        3 * self.strains_at_a_point()
    }
    /// At each Gauss point eps, and with damping the curvature vector k: what stores energy in bending is smooth without its root.
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        let inverse = p[LENGTH].recip();
        let own = line(q, inverse);
        for (point, e) in e.chunks_exact_mut(self.strains_at_a_point()).enumerate() {
            let [first, second] = derivatives(&own, point, inverse);
            e[0] = green_strain(first);
            if self.damped {
                let square = first.dot(&first);
                let curvature = first.cross(&second) * (square * square.sqrt()).recip();
                e[1..].copy_from_slice(&curvature.components());
            }
        }
    }
    #[inline(always)]
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let mut energy = S::zero();
        for (e, weight) in e.chunks_exact(self.strains_at_a_point()).zip(THREE_WEIGHTS) {
            energy += e[0] * e[0] * p[AXIAL] * p[LENGTH] * (0.5 * weight);
        }
        energy
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        let inverse = p[LENGTH].recip();
        let limit = (inverse * STRAIGHT) * (inverse * STRAIGHT);
        for (point, s) in s.chunks_exact_mut(4).enumerate() {
            let (e, rate) = (&e[4 * point..], &rate[4 * point..]);
            let share = p[DAMPING] * p[LENGTH] * THREE_WEIGHTS[point];
            let (k, k_rate) = (Vector3::first_three(&e[1..]), Vector3::first_three(&rate[1..]));
            let direct = (k * k.dot(&k_rate) + k_rate * limit) * (k.dot(&k) + limit).recip();
            s[0] = rate[0] * p[AXIAL] * share;
            s[1..].copy_from_slice(&(direct * (p[BENDING] * share)).components());
        }
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[LENGTH] * p[MASS]
    }
}
