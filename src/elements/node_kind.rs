use super::ConstraintPhysics;
use super::bodies::{EulerParameterNorm, OrthonormalAxes};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, combine_columns, rotation_gradient_transposed};
use std::sync::Arc;

/// What a node's coordinates are, and how elements take hold of it.
///
/// A node of plain coordinates has no place in space: positions, axes and forces in the world are those of the others, and zero there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// Position of a point \[m\]; the body point of what takes hold of it is ignored.
    Point,
    /// Position of a body frame \[m\] and its Euler parameters, kept at unit length inside the node.
    Body,
    /// Position of a body frame \[m\] and its axes u, v, w in the world, kept orthonormal inside the node: natural coordinates.
    Natural,
    /// Position of a point of a cable \[m\] and the slope dr/dx along its reference length; a body point is ignored.
    Slope,
    /// Any number of coordinates with the meaning that the user's elements give them.
    Coordinates(usize),
    /// Any number of states of first order z, which have neither inertia nor energy: z stands in v, z' in a, and nothing depends on q. About an
    /// equilibrium, and in statics, z stands in q and z' in v instead.
    States(usize),
}

/// Kinds of both nodes, a and b, of what stands between two.
pub type NodePair = [NodeKind; 2];

impl NodeKind {
    /// Number of coordinates.
    pub const fn dofs(self) -> usize {
        match self {
            NodeKind::Point => 3,
            NodeKind::Body => 7,
            NodeKind::Natural => 12,
            NodeKind::Slope => 6,
            NodeKind::Coordinates(count) | NodeKind::States(count) => count,
        }
    }

    /// Itself, unless it has no place in space.
    pub fn in_space(self) -> Option<Self> {
        (!matches!(self, NodeKind::Coordinates(_) | NodeKind::States(_))).then_some(self)
    }

    /// Whether it has states of first order.
    pub fn is_of_states(self) -> bool {
        matches!(self, NodeKind::States(_))
    }

    /// What it is in a message.
    pub fn words(self) -> String {
        match self {
            NodeKind::Point => "a point".into(),
            NodeKind::Body => "a body".into(),
            NodeKind::Natural => "a body in natural coordinates".into(),
            NodeKind::Slope => "a node of a cable".into(),
            NodeKind::Coordinates(1) => "a coordinate".into(),
            NodeKind::Coordinates(count) => format!("{count} coordinates"),
            NodeKind::States(1) => "a state".into(),
            NodeKind::States(count) => format!("{count} states"),
        }
    }

    /// The constraint inside the node, if it has one.
    pub fn local_constraint(self) -> Option<ConstraintPhysics> {
        match self {
            NodeKind::Body => Some(ConstraintPhysics::new(Arc::new(EulerParameterNorm))),
            NodeKind::Natural => Some(ConstraintPhysics::new(Arc::new(OrthonormalAxes))),
            _ => None,
        }
    }

    /// Name of coordinate `index`.
    #[doc(hidden)]
    pub fn coordinate_name(self, index: usize) -> String {
        match self {
            NodeKind::Coordinates(_) => format!("coordinate {index}"),
            NodeKind::States(_) => format!("state {index}"),
            NodeKind::Natural => ["x", "y", "z", "ux", "uy", "uz", "vx", "vy", "vz", "wx", "wy", "wz"][index].to_string(),
            NodeKind::Slope => ["x", "y", "z", "slope x", "slope y", "slope z"][index].to_string(),
            NodeKind::Point | NodeKind::Body => ["x", "y", "z", "e0", "e1", "e2", "e3"][index].to_string(),
        }
    }

    /// True for rigid bodies: the node has axes, and takes moments.
    pub fn has_axes(self) -> bool {
        matches!(self, NodeKind::Body | NodeKind::Natural)
    }

    /// World position of the body point `point` \[m\].
    #[inline(always)]
    pub fn position<S: Scalar>(self, q: &[S], point: Vector3<S>) -> Vector3<S> {
        match self {
            NodeKind::Coordinates(_) | NodeKind::States(_) => Vector3::zeros(),
            NodeKind::Point | NodeKind::Slope => Vector3::first_three(q),
            NodeKind::Body => Vector3::first_three(q) + Quaternion::from_slice(&q[3..]).rotate(point),
            NodeKind::Natural => Vector3::first_three(q) + combine_columns(&columns(q), point),
        }
    }

    /// World velocity of the body point `point` [m/s].
    #[inline(always)]
    pub fn velocity<S: Scalar>(self, v: &[S], q: &[S], point: Vector3<S>) -> Vector3<S> {
        match self {
            NodeKind::Coordinates(_) | NodeKind::States(_) => Vector3::zeros(),
            NodeKind::Point | NodeKind::Slope => Vector3::first_three(v),
            NodeKind::Body => {
                let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
                Vector3::first_three(v) + e.rotate_rate(rate, point)
            }
            NodeKind::Natural => Vector3::first_three(v) + combine_columns(&columns(v), point),
        }
    }

    /// World acceleration of the body point `point` [m/s2], for second rates, rates and values of the coordinates, of which a rotation is a quadratic
    /// form.
    pub fn acceleration<S: Scalar>(self, [a, v, q]: [&[S]; 3], point: Vector3<S>) -> Vector3<S> {
        let own = self.velocity(a, q, point);
        match self {
            NodeKind::Body => {
                let rate = Quaternion::from_slice(&v[3..]);
                own + rate.rotate_rate(rate, point)
            }
            _ => own,
        }
    }

    /// A direction of the body in the world; that of the world where a node has no axes.
    pub fn turned<S: Scalar>(self, q: &[S], direction: Vector3<S>) -> Vector3<S> {
        match self {
            NodeKind::Body => Quaternion::from_slice(&q[3..]).rotate(direction),
            NodeKind::Natural => combine_columns(&columns(q), direction),
            _ => direction,
        }
    }

    /// Velocities of its coordinates, into `v`, while the world turns with the angular velocity `omega` [rad/s] about the world point
    /// `about`: linear in what lies at the origin. Changes of coordinates turn like coordinates about the origin.
    pub fn turn<S: Scalar>(self, q: &[S], about: Vector3<S>, omega: Vector3<S>, v: &mut [S]) {
        if self.in_space().is_none() {
            return;
        }
        let turned = |x: &[S]| omega.cross(&Vector3::first_three(x)).components();
        v[..3].copy_from_slice(&omega.cross(&(Vector3::first_three(q) - about)).components());
        match self {
            NodeKind::Body => {
                let half = omega * S::from(0.5);
                let rate = Quaternion([S::zero(), half[0], half[1], half[2]]).times(Quaternion::from_slice(&q[3..]));
                v[3..].copy_from_slice(&rate.0);
            }
            // slopes and axes are vectors in the world
            _ => q[3..].chunks_exact(3).zip(v[3..].chunks_exact_mut(3)).for_each(|(x, v)| v.copy_from_slice(&turned(x))),
        }
    }

    /// Its coordinates after a rotation of the world about the world point `about`, into `turned`; forces on them turn like coordinates about the
    /// origin.
    pub fn rotate<S: Scalar>(self, q: &[S], about: Vector3<S>, rotation: Quaternion<S>, turned: &mut [S]) {
        if self.in_space().is_none() {
            return turned.copy_from_slice(q);
        }
        let rotated = |x: Vector3<S>| rotation.rotate(x).components();
        let place = about + rotation.rotate(Vector3::first_three(q) - about);
        turned[..3].copy_from_slice(&place.components());
        match self {
            NodeKind::Body => turned[3..].copy_from_slice(&rotation.times(Quaternion::from_slice(&q[3..])).0),
            _ => {
                let vectors = q[3..].chunks_exact(3).map(Vector3::first_three);
                vectors.zip(turned[3..].chunks_exact_mut(3)).for_each(|(x, own)| own.copy_from_slice(&rotated(x)));
            }
        }
    }

    /// Adds the generalized force of the world force `force` \[N\] at the body point `point`.
    #[inline(always)]
    pub fn add_force<S: Scalar>(self, q: &[S], point: Vector3<S>, force: Vector3<S>, generalized: &mut [S]) {
        if self.in_space().is_none() {
            return;
        }
        for i in 0..3 {
            generalized[i] += force[i];
        }
        self.add_turning(q, point, force, generalized);
    }

    /// Adds the gradient of force . R s for the vector s in the body frame: what a force at its tip does to the turning of the node.
    #[inline(always)]
    pub(crate) fn add_turning<S: Scalar>(self, q: &[S], s: Vector3<S>, force: Vector3<S>, generalized: &mut [S]) {
        match self {
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => {}
            NodeKind::Body => {
                let moment = rotation_gradient_transposed(Quaternion::from_slice(&q[3..]), s, force);
                for i in 0..4 {
                    generalized[3 + i] += moment[i];
                }
            }
            NodeKind::Natural => {
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
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => Vector3::zeros(),
            NodeKind::Body => {
                let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
                e.rotate(e.g_times(rate) * S::from(2.0))
            }
            NodeKind::Natural => {
                let (axes, rates) = (columns(q), columns(v));
                (axes[0].cross(&rates[0]) + axes[1].cross(&rates[1]) + axes[2].cross(&rates[2])) * S::from(0.5)
            }
        }
    }

    /// Adds the generalized force of the world moment `moment` [N m]: its power is moment . omega.
    #[inline(always)]
    pub(crate) fn add_moment<S: Scalar>(self, q: &[S], moment: Vector3<S>, generalized: &mut [S]) {
        match self {
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => {}
            NodeKind::Body => {
                // omega = 2 G de/dt, so a body-frame moment acts on e as 2 G^T m
                let e = Quaternion::from_slice(&q[3..]);
                let own = e.g_transposed_times(e.rotate_back(moment) * S::from(2.0));
                for i in 0..4 {
                    generalized[3 + i] += own[i];
                }
            }
            NodeKind::Natural => {
                for (axis, column) in columns(q).into_iter().enumerate() {
                    let own = moment.cross(&column) * S::from(0.5);
                    for i in 0..3 {
                        generalized[3 + 3 * axis + i] += own[i];
                    }
                }
            }
        }
    }

    /// Moment about the origin of the node that generalized forces hold, the inverse of `add_moment` for what is
    /// free to turn: in the world [N m].
    #[inline(always)]
    pub fn moment<S: Scalar>(self, q: &[S], generalized: &[S]) -> Vector3<S> {
        match self {
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => Vector3::zeros(),
            NodeKind::Body => {
                let e = Quaternion::from_slice(&q[3..]);
                e.rotate(e.g_times(Quaternion::from_slice(&generalized[3..])) * S::from(0.5))
            }
            NodeKind::Natural => {
                let (axes, forces) = (columns(q), columns(generalized));
                axes[0].cross(&forces[0]) + axes[1].cross(&forces[1]) + axes[2].cross(&forces[2])
            }
        }
    }

    /// How many numbers a force on it has: those of a force and a moment, or its coordinates.
    pub(crate) fn forces(self) -> usize {
        if self.has_axes() { 6 } else { self.dofs() }
    }

    /// How its coordinates move along [`forces`](NodeKind::forces): with a place, and with a turn about the axes of the body, or those of the
    /// world with natural coordinates.
    pub(crate) fn movement<S: Scalar>(self, q: &[S], along: &[S]) -> Vec<S> {
        match self {
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => along.to_vec(),
            NodeKind::Body => {
                let turned = Quaternion::from_slice(&q[3..]).rate_of_body_velocity(Vector3::first_three(&along[3..]));
                along[..3].iter().copied().chain(turned).collect()
            }
            NodeKind::Natural => {
                let turn = Vector3::first_three(&along[3..]);
                let axes = columns(q).into_iter().flat_map(|axis| turn.cross(&axis).components());
                along[..3].iter().copied().chain(axes).collect()
            }
        }
    }

    /// Axes of the node in the world, the columns of R; those of the world for nodes without axes.
    #[inline(always)]
    pub fn axes<S: Scalar>(self, q: &[S]) -> [Vector3<S>; 3] {
        match self {
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => {
                let (zero, one) = (S::zero(), S::one());
                [Vector3::new(one, zero, zero), Vector3::new(zero, one, zero), Vector3::new(zero, zero, one)]
            }
            NodeKind::Body => Quaternion::from_slice(&q[3..]).columns(),
            NodeKind::Natural => columns(q),
        }
    }
}

/// Entries 3 to 11 as three vectors: axes, their rates or the forces on them.
#[inline(always)]
fn columns<S: Scalar>(x: &[S]) -> [Vector3<S>; 3] {
    [Vector3::first_three(&x[3..]), Vector3::first_three(&x[6..]), Vector3::first_three(&x[9..])]
}
