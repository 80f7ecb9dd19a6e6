//! Energies, masses, powers and stresses of elements.

use super::{GROUP, Measurand, measurand};
use crate::elements::entries::{AXIS, names_of};
use crate::elements::forces::LOADS;
use crate::scenes::file::describing::*;

/// Sections whose entries put energy in or take it out.
const WITH_POWER: &[&str] = &joined::<&str, { LOADS.len() + WITH_ELEMENTS.len() + 6 }>(&[
    &["spring", "damper", "element"],
    &names_of::<{ LOADS.len() }, _>(LOADS),
    &["joint", "body", "point"],
    WITH_ELEMENTS,
]);

const OF_SOME: Key = may(
    "of",
    Type::OneOrMore(&Type::Item(WITH_ELEMENTS)),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything",
);

pub(super) const OF_ELEMENTS: &[Measurand] = &[
    measurand("energy", "energy of all elements [J]", &[], |e, over, m| {
        m.energy_functional(e.name(), over);
        Ok(())
    }),
    measurand(
        "power",
        "power of loads, dampers, actuators and losses, of all that is in no energy [W]; an integral is a work [J]",
        &[may(
            "of",
            Type::OneOrMore(&Type::Item(WITH_POWER)),
            "names of loads, springs, dampers, parts of one's own, members or groups; everything",
        )],
        |e, over, m| {
            match e.has("of") {
                true => m.power_functional(e.name(), over, &e.parts("of")?),
                false => m.total_power_functional(e.name(), over),
            }
            Ok(())
        },
    ),
    measurand("mass", "mass of some elements [kg]", &[OF_SOME], |e, over, m| {
        match e.has("of") {
            true => m.group_mass_functional(e.name(), over, &e.group("of")?),
            false => m.mass_functional(e.name(), over),
        }
        Ok(())
    }),
    measurand("strain_energy", "energy stored in strains [J]", &[GROUP], |e, over, m| {
        m.strain_energy_functional(e.name(), over, &e.group("of")?);
        Ok(())
    }),
    measurand(
        "inertia_moment",
        "moment of inertia about an axis [kg m2]",
        &[OF_SOME, may("point", Type::Vector("m"), "point of the axis; the origin"), AXIS],
        |e, over, m| {
            let group = if e.has("of") { e.group("of")? } else { m.all_elements() };
            let point = e.vector_or("point", Vector3::zeros())?;
            m.inertia_moment_functional(e.name(), over, &group, point, e.vector("axis")?);
            Ok(())
        },
    ),
    measurand(
        "von_mises",
        "von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the \
         outer fibres of such cables",
        &[GROUP, need("yield_stress", Type::Number("N/m2", Range::Positive), "yield stress")],
        |e, over, m| {
            let group = e.group("of")?;
            m.von_mises_functional(e.name(), over, &group, e.number("yield_stress")?);
            Ok(())
        },
    ),
    measurand(
        "tsai_wu",
        "failure ratio of Tsai and Wu in laminates [-]",
        &[GROUP, need("laminate", Type::Item(&["laminate"]), "name of the laminate, whose plies have strengths")],
        |e, over, m| {
            let (laminate, strengths) = e.laminate()?;
            m.tsai_wu_functional(e.name(), over, &e.group("of")?, laminate, strengths);
            Ok(())
        },
    ),
];
