//! Signs of eigenvalues that round-off cannot have changed.
//!
//! A count by L D L^T is that of A + E. With s at least as large as E, A - s + E lies below A and A + s + E above it, so that
//!
//! ```text
//! negative ones of A + s + E  <=  negative ones of A  <=  negative ones of A - s + E:
//! ```
//!
//! what lies between the two counts, a distance of about s from zero, has no known sign. Constraints A of [K, A^T; A, 0] have a negative
//! eigenvalue each, whatever K is: where the second count finds no more, there are no more, and the first one is spared. So equilibria that stand
//! take one factorization, others two.
//!
//! Source: Weyl's inequality; Higham, Accuracy and stability of numerical algorithms, chapter 11, for the size of E.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::inertia::{Count, Inertia};

/// The shift that is tried first, in a matrix whose rows and columns have the size 1.
const FIRST_SHIFT: f64 = 1e-13;
/// Shifts that are tried until one is as large as the round-off of its count.
const MOST_SHIFTS: usize = 4;

/// Signs of a matrix of which counts are given for shifts of its diagonal, and of which so many negative eigenvalues are known.
pub fn known_signs(size: usize, known: usize, count: impl Fn(f64) -> Count) -> Inertia {
    let most = beyond(-1.0, &count).map_or(size, |below| below.negative + below.zero).max(known);
    let least = if most == known { known } else { beyond(1.0, &count).map_or(known, |above| above.negative.max(known)) };
    Inertia { negative: least, zero: most - least, positive: size - most }
}

/// The count with a shift on one side that is as large as its round-off; `None` where there is none.
fn beyond(side: f64, count: impl Fn(f64) -> Count) -> Option<Inertia> {
    let mut shift = FIRST_SHIFT;
    for _ in 0..MOST_SHIFTS {
        let Count { inertia, growth } = count(side * shift);
        let error = crate::tolerances::FACTORIZATION * growth;
        if error <= shift {
            return Some(inertia);
        }
        if !(error <= 1.0) {
            return None;
        }
        shift = 2.0 * error;
    }
    None
}
