// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]
// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use nalgebra::{DMatrix, DVector, Hessenberg, SymmetricEigen};
use num_complex::Complex64;
use std::ops::Range;

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

/// Iterations for an eigenvalue before the search is given up; most take two or three.
const ITERATIONS: usize = 60;
/// Every which iteration takes another shift, for matrices that the usual one leaves as they are.
const EXCEPTIONAL: usize = 10;

/// Eigenvalues of a small dense matrix, entry (i, j) being `entry(i, j)`; of a conjugate pair only the one with a positive imaginary
/// part. A symmetric matrix has real ones, the smallest first. `None` if the iteration does not converge, and with numbers that are
/// not finite.
///
/// Where a matrix has fewer vectors than values, the vectors of equal values are nearly the same, and round-off may make one pair more of
/// them.
pub fn eigenpairs(size: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<Eigenpair>> {
    let matrix = DMatrix::from_fn(size, size, entry);
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    if size == 0 {
        return Some(Vec::new());
    }
    let largest = matrix.amax();
    let is_symmetric = (&matrix - matrix.transpose()).amax() <= SYMMETRIC * largest;
    if is_symmetric && let Some(pairs) = symmetric_part_eigenpairs(size, |i, j| matrix[(i, j)]) {
        return Some(pairs);
    }
    let (vectors, hessenberg) = Hessenberg::new(matrix).unpack();
    let (mut vectors, mut t) = (vectors.map(Complex64::from), hessenberg.map(Complex64::from));
    triangularize(&mut t, &mut vectors)?;
    // conjugate pairs are found one by one: what is real has an imaginary part of the size of round-off
    let real = 16.0 * size as f64 * f64::EPSILON * largest;
    let (positive, negative): (Vec<usize>, Vec<usize>) = (0..size).partition(|&k| t[(k, k)].im >= -real);
    let mut pairs: Vec<_> = positive.into_iter().map(|k| eigenpair(&vectors, &t, k, real)).collect();
    // of a cluster that round-off tears apart there may be more below the real axis than above: their conjugates are values, too
    let above = pairs.iter().filter(|pair| pair.value[1] > 0.0).count();
    let mut unmatched: Vec<_> = negative.into_iter().map(|k| eigenpair(&vectors, &t, k, real)).collect();
    unmatched.sort_by(|a, b| b.value[1].total_cmp(&a.value[1]));
    unmatched.truncate(unmatched.len().saturating_sub(above));
    for mut pair in unmatched {
        pair.value[1] = -pair.value[1];
        pair.vector[1].iter_mut().for_each(|part| *part = -*part);
        pairs.push(pair);
    }
    pairs.iter().all(is_finite).then_some(pairs)
}

/// Eigenvalues of a small complex matrix; `None` if the iteration does not converge, and with numbers that are not finite.
pub fn complex_eigenvalues(matrix: DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    if matrix.is_empty() || !matrix.iter().all(|value| value.is_finite()) {
        return matrix.is_empty().then(Vec::new);
    }
    let (mut vectors, mut t) = Hessenberg::new(matrix).unpack();
    triangularize(&mut t, &mut vectors)?;
    Some(t.diagonal().iter().copied().collect())
}

/// Smallest singular value of a complex matrix, from above, by inverse iteration with A^H A: how far another one is of which a value is zero.
pub fn least_singular_value(matrix: DMatrix<Complex64>) -> f64 {
    /// Steps, each of which leaves less of the other singular values by the square of their ratio.
    const STEPS: usize = 4;
    let turn = |k: usize, _: usize| Complex64::from_polar(1.0, k as f64 * k as f64);
    let (mut x, mut least) = (DVector::from_fn(matrix.nrows(), turn), f64::INFINITY);
    let (adjoint, own) = (matrix.adjoint().lu(), matrix.lu());
    for _ in 0..STEPS {
        x.unscale_mut(x.norm());
        if !(adjoint.solve_mut(&mut x) && own.solve_mut(&mut x)) {
            return 0.0;
        }
        // a vector that overflows is of a matrix that is singular
        least = x.norm().sqrt().recip();
        if !(least > 0.0) {
            return 0.0;
        }
    }
    least
}

/// The same of the symmetric part of a real matrix, whatever the rest is: what round-off adds to a symmetric one would make a complex pair of two
/// equal values.
pub fn symmetric_part_eigenpairs(size: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<Eigenpair>> {
    let matrix = DMatrix::from_fn(size, size, |i, j| 0.5 * (entry(i, j) + entry(j, i)));
    if size == 0 || !matrix.iter().all(|value| value.is_finite()) {
        return (size == 0).then(Vec::new);
    }
    let found = SymmetricEigen::try_new(matrix, f64::EPSILON, ITERATIONS * size)?;
    let pair = |(value, vector): (&f64, nalgebra::DVectorView<'_, f64>)| Eigenpair {
        value: [*value, 0.0],
        vector: [vector.iter().copied().collect(), vec![0.0; size]],
    };
    let mut pairs: Vec<_> = found.eigenvalues.iter().zip(found.eigenvectors.column_iter()).map(pair).collect();
    pairs.sort_by(|a, b| a.value[0].total_cmp(&b.value[0]));
    pairs.iter().all(is_finite).then_some(pairs)
}

/// Makes a Hessenberg matrix upper triangular by QR steps with a shift: T <- G T G^H, Q <- Q G^H; `None` without convergence.
///
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., chapter 7.5.
fn triangularize(t: &mut DMatrix<Complex64>, vectors: &mut DMatrix<Complex64>) -> Option<()> {
    let size = t.nrows();
    let norm = t.iter().fold(0.0, |most: f64, entry| most.max(entry.norm()));
    let (mut end, mut iterations) = (size - 1, 0);
    while end > 0 {
        let is_small = |t: &DMatrix<Complex64>, row: usize| {
            let beside = t[(row - 1, row - 1)].norm() + t[(row, row)].norm();
            t[(row, row - 1)].norm() <= f64::EPSILON * if beside == 0.0 { norm } else { beside }
        };
        let start = (1..=end).rev().find(|&row| is_small(t, row)).unwrap_or(0);
        if start > 0 {
            t[(start, start - 1)] = Complex64::ZERO;
        }
        if start == end {
            (end, iterations) = (end - 1, 0);
            continue;
        }
        iterations += 1;
        if iterations > ITERATIONS {
            return None;
        }
        let shift = if iterations.is_multiple_of(EXCEPTIONAL) {
            t[(end, end)] + Complex64::from_polar(t[(end, end - 1)].norm(), iterations as f64)
        } else {
            nearest_eigenvalue(t, end)
        };
        qr_step(t, vectors, start..end + 1, shift);
    }
    Some(())
}

/// The eigenvalue of the two rows up to `end` that is nearest to the last entry.
fn nearest_eigenvalue(t: &DMatrix<Complex64>, end: usize) -> Complex64 {
    let (first, last) = (t[(end - 1, end - 1)], t[(end, end)]);
    let half_difference = 0.5 * (first - last);
    let product = t[(end - 1, end)] * t[(end, end - 1)];
    let root = (half_difference * half_difference + product).sqrt();
    let (one, other) = (half_difference + root, half_difference - root);
    // the farther one is found without cancellation, and the product of both distances is known
    let farther = if one.norm() >= other.norm() { one } else { other };
    if farther == Complex64::ZERO { last } else { last - product / farther }
}

/// T - shift I = Q R in some rows, T <- R Q + shift I.
fn qr_step(t: &mut DMatrix<Complex64>, vectors: &mut DMatrix<Complex64>, rows: Range<usize>, shift: Complex64) {
    let size = t.nrows();
    rows.clone().for_each(|row| t[(row, row)] -= shift);
    let mut rotations = Vec::with_capacity(rows.len());
    for k in rows.start..rows.end - 1 {
        let (upper, lower) = (t[(k, k)], t[(k + 1, k)]);
        let length = upper.norm().hypot(lower.norm());
        let phase = if upper == Complex64::ZERO { Complex64::ONE } else { upper / upper.norm() };
        let (cosine, sine) =
            if length == 0.0 { (1.0, Complex64::ZERO) } else { (upper.norm() / length, phase * lower.conj() / length) };
        for column in k..size {
            let (upper, lower) = (t[(k, column)], t[(k + 1, column)]);
            t[(k, column)] = upper * cosine + lower * sine;
            t[(k + 1, column)] = lower * cosine - upper * sine.conj();
        }
        t[(k + 1, k)] = Complex64::ZERO;
        rotations.push((k, cosine, sine));
    }
    for (k, cosine, sine) in rotations {
        for (matrix, count) in [(&mut *t, k + 2), (&mut *vectors, size)] {
            for row in 0..count {
                let (left, right) = (matrix[(row, k)], matrix[(row, k + 1)]);
                matrix[(row, k)] = left * cosine + right * sine.conj();
                matrix[(row, k + 1)] = right * cosine - left * sine;
            }
        }
    }
    rows.for_each(|row| t[(row, row)] += shift);
}

/// The pair number `k` of Q T Q^H with a triangular T: (T - lambda I) x = 0 with x_k = 1 and zeros below, v = Q x. An imaginary part up to
/// `real` is none, and the vector is turned to be real.
fn eigenpair(vectors: &DMatrix<Complex64>, t: &DMatrix<Complex64>, k: usize, real: f64) -> Eigenpair {
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
    if value.im.abs() > real {
        let parts = [vector.iter().map(|x| x.re).collect(), vector.iter().map(|x| x.im).collect()];
        return Eigenpair { value: [value.re, value.im], vector: parts };
    }
    let largest = vector.iter().fold(Complex64::ZERO, |most, x| if x.norm() > most.norm() { *x } else { most });
    let turned: Vec<f64> = vector.iter().map(|x| (x * largest.conj()).re).collect();
    let length = turned.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
    Eigenpair { value: [value.re, 0.0], vector: [turned.iter().map(|x| x / length).collect(), vec![0.0; t.nrows()]] }
}

fn is_finite(pair: &Eigenpair) -> bool {
    pair.value.iter().chain(pair.vector.iter().flatten()).all(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::{Eigenpair, complex_eigenvalues, eigenpairs, least_singular_value};
    use nalgebra::DMatrix;
    use num_complex::Complex64;

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
        checked_cluster(matrix, false)
    }

    /// The same; of a cluster that is torn apart there may be one more.
    fn checked_cluster(matrix: &[Vec<f64>], is_torn: bool) -> Vec<Eigenpair> {
        let size = matrix.len();
        let mut pairs = eigenpairs(size, |i, j| matrix[i][j]).expect("convergence");
        let largest = matrix.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for pair in &pairs {
            let error = residual(matrix, pair);
            assert!(error <= 1e-14 * size as f64 * largest.max(1.0), "{pair:?}: {error:e}");
        }
        let count = pairs.iter().map(|pair| if pair.value[1] > 0.0 { 2 } else { 1 }).sum::<usize>();
        assert!(count == size || is_torn && count == size + 1, "{count} of {size}");
        pairs.sort_by(|a, b| a.value[0].total_cmp(&b.value[0]));
        pairs
    }

    /// Upper triangular in an orthonormal frame, with values that are equal, and others that are round-off beside them.
    #[test]
    fn complex_values_are_those_of_a_turned_triangle() {
        let turn = |k: usize| Complex64::from_polar(1.0, 0.7 * k as f64);
        let values = [Complex64::new(1e3, 2.0), Complex64::new(1e3, 2.0), Complex64::new(-4.0, 1e-9), Complex64::ZERO];
        let triangle = DMatrix::from_fn(4, 4, |i, j| match i.cmp(&j) {
            std::cmp::Ordering::Less => turn(i + 2 * j),
            std::cmp::Ordering::Equal => values[i],
            std::cmp::Ordering::Greater => Complex64::ZERO,
        });
        let frame =
            DMatrix::from_fn(4, 4, |i, j| turn(3 * i * j + j) + Complex64::from((i as f64 - j as f64).cos())).qr().q();
        let mut found = complex_eigenvalues(&frame * triangle * frame.adjoint()).expect("convergence");
        found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        // two equal ones that share a vector move by the root of round-off
        let expected = [values[0], values[1], values[3], values[2]];
        for (own, (value, limit)) in found.iter().zip(expected.into_iter().zip([1e-4, 1e-4, 1e-12, 1e-12])) {
            assert!((own - value).norm() < limit, "{own} {value}");
        }
        assert!(complex_eigenvalues(DMatrix::from_element(2, 2, Complex64::from(f64::NAN))).is_none());
        assert_eq!(
            complex_eigenvalues(DMatrix::from_element(3, 3, Complex64::ZERO)).expect("zeros"),
            vec![Complex64::ZERO; 3]
        );
    }

    #[test]
    fn the_least_singular_value_is_that_of_a_decomposition() {
        let entry = |i: usize, j: usize| Complex64::from_polar(1.0 + (i * j) as f64, (3 * i + i * j * j) as f64);
        for size in [1, 2, 5, 12] {
            let matrix = DMatrix::from_fn(size, size, entry);
            let expected = matrix.clone().svd(false, false).singular_values.min();
            let own = least_singular_value(matrix);
            assert!((own - expected).abs() <= 0.1 * expected, "{size}: {own:e} {expected:e}");
        }
        // values of a Jordan block move by the square root of what its least singular value is
        let block = |shift: f64| DMatrix::from_row_slice(2, 2, &[shift, 1.0, 0.0, shift].map(Complex64::from));
        assert!(least_singular_value(block(1e-8)) < 2e-16 && least_singular_value(block(0.0)) == 0.0);
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
            let entry = |i: usize, j: usize| [2.0, 1.0, 0.0][j.wrapping_sub(i).min(2)];
            let jordan: Vec<Vec<f64>> = (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect();
            for pair in checked(&jordan).iter().chain(&checked_cluster(&similar(&jordan), true)) {
                assert!((pair.value[0] - 2.0).hypot(pair.value[1]) < 10.0 * f64::EPSILON.powf(1.0 / size as f64));
            }
        }
        // a value of multiplicity three with all its vectors
        let mut diagonal = vec![vec![0.0; 4]; 4];
        (0..4).for_each(|i| diagonal[i][i] = if i < 3 { 1.0 } else { 4.0 });
        checked(&similar(&diagonal));
    }

    /// A cluster of nearly equal values beside small ones in a matrix that is symmetric but for round-off: rigid motions beside vibrations.
    #[test]
    fn values_that_are_nearly_equal_converge() {
        for (size, equal) in [(11, 5), (16, 6), (24, 12)] {
            let unit = |i: usize, k: usize| ((1.0 + i as f64) * (1.7 + 0.31 * k as f64) + 0.6 * k as f64).sin();
            let mut matrix = vec![vec![0.0; size]; size];
            for k in 0..3 {
                let length: f64 = (0..size).map(|i| unit(i, k).powi(2)).sum();
                for (i, row) in matrix.iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        *entry += 1e-2 * unit(i, k) * unit(j, k) / length;
                    }
                }
            }
            for i in 0..size {
                for j in 0..size {
                    if i < equal && j < equal {
                        matrix[i][j] += 1e-5 * unit(i, j) + if i == j { 288.0 } else { 0.0 };
                    }
                }
            }
            let pairs = checked(&matrix);
            assert!(pairs.iter().filter(|pair| (pair.value[0] - 288.0).abs() < 1e-3).count() >= equal / 2);
        }
    }

    #[test]
    fn numbers_that_are_not_finite_have_no_eigenvalues() {
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(eigenpairs(3, |i, j| if (i, j) == (2, 0) { wrong } else { 1.0 + i as f64 }).is_none());
        }
    }
}
