//! Sections of beams and cables.

use crate::elements::flexible::{self, OfShape};
use crate::scenes::file::describing::*;
use crate::scenes::file::formula::SHARE_PLACE;

pub(super) const SECTION: Section = Section {
    forms: flexible::SECTION,
    build: |e, _| shape_of(e).map(|_| Built::Nothing),
    ..Section::named(
        "section",
        "The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place \
          along the length from 0 to 1: `width = \"0.05 - 0.02 * share\"`.",
    )
};

/// Material and shape of a section; nothing of one by its numbers.
pub(super) fn shape_of(e: Entry) -> Result<OfShape<Recorded>> {
    if !e.has("material") {
        return Ok(None);
    }
    let (material, sizes) = (e.material()?, flexible::SECTION.forms.iter().find(|form| form.name == e.form));
    let sizes = sizes.into_iter().flat_map(|form| &form.keys[1..]).map(|key| e.number(key.name));
    let shape = flexible::Shape::of_form(e.form, &sizes.collect::<Result<Vec<Recorded>>>()?, material.poisson);
    Ok(shape.map(|shape| (material, shape)))
}

/// What a key `section` names, and where it does.
pub(super) fn section_of(e: Entry) -> Result<(usize, Entry)> {
    match e.get("section") {
        Some((at, Value::Item(item, _))) => Ok((at, e.context.entry(*item))),
        _ => e.wrong("the key section is needed here"),
    }
}

/// Whether a section changes along the beam.
pub(super) fn is_tapered(section: &Fields) -> bool {
    fn uses(value: &Value) -> bool {
        match value {
            Value::Formula(formula, _) => formula.taken().contains(&SHARE_PLACE),
            Value::List(list) => list.iter().any(|(_, own)| uses(own)),
            _ => false,
        }
    }
    section.values.iter().any(|(_, _, value)| uses(value))
}
