//! Every solver of linear systems gives the same motion and the same gradient.

use costate::linalg::Backend;
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::built_in::FiveBar;

/// Values and gradients of a scene, with the solver that was used.
fn results(scene: &dyn AnyScene, settings: Settings, backend: Backend) -> (Backend, Vec<Vec<f64>>) {
    let x: Vec<f64> = scene.design_variables().iter().map(|variable| variable.initial).collect();
    let method = Method { backend, ..Prepared::method_of(&settings).expect("a method") };
    let prepared = Prepared::with(scene, &x, method, settings).expect("a scene");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).expect("a run");
    let gradient = analysis.adjoint(&x, &forward).expect("a gradient");
    let plan = prepared.linear_solver().expect("a solver");
    (plan.backend, std::iter::once(forward.values).chain(gradient.rows).collect())
}

#[test]
fn gradients_are_the_same_whatever_solves_the_systems() {
    let scene = FiveBar.as_ref();
    let settings = scene.default_settings();
    let settings = Settings { end: 20.0 * settings.end / settings.steps as f64, steps: 20, ..settings };
    let (_, expected) = results(scene, settings, Backend::Automatic);
    for backend in Backend::ALL.into_iter().skip(1) {
        let (used, own) = results(scene, settings, backend);
        assert_eq!(used, backend);
        for (own, expected) in own.iter().zip(&expected) {
            let difference = largest_difference(expected, own);
            assert!(difference < 1e-12, "{}: {difference:e}", backend.name());
        }
    }
}
