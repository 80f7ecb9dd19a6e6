//! Wrong entries of meshes: each is told with the line of what is wrong, and for a file of Gmsh with its line, too.

use super::refused;

const SOUND: &str = r#"version = 1

[settings]
end = 0.1
steps = 2

[variable]
web = { initial = 0.01, bounds = [0.001, 0.1], unit = "m", per_face = "plate.left half" }
h = { initial = 0.02, bounds = [0.001, 0.1], unit = "m" }

[define]
twice = "2 * h"

[material.steel]
young = 2e11
poisson = 0.3
density = 7800

[laminate.cross]
plies = [{ thickness = 0.01, young = [1e11, 1e10], poisson = 0.3, shear = [5e9, 5e9, 3e9], density = 1600 }]

[[mesh]]
name = "plate"
type = "gmsh"
file = "tests/gmsh/quads4.msh"
material = "steel"
thickness = "h"
parts = [{ of = ["left half"], thickness = "web" }]
clamped = ["left edge"]

[[mesh]]
name = "strip"
type = "faces"
points = [[2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0], [4, 0, 0], [4, 1, 0], [2.5, 0, 0]]
faces = [[0, 1, 2, 3], [1, 4, 5, 2]]
groups = { near = [0], far = [1] }
node_sets = { side = [0, 3], corner = [5], nothing = [6] }
material = "steel"
thickness = "twice"

[[force]]
name = "push"
on = "strip.corner"
direction = [0, 0, 1]
size = 1

[[pressure]]
name = "press"
shell = "plate.right half"
size = 10

[[functional]]
name = "mass"
type = "mass"
of = ["plate.left half", "strip"]
over = "initial"
"#;

/// What is replaced by what, the text in whose line the mistake is told, and what it says.
const CASES: &[(&str, &str, &str, &[&str])] = &[
    ("tests/gmsh/quads4.msh", "tests/gmsh/none.msh", "none.msh", &["none.msh: cannot be read"]),
    ("tests/gmsh/quads4.msh", "tests/gmsh/plate.geo", "plate.geo", &["plate.geo:1: this is no mesh of Gmsh"]),
    (
        "tests/gmsh/quads4.msh",
        "tests/gmsh/solids-2.2.msh",
        "solids-2.2.msh",
        &["solids-2.2.msh: the mesh has no faces, but points (1), pyramids of 5 nodes (1)", "Physical Surface"],
    ),
    ("file = \"tests/gmsh/quads4.msh\"\n", "", "[[mesh]]", &["needs the key file", "path of the file"]),
    ("file = \"tests/gmsh/quads4.msh\"", "file = 3", "file = 3", &["file of [[mesh]] \"plate\" must be a text"]),
    ("type = \"gmsh\"", "type = \"gmesh\"", "gmesh", &["type \"gmesh\"", "did you mean \"gmsh\"?"]),
    (
        "clamped = [\"left edge\"]",
        "clamped = [\"left edg\"]",
        "edg\"",
        &["node set \"left edg\"", "did you mean \"left edge\"?"],
    ),
    ("of = [\"left half\"]", "of = [\"left hlf\"]", "hlf", &["group of faces \"left hlf\"", "did you mean \"left half\"?"]),
    (
        "parts = [",
        "parts = [{ of = [\"surface 3\"], thickness = 1 }, ",
        "surface 3",
        &["of \"left half\" belongs to another part"],
    ),
    (
        "material = \"steel\"\nthickness = \"h\"\n",
        "material = \"steel\"\n",
        "[[mesh]]",
        &["element 12 belongs to none of its 1 parts"],
    ),
    ("thickness = \"h\"", "thickness = \"web\"", "thickness = \"web\"", &["has no value for element 12"]),
    ("thickness = \"h\"", "laminate = \"cross\"", "[[mesh]]", &["direction is needed"]),
    (
        "thickness = \"h\"",
        "thickness = \"h\"\nlaminate = \"cross\"\ndirection = [1, 0, 0]",
        "thickness = \"h\"",
        &["leave out thickness or laminate"],
    ),
    ("thickness = \"h\"", "laminate = \"cross\"\ndirection = [0, 0, 1]", "[[mesh]]", &["normal to its surface"]),
    (
        "thickness = \"twice\"",
        "thickness = \"web\"",
        "thickness = \"web\"\n\n",
        &["\"web\" has a value for each face or node of \"plate\""],
    ),
    (
        "twice = \"2 * h\"",
        "twice = \"2 * web\"",
        "twice =",
        &["\"web\" has a value for each face", "only the thickness of this mesh"],
    ),
    ("per_face = \"plate.left half\"", "per_face = \"plat\"", "per_face", &["mesh \"plat\"", "did you mean \"plate\"?"]),
    ("per_face = \"plate.left half\"", "per_face = \"plate.lft half\"", "per_face", &["did you mean \"left half\"?"]),
    (
        "per_face = \"plate.left half\"",
        "per_face = \"plate[3]\"",
        "per_face",
        &["must name a mesh, or a group of its faces"],
    ),
    ("per_face = \"plate.left half\"", "per_face = \"plate\", per_node = \"plate\"", "per_face", &["not both"]),
    ("clamped = [\"left edge\"]", "reverse = [\"all\"]", "reverse", &["group of faces \"all\"", "right half"]),
    (
        "clamped = [\"left edge\"]",
        "nodes = [{ at = \"left edge\", node = \"strip[1]\" }]",
        "at = ",
        &["3 nodes, and one is wanted"],
    ),
    ("clamped = [\"left edge\"]", "nodes = [{ at = \"999\", node = \"strip[1]\" }]", "at = ", &["no node 999"]),
    (
        "clamped = [\"left edge\"]",
        "nodes = [{ at = \"1\", node = \"strip[1]\" }]",
        "[[mesh]]",
        &["m from its node \"strip[1]\""],
    ),
    ("clamped = [\"left edge\"]", "scale = 0", "scale", &["scale of [[mesh]] \"plate\" is 0", "greater than 0"]),
    ("\"strip.corner\"", "\"strip.crner\"", "crner", &["node set \"crner\"", "did you mean \"corner\"?"]),
    ("\"strip.corner\"", "\"strip\"", "on = \"strip", &["a mesh has many nodes", "side, corner"]),
    ("\"strip.corner\"", "\"strip[7]\"", "on = \"strip", &["no node 7", "from 0 to 6"]),
    ("\"strip.corner\"", "\"strip[6]\"", "on = \"strip", &["node 6 belongs to no face"]),
    ("\"strip.corner\"", "\"strip.nothing\"", "on = \"strip", &["node 6 of the node set belongs to no face"]),
    ("\"strip.corner\"", "\"strip.side[2]\"", "on = \"strip", &["the node set has 2 nodes, counted from 0"]),
    ("\"strip.corner\"", "\"strip.side[x]\"", "on = \"strip", &["[i] is the number of a node"]),
    (
        "\"strip.corner\"\n",
        "\"strip.side\"\npoint = [0, 0, 0]\n",
        "point = ",
        &["a force on 2 nodes has no point of its own"],
    ),
    (
        "type = \"mass\"\nof = [\"plate.left half\", \"strip\"]",
        "type = \"position\"\non = \"strip.side\"\ndirection = [1, 0, 0]",
        "on = \"strip.side\"",
        &["has 2 nodes, and one is wanted", "rigid_interface"],
    ),
    ("\"plate.right half\"", "\"plate.rght half\"", "shell = ", &["did you mean \"plate.right half\"?"]),
    ("\"plate.left half\", \"strip\"", "\"plate.left\"", "of = [\"plate.left\"", &["plate.right half"]),
    ("faces = [[0, 1, 2, 3],", "faces = [[0, 1, 2],", "faces = ", &["a face has 4, 6, 8 or 9 points; this one has 3"]),
    ("faces = [[0, 1, 2, 3],", "faces = [[0, 1, 2, 7],", "faces = ", &["no point 7 among 7"]),
    ("faces = [[0, 1, 2, 3],", "faces = [[0, 1, 2, 2.5],", "faces = ", &["whole number from 0", "2.5"]),
    ("faces = [[0, 1, 2, 3],", "faces = [3,", "faces = ", &["lists of whole numbers", "the number 3"]),
    (
        "faces = [[0, 1, 2, 3],",
        "faces = [[0, 3, 2, 1],",
        "[[mesh]]\nname = \"strip\"",
        &["element 0 and element 1", "reverse one of them"],
    ),
    ("faces = [[0, 1, 2, 3],", "faces = [[0, 2, 1, 3],", "[[mesh]]\nname = \"strip\"", &["element 0 is folded"]),
    ("near = [0]", "near = [2]", "groups = ", &["\"near\" of groups: names face 2, which is not there", "from 0 to 1"]),
    (
        "side = [0, 3]",
        "side = [0, 7]",
        "node_sets = ",
        &["\"side\" of node_sets: names node 7, which is not there", "from 0 to 6"],
    ),
    ("side = [0, 3]", "side = 3", "node_sets = ", &["lists of whole numbers", "the number 3"]),
    ("groups = { near = [0], far = [1] }", "groups = [0]", "groups = ", &["table of names with lists"]),
    (
        "side = [0, 3]",
        "side = \"x < 1.9\"",
        "node_sets = ",
        &["\"x < 1.9\" selects no node", "x from 2 to 4, y from 0 to 1, z from 0 to 0", "before scale"],
    ),
    ("near = [0]", "near = \"x > 4\"", "groups = ", &["\"x > 4\" selects no face: middles of faces have x from 2.5 to 3.5"]),
    ("side = [0, 3]", "side = \"x < h\"", "node_sets = ", &["\"side\" of node_sets", "name \"h\"", "x, y, z"]),
    ("side = [0, 3]", "side = \"x = 0\"", "node_sets = ", &["abs(x) < 1e-6 allows for round-off"]),
    ("side = [0, 3]", "side = \"x\"", "node_sets = ", &["a condition compares, as in x < 1e-6"]),
    (
        "clamped = [\"left edge\"]",
        "node_sets = { \"left edge\" = \"x < 0\" }",
        "node_sets = { \"left",
        &["node_sets: the file of the mesh has \"left edge\" already"],
    ),
    (
        "clamped = [\"left edge\"]",
        "groups = { upper = [10, 12, 13] }",
        "groups = { upper",
        &["\"upper\" of groups: names face 10, which is not there; faces are numbered from 12 to "],
    ),
    (
        "clamped = [\"left edge\"]",
        "node_sets = { low = \"y < -0.99\", left = \"x < -0.99\" }\nclamped = [\"low\", \"left\", \"lft\"]",
        "lft",
        &["node set \"lft\"", "did you mean \"left\"?"],
    ),
    ("points = [[2, 0, 0],", "points = [[2, 0],", "points = ", &["vector [x, y, z]", "a list of 2"]),
];

#[test]
fn the_sound_mesh_is_sound() {
    assert_eq!(refused(SOUND), "nothing was found");
}

#[test]
fn wrong_meshes_are_told_with_their_line() {
    let mut failed = Vec::new();
    for (what, by, marked, parts) in CASES {
        assert!(SOUND.contains(what), "{what} is not in the file");
        let text = SOUND.replacen(what, by, 1);
        let at = text.find(marked).unwrap_or_else(|| panic!("{marked} is not in the file with {by}"));
        let place = format!("scene.toml:{}:", text[..at].matches('\n').count() + 1);
        let message = refused(&text);
        if !message.lines().any(|line| line.starts_with(&place)) || !parts.iter().all(|part| message.contains(part)) {
            failed.push(format!("{what:?} -> {by:?}\n  wanted {place} {parts:?}\n  {message}"));
        }
    }
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), CASES.len(), failed.join("\n"));
}
