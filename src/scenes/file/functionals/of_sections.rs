//! What sections of beams and cables bear, and how they deform.

use super::{AT_SHARE, GROUP, Measurand};
use crate::functionals::quantities::{CableMeasure, SectionMeasure};
use crate::functionals::{AggregateKind, Over, Times};
use crate::scenes::file::describing::*;
use crate::scenes::{BeamMember, CableMember};

const OF_BEAM: Key = need("beam", Type::Item(&["beam"]), "name of a beam");
const COMPONENTS: &[&str] = &["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
const COMPONENT: Key =
    need("component", Choice(COMPONENTS), "axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3");

/// Number of a component by its name.
fn component(e: &Fields) -> usize {
    e.text("component").and_then(|own| COMPONENTS.iter().position(|name| *name == own)).unwrap_or(0)
}

/// The beam that an entry names, and the share of its length at which the section is.
fn beam_section(e: Entry<'_>) -> Found<(&BeamMember, f64)> {
    match e.made("beam")? {
        Made::Beam(beam) => Ok((beam, e.fixed("share").unwrap_or(0.0))),
        _ => e.wrong("beam must name a beam"),
    }
}

pub(super) const SECTION_FORCE: Measurand = Measurand {
    form: Form {
        name: "section_force",
        doc: "force or moment in a section of a beam [N, N m]",
        keys: &[OF_BEAM, AT_SHARE, COMPONENT],
    },
    add: |e, over, m| {
        let (beam, share) = beam_section(e)?;
        m.section_functional(e.name(), over, beam, share, SectionMeasure::Force(component(&e)));
        Ok(())
    },
};

pub(super) const SECTION_FORCES: Measurand = Measurand {
    form: Form {
        name: "section_forces",
        doc: "force or moment in all sections of beams [N, N m]",
        keys: &[GROUP, COMPONENT],
    },
    add: |e, over, m| {
        m.section_forces_functional(e.name(), over, &e.group("of")?, component(&e));
        Ok(())
    },
};

pub(super) const SECTION_STRAIN: Measurand = Measurand {
    form: Form {
        name: "section_strain",
        doc: "strain or curvature of a section of a beam [-, 1/m]",
        keys: &[OF_BEAM, AT_SHARE, COMPONENT],
    },
    add: |e, over, m| {
        let (beam, share) = beam_section(e)?;
        m.section_functional(e.name(), over, beam, share, SectionMeasure::Strain(component(&e)));
        Ok(())
    },
};

pub(super) const FIBRE_STRESS: Measurand = Measurand {
    form: Form {
        name: "fibre_stress",
        doc: "axial stress of a fibre of a beam [N/m2]",
        keys: &[
            OF_BEAM,
            AT_SHARE,
            need("young", Number("N/m2", Range::Positive), "Young's modulus"),
            need("fibre", Numbers(&[2], "m", Range::Any), "place of the fibre along axes 2 and 3"),
        ],
    },
    add: |e, over, m| {
        let section = beam_section(e)?;
        let (young, fibre) = (e.number("young")?, e.numbers("fibre")?);
        m.fibre_stress_functional(e.name(), over, section, young, fibre);
        Ok(())
    },
};

const OF_CABLE: Key = need("cable", Type::Item(&["cable"]), "name of a cable");
const YOUNG: Key = need("young", Number("N/m2", Range::Positive), "Young's modulus");

/// The cable that an entry names.
fn cable(e: Entry<'_>) -> Found<&CableMember> {
    match e.made("cable")? {
        Made::Cable(cable) => Ok(cable),
        _ => e.wrong("cable must name a cable"),
    }
}

/// The same, and the share of its length at which the section is.
fn cable_section(e: Entry<'_>) -> Found<(&CableMember, f64)> {
    Ok((cable(e)?, e.fixed("share").unwrap_or(0.0)))
}

pub(super) const CABLE_STRAIN: Measurand = Measurand {
    form: Form { name: "cable_strain", doc: "axial strain of a cable [-]", keys: &[OF_CABLE, AT_SHARE] },
    add: |e, over, m| {
        let (cable, share) = cable_section(e)?;
        m.cable_strain_functional(e.name(), over, cable, share, CableMeasure::Strain);
        Ok(())
    },
};

pub(super) const CABLE_CURVATURE: Measurand = Measurand {
    form: Form { name: "cable_curvature", doc: "curvature of a cable [1/m]", keys: &[OF_CABLE, AT_SHARE] },
    add: |e, over, m| {
        let (cable, share) = cable_section(e)?;
        m.cable_strain_functional(e.name(), over, cable, share, CableMeasure::Curvature);
        Ok(())
    },
};

pub(super) const CABLE_STRESS: Measurand = Measurand {
    form: Form {
        name: "cable_stress",
        doc: "axial stress of a fibre of a cable [N/m2]",
        keys: &[OF_CABLE, AT_SHARE, YOUNG, may("distance", Number("m", Range::Any), "of the fibre from the axis; 0")],
    },
    add: |e, over, m| {
        let section = cable_section(e)?;
        let distance = e.number_or("distance", 0.0)?;
        m.cable_stress_functional(e.name(), over, section, e.number("young")?, distance);
        Ok(())
    },
};

pub(super) const LARGEST_CABLE_STRESS: Measurand = Measurand {
    form: Form {
        name: "largest_cable_stress",
        doc: "smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate smooth_maximum of the run",
        keys: &[OF_CABLE, YOUNG, need("distance", Number("m", Range::AtLeastZero), "of the outer fibres from the axis")],
    },
    add: |e, over, m| {
        let cable = cable(e)?;
        let distance = e.number("distance")?;
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
};
