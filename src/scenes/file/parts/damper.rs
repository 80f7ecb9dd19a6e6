//! Dampers.

use crate::elements::forces::DAMPERS;
use crate::scenes::file::build_parts::{element, of_part};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "damper",
    shape: Shape::Listed,
    doc: "A damper.",
    forms: Forms { common: &[NAME], forms: &forms_of::<{ DAMPERS.len() }, _>(DAMPERS), own: None },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    of_part(item, named(DAMPERS, item.fields.form), |part| element(known, part, item, m))
}
