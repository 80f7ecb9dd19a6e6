//! Mass and its moments.

use super::measurand::Measurand;
use super::over::over;
use crate::elements::entries::AXIS;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_ELEMENTS;

const OF_SOME: Key = may(
    "of",
    Type::Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything",
);

pub(super) const MASS: Measurand = Measurand {
    form: Form { name: "mass", doc: "mass of some elements [kg]", keys: &[OF_SOME] },
    add: |e, m| {
        match e.get("of") {
            None => m.mass_functional(e.name(), over(&e)),
            Some(_) => m.group_mass_functional(e.name(), over(&e), &e.group("of")?),
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
    add: |e, m| {
        let group = if e.get("of").is_some() { e.group("of")? } else { m.all_elements() };
        let point = e.vector_or("point", Vector3::zeros())?;
        m.inertia_moment_functional(e.name(), over(&e), &group, point, e.vector("axis")?);
        Ok(())
    },
};
