//! Closed spheres of shells.

use crate::elements::flexible::MATERIAL;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "sphere",
    shape: Shape::Listed,
    doc: "A closed sphere of shells, of six faces.",
    forms: one_form![
        NAME,
        may("centre", Vector("m"), "centre; the origin"),
        need("radius", Number("m", Positive), "radius"),
        need("elements", Count(1, 100), "elements along each edge of a face"),
        MATERIAL,
        need("thickness", Number("m", Positive), "thickness"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let place = (known.vector_or(fields, "centre", Vector3::zeros())?, known.number(fields, "radius")?);
    let (material, thickness) = (known.material(fields)?, known.number(fields, "thickness")?);
    Ok(Made::Sphere(m.sphere_shell(name, place, count(fields, "elements"), &material, thickness)))
}
