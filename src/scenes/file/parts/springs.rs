//! Springs, dampers and loads: what the library's lists of their entries have.

use crate::elements::entries::{GivenValue, Kind, SpringPart};
use crate::elements::forces::{DAMPERS, LOADS, SPRINGS};
use crate::scenes::file::describing::*;

pub(super) const SPRING: Section = Section {
    forms: Forms { common: &[NAME], forms: &forms_of::<{ SPRINGS.len() }, _>(SPRINGS), own: Some(Kind::Spring) },
    space: "force",
    has_columns: true,
    build: |e, m| element(e.context.own.spring_named(e.form), e, m),
    ..Section::listed("spring", "A spring.")
};

pub(super) const DAMPER: Section = Section {
    forms: Forms { common: &[NAME], forms: &forms_of::<{ DAMPERS.len() }, _>(DAMPERS), own: None },
    space: "force",
    has_columns: true,
    build: |e, m| element(named(DAMPERS, e.form), e, m),
    ..Section::listed("damper", "A damper.")
};

/// A section for each load of the library.
pub(super) const LOAD_SECTIONS: [Section; LOADS.len()] = {
    let (mut sections, mut place) = ([DAMPER; LOADS.len()], 0);
    while place < LOADS.len() {
        let form = &LOADS[place].form;
        sections[place] = Section {
            forms: Forms { common: &[NAME], forms: std::slice::from_ref(form), own: None },
            space: "force",
            build: |e, m| element(named(LOADS, e.form), e, m),
            ..Section::listed(form.name, form.doc)
        };
        place += 1;
    }
    sections
};

/// Makes a spring, damper or load of its entry, on each node or element of what carries it.
fn element(part: Option<&SpringPart>, e: Entry, m: &mut Builder) -> Result<Built> {
    let part = part.unwrap_or_else(|| unreachable!("{} is one of the forms", e.form));
    let (on, mut values) = (e.carriers(m)?, values(e, part.form.keys)?);
    if e.has("on") && on.len() > 1 {
        let share = Recorded::from(1.0 / on.len() as f64);
        values.iter_mut().for_each(|(key, own)| match own {
            GivenValue::Vector(own) if *key == "direction" => *own *= share,
            _ => {}
        });
    }
    m.load(part, &on, &values);
    located(Built::Nothing, e, m)
}
