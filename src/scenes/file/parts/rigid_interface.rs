//! Nodes that a body carries along.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        need("body", Node, "the body, or one of the nodes"),
        need("nodes", NodeSets, "nodes, edges of shells, ends of walls, node sets of meshes"),
    ],
    space: "joint",
    build,
    ..Section::listed("rigid_interface", "Nodes that a body carries along as they stand, by a rigid link to each.")
};

pub(super) fn build(e: Entry, m: &mut Builder) -> Found<Made> {
    let (body, nodes) = (e.node("body", m)?, e.node_sets("nodes", m)?);
    m.rigid_interface(e.name(), body, &nodes);
    Ok(Made::Nothing)
}
