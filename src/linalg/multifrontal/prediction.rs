//! What a factorization would take on ranks of a machine that is not at hand: a model of the times of fronts and of messages.

use super::multifrontal_lu::roles;
use super::stretches::{Stretches, front_time};
use super::symbolic::Symbolic;
use crate::linalg::SparsePattern;

/// Time of a message on the way, and for each number in it \[ns\]: a network of 2 microseconds and 10 GB/s.
const MESSAGE: f64 = 2000.0;
const NUMBER: f64 = 0.8;

/// A factorization on some ranks of one thread each, beside one rank.
#[derive(Clone, Copy, Debug)]
pub struct OnRanks {
    /// How many.
    pub ranks: usize,
    /// How many times as fast.
    pub speed: f64,
    /// What the rank that sends most sends, in numbers.
    pub sent: f64,
}

/// Predicts a factorization of a pattern on ranks: each factors its subtrees, then its fronts with some of other ranks below, for whose
/// contributions it waits. The last one is the bound of any number of ranks of which one has each front, with the longest chain of fronts.
pub fn predicted(pattern: &SparsePattern, ranks: &[usize]) -> (Vec<OnRanks>, f64) {
    let symbolic = Symbolic::new(pattern, &roles(pattern, &[]));
    let mut chains: Vec<f64> = symbolic.fronts.iter().map(front_time).collect();
    let total: f64 = chains.iter().sum();
    for (number, front) in symbolic.fronts.iter().enumerate() {
        let below = symbolic.children[front.children.clone()].iter().map(|&child| chains[child as usize]);
        chains[number] += below.fold(0.0, f64::max);
    }
    let longest = chains.into_iter().fold(0.0, f64::max);
    (ranks.iter().map(|&ranks| on_ranks(&symbolic, ranks, total)).collect(), total / longest)
}

fn on_ranks(symbolic: &Symbolic, ranks: usize, total: f64) -> OnRanks {
    let stretches = Stretches::new(symbolic, ranks);
    let (mut clocks, mut sent) = (vec![0.0; ranks], vec![0.0; ranks]);
    let mut ends = vec![0.0; symbolic.fronts.len()];
    // what waits for nobody comes first
    let (parted, own): (Vec<usize>, Vec<usize>) = (0..ends.len()).partition(|&front| stretches.is_parted(symbolic, front));
    for number in own.into_iter().chain(parted) {
        let (front, owner) = (&symbolic.fronts[number], stretches.owner(number));
        let mut start: f64 = clocks[owner];
        for &child in &symbolic.children[front.children.clone()] {
            let sender = stretches.owner(child as usize);
            if sender != owner {
                let numbers = symbolic.fronts[child as usize].others().pow(2) as f64;
                sent[sender] += numbers;
                start = start.max(ends[child as usize] + MESSAGE + NUMBER * numbers);
            }
        }
        clocks[owner] = start + front_time(front);
        ends[number] = clocks[owner];
    }
    let most = |all: Vec<f64>| all.into_iter().fold(0.0, f64::max);
    OnRanks { ranks, speed: total / most(clocks), sent: most(sent) }
}

#[cfg(test)]
mod tests {
    use super::super::test_matrices::shell;
    use super::*;

    #[test]
    fn ranks_are_no_faster_than_their_number_or_the_longest_chain() {
        let pattern = shell(41, 0);
        let (all, bound) = predicted(&pattern, &[1, 2, 4, 8, 64]);
        assert_eq!((all[0].speed, all[0].sent), (1.0, 0.0));
        for (one, other) in all.iter().zip(&all[1..]) {
            assert!(other.speed <= bound.min(other.ranks as f64) && other.sent > 0.0, "{other:?} {bound}");
            assert!(one.ranks > 2 || other.speed > one.speed, "{one:?} {other:?}");
        }
        // two halves and what lies between them
        assert!(all[1].speed > 1.5, "{:?}", all[1]);
    }
}
