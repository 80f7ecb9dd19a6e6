//! Springs.

use crate::elements::entries::{Forms, Kind, forms_of};
use crate::elements::forces::SPRINGS;
use crate::scalar::Scalar;
use crate::scenes::file::build_parts::{element, of_part};
use crate::scenes::file::fields::Item;
use crate::scenes::file::keys::NAME;
use crate::scenes::file::known::{Builder, Found, Known, Made};
use crate::scenes::file::section::{Section, Shape};

pub(super) const SECTION: Section = Section {
    name: "spring",
    shape: Shape::Listed,
    doc: "A spring.",
    forms: Forms { common: &[NAME], forms: &forms_of::<{ SPRINGS.len() }, _>(SPRINGS), own: Some(Kind::Spring) },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    of_part(item, known.own.spring_named(item.fields.form), |part| element(known, part, item, m))
}
