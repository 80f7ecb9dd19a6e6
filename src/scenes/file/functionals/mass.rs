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

pub(super) struct Mass;

impl Measurand for Mass {
    const FORM: Form = Form { name: "mass", doc: "mass of some elements [kg]", keys: &[OF_SOME] };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        match fields.get("of") {
            None => m.mass_functional(name, over(fields)),
            Some(_) => m.group_mass_functional(name, over(fields), &known.group(fields, "of")?),
        }
        Ok(())
    }
}

pub(super) struct InertiaMoment;

impl Measurand for InertiaMoment {
    const FORM: Form = Form {
        name: "inertia_moment",
        doc: "moment of inertia about an axis [kg m2]",
        keys: &[OF_SOME, may("point", Type::Vector("m"), "point of the axis; the origin"), AXIS],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let group = if fields.get("of").is_some() { known.group(fields, "of")? } else { m.all_elements() };
        let point = known.vector_or(fields, "point", Vector3::zeros())?;
        m.inertia_moment_functional(name, over(fields), &group, point, known.vector(fields, "axis")?);
        Ok(())
    }
}
