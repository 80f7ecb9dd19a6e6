use super::runs_at_once::{results_of_all, teams};
use super::{Optimization, Optimized, Optimizer, Watcher};
use crate::design::{DesignVariable, latin_hypercube};
use crate::integrators::RunError;
use std::sync::Mutex;

/// Designs to start from: the given one, and others that fill the ranges of the variables that vary evenly, the same in every run. A variable without a
/// bound on a side reaches from its value as far as that is large.
pub(super) fn starts(variables: &[DesignVariable], varying: &[usize], first: &[f64], count: usize) -> Vec<Vec<f64>> {
    let mut starts = vec![first.to_vec(); count.max(1)];
    let shares = latin_hypercube(starts.len() - 1, varying.len(), count as u64);
    for (k, &place) in varying.iter().enumerate() {
        let (variable, size) = (&variables[place], if first[place] == 0.0 { 1.0 } else { first[place].abs() });
        let lower = if variable.lower.is_finite() { variable.lower } else { first[place] - size };
        let upper = if variable.upper.is_finite() { variable.upper } else { first[place].max(lower) + size };
        for (start, shares) in starts[1..].iter_mut().zip(&shares) {
            start[place] = (lower + shares[k] * (upper - lower)).clamp(variable.lower, variable.upper);
        }
    }
    starts
}

impl Optimization<'_> {
    /// Designs to start from: the given one, and others that fill the ranges of the variables that vary evenly, the same in every run.
    pub fn starts(&self, first: &[f64], count: usize) -> Vec<Vec<f64>> {
        starts(&self.variables, &self.varying(), first, count)
    }

    /// Optimizes from each of some designs, several at once on all threads, on ranks dealt to teams of them: what comes of each is what [`Optimization::run`] gives. Each has a
    /// watcher of its own.
    ///
    /// # Errors
    /// Each start has its own, as there.
    pub fn run_from_all(
        &self,
        optimizer: &dyn Optimizer,
        starts: &[Vec<f64>],
        watchers: &mut [impl Watcher + Send],
    ) -> Vec<Result<Optimized, RunError>> {
        let jobs: Vec<Mutex<_>> = starts.iter().zip(watchers).map(Mutex::new).collect();
        let teams = teams(&vec![1.0; jobs.len()]);
        let ended = results_of_all(&teams, |number| {
            // each job is taken once, so that none waits for another
            let (start, watcher) = &mut *jobs[number].lock().ok()?;
            Some(self.run(optimizer, start, &mut **watcher))
        });
        // the first rank has seen its own optimizations alone
        for ((team, job), ended) in teams.iter().zip(jobs).zip(&ended) {
            if let (1.., Ok((_, watcher)), Some(Some(Ok(optimized)))) = (team.start, job.into_inner(), ended) {
                watcher.changed(&optimized.history);
            }
        }
        let missing = || Err(RunError::Input("the optimization was not run".into()));
        ended.into_iter().map(|ended| ended.flatten().unwrap_or_else(missing)).collect()
    }
}
