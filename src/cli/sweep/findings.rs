//! What a sweep shows of a functional: its extremes, and how it follows the variables.

/// A functional over all designs that could be simulated.
pub struct Findings {
    /// Least and largest value with the places of their designs; the first of equal ones.
    pub extremes: [(f64, usize); 2],
    pub mean: f64,
    /// Rank correlation with each variable that varies.
    pub correlations: Vec<f64>,
}

impl Findings {
    /// Of the values at some designs, given by their places, and of the variables there; `None` without a design.
    pub fn of(values: &[(usize, f64)], variables: &[Vec<f64>]) -> Option<Self> {
        let by_size = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
        let least = values.iter().min_by(by_size)?;
        let largest = values.iter().rev().max_by(by_size)?;
        let own: Vec<f64> = values.iter().map(|value| value.1).collect();
        let ranks_of_values = ranks(&own);
        Some(Findings {
            extremes: [least, largest].map(|&(place, value)| (value, place)),
            mean: own.iter().sum::<f64>() / own.len() as f64,
            correlations: variables.iter().map(|variable| correlation(&ranks(variable), &ranks_of_values)).collect(),
        })
    }
}

/// Share of the largest size below which a difference is taken for round-off.
const TIE: f64 = 1e-10;

/// Ranks of values from the least on; equal ones share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let tie = TIE * values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|&a, &b| values[b] - values[a] <= tie) {
        let mean = first as f64 + 0.5 * (equal.len() - 1) as f64;
        equal.iter().for_each(|&place| ranks[place] = mean);
        first += equal.len();
    }
    ranks
}

/// Correlation of ranks, NaN where one does not vary: Spearman's
///
/// rho = sum (r - mean) (s - mean) / sqrt(sum (r - mean)^2 sum (s - mean)^2)
///
/// Source: Spearman (1904); Kendall & Gibbons (1990), chapter 1, with ties.
fn correlation(r: &[f64], s: &[f64]) -> f64 {
    let mean = 0.5 * (r.len() as f64 - 1.0);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    let scale = (product(r, r) * product(s, s)).sqrt();
    if scale > 0.0 { product(r, s) / scale } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rank_correlation_is_one_for_what_grows_together_and_that_of_ties_is_kendalls() {
        let x: Vec<f64> = (1..=9).map(f64::from).collect();
        let of = |values: &[f64]| correlation(&ranks(&x), &ranks(values));
        let values = |f: fn(f64) -> f64| x.iter().map(|&x| f(x)).collect::<Vec<f64>>();
        assert_eq!(of(&values(f64::exp)), 1.0);
        assert_eq!(of(&values(|x| 1.0 / x)), -1.0);
        assert_eq!(of(&values(|x| (x - 5.0).powi(2))), 0.0, "what turns in the middle goes nowhere");
        assert!(of(&values(|x| 2.0 + 1e-15 * x)).is_nan(), "round-off");
        // pairs share the ranks 0.5, 2.5, 4.5, 6.5 of 0 ... 7: rho^2 = 1 - (8 / 4) / (sum of (r - 3.5)^2 = 42)
        let pairs: Vec<f64> = (0..8).map(|k| f64::from(k / 2)).collect();
        let all: Vec<f64> = (0..8).map(f64::from).collect();
        let rho = correlation(&ranks(&all), &ranks(&pairs));
        assert!((rho * rho - (1.0 - 2.0 / 42.0)).abs() < 1e-14, "{rho}");
    }

    #[test]
    fn the_first_of_equal_extremes_is_named() {
        let found = Findings::of(&[(3, 1.0), (4, 2.0), (7, 1.0), (9, 2.0)], &[]).expect("designs");
        assert_eq!(found.extremes, [(1.0, 3), (2.0, 4)]);
        assert_eq!(found.mean, 1.5);
    }
}
