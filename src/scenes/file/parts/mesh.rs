//! Shells on meshes.

use super::shell::COINCIDENT;
use crate::elements::entries::ORIENTATION;
use crate::scenes::file::describing::*;
use crate::scenes::file::mesh_nodes::{names, nodes_of};
use crate::scenes::{FreeMesh, MeshData, ShellPart, unknown};
use std::sync::Arc;

const NODE_OF_MESH: Forms = one_form![
    need("at", Text, "number of the node, as in \"12\", or a node set of one node"),
    need("node", Node, "a body, or a node of another shell or of a beam, that stands there"),
];

const PART: Forms = one_form![
    need("of", at_least(0, &Text), "groups of faces"),
    may("material", Type::Item(&["material"]), "name of a material; that of the mesh"),
    may("thickness", OfMesh("m", Positive), "thickness; required unless `laminate` is given"),
    may("laminate", Type::Item(&["laminate"]), "name of a laminate"),
    may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; that of the mesh"),
];

pub(super) const SECTION: Section = Section {
    forms: forms!([
        NAME,
        may("material", Type::Item(&["material"]), "name of a material; required unless `laminate` or `parts` are given"),
        may("thickness", OfMesh("m", Positive),
            "thickness of faces that have no part; may use design variables of faces and nodes; needed with material but with parts"),
        may("laminate", Type::Item(&["laminate"]), "name of a laminate"),
        may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; needed with laminate"),
        may("parts", at_least(0, &Table(&PART)), "sections of groups of faces; all faces have one"),
        may("damping", Number("s", AtLeastZero), "damping proportional to stiffness; none"),
        may("clamped", at_least(0, &Text), "node sets, or groups of faces, whose nodes never move; none"),
        may("joined", OneOrMore(&Type::Item(SHELLS)), "shells, meshes and walls whose nodes it takes over where its outer edges meet them, to a millionth of its diagonal: with each at least one; none"),
        may("nodes", at_least(0, &Table(&NODE_OF_MESH)), "nodes that are there already; none"),
        may("groups", Selections, "groups of faces by name, beside those of the file: numbers of the faces, or a condition such as \
             \"norm([x, y, 0]) > 0.5 and z < 1\" that holds at the mean of their corners, in coordinates before scale; none"),
        may("node_sets", Selections, "node sets by name, beside those of the file: numbers of the nodes, or a condition such as \"abs(x) < 1e-6\", in \
             coordinates before scale; none"),
        may("reverse", at_least(0, &Text), "groups of faces that are turned round, so that their normals point to the other side, with what hangs together with them; none"),
        may("crease", Fixed("rad", Positive), "faces at a larger angle meet in an edge, which keeps its angle; 45 deg"),
        may("scale", Number("-", Positive), "by which the points are multiplied, such as 0.001 for a mesh in millimetres; 1"),
        may("orientation", Table(&ORIENTATION), "turn of the points about the origin, after scale; none"),
        may("position", Vector("m"), "by which the points are moved, after orientation; 0"),
        COINCIDENT,
    ]
    "gmsh" "from a file of Gmsh, version 2 or 4, text or binary; triangles of three nodes are raised to six" [
        need("file", Text, "path of the file, from the folder of this file on"),
    ]
    "faces" "from points and faces here" [
        need("points", at_least(2, &Vector("m")), "points, counted from 0 on"),
        need("faces", Lists, "points of each face: corners counterclockwise as seen from where the normal points to, then the middles of the edges \
             from the first corner on, then the middle"),
    ]),
    build,
    ..Section::with_nodes(
        "mesh",
        "A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the \
          file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group \
          of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is.",
        Nodes::one(OF_BODY),
    )
};

/// Thickness at the points of each face, those that complete faces of eight points included.
type Thickness = Vec<Vec<(usize, Recorded)>>;

/// Points of the mesh where they are wanted.
fn points(e: Entry, data: &MeshData) -> Result<Vec<Vector3<Recorded>>> {
    let mut points = match e.form {
        "faces" => e.points("points")?,
        _ => data.points.iter().map(|&point| Vector3::from_f64(point)).collect(),
    };
    if let Some(scale) = e.given("scale", Entry::number)? {
        points.iter_mut().for_each(|point| *point *= scale);
    }
    if e.has("orientation") {
        let turn = e.orientation()?;
        points.iter_mut().for_each(|point| *point = turn.rotate(*point));
    }
    if let Some(position) = e.given("position", Entry::vector)? {
        points.iter_mut().for_each(|point| *point += position);
    }
    Ok(points)
}

/// What a file gives of its own must be right before a mesh is made of it.
fn check(e: Entry, data: &MeshData) -> Result<()> {
    let count = data.points.len();
    for (at, face) in e.list("faces") {
        let Value::List(own) = face else { continue };
        let most = own.iter().filter_map(|(_, own)| if let Value::Count(own) = own { Some(*own) } else { None }).max();
        if !matches!(own.len(), 4 | 6 | 8 | 9) {
            let text = format!("a face has 4, 6, 8 or 9 points; this one has {}", own.len());
            return Err(Mistake::new(at, text));
        }
        if let Some(most) = most.filter(|&most| most >= count) {
            return Err(Mistake::new(at, format!("there is no point {most} among {count}, counted from 0 on")));
        }
    }
    Ok(())
}

/// The thickness that an entry, or one of its parts, gives to some faces.
fn thickness(e: Entry, data: &MeshData, faces: &[usize]) -> Result<Thickness> {
    let (mut all, mesh) = (vec![Vec::new(); data.faces.len()], e.item.place);
    let has_each = e.context.each.iter().any(|own| own.1.mesh == mesh);
    let constant = if has_each { None } else { Some(e.number("thickness")?) };
    // the middle of a quadrilateral of eight points follows the last of all points
    let mut middles = data.points.len()..;
    let middle_of: Vec<usize> = data
        .faces
        .iter()
        .map(|face| if face.len() == 8 { middles.next().unwrap_or(usize::MAX) } else { usize::MAX })
        .collect();
    for &face in faces {
        let own = &data.faces[face];
        let called = || format!("element {}", data.face_numbers[face]);
        for &point in own {
            let value = match constant {
                Some(value) => value,
                None => e.number_at("thickness", [mesh, face, point], &called())?,
            };
            all[face].push((point, value));
        }
        if own.len() == 8 {
            // as the place of the middle follows from the others
            let share = |place| if place < 4 { -0.25 } else { 0.5 };
            let shares = all[face].iter().enumerate().map(|(place, (_, own))| *own * share(place));
            let value = shares.fold(Recorded::default(), |sum, own| sum + own);
            all[face].push((middle_of[face], value));
        }
    }
    Ok(all)
}

/// The mesh of an entry, with what holds its points.
fn free_mesh(e: Entry, data: &Arc<MeshData>, m: &mut Builder) -> Result<FreeMesh<Recorded>> {
    let mut mesh = FreeMesh::of_data_at(data, points(e, data)?);
    if let Some(angle) = e.fixed("crease") {
        mesh = mesh.creased(angle);
    }
    if let Some(damping) = e.given("damping", Entry::number)? {
        mesh = mesh.damped(damping);
    }
    for (at, value) in e.list("clamped") {
        let Value::Text(set) = value else { continue };
        let points = nodes_of(data, &format!(".{set}"));
        mesh = mesh.clamped(points.map_err(|why| Mistake::new(at, format!("clamped, \"{set}\": {why}")))?);
    }
    for own in e.tables("nodes") {
        let Some(text) = own.text("at") else { continue };
        let is_number = text.chars().all(|letter| letter.is_ascii_digit());
        let rest = if is_number { format!("[{text}]") } else { format!(".{text}") };
        let point = match nodes_of(data, &rest).as_deref() {
            Ok(&[point]) => point,
            Ok(points) => {
                return own.wrong(format!("at, \"{text}\": these are {} nodes, and one is wanted", points.len()));
            }
            Err(why) => return own.wrong(format!("at, \"{text}\": {why}")),
        };
        mesh = mesh.with_node(point, own.node("node", m)?);
    }
    if e.flag("coincident") {
        mesh = mesh.with_coincident_points();
    }
    Ok(m.joined_to_each(mesh, &e.shells("joined")))
}

/// The tables that say the sections of faces, the entry itself where they belong to no part, and which does for each.
fn parts<'k>(e: Entry<'k>, data: &MeshData) -> Result<(Vec<Entry<'k>>, Vec<usize>)> {
    let mut entries: Vec<Entry> = e.tables("parts").collect();
    let mut part_of: Vec<Option<usize>> = vec![None; data.faces.len()];
    for (number, own) in entries.iter().enumerate() {
        for group in own.texts("of") {
            let Some(faces) = data.group(group) else {
                return own.wrong_key("of", unknown("group of faces", group, &names(&data.groups)));
            };
            for &face in faces {
                if part_of[face].replace(number).is_some_and(|before| before != number) {
                    let text = format!("element {} of \"{group}\" belongs to another part, too", data.face_numbers[face]);
                    return own.wrong_key("of", text);
                }
            }
        }
    }
    let of_mesh = entries.len();
    if let Some(face) = part_of.iter().position(Option::is_none) {
        if !e.has("thickness") && !e.has("laminate") {
            return e.wrong(format!(
                "\"{}\" needs the keys material and thickness, or laminate and direction: element {} belongs to none of its {of_mesh} parts",
                e.name(),
                data.face_numbers[face],
            ));
        }
        entries.push(e);
    }
    Ok((entries, part_of.into_iter().map(|own| own.unwrap_or(of_mesh)).collect()))
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let Some(data) = &e.item.mesh else { return e.wrong(format!("\"{}\" has no mesh", e.name())) };
    check(e, data)?;
    // these were read with the mesh
    ["file", "reverse", "groups", "node_sets"].iter().for_each(|key| _ = e.get(key));
    let mesh = free_mesh(e, data, m)?;
    let (entries, part_of) = parts(e, data)?;
    let mut tables: Vec<Thickness> = Vec::new();
    for (number, own) in entries.iter().enumerate() {
        let is_layered = own.has("laminate");
        if is_layered && own.has("thickness") {
            let text = "a laminate has the thickness of its plies: leave out thickness or laminate";
            return own.wrong_key("thickness", text);
        }
        let faces: Vec<usize> = (0..part_of.len()).filter(|&face| part_of[face] == number).collect();
        tables.push(if is_layered || faces.is_empty() { Vec::new() } else { thickness(*own, data, &faces)? });
    }
    let at_point = |table: &Thickness, face: usize, point: usize| {
        let own = table.get(face).into_iter().flatten().find(|own| own.0 == point);
        own.map_or(Recorded::from(f64::NAN), |own| own.1)
    };
    let lookups: Vec<_> = tables.iter().map(|table| move |face, point| at_point(table, face, point)).collect();
    let mut sections: Vec<ShellPart<Recorded>> = Vec::new();
    for (number, own) in entries.iter().enumerate() {
        let given = |key: &str| if own.has(key) { *own } else { e };
        sections.push(if own.has("laminate") {
            ShellPart::Laminate(own.laminate()?.0, given("direction").vector("direction")?)
        } else if part_of.contains(&number) {
            ShellPart::Isotropic(given("material").material()?, &lookups[number])
        } else {
            return own.wrong("this part has no faces");
        });
    }
    Ok(Built::Mesh(Box::new(m.shell_of_parts(e.name(), mesh, &sections, |face| part_of[face]))))
}
