use crate::elements::{Constraint, NonholonomicConstraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// Velocity of the material point of a body that is at the world point `place` now [m/s]: v + omega x (place - r).
#[inline(always)]
fn velocity_at<S: Scalar>(v: &[S], q: &[S], place: Vec3<S>) -> Vec3<S> {
    let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
    let omega = e.rotate(e.g_times(rate) * S::from(2.0));
    Vec3::from_slice(v) + omega.cross(place - Vec3::from_slice(q))
}

/// The sliding velocity of b on a plane of a at their point of contact, along two directions u and w of the plane.
#[inline(always)]
fn sliding<S: Scalar>(v: &[S], q: &[S], [u, w]: [Vec3<S>; 2], contact: Vec3<S>, h: &mut [S]) {
    let velocity = velocity_at(&v[7..], &q[7..], contact) - velocity_at(v, q, contact);
    let e = Quaternion::from_slice(&q[3..]);
    (h[0], h[1]) = (e.rotate(u).dot(velocity), e.rotate(w).dot(velocity));
}

const fn new(name: &'static str, unit: &'static str) -> Parameter {
    Parameter::new(name, unit)
}

/// A sphere b rolls without sliding on a plane of a: h = (u . dv, w . dv) [m/s] with the relative velocity dv of the two bodies at
/// the point of contact x_c - r n.
///
/// It keeps nothing but the rolling: a [`PointInPlane`](super::PointInPlane) beside it keeps the centre at the distance r.
///
/// * `centre`  of the sphere, in the frame of b [m]
/// * `u`, `w`, `normal`  unit vectors in the frame of a, at right angles
/// * `radius`  r [m], greater than 0
///
/// Source: Bloch (2015), Nonholonomic Mechanics and Control, section 1.
pub struct RollingSphere;

impl NonholonomicConstraint for RollingSphere {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 2;
    const PARAMETERS: &'static [Parameter] = &[
        new("centre x", "m"),
        new("centre y", "m"),
        new("centre z", "m"),
        new("u x", "-"),
        new("u y", "-"),
        new("u z", "-"),
        new("w x", "-"),
        new("w y", "-"),
        new("w z", "-"),
        new("normal x", "-"),
        new("normal y", "-"),
        new("normal z", "-"),
        Parameter::positive("radius", "m"),
    ];

    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, h: &mut [S]) {
        let [centre, u, w, normal] = [0, 3, 6, 9].map(|i| Vec3::from_slice(&p[i..]));
        let normal = Quaternion::from_slice(&q[3..]).rotate(normal);
        let centre = Vec3::from_slice(&q[7..]) + Quaternion::from_slice(&q[10..]).rotate(centre);
        sliding(v, q, [u, w], centre - normal * p[12], h);
    }
}

const DISC: [Parameter; 10] = [
    new("centre x", "m"),
    new("centre y", "m"),
    new("centre z", "m"),
    new("axis x", "-"),
    new("axis y", "-"),
    new("axis z", "-"),
    new("normal x", "-"),
    new("normal y", "-"),
    new("normal z", "-"),
    Parameter::positive("radius", "m"),
];

/// Centre of the disc, and the vector from it to the lowest point of its edge: -r (n - (n . b) b) / |n - (n . b) b|.
#[inline(always)]
fn disc<S: Scalar>(q: &[S], p: &[S]) -> (Vec3<S>, Vec3<S>) {
    let [centre, axis, normal] = [0, 3, 6].map(|i| Vec3::from_slice(&p[i..]));
    let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
    let (normal, axis) = (ea.rotate(normal), eb.rotate(axis));
    let up = normal - axis * normal.dot(axis);
    (Vec3::from_slice(&q[7..]) + eb.rotate(centre), up * (-p[9] / up.norm()))
}

/// The edge of a thin disc b touches a plane of a: g = n . (x_c + c - x_a) [m] with the vector c from the centre to the lowest point.
///
/// * `centre`  of the disc, in the frame of b [m]
/// * `axis`  of the disc, unit vector in the frame of b
/// * `normal`  n, unit vector in the frame of a
/// * `radius`  r [m], greater than 0
/// * `point`  x_a, of the plane, in the frame of a [m]
pub struct DiscOnPlane;

impl Constraint for DiscOnPlane {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 1;

    fn parameters(&self) -> Vec<Parameter> {
        DISC.iter().cloned().chain(["point x", "point y", "point z"].map(|name| new(name, "m"))).collect()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (centre, lowest) = disc(q, p);
        let ea = Quaternion::from_slice(&q[3..]);
        let point = Vec3::from_slice(q) + ea.rotate(Vec3::from_slice(&p[10..]));
        g[0] = ea.rotate(Vec3::from_slice(&p[6..])).dot(centre + lowest - point);
    }
}

/// The edge of a thin disc b rolls without sliding on a plane of a: h = (u . dv, w . dv) [m/s] with the relative velocity dv of the two
/// bodies at the lowest point of the disc.
///
/// It keeps nothing but the rolling: a [`DiscOnPlane`] beside it keeps the contact.
///
/// * `centre`, `axis`, `normal`, `radius`  as for [`DiscOnPlane`]
/// * `u`, `w`  unit vectors of the plane in the frame of a, at right angles
///
/// Source: Bloch (2015), Nonholonomic Mechanics and Control, section 1.
pub struct RollingDisc;

impl NonholonomicConstraint for RollingDisc {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 2;

    fn parameters(&self) -> Vec<Parameter> {
        DISC.iter().cloned().chain(["u x", "u y", "u z", "w x", "w y", "w z"].map(|name| new(name, "-"))).collect()
    }
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, h: &mut [S]) {
        let (centre, lowest) = disc(q, p);
        sliding(v, q, [10, 13].map(|i| Vec3::from_slice(&p[i..])), centre + lowest, h);
    }
}
