//! Nodes that a body carries along.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        need("body", Node, "the body, or one of the nodes"),
        need("nodes", at_least(0, &NodeSet), "nodes, edges of shells, ends of walls, node sets of meshes"),
    ],
    space: "joint",
    build: |e, m| {
        let (body, nodes) = (e.node("body", m)?, e.node_sets("nodes", m)?);
        m.rigid_interface(e.name(), body, &nodes);
        Ok(Built::Nothing)
    },
    ..Section::listed("rigid_interface", "Nodes that a body carries along as they stand, by a rigid link to each.")
};
