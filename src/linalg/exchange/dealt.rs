//! Work that is dealt: each rank, or each team of some, does other parts of it, for itself, however long it takes.

use super::group::in_group;
use super::{Exchange, Sent, new_thread};
use std::ops::Range;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{Scope, ScopedJoinHandle};
use std::time::{Duration, Instant};

/// Signs of life within the longest wait for one.
const SIGNS: u32 = 4;
/// Between two looks for messages.
const PAUSE: Duration = Duration::from_millis(5);

/// What a message of a rank at work begins with; a sign of life is empty.
const RESULT: f64 = 1.0;
const DONE: f64 = 2.0;

/// Does the work of a team of ranks, which share it, while the others do theirs, and returns what came of all, by ranks. Messages between ranks of a
/// team are those of its work; the others tell each other that they are at it.
pub fn gather_work<T: Sent>(
    world: &'static dyn Exchange,
    team: Range<usize>,
    work: impl FnOnce(&'static dyn Exchange) -> T,
) -> Vec<T> {
    let mut early = vec![Vec::new(); world.ranks()];
    let of_others = others(world).filter(|rank| !team.contains(rank));
    let takes = |rank: usize, result| early[rank] = result;
    let mut own = Some(at_work(world, team.clone(), (of_others.clone(), of_others), takes, work));
    tell(world, &own);
    let of = |rank: usize| match rank == world.rank() {
        true => own.take(),
        false => Some(after_work(world, rank, std::mem::take(&mut early[rank]))),
    };
    (0..world.ranks()).filter_map(of).collect()
}

/// Does the work of this rank while the others do theirs. The first one sees each result as soon as it is there, with its number, until it
/// wants no more; true if it saw all. The function that the work is given shows them. [`of_first_at_work`] has to follow, which reads what signs
/// of life the first one has sent.
pub fn see_work<T: Sent>(
    world: &'static dyn Exchange,
    work: impl FnOnce(&(dyn Fn(usize, T) + Sync)),
    see: impl FnMut(usize, T) -> bool + Send,
) -> bool {
    let own = world.rank()..world.rank() + 1;
    if world.rank() > 0 {
        // the first one tells nothing else before all are done
        at_work(
            world,
            own,
            (0..1, 0..1),
            |_, _| {},
            |_| {
                work(&|number, result| {
                    let mut message = vec![RESULT];
                    (number, result).write(&mut message);
                    world.send(0, message);
                })
            },
        );
        world.send(0, vec![DONE]);
        return true;
    }
    let see = Mutex::new((see, true));
    let shown = |number: usize, result: T| {
        let (see, goes_on) = &mut *see.lock().unwrap_or_else(PoisonError::into_inner);
        *goes_on = *goes_on && see(number, result);
        *goes_on
    };
    at_work(
        world,
        own,
        (others(world), 0..0),
        |_, _| {},
        |_| {
            std::thread::scope(|scope| {
                let (own_end, other_end) = channel();
                let shown = &shown;
                let listener = (world.ranks() > 1).then(|| start(world, scope, move || listen(world, shown, &other_end)));
                work(&|number, result| {
                    shown(number, result);
                });
                let _ = listener.map(ScopedJoinHandle::join);
                drop(own_end);
            });
        },
    );
    see.into_inner().unwrap_or_else(PoisonError::into_inner).1
}

/// What the first rank tells all, as soon as it has done its work; its signs of life have come so long.
pub fn of_first_at_work<T: Sent>(world: &dyn Exchange, own: Option<T>) -> T {
    if own.is_some() {
        tell(world, &own);
    }
    own.unwrap_or_else(|| after_work(world, 0, Vec::new()))
}

/// Tells all others what came of this rank's work.
fn tell<T: Sent>(world: &dyn Exchange, own: &Option<T>) {
    let mut message = vec![DONE];
    own.iter().for_each(|own| own.write(&mut message));
    others(world).for_each(|rank| world.send(rank, message.clone()));
}

fn others(world: &dyn Exchange) -> impl Iterator<Item = usize> + Clone + use<> {
    let (own, ranks) = (world.rank(), world.ranks());
    (0..ranks).filter(move |&rank| rank != own)
}

/// What a rank has sent behind its signs of life; the last message of it may be there.
fn after_work<T: Sent>(world: &dyn Exchange, rank: usize, mut message: Vec<f64>) -> T {
    loop {
        if let [DONE, result @ ..] = &message[..] {
            return T::read(&mut result.iter());
        }
        message = world.receive(rank);
    }
}

/// Shows the first rank what others have found, until all of them are done, or nobody looks any more.
fn listen<T: Sent>(world: &dyn Exchange, shown: &dyn Fn(usize, T) -> bool, at_work_here: &Receiver<()>) {
    let mut at_work: Vec<(usize, Instant)> = others(world).map(|rank| (rank, Instant::now())).collect();
    let mut goes_on = true;
    while goes_on && !at_work.is_empty() && is_there(at_work_here) {
        hear(world, &mut at_work, |_, message| {
            if let [RESULT, rest @ ..] = &message[..] {
                let (number, result) = Sent::read(&mut rest.iter());
                goes_on &= shown(number, result);
            }
            !matches!(message[..], [DONE, ..])
        });
    }
}

/// Takes what ranks have sent that are at work, since a time each, and leaves out those that do not go on; ends all where one is silent.
fn hear(world: &dyn Exchange, at_work: &mut Vec<(usize, Instant)>, mut goes_on: impl FnMut(usize, Vec<f64>) -> bool) {
    at_work.retain_mut(|(rank, heard)| {
        while let Some(message) = world.receive_if_there(*rank) {
            *heard = Instant::now();
            if !goes_on(*rank, message) {
                return false;
            }
        }
        if heard.elapsed() > world.longest_wait() {
            world.waited_in_vain(&format!("sign of rank {rank}"));
        }
        true
    });
}

/// Work of a team that takes as long as it takes: some others are told that this rank is at it, and of some it hears that they are, until one says
/// more.
fn at_work<R>(
    world: &'static dyn Exchange,
    team: Range<usize>,
    (told, heard): (impl Iterator<Item = usize> + Clone + Send, impl Iterator<Item = usize>),
    mut takes: impl FnMut(usize, Vec<f64>) + Send,
    work: impl FnOnce(&'static dyn Exchange) -> R,
) -> R {
    if team.len() == world.ranks() {
        return work(world);
    }
    let (own_end, other_end) = channel();
    let mut heard: Vec<(usize, Instant)> = heard.map(|rank| (rank, Instant::now())).collect();
    std::thread::scope(|scope| {
        start(world, scope, move || {
            let mut last_sign = Instant::now();
            while is_there(&other_end) {
                world.hurry();
                if last_sign.elapsed() > world.longest_wait() / SIGNS {
                    told.clone().for_each(|rank| world.send(rank, Vec::new()));
                    last_sign = Instant::now();
                }
                hear(world, &mut heard, |rank, message| {
                    let is_sign = message.is_empty();
                    if !is_sign {
                        takes(rank, message);
                    }
                    is_sign
                });
            }
        });
        let _own_end = own_end;
        in_group(world, team, work)
    })
}

/// Starts a thread beside the one that works: without it, ranks would not know of each other.
fn start<'s>(world: &dyn Exchange, scope: &'s Scope<'s, '_>, run: impl FnOnce() + Send + 's) -> ScopedJoinHandle<'s, ()> {
    let started = new_thread().spawn_scoped(scope, run);
    started.unwrap_or_else(|refused| world.end(&format!("the system starts no thread: {refused}")))
}

/// Waits a little; whether the other end is still there, which a panic drops, too.
fn is_there(other_end: &Receiver<()>) -> bool {
    other_end.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::{on_ranks, on_ranks_within};

    #[test]
    fn the_first_rank_sees_results_while_others_work_and_tells_all() {
        let per_rank = on_ranks(3, |world| {
            let mut seen = vec![0; 7];
            let all = see_work(
                world,
                |found| (world.rank()..7).step_by(3).for_each(|number| found(number, number * number)),
                |number, result: usize| {
                    seen[number] += result;
                    true
                },
            );
            assert!(all);
            of_first_at_work(world, (world.rank() == 0).then_some(seen))
        });
        assert_eq!(per_rank, vec![vec![0, 1, 4, 9, 16, 25, 36]; 3]);
    }

    #[test]
    fn work_may_take_longer_than_ranks_wait() {
        let limit = Duration::from_millis(800);
        let own = |world: &dyn Exchange| world.rank()..world.rank() + 1;
        let work = |world: &dyn Exchange| std::thread::sleep(if world.rank() == 1 { 3 * limit } else { Duration::ZERO });
        let gathered = on_ranks_within(limit, 3, |world| {
            let all = gather_work(world, own(world), |_| {
                work(world);
                world.rank()
            });
            let mut seen = 0;
            let see = |_, rank: usize| {
                seen += rank;
                true
            };
            see_work(
                world,
                |found| {
                    work(world);
                    found(0, world.rank());
                },
                see,
            );
            (all, of_first_at_work(world, (world.rank() == 0).then_some(seen)))
        });
        assert_eq!(gathered, vec![(vec![0, 1, 2], 3); 3]);
    }

    #[test]
    fn teams_share_their_work_while_others_are_at_theirs() {
        let limit = Duration::from_millis(500);
        let teams = [0..2, 2..3, 3..6];
        let per_rank = on_ranks_within(limit, 6, |world| {
            let place = teams.iter().position(|team| team.contains(&world.rank())).expect("a team of each");
            // one team after the other takes longer than ranks wait, while messages go to and fro in it
            [0, 2].map(|late| {
                gather_work(world, teams[place].clone(), |team| {
                    let mut sums = Vec::new();
                    for round in 0..12 {
                        if place == late {
                            std::thread::sleep(limit / 4);
                        }
                        let own = (10 * world.rank() + round) as f64;
                        sums.push(team.gather(&[own], &vec![1; team.ranks()]).iter().sum::<f64>());
                    }
                    sums
                })
            })
        });
        let sums = |team: &Range<usize>| -> Vec<f64> {
            (0..12).map(|round| team.clone().map(|rank| (10 * rank + round) as f64).sum()).collect()
        };
        let expected: Vec<Vec<f64>> = teams.iter().flat_map(|team| vec![sums(team); team.len()]).collect();
        assert!(per_rank.iter().flatten().all(|all| *all == expected), "{per_rank:?}");
    }

    #[test]
    fn the_first_rank_may_stop_looking() {
        let all = on_ranks(2, |world| {
            let work = |found: &(dyn Fn(usize, usize) + Sync)| found(world.rank(), 0);
            see_work(world, work, |_, _| false)
        });
        assert_eq!(all, [false, true]);
    }
}
