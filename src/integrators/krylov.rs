//! The largest eigenvalues of an operator in a block Krylov space (Arnoldi), and all of them where the space is small.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::RunError;
use crate::linalg::{Eigenpair, eigenpairs, symmetric_part_eigenpairs};
use nalgebra::DMatrix;

/// Residual of a pair, relative to its value.
const CONVERGED: f64 = 1e-11;
/// Share of the shift, or of the largest value, that is not told from zero: ten times what pairs converge to.
pub(super) const ZERO: f64 = 1e-10;
/// Vectors that are dependent on others but for this share are left out.
const DEPENDENT: f64 = 1e-10;
/// Vectors that are dependent but for this share may be what round-off leaves of the constraints ...
const SUSPICIOUS: f64 = 1e-4;
/// ... and are, if less than this is left of them once they obey these.
const GENUINE: f64 = 0.5;

/// An operator on vectors that obey constraints, and how these are measured.
pub(super) trait Space {
    fn size(&self) -> usize;
    fn is_symmetric(&self) -> bool;
    /// B x, with the inner product x^T B y.
    fn image(&self, vector: &[f64]) -> Vec<f64>;
    /// The operator on a vector x, given as B x.
    fn apply(&mut self, image: &[f64]) -> Vec<f64>;
    fn obey_constraints(&mut self, vector: &mut [f64]);
    /// A vector that obeys the constraints, of any other.
    fn first(&mut self, vector: &[f64]) -> Vec<f64> {
        let image = self.image(vector);
        self.apply(&image)
    }
}

/// Vectors that are orthonormal in the inner product, and what the operator does to them.
#[derive(Default)]
struct Krylov {
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    /// Coefficients of the operator's results, one list for each vector that it was applied to.
    columns: Vec<Vec<f64>>,
}

/// A number from -0.5 to 0.5 in no pattern that a mode could follow (the generator SplitMix64).
pub(super) fn noise(i: usize, k: usize) -> f64 {
    let mut z = (i as u64 + ((k as u64) << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64 - 0.5
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
}

fn norm(space: &dyn Space, vector: &[f64]) -> f64 {
    dot(vector, &space.image(vector)).max(0.0).sqrt()
}

impl Krylov {
    /// Takes from a vector what lies along the basis, twice for the sake of round-off, and adds up the coefficients.
    fn orthogonalize(&self, vector: &mut [f64], mut coefficients: Option<&mut [f64]>) {
        for _ in 0..2 {
            for (place, (image, own)) in self.images.iter().zip(&self.basis).enumerate() {
                let share = dot(image, vector);
                add(vector, -share, own);
                if let Some(coefficients) = &mut coefficients {
                    coefficients[place] += share;
                }
            }
        }
    }

    /// Adds a vector to the basis where it does not depend on it; returns its coefficients.
    fn extend(&mut self, space: &mut dyn Space, mut vector: Vec<f64>) -> Vec<f64> {
        let before = norm(space, &vector);
        let mut coefficients = vec![0.0; self.basis.len()];
        self.orthogonalize(&mut vector, Some(&mut coefficients));
        let left = norm(space, &vector);
        if !(left > DEPENDENT * before) {
            return coefficients;
        }
        vector.iter_mut().for_each(|value| *value /= left);
        if left < SUSPICIOUS * before {
            space.obey_constraints(&mut vector);
            self.orthogonalize(&mut vector, None);
            let genuine = norm(space, &vector);
            if !(genuine > GENUINE) {
                return coefficients;
            }
            vector.iter_mut().for_each(|value| *value /= genuine);
        }
        self.images.push(space.image(&vector));
        self.basis.push(vector);
        coefficients.push(left);
        coefficients
    }
}

/// Eigenvalues of largest size with their vectors, from a few vectors more than values.
pub(super) fn largest_pairs(space: &mut dyn Space, count: usize, spare: usize) -> Result<Vec<Eigenpair>, RunError> {
    let (mut krylov, length, mut examined) = (Krylov::default(), space.size(), 0);
    for k in 0..(count + spare).min(length) {
        let vector = space.first(&(0..length).map(|i| noise(i, k)).collect::<Vec<f64>>());
        krylov.extend(space, vector);
    }
    loop {
        let known = krylov.columns.len();
        for place in known..krylov.basis.len() {
            let result = space.apply(&krylov.images[place]);
            let column = krylov.extend(space, result);
            krylov.columns.push(column);
        }
        let size = krylov.columns.len();
        // values of all these vectors take longer than a few more of them
        if krylov.basis.len() > size && 8 * size < 9 * examined {
            continue;
        }
        examined = size;
        let entry = |i: usize, j: usize| krylov.columns[j].get(i).copied().unwrap_or(0.0);
        let mut pairs = projected_pairs(space.is_symmetric(), size, entry)?;
        pairs.sort_by(|a, b| magnitude(b).total_cmp(&magnitude(a)));
        pairs.truncate(count);
        let left = |pair: &Eigenpair| {
            let beyond = |part: &[f64], i: usize| (0..size).map(|j| entry(i, j) * part[j]).sum::<f64>();
            let rows = size..krylov.basis.len();
            rows.flat_map(|i| [beyond(&pair.vector[0], i), beyond(&pair.vector[1], i)]).fold(0.0, f64::hypot)
        };
        if krylov.basis.len() == size || pairs.iter().all(|pair| left(pair) <= CONVERGED * magnitude(pair)) {
            pairs.iter_mut().for_each(|pair| follow(space, &krylov.basis, pair));
            return Ok(pairs);
        }
    }
}

pub(super) fn magnitude(pair: &Eigenpair) -> f64 {
    pair.value[0].hypot(pair.value[1])
}

fn combined(basis: &[Vec<f64>], shares: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; basis.first().map_or(0, Vec::len)];
    basis.iter().zip(shares).for_each(|(own, share)| add(&mut sum, *share, own));
    sum
}

fn projected_pairs(
    is_symmetric: bool,
    size: usize,
    entry: impl Fn(usize, usize) -> f64,
) -> Result<Vec<Eigenpair>, RunError> {
    let found = if is_symmetric { symmetric_part_eigenpairs(size, entry) } else { eigenpairs(size, entry) };
    found.ok_or_else(|| {
        RunError::Input(
            "the matrices of the vibrations hold numbers that are not finite, or the search for their eigenvalues does not \
             converge: check masses and stiffnesses"
                .into(),
        )
    })
}

/// A basis of all that an operator does not take to zero, and its dual one: dual_i . basis_j = 1 for i = j, otherwise 0.
pub(super) struct WholeBasis {
    pub basis: Vec<Vec<f64>>,
    pub dual: Vec<Vec<f64>>,
}

/// The operator in a basis, and all its eigenvalues but those that are zero, the largest ones first.
pub(super) fn all_pairs(
    space: &mut dyn Space,
    WholeBasis { basis, dual }: &WholeBasis,
) -> Result<(DMatrix<f64>, Vec<Eigenpair>), RunError> {
    let mut matrix = DMatrix::zeros(dual.len(), basis.len());
    for (column, own) in basis.iter().enumerate() {
        let result = space.apply(&space.image(own));
        dual.iter().enumerate().for_each(|(row, own)| matrix[(row, column)] = dot(own, &result));
    }
    let mut pairs = projected_pairs(space.is_symmetric(), basis.len(), |i, j| matrix[(i, j)])?;
    pairs.sort_by(|a, b| magnitude(b).total_cmp(&magnitude(a)));
    // what is left of none is infinitely fast
    pairs.retain(|pair| magnitude(pair) > f64::MIN_POSITIVE.sqrt());
    pairs.iter_mut().for_each(|pair| follow(space, basis, pair));
    Ok((matrix, pairs))
}

/// Makes the vector of a pair in a basis one of the space, with what the operator takes to zero: x = T x / theta.
fn follow(space: &mut dyn Space, basis: &[Vec<f64>], pair: &mut Eigenpair) {
    let [re, im] = pair.vector.each_ref().map(|part| space.apply(&space.image(&combined(basis, part))));
    let [own_re, own_im] = pair.value.map(|part| part / magnitude(pair).powi(2));
    let part = |a: &[f64], b: &[f64], sign: f64| a.iter().zip(b).map(|(a, b)| a * own_re + sign * b * own_im).collect();
    pair.vector = [part(&re, &im, 1.0), part(&im, &re, -1.0)];
}

const MOST_SLICES: usize = 8;

pub(super) type Placed = (Eigenpair, f64);

/// The first `count` of all pairs in the order of a place, which is negative for those that come first of all, each from a shift from which its
/// size is not farther than by a range, which leaves digits to it: those known at one and, beyond, those found at larger ones.
pub(super) fn in_order(
    (mut pairs, mut shift): (Vec<Eigenpair>, f64),
    (count, range): (usize, f64),
    place: &dyn Fn(&Eigenpair, f64) -> f64,
    find: &mut dyn FnMut(f64) -> Result<Vec<Eigenpair>, RunError>,
) -> Result<Vec<Placed>, RunError> {
    let (mut taken, mut known): (Vec<Placed>, usize) = (Vec::new(), 0);
    for slice in 1.. {
        pairs.sort_by(|a, b| place(a, shift).abs().total_cmp(&place(b, shift).abs()));
        let (mut passed, mut is_done) = (0, true);
        for pair in pairs {
            // a pair is two values
            passed += if pair.value[1] == 0.0 { 1 } else { 2 };
            let own = place(&pair, shift);
            if passed <= known {
                continue;
            }
            if own > 0.0 && taken.len() >= count {
                continue;
            }
            if own.abs() <= range * shift {
                known = passed;
                taken.push((pair, shift));
            } else {
                is_done = false;
            }
        }
        // what is far from all of these is infinitely fast
        if is_done || slice == MOST_SLICES {
            break;
        }
        shift *= range;
        pairs = find(shift)?;
    }
    Ok(taken)
}
