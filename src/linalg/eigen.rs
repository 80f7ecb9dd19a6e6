use faer::{Mat, Side};

/// One eigenvalue of a real matrix with its vector: real parts, then imaginary ones.
#[derive(Clone, Debug)]
pub struct Eigenpair {
    /// Eigenvalue.
    pub value: [f64; 2],
    /// Vector of length one.
    pub vector: [Vec<f64>; 2],
}

/// Largest difference of mirrored entries, as a share of the largest entry, up to which a matrix counts as symmetric.
const SYMMETRIC: f64 = 1e-9;

/// Eigenvalues of a small dense matrix, entry (i, j) being `entry(i, j)`; of a conjugate pair only the one with a positive imaginary
/// part. A symmetric matrix has real ones. `None` if the iteration does not converge, as with numbers that are not finite.
pub fn eigenpairs(size: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<Eigenpair>> {
    let matrix = Mat::from_fn(size, size, &entry);
    let pairs = || (0..size).flat_map(|i| (0..size).map(move |j| (i, j)));
    let largest = pairs().fold(0.0, |most: f64, (i, j)| most.max(entry(i, j).abs()));
    let skew = pairs().fold(0.0, |most: f64, (i, j)| most.max((entry(i, j) - entry(j, i)).abs()));
    if skew <= SYMMETRIC * largest {
        let symmetric = Mat::from_fn(size, size, |i, j| 0.5 * (entry(i, j) + entry(j, i)));
        let found = symmetric.self_adjoint_eigen(Side::Lower).ok()?;
        let (values, vectors) = (found.S().column_vector(), found.U());
        let pair = |k: usize| Eigenpair {
            value: [values[k], 0.0],
            vector: [(0..size).map(|i| vectors[(i, k)]).collect(), vec![0.0; size]],
        };
        return Some((0..size).map(pair).collect());
    }
    let found = matrix.eigen().ok()?;
    let (values, vectors) = (found.S().column_vector(), found.U());
    let pair = |k: usize| Eigenpair {
        value: [values[k].re, values[k].im],
        vector: [(0..size).map(|i| vectors[(i, k)].re).collect(), (0..size).map(|i| vectors[(i, k)].im).collect()],
    };
    Some((0..size).filter(|&k| values[k].im >= 0.0).map(pair).collect())
}

#[cfg(test)]
mod tests {
    use super::eigenpairs;

    #[test]
    fn symmetric_and_rotating_matrices_have_the_values_in_closed_form() {
        let symmetric = [[2.0, 1.0], [1.0, 2.0]];
        let mut values: Vec<f64> = eigenpairs(2, |i, j| symmetric[i][j]).unwrap().iter().map(|pair| pair.value[0]).collect();
        values.sort_by(f64::total_cmp);
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15, "{values:?}");
        // a + i b
        let turning = [[0.5, -2.0], [2.0, 0.5]];
        let pairs = eigenpairs(2, |i, j| turning[i][j]).unwrap();
        assert_eq!(pairs.len(), 1);
        let [re, im] = pairs[0].value;
        assert!((re - 0.5).abs() < 1e-15 && (im - 2.0).abs() < 1e-15, "{re} {im}");
    }
}
