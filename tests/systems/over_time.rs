//! Sensitivities at every step: direct differentiation against complex step, the adjoint of a run that ends there, and the run's own values.

use costate::functionals::Over;
use costate::internals::table_named;
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};

fn prepared<'s>(scene: &'s dyn AnyScene, method: &str, end: f64, steps: usize) -> Prepared<'s> {
    let mut settings = scene.settings().without_method();
    (settings.end, settings.steps) = (end, steps);
    let table = table_named(method).expect("no mistake").expect("listed");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings).expect("prepared")
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

#[test]
fn derivatives_over_time_are_those_of_complex_step_and_of_the_adjoint_of_shorter_runs() {
    for (name, h) in [("five-bar", 0.01), ("flexible-pendulum", 0.0025)] {
        let scene = built_in::named(name).expect("built in");
        for method in ["esdirk4", "variational", "bdf2"] {
            let steps = 60;
            let whole = prepared(scene, method, h * steps as f64, steps);
            let (analysis, x) = (whole.analysis(), &whole.x);
            let forward = analysis.forward(x).expect("runs");
            let tangent = analysis.tangent_over_time(x, &forward).expect("runs");
            let complex = analysis.complex_step_over_time(x, &forward).expect("runs");
            assert_eq!(tangent.times, complex.times);
            // complex numbers divide by another formula: the last digits of functionals differ
            for (real, complex) in tangent.values.iter().zip(&complex.values) {
                let apart = real.iter().zip(complex).map(|(a, b)| a - b).collect::<Vec<_>>();
                assert!(largest(&apart) <= 1e-14 * largest(real), "{}, {method}: {:e}", scene.name(), largest(&apart));
            }
            assert_eq!(tangent.times.len(), steps + 1);
            for (k, functional) in whole.functionals().iter().enumerate() {
                let what = format!("{}, {method}, {}", scene.name(), functional.name);
                for variable in 0..x.len() {
                    let (own, exact) = (&tangent.derivatives[k][variable], &complex.derivatives[k][variable]);
                    let apart = own.iter().zip(exact).map(|(a, b)| a - b).collect::<Vec<_>>();
                    assert!(largest(&apart) <= 1e-12 * largest(exact), "{what}, {variable}: {:e}", largest(&apart));
                }
                if functional.over == Over::Terminal {
                    // num-dual divides by the reciprocal: the last digit may differ
                    let (own, real) = (tangent.values[k][steps], forward.values[k]);
                    assert!((own - real).abs() <= 1e-15 * real.abs(), "{what}: {own:e}, {real:e}");
                }
            }
            for ends in [20, 40, 60] {
                let part = prepared(scene, method, h * ends as f64, ends);
                let forward = part.analysis().forward(x).expect("runs");
                let adjoint = part.analysis().adjoint(x, &forward).expect("has a gradient");
                for (k, functional) in part.functionals().iter().enumerate() {
                    if functional.over != Over::Terminal {
                        continue;
                    }
                    for variable in 0..x.len() {
                        let course = &tangent.derivatives[k][variable];
                        let apart = (course[ends] - adjoint.rows[k][variable]).abs();
                        let what = format!("{}, {method}, {}, {variable}", scene.name(), functional.name);
                        // two runs of the same steps: times and with them last digits differ
                        assert!(apart <= 1e-10 * largest(course), "{what}: {apart:e}");
                    }
                }
            }
        }
    }
}
