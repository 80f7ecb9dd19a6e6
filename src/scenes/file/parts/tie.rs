//! Nodes that follow faces of shells.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        need(
            "nodes",
            at_least(0, &NodeSet),
            "what follows: edges of shells, ends of walls, node sets of meshes, nodes; the more finely divided or the shorter \
             side"
        ),
        need("to", OneOrMore(&Type::Item(SHELLS)), "shells, meshes and walls whose faces they follow"),
        may(
            "within",
            Fixed("m", AtLeastZero),
            "how far from the faces they may lie: they keep that distance; a millionth of the diagonal of \
            all of them"
        ),
    ],
    space: "joint",
    build: |e, m| {
        let nodes = e.node_sets("nodes", m)?;
        m.tie_to(e.name(), &nodes, &e.shells("to").concat(), e.fixed("within"));
        Ok(Built::Nothing)
    },
    ..Section::listed(
        "tie",
        "Edges of shells, or other nodes, that follow the faces of shells on which they lie, where nodes do not meet: edges in the mean along \
          them, so that constant stresses pass exactly; other nodes where they stand.",
    )
};
