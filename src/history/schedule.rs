//! Where checkpoints go (Griewank & Walther 2000, "revolve"): with s checkpoints and r repetitions, (s + r)! / (s! r!) steps can
//! be gone back through.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

/// (s + r)! / (s! r!), the number of steps that s checkpoints reach with at most r repetitions; saturates.
fn reach(checkpoints: usize, repetitions: usize) -> usize {
    let mut product: u128 = 1;
    for i in 1..=checkpoints.min(repetitions) as u128 {
        // stays whole: a binomial coefficient after each factor
        product = product * (checkpoints.max(repetitions) as u128 + i) / i;
        if product > usize::MAX as u128 {
            return usize::MAX;
        }
    }
    product as usize
}

/// Least number of repetitions with which the checkpoints reach all steps.
fn repetitions(steps: usize, checkpoints: usize) -> usize {
    let mut repetitions = 0;
    while reach(checkpoints, repetitions) < steps {
        repetitions += 1;
    }
    repetitions
}

/// From a checkpoint, one of `checkpoints` that `steps` steps ahead may use together: how far ahead the next one goes.
///
/// At least 1 and below `steps`; `steps` itself if no other checkpoint is of use.
pub fn split(steps: usize, checkpoints: usize) -> usize {
    if checkpoints < 2 || steps < 2 {
        return steps;
    }
    let r = repetitions(steps, checkpoints);
    // both parts must be within reach: those ahead with one checkpoint less, those behind with one repetition less
    let most = reach(checkpoints, r - 1).min(steps - reach(checkpoints - 1, r - 1).min(steps - 1));
    let least = steps.saturating_sub(reach(checkpoints - 1, r)).max(1);
    most.max(least).min(steps - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The optimum by trying every place of every checkpoint.
    fn by_trial(most_steps: usize, most_checkpoints: usize) -> Vec<Vec<usize>> {
        let mut cost = vec![vec![0; most_steps + 1]; most_checkpoints + 1];
        for s in 1..=most_checkpoints {
            for n in 2..=most_steps {
                let alone = n * (n - 1) / 2;
                let split = (1..n).filter(|_| s > 1).map(|m| m + cost[s - 1][n - m] + cost[s][m]).min();
                cost[s][n] = split.map_or(alone, |split| split.min(alone));
            }
        }
        cost
    }

    #[test]
    fn the_split_reaches_the_optimum() {
        let cost = by_trial(90, 7);
        for s in 2..=7 {
            for n in 2..=90 {
                let m = split(n, s);
                assert!((1..n).contains(&m), "{n} steps, {s} checkpoints: {m}");
                assert_eq!(m + cost[s - 1][n - m] + cost[s][m], cost[s][n], "{n} steps, {s} checkpoints: {m}");
            }
        }
    }

    #[test]
    fn large_numbers_do_not_overflow() {
        assert_eq!(reach(500, 500), usize::MAX);
        assert!(split(10_000_000, 1_000_000_000) < 10_000_000);
    }
}
