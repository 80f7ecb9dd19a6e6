//! Shells of four, six and nine nodes on meshes that users bring: the same physics as on grids, names, closed forms, and mistakes in words.

use super::assert_close;
use costate::elements::flexible::{FaceKind, Laminate, Material, Ply, PlyStrength, ShellSection};
use costate::elements::forces::LoadFrame;
use costate::functionals::{Aggregate, AggregateKind, Times};
use costate::prelude::*;
use costate::scenes::{AnyScene, Edge, FreeMesh, NodeId, ShellMesh, ShellPart};
use std::f64::consts::PI;

const THICKNESS: f64 = 0.01;
const STEEL: Material<f64> = Material { young: 210e9, poisson: 0.3, density: 7850.0 };

fn material<S: Scalar>(young: f64, poisson: f64) -> Material<S> {
    Material { young: S::from(young), poisson: S::from(poisson), density: S::from(1200.0) }
}

/// Faces on the points of a grid, i + (2 first + 1) j, in the order of Gmsh; `kind` says which stand in a cell.
fn faces([first, second]: [usize; 2], kind: impl Fn(usize, usize) -> FaceKind) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    for (c, r) in (0..second).flat_map(|r| (0..first).map(move |c| (c, r))) {
        let at = |a: usize, b: usize| 2 * c + a + (2 * first + 1) * (2 * r + b);
        match kind(c, r) {
            FaceKind::Quad9 => {
                all.push(vec![at(0, 0), at(2, 0), at(2, 2), at(0, 2), at(1, 0), at(2, 1), at(1, 2), at(0, 1), at(1, 1)])
            }
            FaceKind::Quad4 => all.extend(
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| vec![at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)]),
            ),
            FaceKind::Triangle6 => all.extend([
                vec![at(0, 0), at(2, 0), at(2, 2), at(1, 0), at(2, 1), at(1, 1)],
                vec![at(0, 0), at(2, 2), at(0, 2), at(1, 1), at(1, 2), at(0, 1)],
            ]),
        }
    }
    all
}

/// Quadrilaterals of nine nodes and triangles beside each other.
fn mixed(c: usize, r: usize) -> FaceKind {
    if (c + r).is_multiple_of(2) { FaceKind::Quad9 } else { FaceKind::Triangle6 }
}

/// Points of a grid for shares (u, v).
fn points<S: Scalar>([first, second]: [usize; 2], at: impl Fn(f64, f64) -> [f64; 3]) -> Vec<Vector3<S>> {
    let share = |place: usize, count: usize| place as f64 / (2 * count) as f64;
    let places = (0..=2 * second).flat_map(|j| (0..=2 * first).map(move |i| (i, j)));
    places.map(|(i, j)| Vector3::from_f64(at(share(i, first), share(j, second)))).collect()
}

/// A rectangle in the plane of x and y.
fn rectangle<S: Scalar>(sizes: [f64; 2], counts: [usize; 2], kind: impl Fn(usize, usize) -> FaceKind) -> FreeMesh<S> {
    FreeMesh::new(points(counts, |u, v| [sizes[0] * u, sizes[1] * v, 0.0]), faces(counts, kind))
}

/// A part of a cylinder about y, normals outwards, and its normals.
fn curved<S: Scalar>(counts: [usize; 2]) -> [Vec<Vector3<S>>; 2] {
    let radial = |u: f64| [(0.8 * u).sin(), 0.0, (0.8 * u).cos()];
    [points(counts, |u, v| [0.5 * radial(u)[0], 0.3 * v, 0.5 * radial(u)[2]]), points(counts, |u, _| radial(u))]
}

/// Kinetic and potential energy of all elements, and their mass.
fn energies(m: &MechanismBuilder<f64>, v: &[f64], q: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for element in &m.model.elements {
        let of = |x: &[f64]| -> Vec<f64> {
            element.nodes.iter().flat_map(|&node| x[m.model.node(node).dofs.clone()].to_vec()).collect()
        };
        let own = element.physics.energies_at(&of(v), &of(q), &m.numbers.p[element.parameters.clone()]);
        sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    }
    sums
}

/// Coordinates with every node moved.
fn moved(m: &MechanismBuilder<f64>, to: impl Fn(Vector3<f64>) -> (Vector3<f64>, Quaternion<f64>)) -> Vec<f64> {
    let node = |q: &[f64]| {
        let (place, turn) = to(Vector3::first_three(q));
        place.iter().copied().chain(turn.times(Quaternion::from_slice(&q[3..])).0).collect::<Vec<f64>>()
    };
    m.numbers.q.chunks_exact(7).flat_map(node).collect()
}

/// Bent, sheared, stretched and twisted.
fn deformed(x: Vector3<f64>) -> (Vector3<f64>, Quaternion<f64>) {
    let turn = Quaternion::about(Vector3::new(0.6, 0.0, 0.8), 0.3 * x[1] - 0.2 * x[0]);
    (turn.rotate(x) + Vector3::new(0.02 * x[0] * x[1], 0.01 * x[2], 0.03 * x[0] * x[0]), turn)
}

#[test]
fn a_free_mesh_is_the_grid_on_the_same_points() {
    let counts = [3, 2];
    for kind in FaceKind::ALL {
        let [points, normals] = curved(counts);
        let grid = ShellMesh::cylinder(
            [Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.0, 0.3, 0.0)],
            [Vector3::zeros(), Vector3::new(0.0, 1.0, 0.0)],
            0.8,
            counts,
        );
        let mut on_grid = MechanismBuilder::default();
        on_grid.shell("shell", grid.with_faces(kind), &STEEL, THICKNESS);
        let mut free = MechanismBuilder::default();
        let mesh = FreeMesh::new(points.clone(), faces(counts, |_, _| kind));
        free.shell("shell", mesh.clone().with_normals(normals.clone()), &STEEL, THICKNESS);
        let gravity = Vector3::new(1.0, -2.0, 3.0);
        on_grid.gravity(gravity);
        free.gravity(gravity);
        let [on_grid, free] = [on_grid, free].map(|m| m.finish().expect("sound"));
        assert_eq!(free.model.nodes.len(), 7 * 5, "{kind:?}");
        let q = moved(&on_grid, deformed);
        let v: Vec<f64> = (0..q.len()).map(|i| (1.7 * f64::from(i as u32)).sin()).collect();
        for (own, expected) in energies(&free, &v, &q).into_iter().zip(energies(&on_grid, &v, &q)) {
            assert_close(&format!("{kind:?}"), own, expected, 1e-13);
        }
        // normals that are averaged are those of the surface, but where it ends: there of the faces
        let directors = |m: &MechanismBuilder<f64>| -> Vec<Vector3<f64>> {
            let nodes = m.model.elements.iter().flat_map(|element| {
                let count = element.nodes.len();
                m.numbers.p[element.parameters.clone()].chunks_exact(6).take(count).collect::<Vec<_>>()
            });
            nodes.map(|node| Vector3::first_three(&node[3..])).collect()
        };
        let mut averaged = MechanismBuilder::default();
        averaged.shell("shell", mesh, &STEEL, THICKNESS);
        let averaged = averaged.finish().expect("sound");
        let apart = directors(&averaged).into_iter().zip(directors(&free)).map(|(a, b)| (a - b).length());
        // half the angle of a flat face at the ends of an arc of 0.8
        let limit = if kind == FaceKind::Quad4 { 0.51 * 0.8 / 6.0 } else { 6e-3 };
        assert!(apart.fold(0.0, f64::max) < limit, "{kind:?}");
    }
}

/// One element, curved and distorted, without load.
struct Single(FaceKind);

impl Scene for Single {
    fn name(&self) -> String {
        "single".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |u: f64, v: f64| [u + 0.2 * v * v, 0.9 * v + 0.15 * u * v, 0.1 * u * u - 0.12 * v * v + 0.1 * u * v];
        let mut faces = faces([1, 1], |_, _| self.0);
        faces.truncate(1);
        let points = match self.0 {
            FaceKind::Quad4 => points([1, 1], |u, v| at(2.0 * u, 2.0 * v)),
            _ => points([1, 1], at),
        };
        m.shell("shell", FreeMesh::new(points, faces), &material(1e6, 0.3), S::from(0.1));
        Ok(())
    }
}

#[test]
fn a_single_element_has_six_modes_without_energy() {
    for kind in FaceKind::ALL {
        let scene = Single(kind);
        let prepared = Prepared::new(&scene).expect("sound");
        let unknowns = 6 * kind.shape().nodes;
        let modes = prepared.modes(unknowns).expect("modes");
        let frequencies: Vec<f64> = modes.iter().map(|mode| mode.frequency).collect();
        assert_eq!(frequencies.len(), unknowns);
        let (rigid, elastic) = frequencies.split_at(6);
        assert!(rigid[5] < 1e-4 * elastic[0] && elastic[0] > 1.0, "{kind:?}: {frequencies:?}");
    }
}

#[test]
fn rigid_motions_leave_the_energy_of_a_deformed_mixed_mesh() {
    let counts = [3, 2];
    let mut m = MechanismBuilder::default();
    let [points, _] = curved(counts);
    m.shell("shell", FreeMesh::new(points, faces(counts, mixed)), &STEEL, THICKNESS);
    let m = m.finish().expect("sound");
    let still = vec![0.0; m.numbers.q.len()];
    let [_, energy, _] = energies(&m, &still, &moved(&m, deformed));
    for number in 0..100 {
        let random = |k: i32| (12.9898 * f64::from(7 * number + k)).sin();
        let turn = Quaternion::about(Vector3::new(random(1), random(2), random(3)).unit(), 3.0 * random(4));
        let shift = Vector3::new(random(5), random(6), random(0));
        let q = moved(&m, |x| {
            let (place, own) = deformed(x);
            (turn.rotate(place) + shift, turn.times(own))
        });
        let [_, own, _] = energies(&m, &still, &q);
        assert_close("energy", own, energy, 1e-12);
    }
}

#[test]
fn groups_sets_and_weights_are_those_of_the_mesh() {
    let counts = [2, 1];
    let mut m = MechanismBuilder::default();
    // a point that belongs to no face makes no node
    let mut places = points::<f64>(counts, |u, v| [0.4 * u, 0.2 * v, 0.0]);
    places.insert(0, Vector3::new(9.0, 9.0, 9.0));
    let list: Vec<Vec<usize>> =
        faces(counts, mixed).into_iter().map(|face| face.iter().map(|point| point + 1).collect()).collect();
    let mesh = FreeMesh::new(places, list).group("triangles", [1, 2]).node_set("root", [1, 6, 11]).clamped([1, 6, 11]);
    let shell = m.tapered_shell("shell", mesh, &STEEL, |element, point| {
        assert!(point > 0);
        if element == 0 { THICKNESS } else { 2.0 * THICKNESS }
    });
    m.group_mass_functional("mass", Over::Terminal, &shell.group_named("triangles").expect("it has the name"));
    let (root, none) = (shell.node_set("root").expect("it has the name"), shell.node_set("tip").expect_err("no such set"));
    assert_eq!(none, "\"shell\" has no node set \"tip\"; there are: \"root\"");
    assert_eq!((shell.node(0), shell.node(1), shell.nodes.len(), shell.elements.len()), (None, Some(root[0]), 15, 3));
    let m = m.finish().expect("sound");
    assert!(root.iter().all(|&node| m.model.node(node).fixed));
    assert_eq!(m.model.nodes[0].name, "shell[1]");
    assert_eq!(m.model.elements[2].name, "shell, element 2");
    let still = vec![0.0; m.numbers.q.len()];
    let [_, _, mass] = energies(&m, &still, &m.numbers.q);
    assert_close("mass", mass, 7850.0 * 0.2 * 0.2 * THICKNESS * 3.0, 1e-12);
}

#[test]
fn quadrilaterals_of_eight_points_get_a_middle() {
    let own = |take: usize| {
        let mut m = MechanismBuilder::default();
        let list = faces([2, 1], |_, _| FaceKind::Quad9).into_iter().map(|face| face[..take].to_vec());
        let at = |u: f64, v: f64| [u + 0.1 * v, 0.7 * v + 0.1 * u * u, 0.2 * u * v];
        m.shell("shell", FreeMesh::new(points([2, 1], at), list), &STEEL, THICKNESS);
        let m = m.finish().expect("sound");
        let still = vec![0.0; m.numbers.q.len()];
        (m.model.nodes.len(), energies(&m, &still, &moved(&m, deformed))[1])
    };
    let ((nine, expected), (eight, energy)) = (own(9), own(8));
    assert_eq!((nine, eight), (15, 15));
    assert_close("energy", energy, expected, 1e-12);
}

#[test]
fn walls_that_meet_at_an_angle_keep_their_own_directors() {
    // a strip of two squares, folded along y
    let fold = |u: f64, v: f64| if u < 0.5 { [u, v, 0.0] } else { [0.5, v, u - 0.5] };
    let mesh = |angle: f64| FreeMesh::new(points([2, 1], fold), faces([2, 1], |_, _| FaceKind::Quad9)).creased(angle);
    let directors = |angle: f64| -> Vec<[f64; 3]> {
        let mut m = MechanismBuilder::default();
        m.shell("shell", mesh(angle), &STEEL, THICKNESS);
        let m = m.finish().expect("sound");
        let [first, second] =
            [0, 1].map(|element: usize| m.numbers.p[m.model.elements[element].parameters.clone()].to_vec());
        // at the end of the first element and at the start of the second
        [&first[6 * 2..], &second[..]].map(|node| [node[3], node[4], node[5]]).to_vec()
    };
    assert_eq!(directors(PI / 4.0), [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for director in directors(0.6 * PI) {
        assert!((0..3).all(|k| (director[k] - [-half, 0.0, half][k]).abs() < 1e-14), "{director:?}");
    }
}

/// The faces of an icosahedron's kind of sphere: an octahedron whose triangles are divided and blown up.
fn sphere(radius: f64, divisions: usize) -> FreeMesh<f64> {
    let corners = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    let octahedron = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    // places in units of an edge by 2 divisions
    let (mut points, mut list): (Vec<[i64; 3]>, Vec<Vec<usize>>) = (Vec::new(), Vec::new());
    let count = 2 * divisions as i64;
    for triangle in octahedron {
        let mut at = |a: i64, b: i64| {
            let weights = [count - a - b, a, b];
            let place: [i64; 3] = std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[triangle[c]][k]).sum());
            points.iter().position(|own| *own == place).unwrap_or_else(|| {
                points.push(place);
                points.len() - 1
            })
        };
        for a in (0..count).step_by(2) {
            for b in (0..count - a).step_by(2) {
                list.push([(0, 0), (2, 0), (0, 2), (1, 0), (1, 1), (0, 1)].map(|(i, j)| at(a + i, b + j)).to_vec());
                if a + b + 4 <= count {
                    list.push([(2, 0), (2, 2), (0, 2), (2, 1), (1, 2), (1, 1)].map(|(i, j)| at(a + i, b + j)).to_vec());
                }
            }
        }
    }
    let blown = points.iter().map(|&place| Vector3::from_f64(place.map(|x| x as f64)).unit() * radius);
    FreeMesh::new(blown.collect(), list)
}

#[test]
fn pressure_in_a_closed_sphere_of_triangles_has_no_resultant_and_presses_outwards() {
    let mut m = MechanismBuilder::default();
    let shell = m.shell("sphere", sphere(0.5, 3), &STEEL, THICKNESS);
    assert_eq!((shell.elements.len(), shell.nodes.len()), (72, 146));
    m.pressure("pressure", &shell, LoadFrame::Body, Signal::Constant(7.0));
    let m = m.finish().expect("sound");
    let q = moved(&m, deformed);
    let (mut total, mut work) = (Vector3::zeros(), 0.0);
    for element in m.model.elements.iter().filter(|element| element.name.starts_with("pressure")) {
        let own: Vec<f64> = element.nodes.iter().flat_map(|&node| q[m.model.node(node).dofs.clone()].to_vec()).collect();
        let zeros = vec![0.0; own.len()];
        let s = State { a: &zeros, v: &zeros, q: &own };
        let r = element.physics.residual_at(s, &m.numbers.p[element.parameters.clone()], 0.0);
        for (node, r) in own.chunks_exact(7).zip(r.chunks_exact(7)) {
            total -= Vector3::first_three(r);
            work -= Vector3::first_three(r).dot(&Vector3::first_three(node));
        }
    }
    assert!(total.length() < 1e-12 * work.abs(), "{total:?}");
    // force times place: three volumes times the pressure; the deformation changes the volume by some 1 %
    assert_close("volume", work / 21.0, 4.0 / 3.0 * PI * 0.125, 0.02);
}

#[test]
fn stresses_are_those_of_the_surface_for_each_kind() {
    for kind in FaceKind::ALL {
        let mut m = MechanismBuilder::default();
        let shell = m.shell("shell", rectangle([0.4, 0.2], [2, 1], |_, _| kind), &STEEL, THICKNESS);
        let over = Aggregate::new(AggregateKind::Power, 400.0).at(Times::End);
        m.von_mises_functional("yield", over, &shell.group(), 300e6);
        let m = m.finish().expect("sound");
        let surfaces = m.surfaces();
        assert_eq!(surfaces.len(), shell.elements.len());
        let q = moved(&m, |x| (Vector3::new(1.001 * x[0], x[1], x[2]), Quaternion::identity()));
        let along: f64 = 210e9 / (1.0 - 0.09) * (1e-3 + 0.5e-6);
        let expected = along * (1.0 - 0.3 + 0.09_f64).sqrt();
        for surface in &surfaces {
            let stresses = surface.stresses(&q, &m.numbers.p).expect("one material");
            assert_eq!(stresses.len(), kind.shape().gauss.len());
            stresses.into_iter().for_each(|stress| assert_close(&format!("{kind:?}"), stress, expected, 1e-9));
            assert_close("thickness", surface.thickness(&m.numbers.p).expect("one material"), THICKNESS, 1e-14);
        }
        let [_, _, mass] = energies(&m, &vec![0.0; q.len()], &q);
        assert_close("mass", mass, 7850.0 * 0.08 * THICKNESS, 1e-12);
    }
}

/// A square of distorted elements of both kinds with straight edges, whose outer nodes are moved as a field of constant strain moves them.
struct Patch {
    /// A field of curvatures of this size, or a finite deformation of the plane.
    curvature: Option<f64>,
}

impl Patch {
    /// Where node (i, j) stands.
    fn place([i, j]: [usize; 2]) -> [f64; 2] {
        const CORNERS: [[[f64; 2]; 3]; 3] = [
            [[0.0, 0.0], [0.58, 0.0], [1.0, 0.0]],
            [[0.0, 0.43], [0.41, 0.57], [1.0, 0.61]],
            [[0.0, 1.0], [0.38, 1.0], [1.0, 1.0]],
        ];
        let ([low_i, high_i], [low_j, high_j]) = ([i / 2, i.div_ceil(2)], [j / 2, j.div_ceil(2)]);
        // inside of two triangles on the edge between them
        let ends = if i % 2 == 1 && j % 2 == 1 && mixed(i / 2, j / 2) == FaceKind::Triangle6 {
            vec![CORNERS[low_j][low_i], CORNERS[high_j][high_i]]
        } else {
            vec![CORNERS[low_j][low_i], CORNERS[low_j][high_i], CORNERS[high_j][low_i], CORNERS[high_j][high_i]]
        };
        [0, 1].map(|k| ends.iter().map(|end| end[k]).sum::<f64>() / ends.len() as f64)
    }
    /// Position and director that the field gives to a place.
    fn field(&self, [x, y]: [f64; 2]) -> ([f64; 3], Quaternion<f64>) {
        let Some(size) = self.curvature else {
            let f = [[1.05, 0.02], [-0.03, 0.97]];
            let turn = f64::atan2(f[1][0] - f[0][1], f[0][0] + f[1][1]);
            let at = [f[0][0] * x + f[0][1] * y, f[1][0] * x + f[1][1] * y, 0.0];
            return (at, Quaternion::about(Vector3::new(0.0, 0.0, 1.0), turn));
        };
        let (w, slopes) = (size * (0.5 * x * x - 0.35 * y * y + 0.4 * x * y), [x + 0.4 * y, 0.4 * x - 0.7 * y]);
        let axis = Vector3::new(size * slopes[1], -size * slopes[0], 0.0);
        let angle = axis.length();
        let turn = if angle > 0.0 { Quaternion::about(axis * angle.recip(), angle) } else { Quaternion::identity() };
        ([x, y, w], turn)
    }
}

impl Scene for Patch {
    fn name(&self) -> String {
        "patch".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let places = (0..25).map(|point| Patch::place([point % 5, point / 5]));
        let points = places.map(|[x, y]| Vector3::from_f64([x, y, 0.0])).collect();
        let at_rim = |point: usize| [point % 5, point / 5].iter().any(|place| [0, 4].contains(place));
        let mesh = FreeMesh::new(points, faces([2, 2], mixed)).clamped((0..25).filter(|&point| at_rim(point)));
        let shell = m.shell("patch", mesh, &material(1e3, 0.3), S::from(0.01));
        for point in (0..25).filter(|&point| at_rim(point)) {
            let (x, turn) = self.field(Patch::place([point % 5, point / 5]));
            let first = m.model.node(shell.node(point).ok_or("a node")?).dofs.start;
            x.into_iter().chain(turn.0).enumerate().for_each(|(k, own)| m.numbers.q[first + k] = S::from(own));
        }
        Ok(())
    }
}

#[test]
fn patches_of_both_kinds_find_constant_strains() {
    for curvature in [None, Some(1e-7)] {
        let patch = Patch { curvature };
        let prepared = Prepared::new(&patch).expect("sound");
        let q = prepared.equilibrium().expect("an equilibrium").q;
        let (size, places) = curvature.map_or((1.0, 0..3), |size| (size, 2..3));
        for (point, own) in q.chunks_exact(7).enumerate() {
            let (x, turn) = patch.field(Patch::place([point % 5, point / 5]));
            let directors = [Quaternion::from_slice(&own[3..]), turn].map(|e| e.columns()[2]);
            for k in places.clone() {
                assert!((own[k] - x[k]).abs() < 1e-9 * size, "{curvature:?}, point {point}: {own:?} {x:?}");
            }
            let apart = directors[0] - directors[1];
            assert!(apart[0].hypot(apart[1]) < 1e-9 * size, "{curvature:?}, point {point}: {apart:?}");
        }
    }
}

/// A strip of a mixed mesh in a wall, its end in a rigid body.
struct Strip {
    counts: [usize; 2],
    kind: Option<FaceKind>,
    out_of_plane: bool,
}

/// So small that linear theory holds \[N\].
const FORCE: f64 = 1e-5;

impl Scene for Strip {
    fn name(&self) -> String {
        "strip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [first, second] = self.counts;
        let width = 2 * first + 1;
        let mesh = rectangle([1.0, 0.1], self.counts, |c, r| self.kind.unwrap_or(mixed(c, r)));
        let mesh = mesh.clamped((0..=2 * second).map(|j| j * width));
        let mesh = mesh.node_set("tip", (0..=2 * second).map(|j| j * width + 2 * first));
        let shell = m.shell("strip", mesh, &material(1e6, 0.0), S::from(0.01));
        let tip: Vec<NodeId> = shell.node_set("tip")?;
        m.rigid_interface("end", tip[second], &tip);
        let axis = if self.out_of_plane { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let (frame, size, on) = (LoadFrame::World, TimeFunction::ConstantRate, NodeKind::Body);
        let p: Vec<S> = [axis, [0.0; 3]].concat().into_iter().chain([0.0, FORCE]).map(S::from).collect();
        m.element("force", &[tip[second]], costate::internals::AppliedForce { on, frame, size }, &p);
        let at = m.position(tip[second]);
        m.position_functional("deflection", Over::Terminal, tip[second], at, Vector3::from_f64(axis));
        Ok(())
    }
}

#[test]
fn strips_on_meshes_bend_as_beams() {
    let deflection = |strip: Strip, force: f64| {
        let prepared = Prepared::new(&strip).expect("sound");
        let place = if strip.out_of_plane { 0.0 } else { 0.05 };
        (prepared.analysis().values(&prepared.x).expect("an equilibrium")[0] - place) / force
    };
    let (young, length, height, width) = (1e6, 1.0_f64, 0.01_f64, 0.1_f64);
    let shear = 6.0 / 5.0 * length / (0.5 * young * height * width);
    let out = length.powi(3) / (3.0 * young * width * height.powi(3) / 12.0) + shear;
    let within = length.powi(3) / (3.0 * young * height * width.powi(3) / 12.0) + shear;
    for kind in [None, Some(FaceKind::Quad4), Some(FaceKind::Triangle6)] {
        let own = |counts, out_of_plane| deflection(Strip { counts, kind, out_of_plane }, FORCE);
        let errors = [[6, 1], [12, 2]].map(|counts| (own(counts, true) / out - 1.0).abs());
        // straight elements of four nodes find the cubic with the square of their length
        let limits = if kind == Some(FaceKind::Quad4) { [4e-3, 0.3 * errors[0]] } else { [1e-3; 2] };
        assert!(errors[0] < limits[0] && errors[1] < limits[1], "{kind:?}: {errors:?}");
        // four nodes: stiffened in their plane by their bilinear functions, less and less
        let limit = if kind == Some(FaceKind::Quad4) { [0.35, 0.12] } else { [0.02, 0.01] };
        for (counts, limit) in [[6, 1], [12, 2]].into_iter().zip(limit) {
            assert_close(&format!("{kind:?}, in its plane, {counts:?}"), own(counts, false), within, limit);
        }
    }
}

/// A swinging shell of a mesh whose thicknesses and one of whose points are variables.
struct Swinging {
    kind: Option<FaceKind>,
    layered: bool,
}

impl Scene for Swinging {
    fn name(&self) -> String {
        "swinging".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let variable = |name: &str, value: f64| DesignVariable::new(name, value, (0.5 * value, 2.0 * value), "m");
        vec![variable("thickness left", 0.012), variable("thickness right", 0.009), variable("place", 0.11)]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.01, 5)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let mesh = rectangle([0.4, 0.2], [2, 1], |c, r| self.kind.unwrap_or(mixed(c, r)));
        // the middle of the mesh moves along y, a corner out of the plane
        let mesh = mesh.moved(|at, point| match point {
            7 => Vector3::new(at[0], x[2], at[2]),
            14 => Vector3::new(at[0], at[1], x[2] * x[2]),
            _ => at,
        });
        let mesh = mesh.clamped([0, 5, 10]).damped(S::from(1e-3)).group("right", [1]);
        let shell = if self.layered {
            let ply = |angle: f64, thickness: S| {
                let material = material(2e9, 0.3);
                Ply { angle: S::from(angle), young: [S::from(2e9), S::from(8e8)], ..Ply::isotropic(&material, thickness) }
            };
            let laminate = Laminate::new(vec![ply(0.4, x[0]), ply(-0.7, x[1])]).offset(x[1] * 0.2);
            let shell = m.laminate_shell("shell", mesh, &laminate, Vector3::from_f64([1.0, 0.2, 0.0]));
            let tension = [20e6, 10e6].map(S::from);
            let strength = PlyStrength { tension, compression: tension, shear: S::from(8e6) };
            m.tsai_wu_functional("failure", Over::smooth_maximum(20.0), &shell.group(), &laminate, &[strength; 2]);
            shell
        } else {
            // by the point, and in the first element by its number
            let shell = m.tapered_shell("shell", mesh, &material(2e9, 0.3), |element, point| {
                let share = S::from(f64::from((point % 5) as u32) / 4.0);
                x[0] + (x[1] - x[0]) * share + if element == 0 { x[0] * 0.1 } else { S::zero() }
            });
            m.von_mises_functional("failure", Over::smooth_maximum(20.0), &shell.group(), S::from(1e6));
            shell
        };
        m.strain_energy_functional("energy", Over::Integral, &shell.group_named("right")?);
        m.gravity(Vector3::from_f64([0.0, 1.0, -9.81]));
        m.pressure("blow", &shell, LoadFrame::Body, Signal::Constant(S::from(300.0)));
        m.pressure("push", &shell, LoadFrame::World, Signal::Constant(S::from(-100.0)));
        let tip = shell.node(9).ok_or("a node")?;
        let at = m.position(tip);
        m.position_functional("tip", Over::Terminal, tip, at, Vector3::from_f64([0.1, 0.2, 1.0]));
        Ok(())
    }
}

#[test]
fn gradients_by_thickness_and_by_places_of_points_agree_with_complex_steps() {
    for kind in [None, Some(FaceKind::Quad4), Some(FaceKind::Triangle6)] {
        for layered in [false, true] {
            let scene = Swinging { kind, layered };
            let prepared = Prepared::new(&scene as &dyn AnyScene).expect("sound");
            let (analysis, x) = (prepared.analysis(), &prepared.x);
            let forward = analysis.forward(x).expect("a motion");
            let [adjoint, complex] = [analysis.adjoint(x, &forward), analysis.complex_step(x, &forward)]
                .map(|gradient| gradient.expect("differentiable").rows);
            assert_eq!(adjoint.len(), 3);
            for (adjoint, complex) in adjoint.iter().zip(&complex) {
                let apart = largest_difference(complex, adjoint);
                assert!(apart < 1e-12, "{kind:?} {layered}: {apart:e}: {adjoint:?} {complex:?}");
                assert!(complex.iter().all(|slope| *slope != 0.0), "{complex:?}");
            }
        }
    }
}

#[test]
fn a_mesh_takes_over_nodes_of_shells_beside_it() {
    let mut m = MechanismBuilder::default();
    let plate = m.shell(
        "plate",
        ShellMesh::plate(Vector3::zeros(), [Vector3::new(0.4, 0.0, 0.0), Vector3::new(0.0, 0.2, 0.0)], [2, 1]),
        &STEEL,
        THICKNESS,
    );
    let wall = FreeMesh::new(points([1, 1], |u, v| [0.4, 0.2 * u, 0.3 * v]), faces([1, 1], |_, _| FaceKind::Triangle6));
    let wall = m.joined(wall, &[&plate]);
    let wall = m.shell("wall", wall, &STEEL, THICKNESS);
    let edge = plate.edge(Edge::FirstEnd);
    assert_eq!([0, 1, 2].map(|point| wall.node(point)), [0, 1, 2].map(|place| Some(edge[place])));
    let m = m.finish().expect("sound");
    assert_eq!(m.model.nodes.len(), 15 + 6);
}

#[test]
fn mistakes_name_the_face_and_say_what_to_do() {
    let refused = |mesh: FreeMesh<f64>| {
        let mut m = MechanismBuilder::default();
        m.shell("wing", mesh, &STEEL, THICKNESS);
        m.finish().err().expect("refused")
    };
    let square = || points::<f64>([2, 1], |u, v| [0.4 * u, 0.2 * v, 0.0]);
    let quads = || faces([2, 1], |_, _| FaceKind::Quad9);
    let mesh = |change: &dyn Fn(&mut Vec<Vec<usize>>)| {
        let mut list = quads();
        change(&mut list);
        refused(FreeMesh::new(square(), list))
    };
    let linear = mesh(&|list| list[1] = vec![2, 4, 14]);
    assert!(linear.contains("\"wing\": face 1 has 3 points") && linear.contains("made quadratic"), "{linear}");
    let stranger = mesh(&|list| list[1][8] = 15);
    assert!(stranger.contains("\"wing\": element 1: there is no point 15 among 15"), "{stranger}");
    let narrowed = mesh(&|list| list[1][2] = 4);
    assert!(narrowed.contains("\"wing\": element 1 names point 4 twice"), "{narrowed}");
    let reversed = mesh(&|list| list[1] = [4, 2, 12, 14, 3, 7, 13, 9, 8].to_vec());
    assert!(reversed.contains("element 0 and element 1 run along their edge from point 2 to point 12"), "{reversed}");
    assert!(reversed.contains("reverse one of them"), "{reversed}");
    let crossed = mesh(&|list| list[1].swap(0, 1));
    assert!(crossed.contains("element 1 is folded or has no area at point"), "{crossed}");
    let four = mesh(&|list| list[1] = vec![2, 4, 14, 12]);
    assert!(
        four.contains("element 0 and element 1 do not have the same points along their edge from point 2 to point 12"),
        "{four}"
    );
    let hanging = mesh(&|list| list[1] = vec![7, 4, 14, 12]);
    assert!(hanging.contains("point 7 is a corner of element 1 and the middle of the edge of element 0"), "{hanging}");
    let empty = refused(FreeMesh::new(square(), Vec::<Vec<usize>>::new()));
    assert!(empty.contains("\"wing\": it has no faces"), "{empty}");
    let flat = refused(FreeMesh::new(points([2, 1], |u, _| [u, 0.0, 0.0]), quads()));
    assert!(flat.contains("element 0 is folded or has no area"), "{flat}");
    let few = refused(FreeMesh::new(square(), quads()).with_normals(vec![Vector3::new(0.0, 0.0, 1.0); 3]));
    assert!(few.contains("it has 15 points, but 3 normals"), "{few}");
    let under = refused(FreeMesh::new(square(), quads()).with_normals(vec![Vector3::new(0.0, 0.0, -1.0); 15]));
    assert!(under.contains("\"wing\", element 0: at its node 1") && under.contains("cosine is -1.000"), "{under}");
    let group = refused(FreeMesh::new(square(), quads()).group("skin", [0, 2]));
    assert!(group.contains("its group \"skin\" names number 2 of 2 faces"), "{group}");
    let held = refused(FreeMesh::new(square(), quads()).clamped([99]));
    assert!(held.contains("its point 99 is held, but there are 15 points"), "{held}");
}

#[test]
fn a_shell_of_parts_has_the_energies_of_shells_of_each() {
    // two halves of one plate that share no element, of one material with a thickness for each point, and of plies
    let counts = [2, 2];
    let at = |u: f64, v: f64| [0.5 * u, 0.3 * v, 0.0];
    let all = faces(counts, mixed);
    let is_left = |face: &Vec<usize>| face.iter().all(|&point| point % 5 <= 2);
    let laminate = Laminate::new(vec![Ply {
        thickness: 0.004,
        angle: 0.3,
        young: [1.4e11, 1e10],
        poisson: 0.3,
        shear: [5e9, 5e9, 3e9],
        density: 1600.0,
    }])
    .offset(0.001);
    let direction = Vector3::new(1.0, 0.2, 0.0);
    let thickness = |_: usize, point: usize| 0.01 + 1e-4 * point as f64;
    let sums = |m: MechanismBuilder<f64>| {
        let m = m.finish().expect("sound");
        let q = moved(&m, deformed);
        let v = moved(&m, |x| (x * 0.7 + Vector3::new(0.1, -0.2, x[0]), Quaternion::identity()));
        energies(&m, &v, &q)
    };
    let half = |left: bool| {
        let own: Vec<Vec<usize>> = all.iter().filter(|face| is_left(face) == left).cloned().collect();
        FreeMesh::new(points::<f64>(counts, at), own)
    };
    let [mut left, mut right, mut both, mut same] = [(); 4].map(|()| MechanismBuilder::<f64>::default());
    left.tapered_shell("left", half(true), &STEEL, thickness);
    right.laminate_shell("right", half(false), &laminate, direction);
    let whole = || FreeMesh::new(points::<f64>(counts, at), all.clone());
    let parts = [ShellPart::Isotropic(STEEL, &thickness), ShellPart::Laminate(&laminate, direction)];
    let shell = both.shell_of_parts("both", whole(), &parts, |face| usize::from(!is_left(&all[face])));
    let layered = shell.faces().filter(|(kind, _)| kind.section == ShellSection::Laminate).count();
    assert_eq!(layered, all.iter().filter(|face| !is_left(face)).count());
    same.shell_of_parts("same", whole(), &parts[..1], |_| 0);
    let mut plain = MechanismBuilder::<f64>::default();
    plain.tapered_shell("plain", whole(), &STEEL, thickness);
    let [left, right, both, same, plain] = [left, right, both, same, plain].map(sums);
    assert_eq!(same, plain);
    for k in 0..3 {
        assert_close("energy", both[k], left[k] + right[k], 1e-12);
    }
    // a part that is not there
    let mut m = MechanismBuilder::<f64>::default();
    m.shell_of_parts("none", whole(), &parts, |_| 2);
    let why = m.finish().map(|_| ()).unwrap_err().to_string();
    assert!(why.contains("element 0 has part 2, but there are 2"), "{why}");
}
