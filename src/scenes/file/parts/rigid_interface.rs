//! Nodes that a body carries along.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "rigid_interface",
    shape: Shape::Listed,
    doc: "Nodes that a body carries along as they stand, by a rigid link to each.",
    forms: one_form![
        NAME,
        need("body", Node, "the body, or one of the nodes"),
        need("nodes", NodeSets, "nodes, edges of shells, ends of walls, node sets of meshes"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let body = known.node(fields, "body", m)?;
    let nodes = known.node_sets(fields, m)?;
    m.rigid_interface(name, body, &nodes);
    Ok(Made::Nothing)
}
