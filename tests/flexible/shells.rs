//! Shells of mechanisms: what they are made of, their weight, drilling against closed forms, and mistakes in words.

use super::assert_close;
use costate::elements::flexible::{Laminate, Material, Ply};
use costate::prelude::*;
use costate::scenes::{DRILLING, Edge, NodeId, ShellMember, ShellMesh};
use std::f64::consts::PI;

const STEEL: Material<f64> = Material { young: 210e9, poisson: 0.3, density: 7850.0 };
const THICKNESS: f64 = 0.01;

fn rectangle(sizes: [f64; 2], elements: [usize; 2]) -> ShellMesh<f64> {
    ShellMesh::plate(Vector3::zeros(), [Vector3::new(sizes[0], 0.0, 0.0), Vector3::new(0.0, sizes[1], 0.0)], elements)
}

/// A part of a tube about the y axis.
fn curved(elements: [usize; 2]) -> ShellMesh<f64> {
    let edge = [Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.0, 0.3, 0.0)];
    ShellMesh::cylinder(edge, [Vector3::zeros(), Vector3::new(0.0, 1.0, 0.0)], 0.8, elements)
}

/// Kinetic and potential energy of the elements of a shell, and their mass.
fn energies(m: &MechanismBuilder<f64>, shell: &ShellMember, v: &[f64], q: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for element in m.model.elements.iter().filter(|element| element.nodes.iter().all(|node| shell.nodes.contains(node))) {
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
        let (place, turn) = to(Vector3::new(q[0], q[1], q[2]));
        place.iter().copied().chain(turn.times(Quaternion::from_slice(&q[3..])).0).collect::<Vec<f64>>()
    };
    m.numbers.q.chunks_exact(7).flat_map(node).collect()
}

#[test]
fn a_laminate_of_plies_of_one_material_is_the_shell_of_that_material() {
    let mut m = MechanismBuilder::default();
    let plain = m.shell("plain", curved([2, 1]), &STEEL, THICKNESS);
    let ply = |share: f64| Ply { angle: share, ..Ply::isotropic(&STEEL, share * THICKNESS) };
    let plies = Laminate::new(vec![ply(0.2), ply(0.5), ply(0.3)]);
    let layered = m.laminate_shell("layered", curved([2, 1]), &plies, Vector3::new(0.3, 1.0, 0.1));
    m.gravity(Vector3::new(1.0, -2.0, 3.0));
    let m = m.finish().expect("sound");
    // bent, sheared, stretched and twisted
    let q = moved(&m, |x| {
        let turn = Quaternion::about(Vector3::new(0.6, 0.0, 0.8), 0.3 * x[1] - 0.2 * x[0]);
        (turn.rotate(x) + Vector3::new(0.02 * x[0] * x[1], 0.01 * x[2], 0.03 * x[0] * x[0]), turn)
    });
    let v: Vec<f64> = (0..q.len()).map(|i| (1.7 * f64::from(i as u32 % (7 * 15))).sin()).collect();
    let [own, other] = [&plain, &layered].map(|shell| energies(&m, shell, &v, &q));
    for (name, (own, other)) in ["kinetic", "potential", "mass"].into_iter().zip(own.into_iter().zip(other)) {
        assert_close(name, own, other, 1e-12);
    }
}

#[test]
fn weight_is_mass_times_gravity_and_a_tube_closes() {
    let mut m = MechanismBuilder::default();
    let edge = [Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.0, 0.3, 0.0)];
    let tube = ShellMesh::cylinder(edge, [Vector3::zeros(), Vector3::new(0.0, 1.0, 0.0)], 2.0 * PI, [12, 1]).closed();
    let tube = m.shell("tube", tube, &STEEL, THICKNESS);
    m.gravity(Vector3::new(0.0, 0.0, -9.81));
    let m = m.finish().expect("sound");
    assert_eq!(m.model.nodes.len(), 24 * 3, "the first nodes are the last");
    let still = vec![0.0; m.numbers.q.len()];
    let [_, before, mass] = energies(&m, &tube, &still, &m.numbers.q);
    // an element of 30 degrees by quadratics
    assert_close("mass", mass, 7850.0 * THICKNESS * PI * 0.3, 1e-4);
    let lifted = moved(&m, |x| (x + Vector3::new(0.0, 0.0, 2.0), Quaternion::identity()));
    let [_, after, _] = energies(&m, &tube, &still, &lifted);
    assert_close("work against the weight", after - before, 2.0 * 9.81 * mass, 1e-12);
}

#[test]
fn rotation_about_the_director_meets_the_stated_penalty_and_nothing_else() {
    let mut m = MechanismBuilder::default();
    let plate = m.shell("plate", rectangle([0.4, 0.2], [2, 1]), &STEEL, THICKNESS);
    let m = m.finish().expect("sound");
    let angle: f64 = 0.1;
    let q = moved(&m, |x| (x, Quaternion::about(Vector3::new(0.0, 0.0, 1.0), angle)));
    let [_, energy, _] = energies(&m, &plate, &vec![0.0; q.len()], &q);
    // nodes are 0.1 m apart
    let twist = STEEL.young / 2.6 * THICKNESS.powi(3) / 12.0;
    assert_close("energy", energy, 0.5 * DRILLING * twist / 0.02 * angle.sin().powi(2) * 0.08, 1e-12);
}

#[test]
fn shells_share_nodes_with_bodies_and_with_each_other() {
    let mut m = MechanismBuilder::<f64>::default();
    let frame = Quaternion::about(Vector3::new(0.0, 0.6, 0.8), 0.7);
    let body = m.body("body", Vector3::new(0.0, 0.1, 0.0), frame);
    m.rigid_body("body", body, 2.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let first = m.shell("first", rectangle([0.4, 0.2], [2, 1]).with_node(0, 1, body), &STEEL, THICKNESS);
    let shared: Vec<NodeId> = first.edge(Edge::FirstEnd);
    let wall = [Vector3::new(0.0, 0.2, 0.0), Vector3::new(0.0, 0.0, -0.3)];
    let wall = ShellMesh::plate(Vector3::new(0.4, 0.0, 0.0), wall, [1, 1]).with_edge(Edge::SecondStart, &shared);
    let second = m.shell("second", wall, &STEEL, THICKNESS);
    let m = m.finish().expect("sound");
    assert_eq!(m.model.nodes.len(), 15 + 6);
    assert_eq!(first.node(0, 1), body);
    assert_eq!(second.edge(Edge::SecondStart), shared);
    // nothing is strained at the start, in whatever frame the nodes begin
    let still = vec![0.0; m.numbers.q.len()];
    for shell in [&first, &second] {
        let [_, energy, _] = energies(&m, shell, &still, &m.numbers.q);
        assert!(energy.abs() < 1e-12, "{energy}");
    }
}

#[test]
fn mistakes_name_the_shell_and_say_what_to_do() {
    let refused = |build: &dyn Fn(&mut MechanismBuilder<f64>)| {
        let mut m = MechanismBuilder::default();
        build(&mut m);
        m.finish().err().expect("refused")
    };
    let backwards = refused(&|m| {
        let mesh = rectangle([0.4, 0.2], [1, 1]).moved(|x, _, _| Vector3::new(-x[0], x[1], x[2]));
        m.shell("plate", mesh, &STEEL, THICKNESS);
    });
    assert!(backwards.contains("\"plate\", element 1, 1") && backwards.contains("cosine is -1.000"), "{backwards}");
    let empty = refused(&|m| {
        m.shell("plate", rectangle([0.4, 0.2], [0, 1]), &STEEL, THICKNESS);
    });
    assert!(empty.contains("0 x 1 elements"), "{empty}");
    let apart = refused(&|m| {
        let body = m.body("body", Vector3::new(0.0, 0.05, 0.0), Quaternion::identity());
        m.shell("plate", rectangle([0.4, 0.2], [1, 1]).with_node(0, 1, body), &STEEL, THICKNESS);
    });
    assert!(apart.contains("5.000e-2 m from its node \"body\""), "{apart}");
    let normal = refused(&|m| {
        let plies = Laminate::new(vec![Ply::isotropic(&STEEL, THICKNESS)]);
        m.laminate_shell("plate", rectangle([0.4, 0.2], [1, 1]), &plies, Vector3::new(0.0, 0.0, 1.0));
    });
    assert!(normal.contains("normal to its surface"), "{normal}");
    let rubber = refused(&|m| {
        m.shell("plate", rectangle([0.4, 0.2], [1, 1]), &Material { poisson: 1.0, ..STEEL }, THICKNESS);
    });
    assert!(rubber.contains("Poisson's ratio of \"plate\" is 1"), "{rubber}");
}
