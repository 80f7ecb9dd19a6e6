//! Natural coordinates tell the same mechanics as Euler parameters: the same mechanisms, written with one, the other or both.

use costate::elements::forces::LoadFrame;
use costate::functionals::LoadKind;
use costate::internals::{AppliedForce, AppliedTorque};
use costate::prelude::*;
use costate::scenes::{ConstraintId, NodeId};

/// Coordinates of the bodies of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Euler,
    Natural,
    /// One after the other.
    Mixed,
}

/// Joints of a chain of four bodies that hangs on the ground.
#[derive(Clone, Copy, Debug)]
enum Joints {
    Hinges,
    Slides,
    Driven,
}

struct Chain {
    kind: Kind,
    joints: Joints,
}

fn vector<S: Scalar>(components: [f64; 3]) -> Vector3<S> {
    Vector3::from_f64(components)
}

impl Chain {
    fn body<S: Scalar>(&self, m: &mut MechanismBuilder<S>, number: usize, mass: S, place: Vector3<S>) -> NodeId {
        let turn = Quaternion::about(vector([0.0, 0.6, 0.8]), S::from(0.4 + 0.9 * number as f64));
        let name = format!("body {number}");
        let natural = self.kind == Kind::Natural || (self.kind == Kind::Mixed && number.is_multiple_of(2));
        let node = if natural { m.natural_body(&name, place, turn) } else { m.body(&name, place, turn) };
        let tensor = [0.2, 0.3, 0.25, 0.03, -0.02, 0.05].map(|entry| mass * entry);
        m.rigid_body(&name, node, mass, vector([0.05, 0.02, -0.03]), tensor);
        node
    }
}

impl Scene for Chain {
    fn name(&self) -> String {
        format!("chain {:?} {:?}", self.kind, self.joints)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("mass", 1.3), ("length", 0.7), ("stiffness", 30.0), ("spin", 0.8)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.0, 100.0), ""))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.3, 60)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, length, stiffness, spin] = x else { return Err("4 variables expected".into()) };
        let ground = m.ground();
        let (along, z, across) = (vector([0.6, 0.0, 0.8]), vector([0.0, 0.0, 1.0]), vector([0.8, 0.0, -0.6]));
        let point = |i: usize| along * (*length * (i as f64));
        let bodies: Vec<NodeId> = (0..4).map(|i| self.body(m, i, *mass, point(i) + along * (*length * 0.5))).collect();
        let omega = along * *spin;
        m.set_rigid_motion(&bodies, Vector3::zeros(), Vector3::zeros(), omega);
        let pair = |i: usize| [if i == 0 { ground } else { bodies[i - 1] }, bodies[i]];
        let damped = SpringDamper { stiffness: *stiffness * 0.1, damping: S::from(0.2), rest: S::from(0.1) };
        let first: ConstraintId = match self.joints {
            Joints::Hinges => {
                // the whole chain turns about `along`, so that the first hinge does
                let first = m.revolute("hinge", pair(0), point(0), along);
                m.torsion_spring_damper("torsion", pair(0), along, damped);
                m.universal("universal", pair(1), point(1), [across, vector([0.0, 1.0, 0.0])]);
                m.prismatic("slide", pair(2), point(2), across);
                m.slide_spring_damper("along the slide", pair(2), [point(2); 2], across, damped);
                m.fixed("weld", pair(3), point(3));
                first
            }
            Joints::Slides => {
                let first = m.cylindrical("cylinder", pair(0), point(0), along);
                m.helical("screw", pair(1), point(1), across, S::from(0.3));
                m.planar("plane", pair(2), point(2), across);
                m.spherical("ball", pair(3), point(3));
                // along its axes only: what it measures about them differs between coordinates, but for small angles
                let rates = BushingRates {
                    stiffness_along: [*stiffness; 3],
                    stiffness_about: [S::zero(); 3],
                    damping_along: [S::from(0.4); 3],
                    damping_about: [S::zero(); 3],
                };
                m.bushing("bushing", pair(2), point(2), Quaternion::about(z, S::from(0.7)), rates);
                first
            }
            Joints::Driven => {
                let first = m.cylindrical("cylinder", pair(0), point(0), along);
                // at the start as fast as the chain turns
                m.prescribed_rotation("turn", pair(0), along, Signal::ConstantRate { offset: S::zero(), rate: *spin });
                m.prescribed_translation("push", pair(0), [point(0); 2], along, Signal::Constant(S::zero()));
                m.rigid_link("link", pair(1));
                m.point_on_line("line", pair(2), point(2), across);
                m.point_in_plane("face", pair(3), point(3), across);
                m.distance("rod", [bodies[2], bodies[3]], [point(2), point(4)]);
                let angle = m.joint_angle("angle", pair(2), across);
                m.coordinate_spring_damper("on the angle", angle, 0, damped);
                first
            }
        };
        let tip = point(4);
        m.line_spring("spring", [ground, bodies[3]], [vector([1.0, 1.0, 1.0]), tip], *stiffness, S::from(0.5));
        m.vector_damper("damper", [bodies[0], bodies[3]], [point(0), tip], S::from(0.3));
        for (i, frame) in [LoadFrame::World, LoadFrame::Body].into_iter().enumerate() {
            let on = m.model.node(bodies[i]).kind.in_space().ok_or("bodies have places")?;
            let local = |direction: [f64; 3]| {
                if i == 1 {
                    m.local_direction(bodies[i], vector(direction)).components()
                } else {
                    vector(direction).components()
                }
            };
            let (force, torque) = (local([0.3, -0.5, 0.7]), local([0.7, 0.2, -0.4]));
            let p = [&force[..], &m.local_point(bodies[i], point(i)).components(), &[S::from(2.0)]].concat();
            let size = TimeFunction::Constant;
            m.element(&format!("force {i}"), &[bodies[i]], AppliedForce { on, frame, size: size.clone() }, &p);
            let p = [&torque[..], &[S::from(0.6)]].concat();
            m.element(&format!("torque {i}"), &[bodies[i]], AppliedTorque { on, frame, size }, &p);
        }
        m.gravity(vector([0.0, 0.0, -9.81]));
        m.target_functional("path", Over::Integral, bodies[3], tip, Vector3::zeros());
        m.velocity_functional("speed", Over::Terminal, bodies[3], tip, across);
        m.energy_functional("energy", Over::Terminal);
        m.joint_angle_functional("turned", Over::Terminal, pair(0), along);
        m.joint_rate_functional("turning", Over::Terminal, pair(2), across);
        m.joint_displacement_functional("slid", Over::Terminal, pair(2), point(2), across);
        for (kind, frame) in [(LoadKind::Force, LoadFrame::World), (LoadKind::Moment, LoadFrame::Body)] {
            let on = (first, bodies[0]);
            m.joint_load_functional(&format!("{kind:?}"), Over::Integral, on, (kind, frame), z, point(1));
        }
        Ok(())
    }
}

/// Largest difference of two rows, relative to the larger of 1 and the largest entry: some functionals do not depend on the design.
fn apart(exact: &[f64], own: &[f64]) -> f64 {
    let scale = exact.iter().fold(1.0, |scale: f64, x| scale.max(x.abs()));
    exact.iter().zip(own).map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max)
}

fn start(scene: &dyn costate::scenes::AnyScene) -> Vec<f64> {
    scene.variables().iter().map(|variable| variable.initial).collect()
}

const JOINTS: [Joints; 3] = [Joints::Hinges, Joints::Slides, Joints::Driven];

fn values(chain: &Chain, steps: usize) -> Vec<f64> {
    let x = start(chain);
    let settings = Settings { steps, ..chain.settings() };
    let prepared = Prepared::with(chain, &x, Prepared::default_method(), settings).expect("a sound chain");
    let run = prepared.analysis().forward(&x).unwrap_or_else(|error| panic!("{:?} {:?}: {error}", chain.kind, chain.joints));
    run.values
}

/// The default method has order 4: errors of both fall by 16 when steps are halved.
#[test]
fn every_joint_moves_natural_coordinates_as_it_moves_euler_parameters() {
    for joints in JOINTS {
        let [euler, natural, mixed] = [Kind::Euler, Kind::Natural, Kind::Mixed].map(|kind| Chain { kind, joints });
        let reference = values(&euler, 600);
        for other in [natural, mixed] {
            let fine: Vec<f64> = values(&other, 600).iter().zip(&reference).map(|(a, b)| (a - b).abs()).collect();
            let coarse: Vec<f64> = values(&other, 150).iter().zip(&reference).map(|(a, b)| (a - b).abs()).collect();
            let largest = |list: &[f64]| list.iter().fold(0.0, |largest: f64, x| largest.max(*x));
            let (fine, coarse, size) = (largest(&fine), largest(&coarse), largest(&reference));
            println!("{joints:?} {:?}: {fine:.1e} with 600 steps, {coarse:.1e} with 150, values to {size:.1}", other.kind);
            // loads of joints, of order 2 with this method, among them
            assert!(fine < 1e-7 * size && fine < 0.2 * coarse, "{joints:?} {:?}: {fine:.1e}, {coarse:.1e}", other.kind);
        }
    }
}

#[test]
fn gradients_equal_complex_steps() {
    for joints in JOINTS {
        for kind in [Kind::Natural, Kind::Mixed] {
            let chain = Chain { kind, joints };
            let x = start(&chain);
            let prepared = Prepared::new(&chain).expect("a sound chain");
            let analysis = prepared.analysis();
            let forward = analysis.forward(&x).expect("it runs");
            let exact = analysis.complex_step(&x, &forward).expect("it runs");
            let own = [analysis.adjoint(&x, &forward).expect("adjoint"), analysis.tangent(&x, &forward).expect("tangent")];
            for (name, own) in ["adjoint", "tangent"].into_iter().zip(own) {
                let rows = own.rows.iter().zip(&exact.rows);
                let worst = rows.map(|(own, exact)| apart(exact, own)).fold(0.0, f64::max);
                println!("{joints:?} {kind:?}: {name} {worst:.1e}");
                assert!(worst < 1e-12, "{joints:?} {kind:?}: {name} {worst:.1e}");
            }
        }
    }
}

/// A free body, or a body on a joint that is there twice.
struct Single {
    natural: bool,
    pinned: bool,
}

impl Scene for Single {
    fn name(&self) -> String {
        "single".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 1.5, (0.1, 10.0), "kg"), DesignVariable::new("arm", 0.4, (0.1, 1.0), "m")]
    }
    fn settings(&self) -> Settings {
        let settings = Settings::new(1.0, 1000);
        if self.pinned { settings.dropping_redundant() } else { settings }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (mass, arm) = (x[0], vector([1.0, 0.0, 0.0]) * x[1]);
        let node = if self.natural {
            m.natural_body("body", arm, Quaternion::identity())
        } else {
            m.body("body", arm, Quaternion::identity())
        };
        m.rigid_body("body", node, mass, vector([0.1, 0.2, 0.0]), [2.0, 2.5, 3.0, 0.2, -0.1, 0.3].map(|entry| mass * entry));
        let ground = m.ground();
        let omega = vector([0.0, 0.0, 1.0]);
        if self.pinned {
            m.set_rigid_motion(&[node], Vector3::zeros(), Vector3::zeros(), omega);
            let names = ["first", "second"];
            let joints = names.map(|name| (name, m.revolute(name, [ground, node], Vector3::zeros(), omega)));
            for (own, joint) in joints {
                let on = (joint, node);
                for (kind, axis) in [(LoadKind::Force, [1.0, 0.0, 0.0]), (LoadKind::Moment, [0.0, 1.0, 0.0])] {
                    let name = format!("{kind:?} of {own}");
                    m.joint_load_functional(&name, Over::Integral, on, (kind, LoadFrame::World), vector(axis), arm);
                }
                m.reaction_norm_functional(&format!("norm of {own}"), Over::Terminal, joint);
            }
        } else {
            m.set_velocity(node, Vector3::zeros(), vector([1.0, 0.1, 1.0]));
            m.energy_functional("energy", Over::Terminal);
            m.energy_functional("energy at the start", Over::Initial);
        }
        m.gravity(vector([0.0, -1.0, -2.0]));
        for (name, axis) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
            m.position_functional(name, Over::Terminal, node, arm + vector([0.0, 1.0, 0.0]), vector(axis));
        }
        Ok(())
    }
}

#[test]
fn a_free_body_and_redundant_hinges_are_the_same_in_both_coordinates() {
    for pinned in [false, true] {
        let [coarse, fine] = [100, 500].map(|steps| {
            let [euler, natural] = [false, true].map(|natural| {
                let scene = Single { natural, pinned };
                let x = start(&scene);
                let settings = Settings { steps, ..scene.settings() };
                let prepared = Prepared::with(&scene, &x, Prepared::default_method(), settings).expect("a sound body");
                let analysis = prepared.analysis();
                let forward = analysis.forward(&x).expect("it runs");
                let [adjoint, exact] =
                    [analysis.adjoint(&x, &forward), analysis.complex_step(&x, &forward)].map(|g| g.expect("gradient"));
                for (own, exact) in adjoint.rows.iter().zip(&exact.rows) {
                    let difference = apart(exact, own);
                    assert!(difference < 1e-12, "natural: {natural}, pinned: {pinned}: {difference:.1e}");
                }
                forward.values
            });
            apart(&euler, &natural)
        });
        println!("pinned: {pinned}: {coarse:.1e} with 100 steps, {fine:.1e} with 500");
        // of order 4 both, 625 times less with five times the steps, but for round-off
        assert!(fine < 1e-12 && fine < coarse / 30.0, "pinned: {pinned}: {coarse:.1e}, {fine:.1e}");
    }
}

/// With short steps the first correction of the coordinates is round-off, but that of the reactions is as old as the matrix.
#[test]
fn reactions_do_not_depend_on_how_old_the_matrix_is() {
    let scene = Single { natural: false, pinned: true };
    let x = start(&scene);
    let [reference, others @ ..] = [500, 1000, 2000, 4000].map(|steps| {
        let settings = Settings { steps, ..scene.settings() };
        let prepared = Prepared::with(&scene, &x, Prepared::default_method(), settings).expect("a sound body");
        prepared.analysis().values(&x).expect("it runs")
    });
    for values in others {
        // the error of the method is of this size with 500 steps
        assert!(apart(&reference, &values) < 3e-13, "{:.1e}", apart(&reference, &values));
    }
}

/// What a user may get wrong about the start of a natural body.
struct Skew;

impl Scene for Skew {
    fn name(&self) -> String {
        "skew".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 10)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.natural_body("plate", Vector3::zeros(), Quaternion([1.1, 0.0, 0.0, 0.0].map(S::from)));
        m.rigid_body("plate", node, S::one(), Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(S::from));
        Ok(())
    }
}

#[test]
fn axes_that_are_not_orthonormal_are_refused_by_name() {
    let Err(error) = Prepared::new(&Skew) else { panic!("went unnoticed") };
    let message = error.to_string();
    assert!(["\"plate\"", "orthonormal", "2.32", "projected"].iter().all(|part| message.contains(part)), "{message}");
}
