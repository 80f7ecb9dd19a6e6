//! The variational integrator of Leyendecker, Marsden & Ortiz (2008).

use crate::integrators::{Carried, Combination, Quadrature, Stage, Starter, Table};

pub const NAME: &str = "variational";

/// Place of the quadrature point of `variational` where none is given.
pub const DEFAULT_ALPHA: f64 = 0.5;

/// Discrete Euler-Lagrange equations with one quadrature point at a share `alpha` of the step: symplectic, momenta are kept to
/// round-off; order 2 for alpha = 1/2, else 1.
///
/// It carries q, a velocity for output, and the discrete velocity w = (q_n - q_n-1) / h. With the stage's unknown
/// x = (w' - w) / h, which is the acceleration at the start of the step,
///
/// w' = w + h x,   q' = q + h w',   v' = w' + h/2 x.
///
/// The first step starts from v itself: there x is the acceleration of half a step, and v' = w' + h x.
pub fn variational(name: &str, alpha: f64) -> Table {
    assert!((0.0..=1.0).contains(&alpha), "alpha lies within the step");
    let carried = vec![Carried::Q, Carried::V, Carried::V];
    let of = |first: bool| {
        let velocity = |factor: f64| if first { [0.0, factor, 0.0] } else { [0.0, 0.0, factor] };
        let combine = |carried: [f64; 3], x: f64| Combination { carried: carried.to_vec(), stages: vec![x] };
        let place = |share: f64| {
            let [_, of_v, of_w] = velocity(share);
            [1.0, of_v, of_w]
        };
        let stage = Stage {
            c: alpha,
            a: combine([0.0; 3], if first { 2.0 } else { 1.0 }),
            v: combine(velocity(1.0), 1.0),
            q: combine(place(alpha), alpha),
            known: None,
        };
        let output = combine(velocity(1.0), if first { 2.0 } else { 1.5 });
        Table {
            name: name.into(),
            order: if alpha == DEFAULT_ALPHA { 2 } else { 1 },
            carried: carried.clone(),
            stages: vec![stage],
            update: vec![combine(place(1.0), 1.0), output, combine(velocity(1.0), 1.0)],
            quadrature: Combination { carried: vec![1.0], stages: vec![1.0] },
            aggregate_weights: vec![1.0],
            variational: Some(Quadrature { alpha, first }),
            ..Table::default()
        }
    };
    let starter = Starter { table: Box::new(of(true)), steps: 1 };
    Table { starter: Some(starter), ..of(false) }
}
