use crate::tolerances::LONG_SUM;
use nalgebra::{DMatrix, DVector};

/// Weights by which the stages behind an explicit first one make a solution without it: the nearest to `b` in the sum of squares under as
/// many of these conditions as there are such stages: order 1, order 2, bounded and then zero where a decay is infinitely stiff, order 3 with
/// a stage order of 2.
///
/// With A = (0 0; d B) a stiff decay z -> infinity of the value 1 leaves z Y = z Y0 + Y1 + .. in these stages, B Y0 = -d, B Y1 = Y0 - 1, so that
/// the solution is 1 + z w Y0 + w Y1.
pub(super) fn implicit_weights(a: &[Vec<f64>], b: &[f64], c: &[f64]) -> Vec<f64> {
    let count = b.len() - 1;
    let entry = |i: usize, j: usize| a[i + 1].get(j).copied().unwrap_or(0.0);
    let matrix = DMatrix::from_fn(count, count, |i, j| entry(i, j + 1));
    let stages = |right: DVector<f64>| matrix.clone().lu().solve(&right).expect("a triangle with a diagonal");
    let y0 = stages(-DVector::from_fn(count, |i, _| entry(i, 0)));
    let y1 = stages(y0.add_scalar(-1.0));
    let power = |k: i32| DVector::from_fn(count, |i, _| c[i + 1].powi(k));
    let all = [(power(0), 1.0), (power(1), 0.5), (y0, 0.0), (y1, -1.0), (power(2), 1.0 / 3.0)];
    let conditions = &all[..count.min(all.len())];
    let rows = DMatrix::from_fn(conditions.len(), count, |i, j| conditions[i].0[j]);
    let wanted = DVector::from_fn(conditions.len(), |i, _| conditions[i].1);
    let own = DVector::from_column_slice(&b[1..]);
    let missed = wanted - &rows * &own;
    let correction = rows.svd(true, true).solve(&missed, LONG_SUM).expect("both factors are there");
    std::iter::once(0.0).chain((own + correction).iter().copied()).collect()
}
