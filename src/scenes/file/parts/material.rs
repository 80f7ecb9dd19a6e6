//! Materials.

use crate::elements::flexible::{MATERIAL_KEYS, Material};
use crate::scenes::file::build_parts::{given, made_of};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section =
    Section { forms: MATERIAL_KEYS, build, ..Section::named("material", "An isotropic elastic material.") };

pub(super) fn build(e: Entry, _: &mut Builder) -> Found<Made> {
    made_of(e, given(e, &MATERIAL_KEYS)?, Material::given).map(Made::Material)
}
