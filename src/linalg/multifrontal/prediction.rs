//! What a factorization would take on ranks of a machine that is not at hand: a model of the times of fronts and of messages.

use super::balance::balanced;
use super::multifrontal_lu::roles;
use super::stretches::{front_time, shared_time, team_time};
use super::symbolic::Symbolic;
use crate::exchange::{MESSAGE, NUMBER};
use crate::linalg::SparsePattern;

/// A factorization on some ranks with some threads each, beside one of one.
#[derive(Clone, Copy, Debug)]
pub struct OnRanks {
    /// How many.
    pub ranks: usize,
    /// Of each.
    pub threads: usize,
    /// How many times as fast.
    pub speed: f64,
    /// What the rank that sends most sends, in numbers.
    pub sent: f64,
}

/// Predicts a factorization of a pattern on numbers of ranks, with numbers of threads each.
///
/// A rank factors its subtrees, then its fronts with some of other ranks below, for whose contributions it waits, those that take long together
/// with these. Its threads take subtrees, and form a team for each front above these that is as large as its share of the time. The last number
/// is the bound of any number of ranks with one thread, if one had each front: the longest chain of fronts.
pub fn predicted(pattern: &SparsePattern, ranks: &[usize], threads: &[usize]) -> (Vec<OnRanks>, f64) {
    let symbolic = Symbolic::new(pattern, &roles(pattern, &[]));
    let mut chains: Vec<f64> = symbolic.fronts.iter().map(front_time).collect();
    let total: f64 = chains.iter().sum();
    for (number, front) in symbolic.fronts.iter().enumerate() {
        let below = symbolic.children[front.children.clone()].iter().map(|&child| chains[child as usize]);
        chains[number] += below.fold(0.0, f64::max);
    }
    let longest = chains.into_iter().fold(0.0, f64::max);
    let layouts = threads.iter().flat_map(|&threads| ranks.iter().map(move |&ranks| (ranks, threads)));
    (layouts.map(|(ranks, threads)| on_ranks(&symbolic, ranks, threads, total)).collect(), total / longest)
}

fn on_ranks(symbolic: &Symbolic, ranks: usize, threads: usize, total: f64) -> OnRanks {
    let stretches = balanced(symbolic, ranks);
    let (mut clocks, mut sent) = (vec![0.0_f64; ranks], vec![0.0; ranks]);
    let (mut ends, mut below) = (vec![0.0; symbolic.fronts.len()], vec![0.0; symbolic.fronts.len()]);
    let children =
        |number: usize| symbolic.children[symbolic.fronts[number].children.clone()].iter().map(|&own| own as usize);
    // what waits for nobody comes first
    let (parted, own): (Vec<usize>, Vec<usize>) = (0..ends.len()).partition(|&front| stretches.is_parted(symbolic, front));
    let (mut done, mut whole) = (vec![0.0; ranks], vec![0.0; ranks]);
    for &number in &own {
        let time = front_time(&symbolic.fronts[number]);
        below[number] = time + children(number).map(|child| below[child]).sum::<f64>();
        whole[stretches.owner(number)] += time;
    }
    for number in own {
        let (front, owner) = (&symbolic.fronts[number], stretches.owner(number));
        done[owner] += front_time(front);
        let team = threads as f64 * below[number] / whole[owner];
        let chain = if team > 1.0 {
            team_time(front, team) + children(number).map(|child| ends[child]).fold(0.0, f64::max)
        } else {
            below[number]
        };
        ends[number] = chain.max(done[owner] / threads as f64);
        clocks[owner] = clocks[owner].max(ends[number]);
    }
    for number in parted {
        let (front, owner) = (&symbolic.fronts[number], stretches.owner(number));
        let team = stretches.team(symbolic, number);
        let share = 1.0 / team.len() as f64;
        let mut start = team.iter().map(|&rank| clocks[rank]).fold(0.0, f64::max);
        for child in children(number) {
            let senders = match stretches.is_parted(symbolic, child) {
                true => stretches.team(symbolic, child),
                false => vec![stretches.owner(child)],
            };
            let numbers = symbolic.fronts[child].others().pow(2) as f64;
            let is_there = team == [owner] && senders == [owner];
            start = start.max(ends[child] + if is_there { 0.0 } else { MESSAGE + NUMBER * share * numbers });
            for &sender in &senders {
                let kept = if team.contains(&sender) { share } else { 0.0 };
                sent[sender] += numbers / senders.len() as f64 * (1.0 - kept);
            }
        }
        let end = start + shared_time(front, team.len(), threads as f64);
        for (member, &rank) in team.iter().enumerate() {
            clocks[rank] = end;
            // panels to all others, and the rows of pivots to the first
            let panels = front.pivots * front.size() * (team.len() - 1);
            let rows = if member > 0 { front.pivots * front.others() } else { 0 };
            sent[rank] += share * (panels + rows) as f64;
        }
        ends[number] = end;
    }
    let most = |all: Vec<f64>| all.into_iter().fold(0.0, f64::max);
    OnRanks { ranks, threads, speed: total / most(clocks), sent: most(sent) }
}

#[cfg(test)]
mod tests {
    use super::super::test_matrices::shell;
    use super::*;

    #[test]
    fn ranks_are_no_faster_than_their_number_or_the_longest_chain() {
        let pattern = shell(41, 0);
        let (all, bound) = predicted(&pattern, &[1, 2, 4, 8, 64], &[1]);
        assert_eq!((all[0].speed, all[0].sent), (1.0, 0.0));
        for (one, other) in all.iter().zip(&all[1..]) {
            assert!(other.speed <= bound.min(other.ranks as f64) && other.sent > 0.0, "{other:?} {bound}");
            assert!(one.ranks > 2 || other.speed > one.speed, "{one:?} {other:?}");
        }
        // two halves and what lies between them
        assert!(all[1].speed > 1.5, "{:?}", all[1]);
        let (on_threads, _) = predicted(&pattern, &[1, 2, 4, 8, 64], &[2]);
        for (one, two) in all.iter().zip(&on_threads) {
            let gain = two.speed / one.speed;
            assert!(gain > 1.0 && gain <= 2.0 + 1e-12 && two.sent == one.sent, "{one:?} {two:?}");
        }
    }
}
