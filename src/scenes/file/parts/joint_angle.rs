//! Angles of joints as coordinates.

use crate::elements::entries::{AXIS, BETWEEN};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![NAME, BETWEEN, AXIS],
    build: |e, m| {
        let (nodes, axis) = (e.different_nodes(m)?, e.vector("axis")?);
        Ok(Built::Node(m.joint_angle(e.name(), nodes, axis)))
    },
    ..Section::with_nodes(
        "joint_angle",
        "A coordinate that counts the angle of b against a over any number of turns, for gears, springs and functionals; a joint must \
          hold the axis.",
        Nodes::one(OF_COORDINATE),
    )
};
