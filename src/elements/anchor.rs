use super::State;
use crate::scalar::{Quaternion, Scalar, Vec3, rotation_gradient_transposed};

/// What kind of node an element takes hold of: a point mass or a point of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Three coordinates: the position itself; the body point is ignored.
    Point,
    /// Seven coordinates: position of the body frame and Euler parameters.
    Body,
}

impl Anchor {
    /// Number of coordinates.
    pub fn dofs(self) -> usize {
        match self {
            Anchor::Point => 3,
            Anchor::Body => 7,
        }
    }

    /// World position of the body point `point` [m].
    #[inline(always)]
    pub fn position<S: Scalar>(self, q: &[S], point: Vec3<S>) -> Vec3<S> {
        match self {
            Anchor::Point => Vec3::from_slice(q),
            Anchor::Body => Vec3::from_slice(q) + Quaternion::from_slice(&q[3..]).rotate(point),
        }
    }

    /// World velocity of the body point `point` [m/s].
    #[inline(always)]
    pub fn velocity<S: Scalar>(self, v: &[S], q: &[S], point: Vec3<S>) -> Vec3<S> {
        match self {
            Anchor::Point => Vec3::from_slice(v),
            Anchor::Body => {
                let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
                Vec3::from_slice(v) + e.rotate_rate(rate, point)
            }
        }
    }

    /// World acceleration of the body point `point` [m/s2].
    #[inline(always)]
    pub fn acceleration<S: Scalar>(self, s: State<S>, point: Vec3<S>) -> Vec3<S> {
        match self {
            Anchor::Point => Vec3::from_slice(s.a),
            Anchor::Body => {
                let (e, rate) = (Quaternion::from_slice(&s.q[3..]), Quaternion::from_slice(&s.v[3..]));
                let second = Quaternion::from_slice(&s.a[3..]);
                Vec3::from_slice(s.a) + e.rotate_rate(second, point) + rate.rotate_rate(rate, point)
            }
        }
    }

    /// Adds the generalized force of the world force `force` [N] at the body point `point`.
    #[inline(always)]
    pub fn add_force<S: Scalar>(self, q: &[S], point: Vec3<S>, force: Vec3<S>, generalized: &mut [S]) {
        for (g, f) in generalized.iter_mut().zip(force.0) {
            *g += f;
        }
        if self == Anchor::Body {
            let moment = rotation_gradient_transposed(Quaternion::from_slice(&q[3..]), point, force);
            for (g, m) in generalized[3..].iter_mut().zip(moment) {
                *g += m;
            }
        }
    }
}
