//! The fronts of each rank or thread: the sequence of all, in which each stands after those below it, cut into stretches.

use super::pivots::PANEL;
use super::supernodes::elimination_flops;
use super::symbolic::{Front, Symbolic};
use crate::exchange::{MESSAGE, NUMBER};
use std::ops::Range;

/// Share of the time of all fronts that a piece has at most.
const SHARE: f64 = 1.0 / 128.0;

/// Pieces of the tree of fronts, which depend on nothing but the tree: subtrees that take little time, and fronts above them, large ones alone and
/// small ones together as long as they take little. The way forward of solutions adds up what pieces take from the rows of others piece by piece,
/// whoever has them.
pub fn pieces(symbolic: &Symbolic) -> Vec<Range<usize>> {
    let own: Vec<f64> = symbolic.fronts.iter().map(front_time).collect();
    let most = SHARE * own.iter().sum::<f64>();
    let mut subtrees = own.clone();
    for front in 0..own.len() {
        if let Some(parent) = symbolic.fronts[front].parent {
            subtrees[parent] += subtrees[front];
        }
    }
    // with the times that they take
    let mut pieces: Vec<(Range<usize>, f64)> = Vec::new();
    for (number, front) in symbolic.fronts.iter().enumerate() {
        if subtrees[number] > most {
            let (mut start, mut time) = (number, own[number]);
            while let Some((before, earlier)) = pieces.last()
                && front.is_small()
                && before.start >= front.subtree
                && time + earlier <= most
            {
                (start, time) = (before.start, time + earlier);
                pieces.pop();
            }
            pieces.push((start..number + 1, time));
        } else if front.parent.is_none_or(|parent| subtrees[parent] > most) {
            pieces.push((front.subtree..number + 1, subtrees[number]));
        }
    }
    pieces.into_iter().map(|(fronts, _)| fronts).collect()
}

/// For each piece, the last fronts of those that contribute to it.
pub fn below(symbolic: &Symbolic, pieces: &[Range<usize>]) -> Vec<Vec<usize>> {
    let mut below = vec![Vec::new(); pieces.len()];
    for piece in pieces {
        if let Some(parent) = symbolic.fronts[piece.end - 1].parent {
            below[pieces.partition_point(|other| other.end <= parent)].push(piece.end - 1);
        }
    }
    below
}

/// Stretches of the sequence of fronts, one of each rank or thread, each of whole pieces.
///
/// Only the last fronts of a tree have some below them that stand in stretches of other ranks: cuts are where these are few and small.
pub struct Stretches {
    /// The first front of each, and the end.
    starts: Vec<usize>,
    /// Whether ranks share all fronts that they can, or those that are worth it.
    shares_all: bool,
}

/// Time from which on a front is worth the messages of ranks that share it \[ns\]: some for each panel of it.
const SHARED: f64 = 5e5;

/// Time of a front for its calls, small and large, for an entry, and for an operation \[ns\].
const FRONT: [f64; 2] = [1000.0, 5800.0];
const ENTRY: f64 = 0.43;
const FLOP: f64 = 0.0101;
/// Time for an operation in panels, column by column, by that in products.
const SLOWER: f64 = 2.5;

/// Time of a front \[ns\], as measured on one core of 2023 where fronts are large: calls, assembly of the entries, arithmetic.
pub fn front_time(front: &Front) -> f64 {
    shared_time(front, 1)
}

/// The same of ranks that share it: they have entries and products of their own, and send each other panels of pivots, one after the other.
pub fn shared_time(front: &Front, ranks: usize) -> f64 {
    let (size, flops) = (front.size(), elimination_flops(front.pivots, front.size()));
    let alone = (SLOWER * FLOP * (2 * PANEL * front.pivots * size) as f64).min(FLOP * flops);
    let products = FLOP * flops - alone;
    let messages = match ranks {
        1 => 0.0,
        _ => front.pivots.div_ceil(PANEL) as f64 * MESSAGE + NUMBER * (front.pivots * (size + front.others())) as f64,
    };
    let shared = ENTRY * size.pow(2) as f64 + products;
    FRONT[usize::from(!front.is_small())] + alone + messages + shared / ranks as f64
}

/// Whether it is worth the messages to share a front.
pub fn is_worth_sharing(front: &Front) -> bool {
    !front.is_small() && front_time(front) > SHARED
}

impl Stretches {
    /// For a number of ranks: a cut is where the fronts before it take a share of the time, and those that it parts from fronts below them, little.
    pub fn new(symbolic: &Symbolic, ranks: usize) -> Self {
        let count = symbolic.fronts.len();
        // time before each front, and time of all fronts that a cut there parts from some below them
        let (mut before, mut parted) = (vec![0.0; count + 1], vec![0.0; count + 1]);
        for (number, front) in symbolic.fronts.iter().enumerate() {
            let time = front_time(front);
            before[number + 1] = before[number] + time;
            parted[front.subtree + 1] += time;
            parted[number + 1] -= time;
        }
        (1..=count).for_each(|cut| parted[cut] += parted[cut - 1]);
        let (mut starts, pieces) = (vec![0], pieces(symbolic));
        for rank in 1..ranks {
            let target = before[count] * rank as f64 / ranks as f64;
            let cost = |cut: usize| (before[cut] - target).abs() + parted[cut];
            let first = starts[rank - 1];
            let cuts = pieces.iter().map(|piece| piece.end).filter(|&cut| cut >= first);
            starts.push(cuts.min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(count));
        }
        starts.push(count);
        Stretches { starts, shares_all: false }
    }

    /// Cut before the pieces of given fronts.
    #[cfg(test)]
    pub fn at(symbolic: &Symbolic, cuts: &[usize]) -> Self {
        let (pieces, count) = (pieces(symbolic), symbolic.fronts.len());
        let start = |cut: &usize| pieces.iter().find(|piece| piece.contains(cut)).map_or(count, |piece| piece.start);
        Stretches { starts: [&[0], &cuts.iter().map(start).collect::<Vec<_>>()[..], &[count]].concat(), shares_all: false }
    }

    /// With all fronts shared that can be.
    #[cfg(test)]
    pub fn sharing_all(self) -> Self {
        Stretches { shares_all: true, ..self }
    }

    /// The same that begin at other fronts.
    pub fn with_starts(self, mut starts: Vec<usize>) -> Self {
        starts.extend(self.starts.last());
        Stretches { starts, ..self }
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Fronts of a rank.
    pub fn fronts(&self, rank: usize) -> Range<usize> {
        self.starts[rank]..self.starts[rank + 1]
    }

    /// The rank of a front.
    pub fn owner(&self, front: usize) -> usize {
        self.starts.partition_point(|&start| start <= front) - 1
    }

    /// Whether another rank has fronts below one.
    pub fn is_parted(&self, symbolic: &Symbolic, front: usize) -> bool {
        symbolic.fronts[front].subtree < self.starts[self.owner(front)]
    }

    /// Ranks that factor a front: the one that has it and, where it takes long, all others with fronts below it.
    pub fn ranks_of(&self, symbolic: &Symbolic, front: usize) -> Vec<usize> {
        let (owner, planned) = (self.owner(front), &symbolic.fronts[front]);
        let is_shared = is_worth_sharing(planned) || self.shares_all && !planned.is_small();
        let first = if is_shared { self.owner(planned.subtree) } else { owner };
        let others = (first..owner).filter(|&rank| !self.fronts(rank).is_empty());
        std::iter::once(owner).chain(others).collect()
    }

    /// Places of the unknowns of a rank.
    pub fn places(&self, symbolic: &Symbolic, rank: usize) -> Range<usize> {
        let place = |front: usize| symbolic.fronts.get(front).map_or(symbolic.size, |front| front.first);
        place(self.starts[rank])..place(self.starts[rank + 1])
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_matrices::shell;
    use super::*;

    #[test]
    fn cuts_are_between_the_halves_of_a_mesh_and_part_few_fronts() {
        let pattern = shell(41, 0);
        let symbolic = Symbolic::new(&pattern);
        let total: f64 = symbolic.fronts.iter().map(front_time).sum();
        for ranks in [2, 3, 4] {
            let stretches = Stretches::new(&symbolic, ranks);
            for rank in 0..ranks {
                let own: f64 = symbolic.fronts[stretches.fronts(rank)].iter().map(front_time).sum();
                assert!((own * ranks as f64 / total - 1.0).abs() < 0.4, "rank {rank} of {ranks}: {own} of {total}");
            }
            let parted = (0..symbolic.fronts.len()).filter(|&front| stretches.is_parted(&symbolic, front)).count();
            assert!(parted <= 8 * ranks, "{parted} of {} fronts", symbolic.fronts.len());
        }
    }
}
