use crate::exchange::apart;
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicUsize, Ordering};

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
            for place in 0..at_once {
                let own = threads / at_once + usize::from(place < threads % at_once);
                scope.spawn(move || match ThreadPoolBuilder::new().num_threads(own.max(1)).build() {
                    Ok(pool) => pool.install(work),
                    // where the system gives no more threads, this one is there
                    Err(_) => work(),
                });
            }
        });
    };
    // whatever the number of threads of a rank: all ranks are to do the same
    if count > 1 { apart(run_all) } else { run_all() }
}
