//! Angles of joints as coordinates.

use crate::elements::entries::{AXIS, BETWEEN};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "joint_angle",
    shape: Shape::Listed,
    doc: "A coordinate that counts the angle of b against a over any number of turns, for gears, springs and functionals; a joint must \
          hold the axis.",
    forms: one_form![NAME, BETWEEN, AXIS],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (nodes, axis) = (known.different_nodes(fields, m)?, known.vector(fields, "axis")?);
    Ok(Made::Node(m.joint_angle(name, nodes, axis)))
}
