//! Entries of a file as calls of the builder.

use super::build_functionals::functional;

use super::build_members::{beam, cable, group, laminate, section, shell, shells_named, thin_walls};
use super::build_meshes::mesh;
use super::build_parts::{element, given, joint, made_of, rolling};

use super::fields::{Fields, Item, Value};
use super::formula_parts;
use super::known::{Builder, Found, Known, Made, count, fixed, list, text};
use super::mistake::Mistake;
use crate::assembly::NodeId;
use crate::elements::entries::{Part, named};
use crate::elements::flexible::{MATERIAL_KEYS, Material};
use crate::elements::forces::{DAMPERS, LOADS};
use crate::elements::joints::{DRIVERS, Freedom};
use crate::scalar::{Quaternion, Scalar, Vector3};
use crate::scenes::{Solid, SolidShape};

/// Makes what an entry says.
pub(super) fn build<S: Scalar>(known: &Known<S>, place: usize, m: &mut Builder<S>) -> Found<Made<S>> {
    let item = &known.items[place];
    let (name, fields) = (item.name.as_str(), &item.fields);
    match item.section {
        "variable" => Ok(Made::Nothing),
        "material" => made_of(fields, given(known, fields, &MATERIAL_KEYS)?, Material::given).map(Made::Material),
        "section" => Ok(section(known, fields)?.map_or(Made::Nothing, |(material, shape)| Made::Shape(material, shape))),
        "laminate" => laminate(known, fields),
        "body" => body(known, name, fields, m),
        "point" => point(known, name, fields, m),
        "beam" => beam(known, name, fields, m),
        "cable" => cable(known, name, fields, m),
        "shell" => shell(known, name, fields, m),
        "mesh" => mesh(known, place, m),
        "thin_walls" => thin_walls(known, name, fields, m),
        "sphere" => {
            let place = (known.vector_or(fields, "centre", Vector3::zeros())?, known.number(fields, "radius")?);
            let (material, thickness) = (known.material(fields)?, known.number(fields, "thickness")?);
            Ok(Made::Sphere(m.sphere_shell(name, place, count(fields, "elements"), &material, thickness)))
        }
        "group" => group(known, name, fields),
        "coordinate" => {
            let [initial, rate] = ["initial", "rate"].map(|key| known.number_or(fields, key, 0.0));
            Ok(Made::Node(m.coordinates(name, &[initial?], &[rate?])))
        }
        "joint_angle" => {
            let (nodes, axis) = (known.different_nodes(fields, m)?, known.vector(fields, "axis")?);
            Ok(Made::Node(m.joint_angle(name, nodes, axis)))
        }
        "state" => formula_parts::state(known, name, fields, m),
        "driver" => of_part(item, named(DRIVERS, fields.form), |part| joint(known, part, item, m)),
        "joint" => match known.own.joint_named(fields.form) {
            Some(part) => joint(known, part, item, m),
            None if fields.form == "formula" => formula_parts::joint(known, name, fields, m),
            None => rolling(known, item, m),
        },
        "rigid_interface" | "hold" | "spin" | "tie" | "drawing" => on_nodes(known, item, m),
        "spring" => of_part(item, known.own.spring_named(fields.form), |part| element(known, part, item, m)),
        "damper" => of_part(item, named(DAMPERS, fields.form), |part| element(known, part, item, m)),
        "element" => formula_parts::element(known, name, fields, m),
        "functional" => functional(known, item, m),
        "mode" => {
            // of the whole: the file has measured it
            ["number", "measure", "damped"].iter().for_each(|key| _ = fields.get(key));
            Ok(Made::Nothing)
        }
        load => of_part(item, named(LOADS, load), |part| element(known, part, item, m)),
    }
}

/// What is made of a part, if there is one for an entry.
fn of_part<L: ?Sized, T>(item: &Item, part: Option<&Part<L>>, make: impl FnOnce(&Part<L>) -> Found<T>) -> Found<T> {
    let refused = || Mistake::new(item.fields.at, format!("nothing builds a {} of type {}", item.section, item.fields.form));
    part.ok_or_else(refused).and_then(make)
}

/// What holds, turns, ties or draws nodes.
fn on_nodes<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (name, fields) = (item.name.as_str(), &item.fields);
    match item.section {
        "rigid_interface" => {
            let body = known.node(fields, "body", m)?;
            let nodes = node_sets(known, fields, m)?;
            m.rigid_interface(name, body, &nodes);
        }
        "hold" => {
            let chosen = |(_, own): (usize, &Value)| match own {
                Value::Text(name) => Freedom::NAMES.iter().position(|own| own == name).map(|place| Freedom::ALL[place]),
                _ => None,
            };
            let directions: Vec<Freedom> = list(fields, "directions").filter_map(chosen).collect();
            node_sets(known, fields, m)?.into_iter().for_each(|node| m.hold(node, &directions));
        }
        "spin" => {
            let nodes: Vec<NodeId> = list(fields, "parts").flat_map(|(_, part)| nodes_of(known, part)).collect();
            let [point, axis] = [known.vector_or(fields, "point", Vector3::zeros())?, known.vector(fields, "axis")?];
            m.spin(&nodes, point, axis, known.number(fields, "rate")?);
        }
        "tie" => {
            let nodes = node_sets(known, fields, m)?;
            m.tie_to(name, &nodes, &shells_named(known, fields, "to").concat(), fixed(fields, "within"));
        }
        _ => {
            let node = if fields.get("on").is_some() { known.node(fields, "on", m)? } else { m.ground() };
            m.draw(node, &known.points(fields, "points")?);
        }
    }
    Ok(Made::Nothing)
}

/// All nodes of the key `nodes`.
fn node_sets<S: Scalar>(known: &Known<S>, fields: &Fields, m: &mut Builder<S>) -> Found<Vec<NodeId>> {
    let mut nodes = Vec::new();
    for (at, value) in list(fields, "nodes") {
        if let Value::Node(place) = value {
            nodes.extend(known.nodes_at(at, place, m)?);
        }
    }
    Ok(nodes)
}

/// All nodes of a part.
fn nodes_of<S: Scalar>(known: &Known<S>, part: &Value) -> Vec<NodeId> {
    let (Value::Item(item) | Value::Group(item, _)) = part else { return Vec::new() };
    match &known.made[*item] {
        Made::Node(node) => vec![*node],
        Made::Beam(beam) => beam.nodes.clone(),
        Made::Cable(cable) => cable.nodes.clone(),
        shells => shells.shells().into_iter().flat_map(|shell| shell.nodes.clone()).collect(),
    }
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

fn body<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
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

fn point<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let node = m.point(name, known.vector(fields, "position")?);
    if fields.get("velocity").is_some() {
        m.set_velocity(node, known.vector(fields, "velocity")?, Vector3::zeros());
    }
    if fields.get("mass").is_some() {
        m.point_mass(name, node, known.number(fields, "mass")?);
    }
    Ok(Made::Node(node))
}
