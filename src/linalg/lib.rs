//! Linear systems: analyse a pattern once, factor values, solve, solve transposed.
//!
//! Only `f64` is factored; derivative parts are solved with the same factors. `Factorization` scales rows and columns,
//! chooses the backend by size, refines solutions, and names the unknown of a singular system.

extern crate self as linalg;
use costate_program::{scalar, tolerances};

pub mod exchange;

mod column_groups;
mod dense;
mod eigen;
pub mod factorization;
pub mod multifrontal;
#[cfg(feature = "mumps")]
mod mumps;
pub mod own_unknowns;
pub mod owners;
mod rank;
mod scaling;
mod simd;
mod sparse_pattern;
mod vectors;

pub use column_groups::{AT_ONCE, is_shared_by_threads, ranges_where};
pub use dense::DenseLu;
pub use eigen::{Eigenpair, complex_eigenvalues, eigenpairs, least_singular_value, symmetric_part_eigenpairs};
pub use factorization::Backend;
pub use factorization::{Factorization, Signs, SolverPlan, TransposedSolution};
pub use multifrontal::SMALL_FILL;
pub use multifrontal::{Inertia, MultifrontalLu};
#[cfg(feature = "mumps")]
pub use mumps::MumpsLu;
pub use own_unknowns::OwnUnknowns;
pub use owners::Owners;
pub use rank::{SparseRow, independent_rows, sign_of_determinant};
pub use simd::{Kernel, dispatch};
pub use sparse_pattern::SparsePattern;

/// A singular or non-finite matrix: the unknown that it does not determine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// Number of the unknown (column).
    pub unknown: usize,
}

/// A direct solver for square matrices of one pattern; scaled and refined by `Factorization`.
pub trait LinearSolver: Send {
    /// Factors values given in the order of the pattern.
    ///
    /// # Errors
    /// [`Singular`] if a pivot is zero, tiny or not finite and the solver sees it.
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular>;
    /// Another solver of the pattern that has factored nothing yet, where that takes no second analysis.
    fn clone_analysis(&self) -> Option<Box<dyn LinearSolver>> {
        None
    }
    /// Numbers of positive and negative eigenvalues of a symmetric matrix of the pattern, whatever was factored; so many negative ones are
    /// known to be there. Those whose signs round-off may have changed are zero.
    fn inertia(&self, values: &[f64], known: usize) -> Inertia;
    /// Replaces right-hand sides, one after the other, by the columns of A^-1 B.
    fn solve(&mut self, rhs: &mut [f64]);
    /// Replaces right-hand sides, one after the other, by the columns of A^-T B.
    fn solve_transposed(&mut self, rhs: &mut [f64]);
}
