//! A beam and a joint as a user writes them: through the public traits, with parameters in an order of their own, so that nothing of the
//! library's recordings and programs serves them.

use costate::elements::{Constraint, Field, Frame, Interpolation, NodeKind, Parameter};
use costate::internals::{AT_GAUSS_POINTS, AT_TYING_POINTS, tensor_times};
use costate::prelude::{Quaternion, Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// Number of points at which strains are taken.
const TYING_POINTS: usize = 2;
/// Mass, first moment and inertia of each Gauss point: they come first here.
const INERTIA: usize = 10;
/// Metric, two axes and six stiffnesses of each tying point.
const STIFFNESS: usize = 13;

/// Geometrically exact beam of three nodes with a symmetric section of six stiffnesses.
///
/// gamma = Lambda^T R^T dr/dS - (1, 0, 0),   kappa = Lambda^T 2 G(e) de/dS / |e|^2
#[derive(Hash)]
pub struct UserBeam;

impl UserBeam {
    fn components<S: Scalar>(p: &[S], x: Vector3<S>) -> [S; 3] {
        let (tangent, second) = (Vector3::first_three(&p[1..]), Vector3::first_three(&p[4..]));
        [tangent.dot(&x), second.dot(&x), tangent.cross(&second).dot(&x)]
    }
}

impl Field for UserBeam {
    const NODES: usize = 3;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] =
        &[&AT_TYING_POINTS[0], &AT_TYING_POINTS[1], &AT_GAUSS_POINTS[0], &AT_GAUSS_POINTS[1], &AT_GAUSS_POINTS[2]];

    fn parameters(&self) -> Vec<Parameter> {
        (0..3 * INERTIA + TYING_POINTS * STIFFNESS).map(|i| Parameter::named(format!("number {i}"), "SI")).collect()
    }
    fn parameters_of(&self, point: usize) -> Range<usize> {
        let (first, count) = match point.checked_sub(TYING_POINTS) {
            Some(gauss) => (gauss * INERTIA, INERTIA),
            None => (3 * INERTIA + point * STIFFNESS, STIFFNESS),
        };
        first..first + count
    }
    fn kinetic<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S]) -> S {
        if point < TYING_POINTS {
            return S::from(0.0);
        }
        let (e, rate) = (Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&v[3..]));
        let inverse = e.norm_squared().recip();
        let (velocity, omega) = (Vector3::first_three(v), e.g_times(rate) * (inverse + inverse));
        (velocity.dot(&velocity) * p[0] + omega.dot(&tensor_times(&p[4..], omega))) * 0.5
    }
    fn strain_count(&self, point: usize) -> usize {
        if point < TYING_POINTS { 6 } else { 0 }
    }
    fn strains<S: Scalar>(&self, _point: usize, h: &[S], p: &[S], strains: &mut [S]) {
        let (slope, e, turn) = (Vector3::first_three(h), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&h[7..]));
        let scale = (e.norm_squared() * p[0]).recip();
        strains[..3].copy_from_slice(&Self::components(p, e.rotate_back(slope) * scale));
        strains[3..].copy_from_slice(&Self::components(p, e.g_times(turn) * (scale + scale)));
        strains[0] = strains[0] - 1.0;
    }
    fn stored<S: Scalar>(&self, _point: usize, strains: &[S], p: &[S]) -> S {
        let twice: S = strains.iter().zip(&p[7..]).map(|(&strain, &stiffness)| strain * (strain * stiffness)).sum();
        twice * p[0] * 0.5
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0] + p[INERTIA] + p[2 * INERTIA]
    }
}

/// A hinge between two bodies: g = (x_b - x_a, u_a . n_b, w_a . n_b).
#[derive(Hash)]
pub struct UserRevolute;

impl Constraint for UserRevolute {
    const EQUATIONS: usize = 5;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body; 2]
    }
    fn parameters(&self) -> Vec<Parameter> {
        ["axis", "normal u", "normal w", "point a", "point b"]
            .into_iter()
            .flat_map(|vector| ["x", "y", "z"].map(|axis| Parameter::named(format!("{vector} {axis}"), "m, -")))
            .collect()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair([NodeKind::Body; 2], q);
        let axis = b.direction(p);
        g[..3].copy_from_slice(&(b.point(&p[12..]) - a.point(&p[9..])).components());
        g[3] = a.direction(&p[3..]).dot(&axis);
        g[4] = a.direction(&p[6..]).dot(&axis);
    }
}
