//! Sections, beams, cables and shells of a file.

use super::build_parts::{given, made_of};
use super::expression::SHARE_PLACE;
use super::fields::{Fields, Item, NodePlace, Value};
use super::known::{Builder, Found, Known, Made, count, counts, fixed, flag, list, text, texts};
use super::mistake::Mistake;
use crate::assembly::NodeId;
use crate::elements::flexible::{CableSection, Laminate, OfShape, Ply, PlyStrength, SECTION, Section, Shape};
use crate::functionals::ElementGroup;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, CableLine, Edge, Extrusion, MeshedShell, Profile, ShellMesh};
use std::cell::RefCell;

/// Material and shape of a section; nothing of one by its numbers.
pub(super) fn section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<OfShape<S>> {
    if fields.get("material").is_none() {
        return Ok(None);
    }
    let (material, sizes) = (known.material(fields)?, SECTION.forms.iter().find(|form| form.name == fields.form));
    let sizes = sizes.into_iter().flat_map(|form| &form.keys[1..]).map(|key| known.number(fields, key.name));
    let shape = Shape::of_form(fields.form, &sizes.collect::<Found<Vec<S>>>()?, material.poisson);
    Ok(shape.map(|shape| (material, shape)))
}

/// What a key `section` names.
fn section_of<'i>(items: &'i [Item], fields: &Fields) -> Found<(usize, &'i Item)> {
    match fields.get("section") {
        Some((at, Value::Item(item))) => Ok((at, &items[*item])),
        _ => Err(Mistake::new(fields.at, "the key section is needed here")),
    }
}

/// Whether a section changes along the beam.
fn is_tapered(section: &Fields) -> bool {
    fn uses(value: &Value) -> bool {
        match value {
            Value::Formula(formula, _) => formula.uses(SHARE_PLACE),
            Value::List(list) => list.iter().any(|(_, own)| uses(own)),
            _ => false,
        }
    }
    section.values.iter().any(|(_, _, value)| uses(value))
}

fn beam_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Section<S>> {
    let (at, Item { name, fields: own, .. }) = section_of(known.items, fields)?;
    if own.form == "cable" {
        return Err(Mistake::new(at, format!("\"{name}\" is a section of cables; a beam needs one of another type")));
    }
    let of = section(known, own)?;
    made_of(own, given(known, own, &SECTION)?, |given| Section::given(given, of))
}

fn cable_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<CableSection<S>> {
    let (at, Item { name, fields: own, .. }) = section_of(known.items, fields)?;
    if is_tapered(own) {
        let text = format!("\"{name}\" depends on share, and a cable has one section from end to end");
        return Err(Mistake::new(at, text));
    }
    if own.form == "beam" {
        return Err(Mistake::new(at, format!("\"{name}\" is a section of beams; a cable needs one of another type")));
    }
    if own.get("offset").is_some() {
        return Err(Mistake::new(at, format!("\"{name}\" has an offset, which a cable cannot have")));
    }
    let of = section(known, own)?;
    let section = made_of(own, given(known, own, &SECTION)?, |given| CableSection::given(given, of))?;
    Ok(if text(fields, "strains") == Some("small") { section.small_strains() } else { section })
}

pub(super) fn laminate<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Made<S>> {
    let (mut plies, mut strengths) = (Vec::new(), Vec::new());
    for (_, own) in fields.tables("plies") {
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

/// Gives nodes of a member the motion that the entry says. Nodes of others that have a motion of their own must have the same.
fn set_motion<S: Scalar>(known: &Known<S>, fields: &Fields, nodes: &[NodeId], m: &mut Builder<S>) -> Found<()> {
    let Some((at, Value::Fields(own))) = fields.get("motion") else { return Ok(()) };
    let vector = |key| known.vector_or(own, key, Vector3::zeros());
    let moves = |key: &str| match fields.get(key) {
        Some((_, Value::Node(NodePlace { item: Some(item), .. }))) => {
            let has = |key: &&str| known.items[*item].fields.values.iter().any(|own| own.0 == *key);
            ["velocity", "angular_velocity", "motion"].iter().any(has).then_some(*item)
        }
        _ => None,
    };
    let shared = [("start_node", nodes.first()), ("end_node", nodes.last())];
    let rates = |node: NodeId, m: &Builder<S>| -> Vec<f64> {
        let dofs = m.model.find_node(node).map_or(0..0, |own| own.dofs.clone());
        m.numbers.v[dofs].iter().map(|own| own.value()).collect()
    };
    let given: Vec<(usize, NodeId, Vec<f64>)> = shared
        .into_iter()
        .filter_map(|(key, node)| Some((moves(key)?, *node?)))
        .map(|(item, node)| (item, node, rates(node, m)))
        .collect();
    m.set_rigid_motion(nodes, vector("point")?, vector("velocity")?, vector("angular_velocity")?);
    for (item, node, before) in given {
        let differs =
            rates(node, m).iter().zip(&before).any(|(now, before)| (now - before).abs() > 1e-9 * (1.0 + before.abs()));
        if differs {
            let name = &known.items[item].name;
            let text = format!(
                "this motion gives \"{name}\" another velocity than it has of its own: let both be the same, or one of them say it"
            );
            return Err(Mistake::new(at, text));
        }
    }
    Ok(())
}

fn is_clamped(fields: &Fields, end: &str) -> bool {
    texts(fields, "clamped").iter().any(|own| own == end)
}

/// A line with its ends in the nodes that are named, or clamped.
fn with_ends<L>(
    fields: &Fields,
    mut line: L,
    mut node: impl FnMut(&str) -> Found<NodeId>,
    joined: [fn(L, NodeId) -> L; 2],
    clamped: [fn(L) -> L; 2],
) -> Found<L> {
    for (place, [key, end]) in [["start_node", "start"], ["end_node", "end"]].into_iter().enumerate() {
        if fields.get(key).is_some() {
            if is_clamped(fields, end) {
                let text =
                    format!("clamped = \"{end}\" has no effect beside {key}: hold that node, or leave one of them out");
                return Err(Mistake::new(fields.at("clamped"), text));
            }
            line = joined[place](line, node(key)?);
        } else if is_clamped(fields, end) {
            line = clamped[place](line);
        }
    }
    Ok(line)
}

pub(super) fn beam<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
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
    let node = |key: &str| known.node(fields, key, m);
    let (joined, clamped) = ([BeamLine::from_node, BeamLine::to_node], [BeamLine::clamped_start, BeamLine::clamped_end]);
    let line = with_ends(fields, line, node, joined, clamped)?;
    let first = beam_section(known, fields)?;
    let beam = if is_tapered(&section_of(known.items, fields)?.1.fields) {
        let failed = RefCell::new(None);
        let at_share = |share: f64| {
            known.share.set(S::from(share));
            beam_section(known, fields).unwrap_or_else(|why| {
                failed.borrow_mut().get_or_insert(why);
                first
            })
        };
        let beam = m.tapered_beam(name, line, at_share);
        known.share.set(S::zero());
        if let Some(why) = failed.into_inner() {
            return Err(why);
        }
        beam
    } else {
        m.beam(name, line, &first)
    };
    set_motion(known, fields, &beam.nodes, m)?;
    Ok(Made::Beam(beam))
}

pub(super) fn cable<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let ends = [known.vector(fields, "from")?, known.vector(fields, "to")?];
    let line = CableLine::straight(ends, count(fields, "elements"));
    let node = |key: &str| known.node(fields, key, m);
    let (joined, clamped) = ([CableLine::from_node, CableLine::to_node], [CableLine::clamped_start, CableLine::clamped_end]);
    let line = with_ends(fields, line, node, joined, clamped)?;
    let cable = m.cable(name, line, &cable_section(known, fields)?);
    set_motion(known, fields, &cable.nodes, m)?;
    Ok(Made::Cable(cable))
}

/// Shells that a key names, a list of those of each entry.
pub(super) fn shells_named<'k, S: Scalar>(known: &'k Known<S>, fields: &Fields, key: &str) -> Vec<Vec<&'k MeshedShell>> {
    let shells = |(_, value): (usize, &Value)| match value {
        Value::Item(item) | Value::Group(item, _) => Some(known.made[*item].shells()),
        _ => None,
    };
    list(fields, key).filter_map(shells).collect()
}

/// The laminate that a table names.
pub(super) fn laminate_of<'k, S: Scalar>(known: &'k Known<S>, fields: &Fields) -> Found<&'k Laminate<S>> {
    match known.made(fields, "laminate")? {
        Made::Laminate(laminate, _) => Ok(laminate),
        _ => Err(Mistake::new(fields.at, "laminate must name a laminate")),
    }
}

/// The surface of a shell by its form.
fn surface<S: Scalar>(known: &Known<S>, fields: &Fields, elements: [usize; 2]) -> Found<ShellMesh<S>> {
    let vector = |key| known.vector(fields, key);
    Ok(match fields.form {
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
    })
}

pub(super) fn shell<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let elements = counts(fields, "elements").unwrap_or([1; 2]);
    let mut mesh = surface(known, fields, elements)?;
    if flag(fields, "closed", false) {
        mesh = mesh.closed();
    }
    if fields.get("damping").is_some() {
        mesh = mesh.damped(known.number(fields, "damping")?);
    }
    for edge in texts(fields, "clamped") {
        mesh = mesh.clamped(Edge::named(&edge));
    }
    if flag(fields, "coincident", false) {
        mesh = mesh.with_coincident_points();
    }
    mesh = m.joined_to_each(mesh, &shells_named(known, fields, "joined"));
    for (at, own) in fields.tables("held") {
        let [i, j] = counts(own, "place").unwrap_or([0; 2]);
        let [columns, rows] = elements.map(|count| 2 * count + 1);
        if i >= columns || j >= rows {
            return Err(Mistake::new(at, format!("the grid of \"{name}\" has {columns} x {rows} nodes, counted from 0")));
        }
        mesh = mesh.with_node(i, j, known.node(own, "node", m)?);
    }
    if fields.get("laminate").is_some() {
        let laminate = laminate_of(known, fields)?;
        return Ok(Made::Shell(Box::new(m.laminate_shell(name, mesh, laminate, known.vector(fields, "direction")?))));
    }
    let (material, thickness) = (known.material(fields)?, known.strips(fields, "thickness", elements[0])?);
    let (strips, along) = (thickness.len(), elements[0]);
    if strips == 0 || along % strips != 0 {
        let text = format!(
            "\"{name}\" has {strips} thicknesses of strips of equal width, but {along} elements along its first direction: give one, or as many as \
             divide these"
        );
        return Err(Mistake::new(fields.at("thickness"), text));
    }
    let shell = m.tapered_shell(name, mesh, &material, |element, _| thickness[(element % along) * strips / along]);
    Ok(Made::Shell(Box::new(shell)))
}

pub(super) fn thin_walls<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let (profile, walls) = match fields.form {
        "profile" => {
            let corners = list(fields, "corners").map(|given| known.pair(given)).collect::<Found<Vec<[S; 2]>>>()?;
            let wall = |(_, own): (usize, &Fields)| Some((counts(own, "between")?, count(own, "elements")));
            let walls: Vec<([usize; 2], usize)> = fields.tables("walls").filter_map(wall).collect();
            let number = walls.len();
            (Profile::new(corners, walls), number)
        }
        form => {
            let size = [known.number(fields, "width")?, known.number(fields, "height")?];
            let across = counts(fields, "across").unwrap_or([1; 2]);
            match form {
                "box_tube" => (Profile::box_tube(size, across), 4),
                _ => (Profile::i_section(size, across), 5),
            }
        }
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
        return Err(Mistake::new(fields.at("thickness"), text));
    }
    let of_wall = |wall: usize, _: f64| thickness[wall % thickness.len()];
    let walls = m.thin_walls(name, &profile, &extrusion, &known.material(fields)?, of_wall);
    match walls.start().is_empty() {
        // why is among the mistakes of the builder
        true => Ok(Made::Nothing),
        false => Ok(Made::Walls(walls)),
    }
}

pub(super) fn group<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields) -> Found<Made<S>> {
    let Made::Shell(shell) = known.made(fields, "of")? else {
        return Err(Mistake::new(fields.at, "of must name a shell"));
    };
    for (key, count) in ["first", "second"].into_iter().zip(shell.counts) {
        if let (Some([from, to]), Some((at, _))) = (counts(fields, key), fields.get(key))
            && (from > to || to >= count)
        {
            let text = format!("{key} goes from element {from} to {to}; the shell has {count} there, counted from 0");
            return Err(Mistake::new(at, text));
        }
    }
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
