//! Points.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "point",
    shape: Shape::Listed,
    doc: "A point without rotation.",
    forms: one_form![
        NAME,
        need("position", Vector("m"), "place"),
        may("velocity", Vector("m/s"), "velocity; 0"),
        may("mass", Number("kg", Positive), "mass; none"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let node = m.point(name, known.vector(fields, "position")?);
    if fields.get("velocity").is_some() {
        m.set_velocity(node, known.vector(fields, "velocity")?, Vector3::zeros());
    }
    if fields.get("mass").is_some() {
        m.point_mass(name, node, known.number(fields, "mass")?);
    }
    Ok(Made::Node(node))
}
