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
fn component(fields: &Fields) -> usize {
    text(fields, "component").and_then(|own| COMPONENTS.iter().position(|name| *name == own)).unwrap_or(0)
}

/// The beam that an entry names, and the share of its length at which the section is.
fn section<'k, S: Scalar>(known: &'k Known<S>, fields: &Fields) -> Found<(&'k BeamMember, f64)> {
    match known.made(fields, "beam")? {
        Made::Beam(beam) => Ok((beam, fixed(fields, "share").unwrap_or(0.0))),
        _ => Err(Mistake::new(fields.at, "beam must name a beam")),
    }
}

pub(super) struct SectionForce;

impl Measurand for SectionForce {
    const FORM: Form = Form {
        name: "section_force",
        doc: "force or moment in a section of a beam [N, N m]",
        keys: &[OF_BEAM, AT_SHARE, COMPONENT],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let (beam, share) = section(known, fields)?;
        m.section_functional(name, over(fields), beam, share, SectionMeasure::Force(component(fields)));
        Ok(())
    }
}

pub(super) struct SectionForces;

impl Measurand for SectionForces {
    const FORM: Form =
        Form { name: "section_forces", doc: "force or moment in all sections of beams [N, N m]", keys: &[GROUP, COMPONENT] };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        m.section_forces_functional(name, over(fields), &known.group(fields, "of")?, component(fields));
        Ok(())
    }
}

pub(super) struct SectionStrain;

impl Measurand for SectionStrain {
    const FORM: Form = Form {
        name: "section_strain",
        doc: "strain or curvature of a section of a beam [-, 1/m]",
        keys: &[OF_BEAM, AT_SHARE, COMPONENT],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let (beam, share) = section(known, fields)?;
        m.section_functional(name, over(fields), beam, share, SectionMeasure::Strain(component(fields)));
        Ok(())
    }
}

pub(super) struct FibreStress;

impl Measurand for FibreStress {
    const FORM: Form = Form {
        name: "fibre_stress",
        doc: "axial stress of a fibre of a beam [N/m2]",
        keys: &[
            OF_BEAM,
            AT_SHARE,
            need("young", Number("N/m2", Range::Positive), "Young's modulus"),
            need("fibre", Numbers(&[2], "m", Range::Any), "place of the fibre along axes 2 and 3"),
        ],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let section = section(known, fields)?;
        let (young, fibre) = (known.number(fields, "young")?, known.numbers(fields, "fibre")?);
        m.fibre_stress_functional(name, over(fields), section, young, fibre);
        Ok(())
    }
}
