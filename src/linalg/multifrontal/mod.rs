//! Multifrontal LU with nested dissection: for large meshes, where dense matrices of neighbouring unknowns carry the
//! arithmetic.
//!
//! ```text
//! pattern -> graph -> dissection -> elimination tree -> supernodes -> symbolic        (once)
//! values  -> fronts in the order of the tree, pivots in each -> factors -> substitution
//! ```
//!
//! The pattern of A + A^T is eliminated, the values are unsymmetric. Pivots are searched among the unknowns of a front;
//! those without an acceptable one are delayed to the front above.
//!
//! Fronts of up to 32 rows, of which chains have no others, are stored and factored in a way of their own: in columns
//! of whole vector registers, by one program for each number of them. Where such a front has to delay a pivot, or takes
//! one up, it is one like the large ones.
//!
//! Source: Duff & Reid (1983, 1984); Liu (1992), The multifrontal method for sparse matrix solution.

mod balance;
mod dissection;
mod elimination_tree;
mod entries;
mod factors;
mod front;
mod graph;
mod inertia;
mod kernels;
mod known_signs;
mod matrix_view;
mod multifrontal_lu;
pub(super) mod pivots;
mod product;
mod rank_share;
mod shared_front;
mod small_front;
mod small_substitution;
mod stretch_solution;
mod stretches;
mod substitution;
mod supernodes;
mod symbolic;
mod thread_solution;
mod traversal;

#[cfg(test)]
pub(super) mod test_matrices;

pub use inertia::Inertia;
pub(super) use kernels::largest;
pub use multifrontal_lu::MultifrontalLu;
pub use symbolic::SMALL_FILL;
