//! Solutions by several stretches of the sequence of fronts at once, those of ranks or of threads.
//!
//! ```text
//! forward    pieces of its own: what each takes from rows of fronts above goes to the front above it, which adds it up in the order of children
//! backward   from the last stretch on: each sends the unknowns of fronts that have others' below them as soon as it knows them
//! ```
//!
//! Pieces depend on the tree alone, so that every number has the same bits whatever the number of stretches.

use super::factors::{Factors, Part};
use super::stretches::{Stretches, below, pieces};
use super::substitution::{Side, Substitution};
use super::symbolic::Symbolic;
use crate::exchange::Exchange;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Pivots of the last front of a piece that the front above looks for.
#[derive(Clone)]
pub struct Delayed {
    pub front: usize,
    pub parent: usize,
    /// Places of rows and of columns.
    pub places: [Vec<u32>; 2],
}

/// What a stretch does of solutions.
pub struct StretchSolution {
    /// Its number.
    number: usize,
    pub stretches: Arc<Stretches>,
    /// Its pieces: subtrees at first, and then those that others have to come before, with the last fronts of these.
    pub pieces: Vec<(Range<usize>, Vec<usize>)>,
    /// Its fronts by subtrees of its own, and fronts that have some of other stretches below them, which are said to be parted.
    pub subtrees: Vec<(Range<usize>, bool)>,
    /// Fronts of later stretches that have some of this one below them.
    above: Vec<usize>,
    /// Pivots of the last factorization that wait, of all pieces.
    pub delayed: Vec<Delayed>,
}

/// What a piece takes from the rows of others, vector by vector, with its last front.
type Taken = (usize, Vec<f64>);

/// First numbers of messages: what they are.
const REDUCED: f64 = 2.0;
const UNKNOWNS: f64 = 3.0;

impl StretchSolution {
    /// Of the stretch with a number.
    pub fn new(symbolic: &Symbolic, stretches: Arc<Stretches>, number: usize) -> Self {
        let own = stretches.fronts(number);
        let is_parted = |front: usize| stretches.is_parted(symbolic, front);
        let mut subtrees = Vec::new();
        for front in own.clone() {
            let parent = symbolic.fronts[front].parent;
            if is_parted(front) {
                subtrees.push((front..front + 1, true));
            } else if parent.is_none_or(|parent| !own.contains(&parent) || is_parted(parent)) {
                subtrees.push((symbolic.fronts[front].subtree..front + 1, false));
            }
        }
        let all = pieces(symbolic);
        let below = below(symbolic, &all);
        let mut pieces: Vec<_> = all.into_iter().zip(below).filter(|(piece, _)| own.contains(&piece.start)).collect();
        pieces.sort_by_key(|(_, below)| !below.is_empty());
        let is_above = |front: &usize| symbolic.fronts[*front].subtree < own.end && is_parted(*front);
        let above = (own.end..symbolic.fronts.len()).filter(|front| !own.is_empty() && is_above(front)).rev().collect();
        StretchSolution { number, pieces, subtrees, above, delayed: Vec::new(), stretches }
    }

    /// The way forward, of right-hand sides that lie one after the other.
    pub fn forward(
        &self,
        exchange: &dyn Exchange,
        (symbolic, factors): (&Symbolic, &Factors),
        substitution: &mut Substitution,
        side: Side,
        rhs: &[f64],
    ) {
        substitution.make_room(symbolic, rhs);
        let mut waiting: Vec<Taken> = Vec::new();
        for (piece, below) in &self.pieces {
            let root = piece.end - 1;
            let own = symbolic.fronts[piece.start].first..symbolic.fronts[root].first + symbolic.fronts[root].pivots;
            let others = &symbolic.rows[symbolic.fronts[root].rows.clone()];
            for (residual, rhs) in substitution.residuals(symbolic).zip(rhs.chunks_exact(symbolic.size)) {
                let given = symbolic.order[own.clone()].iter().map(|&unknown| rhs[unknown as usize]);
                residual[own.clone()].iter_mut().zip(given).for_each(|(own, given)| *own = given);
                others.iter().for_each(|&place| residual[place as usize] = 0.0);
            }
            for &child in below {
                self.add_taken(exchange, (symbolic, child), &mut waiting, substitution, side);
            }
            match below.is_empty() {
                true => substitution.forward(symbolic, factors, side, piece.clone()),
                false => substitution.forward_late(symbolic, factors, side, piece.clone()),
            }
            let Some(parent) = symbolic.fronts[root].parent else { continue };
            let places = self.taken_places(symbolic, root, side);
            let message = take([REDUCED, root as f64], &places, substitution.residuals(symbolic));
            match self.stretches.owner(parent) {
                owner if owner == self.number => waiting.push((root, message)),
                owner => exchange.send(owner, message),
            }
        }
    }

    /// Adds what a piece took from rows of a front above it, whose residuals stand there; those of pivots that wait are its own.
    fn add_taken(
        &self,
        exchange: &dyn Exchange,
        (symbolic, child): (&Symbolic, usize),
        waiting: &mut Vec<Taken>,
        substitution: &mut Substitution,
        side: Side,
    ) {
        let owner = self.stretches.owner(child);
        let taken = loop {
            if let Some(place) = waiting.iter().position(|taken| taken.0 == child) {
                break waiting.swap_remove(place).1;
            }
            let message = exchange.receive(owner);
            match message[..] {
                [REDUCED, front, ..] => waiting.push((front as usize, message)),
                _ => end_out_of_step(exchange, owner),
            }
        };
        let (others, places) = (symbolic.fronts[child].others(), self.taken_places(symbolic, child, side));
        let columns = substitution.residuals(symbolic).count();
        if taken.len() != 2 + columns * places.len() {
            end_out_of_step(exchange, owner);
        }
        for (residual, taken) in substitution.residuals(symbolic).zip(taken[2..].chunks_exact(places.len().max(1))) {
            for (number, (&place, value)) in places.iter().zip(taken).enumerate() {
                let residual = &mut residual[place as usize];
                *residual = if number < others { *residual + value } else { *value };
            }
        }
    }

    /// Places of residuals that a piece leaves to the front above its last one: rows that it reduced, and those of pivots that wait.
    fn taken_places<'s>(&self, symbolic: &'s Symbolic, root: usize, side: Side) -> Cow<'s, [u32]> {
        let others = &symbolic.rows[symbolic.fronts[root].rows.clone()];
        let delayed = self.delayed.iter().filter(|delayed| delayed.front == root);
        let mut delayed = delayed.flat_map(|delayed| &delayed.places[usize::from(side == Side::Transposed)]).peekable();
        match delayed.peek() {
            None => Cow::Borrowed(others),
            Some(_) => others.iter().chain(delayed).copied().collect(),
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
        // others wait for those that have some of theirs below
        let (parted, whole): (Vec<_>, Vec<_>) = self.subtrees.iter().rev().partition(|(_, is_parted)| *is_parted);
        for (fronts, _) in parted.into_iter().chain(whole) {
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

    /// Places of the unknowns of a front, and of those that it took over from fronts below it.
    fn places_of(&self, symbolic: &Symbolic, front: usize, side: Side) -> Vec<u32> {
        let planned = &symbolic.fronts[front];
        let own = planned.first as u32..(planned.first + planned.pivots) as u32;
        let below = self.delayed.iter().filter(|delayed| delayed.parent == front);
        own.chain(below.flat_map(|delayed| delayed.places[usize::from(side == Side::Plain)].iter().copied())).collect()
    }
}

/// Pivots of pieces that wait.
pub fn delayed(symbolic: &Symbolic, part: &Part<'_>, pieces: &[(Range<usize>, Vec<usize>)]) -> Vec<Delayed> {
    let of_piece = |(piece, _): &(Range<usize>, Vec<usize>)| {
        let front = piece.end - 1;
        let (parent, places) = (symbolic.fronts[front].parent?, part.delayed(front).map(<[u32]>::to_vec));
        (!places[0].is_empty()).then_some(Delayed { front, parent, places })
    };
    pieces.iter().filter_map(of_piece).collect()
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
