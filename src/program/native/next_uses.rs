//! When each number of a listing is read next: by this, registers are assigned.

use crate::program::listing::Listing;

/// A number that is never read (again).
pub const NEVER: u32 = u32::MAX;

/// Next uses of the numbers of a listing.
pub struct NextUses {
    /// For each number, the operation that reads it first.
    pub first: Vec<u32>,
    /// For each operand of each operation, the operation that reads the same number next.
    pub after: Vec<[u32; 3]>,
}

impl NextUses {
    /// Goes over the listing once, backwards.
    pub fn of(listing: &Listing) -> Self {
        let count = listing.operations.len();
        let mut uses = NextUses { first: vec![NEVER; count], after: vec![[NEVER; 3]; count] };
        for (number, operation) in listing.operations.iter().enumerate().rev() {
            let operands = operation.operands();
            for (after, operand) in uses.after[number].iter_mut().zip(&operands) {
                *after = uses.first[operand.0 as usize];
            }
            operands.into_iter().for_each(|operand| uses.first[operand.0 as usize] = number as u32);
        }
        uses
    }
}
