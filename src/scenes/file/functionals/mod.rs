//! Functionals of a file: quantities of nodes, by their entries, and those that are described here, each in one place.

mod formula;
mod of_elements;
mod of_events;
mod of_joints;
mod of_sections;
mod over;

use super::describing::*;
use crate::elements::entries::Kind;
use crate::functionals::Over;
use crate::functionals::quantities::QUANTITIES;
use of_elements::OF_ELEMENTS;
use of_events::{EVENT_TIME, IMPULSE};
use of_joints::OF_JOINTS;
use of_sections::OF_SECTIONS;
use over::{OVER, over};

/// What is measured of a joint, elements or everything: name, sentence, keys, and what an entry adds, of what is made over time.
#[derive(Clone, Copy)]
struct Measurand {
    form: Form,
    add: Adder,
}

type Adder = fn(Entry, Over, &mut Builder) -> Result<()>;

const fn measurand(name: &'static str, doc: &'static str, keys: &'static [Key], add: Adder) -> Measurand {
    Measurand { form: Form { name, doc, keys }, add }
}

/// Elements.
const GROUP: Key = need(
    "of",
    Type::OneOrMore(&Type::Item(WITH_ELEMENTS)),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them",
);

/// What is measured, in the order of the reference page.
const MEASURANDS: [Measurand; 3 + OF_JOINTS.len() + OF_ELEMENTS.len() + OF_SECTIONS.len()] =
    joined(&[&[formula::FORMULA, EVENT_TIME, IMPULSE], OF_JOINTS, OF_ELEMENTS, OF_SECTIONS]);

const FORMS: [Form; MEASURANDS.len()] = {
    let (mut forms, mut place) = ([MEASURANDS[0].form; MEASURANDS.len()], 0);
    while place < MEASURANDS.len() {
        forms[place] = MEASURANDS[place].form;
        place += 1;
    }
    forms
};

const ALL_FORMS: [Form; QUANTITIES.len() + FORMS.len()] =
    joined(&[&forms_of::<{ QUANTITIES.len() }, _>(QUANTITIES), &FORMS]);

pub(super) const SECTION: Section = Section {
    forms: Forms { common: &[NAME, OVER], forms: &ALL_FORMS, own: Some(Kind::Functional) },
    space: "functional",
    has_columns: true,
    build,
    ..Section::listed("functional", "A number that a run gives, with its gradient.")
};

fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    if let Some(part) = e.context.own.quantity_named(e.form) {
        let (nodes, values) = (e.nodes_of_part(m)?, values(e, part.form.keys)?);
        m.measure(part, e.name(), over(&e), &nodes, values);
        return located(Built::Nothing, e, m);
    }
    let own = MEASURANDS.iter().find(|own| own.form.name == e.form);
    own.map_or(Ok(()), |own| (own.add)(e, over(&e), m)).map(|()| Built::Nothing)
}
