//! Solutions on several threads of a process, each with a stretch of the sequence of fronts.

use super::factors::Factors;
use super::stretch_solution::{Delayed, StretchSolution};
use super::stretches::Stretches;
use super::substitution::{BLOCK, Side, Substitution};
use super::symbolic::Symbolic;
use crate::exchange::on_threads;
use crate::linalg::Owners;
use std::sync::Arc;

/// Stretches of all threads, with vectors of each, which have the bits that one thread gives.
pub struct ThreadSolution {
    stretches: Arc<Stretches>,
    threads: Vec<(StretchSolution, Substitution)>,
}

/// Entries of L and U that a thread should have: with fewer, starting it takes longer than its part of a solution.
const OF_EACH: usize = 500_000;

impl ThreadSolution {
    /// For so many threads, or fewer; nothing where one is as fast.
    pub fn new(symbolic: &Symbolic, threads: usize) -> Option<Self> {
        let threads = threads.min(symbolic.analysis(0).entries / OF_EACH);
        (threads > 1).then(|| Self::of(symbolic, Stretches::new(symbolic, threads)))
    }

    /// With given stretches.
    pub fn of(symbolic: &Symbolic, stretches: Stretches) -> Self {
        let stretches = Arc::new(stretches);
        let own = |number| (StretchSolution::new(symbolic, Arc::clone(&stretches), number), Substitution::default());
        ThreadSolution { threads: (0..stretches.count()).map(own).collect(), stretches }
    }

    /// To which thread each unknown belongs, but for those that wait for another one.
    pub fn owners(&self, symbolic: &Symbolic) -> Owners {
        let of = |number| symbolic.order[self.stretches.places(symbolic, number)].to_vec();
        Owners::new(&(0..self.threads.len()).map(of).collect::<Vec<_>>())
    }

    /// Takes over where pivots of a new factorization wait.
    pub fn set_delayed(&mut self, symbolic: &Symbolic, factors: &mut Factors) {
        let part = factors.part(symbolic);
        let mut delayed = Vec::new();
        for (front, planned) in symbolic.fronts.iter().enumerate() {
            let Some(parent) = planned.parent.filter(|&parent| self.stretches.is_parted(symbolic, parent)) else { continue };
            let places = part.delayed(symbolic, front).map(<[u32]>::to_vec);
            if !places[0].is_empty() {
                delayed.push(Delayed { front, parent, places });
            }
        }
        self.threads.iter_mut().for_each(|(own, _)| own.delayed.clone_from(&delayed));
    }

    /// Replaces right-hand sides, column by column, by solutions.
    pub fn solve(&mut self, symbolic: &Symbolic, factors: &mut Factors, side: Side, rhs: &mut [f64]) {
        if side == Side::Transposed {
            factors.transpose(symbolic);
        }
        let both = (symbolic, &*factors);
        for block in rhs.chunks_mut(BLOCK * symbolic.size.max(1)) {
            let given = &*block;
            on_threads(&mut self.threads, |exchange, (own, vectors)| {
                vectors.load_some(symbolic, given, || own.given(symbolic));
                own.forward(exchange, both, vectors, side, given);
                own.backward(exchange, both, vectors, side);
            });
            for (number, (_, vectors)) in self.threads.iter().enumerate() {
                vectors.store_some(symbolic, block, self.stretches.places(symbolic, number));
            }
        }
    }
}
