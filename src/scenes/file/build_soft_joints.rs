//! Joints with springs and dampers in place of their equations.

use super::build::{Builder, kind_in_space, rigid_joint};
use super::known::{Found, Known, Made};
use super::mistake::Mistake;
use super::reader::Fields;
use crate::assembly::NodeId;
use crate::elements::joints::{
    CylindricalJoint, DistanceJoint, FixedJoint, HelicalJoint, PlanarJoint, PointInPlane, PointOnLine, PrismaticJoint,
    RevoluteJoint, RigidLink, SphericalJoint, UniversalJoint,
};
use crate::scalar::Scalar;

/// A joint with the key `stiffness`.
pub(super) fn soft_joint<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let stiffness = known.series(fields, "stiffness")?;
    let mut damping = known.series(fields, "damping")?;
    if damping.is_empty() {
        damping.resize(stiffness.len(), S::zero());
    }
    let nodes: [NodeId; 2] = known.different_nodes(fields, "between", m)?;
    let [a, b] = nodes.map(|node| kind_in_space(node, m));
    let mut failed = None;
    let add = |m: &mut Builder<S>| {
        rigid_joint(known, name, fields, m).unwrap_or_else(|why| {
            failed = Some(why);
            m.model.refused_constraint()
        })
    };
    let values = [&stiffness[..], &damping];
    match fields.form {
        "spherical" => m.soft(SphericalJoint { a, b }, values, add),
        "revolute" => m.soft(RevoluteJoint { a, b }, values, add),
        "fixed" => m.soft(FixedJoint { a, b }, values, add),
        "rigid_link" => m.soft(RigidLink { a, b }, values, add),
        "distance" => m.soft(DistanceJoint { a, b }, values, add),
        "prismatic" => m.soft(PrismaticJoint { a, b }, values, add),
        "cylindrical" => m.soft(CylindricalJoint { a, b }, values, add),
        "planar" => m.soft(PlanarJoint { a, b }, values, add),
        "universal" => m.soft(UniversalJoint { a, b }, values, add),
        "helical" => m.soft(HelicalJoint { a, b }, values, add),
        "point_on_line" => m.soft(PointOnLine { a, b }, values, add),
        "point_in_plane" => m.soft(PointInPlane { a, b }, values, add),
        other => return Err(Mistake::new(fields.at, format!("a joint of type {other} cannot be soft"))),
    };
    failed.map_or(Ok(Made::SoftJoint), Err)
}
