//! Newton's method and projections end at round-off, whatever the step, the load and the inertia.

use costate::elements::forces::LoadFrame;
use costate::elements::{NodeKind, TimeFunction};
use costate::functionals::Over;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepRecord, table_by_name};
use costate::internals::{AppliedForce, march};
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{AnyScene, DesignVariable, MechanismBuilder, Prepared, Scene, Settings, Violation, built_in};

/// A heavy top whose body frame sits at its tip: the joint's equation is r = 0, and any round-off in r is all of r.
struct TopWithFrameAtTip;

impl Scene for TopWithFrameAtTip {
    fn name(&self) -> String {
        "top with its frame at the tip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.02, 100)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let (sine, cosine) = f64::sin_cos(0.5);
        let top = m.body("top", Vector3::zeros(), Quaternion::about(Vector3::from_f64([0.0, 1.0, 0.0]), S::from(0.5)));
        m.set_velocity(top, Vector3::zeros(), Vector3::from_f64([10.0 * sine, 0.0, 10.0 * cosine]));
        let inertia = [0.75, 0.75, 0.5, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("top", top, S::one(), Vector3::from_f64([0.0, 0.0, 0.5]), inertia);
        m.gravity(Vector3::from_f64([0.0, 0.0, -2.0]));
        m.spherical("tip", [ground, top], Vector3::zeros());
        Ok(())
    }
}

fn worst_violation(scene: &dyn AnyScene, table: &str, end: f64, steps: usize) -> Violation {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Method::new(table_by_name(table).expect("listed"), ConstraintLevel::Acceleration);
    let settings = Settings { end, steps, ..scene.settings().without_method() };
    let prepared = Prepared::with(scene, &x, method, settings).expect("a sound scene");
    let mut worst = Violation::default();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        worst = worst.worse(prepared.violation(step.t + step.h, &step.q, &step.v));
        true
    });
    let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch);
    if let Err(error) = run {
        panic!("{} with {table}, {steps} steps: {error}", scene.name());
    }
    worst
}

#[test]
fn projections_converge_at_small_steps() {
    for steps in [20, 100, 200] {
        let worst = worst_violation(&TopWithFrameAtTip, "sdirk4", 0.02, steps);
        assert!(worst.position <= 1e-14 && worst.velocity <= 1e-13, "{steps} steps: {worst:?}");
    }
}

/// Velocities are of order 10 m/s, so 1e-13 m/s is about a hundred units in the last place.
#[test]
fn projected_velocities_satisfy_the_joints_to_round_off() {
    for (table, steps) in [("esdirk3", 4000), ("sdirk4", 4000)] {
        let worst = worst_violation(built_in::named("double-pendulum").expect("built in"), table, 4.0, steps);
        assert!(worst.velocity <= 1e-12, "{table}: {worst:?}");
    }
}

/// A bar hangs at rest from a hinge, with a second one below it, until a force sets in: all that is solved for before is round-off.
struct AtRest;

impl Scene for AtRest {
    fn name(&self) -> String {
        "two bars at rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", 1.3, (0.1, 10.0), "kg"),
            DesignVariable::new("length", 0.7, (0.1, 10.0), "m"),
            DesignVariable::new("force", 2.3, (-10.0, 10.0), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 100)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, length, force] = [x[0], x[1], x[2]];
        let (up, axis) = (Vector3::from_f64([0.0, 0.0, 1.0]), Vector3::from_f64([0.0, 0.6, 0.8]));
        // turned frames, whose products with the weight do not vanish exactly
        let turned = |angle: f64| Quaternion::about(axis, S::from(angle));
        let upper = m.body("upper", up * (-length * 0.5), turned(0.7));
        let lower = m.body("lower", up * (-length * 1.3), turned(-0.4));
        for (name, body) in [("upper", upper), ("lower", lower)] {
            m.rigid_body(name, body, mass, Vector3::zeros(), [0.11, 0.12, 0.13, 0.01, -0.02, 0.015].map(S::from));
        }
        let ground = m.ground();
        m.spherical("shoulder", [ground, upper], Vector3::zeros());
        m.spherical("elbow", [upper, lower], up * -length);
        m.gravity(up * S::from(-9.81));
        let push = AppliedForce { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::Step { switch: 0.5 } };
        let direction_and_point = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0].map(S::from);
        m.element("push", &[lower], push, &[&direction_and_point[..], &[S::zero(), force]].concat());
        m.position_functional("way", Over::Terminal, lower, up * (-length * 1.3), Vector3::from_f64([1.0, 0.0, 0.0]));
        Ok(())
    }
}

#[test]
fn a_mechanism_at_rest_whose_load_comes_later_has_its_gradient_checked() {
    for steps in [20, 100, 1000] {
        let settings = Settings { steps, ..Scene::settings(&AtRest) };
        let prepared =
            Prepared::with(&AtRest, &[1.3, 0.7, 2.3], Prepared::default_method(), settings).expect("a sound scene");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap_or_else(|error| panic!("{steps} steps: {error}"));
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap_or_else(|error| panic!("{steps} steps: {error}"));
        let check = analysis.complex_step(&prepared.x, &forward).unwrap_or_else(|error| panic!("{steps} steps: {error}"));
        let largest = adjoint.rows[0].iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        assert!(largest > 0.05, "the force moves the bar: {:?}", adjoint.rows);
        for (own, exact) in adjoint.rows[0].iter().zip(&check.rows[0]) {
            assert!((own - exact).abs() <= 1e-11 * largest, "{steps} steps: {:?} and {:?}", adjoint.rows, check.rows);
        }
    }
}

/// A pendulum with a speck on a ball joint at its tip, whose inertia about the joint is next to nothing.
struct Speck {
    inertia: f64,
}

/// Length of the pendulum [m], masses of its bob and of the speck [kg], turning rate of the speck [rad/s].
const SPECK: [f64; 4] = [0.8, 1.2, 0.1, 1.0];

impl Scene for Speck {
    fn name(&self) -> String {
        "speck".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 100)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, bob, speck, rate] = SPECK.map(S::from);
        let tip = Vector3::from_f64([1.0, 0.0, 0.0]) * length;
        let (arm, dust) = (m.body("arm", tip, Quaternion::identity()), m.body("speck", tip, Quaternion::identity()));
        m.rigid_body("arm", arm, bob, Vector3::zeros(), [0.01, 0.01, 0.01, 0.0, 0.0, 0.0].map(S::from));
        let own = S::from(self.inertia);
        m.rigid_body("speck", dust, speck, Vector3::zeros(), [own, own, own, S::zero(), S::zero(), S::zero()]);
        m.set_velocity(dust, Vector3::zeros(), Vector3::from_f64([0.0, 0.0, 1.0]) * rate);
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        let ground = m.ground();
        m.revolute("hinge", [ground, arm], Vector3::zeros(), Vector3::from_f64([0.0, 1.0, 0.0]));
        m.spherical("ball", [arm, dust], tip);
        Ok(())
    }
}

/// The moment about its joint is none, so the speck turns steadily, and the arm swings as with a speck of ordinary inertia.
#[test]
fn a_body_next_to_no_inertia_about_its_joint_turns_as_its_start_says() {
    for (table, off) in [("esdirk3", 1e-8), ("esdirk4", 1e-9), ("sdirk4", 1e-7), ("bdf2", 1e-4), ("generalized-alpha", 1e-4)]
    {
        let end = |inertia: f64| {
            let scene = Speck { inertia };
            let method = Method::new(table_by_name(table).expect("listed"), ConstraintLevel::Acceleration);
            let prepared = Prepared::with(&scene, &[], method, Settings::new(1.0, 100)).expect("a sound scene");
            let mut q = Vec::new();
            let mut watch = Watch(|step: &StepRecord<f64>| {
                q.clone_from(&step.q);
                true
            });
            march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch)
                .unwrap_or_else(|error| panic!("{table}: {error}"));
            let bodies = prepared.model().nodes.iter().filter(|node| !node.fixed).map(|node| q[node.dofs.clone()].to_vec());
            bodies.collect::<Vec<_>>()
        };
        let (tiny, ordinary) = (end(1e-13), end(1e-2));
        let (sine, cosine) = (0.5 * SPECK[3]).sin_cos();
        for (own, exact) in tiny[1][3..].iter().zip([cosine, 0.0, 0.0, sine]) {
            assert!((own - exact).abs() <= off, "{table}: the speck stands at {:?}", tiny[1]);
        }
        let apart = tiny[0].iter().zip(&ordinary[0]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(apart <= 1e-9, "{table}: the arm stands {apart} off");
    }
}
