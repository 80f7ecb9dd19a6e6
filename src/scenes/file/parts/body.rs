//! Rigid bodies.

use crate::elements::entries::ORIENTATION;
use crate::scalar::Quaternion;
use crate::scenes::file::describing::*;
use crate::scenes::{Solid, SolidShape};

const WALL_OF_ROUND: Key = may("wall", Number("m", Positive), "thickness of the wall of a hollow one; solid");
const LINE_OF_SOLID: [Key; 2] =
    [need("from", Vector("m"), "start of its middle line"), need("to", Vector("m"), "end of its middle line")];
const SOLID: Forms = forms!([
    may("density", Number("kg/m3", Positive), "density; it is drawn only"),
]
"box" "a bar of rectangular section" [
    LINE_OF_SOLID[0],
    LINE_OF_SOLID[1],
    need("second_axis", Vector("-"), "direction that spans the plane of the width with the line"),
    need("width", Number("m", Positive), "along the second axis"),
    need("height", Number("m", Positive), "across it"),
]
"cylinder" "a round bar or tube" [
    LINE_OF_SOLID[0],
    LINE_OF_SOLID[1],
    need("diameter", Number("m", Positive), "outer diameter"),
    WALL_OF_ROUND,
]
"sphere" "a ball" [
    need("centre", Vector("m"), "centre"),
    need("diameter", Number("m", Positive), "outer diameter"),
    WALL_OF_ROUND,
]
"surface" "what a closed surface of triangles holds; without a density it need not be closed" [
    need("file", Stl, "a file in STL, text or binary, beside the scene file"),
    may("scale", Number("m", Positive), "length of a unit of the file; 1"),
    may("position", Vector("m"), "where its origin stands; that of the body"),
    may("orientation", Table(&ORIENTATION), "its axes in the world; those of the body"),
]);

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        may("position", Vector("m"), "origin of its frame; that of the world"),
        may("orientation", Table(&ORIENTATION), "its axes; those of the world"),
        may("velocity", Vector("m/s"), "velocity of the origin; 0"),
        may("angular_velocity", Vector("rad/s"), "in the world; 0"),
        may("mass", Number("kg", AtLeastZero), "mass; none"),
        may("mass_centre", Vector("m"), "in its own axes from its origin; the origin"),
        may(
            "inertia",
            Numbers(&[3, 6], "kg m2", Any),
            "xx, yy, zz, and xy, xz, yz if they are not 0, about the mass centre in its own axes; needed with mass"
        ),
        may("coordinates", Choice(&["euler_parameters", "natural"]), "kind of its coordinates; euler_parameters"),
        may(
            "solids",
            at_least(0, &Table(&SOLID)),
            "solids of which it consists, in the world at the start, instead of mass, mass_centre and inertia; none"
        ),
        may("draw", at_least(2, &Vector("m")), "corners of a line of the picture, in the world at the start; none"),
    ],
    build,
    ..Section::with_nodes(
        "body",
        "A rigid body: a frame in space, with or without mass. The body named ground is there already; it never moves.",
        Nodes::one(OF_BODY),
    )
};

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let (name, zero) = (e.name(), Vector3::zeros());
    let (position, rotation) = (e.vector_or("position", zero)?, e.orientation()?);
    let node = match e.text("coordinates") {
        Some("natural") => m.natural_body(name, position, rotation),
        _ => m.body(name, position, rotation),
    };
    if e.has("velocity") || e.has("angular_velocity") {
        m.set_velocity(node, e.vector_or("velocity", zero)?, e.vector_or("angular_velocity", zero)?);
    }
    let solids = e.tables("solids").map(|own| solid(own, (position, rotation))).collect::<Result<Vec<_>>>()?;
    let given = ["mass", "inertia", "mass_centre"].into_iter().find(|key| e.has(key));
    if let Some(key) = given.filter(|_| solids.iter().any(|solid| solid.density.is_some())) {
        let text =
            format!("\"{name}\" has its mass of its solids: leave mass, mass_centre and inertia or their densities out");
        return e.wrong_key(key, text);
    }
    m.solid_body(name, node, &solids);
    match given {
        Some("mass") => {
            m.rigid_body(name, node, e.number("mass")?, e.vector_or("mass_centre", zero)?, inertia(e)?);
        }
        Some(key) => return e.wrong_key(key, format!("\"{name}\" has no mass: give it the key mass, too")),
        None => {}
    }
    if e.has("draw") {
        m.draw(node, &e.points("draw")?);
    }
    Ok(Built::Node(node))
}

/// Three or six numbers of an inertia tensor.
fn inertia(e: Entry) -> Result<[Recorded; 6]> {
    let mut own = e.series("inertia")?;
    if own.is_empty() {
        return e.wrong("a body with mass needs the key inertia: [xx, yy, zz] in kg m2");
    }
    own.resize(6, Recorded::default());
    own.try_into().or_else(|_| e.wrong("inertia has three or six numbers"))
}

/// A solid of a body that stands at a place with some axes.
fn solid(e: Entry, (position, rotation): (Vector3<Recorded>, Quaternion<Recorded>)) -> Result<Solid<Recorded>> {
    let line = || Ok::<_, Mistake>([e.vector("from")?, e.vector("to")?]);
    let wall = || e.given("wall", Entry::number);
    let shape = match (e.form, e.get("file")) {
        ("box", _) => SolidShape::Box {
            ends: line()?,
            second_axis: e.vector("second_axis")?,
            size: [e.number("width")?, e.number("height")?],
        },
        ("cylinder", _) => SolidShape::Cylinder { ends: line()?, diameter: e.number("diameter")?, wall: wall()? },
        (_, Some((_, Value::Surface(surface)))) => SolidShape::Surface {
            surface: surface.clone(),
            scale: e.number_or("scale", 1.0)?,
            position: e.vector_or("position", position)?,
            rotation: if e.has("orientation") { e.orientation()? } else { rotation },
        },
        _ => SolidShape::Sphere { centre: e.vector("centre")?, diameter: e.number("diameter")?, wall: wall()? },
    };
    Ok(Solid { shape, density: e.given("density", Entry::number)? })
}
