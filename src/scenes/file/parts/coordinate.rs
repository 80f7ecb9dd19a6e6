//! Numbers that move.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        may("initial", Number("", Any), "value at the start; 0"),
        may("rate", Number("1/s", Any), "its rate there; 0"),
    ],
    build: |e, m| {
        let [initial, rate] = ["initial", "rate"].map(|key| e.number_or(key, 0.0));
        Ok(Built::Node(m.coordinates(e.name(), &[initial?], &[rate?])))
    },
    ..Section::with_nodes(
        "coordinate",
        "A number that moves, with the meaning that springs and parts of one's own on it give it; one of them must have inertia.",
        Nodes::one(OF_COORDINATE),
    )
};
