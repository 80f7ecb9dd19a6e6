//! Where the sequence of fronts is cut for ranks that share some of them: a model of the times that they take, and a search.

use super::stretches::{Stretches, below, front_time, is_worth_sharing, pieces, shared_time};
use super::supernodes::factor_entries;
use super::symbolic::Symbolic;
use crate::exchange::MESSAGE;
use std::ops::Range;

/// How many pieces a cut is moved at a time.
const MOVES: [isize; 10] = [1, -1, 2, -2, 4, -4, 8, -8, 16, -16];
/// Times that all cuts are tried.
const ROUNDS: usize = 20;
/// What a number takes that a piece hands to one of another rank: to lay it down, to send it, and to add it \[ns\].
const HANDED: f64 = 4.8;
/// Solutions for each factorization, and the time of one for each entry of the factors; that of the matrix for each unknown \[ns\].
const SOLUTIONS: f64 = 5.0;
const OF_ENTRY: f64 = 0.46;
const OF_UNKNOWN: f64 = 560.0;
/// What it counts that some ranks have more to do for themselves than others, for which nobody waits yet: else a search would not see on which side of a
/// cut there is room.
const UNEVEN: f64 = 0.1;
/// How many unknowns elements have, which two ranks evaluate, for each row by which a piece of one contributes to a piece of the other: those
/// between the rows of two sides.
const AGAIN: usize = 2;

/// A piece of the tree of fronts.
struct Piece {
    fronts: Range<usize>,
    /// The first piece below it, or itself.
    first: usize,
    /// Pieces whose last fronts contribute to it.
    below: Vec<usize>,
    /// Of its factorization, and of solutions \[ns\].
    time: f64,
    solutions: f64,
    unknowns: usize,
    /// Rows that it contributes to.
    others: usize,
    is_worth_sharing: bool,
}

/// All pieces, in their order.
struct Pieces<'s> {
    symbolic: &'s Symbolic,
    all: Vec<Piece>,
}

impl<'s> Pieces<'s> {
    fn new(symbolic: &'s Symbolic) -> Self {
        let ranges = pieces(symbolic);
        let of_front = |front: usize| ranges.partition_point(|piece| piece.end <= front);
        let piece = |(fronts, below): (&Range<usize>, &Vec<usize>)| {
            let root = &symbolic.fronts[fronts.end - 1];
            let own = || symbolic.fronts[fronts.clone()].iter();
            let entries: usize = own().map(|front| factor_entries(front.pivots, front.size())).sum();
            Piece {
                fronts: fronts.clone(),
                first: of_front(root.subtree),
                below: below.iter().map(|&front| of_front(front)).collect(),
                time: own().map(front_time).sum(),
                solutions: SOLUTIONS * OF_ENTRY * entries as f64,
                unknowns: own().map(|front| front.pivots).sum(),
                others: root.others(),
                is_worth_sharing: !below.is_empty() && is_worth_sharing(root),
            }
        };
        Pieces { symbolic, all: ranges.iter().zip(&below(symbolic, &ranges)).map(piece).collect() }
    }

    /// What a matrix, its factorization and solutions take if ranks begin at given pieces \[ns\].
    fn cost(&self, starts: &[usize]) -> f64 {
        let owners: Vec<usize> =
            (0..self.all.len()).map(|piece| starts.partition_point(|&start| start <= piece) - 1).collect();
        let mut unknowns = vec![0; starts.len()];
        for (piece, &owner) in self.all.iter().zip(&owners) {
            let others = piece.below.iter().filter(|&&child| owners[child] != owner).map(|&child| self.all[child].others);
            unknowns[owner] += piece.unknowns + AGAIN * others.sum::<usize>();
        }
        let matrix = OF_UNKNOWN * unknowns.into_iter().max().unwrap_or(0) as f64;
        let handing = |numbers: usize| MESSAGE + HANDED * numbers as f64;
        let factorization = |piece: &Piece, ranks: usize| match ranks > 1 && piece.is_worth_sharing {
            true => (shared_time(&self.symbolic.fronts[piece.fronts.end - 1], ranks), true),
            false => (piece.time, false),
        };
        let factorization = self.path(&owners, starts.len(), factorization, |child| handing(child.others.pow(2)));
        // each front by its owner alone
        let solutions =
            self.path(&owners, starts.len(), |piece, _| (piece.solutions, false), |child| SOLUTIONS * handing(child.others));
        let own = self.own_times(&owners, starts.len(), |piece| piece.time);
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let uneven = own.iter().map(|time| (time - mean).abs()).sum::<f64>() / own.len() as f64;
        matrix + factorization + solutions + UNEVEN * uneven
    }

    /// Moves cuts as long as that costs less; returns the cost with them.
    fn searched(&self, mut starts: Vec<usize>) -> (f64, Vec<usize>) {
        let (ranks, mut least) = (starts.len(), self.cost(&starts));
        for _ in 0..ROUNDS {
            let before = least;
            for (rank, by) in (1..ranks).flat_map(|rank| MOVES.map(|by| (rank, by))) {
                let was = starts[rank];
                let range = starts[rank - 1]..=starts.get(rank + 1).copied().unwrap_or(self.all.len());
                let Some(moved) = was.checked_add_signed(by).filter(|moved| range.contains(moved)) else { continue };
                starts[rank] = moved;
                let cost = self.cost(&starts);
                if cost < least {
                    least = cost;
                } else {
                    starts[rank] = was;
                }
            }
            if least == before {
                break;
            }
        }
        (least, starts)
    }

    /// Times of ranks for pieces without some of others below them.
    fn own_times(&self, owners: &[usize], ranks: usize, time: impl Fn(&Piece) -> f64) -> Vec<f64> {
        let mut times = vec![0.0; ranks];
        for (piece, &owner) in self.all.iter().zip(owners).filter(|(piece, owner)| owners[piece.first] == **owner) {
            times[owner] += time(piece);
        }
        times
    }

    /// The time after which all pieces are done. Those that have some of others below them take a time that depends on the number of these ranks,
    /// which may share it, as they do what another rank hands to it.
    fn path(
        &self,
        owners: &[usize],
        ranks: usize,
        time: impl Fn(&Piece, usize) -> (f64, bool),
        handing: impl Fn(&Piece) -> f64,
    ) -> f64 {
        let is_parted = |&number: &usize| owners[self.all[number].first] < owners[number];
        let (mut clocks, mut ends) = (vec![0.0_f64; ranks], vec![0.0; self.all.len()]);
        // what waits for nobody comes first
        for number in (0..self.all.len()).filter(|number| !is_parted(number)) {
            clocks[owners[number]] += time(&self.all[number], 1).0;
            ends[number] = clocks[owners[number]];
        }
        for number in (0..self.all.len()).filter(is_parted) {
            let (piece, owner) = (&self.all[number], owners[number]);
            let (time, is_shared) = time(piece, owner + 1 - owners[piece.first]);
            let ranks = if is_shared { owners[piece.first]..owner + 1 } else { owner..owner + 1 };
            let share = 1.0 / ranks.len() as f64;
            let handed = piece.below.iter().filter(|&&child| owners[child] != owner || ranks.len() > 1);
            let handed: f64 = handed.map(|&child| share * handing(&self.all[child])).sum();
            let before = piece.below.iter().map(|&child| ends[child]).chain(clocks[ranks.clone()].iter().copied());
            let start = before.fold(0.0, f64::max) + handed;
            ends[number] = start + time;
            clocks[ranks].fill(ends[number]);
        }
        clocks.into_iter().fold(0.0, f64::max)
    }
}

/// Stretches for ranks: those that share no front, or equal ones, with each cut moved as long as a model says that less time is taken.
pub fn balanced(symbolic: &Symbolic, ranks: usize) -> Stretches {
    let pieces = Pieces::new(symbolic);
    let first = Stretches::new(symbolic, ranks);
    let of_front = |front: usize| pieces.all.partition_point(|piece| piece.fronts.end <= front);
    let of_first = (0..ranks).map(|rank| of_front(first.fronts(rank).start)).collect();
    let total: f64 = pieces.all.iter().map(|piece| piece.time).sum();
    let ends = pieces.all.iter().scan(0.0, |end, piece| {
        *end += piece.time;
        Some(*end)
    });
    let ends: Vec<f64> = ends.collect();
    let equal = (0..ranks).map(|rank| ends.partition_point(|&end| end <= total * rank as f64 / ranks as f64)).collect();
    let found = [of_first, equal].map(|starts| pieces.searched(starts));
    let [(one, starts), (other, others)] = found;
    let starts = if other < one { others } else { starts };
    let start = |&piece: &usize| pieces.all.get(piece).map_or(symbolic.fronts.len(), |piece| piece.fronts.start);
    first.with_starts(starts.iter().map(start).collect())
}
