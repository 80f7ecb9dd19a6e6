//! Joints and motion drivers: each file holds g(q, p, t) and nothing else.

mod distance;
mod fixed;
mod prescribed_rotation;
mod prescribed_translation;
mod revolute;
mod rolling;
mod spherical;

pub use distance::DistanceJoint;
pub use fixed::FixedJoint;
pub use prescribed_rotation::PrescribedRotation;
pub use prescribed_translation::PrescribedTranslation;
pub use revolute::RevoluteJoint;
pub use rolling::{DiscOnPlane, RollingDisc, RollingSphere};
pub use spherical::SphericalJoint;

use super::{Anchor, Parameter};
use crate::scalar::{Scalar, Vec3};

/// The joint point in the frames of both bodies: the first six parameters of every joint that holds points together.
const POINTS: [Parameter; 6] = [
    Parameter::new("point a x", "m"),
    Parameter::new("point a y", "m"),
    Parameter::new("point a z", "m"),
    Parameter::new("point b x", "m"),
    Parameter::new("point b y", "m"),
    Parameter::new("point b z", "m"),
];

/// x_b - x_a for the points of the first six parameters [m].
fn gap<S: Scalar>([a, b]: [Anchor; 2], q: &[S], p: &[S]) -> Vec3<S> {
    let (qa, qb) = q.split_at(a.dofs());
    b.position(qb, Vec3::from_slice(&p[3..])) - a.position(qa, Vec3::from_slice(p))
}

/// The gradient of force . (x_b - x_a): the force at b, its opposite at a.
#[inline(always)]
fn add_pair<S: Scalar>([a, b]: [Anchor; 2], q: &[S], p: &[S], force: Vec3<S>, r: &mut [S]) {
    let (qa, qb) = q.split_at(a.dofs());
    let (ra, rb) = r.split_at_mut(a.dofs());
    a.add_force(qa, Vec3::from_slice(p), -force, ra);
    b.add_force(qb, Vec3::from_slice(&p[3..]), force, rb);
}
