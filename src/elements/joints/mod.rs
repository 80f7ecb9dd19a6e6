//! Joints and motion drivers: each file holds g(q, p, t).

mod angle_coordinate;
mod cable_corner;
mod cable_end;
mod cylindrical;
mod distance;
mod fixed;
mod gear;
mod held_node;
mod helical;
mod planar;
mod point_in_plane;
mod point_on_line;
mod prescribed_rotation;
mod prescribed_translation;
mod prismatic;
mod rack_and_pinion;
mod revolute;
mod rigid_link;
mod rolling;
mod spherical;
mod surfaces;
mod tied_node;
mod universal;

/// Joints and drivers as types.
pub(crate) mod types {
    pub use super::{
        angle_coordinate::AngleCoordinate, cable_corner::CableCorner, cable_end::CableEnd, cable_end::CableHinge,
        cable_end::CableWeld, cylindrical::CylindricalJoint, distance::DistanceJoint, fixed::FixedJoint, gear::GearJoint,
        held_node::HeldNode, helical::HelicalJoint, planar::PlanarJoint, point_in_plane::PointInPlane,
        point_on_line::PointOnLine, prescribed_rotation::PrescribedRotation, prescribed_translation::PrescribedTranslation,
        prismatic::PrismaticJoint, rack_and_pinion::RackAndPinion, revolute::RevoluteJoint, rigid_link::RigidLink,
        rolling::DiscOnPlane, rolling::RollingDisc, rolling::RollingSphere, spherical::SphericalJoint, tied_node::TiedNode,
        universal::UniversalJoint,
    };
}

pub use cable_end::HeldSlope;
pub use held_node::Freedom;
pub(in crate::elements) use rolling::velocity_at;
pub(crate) use rolling::{ROLLING, SphereFriction, SpheresFriction, contact_and_rolling};
pub use surfaces::Surfaces;
pub(crate) use surfaces::{Apart, JointSurfaces};
pub(crate) use types::*;

use super::dyn_layer::instantiate_here;
use super::entries::{JointPart, JointVisitor, entries};
use super::{AnyConstraint, Frame, NodeKind, Nonholonomic, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::f64::consts::TAU;

instantiate_here!(dyn AnyConstraint: AngleCoordinate, CableCorner, CableEnd, CylindricalJoint, DistanceJoint, FixedJoint, GearJoint, HeldNode, HelicalJoint, PlanarJoint, PointInPlane, PointOnLine, PrescribedRotation, PrescribedTranslation, PrismaticJoint, RackAndPinion, RevoluteJoint, RigidLink, DiscOnPlane, SphericalJoint, TiedNode, UniversalJoint, Nonholonomic<RollingDisc>, Nonholonomic<RollingSphere>);

entries! {
    JointPart, JointVisitor;
    /// Joints by the names that scene files and programs use, each described in its own file.
    JOINTS:
    SphericalJoint, RevoluteJoint, FixedJoint, RigidLink, DistanceJoint, PrismaticJoint, CylindricalJoint, PlanarJoint, UniversalJoint,
    HelicalJoint, PointOnLine, PointInPlane, GearJoint, RackAndPinion, CableWeld, CableHinge, CableCorner;
    /// Motion drivers, likewise.
    DRIVERS:
    PrescribedRotation, PrescribedTranslation;
}

/// The entry of a joint or driver of this name.
pub fn named(name: &str) -> Option<&'static JointPart> {
    JOINTS.iter().chain(DRIVERS).find(|part| part.form.name == name)
}

/// The joint point in the frames of both bodies: the first six parameters of every joint that holds points together.
pub(crate) fn points() -> Vec<Parameter> {
    Parameter::vectors(&["point a", "point b"], "m")
}

/// Euler parameters of b relative to a.
const RELATIVE_ROTATION: [Parameter; 4] =
    [Parameter::new("e0", "-"), Parameter::new("e1", "-"), Parameter::new("e2", "-"), Parameter::new("e3", "-")];

/// What an angle between two bodies is measured with: the axis and the zero mark of a, and the mark of b.
pub(crate) fn angle() -> Vec<Parameter> {
    vectors(&["axis", "reference a", "reference b"])
}

/// The components of unit vectors, by the names of the vectors.
pub(crate) fn vectors(names: &[&str]) -> Vec<Parameter> {
    Parameter::vectors(names, "-")
}

/// x_b - x_a for the points of the first six parameters \[m\].
pub(crate) fn gap<S: Scalar>([a, b]: [NodeKind; 2], q: &[S], p: &[S]) -> Vector3<S> {
    let (qa, qb) = q.split_at(a.dofs());
    b.position(qb, Vector3::first_three(&p[3..])) - a.position(qa, Vector3::first_three(p))
}

/// Components of a world vector along vectors of body a, which `vectors` gives in its frame, one after the other.
#[inline(always)]
pub(crate) fn components<S: Scalar>(a: &Frame<S>, vectors: &[S], world: Vector3<S>, g: &mut [S]) {
    let seen_from_a = a.seen(world);
    for (g, vector) in g.iter_mut().zip(vectors.chunks_exact(3)) {
        *g = seen_from_a.dot(&Vector3::first_three(vector));
    }
}

/// For small angles the rotation that b has beyond `relative`, in the frame of a \[rad\]: 2 vec(e_a* e_b e_ab*) between Euler parameters,
/// otherwise (c_1 x d_1 + c_2 x d_2 + c_3 x d_3) / 2 with the axes d_k of b seen from a, and where they should be, c_k = R(e_ab) e_k.
#[inline(always)]
fn remaining_rotation<S: Scalar>(ends: [NodeKind; 2], q: &[S], relative: &[S]) -> Vector3<S> {
    let relative = Quaternion::from_slice(relative);
    if ends == [NodeKind::Body; 2] {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        return ea.conjugate().times(eb).times(relative.conjugate()).parts().1 * S::from(2.0);
    }
    let [a, b] = Frame::pair(ends, q);
    let (wanted, own) = (relative.columns(), b.axes);
    let beyond = |k: usize| wanted[k].cross(&a.seen(own[k]));
    (beyond(0) + beyond(1) + beyond(2)) * S::from(0.5)
}

/// The angle about `axis` from `from` to `to` less `turn`, in [-pi, pi] \[rad\]: any number of whole turns is left out of it. Axis and zero mark
/// are vectors of a, the other mark is one of b.
#[inline(always)]
fn angle_beyond<S: Scalar>([a, b]: [&Frame<S>; 2], [axis, from, to]: [&[S]; 3], turn: S) -> S {
    let (axis, from) = (Vector3::first_three(axis), Vector3::first_three(from));
    let seen_from_a = a.seen(b.direction(to));
    let beyond = axis.cross(&from).dot(&seen_from_a).atan2(from.dot(&seen_from_a)) - turn;
    // whole turns, to the nearest
    beyond - (beyond / TAU + 0.5).floor() * TAU
}

/// The same between two bodies with the parameters [`angle`].
#[inline(always)]
pub(crate) fn angle_between<S: Scalar>(ends: [NodeKind; 2], q: &[S], p: &[S], turn: S) -> S {
    let [a, b] = Frame::pair(ends, q);
    angle_beyond([&a, &b], [p, &p[3..], &p[6..]], turn)
}
