//! Solutions with a matrix near the one that was factored last: for large systems, whose factorization takes the time of many solutions.

mod flexible_gmres;
mod lagged_solver;
mod refactoring;
mod system_matrix;

pub use flexible_gmres::BACKWARD_ERROR;
pub use lagged_solver::{Lag, LaggedSolver};
pub use refactoring::Refactoring;
