//! How fast corrections shrink with a matrix of some age, as earlier searches have seen it.

/// Kinds of systems that share a matrix: projections of coordinates, of velocities, and others.
const KINDS: usize = 3;
/// Systems that were solved with a matrix before: from so many on nothing is kept.
const AGES: usize = 8;
/// Searches that may end at their first correction before one is looked at again.
const MOST_UNSEEN: usize = 7;
/// Rates that are seen vary: so much worse is reckoned with.
const SAFETY: f64 = 2.0;

/// Rate of convergence of one kind of system with a matrix of one age.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contraction {
    /// The second correction by the first one, where it was seen last; 0 before.
    pub rate: f64,
    pub unseen: usize,
}

/// Rates of convergence of all kinds of systems: steps are like the steps before, so that a first correction tells what the second one would
/// be without an evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contractions {
    pub known: [[Contraction; AGES]; KINDS],
    /// Systems that were solved with the matrix since it was factored.
    pub age: usize,
}

impl Contractions {
    /// The share of a first correction that a second one is expected to have at most, if searches have seen it lately.
    pub(super) fn expected(&self, kind: usize) -> Option<f64> {
        let known = self.known[kind].get(self.age)?;
        (known.rate > 0.0 && known.unseen < MOST_UNSEEN).then_some(SAFETY * known.rate)
    }

    /// Takes note of a search that has ended, with the worst rate if it made more than one correction.
    pub(super) fn note(&mut self, kind: usize, seen: Option<f64>) {
        let Some(known) = self.known[kind].get_mut(self.age) else { return };
        match seen {
            // one lucky search is not believed at once
            Some(rate) => *known = Contraction { rate: rate.max(0.5 * known.rate), unseen: 0 },
            None => known.unseen += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_known_for_its_kind_and_age_and_for_some_searches() {
        let mut rates = Contractions::default();
        assert_eq!(rates.expected(0), None);
        rates.note(0, Some(1e-3));
        assert_eq!(rates.expected(0), Some(SAFETY * 1e-3));
        assert_eq!(rates.expected(1), None);
        rates.age = 1;
        assert_eq!(rates.expected(0), None);
        rates.age = 0;
        (0..MOST_UNSEEN).for_each(|_| rates.note(0, None));
        assert_eq!(rates.expected(0), None, "it is time to look again");
        rates.note(0, Some(1e-6));
        assert_eq!(rates.expected(0), Some(SAFETY * 0.5e-3), "one lucky search");
        rates.age = AGES;
        rates.note(0, Some(0.1));
        assert_eq!(rates.expected(0), None, "too old to be known");
    }
}
