//! Equilibria under a load that grows with time.

use crate::integrators::{Carried, Combination, Stage, Table};

/// One equilibrium at the end of each step, R(0, 0, q, p, t) + A^T mu = 0 with g(q, p, t) = 0: time is the load factor of whatever
/// depends on it.
///
/// q' = q + h^2 x, and velocities are zero. An integral over the load factor takes the end of each step: order 1.
pub fn statics() -> Table {
    let combine = |q: f64, x: f64| Combination { carried: vec![q, 0.0], stages: vec![x] };
    let (still, q) = (combine(0.0, 0.0), combine(1.0, 1.0));
    Table {
        name: "static".into(),
        order: 1,
        carried: vec![Carried::Q, Carried::V],
        stages: vec![Stage { c: 1.0, a: still.clone(), v: still.clone(), q: q.clone(), known: None }],
        update: vec![q, still],
        quadrature: Combination { carried: vec![1.0], stages: vec![1.0] },
        aggregate_weights: vec![1.0],
        stiffly_accurate: true,
        ..Table::default()
    }
}
