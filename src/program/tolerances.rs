//! Tolerances by what they mean: what each is relative to, and why it has its size. None is in seconds, metres or kilograms.
//!
//! What several files mean alike stands here, once. What one algorithm steers itself by stands in its own file, where its comment says the same of it.

/// Round-off of what tens of operations make, by the largest of their terms; of a relative correction that leaves nothing to correct; of a pivot
/// that is zero in a matrix whose rows and columns have the size 1: 45 roundings, beside which coefficients and numbers that count are large.
pub const ROUND_OFF: f64 = 1e-14;
/// Round-off of what thousands of operations make, as sums over a model or solutions of small dense systems, by the largest of their terms:
/// 4500 roundings, which add up to less unless all have one sign.
pub const LONG_SUM: f64 = 1e-12;
/// Round-off of a factorization, as a share of what its factors sum: two roundings for each product and sum, and as many for what scaled them.
///
/// Source: Higham, Accuracy and stability of numerical algorithms, chapters 9 and 11.
pub const FACTORIZATION: f64 = 4.0 * f64::EPSILON;
/// Numbers below this are zero: what is made of them underflows, so that their last digits are no share of them and never settle.
pub const NOTHING: f64 = f64::MIN_POSITIVE / f64::EPSILON;
/// Numbers of a model that must fit together, by their size, or by 1 as sines, cosines and unit vectors are: places said twice, right angles,
/// symmetric tables, constraints at the start. Files that write ten digits pass, and what passes moves nothing that is seen.
pub const CONSISTENT: f64 = 1e-9;
/// Derivatives by two ways that are the same, by the largest of their terms: formulas whose terms cancel lose up to half of their digits, and other
/// derivatives differ by a share of 1.
pub const SAME_DERIVATIVE: f64 = 1e-9;
/// Times that are one, and steps and their coefficients that are one, by a step: times are rounded, after a million steps by 2e-10 of
/// one, and events that are two lie farther apart.
pub const SAME_TIME: f64 = 1e-9;
/// Places of a mesh that are one, by its diagonal, or by an edge or face in their own coordinates: mesh files may hold seven digits.
pub const SAME_VERTEX: f64 = 1e-6;
/// What no longer shrinks may be round-off up to here, corrections by the unknowns and residuals by the largest force: round-off by a condition of
/// half a million of a scaled matrix.
pub const STALLED: f64 = 1e-10;
/// Beyond this nothing is round-off, corrections by the unknowns or displacements by the model's length, and two solutions are not of one problem:
/// it takes a condition of 5e9, with which a solution has no digits for a later one to build on.
pub const NO_ROUND_OFF: f64 = 1e-6;
