// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use nalgebra::{DMatrix, DVector, Schur, SymmetricEigen};
use num_complex::Complex64;

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

/// Iterations per eigenvalue before an attempt is given up; most take two or three.
const ITERATIONS: usize = 40;
/// Attempts with a matrix in different coordinates: the shifts of the QR iteration move nothing where, say, unknowns only change places.
const ATTEMPTS: usize = 4;

/// Eigenvalues of a small dense matrix, entry (i, j) being `entry(i, j)`; of a conjugate pair only the one with a positive imaginary
/// part. A symmetric matrix has real ones, the smallest first. `None` if the iteration does not converge, and with numbers that are
/// not finite.
///
/// Where a matrix has fewer vectors than values, the vectors of equal values are nearly the same.
pub fn eigenpairs(size: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<Eigenpair>> {
    let matrix = DMatrix::from_fn(size, size, entry);
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    if size == 0 {
        return Some(Vec::new());
    }
    let largest = matrix.amax();
    if (&matrix - matrix.transpose()).amax() <= SYMMETRIC * largest {
        return symmetric_eigenpairs(0.5 * (&matrix + matrix.transpose()));
    }
    (0..ATTEMPTS).find_map(|attempt| {
        let turn = reflection(size, attempt);
        let schur = Schur::try_new(&turn * &matrix * &turn, f64::EPSILON, ITERATIONS * size)?;
        let (vectors, triangle) = schur.unpack();
        quasi_triangular_eigenpairs(turn * vectors, &triangle)
    })
}

fn symmetric_eigenpairs(matrix: DMatrix<f64>) -> Option<Vec<Eigenpair>> {
    let size = matrix.nrows();
    let found = SymmetricEigen::try_new(matrix, f64::EPSILON, ITERATIONS * size)?;
    let pair = |(value, vector): (&f64, nalgebra::DVectorView<'_, f64>)| Eigenpair {
        value: [*value, 0.0],
        vector: [vector.iter().copied().collect(), vec![0.0; size]],
    };
    let mut pairs: Vec<_> = found.eigenvalues.iter().zip(found.eigenvectors.column_iter()).map(pair).collect();
    pairs.sort_by(|a, b| a.value[0].total_cmp(&b.value[0]));
    pairs.iter().all(is_finite).then_some(pairs)
}

/// I - 2 w w^T with a vector w of length one that each attempt has its own of; the identity at first.
fn reflection(size: usize, attempt: usize) -> DMatrix<f64> {
    let mut turn = DMatrix::identity(size, size);
    if attempt > 0 {
        let direction =
            DVector::from_fn(size, |i, _| ((1.0 + i as f64) * (1.3 + 0.7 * attempt as f64)).sin() + 0.1).normalize();
        turn.ger(-2.0, &direction, &direction, 1.0);
    }
    turn
}

/// Pairs of Q T Q^T, T being upper triangular but for blocks of two rows.
fn quasi_triangular_eigenpairs(vectors: DMatrix<f64>, triangle: &DMatrix<f64>) -> Option<Vec<Eigenpair>> {
    let size = triangle.nrows();
    let mut vectors = vectors.map(Complex64::from);
    let mut t = triangle.map(Complex64::from);
    let mut wanted = Vec::with_capacity(size);
    let mut k = 0;
    while k < size {
        if k + 1 == size || triangle[(k + 1, k)] == 0.0 {
            wanted.push(k);
            k += 1;
            continue;
        }
        let (half_difference, product) =
            (0.5 * (triangle[(k, k)] - triangle[(k + 1, k + 1)]), triangle[(k, k + 1)] * triangle[(k + 1, k)]);
        let mean = 0.5 * (triangle[(k, k)] + triangle[(k + 1, k + 1)]);
        let discriminant = half_difference * half_difference + product;
        let root = Complex64::from(discriminant).sqrt();
        split_block(&mut t, &mut vectors, k, [mean + root, mean - root]);
        wanted.push(k);
        if discriminant >= 0.0 {
            wanted.push(k + 1);
        }
        k += 2;
    }
    let pairs: Vec<_> = wanted.into_iter().map(|k| eigenpair(&vectors, &t, k)).collect();
    pairs.iter().all(is_finite).then_some(pairs)
}

/// Makes a block of two rows triangular, with given eigenvalues on the diagonal: T <- G^H T G, Q <- Q G.
fn split_block(t: &mut DMatrix<Complex64>, vectors: &mut DMatrix<Complex64>, k: usize, values: [Complex64; 2]) {
    // the first column of G is the vector of the first value
    let (first, second) = (values[0] - t[(k + 1, k + 1)], t[(k + 1, k)]);
    let length = first.norm().hypot(second.norm());
    let (first, second) = (first / length, second / length);
    let size = t.nrows();
    for column in k..size {
        let (upper, lower) = (t[(k, column)], t[(k + 1, column)]);
        t[(k, column)] = first.conj() * upper + second.conj() * lower;
        t[(k + 1, column)] = first * lower - second * upper;
    }
    for matrix in [&mut *t, vectors] {
        for row in 0..size {
            let (left, right) = (matrix[(row, k)], matrix[(row, k + 1)]);
            matrix[(row, k)] = left * first + right * second;
            matrix[(row, k + 1)] = right * first.conj() - left * second.conj();
        }
    }
    t[(k, k)] = values[0];
    t[(k + 1, k + 1)] = values[1];
    t[(k + 1, k)] = Complex64::ZERO;
}

/// The pair number `k` of Q T Q^H with a triangular T: (T - lambda I) x = 0 with x_k = 1 and zeros below, v = Q x.
fn eigenpair(vectors: &DMatrix<Complex64>, t: &DMatrix<Complex64>, k: usize) -> Eigenpair {
    /// Entries of a vector are kept below this; without a limit those of equal values would overflow.
    const LARGE: f64 = 1e100;
    let value = t[(k, k)];
    // differences of equal values are round-off
    let least = (f64::EPSILON * t.iter().fold(0.0, |most: f64, entry| most.max(entry.norm()))).max(f64::MIN_POSITIVE);
    let mut x = vec![Complex64::ZERO; k + 1];
    x[k] = Complex64::ONE;
    for i in (0..k).rev() {
        let sum: Complex64 = (i + 1..=k).map(|j| t[(i, j)] * x[j]).sum();
        let difference = value - t[(i, i)];
        x[i] = sum / if difference.norm() < least { Complex64::from(least) } else { difference };
        let size = x[i].norm();
        if size > LARGE {
            x.iter_mut().for_each(|x| *x /= size);
        }
    }
    let size = x.iter().fold(0.0, |sum: f64, x| sum.hypot(x.norm()));
    let at = |row: usize| (0..=k).map(|j| vectors[(row, j)] * x[j]).sum::<Complex64>() / size;
    let vector: Vec<Complex64> = (0..t.nrows()).map(at).collect();
    Eigenpair {
        value: [value.re, value.im],
        vector: [vector.iter().map(|x| x.re).collect(), vector.iter().map(|x| x.im).collect()],
    }
}

fn is_finite(pair: &Eigenpair) -> bool {
    pair.value.iter().chain(pair.vector.iter().flatten()).all(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::{Eigenpair, eigenpairs};

    /// Largest entry of A v - lambda v, and the difference of the length of v from one.
    fn residual(matrix: &[Vec<f64>], pair: &Eigenpair) -> f64 {
        let ([re, im], [x, y]) = (pair.value, &pair.vector);
        let length = x.iter().chain(y).fold(0.0, |sum: f64, part| sum.hypot(*part));
        let times = |row: &[f64], vector: &[f64]| row.iter().zip(vector).map(|(a, v)| a * v).sum::<f64>();
        let rows = matrix.iter().enumerate().map(|(i, row)| {
            (times(row, x) - re * x[i] + im * y[i]).abs().max((times(row, y) - re * y[i] - im * x[i]).abs())
        });
        rows.fold((length - 1.0).abs(), f64::max)
    }

    /// Pairs whose residuals are as small as round-off, the smallest real parts first.
    fn checked(matrix: &[Vec<f64>]) -> Vec<Eigenpair> {
        let size = matrix.len();
        let mut pairs = eigenpairs(size, |i, j| matrix[i][j]).expect("convergence");
        let largest = matrix.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for pair in &pairs {
            let error = residual(matrix, pair);
            assert!(error <= 1e-14 * size as f64 * largest.max(1.0), "{pair:?}: {error:e}");
        }
        assert_eq!(pairs.iter().map(|pair| if pair.value[1] > 0.0 { 2 } else { 1 }).sum::<usize>(), size);
        pairs.sort_by(|a, b| a.value[0].total_cmp(&b.value[0]));
        pairs
    }

    #[test]
    fn symmetric_and_rotating_matrices_have_the_values_in_closed_form() {
        let pairs = checked(&[vec![2.0, 1.0], vec![1.0, 2.0]]);
        let values = [pairs[0].value[0], pairs[1].value[0]];
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15, "{values:?}");
        // a + i b
        let pairs = checked(&[vec![0.5, -2.0], vec![2.0, 0.5]]);
        assert_eq!(pairs.len(), 1);
        let [re, im] = pairs[0].value;
        assert!((re - 0.5).abs() < 1e-15 && (im - 2.0).abs() < 1e-15, "{re} {im}");
    }

    /// S D S^-1 with a diagonal of numbers and blocks, S = I + u w^T.
    fn similar(diagonal: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let size = diagonal.len();
        let (u, w) = (|i: usize| (1.0 + i as f64).sin(), |i: usize| 0.5 * (2.0 + 3.0 * i as f64).cos());
        let scale = 1.0 + (0..size).map(|i| u(i) * w(i)).sum::<f64>();
        let delta = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let entry = |i: usize, j: usize| -> f64 {
            let part =
                |p: usize, q: usize| (delta(i, p) + u(i) * w(p)) * diagonal[p][q] * (delta(q, j) - u(q) * w(j) / scale);
            (0..size).flat_map(|p| (0..size).map(move |q| (p, q))).map(|(p, q)| part(p, q)).sum()
        };
        (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect()
    }

    #[test]
    fn complex_pairs_and_real_values_of_a_general_matrix_are_those_it_was_made_of() {
        let mut diagonal = vec![vec![0.0; 7]; 7];
        for (i, value) in [(0, -3.0), (1, 0.25), (6, 5.0)] {
            diagonal[i][i] = value;
        }
        for (i, [re, im]) in [(2, [1.0, 2.0]), (4, [2.0, 0.125])] {
            (diagonal[i][i], diagonal[i][i + 1], diagonal[i + 1][i], diagonal[i + 1][i + 1]) = (re, im, -im, re);
        }
        let values: Vec<[f64; 2]> = checked(&similar(&diagonal)).iter().map(|pair| pair.value).collect();
        let expected = [[-3.0, 0.0], [0.25, 0.0], [1.0, 2.0], [2.0, 0.125], [5.0, 0.0]];
        assert_eq!(values.len(), expected.len());
        for (value, expected) in values.iter().zip(&expected) {
            assert!((value[0] - expected[0]).hypot(value[1] - expected[1]) < 1e-13, "{value:?} {expected:?}");
        }
    }

    #[test]
    fn unknowns_that_change_places_do_not_hinder_convergence() {
        for size in [3, 4, 7, 12] {
            let cycle: Vec<Vec<f64>> =
                (0..size).map(|i| (0..size).map(|j| if i == (j + 1) % size { 1.0 } else { 0.0 }).collect()).collect();
            for pair in checked(&cycle) {
                assert!((pair.value[0].hypot(pair.value[1]) - 1.0).abs() < 1e-13, "{:?}", pair.value);
            }
        }
    }

    #[test]
    fn zero_repeated_and_missing_vectors_are_finite() {
        for size in [1, 2, 3, 6] {
            assert!(checked(&vec![vec![0.0; size]; size]).iter().all(|pair| pair.value == [0.0, 0.0]));
        }
        assert!(eigenpairs(0, |_, _| 0.0).expect("nothing to iterate").is_empty());
        // a Jordan block of each size, as it is and mixed; the vector of an n-fold value is exact, the value to eps^(1/n)
        for size in [2, 3, 5] {
            let jordan: Vec<Vec<f64>> = (0..size)
                .map(|i| {
                    (0..size)
                        .map(|j| {
                            if i == j {
                                2.0
                            } else if j == i + 1 {
                                1.0
                            } else {
                                0.0
                            }
                        })
                        .collect()
                })
                .collect();
            for pair in checked(&jordan).iter().chain(&checked(&similar(&jordan))) {
                assert!((pair.value[0] - 2.0).hypot(pair.value[1]) < 10.0 * f64::EPSILON.powf(1.0 / size as f64));
            }
        }
        // a value of multiplicity three with all its vectors
        let mut diagonal = vec![vec![0.0; 4]; 4];
        (0..4).for_each(|i| diagonal[i][i] = if i < 3 { 1.0 } else { 4.0 });
        checked(&similar(&diagonal));
    }

    #[test]
    fn numbers_that_are_not_finite_have_no_eigenvalues() {
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(eigenpairs(3, |i, j| if (i, j) == (2, 0) { wrong } else { 1.0 + i as f64 }).is_none());
        }
    }
}
