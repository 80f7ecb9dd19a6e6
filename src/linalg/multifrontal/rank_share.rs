//! What one rank does of a factorization and of solutions: its stretch of the sequence of fronts.
//!
//! ```text
//! factor     subtrees of its own, and fronts above with the contributions of other ranks, in the order of children
//! forward    subtrees of its own, all ranks at once; then the residuals of fronts above, one rank after the other in the order of fronts
//! backward   from the last rank on: each sends the unknowns of fronts that have others' below them as soon as it knows them
//! ```
//!
//! Every number is the sum of the same terms in the same order as in one process, and has the same bits.

use super::factors::{Factors, Part};
use super::front::Contribution;
use super::stretches::Stretches;
use super::substitution::{BLOCK, Rows, Side, Substitution};
use super::symbolic::Symbolic;
use super::traversal::Piece;
use crate::exchange::{Exchange, digest};
use crate::linalg::{OwnUnknowns, Singular};
use std::ops::Range;

/// Pivots of a front that the front above looks for, in another stretch or in one that has fronts of several below.
struct Delayed {
    front: usize,
    parent: usize,
    /// Places of rows and of columns.
    places: [Vec<u32>; 2],
}

/// Fronts in the second part of the way forward.
struct Later {
    fronts: Range<usize>,
    /// Whether other ranks have fronts below: all of it waits for them, and not only what it takes from rows of fronts above.
    is_parted: bool,
}

/// The stretch of one rank.
pub struct RankShare {
    exchange: &'static dyn Exchange,
    stretches: Stretches,
    pieces: Vec<Piece>,
    /// Contributions of other ranks that came before they were needed.
    early: Vec<Received>,
    /// By place: rows that other ranks reduce before this one, or fronts with others' below them do, and their list.
    is_shared: Vec<bool>,
    shared: Vec<u32>,
    later: Vec<Later>,
    /// Places of rows that ranks before this one reduce, and of those that ranks before the next one do.
    running: [Vec<u32>; 2],
    /// Fronts of later ranks that have some of this one below them.
    above: Vec<usize>,
    delayed: Vec<Delayed>,
}

/// A contribution of another rank.
struct Received {
    front: usize,
    places: [Vec<u32>; 2],
    message: Vec<f64>,
    first: usize,
    is_broken: bool,
}

/// First numbers of messages: what they are.
const CONTRIBUTION: f64 = 1.0;
const RESIDUALS: f64 = 2.0;
const UNKNOWNS: f64 = 3.0;
/// Number of delayed pivots in the place of a contribution that there is not.
const BROKEN: f64 = -1.0;

impl RankShare {
    /// The stretch of this rank, for so many threads.
    pub fn new(symbolic: &Symbolic, stretches: Stretches, threads: usize, exchange: &'static dyn Exchange) -> Self {
        let (rank, ranks) = (exchange.rank(), exchange.ranks());
        let own = stretches.fronts(rank);
        let is_parted = |front: usize| stretches.is_parted(symbolic, front);
        let flops = symbolic.subtree_flops();
        let mut pieces = Vec::new();
        for front in own.clone() {
            let parent = symbolic.fronts[front].parent;
            if is_parted(front) {
                pieces.push(Piece::front(symbolic, front, threads));
            } else if parent.is_none_or(|parent| !own.contains(&parent) || is_parted(parent)) {
                pieces.push(Piece::subtree(symbolic, front, &flops, threads));
            }
        }
        let running =
            [rank, rank + 1].map(|rank| if rank < ranks { running(symbolic, &stretches, rank) } else { Vec::new() });
        let of_parted = own.clone().filter(|&front| is_parted(front)).map(|front| symbolic.fronts[front].rows.clone());
        let shared =
            sorted(running[0].iter().copied().chain(of_parted.flat_map(|rows| symbolic.rows[rows].iter().copied())));
        let mut is_shared = vec![false; symbolic.size];
        shared.iter().for_each(|&place| is_shared[place as usize] = true);
        let touches =
            |front: usize| symbolic.rows[symbolic.fronts[front].rows.clone()].iter().any(|&row| is_shared[row as usize]);
        let mut later: Vec<Later> = Vec::new();
        for front in own.clone().filter(|&front| is_parted(front) || touches(front)) {
            match later.last_mut() {
                Some(last) if last.fronts.end == front && !last.is_parted && !is_parted(front) => last.fronts.end += 1,
                _ => later.push(Later { fronts: front..front + 1, is_parted: is_parted(front) }),
            }
        }
        let is_above = |front: &usize| symbolic.fronts[*front].subtree < own.end && is_parted(*front);
        let above = (own.end..symbolic.fronts.len()).filter(|front| !own.is_empty() && is_above(front)).rev().collect();
        let (early, delayed) = (Vec::new(), Vec::new());
        RankShare { exchange, pieces, early, is_shared, shared, later, running, above, delayed, stretches }
    }

    /// Number of all ranks.
    pub fn ranks(&self) -> usize {
        self.exchange.ranks()
    }

    /// Unknowns whose pivots each rank looks for, but for those that wait for another one.
    pub fn own_unknowns(&self, symbolic: &Symbolic) -> OwnUnknowns {
        let of_rank = |rank| symbolic.order[self.stretches.places(symbolic, rank)].to_vec();
        OwnUnknowns::new(self.exchange, (0..self.ranks()).map(of_rank).collect())
    }

    /// Pivots of the last factorization that wait for a front of another rank.
    #[cfg(test)]
    pub fn delayed_across_ranks(&self) -> usize {
        let owner = |front| self.stretches.owner(front);
        let across = self.delayed.iter().filter(|delayed| owner(delayed.front) != owner(delayed.parent));
        across.map(|delayed| delayed.places[0].len()).sum()
    }

    /// Bytes of waiting contributions at their peak.
    pub fn bytes(&self) -> usize {
        self.pieces.iter().map(Piece::bytes).sum()
    }

    /// Factors values given in the order of the pattern.
    ///
    /// # Errors
    /// [`Singular`] with the column that has no pivot, on all ranks.
    pub fn factor(&mut self, symbolic: &Symbolic, values: &[f64], factors: &mut Factors) -> Result<(), Singular> {
        let own = self.stretches.fronts(self.exchange.rank());
        let (_, rest) = factors.part(symbolic).split_at(symbolic, own.start);
        let (mut part, _) = rest.split_at(symbolic, own.end);
        let (mut failure, mut is_broken) = (None, false);
        let mut delayed = Vec::new();
        for index in 0..self.pieces.len() {
            let (root, first) = (self.pieces[index].root(), self.pieces[index].fronts().start);
            let is_parted = self.stretches.is_parted(symbolic, root);
            let taken = if is_parted { self.take_children(symbolic, root) } else { Vec::new() };
            is_broken |= taken.iter().any(|child| child.is_broken);
            if !is_broken {
                let (before, rest) = self.pieces.split_at_mut(index);
                let (below, mut fronts) = part.reborrow().split_at(symbolic, first);
                let result = if is_parted {
                    let children = children(symbolic, root, &taken, before, &below);
                    rest[0].factor_front(symbolic, values, &mut fronts, &children)
                } else {
                    rest[0].factor(symbolic, values, fronts)
                };
                (is_broken, failure) = (result.is_err(), result.err());
            }
            let contribution = (!is_broken).then(|| self.pieces[index].contribution(symbolic, &part));
            self.hand_on(symbolic, root, contribution, &mut delayed);
            self.exchange.hurry();
        }
        self.agree(symbolic, failure, &delayed)
    }

    /// Contributions of other ranks to a front, whenever they come.
    fn take_children(&mut self, symbolic: &Symbolic, parent: usize) -> Vec<Received> {
        let mut taken = Vec::new();
        for &child in &symbolic.children[symbolic.fronts[parent].children.clone()] {
            let (child, owner) = (child as usize, self.stretches.owner(child as usize));
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
                    None => self.end_out_of_step(owner),
                }
            }
        }
        taken
    }

    /// Sends the contribution of a front to the rank that needs it, and notes delayed pivots that other ranks are to know.
    fn hand_on(&self, symbolic: &Symbolic, front: usize, contribution: Option<Contribution<'_>>, delayed: &mut Vec<f64>) {
        let Some(parent) = symbolic.fronts[front].parent else { return };
        let mut message = vec![CONTRIBUTION, front as f64];
        match contribution {
            Some(Contribution { delayed_rows, delayed_columns, values, .. }) => {
                message.push(delayed_rows.len() as f64);
                message.extend([delayed_rows, delayed_columns].into_iter().flatten().map(|&place| f64::from(place)));
                if !delayed_rows.is_empty() && self.stretches.is_parted(symbolic, parent) {
                    delayed.extend(&message[1..]);
                }
                message.extend_from_slice(values);
            }
            None => message.push(BROKEN),
        }
        let to = self.stretches.owner(parent);
        if to != self.exchange.rank() {
            self.exchange.send(to, message);
        }
    }

    /// All ranks know of the first failure, and of pivots that were delayed.
    fn agree(&mut self, symbolic: &Symbolic, failure: Option<Singular>, delayed: &[f64]) -> Result<(), Singular> {
        let failed = failure.map_or(BROKEN, |singular| singular.unknown as f64);
        let all = self.exchange.gather_lists(&[&[failed], delayed].concat());
        if let Some(failed) = all.iter().find(|other| other[0] != BROKEN) {
            return Err(Singular { unknown: failed[0] as usize });
        }
        self.delayed.clear();
        for mut rest in all.iter().map(|other| &other[1..]) {
            while let [front, count, after @ ..] = rest {
                let (places, after) = after.split_at(2 * *count as usize);
                let (rows, columns) = places.split_at(*count as usize);
                let places = [rows, columns].map(|list| list.iter().map(|&place| place as u32).collect());
                let (front, parent) = (*front as usize, symbolic.fronts[*front as usize].parent);
                let parent = parent.expect("what is delayed has a front above");
                self.delayed.push(Delayed { front, parent, places });
                rest = after;
            }
        }
        Ok(())
    }

    fn end_out_of_step(&self, other: usize) -> ! {
        self.exchange.end(&format!("rank {other} did something else at the same time"))
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
            substitution.load(symbolic, block);
            self.forward(symbolic, factors, substitution, side, block);
            self.backward(symbolic, factors, substitution, side);
            self.gather(symbolic, substitution, block);
            substitution.store(symbolic, block);
        }
    }

    fn forward(&mut self, symbolic: &Symbolic, factors: &Factors, substitution: &mut Substitution, side: Side, rhs: &[f64]) {
        for piece in self.pieces.iter().filter(|piece| !self.stretches.is_parted(symbolic, piece.root())) {
            substitution.forward(symbolic, factors, side, piece.fronts(), Rows::All);
        }
        let rank = self.exchange.rank();
        if rank > 0 {
            // what was subtracted above came before its turn
            for (residual, rhs) in substitution.residuals(symbolic).zip(rhs.chunks_exact(symbolic.size)) {
                for &place in &self.shared {
                    residual[place as usize] = rhs[symbolic.order[place as usize] as usize];
                }
            }
            let message = self.exchange.receive(rank - 1);
            let places = self.running_places(rank, side);
            self.put(&message, [RESIDUALS, rank as f64], &places, substitution.residuals(symbolic), rank - 1);
            for Later { fronts, is_parted } in &self.later {
                if *is_parted {
                    substitution.forward_late(symbolic, factors, side, fronts.start);
                } else {
                    let rows = Rows::Some(&self.is_shared);
                    substitution.forward(symbolic, factors, side, fronts.clone(), rows);
                }
            }
        }
        if rank + 1 < self.exchange.ranks() {
            let places = self.running_places(rank + 1, side);
            let message = take([RESIDUALS, (rank + 1) as f64], &places, substitution.residuals(symbolic));
            self.exchange.send(rank + 1, message);
        }
    }

    fn backward(&mut self, symbolic: &Symbolic, factors: &Factors, substitution: &mut Substitution, side: Side) {
        let rank = self.exchange.rank();
        for &front in &self.above {
            let owner = self.stretches.owner(front);
            let message = self.exchange.receive(owner);
            let places = self.places_of(symbolic, front, side);
            self.put(&message, [UNKNOWNS, front as f64], &places, substitution.solutions(symbolic), owner);
        }
        for piece in self.pieces.iter().rev() {
            self.exchange.hurry();
            substitution.backward(symbolic, factors, side, piece.fronts());
            let front = piece.root();
            let first = self.stretches.owner(symbolic.fronts[front].subtree);
            if first < rank {
                let places = self.places_of(symbolic, front, side);
                let message = take([UNKNOWNS, front as f64], &places, substitution.solutions(symbolic));
                let others = (first..rank).filter(|&other| !self.stretches.fronts(other).is_empty());
                others.for_each(|other| self.exchange.send(other, message.clone()));
            }
        }
    }

    /// Brings the unknowns of all ranks together, and compares what they were asked for.
    fn gather(&self, symbolic: &Symbolic, substitution: &mut Substitution, rhs: &[f64]) {
        let ranks = self.exchange.ranks();
        let places = |rank: usize| self.stretches.places(symbolic, rank);
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

    /// Places of residuals that the ranks before one leave to it: rows that they reduced, and those of pivots that wait for a front there or
    /// behind it.
    fn running_places(&self, rank: usize, side: Side) -> Vec<u32> {
        let rows = &self.running[rank - self.exchange.rank()];
        let waiting = self
            .delayed
            .iter()
            .filter(|delayed| self.stretches.owner(delayed.front) < rank && self.stretches.owner(delayed.parent) >= rank);
        let delayed = waiting.flat_map(|delayed| &delayed.places[usize::from(side == Side::Transposed)]);
        rows.iter().chain(delayed).copied().collect()
    }

    /// Places of the unknowns of a front, and of those that it took over from fronts below it.
    fn places_of(&self, symbolic: &Symbolic, front: usize, side: Side) -> Vec<u32> {
        let planned = &symbolic.fronts[front];
        let own = planned.first as u32..(planned.first + planned.pivots) as u32;
        let below = self.delayed.iter().filter(|delayed| delayed.parent == front);
        own.chain(below.flat_map(|delayed| delayed.places[usize::from(side == Side::Plain)].iter().copied())).collect()
    }

    /// Writes numbers of a message to their places in each vector.
    fn put<'v>(
        &self,
        message: &[f64],
        head: [f64; 2],
        places: &[u32],
        vectors: impl Iterator<Item = &'v mut [f64]>,
        from: usize,
    ) {
        let (heads, mut values) = message.split_at(head.len().min(message.len()));
        for vector in vectors {
            if heads != head || values.len() < places.len() {
                self.end_out_of_step(from);
            }
            let (own, rest) = values.split_at(places.len());
            places.iter().zip(own).for_each(|(&place, value)| vector[place as usize] = *value);
            values = rest;
        }
        if !values.is_empty() {
            self.end_out_of_step(from);
        }
    }
}

/// A message of numbers at some places of each vector.
fn take<'v>(head: [f64; 2], places: &[u32], vectors: impl Iterator<Item = &'v mut [f64]>) -> Vec<f64> {
    let mut message = head.to_vec();
    for vector in vectors {
        message.extend(places.iter().map(|&place| vector[place as usize]));
    }
    message
}

/// Each number once, in their order.
fn sorted(numbers: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut numbers: Vec<u32> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Places of rows in the stretch of a rank, or behind it, that fronts before it reduce.
fn running(symbolic: &Symbolic, stretches: &Stretches, rank: usize) -> Vec<u32> {
    let rows = |front: usize| symbolic.rows[symbolic.fronts[front].rows.clone()].iter().copied();
    sorted(stretches.waiting(symbolic, rank).flat_map(rows))
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
        let is_broken = delayed == BROKEN;
        let count = if is_broken { 0 } else { delayed as usize };
        let places = [0, 1].map(|list| message[3 + list * count..][..count].iter().map(|&place| place as u32).collect());
        Some(Received { front: front as usize, places, message, first: 3 + 2 * count, is_broken })
    }

    fn contribution(&self) -> Contribution<'_> {
        let [delayed_rows, delayed_columns] = &self.places;
        Contribution { front: self.front, delayed_rows, delayed_columns, values: &self.message[self.first..] }
    }
}
