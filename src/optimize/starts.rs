use super::{Optimization, Optimized, Optimizer, Watcher};
use crate::integrators::RunError;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Numbers that are the same in every run (a linear congruential generator; Knuth, MMIX).
struct Numbers(u64);

impl Numbers {
    /// Below 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn below(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }
}

impl Optimization<'_> {
    /// Designs to start from: the given one, and others that fill the ranges of the variables that vary evenly, the same in every run. A
    /// variable without a bound on a side reaches from its value as far as that is large.
    ///
    /// Source: McKay, Beckman & Conover (1979), Latin hypercube sampling.
    pub fn starts(&self, first: &[f64], count: usize) -> Vec<Vec<f64>> {
        let mut numbers = Numbers(count as u64);
        let mut starts = vec![first.to_vec(); count.max(1)];
        let others = starts.len() - 1;
        for place in self.varying() {
            let (variable, size) = (&self.variables[place], if first[place] == 0.0 { 1.0 } else { first[place].abs() });
            let lower = if variable.lower.is_finite() { variable.lower } else { first[place] - size };
            let upper = if variable.upper.is_finite() { variable.upper } else { first[place].max(lower) + size };
            let mut strata: Vec<usize> = (0..others).collect();
            for last in (1..others).rev() {
                strata.swap(last, numbers.below(last + 1));
            }
            for (start, stratum) in starts[1..].iter_mut().zip(strata) {
                let share = (stratum as f64 + numbers.next()) / others as f64;
                start[place] = (lower + share * (upper - lower)).clamp(variable.lower, variable.upper);
            }
        }
        starts
    }

    /// Optimizes from each of some designs, on as many threads as there are processors: what comes of each is what [`Optimization::run`]
    /// gives. Each has a watcher of its own.
    ///
    /// # Errors
    /// Each start has its own, as there.
    pub fn run_from_all(
        &self,
        optimizer: &dyn Optimizer,
        starts: &[Vec<f64>],
        watchers: &mut [impl Watcher + Send],
    ) -> Vec<Result<Optimized, RunError>> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(starts.len());
        let jobs: Vec<Mutex<_>> = starts.iter().zip(watchers).map(|job| Mutex::new((job, None))).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                // each job is taken once, so that none waits for another
                if let Ok(mut job) = job.lock() {
                    let ((start, watcher), ended) = &mut *job;
                    *ended = Some(self.run(optimizer, start, &mut **watcher));
                }
            }
        };
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
        let ended = jobs.into_iter().map(|job| job.into_inner().ok().and_then(|(_, ended)| ended));
        ended.map(|ended| ended.unwrap_or_else(|| Err(RunError::Input("the optimization was not run".into())))).collect()
    }
}
