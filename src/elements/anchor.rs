use super::State;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, combine_columns, rotation_gradient_transposed};

/// What kind of node an element takes hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Three coordinates: the position itself; the body point is ignored.
    Point,
    /// Seven coordinates: position of the body frame and Euler parameters.
    Body,
    /// Twelve coordinates: position of the body frame and its axes u, v, w in the world (natural coordinates).
    Natural,
    /// Six coordinates of a cable's node: position and slope dr/dx along the reference length; the body point is ignored.
    Slope,
}

impl Anchor {
    /// Number of coordinates.
    pub fn dofs(self) -> usize {
        match self {
            Anchor::Point => 3,
            Anchor::Body => 7,
            Anchor::Natural => 12,
            Anchor::Slope => 6,
        }
    }

    /// True for rigid bodies: the node has axes, and takes moments.
    pub fn has_axes(self) -> bool {
        matches!(self, Anchor::Body | Anchor::Natural)
    }

    /// World position of the body point `point` \[m\].
    #[inline(always)]
    pub fn position<S: Scalar>(self, q: &[S], point: Vector3<S>) -> Vector3<S> {
        match self {
            Anchor::Point | Anchor::Slope => Vector3::first_three(q),
            Anchor::Body => Vector3::first_three(q) + Quaternion::from_slice(&q[3..]).rotate(point),
            Anchor::Natural => Vector3::first_three(q) + combine_columns(&columns(q), point),
        }
    }

    /// World velocity of the body point `point` [m/s].
    #[inline(always)]
    pub fn velocity<S: Scalar>(self, v: &[S], q: &[S], point: Vector3<S>) -> Vector3<S> {
        match self {
            Anchor::Point | Anchor::Slope => Vector3::first_three(v),
            Anchor::Body => {
                let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
                Vector3::first_three(v) + e.rotate_rate(rate, point)
            }
            Anchor::Natural => Vector3::first_three(v) + combine_columns(&columns(v), point),
        }
    }

    /// World acceleration of the body point `point` [m/s2].
    #[inline(always)]
    pub fn acceleration<S: Scalar>(self, s: State<S>, point: Vector3<S>) -> Vector3<S> {
        match self {
            Anchor::Point | Anchor::Slope => Vector3::first_three(s.a),
            Anchor::Body => {
                let (e, rate) = (Quaternion::from_slice(&s.q[3..]), Quaternion::from_slice(&s.v[3..]));
                let second = Quaternion::from_slice(&s.a[3..]);
                Vector3::first_three(s.a) + e.rotate_rate(second, point) + rate.rotate_rate(rate, point)
            }
            Anchor::Natural => Vector3::first_three(s.a) + combine_columns(&columns(s.a), point),
        }
    }

    /// Adds the generalized force of the world force `force` \[N\] at the body point `point`.
    #[inline(always)]
    pub fn add_force<S: Scalar>(self, q: &[S], point: Vector3<S>, force: Vector3<S>, generalized: &mut [S]) {
        for i in 0..3 {
            generalized[i] += force[i];
        }
        self.add_turning(q, point, force, generalized);
    }

    /// Adds the gradient of force . R s for the vector s in the body frame: what a force at its tip does to the turning of the node.
    #[inline(always)]
    pub fn add_turning<S: Scalar>(self, q: &[S], s: Vector3<S>, force: Vector3<S>, generalized: &mut [S]) {
        match self {
            Anchor::Point | Anchor::Slope => {}
            Anchor::Body => {
                let moment = rotation_gradient_transposed(Quaternion::from_slice(&q[3..]), s, force);
                for i in 0..4 {
                    generalized[3 + i] += moment[i];
                }
            }
            Anchor::Natural => {
                for axis in 0..3 {
                    for i in 0..3 {
                        generalized[3 + 3 * axis + i] += force[i] * s[axis];
                    }
                }
            }
        }
    }

    /// Angular velocity in the world [rad/s]; zero for nodes without axes. With natural coordinates (u x du/dt + ...) / 2.
    #[inline(always)]
    pub fn angular_velocity<S: Scalar>(self, v: &[S], q: &[S]) -> Vector3<S> {
        match self {
            Anchor::Point | Anchor::Slope => Vector3::zeros(),
            Anchor::Body => {
                let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
                e.rotate(e.g_times(rate) * S::from(2.0))
            }
            Anchor::Natural => {
                let (axes, rates) = (columns(q), columns(v));
                (axes[0].cross(&rates[0]) + axes[1].cross(&rates[1]) + axes[2].cross(&rates[2])) * S::from(0.5)
            }
        }
    }

    /// Adds the generalized force of the world moment `moment` [N m]: its power is moment . omega.
    #[inline(always)]
    pub fn add_moment<S: Scalar>(self, q: &[S], moment: Vector3<S>, generalized: &mut [S]) {
        match self {
            Anchor::Point | Anchor::Slope => {}
            Anchor::Body => {
                // omega = 2 G de/dt, so a body-frame moment acts on e as 2 G^T m
                let e = Quaternion::from_slice(&q[3..]);
                let own = e.g_transposed_times(e.rotate_back(moment) * S::from(2.0));
                for i in 0..4 {
                    generalized[3 + i] += own[i];
                }
            }
            Anchor::Natural => {
                for (axis, column) in columns(q).into_iter().enumerate() {
                    let own = moment.cross(&column) * S::from(0.5);
                    for i in 0..3 {
                        generalized[3 + 3 * axis + i] += own[i];
                    }
                }
            }
        }
    }

    /// Moment about the origin of the node that generalized forces hold, the inverse of [`add_moment`](Anchor::add_moment) for what is
    /// free to turn: in the world [N m].
    #[inline(always)]
    pub fn moment<S: Scalar>(self, q: &[S], generalized: &[S]) -> Vector3<S> {
        match self {
            Anchor::Point | Anchor::Slope => Vector3::zeros(),
            Anchor::Body => {
                let e = Quaternion::from_slice(&q[3..]);
                e.rotate(e.g_times(Quaternion::from_slice(&generalized[3..])) * S::from(0.5))
            }
            Anchor::Natural => {
                let (axes, forces) = (columns(q), columns(generalized));
                axes[0].cross(&forces[0]) + axes[1].cross(&forces[1]) + axes[2].cross(&forces[2])
            }
        }
    }

    /// Axes of the node in the world, the columns of R; those of the world for nodes without axes.
    #[inline(always)]
    pub fn axes<S: Scalar>(self, q: &[S]) -> [Vector3<S>; 3] {
        match self {
            Anchor::Point | Anchor::Slope => {
                let (zero, one) = (S::zero(), S::one());
                [Vector3::new(one, zero, zero), Vector3::new(zero, one, zero), Vector3::new(zero, zero, one)]
            }
            Anchor::Body => Quaternion::from_slice(&q[3..]).columns(),
            Anchor::Natural => columns(q),
        }
    }
}

/// Entries 3 to 11 as three vectors: axes, their rates or the forces on them.
#[inline(always)]
fn columns<S: Scalar>(x: &[S]) -> [Vector3<S>; 3] {
    [Vector3::first_three(&x[3..]), Vector3::first_three(&x[6..]), Vector3::first_three(&x[9..])]
}
