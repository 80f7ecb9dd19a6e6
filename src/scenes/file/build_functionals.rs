//! Functionals of a file.

use super::build::{Builder, place};
use super::build_parts::measure;
use super::formula_parts;
use super::known::{Found, Known, Made, fixed, frame, over, text};
use super::mistake::Mistake;
use super::reader::Fields;
use crate::elements::forces::LoadFrame;
use crate::functionals::quantities::{CableMeasure, SectionMeasure};
use crate::functionals::{AggregateKind, LoadKind, Over, Times};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Number of a component of a section by its name.
fn component(fields: &Fields) -> usize {
    let names = ["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
    text(fields, "component").and_then(|own| names.iter().position(|name| *name == own)).unwrap_or(0)
}

/// What a functional measures.
pub(super) fn functional<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    if let Some(part) = known.own.quantity_named(fields.form) {
        return measure(known, part, name, fields, m);
    }
    let over = over(fields);
    let vector = |key| known.vector(fields, key);
    let share = fixed(fields, "share").unwrap_or(0.0);
    match fields.form {
        "formula" => return formula_parts::functional(known, name, fields, m),
        "reaction" => m.reaction_functional(name, over, known.joint(fields)?, &known.series(fields, "weights")?),
        "reaction_norm" => m.reaction_norm_functional(name, over, known.joint(fields)?),
        "joint_load" => {
            let node = known.node(fields, "on", m)?;
            let point = place(known, fields, "point", node, m)?;
            let kind = match text(fields, "load") {
                Some("force") => LoadKind::Force,
                Some("moment") => LoadKind::Moment,
                Some("force_norm") => LoadKind::ForceNorm,
                _ => LoadKind::MomentNorm,
            };
            // a point may be named for a force, too, which is the same at all of them
            if let (LoadKind::ForceNorm | LoadKind::MomentNorm, Some((at, _))) = (kind, fields.get("frame")) {
                return Err(Mistake::new(at, "frame has no effect on the size of a load: leave it out"));
            }
            let direction = match kind {
                LoadKind::Force | LoadKind::Moment => vector("direction")?,
                _ => Vector3::from_f64([1.0, 0.0, 0.0]),
            };
            let of = (known.joint(fields)?, node);
            m.joint_load_functional(name, over, of, (kind, frame(fields, LoadFrame::World)), direction, point);
        }
        "energy" => m.energy_functional(name, over),
        "mass" if fields.get("of").is_none() => m.mass_functional(name, over),
        "mass" => m.group_mass_functional(name, over, &known.group(fields, "of")?),
        "strain_energy" => m.strain_energy_functional(name, over, &known.group(fields, "of")?),
        "inertia_moment" => {
            let group = if fields.get("of").is_some() { known.group(fields, "of")? } else { m.all_elements() };
            let point = known.vector_or(fields, "point", Vector3::zeros())?;
            m.inertia_moment_functional(name, over, &group, point, vector("axis")?);
        }
        "von_mises" => {
            let yield_stress = known.number(fields, "yield_stress")?;
            m.von_mises_functional(name, over, &known.group(fields, "of")?, yield_stress);
        }
        "section_forces" => m.section_forces_functional(name, over, &known.group(fields, "of")?, component(fields)),
        "tsai_wu" => {
            let Made::Laminate(laminate, strengths) = known.made(fields, "laminate")? else {
                return Err(Mistake::new(fields.at, "laminate must name a laminate"));
            };
            m.tsai_wu_functional(name, over, &known.group(fields, "of")?, laminate, strengths);
        }
        "section_force" | "section_strain" | "fibre_stress" => {
            let Made::Beam(beam) = known.made(fields, "beam")? else {
                return Err(Mistake::new(fields.at, "beam must name a beam"));
            };
            match fields.form {
                "section_force" => {
                    m.section_functional(name, over, beam, share, SectionMeasure::Force(component(fields)));
                }
                "section_strain" => {
                    m.section_functional(name, over, beam, share, SectionMeasure::Strain(component(fields)));
                }
                _ => {
                    let (young, fibre) = (known.number(fields, "young")?, known.numbers(fields, "fibre")?);
                    m.fibre_stress_functional(name, over, (beam, share), young, fibre);
                }
            }
        }
        form => {
            let Made::Cable(cable) = known.made(fields, "cable")? else {
                return Err(Mistake::new(fields.at, "cable must name a cable"));
            };
            let distance = known.number_or(fields, "distance", 0.0)?;
            match form {
                "cable_strain" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Strain),
                "cable_curvature" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Curvature),
                "cable_stress" => {
                    m.cable_stress_functional(name, over, (cable, share), known.number(fields, "young")?, distance);
                }
                _ => {
                    let aggregate = match over {
                        Over::Aggregate { aggregate, times: Times::Run }
                            if aggregate.kind == (AggregateKind::SmoothMaximum { normalized: true }) =>
                        {
                            aggregate
                        }
                        _ => {
                            let at = fields.get("over").map_or(fields.at, |own| own.0);
                            let text =
                                "over of a largest_cable_stress must be { aggregate = \"smooth_maximum\", sharpness = .. }";
                            return Err(Mistake::new(at, text));
                        }
                    };
                    let young = known.number(fields, "young")?;
                    m.largest_cable_stress_functional(name, cable, young, distance, aggregate.sharpness);
                }
            }
        }
    }
    Ok(Made::Nothing)
}
