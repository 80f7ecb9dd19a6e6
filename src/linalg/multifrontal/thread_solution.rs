//! Solutions on several threads of a process, each with a stretch of the sequence of fronts.

use super::factors::Factors;
use super::stretch_solution::{Delayed, StretchSolution, delayed};
use super::stretches::Stretches;
use super::substitution::{Side, Substitution};
use super::symbolic::{SMALL_FILL, Symbolic};
use crate::exchange::on_threads;
use crate::linalg::Owners;
use std::io;
use std::sync::Arc;

/// Stretches of all threads, with vectors of each, which have the bits that one thread gives.
pub struct ThreadSolution {
    stretches: Arc<Stretches>,
    threads: Vec<(StretchSolution, Substitution)>,
}

/// Entries of L and U that a thread should have: with fewer, starting it takes longer than its part of a solution.
const OF_EACH: usize = 500_000;

impl ThreadSolution {
    /// For so many threads, or fewer where these would have little to do; nothing where the factors are small.
    pub fn new(symbolic: &Symbolic, threads: usize) -> Option<Self> {
        let entries = symbolic.analysis(0).entries;
        (entries > SMALL_FILL).then(|| Self::of(symbolic, Stretches::new(symbolic, threads.clamp(1, entries / OF_EACH))))
    }

    /// With given stretches.
    pub fn of(symbolic: &Symbolic, stretches: Stretches) -> Self {
        let stretches = Arc::new(stretches);
        let own = |number| (StretchSolution::new(symbolic, Arc::clone(&stretches), number), Substitution::default());
        ThreadSolution { threads: (0..stretches.count()).map(own).collect(), stretches }
    }

    /// To which thread each unknown belongs, where there are several.
    pub fn owners(&self, symbolic: &Symbolic) -> Option<Owners> {
        let of = |number| symbolic.order[self.stretches.places(symbolic, number)].to_vec();
        (self.threads.len() > 1).then(|| Owners::new(&(0..self.threads.len()).map(of).collect::<Vec<_>>()))
    }

    /// Takes over where pivots of a new factorization wait.
    pub fn set_delayed(&mut self, symbolic: &Symbolic, factors: &mut Factors) {
        let part = factors.part(symbolic);
        let of_own = self.threads.iter().flat_map(|(own, _)| delayed(symbolic, &part, &own.pieces));
        let delayed: Vec<Delayed> = of_own.collect();
        self.threads.iter_mut().for_each(|(own, _)| own.delayed.clone_from(&delayed));
    }

    /// Replaces a block of right-hand sides, column by column, by solutions.
    pub fn solve(&mut self, symbolic: &Symbolic, factors: &mut Factors, side: Side, rhs: &mut [f64]) {
        while self.solve_on_threads((symbolic, factors), side, rhs).is_err() {
            // the system starts no more threads: the one that there is has the same bits
            *self = Self::of(symbolic, Stretches::new(symbolic, 1));
            self.set_delayed(symbolic, factors);
        }
    }

    fn solve_on_threads(&mut self, both: (&Symbolic, &Factors), side: Side, rhs: &mut [f64]) -> io::Result<()> {
        let given = &*rhs;
        on_threads(&mut self.threads, |exchange, (own, vectors)| {
            own.forward(exchange, both, vectors, side, given);
            own.backward(exchange, both, vectors, side);
        })?;
        for (number, (_, vectors)) in self.threads.iter().enumerate() {
            vectors.store(both.0, rhs, self.stretches.places(both.0, number));
        }
        Ok(())
    }
}
