//! The variational integrator: its orders, what it conserves, and its discrete adjoint against direct differentiation and complex step.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{StepRecord, discrete_momentum};
use costate::internals::{Measured, march, table_named};
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};
use costate::sensitivity::largest_difference;

fn prepared<'s>(scene: &'s dyn AnyScene, name: &str, end: f64, steps: usize) -> Prepared<'s> {
    let mut settings = scene.settings().without_method();
    (settings.end, settings.steps, settings.divide) = (end, steps, false);
    let table = table_named(name).expect("no mistake").expect("listed");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings).expect("prepared")
}

/// All steps of a run.
fn steps(prepared: &Prepared) -> Vec<StepRecord<f64>> {
    let mut all = Vec::new();
    let mut keep = Watch(|step: &StepRecord<f64>| {
        all.push(step.clone());
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut keep).expect("runs");
    all
}

#[test]
fn adjoint_direct_differentiation_and_complex_step_agree() {
    let scenes = [
        ("pendulum", 0.4),
        ("double-pendulum", 0.4),
        ("free-body", 0.4),
        ("heavy-top", 0.2),
        ("five-bar", 0.4),
        ("slider-crank", 0.4),
        // with the point at an end of the step, forces are explicit: stiff members need short steps
        ("flying-rod", 0.02),
        ("flexible-pendulum", 0.008),
    ];
    let mut wrong = Vec::new();
    for (name, end) in scenes {
        let scene = built_in::named(name).expect("built in");
        for alpha in ["0", "0.3", "0.5", "1"] {
            let prepared = prepared(scene, &format!("variational:{alpha}"), end, 20);
            let (analysis, x) = (prepared.analysis(), &prepared.x);
            let forward = match analysis.forward(x) {
                Ok(forward) => forward,
                Err(error) => {
                    wrong.push(format!("{} {alpha}: {error}", scene.name()));
                    continue;
                }
            };
            let adjoint = analysis.adjoint(x, &forward).expect("adjoint");
            let tangent = analysis.tangent(x, &forward).expect("tangent");
            let complex_step = analysis.complex_step(x, &forward).expect("complex step");
            for (k, functional) in prepared.functionals().iter().enumerate() {
                let expected = &complex_step.rows[k];
                let [a, b] = [&adjoint, &tangent].map(|own| largest_difference(&own.rows[k], expected));
                // in 8 ms the tip has moved by 0.3 mm
                let limit = if end == 0.008 { 1e-9 } else { 1e-11 };
                if !(a.max(b) < limit) {
                    wrong.push(format!("{} {alpha} {}: {a:e} {b:e}", scene.name(), functional.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_order_is_two_with_the_point_in_the_middle_and_one_elsewhere() {
    for (name, end) in [("heavy-top", 0.1), ("double-pendulum", 0.5)] {
        let scene = built_in::named(name).expect("built in");
        let last = |name: &str, count: usize| -> [Vec<f64>; 2] {
            let step = steps(&prepared(scene, name, end, count)).pop().expect("steps");
            [step.q, step.v]
        };
        let exact = last("esdirk5", 800);
        for (alpha, order) in [("0.5", 2.0), ("0", 1.0), ("0.3", 1.0), ("1", 1.0)] {
            let errors = [200, 400, 800, 1600].map(|count| {
                let own = last(&format!("variational:{alpha}"), count);
                [0, 1].map(|i| own[i].iter().zip(&exact[i]).fold(0.0, |e: f64, (a, b)| e.max((a - b).abs())))
            });
            for i in 0..2 {
                let observed = (errors[2][i] / errors[3][i]).log2();
                let name = format!("{} {alpha} {}: {errors:?}", scene.name(), ["q", "v"][i]);
                assert!((observed - order).abs() < 0.1, "{name}: {observed}");
            }
        }
    }
}

/// Moment of momentum of a body in world components: p_e = 2 G^T R^T L for unit Euler parameters.
fn moment_of_momentum(q: &[f64], p: &[f64]) -> [f64; 3] {
    let e = Quaternion::from_slice(&q[3..]);
    // d(R s)/de along a turn about a unit vector u is u x R s: e' = (0, u) e / 2
    let turned = |u: [f64; 3]| Quaternion([0.0, u[0], u[1], u[2]]).times(e);
    let spin = |u: [f64; 3]| 0.5 * turned(u).0.iter().zip(&p[3..]).map(|(e, p)| e * p).sum::<f64>();
    [spin([1.0, 0.0, 0.0]), spin([0.0, 1.0, 0.0]), spin([0.0, 0.0, 1.0])]
}

#[test]
fn a_free_body_keeps_its_moment_of_momentum_to_round_off_and_its_energy_without_drift() {
    let prepared = prepared(built_in::named("free-body").expect("built in"), "variational", 200.0, 20_000);
    let problem = prepared.problem();
    let (mut first, mut worst, mut energies) = (None, 0.0_f64, Vec::new());
    let energy = Measured::energy();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let momentum = moment_of_momentum(&step.q, &discrete_momentum(&problem, step));
        let reference = *first.get_or_insert(momentum);
        worst = momentum.iter().zip(reference).fold(worst, |worst, (a, b)| worst.max((a - b).abs()));
        let mut sample = Sample::empty();
        sample.set_stage(step, 0);
        energies.push(energy.value(problem.model, &sample, &problem.p));
        true
    });
    march(&problem, &prepared.method, &prepared.grid, &prepared.plan, &mut watch).expect("runs");
    assert!(worst < 1e-11, "{worst:e}");
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (early, late) = (mean(&energies[..7000]), mean(&energies[13_000..]));
    assert!((early - late).abs() < 1e-6 * early, "{early} {late}");
}

#[test]
fn what_it_cannot_integrate_is_refused_with_the_reason() {
    let refused = table_named("variational:1.5").expect_err("outside the step");
    assert!(refused.contains("from 0 to 1"), "{refused}");
    let scene = built_in::named("flexible-four-bar").expect("built in");
    assert_eq!(prepared(scene, "variational", 0.01, 1).method.constraint_level(), ConstraintLevel::Position);
}
