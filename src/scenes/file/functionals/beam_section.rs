//! What sections of beams bear, and how they deform.

use super::measurand::{AT_SHARE, GROUP, Measurand};
use super::over::over;
use crate::functionals::quantities::SectionMeasure;
use crate::scenes::BeamMember;
use crate::scenes::file::describing::*;

const OF_BEAM: Key = need("beam", Type::Item(&["beam"]), "name of a beam");
const COMPONENTS: &[&str] = &["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
const COMPONENT: Key =
    need("component", Choice(COMPONENTS), "axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3");

/// Number of a component by its name.
fn component(e: &Fields) -> usize {
    e.text("component").and_then(|own| COMPONENTS.iter().position(|name| *name == own)).unwrap_or(0)
}

/// The beam that an entry names, and the share of its length at which the section is.
fn section<'k>(e: Entry<'k>) -> Found<(&'k BeamMember, f64)> {
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
    add: |e, m| {
        let (beam, share) = section(e)?;
        m.section_functional(e.name(), over(&e), beam, share, SectionMeasure::Force(component(&e)));
        Ok(())
    },
};

pub(super) const SECTION_FORCES: Measurand = Measurand {
    form: Form {
        name: "section_forces",
        doc: "force or moment in all sections of beams [N, N m]",
        keys: &[GROUP, COMPONENT],
    },
    add: |e, m| {
        m.section_forces_functional(e.name(), over(&e), &e.group("of")?, component(&e));
        Ok(())
    },
};

pub(super) const SECTION_STRAIN: Measurand = Measurand {
    form: Form {
        name: "section_strain",
        doc: "strain or curvature of a section of a beam [-, 1/m]",
        keys: &[OF_BEAM, AT_SHARE, COMPONENT],
    },
    add: |e, m| {
        let (beam, share) = section(e)?;
        m.section_functional(e.name(), over(&e), beam, share, SectionMeasure::Strain(component(&e)));
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
    add: |e, m| {
        let section = section(e)?;
        let (young, fibre) = (e.number("young")?, e.numbers("fibre")?);
        m.fibre_stress_functional(e.name(), over(&e), section, young, fibre);
        Ok(())
    },
};
