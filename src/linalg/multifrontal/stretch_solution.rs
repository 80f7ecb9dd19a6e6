//! Solutions by several stretches of the sequence of fronts at once, those of ranks or of threads.
//!
//! ```text
//! forward    subtrees of its own, all stretches at once; then the residuals of fronts above, one stretch after the other in the order of fronts
//! backward   from the last stretch on: each sends the unknowns of fronts that have others' below them as soon as it knows them
//! ```

use super::factors::Factors;
use super::stretches::Stretches;
use super::substitution::{Rows, Side, Substitution};
use super::symbolic::Symbolic;
use crate::exchange::Exchange;
use std::ops::Range;
use std::sync::Arc;

/// Pivots of a front that the front above looks for, in another stretch or in one that has fronts of several below.
#[derive(Clone)]
pub struct Delayed {
    pub front: usize,
    pub parent: usize,
    /// Places of rows and of columns.
    pub places: [Vec<u32>; 2],
}

/// Fronts in the second part of the way forward.
struct Later {
    fronts: Range<usize>,
    /// Whether other ranks have fronts below: all of it waits for them, and not only what it takes from rows of fronts above.
    is_parted: bool,
}

/// What a stretch does of solutions.
pub struct StretchSolution {
    /// Its number.
    number: usize,
    pub stretches: Arc<Stretches>,
    /// Subtrees of its own, and fronts that have some of other stretches below them, which are said to be parted.
    pub pieces: Vec<(Range<usize>, bool)>,
    /// By place: rows that other stretches reduce before this one, or fronts with others' below them do, and their list.
    is_shared: Vec<bool>,
    shared: Vec<u32>,
    later: Vec<Later>,
    /// Places of rows that stretches before this one reduce, and of those that stretches before the next one do.
    running: [Vec<u32>; 2],
    /// Fronts of later stretches that have some of this one below them.
    above: Vec<usize>,
    /// Pivots of the last factorization that wait for a front of another stretch.
    pub delayed: Vec<Delayed>,
}

/// First numbers of messages: what they are.
const RESIDUALS: f64 = 2.0;
const UNKNOWNS: f64 = 3.0;

impl StretchSolution {
    /// Of the stretch with a number.
    pub fn new(symbolic: &Symbolic, stretches: Arc<Stretches>, number: usize) -> Self {
        let (rank, own) = (number, stretches.fronts(number));
        let is_parted = |front: usize| stretches.is_parted(symbolic, front);
        let mut pieces = Vec::new();
        for front in own.clone() {
            let parent = symbolic.fronts[front].parent;
            if is_parted(front) {
                pieces.push((front..front + 1, true));
            } else if parent.is_none_or(|parent| !own.contains(&parent) || is_parted(parent)) {
                pieces.push((symbolic.fronts[front].subtree..front + 1, false));
            }
        }
        let running = [rank, rank + 1]
            .map(|rank| if rank < stretches.count() { running(symbolic, &stretches, rank) } else { Vec::new() });
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
        let delayed = Vec::new();
        StretchSolution { number, pieces, is_shared, shared, later, running, above, delayed, stretches }
    }

    /// Places of right-hand sides that it begins with: its own, and rows that it reduces for others.
    pub fn given(&self, symbolic: &Symbolic) -> impl Iterator<Item = usize> {
        let reduced = self.running[1].iter().map(|&place| place as usize);
        self.stretches.places(symbolic, self.number).chain(reduced)
    }

    /// The way forward, after the stretches before this one; residuals of its own rows and of those that it reduces are loaded.
    pub fn forward(
        &self,
        exchange: &dyn Exchange,
        (symbolic, factors): (&Symbolic, &Factors),
        substitution: &mut Substitution,
        side: Side,
        rhs: &[f64],
    ) {
        for (fronts, _) in self.pieces.iter().filter(|(_, is_parted)| !is_parted) {
            substitution.forward(symbolic, factors, side, fronts.clone(), Rows::All);
        }
        let rank = self.number;
        if rank > 0 {
            // what was subtracted above came before its turn
            for (residual, rhs) in substitution.residuals(symbolic).zip(rhs.chunks_exact(symbolic.size)) {
                for &place in &self.shared {
                    residual[place as usize] = rhs[symbolic.order[place as usize] as usize];
                }
            }
            let message = exchange.receive(rank - 1);
            let places = self.running_places(rank, side);
            put(exchange, &message, [RESIDUALS, rank as f64], &places, substitution.residuals(symbolic), rank - 1);
            for Later { fronts, is_parted } in &self.later {
                if *is_parted {
                    substitution.forward_late(symbolic, factors, side, fronts.start);
                } else {
                    let rows = Rows::Some(&self.is_shared);
                    substitution.forward(symbolic, factors, side, fronts.clone(), rows);
                }
            }
        }
        if rank + 1 < exchange.ranks() {
            let places = self.running_places(rank + 1, side);
            let message = take([RESIDUALS, (rank + 1) as f64], &places, substitution.residuals(symbolic));
            exchange.send(rank + 1, message);
        }
    }

    /// The way back, behind the stretches after this one.
    pub fn backward(
        &self,
        exchange: &dyn Exchange,
        (symbolic, factors): (&Symbolic, &Factors),
        substitution: &mut Substitution,
        side: Side,
    ) {
        let rank = self.number;
        for &front in &self.above {
            let owner = self.stretches.owner(front);
            let message = exchange.receive(owner);
            let places = self.places_of(symbolic, front, side);
            put(exchange, &message, [UNKNOWNS, front as f64], &places, substitution.solutions(symbolic), owner);
        }
        for (fronts, _) in self.pieces.iter().rev() {
            exchange.hurry();
            substitution.backward(symbolic, factors, side, fronts.clone());
            let front = fronts.end - 1;
            let first = self.stretches.owner(symbolic.fronts[front].subtree);
            if first < rank {
                let places = self.places_of(symbolic, front, side);
                let message = take([UNKNOWNS, front as f64], &places, substitution.solutions(symbolic));
                let others = (first..rank).filter(|&other| !self.stretches.fronts(other).is_empty());
                others.for_each(|other| exchange.send(other, message.clone()));
            }
        }
    }

    /// Places of residuals that the ranks before one leave to it: rows that they reduced, and those of pivots that wait for a front there or
    /// behind it.
    fn running_places(&self, rank: usize, side: Side) -> Vec<u32> {
        let rows = &self.running[rank - self.number];
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
}

/// Ends what others do in another order.
pub fn end_out_of_step(exchange: &dyn Exchange, other: usize) -> ! {
    exchange.end(&format!("rank {other} did something else at the same time"))
}

/// Writes numbers of a message to their places in each vector.
fn put<'v>(
    exchange: &dyn Exchange,
    message: &[f64],
    head: [f64; 2],
    places: &[u32],
    vectors: impl Iterator<Item = &'v mut [f64]>,
    from: usize,
) {
    let (heads, mut values) = message.split_at(head.len().min(message.len()));
    for vector in vectors {
        if heads != head || values.len() < places.len() {
            end_out_of_step(exchange, from);
        }
        let (own, rest) = values.split_at(places.len());
        places.iter().zip(own).for_each(|(&place, value)| vector[place as usize] = *value);
        values = rest;
    }
    if !values.is_empty() {
        end_out_of_step(exchange, from);
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
