//! Work counts and threads: lost efficiency turns red without a clock, and results do not depend on the number of threads.

use costate::elements::{Element, NodeKind, Parameter, State};
use costate::functionals::Over;
use costate::integrators::{ConstraintLevel, Method};
use costate::internals::{Equations, Level, Program, StageCoefficients, table_named};
use costate::scalar::Scalar;
use costate::scenes::{AnyScene, DesignVariable, MechanismBuilder, Prepared, Scene, Settings, built_in};
use costate::sensitivity::largest_difference;

fn scene(name: &str) -> &'static dyn AnyScene {
    built_in::named(name).expect("a built-in scene")
}

fn prepared<'s>(scene: &'s dyn AnyScene, end: f64, steps: usize) -> Prepared<'s> {
    let x: Vec<f64> = scene.variables().iter().map(|variable: &DesignVariable| variable.initial).collect();
    let settings = Settings { end, steps, ..scene.settings().without_method() };
    Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene")
}

#[test]
fn newton_needs_few_iterations_and_few_factorizations() {
    let scene = scene("five-bar");
    let prepared = prepared(scene, 0.5, 50);
    let forward = prepared.analysis().forward(&prepared.x).expect("runs");
    let counters = forward.counters;
    // five stages and two projections a step, and the first acceleration
    assert_eq!(counters.systems, 7 * 50 + 1);
    assert!(2 * counters.iterations <= 5 * counters.systems, "{counters:?}");
    // one at the start of a step where that saves corrections, a look at its redundant equations every five steps, and as many where a
    // second correction, which springs ask for, shows that the matrix has aged within the step
    assert!(counters.factorizations <= 50 + 10 + 12, "{counters:?}");
}

#[test]
fn a_step_of_cables_takes_few_iterations_and_one_block_an_element() {
    let steps = 200;
    for (elements, most_iterations, most_factorizations) in [(5, 5.0, 0.07), (20, 5.5, 0.2)] {
        let changes = format!("cable.pendulum.elements = {elements}");
        let scene = built_in::changed("flexible-pendulum", &changes).expect("sound");
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let settings = Settings { end: 1e-3 * steps as f64, steps, ..scene.settings() };
        let table = table_named("variational").expect("no mistake").expect("listed");
        let method = Method::new(table, ConstraintLevel::default());
        let prepared = Prepared::with(&scene, &x, method, settings).expect("a sound scene");
        let counters = prepared.analysis().forward(&x).expect("runs").counters;
        assert_eq!(counters.systems, steps + 1);
        // inertia, weight and elasticity in one element
        assert_eq!(counters.blocks, elements * counters.factorizations);
        let per_step = |count: usize| count as f64 / steps as f64;
        assert!(per_step(counters.iterations) <= most_iterations, "{counters:?}");
        assert!(per_step(counters.factorizations) <= most_factorizations, "{counters:?}");
    }
}

#[test]
fn the_adjoint_takes_one_factorization_a_system_and_shares_it_between_functionals() {
    let scene = scene("pendulum");
    let prepared = prepared(scene, 0.5, 50);
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("runs");
    let counters = analysis.adjoint(&prepared.x, &forward).expect("has a gradient").counters;
    // but where the matrix is nearly the same, as in the second projection of each step
    assert!((295..=305).contains(&counters.factorizations), "{counters:?}");
    let functionals = prepared.functionals().len();
    // without stiff members a correction of these is looked at, to no purpose, 1, 2, 4, ... and then 64 systems later
    let most = functionals * (counters.systems + 10);
    assert!(functionals > 1 && counters.solves > counters.systems && counters.solves <= most, "{counters:?}");
    assert_eq!(counters.products, counters.solves);
}

#[test]
fn products_of_a_second_functional_share_what_depends_on_the_state() {
    for name in ["five-bar", "andrews", "plate-pendulum"] {
        let scene = scene(name);
        let prepared = prepared(scene, 0.1, 10);
        let system = prepared.method.system(prepared.model(), &prepared.plan.dropped);
        let equations = Equations::stage(StageCoefficients::new(1.0, 0.01, 1e-4), Level::Acceleration);
        let count = |program: &Program| program.instructions();
        let pairs = system.part_programs(&equations).into_iter().map(|own| own.products.map(|own| count(&own)));
        let shares: Vec<(usize, f64)> = pairs.map(|[one, two]| (one, two as f64 / one as f64)).collect();
        println!("{name}: instructions for one functional, and for two by these: {shares:.2?}");
        let large = shares.iter().filter(|(one, _)| *one > 100);
        assert!(large.clone().count() > 0 && large.clone().all(|(_, share)| *share < 1.9), "{name}: {shares:?}");
    }
}

#[test]
fn one_and_many_threads_give_the_same_bits() {
    let scene = scene("chain-common");
    let prepared = prepared(scene, 0.02, 4);
    let on_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| {
            let forward = prepared.analysis().forward(&prepared.x).expect("runs");
            let gradient = prepared.analysis().adjoint(&prepared.x, &forward).expect("has a gradient");
            (forward.values, gradient.rows)
        })
    };
    assert_eq!(on_threads(1), on_threads(4));
}

/// A chain of masses on linear springs and dampers between the ends of the line, written by a user.
#[derive(Hash)]
struct Spring;

impl Element for Spring {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("stiffness", "N/m"), Parameter::new("damping", "N s/m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1); 2]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let force = p[0] * (s.q[1] - s.q[0]) + p[1] * (s.v[1] - s.v[0]);
        r[0] -= force;
        r[1] += force;
    }
}

#[derive(Hash)]
struct Mass;

impl Element for Mass {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] += p[0] * s.a[0];
    }
}

struct Masses(usize);

/// Their number.
const MASSES: usize = 6;

impl Scene for Masses {
    fn name(&self) -> String {
        "masses".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("stiffness", 40.0, (1.0, 100.0), "N/m"),
            DesignVariable::new("mass", 2.0, (0.1, 10.0), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 100)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let place = |i: usize| [S::from(0.1 * (i * i) as f64)];
        let node = |m: &mut MechanismBuilder<S>, i: usize| m.coordinates(&format!("mass {i}"), &place(i), &[S::zero()]);
        let nodes: Vec<_> = (0..self.0).map(|i| node(m, i)).collect();
        for &node in &nodes {
            m.element("mass", &[node], Mass, &[x[1]]);
        }
        for pair in nodes.windows(2) {
            m.element("spring", pair, Spring, &[x[0], S::from(0.3)]);
        }
        m.coordinate_functional("first mass at the end", Over::Terminal, nodes[0], 0);
        Ok(())
    }
}

#[test]
fn a_linear_scene_is_differentiated_once_and_factored_once_per_step_size() {
    let x = [40.0, 2.0];
    let prepared = Prepared::new(&Masses(MASSES)).expect("sound");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).expect("runs");
    let stages = prepared.method.table.stages.iter().filter(|stage| stage.known.is_none()).count();
    // no projections: there is nothing to project on
    assert_eq!(forward.counters.systems, 100 * stages + 1);
    // the first acceleration and the stages
    assert_eq!(forward.counters.factorizations, 2);
    // one program gives the whole block of an element for a step size: gamma dR/da + beta dR/dv + alpha dR/dq
    let blocks = MASSES + MASSES - 1;
    assert_eq!(forward.counters.blocks, 2 * blocks);
    let adjoint = analysis.adjoint(&x, &forward).expect("has a gradient");
    assert_eq!((adjoint.counters.factorizations, adjoint.counters.blocks), (2, 2 * blocks));
    let complex = analysis.complex_step(&x, &forward).expect("runs");
    assert!(largest_difference(&complex.rows[0], &adjoint.rows[0]) < 1e-13, "{complex:?} {adjoint:?}");
}

#[test]
fn a_longer_linear_scene_is_factored_once_too_with_the_same_bits_on_any_number_of_threads() {
    let gradient = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let prepared = Prepared::new(&Masses(30)).expect("sound");
            let (analysis, x) = (prepared.analysis(), [40.0, 2.0]);
            let forward = analysis.forward(&x).expect("runs");
            analysis.adjoint(&x, &forward).expect("has a gradient")
        })
    };
    let alone = gradient(1);
    assert_eq!(alone.counters.factorizations, 2);
    for threads in [2, 3] {
        assert_eq!(gradient(threads), alone, "{threads} threads");
    }
}
