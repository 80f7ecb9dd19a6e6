//! Entries of a file as calls of the builder.

use super::known::{Found, Known, Made, count, counts, edge_named, fixed, flag, frame, list, over, text, texts};
use super::mistake::Mistake;
use super::reader::{Fields, Item, Value};
use crate::assembly::NodeId;
use crate::elements::flexible::section::Shape;
use crate::elements::flexible::{CableSection, Laminate, Material, Ply, PlyStrength, STRAINS, Section};
use crate::elements::forces::{AppliedForce, AppliedTorque, LoadFrame};
use crate::elements::joints::HeldSlope;
use crate::elements::{NodeKind, TimeFunction};
use crate::functionals::quantities::{CableMeasure, SectionMeasure};
use crate::functionals::{AggregateKind, ElementGroup, LoadKind, Over, Times};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, CableLine, Extrusion, MechanismBuilder, Profile, ShellMember, ShellMesh};

type Builder<S> = MechanismBuilder<S>;

/// Makes what an entry says.
pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (name, fields) = (item.name.as_str(), &item.fields);
    match item.section {
        "variable" => Ok(Made::Nothing),
        "material" => {
            let number = |key| known.number(fields, key);
            let [young, poisson, density] = [number("young")?, number("poisson")?, number("density")?];
            Ok(Made::Material(Material { young, poisson, density }))
        }
        "section" => section(known, fields),
        "laminate" => laminate(known, fields),
        "body" => body(known, name, fields, m),
        "point" => point(known, name, fields, m),
        "beam" => beam(known, name, fields, m),
        "cable" => cable(known, name, fields, m),
        "shell" => shell(known, name, fields, m),
        "thin_walls" => thin_walls(known, name, fields, m),
        "sphere" => {
            let place = (known.vector_or(fields, "centre", Vector3::zeros())?, known.number(fields, "radius")?);
            let (material, thickness) = (known.material(fields)?, known.number(fields, "thickness")?);
            Ok(Made::Sphere(m.sphere_shell(name, place, count(fields, "elements"), &material, thickness)))
        }
        "group" => group(known, name, fields),
        "joint_angle" => {
            let (nodes, axis) = (known.nodes(fields, "between", m)?, known.vector(fields, "axis")?);
            Ok(Made::Node(m.joint_angle(name, nodes, axis)))
        }
        "joint" => joint(known, name, fields, m),
        "rigid_interface" => {
            let body = known.node(fields, "body", m)?;
            let mut nodes = Vec::new();
            for (at, value) in list(fields, "nodes") {
                if let Value::Node(place) = value {
                    nodes.extend(known.nodes_at(at, place, m)?);
                }
            }
            m.rigid_interface(name, body, &nodes);
            Ok(Made::Nothing)
        }
        "driver" => driver(known, name, fields, m),
        "spring" => spring(known, name, fields, m),
        "damper" => {
            let nodes = known.nodes(fields, "between", m)?;
            let (ends, damping) = (ends(known, fields, nodes, m)?, known.number(fields, "damping")?);
            match fields.form {
                "line" => m.line_damper(name, nodes, ends, damping),
                _ => m.vector_damper(name, nodes, ends, damping),
            };
            Ok(Made::Nothing)
        }
        "force" | "torque" | "distributed_load" | "pressure" => load(known, item, m),
        "drawing" => {
            let node = if fields.get("on").is_some() { known.node(fields, "on", m)? } else { m.ground() };
            m.draw(node, &known.points(fields, "points")?);
            Ok(Made::Nothing)
        }
        "functional" => functional(known, name, fields, m),
        other => Err(Mistake::new(fields.at, format!("nothing builds a {other}"))),
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

/// A section of beams, or the shape from which that of a cable is made, too.
fn section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Made<S>> {
    let number = |key| known.number(fields, key);
    if matches!(fields.form, "beam" | "cable") {
        return Ok(Made::Nothing);
    }
    let material = known.material(fields)?;
    let poisson = material.poisson;
    let shape = match fields.form {
        "rectangle" => Shape::rectangle(number("width")?, number("height")?, poisson),
        "box" => Shape::box_section(number("width")?, number("height")?, number("wall")?, poisson),
        "circle" => Shape::circle(number("diameter")?, poisson),
        _ => Shape::tube(number("diameter")?, number("wall")?, poisson),
    };
    Ok(Made::Shape(material, shape))
}

/// What a key `section` names.
fn section_of<'i>(items: &'i [Item], fields: &Fields) -> Found<(usize, &'i Item)> {
    match fields.get("section") {
        Some((at, Value::Item(item))) => Ok((at, &items[*item])),
        _ => Err(Mistake::new(fields.at, "the key section is needed here")),
    }
}

fn beam_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Section<S>> {
    let (at, item) = section_of(known.items, fields)?;
    let own = &item.fields;
    let mut section = match (known.made(fields, "section")?, own.form) {
        (Made::Shape(material, shape), _) => Section::of(*material, *shape),
        (_, "beam") => {
            let ([shear_2, shear_3], [bending_2, bending_3]) =
                (known.numbers(own, "shear")?, known.numbers(own, "bending")?);
            let [axial, torsion] = [known.number(own, "axial")?, known.number(own, "torsion")?];
            let section = Section::new([axial, shear_2, shear_3, torsion, bending_2, bending_3]);
            let second: [S; 2] = if own.get("inertia").is_some() { known.numbers(own, "inertia")? } else { [S::zero(); 2] };
            section.with_inertia(known.number_or(own, "mass", 0.0)?, second)
        }
        _ => {
            return Err(Mistake::new(
                at,
                format!("\"{}\" is a section of cables; a beam needs one of another type", item.name),
            ));
        }
    };
    if own.get("centre").is_some() {
        section = section.with_centre(known.numbers(own, "centre")?);
    }
    if own.get("stiffness").is_some() {
        let mut upper = known.series(own, "stiffness")?.into_iter();
        let mut stiffness = [[S::zero(); STRAINS]; STRAINS];
        let places = (0..STRAINS).flat_map(|i| (i..STRAINS).map(move |j| (i, j)));
        for ((i, j), own) in places.zip(&mut upper) {
            stiffness[i][j] = own;
            stiffness[j][i] = own;
        }
        section = section.with_stiffness(stiffness);
    }
    if own.get("damping").is_some() {
        section = section.damped(known.number(own, "damping")?);
    }
    if own.get("offset").is_some() {
        section = section.offset(known.numbers(own, "offset")?);
    }
    Ok(section)
}

fn cable_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<CableSection<S>> {
    let (at, item) = section_of(known.items, fields)?;
    let own = &item.fields;
    let number = |key| known.number(own, key);
    let mut section = match (known.made(fields, "section")?, own.form) {
        (Made::Shape(material, shape), _) => CableSection::of(*material, *shape),
        (_, "cable") => CableSection::new(number("axial")?, number("bending")?, number("mass")?),
        _ => {
            return Err(Mistake::new(
                at,
                format!("\"{}\" is a section of beams; a cable needs one of another type", item.name),
            ));
        }
    };
    if own.get("offset").is_some() {
        return Err(Mistake::new(at, format!("\"{}\" has an offset, which a cable cannot have", item.name)));
    }
    if own.get("damping").is_some() {
        section = section.damped(number("damping")?);
    }
    Ok(if text(fields, "strains") == Some("small") { section.small_strains() } else { section })
}

fn laminate<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Made<S>> {
    let (mut plies, mut strengths) = (Vec::new(), Vec::new());
    for (_, value) in list(fields, "plies") {
        let Value::Fields(own) = value else { continue };
        plies.push(Ply {
            thickness: known.number(own, "thickness")?,
            angle: known.number_or(own, "angle", 0.0)?,
            young: known.numbers(own, "young")?,
            poisson: known.number(own, "poisson")?,
            shear: known.numbers(own, "shear")?,
            density: known.number(own, "density")?,
        });
        if own.get("tension").is_some() {
            strengths.push(PlyStrength {
                tension: known.numbers(own, "tension")?,
                compression: known.numbers(own, "compression")?,
                shear: known.number(own, "shear_strength")?,
            });
        }
    }
    let mut laminate = Laminate::new(plies).offset(known.number_or(fields, "offset", 0.0)?);
    laminate.shear_factor = fixed(fields, "shear_factor").unwrap_or(laminate.shear_factor);
    Ok(Made::Laminate(laminate, strengths))
}

/// Gives nodes of a member the motion that the entry says.
fn set_motion<S: Scalar>(known: &Known<S>, fields: &Fields, nodes: &[NodeId], m: &mut Builder<S>) -> Found<()> {
    let Some((_, Value::Fields(own))) = fields.get("motion") else { return Ok(()) };
    let vector = |key| known.vector_or(own, key, Vector3::zeros());
    m.set_rigid_motion(nodes, vector("point")?, vector("velocity")?, vector("angular_velocity")?);
    Ok(())
}

fn is_clamped(fields: &Fields, end: &str) -> bool {
    texts(fields, "clamped").iter().any(|own| own == end)
}

fn beam<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let (from, elements) = (known.vector(fields, "from")?, count(fields, "elements"));
    let mut line = match fields.get("arc") {
        Some((_, Value::Fields(arc))) => {
            let (centre, axis) = (known.vector(arc, "centre")?, known.vector(arc, "axis")?);
            BeamLine::arc(from, centre, axis.unit(), known.number(arc, "angle")?, elements)
        }
        _ => BeamLine::straight([from, known.vector(fields, "to")?], elements, known.vector(fields, "second_axis")?),
    };
    if fields.get("twist").is_some() {
        line = line.twisted(known.number(fields, "twist")?);
    }
    if fields.get("start_node").is_some() {
        line = line.from_node(known.node(fields, "start_node", m)?);
    } else if is_clamped(fields, "start") {
        line = line.clamped_start();
    }
    if fields.get("end_node").is_some() {
        line = line.to_node(known.node(fields, "end_node", m)?);
    } else if is_clamped(fields, "end") {
        line = line.clamped_end();
    }
    let beam = m.beam(name, line, &beam_section(known, fields)?);
    set_motion(known, fields, &beam.nodes, m)?;
    Ok(Made::Beam(beam))
}

fn cable<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let ends = [known.vector(fields, "from")?, known.vector(fields, "to")?];
    let mut line = CableLine::straight(ends, count(fields, "elements"));
    if fields.get("start_node").is_some() {
        line = line.from_node(known.node(fields, "start_node", m)?);
    } else if is_clamped(fields, "start") {
        line = line.clamped_start();
    }
    if fields.get("end_node").is_some() {
        line = line.to_node(known.node(fields, "end_node", m)?);
    } else if is_clamped(fields, "end") {
        line = line.clamped_end();
    }
    let cable = m.cable(name, line, &cable_section(known, fields)?);
    set_motion(known, fields, &cable.nodes, m)?;
    Ok(Made::Cable(cable))
}

fn shell<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let elements = counts(fields, "elements").unwrap_or([1; 2]);
    let vector = |key| known.vector(fields, key);
    let mut mesh = match fields.form {
        "plate" => {
            let corner = known.vector_or(fields, "corner", Vector3::zeros())?;
            ShellMesh::plate(corner, [vector("first")?, vector("second")?], elements)
        }
        "cylinder" => {
            let (line, about) = ([vector("from")?, vector("along")?], [vector("centre")?, vector("axis")?.unit()]);
            ShellMesh::cylinder(line, about, known.number(fields, "angle")?, elements)
        }
        "sphere_patch" => {
            let (centre, radius) = (vector("centre")?, known.number(fields, "radius")?);
            ShellMesh::sphere(
                centre,
                radius,
                known.numbers(fields, "longitude")?,
                known.numbers(fields, "latitude")?,
                elements,
            )
        }
        _ => {
            let edges = [vector("first")?.unit(), vector("second")?.unit()];
            ShellMesh::sphere_face(vector("centre")?, known.number(fields, "radius")?, edges, elements)
        }
    };
    if flag(fields, "closed", false) {
        mesh = mesh.closed();
    }
    if fields.get("damping").is_some() {
        mesh = mesh.damped(known.number(fields, "damping")?);
    }
    for edge in texts(fields, "clamped") {
        mesh = mesh.clamped(edge_named(&edge));
    }
    let mut others: Vec<&ShellMember> = Vec::new();
    for (_, value) in list(fields, "joined") {
        let Value::Item(item) = value else { continue };
        match &known.made[*item] {
            Made::Shell(shell) => others.push(shell),
            Made::Walls(walls) => others.extend(&walls.walls),
            _ => {}
        }
    }
    if !others.is_empty() {
        mesh = m.joined(mesh, &others);
    }
    for (at, value) in list(fields, "held") {
        let Value::Fields(own) = value else { continue };
        let [i, j] = counts(own, "place").unwrap_or([0; 2]);
        let [columns, rows] = elements.map(|count| 2 * count + 1);
        if i >= columns || j >= rows {
            return Err(Mistake::new(at, format!("the grid of \"{name}\" has {columns} x {rows} nodes, counted from 0")));
        }
        mesh = mesh.with_node(i, j, known.node(own, "node", m)?);
    }
    if fields.get("laminate").is_some() {
        let Made::Laminate(laminate, _) = known.made(fields, "laminate")? else {
            return Err(Mistake::new(fields.at, "laminate must name a laminate"));
        };
        return Ok(Made::Shell(Box::new(m.laminate_shell(name, mesh, laminate, vector("direction")?))));
    }
    let (material, thickness) = (known.material(fields)?, known.series(fields, "thickness")?);
    let (strips, along) = (thickness.len(), elements[0]);
    if strips == 0 || strips > along {
        let text = format!(
            "\"{name}\" has {strips} thicknesses; give one, or up to {along}, the elements along its first direction"
        );
        return Err(Mistake::new(fields.get("thickness").map_or(fields.at, |own| own.0), text));
    }
    let shell = m.tapered_shell(name, mesh, &material, |element, _| thickness[(element % along) * strips / along]);
    Ok(Made::Shell(Box::new(shell)))
}

fn thin_walls<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let size = [known.number(fields, "width")?, known.number(fields, "height")?];
    let across = counts(fields, "across").unwrap_or([1; 2]);
    let (profile, walls) = match fields.form {
        "box_tube" => (Profile::box_tube(size, across), 4),
        _ => (Profile::i_section(size, across), 5),
    };
    let extrusion = Extrusion {
        start: known.vector_or(fields, "start", Vector3::zeros())?,
        along: known.vector(fields, "along")?,
        first_axis: known.vector(fields, "first_axis")?,
        twist: known.number_or(fields, "twist", 0.0)?,
        elements: count(fields, "elements"),
    };
    let thickness = known.series(fields, "thickness")?;
    if thickness.len() != 1 && thickness.len() != walls {
        let text = format!("\"{name}\" has {} thicknesses; give one, or {walls}, one for each wall", thickness.len());
        return Err(Mistake::new(fields.get("thickness").map_or(fields.at, |own| own.0), text));
    }
    let of_wall = |wall: usize, _: f64| thickness[wall % thickness.len()];
    let walls = m.thin_walls(name, &profile, &extrusion, &known.material(fields)?, of_wall);
    match walls.start().is_empty() {
        // why is among the mistakes of the builder
        true => Ok(Made::Nothing),
        false => Ok(Made::Walls(walls)),
    }
}

fn group<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields) -> Found<Made<S>> {
    let Made::Shell(shell) = known.made(fields, "of")? else {
        return Err(Mistake::new(fields.at, "of must name a shell"));
    };
    let bounds = |key: &str, count: usize| counts(fields, key).unwrap_or([0, count.saturating_sub(1)]);
    let ranges = [bounds("first", shell.counts[0]), bounds("second", shell.counts[1])];
    let is_in = |place: [usize; 2]| (0..2).all(|k| (ranges[k][0]..=ranges[k][1]).contains(&place[k]));
    let group: ElementGroup = shell.part(name, is_in);
    if group.elements.is_empty() {
        let [columns, rows] = shell.counts;
        let text = format!("\"{name}\" has no elements; the shell has {columns} x {rows}, counted from 0");
        return Err(Mistake::new(fields.at, text));
    }
    Ok(Made::Group(group))
}

/// Points of both nodes: given, or where the nodes are.
fn ends<S: Scalar>(known: &Known<S>, fields: &Fields, nodes: [NodeId; 2], m: &Builder<S>) -> Found<[Vector3<S>; 2]> {
    let given = known.points(fields, "points")?;
    match given.as_slice() {
        [] => Ok(nodes.map(|node| m.position(node))),
        &[a, b] => Ok([a, b]),
        other => {
            let at = fields.get("points").map_or(fields.at, |own| own.0);
            Err(Mistake::new(at, format!("points has {} places; give two, one on each node", other.len())))
        }
    }
}

/// The key `point`, or the place of a node.
fn place<S: Scalar>(known: &Known<S>, fields: &Fields, key: &str, node: NodeId, m: &Builder<S>) -> Found<Vector3<S>> {
    known.vector_or(fields, key, m.position(node))
}

fn joint<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    if fields.form == "rack_and_pinion" {
        let places = [known.vector(fields, "centre")?, known.vector(fields, "contact")?];
        let nodes = known.nodes(fields, "between", m)?;
        return Ok(Made::Joint(m.rack_and_pinion(name, nodes, places, known.vector(fields, "axis")?)));
    }
    let nodes: [NodeId; 2] = known.nodes(fields, "between", m)?;
    let point = place(known, fields, "point", nodes[1], m)?;
    let vector = |key| known.vector(fields, key);
    let contact = format!("contact of {name}");
    Ok(Made::Joint(match fields.form {
        "spherical" => m.spherical(name, nodes, point),
        "revolute" => m.revolute(name, nodes, point, vector("axis")?),
        "fixed" => m.fixed(name, nodes, point),
        "rigid_link" => m.rigid_link(name, nodes),
        "distance" => {
            let ends = ends(known, fields, nodes, m)?;
            m.distance(name, nodes, ends)
        }
        "prismatic" => m.prismatic(name, nodes, point, vector("axis")?),
        "cylindrical" => m.cylindrical(name, nodes, point, vector("axis")?),
        "planar" => m.planar(name, nodes, point, vector("normal")?),
        "universal" => m.universal(name, nodes, point, [vector("pin_a")?, vector("pin_b")?]),
        "helical" => m.helical(name, nodes, point, vector("axis")?, known.number(fields, "pitch")?),
        "point_on_line" => m.point_on_line(name, nodes, point, vector("axis")?),
        "point_in_plane" => m.point_in_plane(name, nodes, point, vector("normal")?),
        "gear" => m.gear(name, nodes, known.numbers(fields, "radii")?),
        "rolling_sphere" => {
            let centre = place(known, fields, "centre", nodes[1], m)?;
            let radius = known.number(fields, "radius")?;
            m.rolling_sphere([&contact, name], nodes, centre, vector("normal")?, radius)[1]
        }
        "rolling_disc" => {
            let disc = (place(known, fields, "centre", nodes[1], m)?, vector("axis")?);
            let plane = (place(known, fields, "point", nodes[0], m)?, vector("normal")?);
            m.rolling_disc([&contact, name], nodes, disc, plane, known.number(fields, "radius")?)[1]
        }
        "cable_weld" => {
            let held = if text(fields, "holds") == Some("vector") { HeldSlope::Vector } else { HeldSlope::Direction };
            m.cable_weld(name, nodes, held)
        }
        "cable_hinge" => m.cable_hinge(name, nodes, vector("axis")?),
        "cable_corner" => m.cable_corner(name, nodes),
        other => return Err(Mistake::new(fields.at, format!("nothing builds a joint of type {other}"))),
    }))
}

fn driver<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let (nodes, axis) = (known.nodes(fields, "between", m)?, known.vector(fields, "axis")?);
    Ok(Made::Joint(match fields.form {
        "rotation" => {
            let (angle, values) = known.function(fields, "angle")?;
            m.prescribed_rotation(name, nodes, axis, angle, &values)
        }
        _ => {
            let (displacement, values) = known.function(fields, "displacement")?;
            let places = [place(known, fields, "origin", nodes[0], m)?, place(known, fields, "point", nodes[1], m)?];
            m.prescribed_translation(name, nodes, places, axis, displacement, &values)
        }
    }))
}

fn spring<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let number = |key| known.number_or(fields, key, 0.0);
    if fields.form == "angle" {
        let coefficients = [number("stiffness")?, number("damping")?, number("rest_angle")?];
        let node = known.node(fields, "on", m)?;
        m.coordinate_spring_damper(name, node, 0, coefficients);
        return Ok(Made::Nothing);
    }
    let nodes = known.nodes(fields, "between", m)?;
    match fields.form {
        "line" => {
            let ends = ends(known, fields, nodes, m)?;
            let rest = match fields.get("rest_length") {
                Some(_) => number("rest_length")?,
                None => (ends[1] - ends[0]).length(),
            };
            m.line_spring(name, nodes, ends, number("stiffness")?, rest)
        }
        "torsion" => {
            let coefficients = [number("stiffness")?, number("damping")?, number("rest_angle")?];
            m.torsion_spring_damper(name, nodes, known.vector(fields, "axis")?, coefficients)
        }
        "slide" => {
            let places = [place(known, fields, "origin", nodes[0], m)?, place(known, fields, "point", nodes[1], m)?];
            let coefficients = [number("stiffness")?, number("damping")?, number("rest_displacement")?];
            m.slide_spring_damper(name, nodes, places, known.vector(fields, "axis")?, coefficients)
        }
        _ => {
            let axes: Quaternion<S> = known.orientation(fields)?;
            let damping = if fields.get("damping").is_some() { known.numbers(fields, "damping")? } else { [S::zero(); 6] };
            let coefficients = [known.numbers(fields, "stiffness")?, damping];
            let point = place(known, fields, "point", nodes[1], m)?;
            m.bushing(name, nodes, point, axes, coefficients)
        }
    };
    Ok(Made::Nothing)
}

fn load<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (name, fields) = (item.name.as_str(), &item.fields);
    let (size, values): (TimeFunction, Vec<S>) = known.function(fields, "size")?;
    match item.section {
        "distributed_load" => {
            let Made::Beam(beam) = known.made(fields, "beam")? else {
                return Err(Mistake::new(fields.at, "beam must name a beam"));
            };
            let direction = known.vector(fields, "direction")?;
            m.distributed_load(name, beam, (frame(fields, LoadFrame::World), direction), size, &values);
        }
        "pressure" => {
            let Made::Shell(shell) = known.made(fields, "shell")? else {
                return Err(Mistake::new(fields.at, "shell must name a shell"));
            };
            m.pressure(name, shell, frame(fields, LoadFrame::Body), size, &values);
        }
        kind => {
            let node = known.node(fields, "on", m)?;
            let on = m.model.find_node(node).and_then(|own| own.kind.in_space()).unwrap_or(NodeKind::Point);
            let frame = frame(fields, LoadFrame::World);
            let turned = |direction| if frame == LoadFrame::Body { m.local_direction(node, direction) } else { direction };
            if kind == "torque" {
                let p = [&turned(known.vector(fields, "axis")?).components()[..], &values].concat();
                m.element(name, &[node], AppliedTorque { on, frame, size }, &p);
            } else {
                let point = m.local_point(node, place(known, fields, "point", node, m)?).components();
                let p = [&turned(known.vector(fields, "direction")?).components()[..], &point, &values].concat();
                m.element(name, &[node], AppliedForce { on, frame, size }, &p);
            }
        }
    }
    Ok(Made::Nothing)
}

/// Number of a component of a section by its name.
fn component(fields: &Fields) -> usize {
    let names = ["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
    text(fields, "component").and_then(|own| names.iter().position(|name| *name == own)).unwrap_or(0)
}

fn functional<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let over = over(fields);
    let vector = |key| known.vector(fields, key);
    let share = fixed(fields, "share").unwrap_or(0.0);
    match fields.form {
        "position" | "velocity" | "target" => {
            let node = known.node(fields, "on", m)?;
            let point = place(known, fields, "point", node, m)?;
            match fields.form {
                "position" => m.position_functional(name, over, node, point, vector("direction")?),
                "velocity" => m.velocity_functional(name, over, node, point, vector("direction")?),
                _ => m.target_functional(name, over, node, point, known.vector_or(fields, "target", point)?),
            }
        }
        "distance" => {
            let nodes = known.nodes(fields, "between", m)?;
            let ends = ends(known, fields, nodes, m)?;
            m.distance_functional(name, over, nodes, ends);
        }
        "coordinate" => {
            let (node, index) = (known.node(fields, "on", m)?, count(fields, "index"));
            let dofs = m.model.find_node(node).map_or(0, |own| own.kind.dofs());
            if index >= dofs {
                let at = fields.get("index").map_or(fields.at, |own| own.0);
                return Err(Mistake::new(at, format!("index is {index}; the node has {dofs} coordinates, from 0 on")));
            }
            m.coordinate_functional(name, over, node, index);
        }
        "joint_angle" | "joint_rate" | "joint_displacement" | "joint_speed" | "cable_deflection" => {
            let nodes = known.nodes(fields, "between", m)?;
            let point = place(known, fields, "point", nodes[1], m)?;
            match fields.form {
                "joint_angle" => m.joint_angle_functional(name, over, nodes, vector("axis")?),
                "joint_rate" => m.joint_rate_functional(name, over, nodes, vector("axis")?),
                "joint_displacement" => m.joint_displacement_functional(name, over, nodes, point, vector("axis")?),
                "joint_speed" => m.joint_speed_functional(name, over, nodes, point, vector("axis")?),
                _ => m.cable_deflection_functional(name, over, nodes, vector("normal")?),
            }
        }
        "reaction" => m.reaction_functional(name, over, known.joint(fields)?, &known.series(fields, "weights")?),
        "reaction_norm" => m.reaction_norm_functional(name, over, known.joint(fields)?),
        "joint_load" => {
            let node = known.node(fields, "on", m)?;
            let point = place(known, fields, "point", node, m)?;
            let kind = match text(fields, "load") {
                Some("force") => LoadKind::Force,
                Some("moment") => LoadKind::Moment,
                Some("force_norm") => LoadKind::ForceNorm,
                _ => LoadKind::MomentNorm,
            };
            let direction = match kind {
                LoadKind::Force | LoadKind::Moment => vector("direction")?,
                _ => Vector3::from_f64([1.0, 0.0, 0.0]),
            };
            let of = (known.joint(fields)?, node);
            m.joint_load_functional(name, over, of, (kind, frame(fields, LoadFrame::World)), direction, point);
        }
        "energy" => m.energy_functional(name, over),
        "mass" if fields.get("of").is_none() => m.mass_functional(name, over),
        "mass" => m.group_mass_functional(name, over, &known.group(fields, "of")?),
        "strain_energy" => m.strain_energy_functional(name, over, &known.group(fields, "of")?),
        "inertia_moment" => {
            let group = if fields.get("of").is_some() { known.group(fields, "of")? } else { m.all_elements() };
            let point = known.vector_or(fields, "point", Vector3::zeros())?;
            m.inertia_moment_functional(name, over, &group, point, vector("axis")?);
        }
        "von_mises" => {
            let yield_stress = known.number(fields, "yield_stress")?;
            m.von_mises_functional(name, over, &known.group(fields, "of")?, yield_stress);
        }
        "tsai_wu" => {
            let Made::Laminate(laminate, strengths) = known.made(fields, "laminate")? else {
                return Err(Mistake::new(fields.at, "laminate must name a laminate"));
            };
            m.tsai_wu_functional(name, over, &known.group(fields, "of")?, laminate, strengths);
        }
        "section_force" | "section_strain" | "fibre_stress" => {
            let Made::Beam(beam) = known.made(fields, "beam")? else {
                return Err(Mistake::new(fields.at, "beam must name a beam"));
            };
            match fields.form {
                "section_force" => {
                    m.section_functional(name, over, beam, share, SectionMeasure::Force(component(fields)));
                }
                "section_strain" => {
                    m.section_functional(name, over, beam, share, SectionMeasure::Strain(component(fields)));
                }
                _ => {
                    let (young, fibre) = (known.number(fields, "young")?, known.numbers(fields, "fibre")?);
                    m.fibre_stress_functional(name, over, (beam, share), young, fibre);
                }
            }
        }
        form => {
            let Made::Cable(cable) = known.made(fields, "cable")? else {
                return Err(Mistake::new(fields.at, "cable must name a cable"));
            };
            let distance = known.number_or(fields, "distance", 0.0)?;
            match form {
                "cable_strain" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Strain),
                "cable_curvature" => m.cable_strain_functional(name, over, cable, share, CableMeasure::Curvature),
                "cable_stress" => {
                    m.cable_stress_functional(name, over, (cable, share), known.number(fields, "young")?, distance);
                }
                _ => {
                    let aggregate = match over {
                        Over::Aggregate { aggregate, times: Times::Run }
                            if aggregate.kind == (AggregateKind::SmoothMaximum { normalized: true }) =>
                        {
                            aggregate
                        }
                        _ => {
                            let at = fields.get("over").map_or(fields.at, |own| own.0);
                            let text =
                                "over of a largest_cable_stress must be { aggregate = \"smooth_maximum\", sharpness = .. }";
                            return Err(Mistake::new(at, text));
                        }
                    };
                    let young = known.number(fields, "young")?;
                    m.largest_cable_stress_functional(name, cable, young, distance, aggregate.sharpness);
                }
            }
        }
    }
    Ok(Made::Nothing)
}
