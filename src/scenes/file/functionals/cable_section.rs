//! What sections of cables bear, and how they deform.

use super::measurand::{AT_SHARE, Measurand};
use super::over::over;
use crate::functionals::quantities::CableMeasure;
use crate::functionals::{AggregateKind, Over, Times};
use crate::scenes::CableMember;
use crate::scenes::file::describing::*;

const OF_CABLE: Key = need("cable", Type::Item(&["cable"]), "name of a cable");
const YOUNG: Key = need("young", Number("N/m2", Range::Positive), "Young's modulus");

/// The cable that an entry names.
fn cable<'k, S: Scalar>(known: &'k Known<S>, fields: &Fields) -> Found<&'k CableMember> {
    match known.made(fields, "cable")? {
        Made::Cable(cable) => Ok(cable),
        _ => Err(Mistake::new(fields.at, "cable must name a cable")),
    }
}

/// The same, and the share of its length at which the section is.
fn section<'k, S: Scalar>(known: &'k Known<S>, fields: &Fields) -> Found<(&'k CableMember, f64)> {
    Ok((cable(known, fields)?, fixed(fields, "share").unwrap_or(0.0)))
}

pub(super) struct CableStrain;

impl Measurand for CableStrain {
    const FORM: Form = Form { name: "cable_strain", doc: "axial strain of a cable [-]", keys: &[OF_CABLE, AT_SHARE] };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let (cable, share) = section(known, fields)?;
        m.cable_strain_functional(name, over(fields), cable, share, CableMeasure::Strain);
        Ok(())
    }
}

pub(super) struct CableCurvature;

impl Measurand for CableCurvature {
    const FORM: Form = Form { name: "cable_curvature", doc: "curvature of a cable [1/m]", keys: &[OF_CABLE, AT_SHARE] };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let (cable, share) = section(known, fields)?;
        m.cable_strain_functional(name, over(fields), cable, share, CableMeasure::Curvature);
        Ok(())
    }
}

pub(super) struct CableStress;

impl Measurand for CableStress {
    const FORM: Form = Form {
        name: "cable_stress",
        doc: "axial stress of a fibre of a cable [N/m2]",
        keys: &[OF_CABLE, AT_SHARE, YOUNG, may("distance", Number("m", Range::Any), "of the fibre from the axis; 0")],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let section = section(known, fields)?;
        let distance = known.number_or(fields, "distance", 0.0)?;
        m.cable_stress_functional(name, over(fields), section, known.number(fields, "young")?, distance);
        Ok(())
    }
}

pub(super) struct LargestCableStress;

impl Measurand for LargestCableStress {
    const FORM: Form = Form {
        name: "largest_cable_stress",
        doc: "smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate smooth_maximum of the run",
        keys: &[OF_CABLE, YOUNG, need("distance", Number("m", Range::AtLeastZero), "of the outer fibres from the axis")],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let cable = cable(known, fields)?;
        let distance = known.number(fields, "distance")?;
        match over(fields) {
            Over::Aggregate { aggregate, times: Times::Run }
                if aggregate.kind == (AggregateKind::SmoothMaximum { normalized: true }) =>
            {
                let young = known.number(fields, "young")?;
                m.largest_cable_stress_functional(name, cable, young, distance, aggregate.sharpness);
                Ok(())
            }
            _ => {
                let text = format!("over of a {} must be {{ aggregate = \"smooth_maximum\", sharpness = .. }}", fields.form);
                Err(Mistake::new(fields.at("over"), text))
            }
        }
    }
}
