//! Threads of one process that send each other messages as ranks do.

use super::Exchange;
use std::collections::VecDeque;
use std::io;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use std::time::Duration;

/// After which one that failed is not waited for, where nobody says otherwise.
const LONGEST_WAIT: Duration = Duration::from_secs(60);
/// Looks for a message without falling asleep, which takes about as long to wake up from.
const LOOKS: usize = 2000;

/// Messages that are on their way between two threads, by receivers and senders.
struct Post {
    ranks: usize,
    longest_wait: Duration,
    waiting: Mutex<Vec<VecDeque<Vec<f64>>>>,
    came: Condvar,
    /// A thread is not there, or no longer: nobody waits for it.
    is_over: AtomicBool,
}

struct Thread<'p> {
    rank: usize,
    post: &'p Post,
}

impl Post {
    fn new(longest_wait: Duration, ranks: usize) -> Self {
        let waiting = Mutex::new(vec![VecDeque::new(); ranks * ranks]);
        Post { ranks, longest_wait, waiting, came: Condvar::new(), is_over: AtomicBool::new(false) }
    }

    /// Ends all threads that wait, or will.
    fn end(&self) {
        // with the lock: whoever has seen that it goes on waits already
        let _waiting = self.waiting();
        self.is_over.store(true, Ordering::Relaxed);
        self.came.notify_all();
    }

    fn waiting(&self) -> MutexGuard<'_, Vec<VecDeque<Vec<f64>>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Thread<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.post.end();
        }
    }
}

impl Exchange for Thread<'_> {
    fn rank(&self) -> usize {
        self.rank
    }
    fn ranks(&self) -> usize {
        self.post.ranks
    }
    fn send(&self, to: usize, message: Vec<f64>) {
        assert_ne!(to, self.rank, "a message to itself");
        self.post.waiting()[to * self.post.ranks + self.rank].push_back(message);
        self.post.came.notify_all();
    }
    fn receive(&self, from: usize) -> Vec<f64> {
        for _ in 0..LOOKS {
            if let Some(message) = self.receive_if_there(from) {
                return message;
            }
            std::hint::spin_loop();
        }
        let own = self.rank * self.post.ranks + from;
        let mut waiting = self.post.waiting();
        loop {
            if let Some(message) = waiting[own].pop_front() {
                return message;
            }
            if self.post.is_over.load(Ordering::Relaxed) {
                // why was told where it happened
                resume_unwind(Box::new(()));
            }
            let waited = self.post.came.wait_timeout(waiting, self.post.longest_wait);
            let (lock, waited) = waited.unwrap_or_else(PoisonError::into_inner);
            assert!(!waited.timed_out(), "rank {}: no message of rank {from}", self.rank);
            waiting = lock;
        }
    }
    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        self.post.waiting()[self.rank * self.post.ranks + from].pop_front()
    }
    fn longest_wait(&self) -> Duration {
        self.post.longest_wait
    }
    fn end(&self, reason: &str) -> ! {
        panic!("{reason}")
    }
}

/// Works on all of a list at once, on a thread each: every one of them runs, whatever the others wait for.
///
/// # Errors
/// A thread that the system does not start: what others have done until then is of no use.
pub fn on_threads<T: Send>(all: &mut [T], work: impl Fn(&dyn Exchange, &mut T) + Sync) -> io::Result<()> {
    let post = Post::new(LONGEST_WAIT, all.len());
    let Some((first, others)) = all.split_first_mut() else { return Ok(()) };
    std::thread::scope(|scope| {
        let mut started = Vec::with_capacity(others.len());
        for (other, own) in others.iter_mut().enumerate() {
            let (post, work) = (&post, &work);
            match new_thread().spawn_scoped(scope, move || work(&Thread { rank: other + 1, post }, own)) {
                Ok(thread) => started.push(thread),
                Err(refused) => {
                    post.end();
                    // that they end in the middle is no panic
                    started.into_iter().for_each(|thread| drop(thread.join()));
                    return Err(refused);
                }
            }
        }
        work(&Thread { rank: 0, post: &post }, first);
        Ok(())
    })
}

thread_local! {
    /// How many threads the system still starts for this one.
    pub static STARTED_AT_MOST: std::cell::Cell<usize> = const { std::cell::Cell::new(usize::MAX) };
}

/// A thread to be started, which the system may refuse: there is no room for the stack of one too many.
pub fn new_thread() -> Builder {
    match STARTED_AT_MOST.replace(STARTED_AT_MOST.get().saturating_sub(1)) {
        0 => Builder::new().stack_size(isize::MAX as usize),
        _ => Builder::new(),
    }
}

/// What each of some ranks gives, which all run the same.
pub fn on_ranks<R: Send>(ranks: usize, run: impl Fn(&'static dyn Exchange) -> R + Sync) -> Vec<R> {
    on_ranks_within(LONGEST_WAIT, ranks, run)
}

/// The same for ranks that do not wait longer for each other.
pub fn on_ranks_within<R: Send>(
    longest_wait: Duration,
    ranks: usize,
    run: impl Fn(&'static dyn Exchange) -> R + Sync,
) -> Vec<R> {
    // ranks live as long as the process, as those of `mpirun` do
    let post: &'static Post = Box::leak(Box::new(Post::new(longest_wait, ranks)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::time::Instant;

    #[test]
    fn nobody_waits_for_a_thread_that_panicked() {
        for panics in 0..3 {
            let begun = Instant::now();
            let work = |exchange: &dyn Exchange, _: &mut ()| match exchange.rank() {
                own if own == panics => panic!("rank {own}"),
                _ => drop(exchange.receive(panics)),
            };
            assert!(catch_unwind(AssertUnwindSafe(|| on_threads(&mut [(); 3], work))).is_err());
            assert!(begun.elapsed() < LONGEST_WAIT / 6, "{panics}: after {:?}", begun.elapsed());
        }
    }
}
