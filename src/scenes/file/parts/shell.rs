//! Shells on grids.

use crate::scenes::file::describing::*;
use crate::scenes::{Edge, ShellMesh};

pub(super) const COINCIDENT: Key =
    may("coincident", Flag, "nodes may stand at the same place, or on other faces, and are not joined: a slit; false");
const ELEMENTS: Key = need("elements", exactly(2, &Count(1, 1000)), "elements along both directions");

const HELD: Forms = one_form![
    need("place", exactly(2, &Count(0, 2000)), "[i, j] of the grid"),
    need("node", Node, "a body, or a node of another shell or of a beam, that stands there"),
];

pub(super) const SECTION: Section = Section {
    forms: forms!([
        NAME,
        ELEMENTS,
        may("material", Type::Item(&["material"]), "name of a material; required unless `laminate` is given"),
        may("thickness", Strips(&Number("m", Positive)),
            "thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, \
             which is taken at the middle of each element; needed with material"),
        may("laminate", Type::Item(&["laminate"]), "name of a laminate"),
        may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; needed with laminate"),
        may("damping", Number("s", AtLeastZero), "damping proportional to stiffness; none"),
        may("clamped", OneOrMore(&Choice(&Edge::NAMES)), "edges that never move; none"),
        may("joined", OneOrMore(&Type::Item(SHELLS)), "shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none"),
        may("held", at_least(0, &Table(&HELD)), "nodes of the grid that are there already; none"),
        may("closed", Flag, "the first direction ends in the nodes where it starts; false"),
        COINCIDENT,
    ]
    "plate" "flat" [
        may("corner", Vector("m"), "a corner; the origin"),
        need("first", Vector("m"), "edge along the first direction"),
        need("second", Vector("m"), "edge along the second direction"),
    ]
    "cylinder" "part of a circular cylinder" [
        need("from", Vector("m"), "where the edge line starts"),
        need("along", Vector("m"), "the edge line, which is the second direction"),
        need("centre", Vector("m"), "a point of the axis"),
        need("axis", Vector("-"), "unit vector of the axis"),
        need("angle", Number("rad", Any), "turn of the edge line about the axis, which is the first direction"),
    ]
    "sphere_patch" "patch of a sphere between longitudes and latitudes about z" [
        need("centre", Vector("m"), "centre"),
        need("radius", Number("m", Positive), "radius"),
        need("longitude", Numbers(&[2], "rad", Any), "from and to, the first direction"),
        need("latitude", Numbers(&[2], "rad", Any), "from and to, the second direction"),
    ]
    "sphere_face" "one of six parts of a sphere" [
        need("centre", Vector("m"), "centre"),
        need("radius", Number("m", Positive), "radius"),
        need("first", Vector("-"), "unit vector along an edge of the face"),
        need("second", Vector("-"), "unit vector along the other, at right angles"),
    ]),
    build,
    ..Section::with_nodes(
        "shell",
        "A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along \
          the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].",
        Nodes { edges: &Edge::NAMES, own: 2, of_edge: 1, known: OF_BODY },
    )
};

/// The surface of a shell by its form.
fn surface(e: Entry, elements: [usize; 2]) -> Result<ShellMesh<Recorded>> {
    let (vector, number) = (|key| e.vector(key), |key| e.number(key));
    Ok(match e.form {
        "plate" => {
            let corner = e.vector_or("corner", Vector3::zeros())?;
            ShellMesh::plate(corner, [vector("first")?, vector("second")?], elements)
        }
        "cylinder" => {
            let (line, about) = ([vector("from")?, vector("along")?], [vector("centre")?, vector("axis")?.unit()]);
            ShellMesh::cylinder(line, about, number("angle")?, elements)
        }
        "sphere_patch" => {
            let ranges = (e.numbers("longitude")?, e.numbers("latitude")?);
            ShellMesh::sphere(vector("centre")?, number("radius")?, ranges.0, ranges.1, elements)
        }
        _ => {
            let edges = [vector("first")?.unit(), vector("second")?.unit()];
            ShellMesh::sphere_face(vector("centre")?, number("radius")?, edges, elements)
        }
    })
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let (name, elements) = (e.name(), e.counts("elements").unwrap_or([1; 2]));
    let mut mesh = surface(e, elements)?;
    if e.flag("closed") {
        mesh = mesh.closed();
    }
    if let Some(damping) = e.given("damping", Entry::number)? {
        mesh = mesh.damped(damping);
    }
    for edge in e.texts("clamped") {
        mesh = mesh.clamped(Edge::named(edge));
    }
    if e.flag("coincident") {
        mesh = mesh.with_coincident_points();
    }
    mesh = m.joined_to_each(mesh, &e.shells("joined"));
    for own in e.tables("held") {
        let [i, j] = own.counts("place").unwrap_or([0; 2]);
        let [columns, rows] = elements.map(|count| 2 * count + 1);
        if i >= columns || j >= rows {
            return own.wrong(format!("the grid of \"{name}\" has {columns} x {rows} nodes, counted from 0"));
        }
        mesh = mesh.with_node(i, j, own.node("node", m)?);
    }
    if e.has("laminate") {
        return Ok(Built::Shell(Box::new(m.laminate_shell(name, mesh, e.laminate()?.0, e.vector("direction")?))));
    }
    let (material, thickness) = (e.material()?, e.strips("thickness", elements[0])?);
    let (strips, along) = (thickness.len(), elements[0]);
    if strips == 0 || along % strips != 0 {
        let text = format!(
            "\"{name}\" has {strips} thicknesses of strips of equal width, but {along} elements along its first direction: give one, or as many as \
             divide these"
        );
        return e.wrong_key("thickness", text);
    }
    let shell = m.tapered_shell(name, mesh, &material, |element, _| thickness[(element % along) * strips / along]);
    Ok(Built::Shell(Box::new(shell)))
}
