//! Work counts and threads: lost efficiency turns red without a clock, and results do not depend on the number of threads.

use costate::design::DesignVariable;
use costate::scenes::{AnyScene, Prepared, Settings, built_in};

fn scene(name: &str) -> Box<dyn AnyScene> {
    built_in::all().into_iter().find(|scene| scene.scene_name() == name).expect("a built-in scene")
}

fn prepared<'s>(scene: &'s dyn AnyScene, end: f64, steps: usize) -> Prepared<'s> {
    let x: Vec<f64> = scene.design_variables().iter().map(|variable: &DesignVariable| variable.initial).collect();
    let settings = Settings { end, steps, ..scene.default_settings() };
    Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene")
}

#[test]
fn newton_needs_few_iterations_and_few_factorizations() {
    let scene = scene("five-bar");
    let prepared = prepared(&*scene, 0.5, 50);
    let forward = prepared.analysis().forward(&prepared.x).expect("runs");
    let counters = forward.counters;
    // three stages and two projections a step, and the first acceleration
    assert_eq!(counters.systems, 5 * 50 + 1);
    assert!(counters.iterations <= 7 * counters.systems, "{counters:?}");
    assert!(counters.factorizations <= 15, "{counters:?}");
}

#[test]
fn the_adjoint_takes_one_factorization_a_system_and_shares_it_between_functionals() {
    let scene = scene("pendulum");
    let prepared = prepared(&*scene, 0.5, 50);
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("runs");
    let counters = analysis.adjoint(&prepared.x, &forward).expect("has a gradient").counters;
    assert_eq!(counters.factorizations, counters.systems);
    let functionals = prepared.functionals().len();
    assert!(
        functionals > 1 && counters.solves > counters.factorizations && counters.solves <= functionals * counters.systems
    );
    assert_eq!(counters.products, counters.solves);
}

#[test]
fn one_and_many_threads_give_the_same_bits() {
    let scene = scene("chain-common");
    let prepared = prepared(&*scene, 0.02, 4);
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
