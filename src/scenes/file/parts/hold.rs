//! Nodes that are held until the motion begins.

use crate::elements::joints::Freedom;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "hold",
    shape: Shape::Listed,
    doc: "Nodes that are held where they stand while the equilibrium is found at which the motion begins (`start` of `[settings]`), and let go then.",
    forms: one_form![
        need("nodes", NodeSets, "what is held"),
        may("directions", Choices(&Freedom::NAMES), "in which directions of the world; all that it has"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let chosen = |(_, own): (usize, &Value)| match own {
        Value::Text(name) => Freedom::NAMES.iter().position(|own| own == name).map(|place| Freedom::ALL[place]),
        _ => None,
    };
    let directions: Vec<Freedom> = list(fields, "directions").filter_map(chosen).collect();
    known.node_sets(fields, m)?.into_iter().for_each(|node| m.hold(node, &directions));
    Ok(Made::Nothing)
}
