//! Whether a step begins with a new matrix: by what steps cost with one and without.

use crate::integrators::Counters;

/// Cost of a matrix with its factorization, in corrections with the evaluations that they take: three to six for chains and shells.
const FACTORIZATION: f64 = 4.0;
/// Corrections that a system takes at least with a new matrix, as a rule.
const CORRECTIONS: f64 = 2.0;
/// Steps before a new matrix is tried: first guesses become better with each of them.
const FIRST_STEPS: usize = 12;
/// Steps for which the other way is tried; the first one still has what the last way left.
const TRIED: usize = 4;
/// Steps until the other way is tried again, at first; twice as many each time that it is no better.
const KEPT: usize = 40;
const MOST_KEPT: usize = 640;

/// The choice between two ways to take a step: with the matrix that is there until corrections become slow, or with a new one at its start.
///
/// Both are tried in turn; the cheaper one by the counts of corrections and factorizations, which no clock changes, is kept for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Renewal {
    pub renews: bool,
    /// The way that was better is known, and this one is tried.
    pub trying: bool,
    pub left: usize,
    pub kept_for: usize,
    /// Sum of the costs of the last steps on this way, which count, and their number.
    pub cost: f64,
    pub steps: usize,
    pub other: f64,
    /// Systems, corrections and factorizations of the step so far.
    pub step: [usize; 3],
}

impl Default for Renewal {
    fn default() -> Self {
        Renewal {
            renews: false,
            trying: false,
            left: FIRST_STEPS,
            kept_for: KEPT,
            cost: 0.0,
            steps: 0,
            other: f64::INFINITY,
            step: [0; 3],
        }
    }
}

impl Renewal {
    /// Takes note of a search, by the counters before and after it.
    pub(super) fn note(&mut self, before: &Counters, after: &Counters) {
        let counts = |of: &Counters| [of.systems, of.iterations, of.factorizations];
        let (before, after) = (counts(before), counts(after));
        (0..3).for_each(|i| self.step[i] += after[i] - before[i]);
    }

    /// Takes note of the step that has ended, if there was one; returns whether the next one begins with a new matrix.
    pub(super) fn begin_step(&mut self) -> bool {
        let [systems, iterations, factorizations] = std::mem::take(&mut self.step).map(|count| count as f64);
        // not the first one of a way
        if self.left < TRIED {
            self.cost += iterations + FACTORIZATION * factorizations;
            self.steps += 1;
        }
        self.left = self.left.saturating_sub(1);
        if self.left > 0 || self.steps == 0 {
            return self.renews;
        }
        let own = self.cost / self.steps as f64;
        (self.cost, self.steps) = (0.0, 0);
        if self.trying {
            let better = own < self.other;
            self.kept_for = if better { KEPT } else { (2 * self.kept_for).min(MOST_KEPT) };
            (self.trying, self.left, self.renews) = (false, self.kept_for, self.renews == better);
        } else if self.renews || own > FACTORIZATION + CORRECTIONS * systems {
            (self.trying, self.left, self.other, self.renews) = (true, TRIED, own, !self.renews);
        } else {
            // no step with a new matrix could cost less
            self.left = self.kept_for;
        }
        self.renews
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps that renew among the last hundred of a thousand, with these corrections in a step of three systems.
    fn renewing(kept: (usize, usize), renewed: usize) -> usize {
        let (mut renewal, mut counters) = (Renewal::default(), Counters::default());
        let mut renewing = 0;
        for step in 0..1000 {
            let renews = renewal.begin_step();
            let (iterations, factorizations) = if renews { (renewed, 1) } else { kept };
            let before = counters;
            counters.systems += 3;
            counters.iterations += iterations;
            counters.factorizations += factorizations;
            renewal.note(&before, &counters);
            renewing += usize::from(renews && step >= 900);
        }
        renewing
    }

    #[test]
    fn the_cheaper_way_is_kept() {
        assert!(renewing((9, 1), 6) >= 90, "a factorization in either case");
        assert!(renewing((9, 0), 6) <= 10, "three corrections for a factorization");
        assert!(renewing((12, 0), 6) >= 90, "six corrections for a factorization");
        assert_eq!(renewing((5, 0), 3), 0, "nothing to be gained");
    }
}
