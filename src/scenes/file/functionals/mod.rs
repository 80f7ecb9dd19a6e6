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
use super::fields::Item;
use super::keys::NAME;
use super::known::{Builder, Found, Known, Made};
use super::section::{Section, Shape};
use crate::elements::entries::{Form, Forms, Kind, forms_of, joined};
use crate::functionals::quantities::QUANTITIES;
use crate::scalar::Scalar;
use measurand::Measurand;
use over::{OVER, over};

/// The list of what is measured: its forms, in the order of the reference page, and which of them adds an entry.
macro_rules! measurands {
    ($($own:ty),* $(,)?) => {
        const FORMS: &[Form] = &[$(<$own>::FORM),*];

        fn add<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<()> {
            match item.fields.form {
                $(form if form == <$own>::FORM.name => <$own>::add(known, item, m),)*
                _ => Err(nothing_builds(item)),
            }
        }
    };
}

measurands![
    formula::Formula,
    reaction::Reaction,
    reaction::ReactionNorm,
    joint_load::JointLoad,
    joint_load::JointPower,
    energy::Energy,
    power::Power,
    mass::Mass,
    energy::StrainEnergy,
    mass::InertiaMoment,
    von_mises::VonMises,
    tsai_wu::TsaiWu,
    beam_section::SectionForce,
    beam_section::SectionForces,
    beam_section::SectionStrain,
    beam_section::FibreStress,
    cable_section::CableStrain,
    cable_section::CableCurvature,
    cable_section::CableStress,
    cable_section::LargestCableStress,
];

const ALL_FORMS: [Form; QUANTITIES.len() + FORMS.len()] = joined(&[&forms_of::<{ QUANTITIES.len() }, _>(QUANTITIES), FORMS]);

pub(super) const SECTION: Section = Section {
    name: "functional",
    shape: Shape::Listed,
    doc: "A number that a run gives, with its gradient.",
    forms: Forms { common: &[NAME, OVER], forms: &ALL_FORMS, own: Some(Kind::Functional) },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let Item { name, fields, .. } = item;
    let Some(part) = known.own.quantity_named(fields.form) else {
        return add(known, item, m).map(|()| Made::Nothing);
    };
    let (nodes, values) = (known.nodes_of_part(fields, m)?, values(known, fields, part.form.keys)?);
    let made = m.quantity_part(part, name, over(fields), &nodes, values).map(|()| Made::Nothing);
    located(made, item, m)
}
