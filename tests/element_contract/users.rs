//! Elements as users write them: with a residual, with energies, with both, with choices, with points of interpolated fields.

use super::cases::Case;
use costate::elements::{Element, Field, Flexible, Interpolation, NodeKind, Parameter, State};
use costate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// m a + c v + k q + k3 q^3 = load sin(omega t), written out.
#[derive(Hash)]
struct Duffing;

impl Element for Duffing {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::positive("mass", "kg"),
        Parameter::new("damping", "N s/m"),
        Parameter::new("stiffness", "N/m"),
        Parameter::new("cubic stiffness", "N/m3"),
        Parameter::new("load", "N"),
        Parameter::new("angular frequency", "rad/s"),
    ];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let q = s.q[0];
        r[0] += p[0] * s.a[0] + p[1] * s.v[0] + p[2] * q + p[3] * q * q * q - p[4] * (p[5] * t).sin();
    }
}

/// A bead on the parabola y = c x^2 under its weight: T = m (1 + 4 c^2 x^2) v^2 / 2.
#[derive(Hash)]
struct Bead;

impl Element for Bead {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::positive("mass", "kg"), Parameter::new("shape", "1/m"), Parameter::new("gravity", "m/s2")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let slope = p[1] * q[0] * 2.0;
        p[0] * (slope * slope + 1.0) * v[0] * v[0] * 0.5
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        p[0] * p[2] * p[1] * q[0] * q[0]
    }
}

/// The same bead, its residual written beside its energies.
#[derive(Hash)]
struct WrittenBead;

impl Element for WrittenBead {
    const PARAMETERS: &'static [Parameter] = Bead::PARAMETERS;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        Bead.kinetic(v, q, p)
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        Bead.potential(q, p)
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let (x, c) = (s.q[0], p[1]);
        let inertia = (c * c * x * x * 4.0 + 1.0) * s.a[0] + c * c * x * s.v[0] * s.v[0] * 4.0;
        r[0] += p[0] * (inertia + p[2] * c * x * 2.0);
    }
}

/// A ball above a floor that pushes where it is touched, and whose damper acts there alone; friction follows the sign of the velocity.
#[derive(Hash)]
struct Floor;

impl Element for Floor {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("stiffness", "N/m1.5"),
        Parameter::new("damping", "N s/m"),
        Parameter::new("friction", "1"),
        Parameter::new("height", "m"),
    ];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(2)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let depth = p[3] - s.q[1];
        let touches = S::zero().less(depth);
        // a root of what is not there is not a number, and leaves no trace
        let push = touches.select(p[0] * depth * depth.sqrt() - p[1] * s.v[1], S::zero());
        r[1] -= push;
        r[0] += p[2] * push.max(S::zero()) * s.v[0].sign();
    }
}

/// Two point masses on a strain that is written with its energy and damper.
#[derive(Hash)]
struct Bar;

impl Element for Bar {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::positive("mass", "kg"),
        Parameter::positive("stiffness", "N/m"),
        Parameter::positive("damping", "N s/m"),
        Parameter::positive("length", "m"),
    ];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point; 2]
    }
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        v.iter().map(|&v| v * v).sum::<S>() * p[0] * 0.5
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = (Vector3::first_three(&q[3..]) - Vector3::first_three(q)).length() - p[3];
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        p[1] * e[0] * e[0] * 0.5 + e[0].powi(4)
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        s[0] = p[2] * rate[0] * (e[0] * e[0] + 1.0);
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0] * 2.0
    }
}

/// A cable of two elements' length with curvature-free strains at two points.
#[derive(Hash)]
struct Cable;

const fn row(component: usize, weights: &'static [f64]) -> Interpolation {
    Interpolation { component, weights }
}

const FIRST: [f64; 3] = [-1.5, 2.0, -0.5];
const SECOND: [f64; 3] = [0.5, -2.0, 1.5];

impl Field for Cable {
    const NODES: usize = 3;
    const NODE: NodeKind = NodeKind::Point;
    const POINTS: &'static [&'static [Interpolation]] =
        &[&[row(0, &FIRST), row(1, &FIRST), row(2, &FIRST)], &[row(0, &SECOND), row(1, &SECOND), row(2, &SECOND)]];
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::non_negative("EA", "N"), Parameter::positive("length", "m"), Parameter::new("viscosity", "N s")]
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..3
    }
    fn kinetic<S: Scalar>(&self, _point: usize, v: &[S], h: &[S], p: &[S]) -> S {
        v.iter().zip(h).map(|(&v, &h)| v * v * (h.sin() + 2.0)).sum::<S>() * p[1]
    }
    fn strain_count(&self, _point: usize) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, _point: usize, h: &[S], p: &[S], e: &mut [S]) {
        e[0] = Vector3::first_three(h).length() / p[1] - 1.0;
    }
    fn stored<S: Scalar>(&self, _point: usize, e: &[S], p: &[S]) -> S {
        p[0] * e[0] * e[0] * 0.5
    }
    fn damping<S: Scalar>(&self, _point: usize, _e: &[S], rate: &[S], p: &[S], s: &mut [S]) {
        s[0] = p[2] * rate[0];
    }
}

pub fn users_own() -> Vec<Case> {
    vec![
        Case::new("a user's oscillator", Duffing, &[1.3, 0.4, 2.1, 0.8, 0.6, 1.9]).without_energies(),
        Case::new("a user's bead", Bead, &[1.3, 0.7, 9.8]),
        Case::new("a user's bead, written", WrittenBead, &[1.3, 0.7, 9.8]),
        Case::new("a user's floor", Floor, &[30.0, 0.4, 0.3, 0.1]).without_energies(),
        Case::new("a user's bar", Bar, &[1.3, 30.0, 0.4, 0.9]),
        Case::new("a user's cable", Flexible(Cable), &[30.0, 0.9, 0.4]).bound_to_world(true),
    ]
}
