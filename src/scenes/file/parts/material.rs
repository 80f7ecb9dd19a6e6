//! Materials.

use crate::elements::flexible::{MATERIAL_KEYS, Material};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: MATERIAL_KEYS,
    build: |e, _| built_from(e, given(e, &MATERIAL_KEYS)?, Material::given).map(Built::Material),
    ..Section::named("material", "An isotropic elastic material.")
};
