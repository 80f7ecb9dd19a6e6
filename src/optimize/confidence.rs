//! How exactly variables are known from measurements.

use crate::tolerances::SAME_DERIVATIVE;
use nalgebra::DMatrix;

/// What the measurements say of the variables beside their values: to first order in the errors of these, which are normally distributed.
///
/// The covariance is (J^T J)^-1 with the Jacobian J of the residuals in units of their deviations; where no deviations are given, times the variance of
/// the residuals. That is SciPy's `curve_fit` with and without `absolute_sigma`. Rows count by the curvature of their loss: outliers tell nothing.
/// Variables at a bound are taken as known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Confidence {
    /// Places of the variables that are estimated among those that vary: all but those at a bound.
    pub estimated: Vec<usize>,
    /// Covariance of these; infinite for a variable that is not determined.
    pub covariance: Vec<Vec<f64>>,
    /// Combinations of them, from the least to the best determined.
    pub combinations: Vec<Combined>,
    /// By what the squares of deviations were multiplied.
    pub variance: f64,
}

/// A sum of changes of variables, each by its size, of which all squares sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Combined {
    /// Coefficients of the variables that are estimated.
    pub coefficients: Vec<f64>,
    /// Its standard deviation; infinite where no measurement changes with it.
    pub deviation: f64,
}

/// Coefficients below this are those of other variables.
const NO_PART: f64 = 1e-6;

impl Confidence {
    /// From the Jacobian by all variables that vary, their sizes, those that are estimated, and the variance of residuals in units of deviations.
    pub(super) fn new(jacobian: &DMatrix<f64>, sizes: &[f64], estimated: Vec<usize>, variance: f64) -> Self {
        let count = estimated.len();
        if count == 0 {
            return Confidence { variance, ..Confidence::default() };
        }
        let mut scaled = jacobian.select_columns(&estimated);
        for (mut column, &variable) in scaled.column_iter_mut().zip(&estimated) {
            column *= sizes[variable];
        }
        // the triangle has the singular values and right vectors of the whole
        let svd = scaled.qr().r().svd(false, true);
        let largest = svd.singular_values.max();
        let deviation = |singular: f64| match singular > SAME_DERIVATIVE * largest {
            true => variance.sqrt() / singular,
            false => f64::INFINITY,
        };
        let mut combinations: Vec<Combined> = Vec::new();
        if let Some(vectors) = &svd.v_t {
            for (row, &singular) in vectors.row_iter().zip(svd.singular_values.iter()) {
                let leading =
                    row.iter().copied().fold(0.0, |most: f64, own| if own.abs() > most.abs() { own } else { most });
                let coefficients = row.iter().map(|own| own * leading.signum()).collect();
                combinations.push(Combined { coefficients, deviation: deviation(singular) });
            }
        }
        combinations.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
        let entry = |i: usize, j: usize| {
            let term = |own: &Combined| match own.coefficients[i] * own.coefficients[j] {
                product if own.deviation.is_finite() => product * own.deviation.powi(2),
                _ if own.coefficients[i].abs() > NO_PART && own.coefficients[j].abs() > NO_PART => f64::INFINITY,
                _ => 0.0,
            };
            sizes[estimated[i]] * sizes[estimated[j]] * combinations.iter().map(term).sum::<f64>()
        };
        let covariance = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
        Confidence { estimated, covariance, combinations, variance }
    }

    /// Standard deviation of the variable at a place among those that are estimated.
    pub fn deviation(&self, place: usize) -> f64 {
        self.covariance[place][place].sqrt()
    }

    /// Correlation of two of them.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[i][j] / (self.deviation(i) * self.deviation(j))
    }

    /// Standard deviation of a number by its derivatives by all variables that vary.
    pub(super) fn of_number(&self, derivatives: &[f64], sizes: &[f64]) -> f64 {
        let along = |own: &Combined| -> f64 {
            let terms = self.estimated.iter().zip(&own.coefficients);
            terms.map(|(&variable, coefficient)| derivatives[variable] * sizes[variable] * coefficient).sum()
        };
        // no number that was measured changes with what is not determined
        let determined = self.combinations.iter().filter(|own| own.deviation.is_finite());
        determined.map(|own| (along(own) * own.deviation).powi(2)).sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_points_has_the_covariance_of_textbooks() {
        // y = a + b t with deviations 0.1: s^2 / n (1 + 3 mean^2 / spread) and so on
        let times: Vec<f64> = (0..20).map(|k| 0.5 * f64::from(k)).collect();
        let jacobian = DMatrix::from_fn(20, 2, |i, j| [1.0, times[i]][j] / 0.1);
        let own = Confidence::new(&jacobian, &[3.0, 1e-4], vec![0, 1], 1.0);
        let (count, mean) = (20.0, times.iter().sum::<f64>() / 20.0);
        let spread: f64 = times.iter().map(|t| (t - mean).powi(2)).sum();
        let expected = [[0.01 * (1.0 / count + mean * mean / spread), -0.01 * mean / spread], [0.0, 0.01 / spread]];
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            assert!((own.covariance[i][j] / expected[i][j] - 1.0).abs() < 1e-12, "{own:?}");
        }
        let of_value = own.of_number(&[1.0, 2.0], &[3.0, 1e-4]);
        let exact = (expected[0][0] + 4.0 * expected[0][1] + 4.0 * expected[1][1]).sqrt();
        assert!((of_value / exact - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_told_apart_is_a_combination_without_a_deviation() {
        // the first two count by their ratio alone, the third by itself
        let jacobian = DMatrix::from_fn(5, 3, |i, j| (i + 1) as f64 * [0.5, -0.1, 0.0][j] + [0.0, 0.0, 1.0][j]);
        let own = Confidence::new(&jacobian, &[2.0, 10.0, 1.0], vec![0, 1, 2], 1.0);
        let Combined { coefficients, deviation } = &own.combinations[0];
        let expected = [0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0];
        assert!(deviation.is_infinite() && coefficients.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(own.deviation(0).is_infinite() && own.deviation(1).is_infinite() && own.deviation(2).is_finite());
        assert!(own.combinations[1].deviation.is_finite());
    }
}
