//! Points.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        need("position", Vector("m"), "place"),
        may("velocity", Vector("m/s"), "velocity; 0"),
        may("mass", Number("kg", Positive), "mass; none"),
    ],
    build: |e, m| {
        let node = m.point(e.name(), e.vector("position")?);
        if let Some(velocity) = e.given("velocity", Entry::vector)? {
            m.set_velocity(node, velocity, Vector3::zeros());
        }
        if let Some(mass) = e.given("mass", Entry::number)? {
            m.point_mass(e.name(), node, mass);
        }
        Ok(Built::Node(node))
    },
    ..Section::with_nodes("point", "A point without rotation.", Nodes::one(OF_POINT))
};
