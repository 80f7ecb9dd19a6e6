//! What one rank does of a factorization and of solutions: its stretch of the sequence of fronts.
//!
//! Of a factorization these are subtrees of its own, and fronts above with the contributions of other ranks, in the order of children.
//! Every number is the sum of the same terms in the same order as in one process, and has the same bits.

use super::factors::{Factors, Part};
use super::front::Contribution;
use super::stretch_solution::{Delayed, StretchSolution, delayed, end_out_of_step};
use super::stretches::Stretches;
use super::substitution::{BLOCK, Side, Substitution};
use super::symbolic::Symbolic;
use super::traversal::Piece;
use crate::exchange::{Exchange, digest};
use crate::linalg::{OwnUnknowns, Singular};
use std::ops::Range;
use std::sync::Arc;

/// The stretch of one rank.
pub struct RankShare {
    exchange: &'static dyn Exchange,
    pieces: Vec<Piece>,
    /// Contributions of other ranks that came before they were needed.
    early: Vec<Received>,
    solution: StretchSolution,
}

/// A contribution of another rank.
struct Received {
    front: usize,
    places: [Vec<u32>; 2],
    message: Vec<f64>,
    first: usize,
}

/// First number of its message.
const CONTRIBUTION: f64 = 1.0;
/// In the place of an unknown that has no pivot, where all have one.
const REGULAR: f64 = -1.0;

impl RankShare {
    /// The stretch of this rank, for so many threads.
    pub fn new(symbolic: &Symbolic, stretches: Stretches, threads: usize, exchange: &'static dyn Exchange) -> Self {
        let solution = StretchSolution::new(symbolic, Arc::new(stretches), exchange.rank());
        let flops = symbolic.subtree_flops();
        let piece = |(fronts, is_parted): &(Range<usize>, bool)| match is_parted {
            true => Piece::front(symbolic, fronts.start, threads),
            false => Piece::subtree(symbolic, fronts.end - 1, &flops, threads),
        };
        let pieces = solution.subtrees.iter().map(piece).collect();
        RankShare { exchange, pieces, early: Vec::new(), solution }
    }

    /// Number of all ranks.
    pub fn ranks(&self) -> usize {
        self.exchange.ranks()
    }

    /// Unknowns whose pivots each rank looks for, but for those that wait for another one.
    pub fn own_unknowns(&self, symbolic: &Symbolic) -> OwnUnknowns {
        let of_rank = |rank| symbolic.order[self.solution.stretches.places(symbolic, rank)].to_vec();
        OwnUnknowns::new(self.exchange, (0..self.ranks()).map(of_rank).collect())
    }

    /// Pivots of the last factorization that wait for a front of another rank.
    #[cfg(test)]
    pub fn delayed_across_ranks(&self) -> usize {
        let owner = |front| self.solution.stretches.owner(front);
        let across = self.solution.delayed.iter().filter(|delayed| owner(delayed.front) != owner(delayed.parent));
        across.map(|delayed| delayed.places[0].len()).sum()
    }

    /// Bytes of waiting contributions at their peak.
    pub fn bytes(&self) -> usize {
        self.pieces.iter().map(Piece::bytes).sum()
    }

    /// Factors values given in the order of the pattern.
    ///
    /// Only a last front finds that there is no pivot: all others leave it to the one above. So whoever waits for a contribution gets it, and
    /// every last front is looked at, of which the first in the order of elimination tells, as in one process.
    ///
    /// # Errors
    /// [`Singular`] with the column that has no pivot, on all ranks.
    pub fn factor(&mut self, symbolic: &Symbolic, values: &[f64], factors: &mut Factors) -> Result<(), Singular> {
        let own = self.solution.stretches.fronts(self.exchange.rank());
        let (_, rest) = factors.part(symbolic).split_at(symbolic, own.start);
        let (mut part, _) = rest.split_at(symbolic, own.end);
        let mut failure: Option<(usize, Singular)> = None;
        // what waits for nobody comes first
        let is_parted = |index: &usize| self.solution.subtrees[*index].1;
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_by_key(is_parted);
        for index in order {
            let (root, first) = (self.pieces[index].root(), self.pieces[index].fronts().start);
            let is_parted = self.solution.stretches.is_parted(symbolic, root);
            let taken = if is_parted { self.take_children(symbolic, root) } else { Vec::new() };
            let (before, rest) = self.pieces.split_at_mut(index);
            let (below, mut fronts) = part.reborrow().split_at(symbolic, first);
            let result = if is_parted {
                let children = children(symbolic, root, &taken, before, &below);
                rest[0].factor_front(symbolic, values, &mut fronts, &children)
            } else {
                rest[0].factor(symbolic, values, fronts)
            };
            match result {
                Ok(()) => self.hand_on(symbolic, root, self.pieces[index].contribution(symbolic, &part)),
                Err(singular) => failure = failure.filter(|&(earlier, _)| earlier < root).or(Some((root, singular))),
            }
            self.exchange.hurry();
        }
        let delayed = if failure.is_some() { Vec::new() } else { delayed(symbolic, &part, &self.solution.pieces) };
        self.agree(symbolic, failure.map(|(_, singular)| singular), delayed)
    }

    /// Contributions of other ranks to a front, whenever they come.
    fn take_children(&mut self, symbolic: &Symbolic, parent: usize) -> Vec<Received> {
        let mut taken = Vec::new();
        for &child in &symbolic.children[symbolic.fronts[parent].children.clone()] {
            let (child, owner) = (child as usize, self.solution.stretches.owner(child as usize));
            if owner == self.exchange.rank() {
                continue;
            }
            loop {
                if let Some(place) = self.early.iter().position(|early| early.front == child) {
                    taken.push(self.early.swap_remove(place));
                    break;
                }
                let received = Received::new(self.exchange.receive(owner));
                match received {
                    Some(received) => self.early.push(received),
                    None => end_out_of_step(self.exchange, owner),
                }
            }
        }
        taken
    }

    /// Sends the contribution of a front to the rank that needs it.
    fn hand_on(&self, symbolic: &Symbolic, front: usize, contribution: Contribution<'_>) {
        let Some(parent) = symbolic.fronts[front].parent else { return };
        let to = self.solution.stretches.owner(parent);
        if to != self.exchange.rank() {
            let Contribution { delayed_rows, delayed_columns, values, .. } = contribution;
            let mut message = vec![CONTRIBUTION, front as f64, delayed_rows.len() as f64];
            message.extend([delayed_rows, delayed_columns].into_iter().flatten().map(|&place| f64::from(place)));
            message.extend_from_slice(values);
            self.exchange.send(to, message);
        }
    }

    /// All ranks know of the first failure, and of pivots that were delayed.
    fn agree(&mut self, symbolic: &Symbolic, failure: Option<Singular>, delayed: Vec<Delayed>) -> Result<(), Singular> {
        let failed = failure.map_or(REGULAR, |singular| singular.unknown as f64);
        let mut own = vec![failed];
        for Delayed { front, places: [rows, columns], .. } in delayed {
            own.extend([front as f64, rows.len() as f64]);
            own.extend(rows.iter().chain(&columns).map(|&place| f64::from(place)));
        }
        let all = self.exchange.gather_lists(&own);
        // stretches follow each other as the fronts do
        if let Some(failed) = all.iter().find(|other| other[0] != REGULAR) {
            return Err(Singular { unknown: failed[0] as usize });
        }
        self.solution.delayed.clear();
        for mut rest in all.iter().map(|other| &other[1..]) {
            while let [front, count, after @ ..] = rest {
                let (places, after) = after.split_at(2 * *count as usize);
                let (rows, columns) = places.split_at(*count as usize);
                let places = [rows, columns].map(|list| list.iter().map(|&place| place as u32).collect());
                let (front, parent) = (*front as usize, symbolic.fronts[*front as usize].parent);
                let parent = parent.expect("what is delayed has a front above");
                self.solution.delayed.push(Delayed { front, parent, places });
                rest = after;
            }
        }
        Ok(())
    }

    /// Replaces right-hand sides, column by column, by solutions.
    pub fn solve(
        &mut self,
        symbolic: &Symbolic,
        factors: &mut Factors,
        substitution: &mut Substitution,
        side: Side,
        rhs: &mut [f64],
    ) {
        if side == Side::Transposed {
            factors.transpose(symbolic);
        }
        for block in rhs.chunks_mut(BLOCK * symbolic.size.max(1)) {
            self.solution.forward(self.exchange, (symbolic, factors), substitution, side, block);
            self.solution.backward(self.exchange, (symbolic, factors), substitution, side);
            self.gather(symbolic, substitution, block);
            substitution.store(symbolic, block);
        }
    }

    /// Brings the unknowns of all ranks together, and compares what they were asked for.
    fn gather(&self, symbolic: &Symbolic, substitution: &mut Substitution, rhs: &[f64]) {
        let ranks = self.exchange.ranks();
        let places = |rank: usize| self.solution.stretches.places(symbolic, rank);
        let columns = rhs.len() / symbolic.size;
        let mut own = vec![digest(rhs)];
        for solution in substitution.solutions(symbolic) {
            own.extend_from_slice(&solution[places(self.exchange.rank())]);
        }
        let counts: Vec<usize> = (0..ranks).map(|rank| 1 + columns * places(rank).len()).collect();
        let all = self.exchange.gather(&own, &counts);
        let mut rest = &all[..];
        for (rank, count) in counts.into_iter().enumerate() {
            let (others, after) = rest.split_at(count);
            rest = after;
            if others[0] != all[0] {
                self.exchange.end(&format!("rank {rank} has other numbers than rank 0: are all processors the same?"));
            }
            let lists = others[1..].chunks_exact(places(rank).len().max(1));
            for (solution, list) in substitution.solutions(symbolic).zip(lists) {
                solution[places(rank)].copy_from_slice(list);
            }
        }
    }
}

/// Contributions to a front in the order of its children: those of other ranks, and those of pieces before it, whose factors are `below`.
fn children<'c>(
    symbolic: &Symbolic,
    parent: usize,
    taken: &'c [Received],
    before: &'c [Piece],
    below: &'c Part<'_>,
) -> Vec<Contribution<'c>> {
    let of_child = |child: &u32| {
        let child = *child as usize;
        match taken.iter().find(|taken| taken.front == child) {
            Some(taken) => taken.contribution(),
            None => {
                let place =
                    before.binary_search_by_key(&child, Piece::root).expect("a child of a parted front ends a piece");
                before[place].contribution(symbolic, below)
            }
        }
    };
    symbolic.children[symbolic.fronts[parent].children.clone()].iter().map(of_child).collect()
}

impl Received {
    /// What a message says; nothing if it is no contribution.
    fn new(message: Vec<f64>) -> Option<Self> {
        let &[CONTRIBUTION, front, delayed, ..] = &message[..] else { return None };
        let count = delayed as usize;
        let places = [0, 1].map(|list| message[3 + list * count..][..count].iter().map(|&place| place as u32).collect());
        Some(Received { front: front as usize, places, message, first: 3 + 2 * count })
    }

    fn contribution(&self) -> Contribution<'_> {
        let [delayed_rows, delayed_columns] = &self.places;
        Contribution { front: self.front, delayed_rows, delayed_columns, values: &self.message[self.first..] }
    }
}
