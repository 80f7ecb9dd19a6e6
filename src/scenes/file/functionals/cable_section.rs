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
fn cable<'k>(e: Entry<'k>) -> Found<&'k CableMember> {
    match e.made("cable")? {
        Made::Cable(cable) => Ok(cable),
        _ => e.wrong("cable must name a cable"),
    }
}

/// The same, and the share of its length at which the section is.
fn section<'k>(e: Entry<'k>) -> Found<(&'k CableMember, f64)> {
    Ok((cable(e)?, e.fixed("share").unwrap_or(0.0)))
}

pub(super) const CABLE_STRAIN: Measurand = Measurand {
    form: Form { name: "cable_strain", doc: "axial strain of a cable [-]", keys: &[OF_CABLE, AT_SHARE] },
    add: |e, m| {
        let (cable, share) = section(e)?;
        m.cable_strain_functional(e.name(), over(&e), cable, share, CableMeasure::Strain);
        Ok(())
    },
};

pub(super) const CABLE_CURVATURE: Measurand = Measurand {
    form: Form { name: "cable_curvature", doc: "curvature of a cable [1/m]", keys: &[OF_CABLE, AT_SHARE] },
    add: |e, m| {
        let (cable, share) = section(e)?;
        m.cable_strain_functional(e.name(), over(&e), cable, share, CableMeasure::Curvature);
        Ok(())
    },
};

pub(super) const CABLE_STRESS: Measurand = Measurand {
    form: Form {
        name: "cable_stress",
        doc: "axial stress of a fibre of a cable [N/m2]",
        keys: &[OF_CABLE, AT_SHARE, YOUNG, may("distance", Number("m", Range::Any), "of the fibre from the axis; 0")],
    },
    add: |e, m| {
        let section = section(e)?;
        let distance = e.number_or("distance", 0.0)?;
        m.cable_stress_functional(e.name(), over(&e), section, e.number("young")?, distance);
        Ok(())
    },
};

pub(super) const LARGEST_CABLE_STRESS: Measurand = Measurand {
    form: Form {
        name: "largest_cable_stress",
        doc: "smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate smooth_maximum of the run",
        keys: &[OF_CABLE, YOUNG, need("distance", Number("m", Range::AtLeastZero), "of the outer fibres from the axis")],
    },
    add: |e, m| {
        let cable = cable(e)?;
        let distance = e.number("distance")?;
        match over(&e) {
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
