//! To whom unknowns belong: ranks, or threads.

use std::ops::Range;

/// The owner of each unknown.
pub struct Owners {
    owners: Vec<u32>,
    count: usize,
}

impl Owners {
    /// Of owners that have all unknowns together, each once.
    pub fn new(of_each: &[Vec<u32>]) -> Self {
        let mut owners = vec![0; of_each.iter().map(Vec::len).sum()];
        for (owner, own) in of_each.iter().enumerate() {
            own.iter().for_each(|&unknown| owners[unknown as usize] = owner as u32);
        }
        Owners { owners, count: of_each.len() }
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// How many unknowns there are.
    pub fn unknowns(&self) -> usize {
        self.owners.len()
    }

    /// The owner of an unknown.
    pub fn of(&self, unknown: usize) -> usize {
        self.owners[unknown] as usize
    }

    /// Whether an owner has any of some unknowns.
    pub fn has_any(&self, owner: usize, mut unknowns: Range<usize>) -> bool {
        unknowns.any(|unknown| self.of(unknown) == owner)
    }

    /// Whether an owner has all of some unknowns.
    pub fn has_all(&self, owner: usize, mut unknowns: Range<usize>) -> bool {
        unknowns.all(|unknown| self.of(unknown) == owner)
    }
}
