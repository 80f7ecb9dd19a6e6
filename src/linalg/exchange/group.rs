//! Some of all ranks, which follow each other and share work that the others do not.

use super::{Exchange, Traffic};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Ranks of others, counted from the first one of them.
pub(super) struct Group {
    of: &'static dyn Exchange,
    first: usize,
    ranks: usize,
}

/// All groups so far, each once: they live as long as the process, as what is shared among them may.
static GROUPS: Mutex<Vec<&'static Group>> = Mutex::new(Vec::new());
/// The number of the group that shares the work of now among them, from 1 on; 0 where all ranks do.
static NOW: AtomicUsize = AtomicUsize::new(0);

fn groups() -> MutexGuard<'static, Vec<&'static Group>> {
    GROUPS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The group that shares the work of now, where not all ranks do.
pub(super) fn now() -> Option<&'static dyn Exchange> {
    match NOW.load(Ordering::Relaxed) {
        0 => None,
        number => Some(groups()[number - 1]),
    }
}

/// Runs work that some of the ranks of now share, this one among them, as if there were no others.
pub(super) fn in_group<R>(
    of: &'static dyn Exchange,
    ranks: Range<usize>,
    work: impl FnOnce(&'static dyn Exchange) -> R,
) -> R {
    assert!(ranks.contains(&of.rank()), "rank {} is none of {ranks:?}", of.rank());
    if ranks.len() == of.ranks() {
        return work(of);
    }
    let (number, group) = numbered(of, ranks);
    // one thread changes it: others that work at the same time are in a group of one, which has no smaller one
    let before = NOW.swap(number, Ordering::Relaxed);
    let result = work(group);
    NOW.store(before, Ordering::Relaxed);
    result
}

fn numbered(of: &'static dyn Exchange, ranks: Range<usize>) -> (usize, &'static Group) {
    let mut groups = groups();
    let is_it =
        |own: &&Group| std::ptr::addr_eq(own.of, of) && (own.first, own.first + own.ranks) == (ranks.start, ranks.end);
    let place = groups.iter().position(is_it).unwrap_or_else(|| {
        groups.push(Box::leak(Box::new(Group { of, first: ranks.start, ranks: ranks.len() })));
        groups.len() - 1
    });
    (place + 1, groups[place])
}

impl Exchange for Group {
    fn rank(&self) -> usize {
        self.of.rank() - self.first
    }
    fn ranks(&self) -> usize {
        self.ranks
    }
    fn send(&self, to: usize, message: Vec<f64>) {
        self.of.send(self.first + to, message);
    }
    fn hurry(&self) {
        self.of.hurry();
    }
    fn receive(&self, from: usize) -> Vec<f64> {
        self.of.receive(self.first + from)
    }
    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        self.of.receive_if_there(self.first + from)
    }
    fn longest_wait(&self) -> Duration {
        self.of.longest_wait()
    }
    fn traffic(&self) -> Traffic {
        self.of.traffic()
    }
    #[cfg(feature = "mumps")]
    fn communicator(&self, ranks: Range<usize>) -> Option<std::ffi::c_int> {
        self.of.communicator(self.first + ranks.start..self.first + ranks.end)
    }
    fn end(&self, reason: &str) -> ! {
        self.of.end(reason)
    }
    fn waited_in_vain(&self, what: &str) -> ! {
        self.of.waited_in_vain(what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::on_ranks;

    #[test]
    fn a_group_counts_its_ranks_and_gathers_of_them_alone() {
        let per_rank = on_ranks(5, |world| {
            let team = [0..1, 1..4, 1..4, 1..4, 4..5][world.rank()].clone();
            in_group(world, team, |group| {
                let counts: Vec<usize> = (1..=group.ranks()).collect();
                let own = vec![world.rank() as f64; group.rank() + 1];
                // a group of a group has ranks of its own, too
                let pair = if group.rank() < 2 && group.ranks() > 1 { 0..2 } else { group.rank()..group.rank() + 1 };
                let inner = in_group(group, pair, |pair| pair.gather(&[world.rank() as f64], &vec![1; pair.ranks()]));
                (group.gather(&own, &counts), group.gather_lists(&own[1..]), inner)
            })
        });
        let of_three = (vec![1.0, 2.0, 2.0, 3.0, 3.0, 3.0], vec![vec![], vec![2.0], vec![3.0; 2]]);
        let alone = |rank: f64| (vec![rank], vec![vec![]], vec![rank]);
        let shared = |inner: &[f64]| (of_three.0.clone(), of_three.1.clone(), inner.to_vec());
        assert_eq!(per_rank, [alone(0.0), shared(&[1.0, 2.0]), shared(&[1.0, 2.0]), shared(&[3.0]), alone(4.0)]);
    }

    #[test]
    fn a_group_is_made_once() {
        let first = on_ranks(1, |world| {
            let of = |ranks: Range<usize>| numbered(world, ranks).0;
            let all = [of(0..2), of(0..3), of(0..2), of(1..3), of(0..3)];
            (all[0] == all[2], all[1] == all[4], all[0] != all[1] && all[1] != all[3])
        });
        assert_eq!(first, [(true, true, true)]);
    }
}
