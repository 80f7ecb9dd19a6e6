//! Backward differentiation: one stage at the end of the step, and the states of several steps before.

use super::esdirk::esdirk3;
use crate::integrators::{Carried, Combination, Stage, Starter, Table};

/// Backward differentiation formula of `order` 1 to 3 for steps of equal size; order 1 is the implicit Euler rule.
///
/// y_{n+1} = sum alpha_j y_{n-j} + h beta y'_{n+1} for y = q and y = v. The first steps, and those after a breakpoint or a change of
/// size, are made by a one-step method.
///
/// # Panics
/// For other orders, or if the coefficients miss the order.
pub fn bdf(order: usize) -> Table {
    let (name, alpha, beta): (&str, &[f64], f64) = match order {
        1 => ("bdf1", &[1.0], 1.0),
        2 => ("bdf2", &[4.0 / 3.0, -1.0 / 3.0], 2.0 / 3.0),
        3 => ("bdf3", &[18.0 / 11.0, -9.0 / 11.0, 2.0 / 11.0], 6.0 / 11.0),
        _ => panic!("backward differentiation is listed for orders 1 to 3, not {order}"),
    };
    for power in 0..=order as i32 {
        // exact for t^power, with the old points at 0, -1, -2 and the new one at 1
        let old: f64 = alpha.iter().enumerate().map(|(j, alpha)| alpha * f64::powi(-(j as f64), power)).sum();
        let defect = old + beta * f64::from(power) - 1.0;
        assert!(defect.abs() < 1e-14, "{name}: t^{power} is missed by {defect:e}");
    }

    // q, v, the last acceleration (for the starter), then older pairs of q and v
    let mut carried = vec![Carried::Q, Carried::V, Carried::A];
    carried.extend([Carried::Q, Carried::V].repeat(order - 1));
    let place = |kind: Carried, age: usize| match (kind, age) {
        (Carried::Q, 0) => 0,
        (Carried::V, 0) => 1,
        (Carried::Q, age) => 1 + 2 * age,
        (_, age) => 2 + 2 * age,
    };
    let combine = |terms: &[(usize, f64)], new: f64| {
        let mut combination = Combination { carried: vec![0.0; carried.len()], stages: vec![new] };
        terms.iter().for_each(|(place, factor)| combination.carried[*place] += factor);
        combination
    };
    let of = |kind: Carried, factor: f64| -> Vec<(usize, f64)> {
        alpha.iter().enumerate().map(|(age, alpha)| (place(kind, age), factor * alpha)).collect()
    };
    let v = combine(&of(Carried::V, 1.0), beta);
    let q = combine(&[of(Carried::Q, 1.0), of(Carried::V, beta)].concat(), beta * beta);
    let a = combine(&[], 1.0);
    let mut update = vec![q.clone(), v.clone(), a.clone()];
    for age in 1..order {
        update.extend([Carried::Q, Carried::V].map(|kind| combine(&[(place(kind, age - 1), 1.0)], 0.0)));
    }
    let starter = (order > 1)
        .then(|| Starter { table: Box::new(esdirk3().into_table().carrying(&carried, &update)), steps: order - 1 });
    Table {
        name: name.into(),
        order,
        stages: vec![Stage { c: 1.0, a, v, q, known: None }],
        update,
        quadrature: Combination { carried: alpha.to_vec(), stages: vec![beta] },
        aggregate_weights: vec![beta],
        stiffly_accurate: true,
        starter,
        carried,
        ..Table::default()
    }
}
