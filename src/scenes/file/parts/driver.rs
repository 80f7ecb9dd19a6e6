//! Prescribed motions.

use crate::elements::joints::DRIVERS;
use crate::scenes::file::build_parts::{joint, of_part};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "driver",
    shape: Shape::Listed,
    doc: "A prescribed motion.",
    forms: Forms { common: &[NAME], forms: &forms_of::<{ DRIVERS.len() }, _>(DRIVERS), own: None },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    of_part(item, named(DRIVERS, item.fields.form), |part| joint(known, part, item, m))
}
