//! Numbers that move.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "coordinate",
    shape: Shape::Listed,
    doc: "A number that moves, with the meaning that springs and parts of one's own on it give it; one of them must have inertia.",
    forms: one_form![
        NAME,
        may("initial", Number("", Any), "value at the start; 0"),
        may("rate", Number("1/s", Any), "its rate there; 0"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let [initial, rate] = ["initial", "rate"].map(|key| known.number_or(fields, key, 0.0));
    Ok(Made::Node(m.coordinates(name, &[initial?], &[rate?])))
}
