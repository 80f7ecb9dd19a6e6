//! Parts that turn steadily where the motion begins.

use crate::assembly::NodeId;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("parts", OneOrMore(&Type::Item(WITH_MASS)), "bodies, points and members that turn, with all their nodes"),
        may("point", Vector("m"), "a point of the axis; the origin"),
        need("axis", Vector("-"), "its direction"),
        need("rate", Number("rad/s", Any), "of the turn about it"),
    ],
    space: "",
    build: |e, m| {
        let nodes: Vec<NodeId> = e.list("parts").flat_map(|(_, part)| nodes_of(e.context, part)).collect();
        let [point, axis] = [e.vector_or("point", Vector3::zeros())?, e.vector("axis")?];
        m.spin(&nodes, point, axis, e.number("rate")?);
        Ok(Built::Nothing)
    },
    ..Section::listed(
        "spin",
        "Parts that turn steadily about an axis of the world where the motion begins (`start = \"steady\"` of `[settings]`): it begins at the \
          equilibrium in the frame that turns with them. Weights of what turns count with their part along the axis, the mean over a turn.",
    )
};

/// All nodes of a part.
fn nodes_of(context: &EntryContext, part: &Value) -> Vec<NodeId> {
    let Value::Item(item, _) = part else { return Vec::new() };
    match &context.built[*item] {
        Built::Node(node) => vec![*node],
        Built::Beam(beam) => beam.nodes.clone(),
        Built::Cable(cable) => cable.nodes.clone(),
        shells => shells.shells().into_iter().flat_map(|shell| shell.nodes.clone()).collect(),
    }
}
