//! Lines of the picture.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        may("on", Node, "node; ground"),
        need("points", at_least(2, &Vector("m")), "corners in the world at the start"),
    ],
    space: "",
    build: |e, m| {
        let node = if e.has("on") { e.node("on", m)? } else { m.ground() };
        m.draw(node, &e.points("points")?);
        Ok(Built::Nothing)
    },
    ..Section::listed("drawing", "A line of the picture that moves with a node.")
};
