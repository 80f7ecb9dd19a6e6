//! Nodes that are held until the motion begins.

use crate::elements::joints::Freedom;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("nodes", at_least(0, &NodeSet), "what is held"),
        may("directions", OneOrMore(&Choice(&Freedom::NAMES)), "in which directions of the world; all that it has"),
    ],
    space: "",
    build: |e, m| {
        let named = |name: &str| Freedom::NAMES.iter().position(|own| *own == name).map(|place| Freedom::ALL[place]);
        let directions: Vec<Freedom> = e.texts("directions").filter_map(named).collect();
        e.node_sets("nodes", m)?.into_iter().for_each(|node| m.hold(node, &directions));
        Ok(Built::Nothing)
    },
    ..Section::listed(
        "hold",
        "Nodes that are held where they stand while the equilibrium is found at which the motion begins (`start` of `[settings]`), and let go then.",
    )
};
