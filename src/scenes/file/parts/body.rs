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
    name: "body",
    shape: Shape::Listed,
    doc: "A rigid body: a frame in space, with or without mass. The body named ground is there already; it never moves.",
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
            Tables(&SOLID),
            "solids of which it consists, in the world at the start, instead of mass, mass_centre and inertia; none"
        ),
        may("draw", Points, "corners of a line of the picture, in the world at the start; none"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let zero = Vector3::zeros();
    let (position, rotation) = (known.vector_or(fields, "position", zero)?, known.orientation(fields)?);
    let node = match text(fields, "coordinates") {
        Some("natural") => m.natural_body(name, position, rotation),
        _ => m.body(name, position, rotation),
    };
    if fields.get("velocity").is_some() || fields.get("angular_velocity").is_some() {
        let velocity = known.vector_or(fields, "velocity", zero)?;
        m.set_velocity(node, velocity, known.vector_or(fields, "angular_velocity", zero)?);
    }
    let solids = solids(known, fields, (position, rotation))?;
    let is_weighed = solids.iter().any(|solid| solid.density.is_some());
    if let Some((at, _)) = fields.get("mass").or(fields.get("inertia")).or(fields.get("mass_centre")).filter(|_| is_weighed)
    {
        let text =
            format!("\"{name}\" has its mass of its solids: leave mass, mass_centre and inertia or their densities out");
        return Err(Mistake::new(at, text));
    }
    m.solid_body(name, node, &solids);
    if fields.get("mass").is_some() {
        let (mass, centre) = (known.number(fields, "mass")?, known.vector_or(fields, "mass_centre", zero)?);
        m.rigid_body(name, node, mass, centre, inertia(known, fields)?);
    } else if let Some((at, _)) = fields.get("inertia").or(fields.get("mass_centre")) {
        return Err(Mistake::new(at, format!("\"{name}\" has no mass: give it the key mass, too")));
    }
    if fields.get("draw").is_some() {
        m.draw(node, &known.points(fields, "draw")?);
    }
    Ok(Made::Node(node))
}

/// Three or six numbers of an inertia tensor.
fn inertia<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<[S; 6]> {
    let mut own = known.series(fields, "inertia")?;
    if own.is_empty() {
        return Err(Mistake::new(fields.at, "a body with mass needs the key inertia: [xx, yy, zz] in kg m2"));
    }
    own.resize(6, S::zero());
    own.try_into().map_err(|_| Mistake::new(fields.at, "inertia has three or six numbers"))
}

/// Solids of a body that stands at a place with some axes.
fn solids<S: Scalar>(
    known: &Known<S>,
    fields: &Fields,
    (position, rotation): (Vector3<S>, Quaternion<S>),
) -> Found<Vec<Solid<S>>> {
    let mut solids = Vec::new();
    for (_, value) in list(fields, "solids") {
        let Value::Fields(own) = value else { continue };
        let number = |key| known.number(own, key);
        let wanted = |key: &str| own.get(key).map(|_| known.number(own, key)).transpose();
        let line = || Found::Ok([known.vector(own, "from")?, known.vector(own, "to")?]);
        let shape = match own.form {
            "box" => SolidShape::Box {
                ends: line()?,
                second_axis: known.vector(own, "second_axis")?,
                size: [number("width")?, number("height")?],
            },
            "cylinder" => SolidShape::Cylinder { ends: line()?, diameter: number("diameter")?, wall: wanted("wall")? },
            "sphere" => SolidShape::Sphere {
                centre: known.vector(own, "centre")?,
                diameter: number("diameter")?,
                wall: wanted("wall")?,
            },
            _ => {
                let Some((_, Value::Surface(surface))) = own.get("file") else { continue };
                let turned = own.get("orientation").map(|_| known.orientation(own)).transpose()?;
                SolidShape::Surface {
                    surface: surface.clone(),
                    scale: known.number_or(own, "scale", 1.0)?,
                    position: known.vector_or(own, "position", position)?,
                    rotation: turned.unwrap_or(rotation),
                }
            }
        };
        solids.push(Solid { shape, density: wanted("density")? });
    }
    Ok(solids)
}
