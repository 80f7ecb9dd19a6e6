//! Functionals of a file.

use super::build_parts::{made_of, measure, values};
use super::fields::{Fields, Item};
use super::formula_parts;
use super::known::{Builder, Found, Known, Made, fixed, over, text};
use super::mistake::Mistake;
use super::sections::SECTION_COMPONENTS;
use crate::functionals::load::JOINT_LOADS;
use crate::functionals::quantities::{CableMeasure, SectionMeasure};
use crate::functionals::{AggregateKind, JointLoad, Over, Times};
use crate::scalar::{Scalar, Vector3};

/// Number of a component of a section by its name.
fn component(fields: &Fields) -> usize {
    text(fields, "component").and_then(|own| SECTION_COMPONENTS.iter().position(|name| *name == own)).unwrap_or(0)
}

/// What a functional measures.
pub(super) fn functional<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let Item { name, fields, .. } = item;
    if let Some(part) = known.own.quantity_named(fields.form) {
        return measure(known, part, item, m);
    }
    match fields.form {
        "formula" => return formula_parts::functional(known, name, fields, m),
        "energy" => m.energy_functional(name, over(fields)),
        "reaction" | "reaction_norm" | "joint_load" | "joint_power" => of_joint(known, name, fields, m)?,
        "section_force" | "section_strain" | "fibre_stress" => of_beam(known, name, fields, m)?,
        "cable_strain" | "cable_curvature" | "cable_stress" | "largest_cable_stress" => of_cable(known, name, fields, m)?,
        _ => of_group(known, name, fields, m)?,
    }
    Ok(Made::Nothing)
}

/// Of a joint: its multipliers, or what it does to a node.
fn of_joint<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<()> {
    let (joint, over) = (known.joint(fields)?, over(fields));
    match fields.form {
        "reaction" => m.reaction_functional(name, over, joint, &known.series(fields, "weights")?),
        "reaction_norm" => m.reaction_norm_functional(name, over, joint),
        "joint_power" => {
            let on = fields.get("on").map(|_| known.node(fields, "on", m)).transpose()?;
            m.joint_power_functional(name, over, joint, on);
        }
        _ => {
            let node = known.node(fields, "on", m)?;
            let given = m.given(name, &[node], values(known, fields, JOINT_LOADS.keys("joint_load"))?);
            let (load, [direction, point]) = made_of(fields, given, JointLoad::given)?;
            m.joint_load_functional(name, over, (joint, node), load, direction, point);
        }
    }
    Ok(())
}

/// Of elements: the group of the key `of`, or everything where that may be left out.
fn of_group<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<()> {
    let over = over(fields);
    let group = || known.group(fields, "of");
    match fields.form {
        "mass" if fields.get("of").is_none() => m.mass_functional(name, over),
        "mass" => m.group_mass_functional(name, over, &group()?),
        "power" if fields.get("of").is_none() => m.total_power_functional(name, over),
        "power" => m.power_functional(name, over, &known.parts(fields, "of")?),
        "strain_energy" => m.strain_energy_functional(name, over, &group()?),
        "inertia_moment" => {
            let group = if fields.get("of").is_some() { group()? } else { m.all_elements() };
            let point = known.vector_or(fields, "point", Vector3::zeros())?;
            m.inertia_moment_functional(name, over, &group, point, known.vector(fields, "axis")?);
        }
        "von_mises" => m.von_mises_functional(name, over, &group()?, known.number(fields, "yield_stress")?),
        "section_forces" => m.section_forces_functional(name, over, &group()?, component(fields)),
        _ => {
            let Made::Laminate(laminate, strengths) = known.made(fields, "laminate")? else {
                return Err(Mistake::new(fields.at, "laminate must name a laminate"));
            };
            m.tsai_wu_functional(name, over, &group()?, laminate, strengths);
        }
    }
    Ok(())
}

/// Of a section of a beam.
fn of_beam<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<()> {
    let Made::Beam(beam) = known.made(fields, "beam")? else {
        return Err(Mistake::new(fields.at, "beam must name a beam"));
    };
    let (over, share) = (over(fields), fixed(fields, "share").unwrap_or(0.0));
    match fields.form {
        "section_force" => m.section_functional(name, over, beam, share, SectionMeasure::Force(component(fields))),
        "section_strain" => m.section_functional(name, over, beam, share, SectionMeasure::Strain(component(fields))),
        _ => {
            let (young, fibre) = (known.number(fields, "young")?, known.numbers(fields, "fibre")?);
            m.fibre_stress_functional(name, over, (beam, share), young, fibre);
        }
    }
    Ok(())
}

/// Of a section of a cable, or of all of them.
fn of_cable<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<()> {
    let Made::Cable(cable) = known.made(fields, "cable")? else {
        return Err(Mistake::new(fields.at, "cable must name a cable"));
    };
    let (over, share) = (over(fields), fixed(fields, "share").unwrap_or(0.0));
    let (young, distance) = (|| known.number(fields, "young"), known.number_or(fields, "distance", 0.0)?);
    match fields.form {
        "cable_strain" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Strain),
        "cable_curvature" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Curvature),
        "cable_stress" => m.cable_stress_functional(name, over, (cable, share), young()?, distance),
        _ => match over {
            Over::Aggregate { aggregate, times: Times::Run }
                if aggregate.kind == (AggregateKind::SmoothMaximum { normalized: true }) =>
            {
                m.largest_cable_stress_functional(name, cable, young()?, distance, aggregate.sharpness);
            }
            _ => {
                let at = fields.get("over").map_or(fields.at, |own| own.0);
                let text = "over of a largest_cable_stress must be { aggregate = \"smooth_maximum\", sharpness = .. }";
                return Err(Mistake::new(at, text));
            }
        },
    }
    Ok(())
}
