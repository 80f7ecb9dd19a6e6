//! Lines of the picture.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![may("on", Node, "node; ground"), need("points", Points, "corners in the world at the start"),],
    space: "",
    build,
    ..Section::listed("drawing", "A line of the picture that moves with a node.")
};

pub(super) fn build(e: Entry, m: &mut Builder) -> Found<Made> {
    let node = if e.has("on") { e.node("on", m)? } else { m.ground() };
    m.draw(node, &e.points("points")?);
    Ok(Made::Nothing)
}
