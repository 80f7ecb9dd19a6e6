//! Linear systems: analyse a pattern once, factor values, solve, solve transposed.
//!
//! Only `f64` is factored; derivative parts are solved with the same factors. [`Factorization`] scales rows and columns,
//! chooses the backend by size, refines solutions, and names the unknown of a singular system.

mod dense;
mod eigen;
mod factorization;
pub mod lagged;
mod left_looking;
pub mod multifrontal;
mod ordering;
mod rank;
mod simd;
mod sparse_pattern;

pub use dense::DenseLu;
pub use eigen::{Eigenpair, eigenpairs};
pub use factorization::{Backend, Factorization, SolverPlan, Work};
pub use left_looking::LeftLookingLu;
pub use multifrontal::Side;
pub use ordering::{Ordering, minimum_degree};
pub use rank::independent_rows;
pub use sparse_pattern::SparsePattern;

/// A singular or non-finite matrix: the unknown that it does not determine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// Number of the unknown (column).
    pub unknown: usize,
}

/// A direct solver for square matrices of one pattern; scaled and refined by [`Factorization`].
pub trait LinearSolver: Send {
    /// Factors values given in the order of the pattern.
    ///
    /// # Errors
    /// [`Singular`] if a pivot is zero, tiny or not finite and the solver sees it.
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular>;
    /// The order of pivots that later factorizations keep, if the solver keeps any: together with the values it fixes every bit
    /// of the factors.
    fn kept_pivots(&self) -> Option<&[usize]> {
        None
    }
    /// Takes over the order of pivots that another factorization of the pattern found.
    fn keep_pivots(&mut self, _pivots: &[usize]) {}
    /// Another solver of the pattern that has factored nothing yet, where that takes no second analysis.
    fn another(&self) -> Option<Box<dyn LinearSolver>> {
        None
    }
    /// Replaces b by A^-1 b.
    fn solve(&mut self, rhs: &mut [f64]);
    /// Replaces b by A^-T b.
    fn solve_transposed(&mut self, rhs: &mut [f64]);
    /// Replaces right-hand sides, one after the other, by the columns of A^-1 B or A^-T B.
    ///
    /// * `size` number of unknowns
    fn solve_columns(&mut self, side: Side, size: usize, rhs: &mut [f64]) {
        for column in rhs.chunks_exact_mut(size) {
            match side {
                Side::Plain => self.solve(column),
                Side::Transposed => self.solve_transposed(column),
            }
        }
    }
}
