//! Bytes of which each of several ranks keeps a slice.

use super::flat::{numbers_of, set_bytes};
use crate::exchange::{Exchange, world};
use std::fmt;

/// Bytes that each rank keeps all of: bringing fewer together takes longer than reading them.
const WHOLE: usize = 1 << 16;

/// Bytes that all ranks have, in slices; all of them where there is one process.
#[derive(Clone)]
pub(super) struct Sliced {
    /// The slice of this rank.
    own: Box<[u8]>,
    length: usize,
    world: &'static dyn Exchange,
}

impl fmt::Debug for Sliced {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} of {} bytes", self.own.len(), self.length)
    }
}

impl Sliced {
    /// Of bytes that all ranks of now have.
    pub fn new(bytes: Vec<u8>) -> Self {
        Self::among(world(), bytes)
    }

    fn among(world: &'static dyn Exchange, mut bytes: Vec<u8>) -> Self {
        let length = bytes.len();
        if length >= WHOLE && world.ranks() > 1 {
            let [start, end] = [0, 1].map(|next| first_of(world.rank() + next, length, world.ranks()));
            bytes.copy_within(start..end, 0);
            bytes.truncate(end - start);
        }
        Sliced { own: bytes.into(), length, world }
    }

    pub fn length(&self) -> usize {
        self.length
    }

    pub fn kept(&self) -> usize {
        self.own.len()
    }

    /// All bytes, in a list where they have to be brought together: all ranks ask for them.
    pub fn all<'b>(&'b self, list: &'b mut Vec<u8>) -> &'b [u8] {
        if self.own.len() == self.length {
            return &self.own;
        }
        let ranks = self.world.ranks();
        let first = |rank: usize| first_of(rank, self.length, ranks).div_ceil(WORD);
        let counts: Vec<usize> = (0..ranks).map(|rank| first(rank + 1) - first(rank)).collect();
        set_bytes(list, &self.world.gather(&numbers_of(&self.own), &counts));
        list.truncate(self.length);
        list
    }
}

const WORD: usize = 8;

/// Where the slice of a rank begins; behind the last one the end.
fn first_of(rank: usize, length: usize, ranks: usize) -> usize {
    (length.div_ceil(WORD) * rank / ranks * WORD).min(length)
}

/// Most bytes that a rank keeps of so many.
pub(super) fn most_kept(length: usize) -> usize {
    let ranks = world().ranks();
    if length < WHOLE { length } else { length.div_ceil(WORD).div_ceil(ranks) * WORD }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::on_ranks;

    #[test]
    fn slices_of_all_ranks_are_the_bytes_of_each() {
        for length in [0, 5, WHOLE - 1, WHOLE, WHOLE + 3, 3 * WHOLE + 16] {
            let bytes: Vec<u8> = (0..length).map(|place| (place * 37 % 251) as u8).collect();
            for ranks in [1, 2, 3, 5] {
                let kept = on_ranks(ranks, |world| {
                    let sliced = Sliced::among(world, bytes.clone());
                    assert_eq!(sliced.all(&mut vec![7; 3]), bytes, "{length} bytes on {ranks} ranks");
                    sliced.kept()
                });
                let is_whole = length < WHOLE;
                assert_eq!(kept.iter().sum::<usize>(), if is_whole { ranks * length } else { length });
                assert!(is_whole || kept.iter().all(|&kept| kept <= length.div_ceil(ranks) + WORD));
            }
        }
    }
}
