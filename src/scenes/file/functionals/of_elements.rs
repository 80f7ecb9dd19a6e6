//! Energies, masses, powers and stresses of elements.

use super::{GROUP, Measurand};
use crate::elements::entries::AXIS;
use crate::elements::entries::names_of;
use crate::elements::forces::LOADS;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_ELEMENTS;

pub(super) const ENERGY: Measurand = Measurand {
    form: Form { name: "energy", doc: "energy of all elements [J]", keys: &[] },
    add: |e, over, m| {
        m.energy_functional(e.name(), over);
        Ok(())
    },
};

pub(super) const STRAIN_ENERGY: Measurand = Measurand {
    form: Form { name: "strain_energy", doc: "energy stored in strains [J]", keys: &[GROUP] },
    add: |e, over, m| {
        m.strain_energy_functional(e.name(), over, &e.group("of")?);
        Ok(())
    },
};

/// Sections whose entries put energy in or take it out.
const WITH_POWER: &[&str] = &joined::<&str, { LOADS.len() + WITH_ELEMENTS.len() + 6 }>(&[
    &["spring", "damper", "element"],
    &names_of::<{ LOADS.len() }, _>(LOADS),
    &["joint", "body", "point"],
    WITH_ELEMENTS,
]);

pub(super) const POWER: Measurand = Measurand {
    form: Form {
        name: "power",
        doc: "power of loads, dampers, actuators and losses, of all that is in no energy [W]; an integral is a work [J]",
        keys: &[may(
            "of",
            Type::Items(WITH_POWER),
            "names of loads, springs, dampers, parts of one's own, members or groups; everything",
        )],
    },
    add: |e, over, m| {
        match e.get("of") {
            None => m.total_power_functional(e.name(), over),
            Some(_) => m.power_functional(e.name(), over, &e.parts("of")?),
        }
        Ok(())
    },
};

const OF_SOME: Key = may(
    "of",
    Type::Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything",
);

pub(super) const MASS: Measurand = Measurand {
    form: Form { name: "mass", doc: "mass of some elements [kg]", keys: &[OF_SOME] },
    add: |e, over, m| {
        match e.get("of") {
            None => m.mass_functional(e.name(), over),
            Some(_) => m.group_mass_functional(e.name(), over, &e.group("of")?),
        }
        Ok(())
    },
};

pub(super) const INERTIA_MOMENT: Measurand = Measurand {
    form: Form {
        name: "inertia_moment",
        doc: "moment of inertia about an axis [kg m2]",
        keys: &[OF_SOME, may("point", Type::Vector("m"), "point of the axis; the origin"), AXIS],
    },
    add: |e, over, m| {
        let group = if e.get("of").is_some() { e.group("of")? } else { m.all_elements() };
        let point = e.vector_or("point", Vector3::zeros())?;
        m.inertia_moment_functional(e.name(), over, &group, point, e.vector("axis")?);
        Ok(())
    },
};

pub(super) const VON_MISES: Measurand = Measurand {
    form: Form {
        name: "von_mises",
        doc: "von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the \
              outer fibres of such cables",
        keys: &[GROUP, need("yield_stress", Type::Number("N/m2", Range::Positive), "yield stress")],
    },
    add: |e, over, m| {
        let group = e.group("of")?;
        m.von_mises_functional(e.name(), over, &group, e.number("yield_stress")?);
        Ok(())
    },
};

pub(super) const TSAI_WU: Measurand = Measurand {
    form: Form {
        name: "tsai_wu",
        doc: "failure ratio of Tsai and Wu in laminates [-]",
        keys: &[GROUP, need("laminate", Type::Item(&["laminate"]), "name of the laminate, whose plies have strengths")],
    },
    add: |e, over, m| {
        let (laminate, strengths) = e.laminate()?;
        m.tsai_wu_functional(e.name(), over, &e.group("of")?, laminate, strengths);
        Ok(())
    },
};
