//! Pressure and damping of shells: resultants, work and equilibria in closed form, gradients.

use costate::elements::flexible::Material;
use costate::elements::forces::LoadFrame;
use costate::functionals::{Aggregate, AggregateKind, Times};
use costate::integrators::ArcLength;
use costate::prelude::*;
use costate::scenes::{AnyScene, Edge, NodeId, ShellMember, ShellMesh};
use std::f64::consts::PI;

const YOUNG: f64 = 1e6;
const RADIUS: f64 = 1.0;

fn material<S: Scalar>(poisson: f64) -> Material<S> {
    Material { young: S::from(YOUNG), poisson: S::from(poisson), density: S::one() }
}

fn unit<S: Scalar>(axis: usize) -> Vector3<S> {
    let mut components = [0.0; 3];
    components[axis] = 1.0;
    Vector3::from_f64(components)
}

/// Holds the position of a node along an axis.
fn hold<S: Scalar>(m: &mut MechanismBuilder<S>, node: NodeId, axis: usize) {
    let (ground, at) = (m.ground(), m.position(node));
    m.point_in_plane(&format!("hold {axis} of {}", m.model.node(node).name.clone()), [ground, node], at, unit(axis));
}

fn coordinates(m: &MechanismBuilder<f64>, nodes: &[NodeId], q: &[f64]) -> Vec<f64> {
    nodes.iter().flat_map(|&node| q[m.model.node(node).dofs.clone()].to_vec()).collect()
}

/// Generalized force of all elements whose name starts with some word, on all coordinates.
fn force_of(m: &MechanismBuilder<f64>, word: &str, v: &[f64], q: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; q.len()];
    for element in m.model.elements.iter().filter(|element| element.name.starts_with(word)) {
        let [v, own] = [v, q].map(|x| coordinates(m, &element.nodes, x));
        let s = State { a: &vec![0.0; own.len()], v: &v, q: &own };
        let r = element.physics.residual_at(s, &m.numbers.p[element.parameters.clone()], 0.0);
        let places = element.nodes.iter().flat_map(|&node| m.model.node(node).dofs.clone());
        places.zip(r).for_each(|(place, r)| all[place] -= r);
    }
    all
}

/// Volume inside a closed surface: a third of the integral of x . x,r cross x,s.
fn volume(m: &MechanismBuilder<f64>, shells: &[ShellMember], q: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (kind, nodes) in shells.iter().flat_map(|shell| shell.faces()) {
        let (own, shape) = (coordinates(m, nodes, q), kind.face.shape());
        for (weights, gauss_weight) in shape.gauss.iter().zip(shape.gauss_weights) {
            let [x, r, s] = [weights.value, weights.by_r, weights.by_s].map(|weights| {
                let nodes = own.chunks_exact(7).zip(weights);
                nodes.fold(Vector3::zeros(), |sum, (node, &weight)| sum + Vector3::first_three(node) * weight)
            });
            sum += x.dot(&r.cross(&s)) * gauss_weight / 3.0;
        }
    }
    sum
}

#[test]
fn follower_pressure_in_a_triangle_surface_has_no_resultant_and_the_work_p_dv() {
    let mut m = MechanismBuilder::default();
    let sphere = m.sphere_shell("sphere", (Vector3::new(0.3, -0.2, 0.5), RADIUS), 2, &material(0.3), 0.02);
    for face in &sphere {
        m.pressure("pressure", face, LoadFrame::Body, Signal::Constant(7.0));
    }
    let m = m.finish().expect("sound");
    assert_eq!(m.model.nodes.len(), 6 * 16 + 2, "faces share their edges");
    let round = volume(&m, &sphere, &m.numbers.q);
    assert!((round / (4.0 / 3.0 * PI) - 1.0).abs() < 2e-3, "{round}");
    // any deformation
    let number = |i: usize| (1.7 * i as f64 + 0.3).sin();
    let q: Vec<f64> = m.numbers.q.iter().enumerate().map(|(i, q)| q + 0.1 * number(i)).collect();
    let force = force_of(&m, "pressure", &vec![0.0; q.len()], &q);
    let total: Vec<f64> = (0..3).map(|axis| force.iter().skip(axis).step_by(7).sum()).collect();
    assert!(total.iter().all(|total| total.abs() < 1e-13 * 7.0 * 4.0 * PI), "{total:?}");
    let moment = force
        .chunks_exact(7)
        .zip(q.chunks_exact(7))
        .fold(Vector3::zeros(), |sum, (force, q)| sum + Vector3::first_three(q).cross(&Vector3::first_three(force)));
    assert!(moment.length() < 1e-13 * 7.0 * 4.0 * PI, "{moment:?}");
    // the volume is a cubic of the coordinates: these differences have no error but round-off
    let along = |size: f64| {
        let moved: Vec<f64> = q.iter().enumerate().map(|(i, q)| q + size * number(3 * i + 1)).collect();
        volume(&m, &sphere, &moved)
    };
    let slope = (8.0 * (along(1.0) - along(-1.0)) - (along(2.0) - along(-2.0))) / 12.0;
    let work: f64 = force.iter().enumerate().map(|(i, force)| force * number(3 * i + 1)).sum();
    assert!((work - 7.0 * slope).abs() < 1e-12 * work.abs(), "{work} {slope}");
}

/// A vessel under a pressure inside that grows with the load factor.
struct Vessel {
    round: Round,
    frame: LoadFrame,
    elements: usize,
    pressure: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Round {
    /// A quarter of a tube that may change its length, nu = 0.
    Tube,
    Sphere,
}

const THICKNESS: f64 = 0.02;
const POISSON: f64 = 0.3;

impl Vessel {
    /// The stretch of the middle surface, from the work of the pressure against E (stretching and, by the curvatures (stretch - 1) / R,
    /// bending).
    fn stretch(&self, pressure: f64) -> f64 {
        let h = THICKNESS;
        let excess = |stretch: f64| {
            let strain = 0.5 * (stretch * stretch - 1.0);
            let (curvature, bending) = ((stretch - 1.0) / RADIUS, h.powi(3) / 12.0);
            match (self.round, self.frame) {
                (Round::Tube, LoadFrame::Body) => {
                    YOUNG * (h * strain * stretch + bending * curvature / RADIUS) - pressure * RADIUS * stretch
                }
                (Round::Tube, LoadFrame::World) => {
                    YOUNG * (h * strain * stretch + bending * curvature / RADIUS) - pressure * RADIUS
                }
                (Round::Sphere, frame) => {
                    let area = if frame == LoadFrame::Body { stretch * stretch } else { 1.0 };
                    2.0 * YOUNG / (1.0 - POISSON) * (h * strain * stretch + bending * curvature / RADIUS)
                        - pressure * RADIUS * area
                }
            }
        };
        let (mut below, mut above) = (1.0, 2.0);
        for _ in 0..100 {
            let middle = 0.5 * (below + above);
            if excess(middle) < 0.0 { below = middle } else { above = middle }
        }
        below
    }
}

impl Scene for Vessel {
    fn name(&self) -> String {
        "vessel".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("pressure", self.pressure, (0.0, 1e6), "N/m2"),
            DesignVariable::new("thickness", THICKNESS, (1e-3, 1.0), "m"),
            DesignVariable::new("radius", RADIUS, (0.1, 10.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::statics(4)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [pressure, thickness, radius] = *x else { return Err("3 variables".into()) };
        let (ground, values) = (m.ground(), [S::zero(), pressure]);
        let (shells, crown) = match self.round {
            Round::Tube => {
                let edge = [unit::<S>(2) * radius, unit::<S>(1) * S::from(0.3)];
                let axis = [Vector3::zeros(), unit(1)];
                let mesh = ShellMesh::cylinder(edge, axis, S::from(0.5 * PI), [self.elements, 1]);
                let tube = m.shell("tube", mesh, &material(0.0), thickness);
                for (edge, normal) in [(Edge::FirstStart, 0), (Edge::FirstEnd, 2)] {
                    for node in tube.edge(edge) {
                        let (name, at) = (format!("symmetry of {}", m.model.node(node).name), m.position(node));
                        m.planar(&name, [ground, node], at, unit(normal));
                    }
                }
                hold(m, tube.node(0, 0), 1);
                let crown = (tube.node(0, 1), 2);
                (vec![tube], crown)
            }
            Round::Sphere => {
                let faces =
                    m.sphere_shell("sphere", (Vector3::zeros(), radius), self.elements, &material(POISSON), thickness);
                // the middles of three faces move along their normals alone
                for (normal, face) in faces.iter().enumerate().take(3) {
                    let middle = face.node(self.elements, self.elements);
                    (1..3).for_each(|other| hold(m, middle, (normal + other) % 3));
                }
                let crown = (faces[0].node(self.elements, self.elements), 0);
                // with so little sharpness the mean over all points
                let mean = Aggregate::new(AggregateKind::SmoothMaximum { normalized: true }, 1e-3);
                m.von_mises_functional("stress", mean.at(Times::End), &faces[0].group(), S::one());
                (faces, crown)
            }
        };
        for (number, shell) in shells.iter().enumerate() {
            m.pressure(&format!("pressure {number}"), shell, self.frame, Signal::of(TimeFunction::ConstantRate, &values));
        }
        let (node, axis) = crown;
        let at = m.position(node);
        m.position_functional("radius", Over::Terminal, node, at, unit(axis));
        Ok(())
    }
}

#[test]
fn vessels_find_the_stretch_in_closed_form() {
    for round in [Round::Tube, Round::Sphere] {
        for frame in [LoadFrame::World, LoadFrame::Body] {
            let mut errors = Vec::new();
            for elements in [2, 4] {
                // stretches the tube by some 10 %
                let scene = Vessel { round, frame, elements, pressure: 2000.0 };
                let prepared = Prepared::new(&scene).expect("sound");
                let place = prepared.mechanism.functionals.len() - 1;
                let radius = prepared.analysis().values(&prepared.x).expect("values")[place];
                errors.push((radius / scene.stretch(2000.0) / RADIUS - 1.0).abs());
            }
            assert!(errors[1] < 1e-4 && errors[1] < 0.15 * errors[0], "{errors:?}");
        }
    }
}

#[test]
fn a_sphere_under_pressure_has_the_membrane_stress_p_r_by_two_h() {
    let scene = Vessel { round: Round::Sphere, frame: LoadFrame::Body, elements: 4, pressure: 1.0 };
    let prepared = Prepared::new(&scene).expect("sound");
    let values = prepared.analysis().values(&prepared.x).expect("values");
    assert!((values[0] / (RADIUS / (2.0 * THICKNESS)) - 1.0).abs() < 0.02, "{}", values[0]);
}

#[test]
fn arc_length_follows_a_sphere_that_is_blown_up() {
    let scene = Vessel { round: Round::Sphere, frame: LoadFrame::Body, elements: 2, pressure: 2000.0 };
    let prepared = Prepared::new(&scene).expect("sound");
    let node = prepared.mechanism.model.nodes.iter().find(|node| node.name == "sphere, face 1[2,2]");
    let dof = node.expect("the middle of the face").dofs.start;
    let path = prepared.path(&ArcLength::new(0.25).up_to_load(1.0)).expect("a path");
    assert!(path.points.len() > 3);
    for point in &path.points {
        let stretch = scene.stretch(2000.0 * point.load);
        assert!((point.q[dof] / stretch - 1.0).abs() < 5e-3, "{} {stretch}", point.q[dof]);
    }
}

#[test]
fn gradients_of_equilibria_by_pressure_thickness_and_radius_agree() {
    for (round, frame) in [(Round::Tube, LoadFrame::World), (Round::Tube, LoadFrame::Body), (Round::Sphere, LoadFrame::Body)]
    {
        let scene = Vessel { round, frame, elements: 2, pressure: 2000.0 };
        let prepared = Prepared::new(&scene as &dyn AnyScene).expect("sound");
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("an equilibrium");
        let [adjoint, complex] = [analysis.adjoint(x, &forward), analysis.complex_step(x, &forward)]
            .map(|gradient| gradient.expect("differentiable").rows);
        for (adjoint, complex) in adjoint.iter().zip(&complex) {
            let apart = largest_difference(complex, adjoint);
            assert!(apart < 1e-11, "{apart:e}: {adjoint:?} {complex:?}");
        }
        // per cent by per cent: the same stretch for p R / h
        let [by_pressure, by_thickness, _] = adjoint[adjoint.len() - 1][..] else { panic!("three variables") };
        let ratio = by_thickness * THICKNESS / (by_pressure * 2000.0);
        assert!((ratio + 1.0).abs() < 1e-3, "{ratio}");
    }
}

#[test]
fn damping_takes_eta_times_the_stiffness_by_the_square_of_the_rate_and_nothing_of_rigid_motion() {
    let mut m = MechanismBuilder::default();
    let eta = 0.03;
    let edges = [unit::<f64>(0) * 0.4, unit::<f64>(1) * 0.2];
    m.shell("plate", ShellMesh::plate(Vector3::zeros(), edges, [2, 1]).damped(eta), &material(0.0), THICKNESS);
    let m = m.finish().expect("sound");
    let q = &m.numbers.q;
    let power = |v: &[f64]| -> f64 {
        let still = force_of(&m, "plate", &vec![0.0; q.len()], q);
        let damped = force_of(&m, "plate", v, q);
        damped.iter().zip(still).zip(v).map(|((damped, still), v)| (damped - still) * v).sum()
    };
    let velocity = |of: &dyn Fn(Vector3<f64>) -> [Vector3<f64>; 2]| -> Vec<f64> {
        let own = q.chunks_exact(7).flat_map(|node| {
            let [velocity, omega] = of(Vector3::first_three(node));
            velocity.components().into_iter().chain(Quaternion::from_slice(&node[3..]).rate_of_body_velocity(omega))
        });
        own.collect()
    };
    let rate = 0.7;
    let stretching = velocity(&|x| [Vector3::new(rate * x[0], 0.0, 0.0), Vector3::zeros()]);
    let expected = -eta * YOUNG * THICKNESS * rate * rate * 0.4 * 0.2;
    assert!((power(&stretching) / expected - 1.0).abs() < 1e-12, "{}", power(&stretching));
    // w = kappa x^2 / 2: the directors turn about y by -kappa x
    let bending = velocity(&|x| [Vector3::new(0.0, 0.0, 0.5 * rate * x[0] * x[0]), Vector3::new(0.0, -rate * x[0], 0.0)]);
    let expected = -eta * YOUNG * THICKNESS.powi(3) / 12.0 * rate * rate * 0.4 * 0.2;
    assert!((power(&bending) / expected - 1.0).abs() < 1e-9, "{} {expected}", power(&bending));
    let omega = Vector3::new(0.3, -0.8, 0.5);
    let rigid = velocity(&|x| [Vector3::new(1.0, 2.0, -1.0) + omega.cross(&x), omega]);
    // quadratic forces of inertia have no power in a rigid motion, up to round-off
    let turning = force_of(&m, "plate", &rigid, q);
    assert!(turning.iter().zip(&rigid).map(|(force, v)| force * v).sum::<f64>().abs() < 1e-9, "{turning:?}");
}
