//! Parts that turn steadily where the motion begins.

use crate::assembly::NodeId;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_MASS;

pub(super) const SECTION: Section = Section {
    name: "spin",
    shape: Shape::Listed,
    doc: "Parts that turn steadily about an axis of the world where the motion begins (`start = \"steady\"` of `[settings]`): it begins at the \
          equilibrium in the frame that turns with them. Weights of what turns count with their part along the axis, the mean over a turn.",
    forms: one_form![
        need("parts", Items(WITH_MASS), "bodies, points and members that turn, with all their nodes"),
        may("point", Vector("m"), "a point of the axis; the origin"),
        need("axis", Vector("-"), "its direction"),
        need("rate", Number("rad/s", Any), "of the turn about it"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let nodes: Vec<NodeId> = list(fields, "parts").flat_map(|(_, part)| nodes_of(known, part)).collect();
    let [point, axis] = [known.vector_or(fields, "point", Vector3::zeros())?, known.vector(fields, "axis")?];
    m.spin(&nodes, point, axis, known.number(fields, "rate")?);
    Ok(Made::Nothing)
}

/// All nodes of a part.
fn nodes_of<S: Scalar>(known: &Known<S>, part: &Value) -> Vec<NodeId> {
    let (Value::Item(item) | Value::Group(item, _)) = part else { return Vec::new() };
    match &known.made[*item] {
        Made::Node(node) => vec![*node],
        Made::Beam(beam) => beam.nodes.clone(),
        Made::Cable(cable) => cable.nodes.clone(),
        shells => shells.shells().into_iter().flat_map(|shell| shell.nodes.clone()).collect(),
    }
}
