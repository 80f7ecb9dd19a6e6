//! Nodes that follow faces of shells.

use super::shell::shells_named;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::SHELLS;

pub(super) const SECTION: Section = Section {
    name: "tie",
    shape: Shape::Listed,
    doc: "Edges of shells, or other nodes, that follow the faces of shells on which they lie, where nodes do not meet: edges in the mean along \
          them, so that constant stresses pass exactly; other nodes where they stand.",
    forms: one_form![
        NAME,
        need(
            "nodes",
            NodeSets,
            "what follows: edges of shells, ends of walls, node sets of meshes, nodes; the more finely divided or the shorter \
             side"
        ),
        need("to", Items(SHELLS), "shells, meshes and walls whose faces they follow"),
        may(
            "within",
            Fixed("m", AtLeastZero),
            "how far from the faces they may lie: they keep that distance; a millionth of the diagonal of \
            all of them"
        ),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let nodes = known.node_sets(fields, m)?;
    m.tie_to(name, &nodes, &shells_named(known, fields, "to").concat(), fixed(fields, "within"));
    Ok(Made::Nothing)
}
