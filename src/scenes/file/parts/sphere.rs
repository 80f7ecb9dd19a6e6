//! Closed spheres of shells.

use crate::elements::flexible::MATERIAL;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        may("centre", Vector("m"), "centre; the origin"),
        need("radius", Number("m", Positive), "radius"),
        need("elements", Count(1, 100), "elements along each edge of a face"),
        MATERIAL,
        need("thickness", Number("m", Positive), "thickness"),
    ],
    build: |e, m| {
        let place = (e.vector_or("centre", Vector3::zeros())?, e.number("radius")?);
        let (material, thickness) = (e.material()?, e.number("thickness")?);
        Ok(Built::Sphere(m.sphere_shell(e.name(), place, e.count("elements"), &material, thickness)))
    },
    ..Section::with_nodes(
        "sphere",
        "A closed sphere of shells, of six faces.",
        Nodes { edges: &[], own: 3, of_edge: 0, known: OF_BODY },
    )
};
