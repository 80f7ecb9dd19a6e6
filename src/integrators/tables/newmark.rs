//! One stage at the end of the step, and the acceleration of the step before.

use crate::integrators::{Butcher, Carried, Combination, Stage, Table};

/// Spectral radius of `generalized-alpha` where none is given.
pub const DEFAULT_RADIUS: f64 = 0.8;

/// Average acceleration (Newmark 1959, beta = 1/4, gamma = 1/2), which is the trapezoidal rule: order 2, A-stable, undamped.
pub fn newmark() -> Table {
    let b = vec![0.5, 0.5];
    let a = vec![vec![0.0], b.clone()];
    Butcher { name: "newmark".into(), order: 2, stage_order: 2, a, b, ..Butcher::default() }.into_table()
}

/// Generalized-alpha (Chung & Hulbert 1993; Arnold & Bruls 2007): order 2, at high frequency a step multiplies by the spectral
/// radius.
///
/// (1 - am) alpha' + am alpha = (1 - af) a' + af a,  q' = q + h v + h^2 ((1/2 - beta) alpha + beta alpha'),
/// v' = v + h ((1 - gamma) alpha + gamma alpha'); equations of motion and constraints hold for (a', v', q') at the end of the
/// step. The algorithmic acceleration alpha starts as the acceleration.
pub fn generalized_alpha(name: &str, radius: f64) -> Table {
    let (am, af) = ((2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0));
    let gamma = 0.5 + af - am;
    let beta = (gamma + 0.5) * (gamma + 0.5) / 4.0;
    let carried = vec![Carried::Q, Carried::V, Carried::A, Carried::A];
    // alpha' in terms of a, alpha, a'
    let (of_old, of_alpha, of_new) = (af / (1.0 - am), -am / (1.0 - am), (1.0 - af) / (1.0 - am));
    let combine = |carried: [f64; 4], new: f64| Combination { carried: carried.to_vec(), stages: vec![0.0, new] };
    let q = combine([1.0, 1.0, beta * of_old, 0.5 - beta + beta * of_alpha], beta * of_new);
    let v = combine([0.0, 1.0, gamma * of_old, 1.0 - gamma + gamma * of_alpha], gamma * of_new);
    let a = combine([0.0; 4], 1.0);
    let alpha = combine([0.0, 0.0, of_old, of_alpha], of_new);
    let given = |carried: [f64; 4]| combine(carried, 0.0);
    let start = Stage {
        c: 0.0,
        a: given([0.0, 0.0, 1.0, 0.0]),
        v: given([0.0, 1.0, 0.0, 0.0]),
        q: given([1.0, 0.0, 0.0, 0.0]),
        known: Some(2),
    };
    let end = Stage { c: 1.0, a: a.clone(), v: v.clone(), q: q.clone(), known: None };
    Table {
        name: name.into(),
        order: 2,
        carried,
        stages: vec![start, end],
        update: vec![q, v, a, alpha],
        quadrature: Combination { carried: vec![1.0], stages: vec![0.5, 0.5] },
        aggregate_weights: vec![0.5, 0.5],
        stiffly_accurate: true,
        radius_at_infinity: radius,
        ..Table::default()
    }
}
