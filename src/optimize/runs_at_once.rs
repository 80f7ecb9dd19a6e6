use crate::exchange::{Sent, apart, gather_work, new_thread, world};
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The rank that does each of some jobs; `None` where all ranks do the only one together.
pub(crate) fn owners(count: usize) -> Vec<Option<usize>> {
    let ranks = world().ranks();
    (0..count).map(|number| (count > 1).then_some(number % ranks)).collect()
}

/// What a function gives for the number of each job: several at once, on all threads of the ranks that do them, each for itself. `None` where
/// nothing was given.
pub(crate) fn results_of_all<T: Sent + Send>(owners: &[Option<usize>], run: impl Fn(usize) -> T + Sync) -> Vec<Option<T>> {
    let world = world();
    if let ([None], _) | ([_], 1) = (owners, world.ranks()) {
        return vec![Some(run(0))];
    }
    let own: Vec<usize> = (0..owners.len()).filter(|&number| owners[number] == Some(world.rank())).collect();
    let work = || {
        let results: Vec<Mutex<Option<T>>> = own.iter().map(|_| Mutex::new(None)).collect();
        run_at_once(own.len(), rayon::current_num_threads(), |place| {
            let result = run(own[place]);
            *results[place].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        results.into_iter().map(|own| own.into_inner().unwrap_or_else(PoisonError::into_inner)).collect::<Vec<_>>()
    };
    let mut by_ranks: Vec<_> = gather_work(world, work).into_iter().map(Vec::into_iter).collect();
    owners.iter().map(|owner| by_ranks[(*owner)?].next().flatten()).collect()
}

/// Calls `run` once with each number below `count`, in their order, several at once: of all `threads` each call has its
/// share for itself. What a run gives has the same bits on any number of threads.
pub(crate) fn run_at_once(count: usize, threads: usize, run: impl Fn(usize) + Sync) {
    let at_once = threads.min(count).max(1);
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|&number| number < count) {
            run(number);
        }
    };
    let run_all = || {
        std::thread::scope(|scope| {
            let start = |place: usize| {
                let own = threads / at_once + usize::from(place < threads % at_once);
                let worker = move || match ThreadPoolBuilder::new().num_threads(own.max(1)).build() {
                    Ok(pool) => pool.install(work),
                    // where the system gives no more threads, this one is there
                    Err(_) => work(),
                };
                new_thread().spawn_scoped(scope, worker).is_ok()
            };
            if (0..at_once).filter(|&place| start(place)).count() == 0 {
                work();
            }
        });
    };
    apart(run_all);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::STARTED_AT_MOST;

    #[test]
    fn all_is_done_once_however_few_threads_the_system_starts() {
        for at_most in 0..4 {
            STARTED_AT_MOST.set(at_most);
            let done: Vec<AtomicUsize> = (0..9).map(|_| AtomicUsize::new(0)).collect();
            run_at_once(done.len(), 3, |number| {
                done[number].fetch_add(1, Ordering::Relaxed);
            });
            assert!(done.iter().all(|own| own.load(Ordering::Relaxed) == 1), "{at_most}: {done:?}");
        }
    }
}
