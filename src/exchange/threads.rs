//! Ranks that are threads of one process, for tests.

use super::Exchange;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex};
use std::time::Duration;

/// After which a rank that failed is not waited for, where a test does not say.
const LONGEST_WAIT: Duration = Duration::from_secs(60);

/// Messages that are on their way between two ranks, by receivers and senders.
struct Post {
    ranks: usize,
    longest_wait: Duration,
    waiting: Mutex<Vec<VecDeque<Vec<f64>>>>,
    came: Condvar,
}

struct Thread {
    rank: usize,
    post: &'static Post,
}

impl Exchange for Thread {
    fn rank(&self) -> usize {
        self.rank
    }
    fn ranks(&self) -> usize {
        self.post.ranks
    }
    fn send(&self, to: usize, message: Vec<f64>) {
        assert_ne!(to, self.rank, "a message to itself");
        self.post.waiting.lock().expect("no rank has failed")[to * self.post.ranks + self.rank].push_back(message);
        self.post.came.notify_all();
    }
    fn receive(&self, from: usize) -> Vec<f64> {
        let own = self.rank * self.post.ranks + from;
        let mut waiting = self.post.waiting.lock().expect("no rank has failed");
        loop {
            if let Some(message) = waiting[own].pop_front() {
                return message;
            }
            let (lock, waited) = self.post.came.wait_timeout(waiting, self.post.longest_wait).expect("no rank has failed");
            assert!(!waited.timed_out(), "rank {}: no message of rank {from}", self.rank);
            waiting = lock;
        }
    }
    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        self.post.waiting.lock().expect("no rank has failed")[self.rank * self.post.ranks + from].pop_front()
    }
    fn longest_wait(&self) -> Duration {
        self.post.longest_wait
    }
    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        assert_eq!(own.len(), counts[self.rank]);
        let others = || (0..self.post.ranks).filter(|&rank| rank != self.rank);
        others().for_each(|rank| self.send(rank, own.to_vec()));
        let of = |rank: usize| if rank == self.rank { own.to_vec() } else { self.receive(rank) };
        (0..self.post.ranks).flat_map(of).collect()
    }
    fn end(&self, reason: &str) -> ! {
        panic!("{reason}")
    }
}

/// What each of some ranks gives, which all run the same.
pub(crate) fn on_ranks<R: Send>(ranks: usize, run: impl Fn(&'static dyn Exchange) -> R + Sync) -> Vec<R> {
    on_ranks_within(LONGEST_WAIT, ranks, run)
}

/// The same for ranks that do not wait longer for each other.
pub(crate) fn on_ranks_within<R: Send>(
    longest_wait: Duration,
    ranks: usize,
    run: impl Fn(&'static dyn Exchange) -> R + Sync,
) -> Vec<R> {
    // ranks live as long as the process, as those of `mpirun` do
    let post = Post { ranks, longest_wait, waiting: Mutex::new(vec![VecDeque::new(); ranks * ranks]), came: Condvar::new() };
    let post: &'static Post = Box::leak(Box::new(post));
    std::thread::scope(|scope| {
        let start = |rank: usize| -> &'static dyn Exchange { Box::leak(Box::new(Thread { rank, post })) };
        let started: Vec<_> = (0..ranks)
            .map(|rank| {
                scope.spawn({
                    let run = &run;
                    move || run(start(rank))
                })
            })
            .collect();
        started.into_iter().map(|thread| thread.join().expect("no rank has failed")).collect()
    })
}
