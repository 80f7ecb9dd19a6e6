//! What sections of beams and cables bear, and how they deform.

use super::{GROUP, Measurand, measurand};
use crate::functionals::quantities::{CableMeasure, SectionMeasure};
use crate::functionals::{AggregateKind, Over, Times};
use crate::scenes::file::describing::*;
use crate::scenes::{BeamMember, CableMember};

/// A section of a beam or cable.
const AT_SHARE: Key = need("share", Fixed("-", Range::Share), "place along its length, from 0 to 1");
const OF_BEAM: Key = need("beam", Type::Item(&["beam"]), "name of a beam");
const COMPONENTS: &[&str] = &["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
const COMPONENT: Key =
    need("component", Choice(COMPONENTS), "axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3");
const OF_CABLE: Key = need("cable", Type::Item(&["cable"]), "name of a cable");
const YOUNG: Key = need("young", Number("N/m2", Positive), "Young's modulus");

/// Number of a component by its name.
fn component(e: &Fields) -> usize {
    e.text("component").and_then(|own| COMPONENTS.iter().position(|name| *name == own)).unwrap_or(0)
}

/// The beam that an entry names, and the share of its length at which the section is.
fn beam_section(e: Entry<'_>) -> Result<(&BeamMember, f64)> {
    match e.built("beam")? {
        Built::Beam(beam) => Ok((beam, e.fixed("share").unwrap_or(0.0))),
        _ => e.wrong("beam must name a beam"),
    }
}

/// Adds a measure of a component in a section of a beam.
fn add_measure(e: Entry, over: Over, m: &mut Builder, measure: fn(usize) -> SectionMeasure) -> Result<()> {
    let (beam, share) = beam_section(e)?;
    m.section_functional(e.name(), over, beam, share, measure(component(&e)));
    Ok(())
}

/// The cable that an entry names, and the share of its length at which the section is, where it is at one.
fn cable_section(e: Entry<'_>) -> Result<(&CableMember, f64)> {
    match e.built("cable")? {
        Built::Cable(cable) => Ok((cable, e.fixed("share").unwrap_or(0.0))),
        _ => e.wrong("cable must name a cable"),
    }
}

/// Adds a measure of a section of a cable.
fn add_cable_measure(e: Entry, over: Over, m: &mut Builder, measure: CableMeasure) -> Result<()> {
    let (cable, share) = cable_section(e)?;
    m.cable_strain_functional(e.name(), over, cable, share, measure);
    Ok(())
}

pub(super) const OF_SECTIONS: &[Measurand] = &[
    measurand(
        "section_force",
        "force or moment in a section of a beam [N, N m]",
        &[OF_BEAM, AT_SHARE, COMPONENT],
        |e, over, m| add_measure(e, over, m, SectionMeasure::Force),
    ),
    measurand("section_forces", "force or moment in all sections of beams [N, N m]", &[GROUP, COMPONENT], |e, over, m| {
        m.section_forces_functional(e.name(), over, &e.group("of")?, component(&e));
        Ok(())
    }),
    measurand(
        "section_strain",
        "strain or curvature of a section of a beam [-, 1/m]",
        &[OF_BEAM, AT_SHARE, COMPONENT],
        |e, over, m| add_measure(e, over, m, SectionMeasure::Strain),
    ),
    measurand(
        "fibre_stress",
        "axial stress of a fibre of a beam [N/m2]",
        &[OF_BEAM, AT_SHARE, YOUNG, need("fibre", Numbers(&[2], "m", Any), "place of the fibre along axes 2 and 3")],
        |e, over, m| {
            let section = beam_section(e)?;
            let (young, fibre) = (e.number("young")?, e.numbers("fibre")?);
            m.fibre_stress_functional(e.name(), over, section, young, fibre);
            Ok(())
        },
    ),
    measurand("cable_strain", "axial strain of a cable [-]", &[OF_CABLE, AT_SHARE], |e, over, m| {
        add_cable_measure(e, over, m, CableMeasure::Strain)
    }),
    measurand("cable_curvature", "curvature of a cable [1/m]", &[OF_CABLE, AT_SHARE], |e, over, m| {
        add_cable_measure(e, over, m, CableMeasure::Curvature)
    }),
    measurand(
        "cable_stress",
        "axial stress of a fibre of a cable [N/m2]",
        &[OF_CABLE, AT_SHARE, YOUNG, may("distance", Number("m", Any), "of the fibre from the axis; 0")],
        |e, over, m| {
            let section = cable_section(e)?;
            let distance = e.number_or("distance", 0.0)?;
            m.cable_stress_functional(e.name(), over, section, e.number("young")?, distance);
            Ok(())
        },
    ),
    measurand(
        "largest_cable_stress",
        "smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate smooth_maximum of the run",
        &[OF_CABLE, YOUNG, need("distance", Number("m", AtLeastZero), "of the outer fibres from the axis")],
        |e, over, m| {
            let ((cable, _), distance) = (cable_section(e)?, e.number("distance")?);
            match over {
                Over::Aggregate { aggregate, times: Times::Run }
                    if aggregate.kind == (AggregateKind::SmoothMaximum { normalized: true }) =>
                {
                    let young = e.number("young")?;
                    m.largest_cable_stress_functional(e.name(), cable, young, distance, aggregate.sharpness);
                    Ok(())
                }
                _ => {
                    let text = format!("over of a {} must be {{ aggregate = \"smooth_maximum\", sharpness = .. }}", e.form);
                    e.wrong_key("over", text)
                }
            }
        },
    ),
];
