//! Shells and meshes that look joined: joined they are, or refused with the place.

use costate::elements::flexible::{FaceKind, Material};
use costate::prelude::*;
use costate::scenes::{Edge, FreeMesh};

const THICKNESS: f64 = 0.01;
const STEEL: Material<f64> = Material { young: 210e9, poisson: 0.3, density: 7850.0 };

fn at(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// A plate of 0.4 x 0.2 m from the origin, and what becomes of another one that is to be joined to it.
fn joined_to_a_plate(second: ShellMesh<f64>, kind: FaceKind) -> Result<usize, String> {
    let mut m = MechanismBuilder::default();
    let first = ShellMesh::plate(at(0.0, 0.0, 0.0), [at(0.4, 0.0, 0.0), at(0.0, 0.2, 0.0)], [2, 2]).with_faces(kind);
    let first = m.shell("first", first, &STEEL, THICKNESS);
    let second = m.joined(second, &[&first]);
    m.shell("second", second, &STEEL, THICKNESS);
    m.finish().map(|mechanism| mechanism.model.nodes.len())
}

fn beside(gap: f64, elements: [usize; 2]) -> ShellMesh<f64> {
    ShellMesh::plate(at(0.4 + gap, 0.0, 0.0), [at(0.3, 0.0, 0.0), at(0.0, 0.2, 0.0)], elements)
}

#[test]
fn shells_join_within_a_millionth_of_their_size_or_are_refused_with_place_and_distance() {
    // 25 nodes each, 5 in common
    for gap in [0.0, 1e-12, 1e-9, -1e-9, 1e-7] {
        assert_eq!(joined_to_a_plate(beside(gap, [2, 2]), FaceKind::Quad9), Ok(45), "{gap:e}");
    }
    for gap in [1e-6, 1e-5, 1e-3, 0.1, -1e-3] {
        let why = joined_to_a_plate(beside(gap, [2, 2]), FaceKind::Quad9).expect_err("refused");
        let distance = format!("{:.3e} m apart", f64::abs(gap));
        assert!(why.contains("\"second\" is to be joined to \"first\"") || gap < 0.0, "{gap:e}: {why}");
        assert!(why.contains(&distance) || gap < 0.0, "{gap:e}: {why}");
    }
    // one that is turned a little about the corner it has in common
    let turned = beside(0.0, [2, 2]).moved(|point, _, _| at(point.x + 1e-3 * point.y, point.y, point.z));
    let why = joined_to_a_plate(turned, FaceKind::Quad9).expect_err("refused");
    assert!(why.contains("lie along each other with other nodes"), "{why}");
}

#[test]
fn edges_with_other_divisions_are_refused_with_their_place() {
    for elements in [[2, 1], [2, 3], [2, 4], [1, 5]] {
        let why = joined_to_a_plate(beside(0.0, elements), FaceKind::Quad9).expect_err("refused");
        assert!(why.contains("\"second\" is joined to \"first\", but at (0.4, "), "{elements:?}: {why}");
    }
    // the same nodes, but lines where the other has parabolas, and the other way round
    for (own, other) in [(FaceKind::Quad4, FaceKind::Quad9), (FaceKind::Quad9, FaceKind::Quad4)] {
        let why = joined_to_a_plate(beside(0.0, [2, 2]).with_faces(own), other).expect_err("refused");
        assert!(why.contains("lie along each other with other nodes"), "{why}");
    }
    // of one length, and shorter: nodes of the longer edge hang
    let short = ShellMesh::plate(at(0.4, 0.0, 0.0), [at(0.3, 0.0, 0.0), at(0.0, 0.15, 0.0)], [2, 2]);
    let why = joined_to_a_plate(short, FaceKind::Quad9).expect_err("refused");
    assert!(why.contains("lie along each other with other nodes"), "{why}");
    for kind in FaceKind::ALL {
        assert_eq!(joined_to_a_plate(beside(0.0, [3, 2]).with_faces(kind), kind), Ok(25 + 35 - 5), "{kind:?}");
    }
}

#[test]
fn a_web_stands_on_any_line_of_nodes_of_a_flange_and_between_two() {
    // along the middles of its faces of nine nodes, and along their edges; not along a diagonal
    let web =
        |from: Vector3<f64>, along: Vector3<f64>, elements| ShellMesh::plate(from, [along, at(0.0, 0.0, 0.3)], elements);
    for y in [0.0, 0.05, 0.1, 0.15] {
        assert_eq!(joined_to_a_plate(web(at(0.0, y, 0.0), at(0.4, 0.0, 0.0), [2, 1]), FaceKind::Quad9), Ok(25 + 15 - 5));
    }
    let why = joined_to_a_plate(web(at(0.0, 0.0, 0.0), at(0.4, 0.2, 0.0), [2, 1]), FaceKind::Quad9).expect_err("refused");
    assert!(why.contains("\"second\" is joined to \"first\", but at ("), "{why}");
    let why = joined_to_a_plate(web(at(0.0, 0.03, 0.0), at(0.4, 0.0, 0.0), [2, 1]), FaceKind::Quad9).expect_err("refused");
    assert!(why.contains("\"second\""), "{why}");
    let mut m = MechanismBuilder::default();
    let flange = |z: f64| ShellMesh::plate(at(0.0, 0.0, z), [at(0.4, 0.0, 0.0), at(0.0, 0.2, 0.0)], [2, 2]);
    let lower = m.shell("lower", flange(0.0), &STEEL, THICKNESS);
    let upper = m.shell("upper", flange(0.3), &STEEL, THICKNESS);
    let web = m.joined(web(at(0.0, 0.1, 0.0), at(0.4, 0.0, 0.0), [2, 1]), &[&lower, &upper]);
    m.shell("web", web, &STEEL, THICKNESS);
    assert_eq!(m.finish().expect("sound").model.nodes.len(), 25 + 25 + 5);
}

#[test]
fn coarse_and_fine_edges_along_a_circle_are_refused() {
    let tube = |z: f64, elements: [usize; 2], kind: FaceKind| {
        let line = [at(0.1, 0.0, z), at(0.0, 0.0, 0.2)];
        ShellMesh::cylinder(line, [at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.0)], std::f64::consts::PI, elements).with_faces(kind)
    };
    for kind in [FaceKind::Quad9, FaceKind::Quad4] {
        for (around, refused) in [(8, false), (4, true), (16, true), (12, true)] {
            let mut m = MechanismBuilder::default();
            let first = m.shell("first", tube(0.0, [8, 1], kind), &STEEL, THICKNESS);
            let second = m.joined(tube(0.2, [around, 1], kind), &[&first]);
            m.shell("second", second, &STEEL, THICKNESS);
            let why = m.finish().err();
            assert_eq!(why.is_some(), refused, "{kind:?}, {around} around: {why:?}");
        }
    }
}

/// What is said of a mesh of points and faces in the plane.
fn told(points: &[[f64; 2]], faces: &[&[usize]]) -> Option<String> {
    let mut m = MechanismBuilder::default();
    let points = points.iter().map(|&[x, y]| at(x, y, 0.0)).collect();
    m.shell("sheet", FreeMesh::new(points, faces), &STEEL, THICKNESS);
    m.finish().err()
}

#[test]
fn meshes_with_hanging_nodes_are_refused() {
    // a large face beside 2, 3 or 4 small ones
    for parts in [2, 3, 4] {
        let mut points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut faces: Vec<Vec<usize>> = vec![vec![0, 1, 2, 3]];
        let mut column = vec![1];
        for part in 1..parts {
            column.push(points.len());
            points.push([1.0, f64::from(part) / f64::from(parts)]);
        }
        column.push(2);
        let first = points.len();
        points.extend((0..=parts).map(|part| [1.5, f64::from(part) / f64::from(parts)]));
        for part in 0..parts as usize {
            faces.push(vec![column[part], first + part, first + part + 1, column[part + 1]]);
        }
        let faces: Vec<&[usize]> = faces.iter().map(Vec::as_slice).collect();
        let why = told(&points, &faces).expect("refused");
        assert!(why.contains("\"sheet\": point ") && why.contains("lies on element 0"), "{parts}: {why}");
    }
    // a small face on the side of a large one, without a point in common
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.3], [1.5, 0.3], [1.5, 0.6], [1.0, 0.6]];
    let why = told(&points, &[&[0, 1, 2, 3], &[4, 5, 6, 7]]).expect("refused");
    assert!(why.contains("point 4 at (1, 0.3, 0) m lies on element 0"), "{why}");
    // faces apart are two parts; points at one place are told, unless they may be there
    let apart = |gap: f64| points.map(|[x, y]| if y == 0.3 || y == 0.6 { [x + gap, y] } else { [x, y] });
    assert_eq!(told(&apart(1e-3), &[&[0, 1, 2, 3], &[4, 5, 6, 7]]), None);
    let crack = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]];
    let why = told(&crack, &[&[0, 1, 2, 3], &[4, 5, 6, 7]]).expect("refused");
    assert!(why.contains("points 1 and 4 stand at the same place, (1, 0, 0) m"), "{why}");
    let mut m = MechanismBuilder::default();
    let open = FreeMesh::new(crack.map(|[x, y]| at(x, y, 0.0)).to_vec(), [[0, 1, 2, 3], [4, 5, 6, 7]]);
    m.shell("sheet", open.with_coincident_points(), &STEEL, THICKNESS);
    assert!(m.finish().is_ok());
    // a tube that is not closed is open along a line
    let line = [at(0.1, 0.0, 0.0), at(0.0, 0.0, 0.2)];
    let tube = || ShellMesh::cylinder(line, [at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.0)], std::f64::consts::TAU, [8, 1]);
    for (mesh, refused) in [(tube(), true), (tube().closed(), false), (tube().with_coincident_points(), false)] {
        let mut m = MechanismBuilder::default();
        m.shell("tube", mesh, &STEEL, THICKNESS);
        assert_eq!(m.finish().is_err(), refused);
    }
}

#[test]
fn faces_that_stand_twice_are_refused() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]];
    for twice in [[1, 4, 5, 2], [4, 5, 2, 1], [2, 5, 4, 1], [1, 2, 5, 4]] {
        let why = told(&square, &[&[0, 1, 2, 3], &[1, 4, 5, 2], &twice]).expect("refused");
        assert!(why.contains("element 1 and element 2 have the same points"), "{twice:?}: {why}");
    }
    // one upon two others
    let why = told(&square, &[&[0, 1, 2, 3], &[1, 4, 5, 2], &[0, 4, 5, 3]]).expect("refused");
    assert!(why.contains("lie on each other") || why.contains("lies on element"), "{why}");
    assert_eq!(told(&square, &[&[0, 1, 2, 3], &[1, 4, 5, 2]]), None);
}

#[test]
fn what_a_mesh_is_given_and_does_not_take_is_an_error() {
    let mut m = MechanismBuilder::default();
    let plate = m.shell(
        "plate",
        ShellMesh::plate(at(0.0, 0.0, 0.0), [at(0.4, 0.0, 0.0), at(0.0, 0.2, 0.0)], [2, 1]),
        &STEEL,
        THICKNESS,
    );
    let nodes = plate.edge(Edge::FirstEnd);
    m.shell("few", beside(0.0, [1, 2]).with_edge(Edge::FirstStart, &nodes), &STEEL, THICKNESS);
    let clamped = m.joined(beside(0.0, [1, 1]), &[&plate]).clamped(Edge::SecondStart);
    m.shell("held", clamped, &STEEL, THICKNESS);
    let twice = beside(0.0, [1, 1]).with_node(0, 0, nodes[0]).with_node(0, 0, nodes[1]);
    m.shell("twice", twice, &STEEL, THICKNESS);
    let why = m.finish().err().expect("refused");
    for part in [
        "\"few\" has 5 nodes on an edge that is given 3",
        "\"held\" is clamped at its node [0,0], which is the node \"plate[4,0]\" that moves",
        "\"twice\" is given two nodes for its node [0,0]",
    ] {
        assert!(why.contains(part), "{part}: {why}");
    }
}
