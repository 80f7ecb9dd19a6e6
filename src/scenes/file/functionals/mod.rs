//! Functionals of a file: quantities of nodes, by their entries, and those that are described here, each in one place.

mod beam_section;
mod cable_section;
mod energy;
mod formula;
mod joint_load;
mod mass;
mod measurand;
mod over;
mod power;
mod reaction;
mod tsai_wu;
mod von_mises;

use super::build_parts::{located, nothing_builds, values};
use super::keys::NAME;
use super::known::{Builder, Entry, Found, Made};
use super::section::Section;
use crate::elements::entries::{Form, Forms, Kind, forms_of, joined};
use crate::functionals::quantities::QUANTITIES;
use measurand::Measurand;
use over::{OVER, over};

/// What is measured, in the order of the reference page.
const MEASURANDS: [Measurand; 20] = [
    formula::FORMULA,
    reaction::REACTION,
    reaction::REACTION_NORM,
    joint_load::JOINT_LOAD,
    joint_load::JOINT_POWER,
    energy::ENERGY,
    power::POWER,
    mass::MASS,
    energy::STRAIN_ENERGY,
    mass::INERTIA_MOMENT,
    von_mises::VON_MISES,
    tsai_wu::TSAI_WU,
    beam_section::SECTION_FORCE,
    beam_section::SECTION_FORCES,
    beam_section::SECTION_STRAIN,
    beam_section::FIBRE_STRESS,
    cable_section::CABLE_STRAIN,
    cable_section::CABLE_CURVATURE,
    cable_section::CABLE_STRESS,
    cable_section::LARGEST_CABLE_STRESS,
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
        let made = m.quantity_part(part, e.name(), over(&e), &nodes, values).map(|()| Made::Nothing);
        return located(made, e, m);
    }
    match MEASURANDS.iter().find(|own| own.form.name == e.form) {
        Some(own) => (own.add)(e, m).map(|()| Made::Nothing),
        None => nothing_builds(e),
    }
}
