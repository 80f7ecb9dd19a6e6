/// When to factor anew a matrix that changes slowly, instead of solving with factors that lag behind: by counts only, so that the same
/// problem takes the same way on every machine.
///
/// Since the last factorization s matrices were solved with, for a cost C (the factorization included). A further matrix is tried with
/// the same factors as long as it is not expected to cost more than the mean C / s: from there on every further one raises it.
/// The unit of cost is an iteration for one right-hand side.
///
/// Source: the criterion of least mean cost for a machine that wears out, Barlow & Hunter (1960).
#[derive(Clone, Debug, PartialEq)]
pub struct Refactoring {
    /// Of a factorization alone.
    factorization: f64,
    /// Matrices since the last factorization, the factored one included; 0 without factors.
    matrices: usize,
    /// What they cost.
    cost: f64,
    /// Applications for one right-hand side of the last two matrices.
    applications: [usize; 2],
    /// Matrices that one factorization served when it failed with the next.
    reach: usize,
    /// Factorizations to come before one is tried beyond that again.
    pause: usize,
    /// Pause after the next failure.
    next_pause: usize,
}

/// A factorization with r multiplications for each number in L and U takes the time of r / (6 + r / 10) iterations, a little more on
/// one thread: in small fronts the arithmetic is slow, and large factors come from slow memory, but the rest of an iteration does so too.
const SLOW_MULTIPLICATIONS: f64 = 6.0;
/// What it tends to.
const MOST_ITERATIONS: f64 = 10.0;
/// Cost of an iteration for several right-hand sides together, and for each of them, by that of one alone.
const TOGETHER: [f64; 2] = [1.5, 0.1];
/// Solutions with fresh factors: one, and its correction.
const FRESH_APPLICATIONS: f64 = 2.0;
/// Fewest applications with which an attempt is worth its risk; 3 are enough only where nearly nothing changes.
const FEWEST_APPLICATIONS: usize = 4;
/// By this a pause after a failure is longer than the one before.
const PAUSE_GROWTH: usize = 4;
/// Longest pause.
const LONGEST_PAUSE: usize = 64;

impl Refactoring {
    /// * `multiplications` of a factorization
    /// * `entries`         numbers in L and U
    pub fn new(multiplications: f64, entries: usize) -> Self {
        let ratio = multiplications / entries.max(1) as f64;
        let factorization = ratio / (SLOW_MULTIPLICATIONS + ratio / MOST_ITERATIONS);
        Refactoring { factorization, matrices: 0, cost: 0.0, applications: [0; 2], reach: 0, pause: 0, next_pause: 1 }
    }

    /// Most applications of the factors of now that a new matrix with a number of right-hand sides is worth; 0 to factor it at once.
    pub fn most_applications(&self, columns: usize) -> usize {
        let (fresh, weight) = (self.fresh_cost(columns), weight(columns));
        let worth = (fresh / weight) as usize;
        let is_beyond = self.pause > 0 && self.matrices >= self.reach;
        if self.matrices == 0 || is_beyond || worth < FEWEST_APPLICATIONS {
            return 0;
        }
        // one that lies further away takes one more at most, where the distance grows evenly
        let [before, last] = self.applications;
        let expected = last + usize::from(last > before);
        let mean = self.cost / self.matrices as f64;
        if expected as f64 * weight > mean { 0 } else { worth }
    }

    /// A matrix was solved with lagging factors.
    pub fn add_lagged(&mut self, columns: usize, applications: usize) {
        self.cost += applications as f64 * weight(columns);
        // the first after a factorization tells of no growth
        self.applications = if self.matrices == 1 { [applications; 2] } else { [self.applications[1], applications] };
        self.matrices += 1;
        if self.matrices > self.reach {
            self.next_pause = 1;
        }
    }

    /// An attempt failed: as far from a factored matrix the next ones are left out, ever more from failure to failure.
    pub fn add_failure(&mut self) {
        self.reach = self.matrices;
        // this one is factored too
        self.pause = self.next_pause + 1;
        self.next_pause = (PAUSE_GROWTH * self.next_pause).min(LONGEST_PAUSE);
    }

    /// A matrix was factored and solved with.
    pub fn add_factored(&mut self, columns: usize) {
        self.pause = self.pause.saturating_sub(1);
        self.matrices = 1;
        self.cost = self.fresh_cost(columns);
        self.applications = [FRESH_APPLICATIONS as usize; 2];
    }

    fn fresh_cost(&self, columns: usize) -> f64 {
        self.factorization + FRESH_APPLICATIONS * weight(columns)
    }
}

/// Cost of an application for right-hand sides together.
fn weight(columns: usize) -> f64 {
    if columns <= 1 { 1.0 } else { TOGETHER[0] + TOGETHER[1] * columns as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule whose factorizations cost as much as a number of iterations.
    fn rule(iterations: f64) -> Refactoring {
        Refactoring { factorization: iterations, ..Refactoring::new(0.0, 1) }
    }

    /// Factorizations and iterations for matrices that take so many iterations as a function of the distance from the factored one.
    fn count(iterations: f64, matrices: usize, columns: usize, needed: impl Fn(usize) -> usize) -> (usize, usize) {
        let mut rule = rule(iterations);
        let (mut factored, mut factorizations, mut applications) = (0, 0, 0);
        for matrix in 0..matrices {
            let most = rule.most_applications(columns);
            let needed = needed(matrix - factored);
            if most > 0 && needed <= most {
                rule.add_lagged(columns, needed);
                applications += needed;
            } else {
                if most > 0 {
                    rule.add_failure();
                    applications += most;
                }
                rule.add_factored(columns);
                (factored, factorizations, applications) = (matrix, factorizations + 1, applications + 2);
            }
        }
        (factorizations, applications)
    }

    #[test]
    fn iterations_for_a_factorization_are_as_measured() {
        // chain of 10,000 unknowns, shells of 5,000, 50,000 and 200,000: milliseconds of a factorization and of an iteration on one thread
        for (multiplications, entries, factorization, iteration) in [
            (3.018e6, 347_300, 1.41, 0.66),
            (1.091e8, 1_286_000, 9.97, 1.28),
            (3.254e9, 19_510_000, 203.0, 24.0),
            (2.679e10, 97_520_000, 1361.0, 136.0),
        ] {
            let taken: f64 = factorization / iteration;
            let assumed = Refactoring::new(multiplications, entries).factorization;
            // two threads share a factorization, not an iteration
            assert!(assumed < taken && assumed > 0.55 * taken, "{assumed} assumed, {taken} taken");
        }
    }

    #[test]
    fn small_factorizations_are_never_left_out() {
        // 2 applications with fresh factors and less than 2 more are not undercut by 4
        assert_eq!(count(1.9, 50, 1, |_| 3).0, 50);
        // nor where many right-hand sides share one
        assert_eq!(count(5.0, 50, 64, |_| 3).0, 50);
    }

    #[test]
    fn matrices_that_stay_near_are_never_factored_again() {
        assert_eq!(count(10.0, 1000, 1, |_| 5), (1, 2 + 999 * 5));
    }

    #[test]
    fn matrices_that_move_away_are_factored_at_nearly_the_best_interval() {
        for columns in [1, 4] {
            for (first, growth) in [(4, 1.0), (4, 0.3), (6, 0.5), (3, 0.1)] {
                let (matrices, iterations) = (2000, 20.0);
                let needed = |distance: usize| first + (growth * distance as f64) as usize;
                let cost = |(factorizations, applications): (usize, usize)| {
                    factorizations as f64 * iterations + applications as f64 * weight(columns)
                };
                let best = (1..200)
                    .map(|interval| {
                        let one: usize = 2 + (1..interval).map(needed).sum::<usize>();
                        cost((1, one)) / interval as f64
                    })
                    .fold(f64::INFINITY, f64::min);
                let taken = cost(count(iterations, matrices, columns, needed)) / matrices as f64;
                // the best interval is a whole number, and seen by one application too early or too late
                assert!(taken < 1.1 * best, "{columns} columns, {first} + {growth} d: {taken} for each, best {best}");
                assert!(taken < 0.9 * cost((1, 2)), "no gain: {taken}");
            }
        }
    }

    #[test]
    fn failures_are_tried_ever_more_seldom() {
        let (factorizations, applications) = count(10.0, 1000, 1, |_| 100);
        assert_eq!(factorizations, 1000);
        // attempts of 12 applications, at the second matrix and after pauses of 1, 4, 16, 64, 64 ..
        let attempts = (applications - 2 * factorizations) / 12;
        let later = [1, 4, 16].iter().sum::<usize>() + 3;
        assert_eq!(attempts, 1 + 3 + (1000 - 2 - later) / 65);
    }

    #[test]
    fn attempts_that_fail_at_the_same_distance_get_seldom_too() {
        for distance in 2..6 {
            // 5 iterations up to there, then too many
            let (factorizations, applications) = count(10.0, 1000, 1, |d| if d < distance { 5 } else { 100 });
            assert_eq!(factorizations, 1000usize.div_ceil(distance));
            let attempts = (applications - 2 * factorizations - 5 * (1000 - factorizations)) / 12;
            // after pauses of 1, 4, 16, 64, 64 .. factorizations
            assert!((3..12).contains(&attempts), "{attempts} failures, {factorizations} factorizations");
        }
    }
}
