// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::linalg::simd::{Kernel, dispatch};

/// Backward error up to which a solution is as good as one of a fresh factorization that was refined once.
pub const BACKWARD_ERROR: f64 = 1e-15;
/// Backward error at which a cycle aims.
const AIM: f64 = 0.5 * BACKWARD_ERROR;
/// The largest of many errors is as many times their mean; where it is more, it gets less in a cycle.
const LARGEST_BY_MEAN: [f64; 2] = [2.5, 25.0];
/// A cycle has to divide the backward error at least by this.
const SLOWEST: f64 = 2.0;
/// As many times the most applications, expected after half of them, are too many: convergence gets faster, but not so much.
const HOPELESS: f64 = 2.0;
/// Part of a vector outside the space before it that is but round-off.
const ROUND_OFF: f64 = 1e-14;

/// How far a solution is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Progress {
    /// Another application of the preconditioner is needed.
    Open,
    /// There is a solution, but its residual is only estimated.
    Unchecked,
    /// The backward error is at most [`BACKWARD_ERROR`].
    Reached,
    /// The preconditioner is too far from the matrix, or not finite.
    #[default]
    Refused,
}

/// GMRES for one right-hand side, preconditioned from the right, in the norm that the backward error is measured in:
///
/// ```text
/// x = x0 + Z y,  Z = M^-1 D V,  |D^-1 (b - A x)|_2 least,  D = diag(|A| |x0| + |b|),  x0 = M^-1 b
/// ```
///
/// M is applied by the caller, so that several right-hand sides can share an application. Z is kept, so that a solution needs no other
/// one. When the estimate says so, the residual is evaluated and, if too large, a new cycle begins there.
///
/// Source: Saad & Schultz (1986) with modified Gram-Schmidt; Saad (1993) for Z; Essai (1998) for D.
#[derive(Default)]
pub struct FlexibleGmres {
    /// Most applications.
    most: usize,
    applications: usize,
    progress: Progress,
    backward_error: f64,
    rhs: Vec<f64>,
    solution: Vec<f64>,
    /// D.
    against: Vec<f64>,
    /// V, one column more than Z.
    basis: Vec<f64>,
    /// Z.
    directions: Vec<f64>,
    /// Columns of the triangle into which rotations turn the Hessenberg matrix; the j-th has j + 1 entries.
    triangle: Vec<f64>,
    rotations: Vec<[f64; 2]>,
    /// Norm of the residual with which a cycle begins.
    begun: f64,
    /// Norm of the residual with which it ends.
    goal: f64,
    /// Norm of the residual at the start of a cycle, rotated.
    rotated: Vec<f64>,
}

impl FlexibleGmres {
    /// Begins with a right-hand side; at most `most` applications of the preconditioner.
    pub fn start(&mut self, rhs: &[f64], most: usize) {
        let size = rhs.len();
        self.most = most;
        self.applications = 0;
        self.backward_error = f64::INFINITY;
        self.clear_cycle();
        // untouched memory is not used: most solutions need less than the most
        self.basis.reserve(size * (most + 1));
        self.directions.reserve(size * most);
        self.triangle.reserve(most * (most + 1) / 2);
        self.rotations.reserve(most);
        self.rotated.reserve(most + 1);
        self.rhs.resize(size, 0.0);
        self.rhs.copy_from_slice(rhs);
        self.solution.resize(size, 0.0);
        self.against.resize(size, 0.0);
        // zero without an application
        self.progress = if rhs.iter().all(|&b| b == 0.0) {
            self.solution.fill(0.0);
            self.backward_error = 0.0;
            Progress::Reached
        } else if most == 0 {
            Progress::Refused
        } else {
            Progress::Open
        };
    }

    /// What the preconditioner is to be applied to.
    pub fn write_direction(&self, direction: &mut [f64]) {
        let size = self.rhs.len();
        if self.applications == 0 {
            direction.copy_from_slice(&self.rhs);
        } else {
            let last = &self.basis[self.rotations.len() * size..];
            direction.iter_mut().zip(last.iter().zip(&self.against)).for_each(|(own, (v, d))| *own = v * d);
        }
    }

    /// Takes up M^-1 of the direction as the first solution.
    pub fn take_first(&mut self, applied: &[f64]) {
        self.applications = 1;
        self.solution.copy_from_slice(applied);
        self.progress = Progress::Unchecked;
    }

    /// Takes up z = M^-1 of the direction, and A z.
    pub fn take(&mut self, applied: &[f64], product: &[f64]) {
        self.applications += 1;
        if self.extend(applied, product) {
            self.add_combination();
            self.progress = Progress::Unchecked;
        } else if self.applications == self.most.div_ceil(2) && self.expected() > HOPELESS * self.most as f64 {
            self.progress = Progress::Refused;
        }
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// The solution so far, with its backward error as of the last evaluation.
    pub fn solution(&self) -> (&[f64], f64) {
        (&self.solution, self.backward_error)
    }

    /// Applications of the preconditioner.
    pub fn applications(&self) -> usize {
        self.applications
    }

    /// Applications in all, if the residual goes on falling as it did in this cycle.
    fn expected(&self) -> f64 {
        let (columns, reached) = (self.rotations.len(), self.rotated[self.rotations.len()].abs());
        let each = (self.begun / reached).ln() / columns as f64;
        self.applications as f64 + (reached / self.goal).ln() / each
    }

    fn clear_cycle(&mut self) {
        self.basis.clear();
        self.directions.clear();
        self.triangle.clear();
        self.rotations.clear();
        self.rotated.clear();
    }

    /// Sets the residual and begins a cycle with it, unless all is over. The measure is that of the componentwise backward error,
    ///
    /// ```text
    /// omega = max_i |b - A x|_i / (|A| |x| + |b|)_i
    /// ```
    ///
    /// where an equation that holds but for quantities much smaller than the solution is measured against the solution.
    ///
    /// * `product`   A x
    /// * `magnitude` |A| |x|
    /// * `row_sizes` largest entry of each row of A
    ///
    /// Source: Arioli, Demmel & Duff (1989), eqs. (2.4) and (2.6).
    pub fn check(&mut self, product: &[f64], magnitude: &[f64], row_sizes: &[f64]) {
        self.clear_cycle();
        let size = self.rhs.len();
        let largest = self.solution.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let small = 1000.0 * size as f64 * f64::EPSILON;
        let mut omega = [0.0; 2];
        for row in 0..size {
            let (b, of_solution) = (self.rhs[row], row_sizes[row] * largest);
            let ordinary = magnitude[row] + b.abs() > small * (of_solution + b.abs());
            let against = magnitude[row] + if ordinary { b.abs() } else { of_solution };
            let residual = b - product[row];
            let weighted = if residual == 0.0 { 0.0 } else { residual / against };
            let most = &mut omega[usize::from(ordinary)];
            if !(weighted.abs() <= *most) && !most.is_nan() {
                *most = weighted.abs();
            }
            self.against[row] = against;
            self.basis.push(weighted);
        }
        let error = omega[0] + omega[1];
        let before = std::mem::replace(&mut self.backward_error, error);
        self.progress = if error <= BACKWARD_ERROR {
            Progress::Reached
        } else if !(error <= before / SLOWEST) || !error.is_finite() || self.applications == self.most {
            Progress::Refused
        } else {
            let norm = dot(&self.basis, &self.basis).sqrt();
            self.basis.iter_mut().for_each(|v| *v /= norm);
            self.rotated.push(norm);
            self.begun = norm;
            let root = (size as f64).sqrt();
            let [least, most] = LARGEST_BY_MEAN;
            self.goal = AIM * root / (error * root / norm).clamp(least, most);
            Progress::Open
        };
    }

    /// Adds a column to Z and V; returns whether the cycle ends.
    fn extend(&mut self, applied: &[f64], product: &[f64]) -> bool {
        let (size, column) = (self.rhs.len(), self.rotations.len());
        self.directions.extend_from_slice(applied);
        self.basis.extend(product.iter().zip(&self.against).map(|(w, d)| if *d > 0.0 { w / d } else { 0.0 }));
        let (before, next) = self.basis.split_at_mut(size * (column + 1));
        let whole = dot(next, next).sqrt();
        let first = self.triangle.len();
        for v in before.chunks_exact(size) {
            let along = dot(v, next);
            add_multiple(-along, v, next);
            self.triangle.push(along);
        }
        let norm = dot(next, next).sqrt();
        next.iter_mut().for_each(|w| *w /= norm);
        let own = &mut self.triangle[first..];
        for (row, [cosine, sine]) in self.rotations.iter().enumerate() {
            let (upper, lower) = (own[row], own[row + 1]);
            own[row] = cosine * upper + sine * lower;
            own[row + 1] = cosine * lower - sine * upper;
        }
        let diagonal = own[column].hypot(norm);
        let [cosine, sine] = [own[column] / diagonal, norm / diagonal];
        own[column] = diagonal;
        self.rotations.push([cosine, sine]);
        let rotated = self.rotated[column];
        self.rotated[column] = cosine * rotated;
        self.rotated.push(-sine * rotated);
        // not finite as well
        !((sine * rotated).abs() > self.goal) || !(norm > ROUND_OFF * whole) || self.applications == self.most
    }

    /// x + Z y with the y of the least residual.
    fn add_combination(&mut self) {
        let (size, columns) = (self.rhs.len(), self.rotations.len());
        let y = &mut self.rotated[..columns];
        for column in (0..columns).rev() {
            let own = &self.triangle[column * (column + 1) / 2..][..column + 1];
            y[column] /= own[column];
            let known = y[column];
            y.iter_mut().zip(&own[..column]).for_each(|(y, above)| *y -= above * known);
        }
        for (direction, y) in self.directions.chunks_exact(size).zip(y) {
            add_multiple(*y, direction, &mut self.solution);
        }
    }
}

/// Inner product, in lanes.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    dispatch(Dot(a, b))
}

/// Adds a multiple of a vector to another one.
fn add_multiple(factor: f64, vector: &[f64], to: &mut [f64]) {
    dispatch(AddMultiple(factor, vector, to));
}

// products and sums stay apart, so that every processor gives the same bits
struct Dot<'d>(&'d [f64], &'d [f64]);

impl Kernel for Dot<'_> {
    type Output = f64;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let (a, a_rest) = self.0.as_chunks::<16>();
        let (b, b_rest) = self.1.as_chunks::<16>();
        let mut lanes = [0.0; 16];
        for (a, b) in a.iter().zip(b) {
            (0..16).for_each(|lane| lanes[lane] += a[lane] * b[lane]);
        }
        lanes.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
    }
}

struct AddMultiple<'d>(f64, &'d [f64], &'d mut [f64]);

impl Kernel for AddMultiple<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        self.2.iter_mut().zip(self.1).for_each(|(to, own)| *to += self.0 * own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::multifrontal::test_matrices::Noise;

    /// A v, row by row.
    fn product(a: &[Vec<f64>], v: &[f64]) -> Vec<f64> {
        a.iter().map(|row| row.iter().zip(v).map(|(a, v)| a * v).sum()).collect()
    }

    #[test]
    fn without_a_preconditioner_as_many_iterations_as_unknowns_are_enough() {
        let mut noise = Noise(21);
        for size in [1, 2, 5, 17, 20] {
            // eigenvalues on all sides of zero: corrections alone would diverge
            let a: Vec<Vec<f64>> = (0..size).map(|_| noise.vector(size)).collect();
            let sizes: Vec<f64> = a.iter().map(|row| row.iter().fold(0.0, |most: f64, a| most.max(a.abs()))).collect();
            let absolute: Vec<Vec<f64>> = a.iter().map(|row| row.iter().map(|a| a.abs()).collect()).collect();
            let mut gmres = FlexibleGmres::default();
            gmres.start(&noise.vector(size), 4 * size + 4);
            let mut direction = vec![0.0; size];
            let mut cycles = Vec::new();
            while gmres.progress() == Progress::Open {
                gmres.write_direction(&mut direction);
                if cycles.is_empty() {
                    gmres.take_first(&direction);
                } else {
                    gmres.take(&direction, &product(&a, &direction));
                }
                if gmres.progress() == Progress::Unchecked {
                    let x = gmres.solution().0;
                    let magnitudes = product(&absolute, &x.iter().map(|x| x.abs()).collect::<Vec<_>>());
                    let products = product(&a, x);
                    gmres.check(&products, &magnitudes, &sizes);
                    cycles.push(gmres.applications());
                }
            }
            let error = gmres.solution().1;
            // the first vector as it is, then a cycle with the whole space; the next ones take what round-off leaves of it
            assert!(cycles[1] <= 1 + size, "{size} unknowns: cycles end at {cycles:?}");
            assert_eq!(gmres.progress(), Progress::Reached, "{size} unknowns: {cycles:?}, {error:e}");
        }
    }
}
