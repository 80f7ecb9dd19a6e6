//! Materials.

use crate::elements::flexible::{MATERIAL_KEYS, Material};
use crate::scenes::file::build_parts::{given, made_of};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section =
    Section { name: "material", shape: Shape::Named, doc: "An isotropic elastic material.", forms: MATERIAL_KEYS };

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { fields, .. }: &Item, _: &mut Builder<S>) -> Found<Made<S>> {
    made_of(fields, given(known, fields, &MATERIAL_KEYS)?, Material::given).map(Made::Material)
}
