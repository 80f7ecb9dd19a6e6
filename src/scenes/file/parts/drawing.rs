//! Lines of the picture.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "drawing",
    shape: Shape::Listed,
    doc: "A line of the picture that moves with a node.",
    forms: one_form![may("on", Node, "node; ground"), need("points", Points, "corners in the world at the start"),],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let node = if fields.get("on").is_some() { known.node(fields, "on", m)? } else { m.ground() };
    m.draw(node, &known.points(fields, "points")?);
    Ok(Made::Nothing)
}
