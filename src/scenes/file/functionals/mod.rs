//! Functionals of a file: quantities of nodes, by their entries, and those that are described here, each in one place.

mod formula;
mod of_elements;
mod of_joints;
mod of_sections;
mod over;

use super::build_parts::{located, nothing_builds, values};
use super::keys::{NAME, WITH_ELEMENTS};
use super::known::{Builder, Entry, Found, Made};
use super::section::Section;
use crate::elements::entries::{Form, Forms, Key, Kind, Range, Type, forms_of, joined, need};
use crate::functionals::Over;
use crate::functionals::quantities::QUANTITIES;
use over::{OVER, over};

/// What is measured of a joint, elements or everything, all in one place: name, sentence, keys, and what an entry adds.
struct Measurand {
    form: Form,
    /// Adds the functional of an entry, of what is made over time.
    add: fn(Entry, Over, &mut Builder) -> Found<()>,
}

/// Elements.
const GROUP: Key = need(
    "of",
    Type::Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them",
);
/// A section of a beam or cable.
const AT_SHARE: Key = need("share", Type::Fixed("-", Range::Share), "place along its length, from 0 to 1");

/// What is measured, in the order of the reference page.
const MEASURANDS: [Measurand; 20] = [
    formula::FORMULA,
    of_joints::REACTION,
    of_joints::REACTION_NORM,
    of_joints::JOINT_LOAD,
    of_joints::JOINT_POWER,
    of_elements::ENERGY,
    of_elements::POWER,
    of_elements::MASS,
    of_elements::STRAIN_ENERGY,
    of_elements::INERTIA_MOMENT,
    of_elements::VON_MISES,
    of_elements::TSAI_WU,
    of_sections::SECTION_FORCE,
    of_sections::SECTION_FORCES,
    of_sections::SECTION_STRAIN,
    of_sections::FIBRE_STRESS,
    of_sections::CABLE_STRAIN,
    of_sections::CABLE_CURVATURE,
    of_sections::CABLE_STRESS,
    of_sections::LARGEST_CABLE_STRESS,
];

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

fn build(e: Entry, m: &mut Builder) -> Found<Made> {
    if let Some(part) = e.known.own.quantity_named(e.form) {
        let (nodes, values) = (e.nodes_of_part(m)?, values(e, part.form.keys)?);
        m.measure(part, e.name(), over(&e), &nodes, values);
        return located(Made::Nothing, e, m);
    }
    match MEASURANDS.iter().find(|own| own.form.name == e.form) {
        Some(own) => (own.add)(e, over(&e), m).map(|()| Made::Nothing),
        None => nothing_builds(e),
    }
}
