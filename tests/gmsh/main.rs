//! Meshes that Gmsh 4.8 wrote, and such files with something wrong in them: see plate.geo beside. Versions before 4.1 were written with
//! `-format msh22` and `msh40`, parameters with `Mesh.SaveParametric`; mixed-2.2.msh and solids-2.2.msh are by hand, mixed-2.2-binary.msh is the
//! first of these in memory, quads4-2.2-big-endian.msh is quads4-2.2-binary.msh with the bytes of its numbers in the other order.

use costate::elements::flexible::Material;
use costate::scenes::{FilePlace, FreeMesh, MechanismBuilder, MeshData, parse_gmsh, read_gmsh};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gmsh").join(name)
}

fn read(name: &str) -> MeshData {
    read_gmsh(&path(name)).unwrap_or_else(|why| panic!("{why}"))
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(path(name)).unwrap()
}

const SORTS: [&str; 7] = ["quads4", "quads8", "quads9", "quads16", "triangles3", "triangles6", "triangles15"];

/// All files here.
fn all_files() -> Vec<String> {
    let entries = std::fs::read_dir(path("")).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.filter(|name| name.ends_with(".msh")).collect();
    names.sort();
    names
}

/// A shell of thickness 1 m and density 1 kg/m3: its mass is its area. That of some faces, and of all.
fn areas(data: &MeshData, group: &[usize]) -> [f64; 2] {
    let mut m = MechanismBuilder::<f64>::default();
    let material = Material { young: 1.0, poisson: 0.0, density: 1.0 };
    let mesh = FreeMesh::of_data(&std::sync::Arc::new(data.clone()));
    m.shell("plate", mesh, &material, 1.0);
    let m = m.finish().unwrap_or_else(|why| panic!("{why}"));
    let mass = |place: usize| {
        let element = &m.model.elements[place];
        let of = |x: &[f64]| -> Vec<f64> {
            element.nodes.iter().flat_map(|&node| x[m.model.node(node).dofs.clone()].to_vec()).collect()
        };
        let q = of(&m.numbers.q);
        element.physics.energies_at(&vec![0.0; q.len()], &q, &m.numbers.p[element.parameters.clone()])[2]
    };
    [group.iter().map(|&face| mass(face)).sum(), (0..data.faces.len()).map(mass).sum()]
}

#[test]
fn text_and_binary_files_of_gmsh_are_the_same_mesh() {
    for sort in SORTS {
        let (text, binary) = (read(&format!("{sort}.msh")), read(&format!("{sort}-binary.msh")));
        // texts have 16 digits
        let pairs = text.points.iter().flatten().zip(binary.points.iter().flatten());
        assert!(pairs.into_iter().all(|(text, binary)| (text - binary).abs() < 1e-15), "{sort}");
        assert_eq!(text.point_numbers, binary.point_numbers, "{sort}");
        assert_eq!([&text.groups, &text.node_sets], [&binary.groups, &binary.node_sets], "{sort}");
        assert_eq!([&text.face_numbers], [&binary.face_numbers], "{sort}");
        assert_eq!(text.faces, binary.faces, "{sort}");
        assert!(matches!(text.face_places[0], FilePlace::Line(_)), "{sort}");
        assert!(matches!(binary.face_places[0], FilePlace::Byte(_)), "{sort}");
    }
}

#[test]
fn files_of_all_versions_are_the_same_mesh() {
    for (sort, others) in
        [("quads4", &["2.2", "2.2-binary", "2.2-parametric-binary", "2.2-big-endian", "4.0"][..]), ("triangles3", &["2.2"])]
    {
        let expected = read(&format!("{sort}.msh"));
        for other in others {
            let own = read(&format!("{sort}-{other}.msh"));
            // texts have 16 digits
            let pairs = own.points.iter().flatten().zip(expected.points.iter().flatten());
            assert!(pairs.into_iter().all(|(own, expected)| (own - expected).abs() < 1e-15), "{other}");
            assert_eq!(own.point_numbers, expected.point_numbers, "{other}");
            // version 2 writes faces of two groups twice and counts them anew
            assert_eq!(own.faces, expected.faces, "{other}");
            assert_eq!([&own.groups, &own.node_sets], [&expected.groups, &expected.node_sets], "{other}");
            assert_eq!(own.notes, expected.notes, "{other}");
        }
    }
    // names of version 2.0 have no dimension, and tags may be missing
    let text = String::from_utf8(bytes("mixed-2.2.msh")).unwrap();
    let old = text.replace("2.2 0 8", "2 0 8").replace("1 3 \"", "3 \"").replace("2 1 \"", "1 \"").replace("3 2 \"", "2 \"");
    let old = old.replace("\n1 15 2 0 1 1\n", "\n1 15 0 1\n");
    assert_eq!(
        MeshData { file: String::new(), ..parse_gmsh("", old.as_bytes()).unwrap() },
        parse_gmsh("", text.as_bytes()).unwrap()
    );
}

#[test]
fn triangles_of_three_nodes_are_raised_with_middles_in_common() {
    let data = read("triangles3.msh");
    assert!(data.faces.iter().all(|face| face.len() == 6));
    // what Euler says of a plate with a hole: faces - edges + corners = 0
    let (faces, corners) = (data.faces.len(), 24);
    let edges = data.points.len() - corners;
    assert_eq!(faces + corners, edges);
    let middle = |a: usize, b: usize| [0, 1, 2].map(|k| 0.5 * (data.points[a][k] + data.points[b][k]));
    for face in &data.faces {
        (0..3).for_each(|k| assert_eq!(data.points[face[3 + k]], middle(face[k], face[(k + 1) % 3])));
    }
    // curves go through the middles of their edges, which are held with them
    let hole = data.node_set("hole").unwrap();
    assert_eq!(hole.len(), 16);
    hole.chunks(2).zip(hole.iter().skip(2).step_by(2)).for_each(|(own, &next)| {
        assert_eq!(data.points[own[1]], middle(own[0], next));
    });
    assert_eq!(data.point_numbers[corners..], (25..25 + edges).collect::<Vec<_>>());
    assert!(
        data.notes.iter().any(|note| note.contains(&format!("triangles of 3 nodes raised to 6 ({faces}): nodes 25 to")))
    );
}

#[test]
fn solids_are_left_out_beside_faces_and_quadrilaterals_fit_to_raised_triangles() {
    for name in ["mixed-2.2.msh", "mixed-2.2-binary.msh"] {
        let data = read(name);
        assert_eq!(data.faces.iter().map(Vec::len).collect::<Vec<_>>(), [9, 6, 6, 6], "{name}");
        assert_eq!(data.group("skin"), Some(&[0, 1, 2, 3][..]), "{name}");
        assert!(data.group("core").is_none(), "{name}");
        assert_eq!(data.points[data.node_set("root").unwrap()[1]], [0.0, 0.5, 0.0], "{name}");
        let [_, all] = areas(&data, &[]);
        assert!((all - 2.5).abs() < 1e-14, "{name}: {all}");
        let notes = data.notes.join("\n");
        for part in [
            "left out: points (1), lines of 2 nodes (1), tetrahedra of 4 nodes (1), pyramids of 5 nodes (1)",
            "triangles of 3 nodes raised to 6 (3), and quadrilaterals of 4 nodes beside them to 9 (1): nodes 11 to 21 are",
            "nodes that belong to no face: 3 of 21",
        ] {
            assert!(notes.contains(part), "{name}: {notes}");
        }
    }
    let why = read_gmsh(&path("solids-2.2.msh")).unwrap_err();
    for part in ["no faces, but points (1), pyramids of 5 nodes (1)", "Physical Surface", "-save_all"] {
        assert!(why.contains(part), "{why}");
    }
    assert!(read("quads9.msh").notes.is_empty());
}

/// Distance of the middles of eight edges around a circle of radius 1 from its centre: of chords, of curves through a point of the circle, or
/// through two, a third of the edge from its ends.
fn middle_of_edges(sort: &str) -> f64 {
    let half = PI / 8.0;
    match sort {
        "quads4" | "triangles3" => half.cos(),
        "quads16" => (9.0 * (half / 3.0).cos() - half.cos()) / 8.0,
        _ => 1.0,
    }
}

/// Area that chords or arcs of eight parts leave of a square of side 2 around a circle of radius 1/2: an eighth of the circle is a chord, or a
/// parabola through its middle, under which lie two thirds of the rectangle on the chord.
fn area(sort: &str) -> f64 {
    let (radius, half) = (0.5, PI / 8.0);
    let triangles = 8.0 * 0.5 * radius * radius * (2.0 * half).sin();
    4.0 - triangles - 8.0 * 2.0 / 3.0 * (2.0 * radius * half.sin()) * (radius * (middle_of_edges(sort) - half.cos()))
}

#[test]
fn faces_of_higher_order_are_lowered_to_second() {
    let near = |data: &MeshData, point: usize, place: [f64; 3]| {
        let apart = (0..3).map(|k| (data.points[point][k] - place[k]).abs()).fold(0.0, f64::max);
        // Gmsh's points on curves are exact to about 1e-12
        assert!(apart < 1e-11, "{:?} instead of {place:?}", data.points[point]);
    };
    // of an even number of parts: the nodes that stand in the middles of edges
    let own = read("triangles15.msh");
    assert!(own.faces.iter().all(|face| face.len() == 6));
    assert_eq!(own.points.len(), own.point_numbers.iter().max().copied().unwrap());
    let hole = own.node_set("hole").unwrap();
    hole.iter().for_each(|&point| {
        let [x, y, _] = own.points[point];
        assert!((x.hypot(y) - 0.5).abs() < 1e-11, "{x} {y}");
    });
    assert_eq!(hole.len(), 16);
    assert!(
        own.notes[0].contains(&format!("triangles of 15 nodes lowered to second order ({})", own.faces.len())),
        "{:?}",
        own.notes
    );
    // of an odd one: new nodes, in common with the neighbours and curves
    let own = read("quads16.msh");
    assert!(own.faces.iter().all(|face| face.len() == 9));
    let (faces, corners) = (own.faces.len(), read("quads4.msh").points.len());
    let edges = faces + corners;
    let used = own.used().into_iter().filter(|used| *used).count();
    assert_eq!(used, corners + edges + faces);
    assert_eq!(own.node_set("hole").unwrap().len(), 16);
    let straight: Vec<usize> = own.node_set("left edge").unwrap();
    assert_eq!(straight.len(), 5);
    straight.iter().zip([1.0, 0.5, 0.0, -0.5, -1.0]).for_each(|(&point, y)| near(&own, point, [-1.0, y, 0.0]));
    assert!(
        own.notes.iter().any(|note| note.contains("quadrilaterals of 16 nodes lowered to second order")),
        "{:?}",
        own.notes
    );
}

/// A square of a polynomial of third degree in both directions keeps its middles, exactly, and the order of its nodes is that of Gmsh.
#[test]
fn middles_of_a_quadrilateral_are_those_of_its_own_surface() {
    // corners, edges, and an inner quadrilateral of first order
    let places = [
        [0, 0],
        [3, 0],
        [3, 3],
        [0, 3],
        [1, 0],
        [2, 0],
        [3, 1],
        [3, 2],
        [2, 3],
        [1, 3],
        [0, 2],
        [0, 1],
        [1, 1],
        [2, 1],
        [2, 2],
        [1, 2],
    ];
    let height = |x: f64, y: f64| x * x * x - 2.0 * x * y * y + 0.3 * y * y * y * x * x;
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n16\n");
    for (number, [i, j]) in places.into_iter().enumerate() {
        let (x, y) = (f64::from(i) / 3.0, f64::from(j) / 3.0);
        text += &format!("{} {x:e} {y:e} {:e}\n", number + 1, height(x, y));
    }
    text += "$EndNodes\n$Elements\n1\n1 36 2 1 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n$EndElements\n";
    // beside a face of first order, a curve of third has its middle all the same
    let face = "1\n1 36 2 1 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n";
    assert!(text.contains(face));
    let curve = text.replace(face, "2\n1 3 2 1 1 1 2 3 4\n2 26 2 5 5 1 2 5 6\n");
    let data = parse_gmsh("curve.msh", curve.as_bytes()).unwrap();
    assert_eq!((data.points.len(), data.point_numbers.len()), (17, 17));
    assert_eq!(data.node_set("curve 5").unwrap(), [0, 16, 1]);
    let data = parse_gmsh("square.msh", text.as_bytes()).unwrap();
    let wanted =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.5]];
    for (&point, [x, y]) in data.faces[0].iter().zip(wanted) {
        let own = data.points[point];
        let apart =
            [own[0] - x, own[1] - y, own[2] - height(x, y)].into_iter().fold(0.0, |most: f64, off| most.max(off.abs()));
        assert!(apart < 1e-15, "{own:?} instead of {x}, {y}, {}", height(x, y));
    }
    assert!(
        data.notes[0].ends_with("lowered to second order (1): nodes 17 to 21 are the middles of edges and faces"),
        "{:?}",
        data.notes
    );
}

#[test]
fn faces_that_hang_together_are_turned_to_one_side() {
    let straight = read("quads9.msh");
    let sides = |data: &MeshData| -> Vec<bool> {
        (0..data.faces.len()).map(|face| data.faces[face] == straight.faces[face]).collect()
    };
    // most decide
    let mut own = straight.clone();
    own.reverse([1, 4]);
    own.orient([]);
    assert!(sides(&own).into_iter().all(|same| same));
    assert!(
        own.notes[0].starts_with("turned round") && own.notes[0].ends_with(&format!("2 of {} faces", own.faces.len())),
        "{:?}",
        own.notes
    );
    // or those that lead
    let mut own = straight.clone();
    own.reverse([1, 4]);
    own.orient([1, 4]);
    assert!(!sides(&own).into_iter().any(|same| same));
    // nothing to do, nothing said
    let mut own = straight.clone();
    own.orient([3]);
    assert_eq!(own, straight);
    // a third face at an edge, and a band that is twisted in itself, stay
    let branch = MeshData {
        points: vec![[0.0; 3]; 5],
        faces: vec![vec![0, 1, 2], vec![0, 1, 3], vec![0, 1, 4]],
        ..MeshData::default()
    };
    let twisted = MeshData {
        points: vec![[0.0; 3]; 6],
        faces: vec![vec![0, 1, 3, 2], vec![2, 3, 5, 4], vec![4, 5, 0, 1]],
        ..MeshData::default()
    };
    for own in [branch, twisted] {
        let mut turned = own.clone();
        turned.orient([]);
        assert_eq!(turned, own);
    }
}

#[test]
fn areas_are_those_of_the_edges() {
    for sort in SORTS {
        let data = read(&format!("{sort}.msh"));
        let expected = area(sort);
        let [right, all] = areas(&data, data.group("right half").unwrap());
        let [left, _] = areas(&data, data.group("left half").unwrap());
        // Gmsh's points on curves are exact to about 1e-12
        for (own, expected) in [(all, expected), (right, 0.5 * expected), (left, 0.5 * expected)] {
            assert!((own - expected).abs() < 1e-10, "{sort}: {own} instead of {expected}");
        }
        println!("{sort}: area {all}, {expected} expected, {:.1e} apart", all - expected);
    }
}

#[test]
fn physical_groups_are_groups_and_node_sets_in_order() {
    for sort in SORTS {
        let data = read(&format!("{sort}.msh"));
        let names = |all: &[(String, Vec<usize>)]| all.iter().map(|own| own.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&data.groups), ["right half", "left half", "surface 3"], "{sort}");
        assert_eq!(names(&data.node_sets), ["corner", "hole", "left edge"], "{sort}");
        let mut both = [data.group("right half").unwrap(), data.group("left half").unwrap()].concat();
        both.sort_unstable();
        assert_eq!(both, (0..data.faces.len()).collect::<Vec<_>>(), "{sort}");
        assert_eq!(data.group("surface 3").unwrap(), both, "{sort}");
        let [corner] = data.node_set("corner").unwrap()[..] else { panic!("{sort}") };
        assert_eq!(data.points[corner], [1.0, 1.0, 0.0]);
        let on = |name: &str, is_on: &dyn Fn([f64; 3]) -> bool| {
            let set = data.node_set(name).unwrap();
            assert!(set.iter().all(|&point| is_on(data.points[point])), "{sort}: {name}");
            set
        };
        // middles of edges may lie inside the circle
        let least = 0.5 * middle_of_edges(sort);
        let hole = on("hole", &|[x, y, _]| (least - 1e-9..0.5 + 1e-9).contains(&x.hypot(y)));
        let per_part = if sort == "quads4" { 1 } else { 2 };
        assert_eq!(hole.len(), 8 * per_part, "{sort}");
        // around the hole, each point beside the last
        let length = |[a, b]: [usize; 2]| {
            let [a, b] = [data.points[a], data.points[b]];
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        let longest = hole.windows(2).map(|pair| length([pair[0], pair[1]])).fold(0.0, f64::max);
        assert!(longest < 1.01 * (PI / 8.0 / per_part as f64).sin(), "{sort}: {longest}");
        assert_eq!(on("left edge", &|[x, _, _]| x == -1.0).len(), 2 * per_part + 1, "{sort}");
        // the points of a group of faces, where no set has the name
        let half = on("right half", &|[x, _, _]| x > -1e-9);
        assert!(half.len() < data.points.len() && half.is_sorted(), "{sort}");
        // the middle of the circle belongs to no face: it is a point, and no node, as are nodes of a higher order than second
        if matches!(sort, "quads16" | "triangles15") {
            continue;
        }
        assert_eq!(data.used().iter().filter(|used| !**used).count(), usize::from(data.point(7).is_none()), "{sort}");
    }
}

/// A text as Gmsh writes it, of one square of four nodes in two groups, both of which turn it, and with parameters at its nodes.
const SQUARE: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 5 \"square \"of\" four\"\n1 2 \"side\"\n$EndPhysicalNames\n\
    $Entities\n0 1 1 0\n4 0 0 0 1 0 0 1 2 0 \n9 0 0 0 1 1 0 2 -5 -6 1 4 \n$EndEntities\n\
    $Nodes\n2 5 1 50\n1 4 1 2\n30\n10\n0 0 0 0.5\n1 0 0 0.25\n2 9 1 3\n1\n2\n50\n1 1 0 0 1\n0 1 0 1 0\n7 7 7 0 0\n$EndNodes\n\
    $Elements\n2 2 3 8\n1 4 1 1\n3 30 10 \n2 9 3 1\n8 30 10 1 2 \n$EndElements\n\
    $NodeData\n1\n\"a view\"\n$EndNodeData\n";

#[test]
fn parameters_are_passed_over_and_a_minus_sign_turns_faces_round() {
    // whatever the ends of lines are
    for text in [SQUARE.to_string(), SQUARE.replace('\n', "\r\n")] {
        let data = parse_gmsh("square.msh", text.as_bytes()).unwrap();
        assert_eq!(data.points, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [7.0; 3]]);
        assert_eq!(data.point_numbers, [30, 10, 1, 2, 50]);
        assert_eq!(data.faces, [[0, 3, 2, 1]]);
        assert_eq!((data.face_numbers, data.face_places), (vec![8], vec![FilePlace::Line(34)]));
        assert_eq!(data.groups, [("square \"of\" four".to_string(), vec![0]), ("surface 6".into(), vec![0])]);
        assert_eq!(data.node_sets, [("side".to_string(), vec![0, 1])]);
    }
}

/// Files of which something is replaced: which, by what, the place and the words of the message.
const WRONG: &[(&str, &str, &str, &str, &[&str])] = &[
    ("", "$MeshFormat", "{}", ":1", &["no mesh of Gmsh"]),
    ("", "4.1 0 8", "3 0 8", ":2", &["version \"3\"", "versions 2.0 to 2.2, 4.0 and 4.1", "-save -format msh41"]),
    ("", "$MeshFormat", "$NOD", ":1", &["version 1", "-save -format msh41"]),
    ("", "4.1 0 8", "2.2 0 8", ":9", &["$Entities does not belong to version 2.2"]),
    ("", "4.1 0 8", "4.1 0 4", ":2", &["4 bytes"]),
    ("", "4.1 0 8", "4.1 2 8", ":2", &["0, a text, or 1, binary; it is 2"]),
    ("", "4.1 0 8\n$EndMeshFormat", "4.1 0 8\n$EndMesh", ":3", &["$EndMeshFormat is wanted", "\"$EndMesh\""]),
    ("", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "", ":1", &["$PhysicalNames stands before $MeshFormat"]),
    ("", "2 5 \"square", "2 5 square", ":6", &["between quotes"]),
    ("", "1 2 \"side\"", "2 5 \"side\"", ":7", &["group 5 of dimension 2 has two names"]),
    (
        "",
        "$PhysicalNames\n2\n",
        "$PhysicalNames\n3\n",
        ":8",
        &["$EndPhysicalNames where the dimension of a group is wanted"],
    ),
    ("", "$PhysicalNames\n2\n", "$PhysicalNames\n1\n", ":7", &["$EndPhysicalNames is wanted here"]),
    ("", "$PhysicalNames\n2\n", "$PhysicalNames\n2000000\n", ":6", &["2000000 names are announced", "cut off"]),
    ("", "0 1 1 0\n4", "0 1 2 0\n4", ":13", &["$EndEntities where the number of an entity"]),
    ("", "2 -5 -6", "2 -2147483648 -6", "", &[]),
    ("mixed-2.2.msh", "5 2 2 1 1", "5 2 2 -2147483648 1", "", &[]),
    ("", "2 -5 -6", "2 -5 6", ":33", &["surface 9", "\"square \"of\" four\", \"surface 6\"", "minus sign"]),
    ("", "9 0 0 0 1 1 0", "8 0 0 0 1 1 0", ":33", &["no surface 9 in $Entities"]),
    ("", "$Nodes\n2 5 1 50", "$Nodes\n2 18446744073709551615 1 50", ":16", &["18446744073709551615 nodes are announced"]),
    ("", "$Nodes\n2 5 1 50", "$Nodes\n2 18446744073709551616 1 50", ":15", &["\"18446744073709551616\""]),
    ("", "$Nodes\n2 5 1 50", "$Nodes\n2 -1 1 50", ":15", &["the number of nodes must be a whole number", "\"-1\""]),
    ("", "$Nodes\n2 5 1 50", "$Nodes\n2 6 1 50", ":28", &["announces 6 nodes", "have 5"]),
    ("", "$Nodes\n2 5 1 50", "$Nodes\n2 5 1 49", ":24", &["the number of a node is 50", "from 1 to 49"]),
    ("", "1 4 1 2\n30\n10\n", "1 4 1 2\n30\n30\n", ":18", &["node 30 is there twice"]),
    ("", "1 4 1 2\n30", "1 4 2 2\n30", ":16", &["parameters must be 0 or 1; it is 2"]),
    ("", "1 4 1 2\n30", "4 4 1 2\n30", ":16", &["dimension of an entity must be from 0 to 3; it is 4"]),
    ("", "7 7 7 0 0", "7 7 nan 0 0", ":27", &["coordinate of a node must be a finite number; it is \"nan\""]),
    ("", "7 7 7 0 0", "7 7 x 0 0", ":27", &["coordinate of a node must be a finite number; it is \"x\""]),
    ("", "7 7 7 0 0", "7 7 7 0 x", ":27", &["parameter of a node must be a finite number; it is \"x\""]),
    (
        "",
        "$PhysicalNames\n2\n",
        "$PhysicalNames\n3\n2 6 \"square \"of\" four\"\n",
        "",
        &["two physical groups of surfaces are named \"square \"of\" four\""],
    ),
    ("", "7 7 7 0 0", "7 7 7 0", ":28", &["$EndNodes where a parameter of a node is wanted"]),
    ("", "2 9 3 1\n8 30 10 1 2", "2 9 3 1\n8 30 10 1 3", ":34", &["element 8 names node 3", "$Nodes does not have"]),
    ("", "2 9 3 1\n8 30", "2 9 3 2\n8 30 10 1 2\n8 30", ":35", &["element 8 is there twice"]),
    ("", "2 9 3 1\n8 30", "2 9 3 1\n9 30", ":34", &["the number of an element is 9", "from 3 to 8"]),
    ("", "$Elements\n2 2 3 8", "$Elements\n2 3 3 8", ":35", &["announces 3 elements", "have 2"]),
    ("", "2 9 3 1\n8 30", "2 9 1 1\n8 30", ":33", &["surface 9", "lines of 2 nodes cannot be a part of it"]),
    ("", "2 9 3 1\n8", "2 9 4 1\n8", ":33", &["surface 9", "tetrahedra of 4 nodes cannot be a part of it"]),
    ("", "2 9 3 1\n8 30 10 1 2 ", "2 9 21 1\n8 30 10 1 2 ", ":35", &["$EndElements where the number of a node"]),
    ("", "2 9 3 1\n8", "2 9 32 1\n8", ":33", &["solids of third order", "Mesh.SecondOrderIncomplete = 0"]),
    ("", "2 9 3 1\n8", "2 9 34 1\n8", ":33", &["elements of type 34"]),
    ("", "1 4 1 1\n3", "1 4 21 1\n3", ":31", &["curve 4", "\"side\"", "triangles of 10 nodes cannot be a part of it"]),
    ("", "2 9 3 1\n8 30 10 1 2", "2 9 3 0", "", &["2 elements", "have 1"]),
    (
        "",
        "$Elements\n2 2 3 8\n1 4 1 1\n3 30 10 \n2 9 3 1\n8 30 10 1 2 \n",
        "$Elements\n0 0 0 0\n",
        "",
        &["no faces", "gmsh -2"],
    ),
    ("", "$NodeData\n1\n\"a view\"\n$EndNodeData\n", "$NodeData\n1\n", ":37", &["$NodeData has no end", "cut off"]),
    ("", "$NodeData\n1\n\"a view\"\n$EndNodeData\n", "$Nodes\n", ":36", &["two sections $Nodes"]),
    ("", "$NodeData\n1\n\"a view\"\n$EndNodeData\n", "data\n", ":36", &["a section such as $Nodes", "\"data\""]),
    ("", "$Entities\n", "$PartitionedEntities\n", ":9", &["partitioned", "UnpartitionMesh"]),
    ("", "2 5 \"square \"of\" four\"", "1 7 \"side\"", "", &[]),
    ("mixed-2.2.msh", "2.2 0 8", "2.2 0 4", ":2", &["4 bytes"]),
    ("mixed-2.2.msh", "$Nodes\n10", "$Nodes\n99", ":12", &["99 nodes are announced"]),
    ("mixed-2.2.msh", "$Nodes\n10", "$Nodes\n-1", ":11", &["number of nodes must be a whole number"]),
    ("mixed-2.2.msh", "$Nodes\n10", "$Nodes\n11", ":22", &["$EndNodes where the number of a node is wanted"]),
    ("mixed-2.2.msh", "\n10 3 1 0", "\n1 3 1 0", ":21", &["node 1 is there twice"]),
    ("mixed-2.2.msh", "$Elements\n9", "$Elements\n8", ":33", &["$EndElements is wanted here"]),
    ("mixed-2.2.msh", "5 2 2 1 1 2 5 3", "5 2 2000 1 1 2 5 3", ":29", &["2000 tags are announced"]),
    ("mixed-2.2.msh", "5 2 2 1 1 2 5 3", "5 2 2 1 1 2 5 77", ":29", &["element 5 names node 77"]),
    ("mixed-2.2.msh", "5 2 2 1 1 2 5 3", "6 2 2 1 1 2 5 3", ":30", &["element 6 is there twice"]),
    ("mixed-2.2.msh", "5 2 2 1 1 2 5 3", "5 21 2 1 1 2 5 3", ":34", &["$EndElements where the number of an element"]),
    ("mixed-2.2.msh", "5 2 2 1 1 2 5 3", "5 79 2 1 1 2 5 3", ":29", &["solids of third order", "ElementOrder = 2"]),
    (
        "mixed-2.2.msh",
        "9 3 0 0\n10 3 1 0",
        "9 3 0 0\n18446744073709551615 3 1 0",
        "",
        &["leaves none for nodes in the middles"],
    ),
];

#[test]
fn wrong_files_are_told_with_their_place() {
    let mut kinds = 0;
    for (file, from, to, place, words) in WRONG {
        let text = if file.is_empty() { SQUARE.to_string() } else { String::from_utf8(bytes(file)).unwrap() };
        assert!(text.contains(from), "{from}");
        let result = parse_gmsh("a.msh", text.replacen(from, to, 1).as_bytes());
        if words.is_empty() {
            assert!(result.is_ok(), "{from} by {to}: {result:?}");
            continue;
        }
        let Err(why) = result else { panic!("{from} by {to} is taken") };
        assert!(why.starts_with(&format!("a.msh{place}: ")) || place.is_empty(), "{from} by {to}, {place}: {why}");
        words.iter().for_each(|word| assert!(why.contains(word), "{from} by {to}, \"{word}\": {why}"));
        kinds += 1;
    }
    assert!(kinds > 40, "{kinds}");
}

#[test]
fn files_that_are_cut_off_are_told_wherever_they_end() {
    for name in all_files() {
        let name = name.as_str();
        let whole = bytes(name);
        // without the last line of a text, whose end is not missed
        for end in (0..whole.len() - 1).step_by(7) {
            let why = parse_gmsh("a.msh", &whole[..end]).expect_err(name);
            assert!(why.starts_with("a.msh") && why.contains(": "), "{name}, {end}: {why}");
        }
    }
    assert!(parse_gmsh("a.msh", b"").unwrap_err().contains("empty"));
    let missing = read_gmsh(&path("missing.msh")).unwrap_err();
    assert!(missing.contains("missing.msh: cannot be read"), "{missing}");
    assert!(read_gmsh(&path("")).unwrap_err().contains("no file"));
}

#[test]
fn binary_files_that_are_wrong_are_told_with_their_byte() {
    let whole = bytes("quads4-binary.msh");
    let at = |text: &[u8]| whole.windows(text.len()).position(|own| own == text).unwrap();
    let changed = |at: usize, own: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + own.len()].copy_from_slice(own);
        parse_gmsh("a.msh", &bytes).unwrap_err()
    };
    let one = at(b"4.1 1 8\n") + 8;
    let why = changed(one, &7_i32.to_le_bytes());
    assert!(why.contains("must be 1; it is 7"), "{why}");
    let nodes = at(b"$Nodes\n") + 7;
    let why = changed(nodes + 8, &u64::MAX.to_le_bytes());
    assert!(why.starts_with("a.msh, byte ") && why.contains("18446744073709551615 nodes"), "{why}");
    let why = changed(nodes, &(1_u64 << 60).to_le_bytes());
    assert!(why.contains("blocks of nodes are announced"), "{why}");
    // the first coordinate, behind four sizes and a block of one node
    let why = changed(nodes + 32 + 20 + 8, &f64::NAN.to_le_bytes());
    assert!(why.contains(&format!("byte {}", nodes + 32 + 20 + 16)) && why.contains("NaN"), "{why}");
    for name in ["mixed-2.2-binary.msh", "quads4-2.2-big-endian.msh"] {
        let whole = bytes(name);
        let elements = whole.windows(10).position(|own| own == b"$Elements\n").unwrap() + 10;
        // behind the count in text are the type, the number of elements and that of their tags
        let header = elements + whole[elements..].iter().position(|byte| *byte == b'\n').unwrap() + 1;
        for (at, own, part) in [
            (header, 0x7f7f_7f7f, "elements of type 2139062143 are not known"),
            (header + 4, 0x7f7f_7f7f, "2139062143 elements are announced"),
            (header + 4, -1, "the number of elements of a block must be at least 0; it is -1"),
            (header + 8, 0x7f7f_7f7f, "2139062143 tags are announced"),
        ] {
            let mut wrong = whole.clone();
            wrong[at..at + 4].copy_from_slice(&i32::to_ne_bytes(own));
            let why = parse_gmsh("a.msh", &wrong).unwrap_err();
            assert!(why.starts_with("a.msh, byte ") && why.contains(part), "{name}: {why}");
        }
    }
    // what stands where elements are
    let elements = at(b"$Elements\n") + 10;
    let why = changed(elements + 32 + 8, &2_i32.to_le_bytes());
    assert!(why.contains("point 4") && why.contains("triangles of 3 nodes"), "{why}");
}

#[test]
fn faces_that_do_not_fit_are_told_with_their_numbers_and_lines() {
    let build = |data: MeshData| {
        let mut m = MechanismBuilder::<f64>::default();
        let material = Material { young: 1.0, poisson: 0.0, density: 1.0 };
        m.shell("plate", FreeMesh::of_data(&std::sync::Arc::new(data)), &material, 1.0);
        m.finish().map(|_| ()).unwrap_err().to_string()
    };
    let mut turned = read("quads9.msh");
    turned.reverse([4]);
    let why = build(turned);
    let line =
        1 + String::from_utf8(bytes("quads9.msh")).unwrap().lines().position(|own| own.starts_with("16 7 2 3 38 ")).unwrap();
    assert!(why.contains(&format!("element 16 ({}:{line})", path("quads9.msh").display())), "{why}");
    assert!(why.contains("reverse one of them"), "{why}");
    let mut folded = read("quads8.msh");
    folded.faces[0].swap(0, 1);
    assert!(build(folded).contains("element 12 ("), "{line}");
}

/// Numbers scattered evenly, the same in every run.
struct Scatter(u64);

impl Scatter {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

#[test]
fn whatever_is_changed_in_a_file_it_is_read_or_refused() {
    // a longer run: GMSH_MUTATIONS=10000000
    let count: usize = std::env::var("GMSH_MUTATIONS").ok().and_then(|own| own.parse().ok()).unwrap_or(40_000);
    let mut files: Vec<Vec<u8>> = all_files().iter().map(|name| bytes(name)).collect();
    files.push(SQUARE.as_bytes().to_vec());
    const PIECES: &[&[u8]] = &[
        b"",
        b" ",
        b"\n",
        b"\r\n",
        b"$",
        b"$Nodes\n",
        b"$EndNodes\n",
        b"$Elements\n",
        b"$EndElements\n",
        b"$MeshFormat\n4.1 0 8\n",
        b"4.1 1 8\n",
        b"4 0 8\n",
        b"2.2 0 8\n",
        b"2.2 1 8\n\x01\0\0\0",
        b"-1",
        b"0",
        b"1",
        b"2",
        b"99999999999999999999",
        b"18446744073709551615",
        b"9223372036854775808",
        b"2147483648",
        b"-2147483648",
        b"nan",
        b"1e999",
        b"\"",
        b"\0\0\0\0",
        b"\xff\xff\xff\xff\xff\xff\xff\xff",
        b"\xc3",
        b"$Comments\n",
    ];
    let (mut scatter, mut good, mut built) = (Scatter(1), 0, 0);
    for _ in 0..count {
        let mut own = files[scatter.below(files.len())].clone();
        for _ in 0..=scatter.below(3) {
            let from = scatter.below(own.len() + 1);
            let to = (from + scatter.below(12)).min(own.len());
            match scatter.below(6) {
                0 => _ = own.splice(from..to, []),
                1 => _ = own.splice(from..from, PIECES[scatter.below(PIECES.len())].iter().copied()),
                2 => _ = own.splice(from..to, PIECES[scatter.below(PIECES.len())].iter().copied()),
                3 => {
                    let piece = own[from..to].to_vec();
                    _ = own.splice(from..from, piece);
                }
                4 => own.iter_mut().skip(from).take(1).for_each(|byte| *byte ^= 1 << scatter.below(8)),
                _ => own.truncate(from),
            }
        }
        let outcome = std::panic::catch_unwind(|| match parse_gmsh("a.msh", &own) {
            Ok(data) => {
                assert!(data.points.len() == data.point_numbers.len() && data.faces.len() == data.face_places.len());
                let mut m = MechanismBuilder::<f64>::default();
                let material = Material { young: 1.0, poisson: 0.0, density: 1.0 };
                m.shell("plate", FreeMesh::of_data(&std::sync::Arc::new(data)), &material, 1.0);
                (true, m.finish().is_ok())
            }
            Err(why) => {
                assert!(why.starts_with("a.msh") && why.len() < 1000, "{why}");
                (false, false)
            }
        });
        let Ok((is_good, is_built)) = outcome else {
            panic!("this file ends in a panic:\n{}", String::from_utf8_lossy(&own));
        };
        good += usize::from(is_good);
        built += usize::from(is_built);
    }
    println!("{count} files: {good} read, {built} of them shells");
    // neither all nor none: the changes are neither too small nor too large to try the reader
    assert!(good > count / 50 && good < count / 2 && built > 0, "{count} files: {good} read, {built} built");
}
