//! Springs.

use crate::elements::entries::Kind;
use crate::elements::forces::SPRINGS;
use crate::scenes::file::build_parts::{element, of_part};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "spring",
    shape: Shape::Listed,
    doc: "A spring.",
    forms: Forms { common: &[NAME], forms: &forms_of::<{ SPRINGS.len() }, _>(SPRINGS), own: Some(Kind::Spring) },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    of_part(item, known.own.spring_named(item.fields.form), |part| element(known, part, item, m))
}
