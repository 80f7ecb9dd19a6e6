//! Laminates of shells.

use crate::elements::flexible::{Laminate, Ply, PlyStrength};
use crate::scenes::file::describing::*;

const PLY: Forms = one_form![
    need("thickness", Number("m", Positive), "thickness"),
    may("angle", Number("rad", Any), "from axis 1 of the shell to the fibres; 0"),
    need("young", Numbers(&[2], "N/m2", Positive), "E_1 along the fibres, E_2 across"),
    need("poisson", Number("-", Any), "nu_12"),
    need("shear", Numbers(&[3], "N/m2", Positive), "G_12, G_13, G_23"),
    need("density", Number("kg/m3", AtLeastZero), "density"),
    may("tension", Numbers(&[2], "N/m2", Positive), "strengths in tension, along and across; for tsai_wu"),
    may("compression", Numbers(&[2], "N/m2", Positive), "strengths in compression, along and across; for tsai_wu"),
    may("shear_strength", Number("N/m2", Positive), "strength in shear; for tsai_wu"),
];

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("plies", at_least(0, &Table(&PLY)), "plies"),
        may("offset", Number("m", Any), "of the middle of all plies from the nodes, along the normal; 0"),
        may("shear_factor", Fixed("-", Positive), "share of the shear stiffness that acts; 5/6"),
    ],
    build,
    ..Section::named("laminate", "Plies of a shell, from below.")
};

pub(super) fn build(e: Entry, _: &mut Builder) -> Result<Built> {
    let (mut plies, mut strengths) = (Vec::new(), Vec::new());
    for own in e.tables("plies") {
        plies.push(Ply {
            thickness: own.number("thickness")?,
            angle: own.number_or("angle", 0.0)?,
            young: own.numbers("young")?,
            poisson: own.number("poisson")?,
            shear: own.numbers("shear")?,
            density: own.number("density")?,
        });
        if own.has("tension") {
            strengths.push(PlyStrength {
                tension: own.numbers("tension")?,
                compression: own.numbers("compression")?,
                shear: own.number("shear_strength")?,
            });
        }
    }
    let mut laminate = Laminate::new(plies).offset(e.number_or("offset", 0.0)?);
    laminate.shear_factor = e.fixed("shear_factor").unwrap_or(laminate.shear_factor);
    Ok(Built::Laminate(laminate, strengths))
}
