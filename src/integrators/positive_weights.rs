use crate::tolerances::LONG_SUM;
use nalgebra::{DMatrix, DVector};

/// Weights of a step's stages at the times `c`, none negative, that integrate polynomials as well as the weights `b` of a method of this order do, and
/// are the nearest to `b` in the sum of squares; `b` itself where nothing in it is negative.
///
/// Where there are no such weights, as for the three stages of `sdirk3`, the polynomials' degree is lowered.
pub(super) fn positive_weights(b: &[f64], c: &[f64], order: usize) -> Vec<f64> {
    if b.iter().all(|&weight| weight >= 0.0) {
        return b.to_vec();
    }
    let nearest = (1..=order).rev().find_map(|conditions| nearest(b, c, conditions));
    nearest.unwrap_or_else(|| vec![1.0 / b.len() as f64; b.len()])
}

/// The nearest weights that are not negative and integrate 1, t, t^2, ... as far as there are conditions: the stages that have a weight are tried out, and
/// the optimum is one of those.
fn nearest(b: &[f64], c: &[f64], conditions: usize) -> Option<Vec<f64>> {
    let distance = |weights: &[f64]| weights.iter().zip(b).map(|(weight, b)| (weight - b).powi(2)).sum::<f64>();
    let supports =
        (1_u32..1 << b.len()).map(|bits| (0..b.len()).filter(|&stage| bits >> stage & 1 == 1).collect::<Vec<_>>());
    let candidates = supports.filter_map(|support| on_support(b, c, conditions, &support));
    candidates.min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// The nearest weights of some stages, the others without one: w = b + C^T lambda with C w = (1, 1/2, 1/3, ...), C the powers of `c`.
fn on_support(b: &[f64], c: &[f64], conditions: usize, support: &[usize]) -> Option<Vec<f64>> {
    let powers = DMatrix::from_fn(conditions, support.len(), |power, own| c[support[own]].powi(power as i32));
    let wanted = DVector::from_fn(conditions, |power, _| 1.0 / (power + 1) as f64);
    let own = DVector::from_fn(support.len(), |own, _| b[support[own]]);
    let missed = &wanted - &powers * &own;
    let correction = powers.clone().svd(true, true).solve(&missed, LONG_SUM).ok()?;
    let weights = own + correction;
    if (&powers * &weights - wanted).amax() > LONG_SUM || weights.min() < 0.0 {
        return None;
    }
    let mut all = vec![0.0; b.len()];
    support.iter().zip(weights.iter()).for_each(|(&stage, &weight)| all[stage] = weight);
    Some(all)
}

#[cfg(test)]
mod tests {
    use crate::integrators::tables::table_by_name;

    /// Of each method with stages: nothing negative, and polynomials below its order are integrated.
    #[test]
    fn weights_of_aggregates_are_positive_and_of_the_methods_order() {
        for (name, changed) in
            [("midpoint", false), ("dirk3", false), ("esdirk3", true), ("esdirk4", true), ("esdirk5", true)]
        {
            let table = table_by_name(name).expect("a method");
            let (weights, b) = (&table.aggregate_weights, &table.quadrature.stages);
            assert_eq!(weights != b, changed, "{name}: {weights:?}");
            assert!(weights.iter().all(|&weight| weight >= 0.0), "{name}: {weights:?}");
            for power in 0..table.order {
                let sum: f64 = weights.iter().zip(&table.stages).map(|(w, stage)| w * stage.c.powi(power as i32)).sum();
                let exact = 1.0 / (power + 1) as f64;
                assert!((sum - exact).abs() < 1e-13, "{name}: t^{power} gives {sum}, {exact} is exact");
            }
        }
    }

    /// Two stages at the same end of a step cannot integrate t: the constant is left.
    #[test]
    fn weights_that_cannot_be_positive_integrate_a_constant() {
        let weights = super::positive_weights(&[2.0, -1.0], &[0.9, 1.0], 2);
        assert!(
            weights.iter().all(|&weight| weight >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-15,
            "{weights:?}"
        );
    }
}
