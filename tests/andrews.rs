//! The written-out forms of Andrews' squeezer against the energies and the closure that they were written from.

// a study uses the rest
#[allow(dead_code, unused_imports)]
#[path = "../verification/andrews.rs"]
mod squeezer;
mod support;

use costate::elements::{ReactingConstraintIn, lagrangian_residual};
use costate::prelude::*;
use squeezer::{Andrews, WrittenAndrews, WrittenBodies};
use support::Random;

fn largest_apart(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

#[test]
fn the_written_residual_is_that_of_the_energies() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let [a, v, q] = [(); 3].map(|()| random.vector(7));
        let p: Vec<f64> = (0..17).map(|_| random.uniform(0.5, 2.5)).collect();
        let state = State { a: &a, v: &v, q: &q };
        let (mut written, mut derived) = (vec![0.0; 7], vec![0.0; 7]);
        WrittenBodies.residual(state, &p, 0.0, &mut written);
        lagrangian_residual(&WrittenBodies, state, &p, 0.0, &mut derived);
        assert!(largest_apart(&derived, &written) < 1e-13, "{derived:?} {written:?}");
    }
}

#[test]
fn the_written_reaction_is_that_of_the_closure() {
    let mut random = Random::new(2);
    let x: Vec<f64> = Andrews.variables().iter().map(|variable| variable.initial).collect();
    let [derived, written] =
        [&Andrews as &dyn costate::scenes::AnyScene, &WrittenAndrews].map(|scene| scene.build_real(&x).unwrap().model);
    for _ in 0..20 {
        let q = random.vector(7);
        let mu = random.vector(6);
        let [derived, written] = [&derived, &written].map(|model| {
            let mut r = vec![0.0; 7];
            let closure: &dyn ReactingConstraintIn<f64> = &*model.constraints[0].physics;
            closure.add_reaction(&q, &mu, &x[14..25], 0.0, &mut r);
            r
        });
        assert!(largest_apart(&derived, &written) < 1e-13, "{derived:?} {written:?}");
    }
}
