//! Sections of beams and cables.

use crate::elements::flexible::{self, OfShape};
use crate::scenes::file::describing::*;
use crate::scenes::file::formula::SHARE_PLACE;

pub(super) const SECTION: Section = Section {
    name: "section",
    shape: Shape::Named,
    doc: "The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place \
          along the length from 0 to 1: `width = \"0.05 - 0.02 * share\"`.",
    forms: flexible::SECTION,
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { fields, .. }: &Item, _: &mut Builder<S>) -> Found<Made<S>> {
    Ok(shape_of(known, fields)?.map_or(Made::Nothing, |(material, shape)| Made::Shape(material, shape)))
}

/// Material and shape of a section; nothing of one by its numbers.
pub(super) fn shape_of<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<OfShape<S>> {
    if fields.get("material").is_none() {
        return Ok(None);
    }
    let (material, sizes) = (known.material(fields)?, flexible::SECTION.forms.iter().find(|form| form.name == fields.form));
    let sizes = sizes.into_iter().flat_map(|form| &form.keys[1..]).map(|key| known.number(fields, key.name));
    let shape = flexible::Shape::of_form(fields.form, &sizes.collect::<Found<Vec<S>>>()?, material.poisson);
    Ok(shape.map(|shape| (material, shape)))
}

/// What a key `section` names.
pub(super) fn section_of<'i>(items: &'i [Item], fields: &Fields) -> Found<(usize, &'i Item)> {
    match fields.get("section") {
        Some((at, Value::Item(item))) => Ok((at, &items[*item])),
        _ => Err(Mistake::new(fields.at, "the key section is needed here")),
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
