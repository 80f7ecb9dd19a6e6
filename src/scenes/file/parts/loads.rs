//! Loads.

use crate::elements::forces::LOADS;
use crate::scenes::file::build_parts::{element, of_part};
use crate::scenes::file::describing::*;

/// A section for each load of the library.
pub(super) const SECTIONS: [Section; LOADS.len()] = {
    let (mut sections, mut place) = ([super::damper::SECTION; LOADS.len()], 0);
    while place < LOADS.len() {
        let form = &LOADS[place].form;
        let forms = Forms { common: &[NAME], forms: std::slice::from_ref(form), own: None };
        sections[place] = Section { name: form.name, shape: Shape::Listed, doc: form.doc, forms };
        place += 1;
    }
    sections
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    of_part(item, named(LOADS, item.section), |part| element(known, part, item, m))
}
