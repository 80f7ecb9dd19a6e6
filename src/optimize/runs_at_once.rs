use crate::exchange::{Exchange, Sent, apart, gather_work, new_thread, world};
use rayon::ThreadPoolBuilder;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The ranks that do each of some jobs together, which have taken so much time of one rank before, or are thought to take.
pub(crate) fn teams(costs: &[f64]) -> Vec<Range<usize>> {
    teams_of(world().ranks(), costs)
}

/// Of jobs that are no fewer than ranks, each is one rank's: the longest first, to the rank that has the least to do. Of fewer, each is done by ranks that
/// follow each other: by one at least, and each further one comes to the job that takes the longest.
fn teams_of(ranks: usize, costs: &[f64]) -> Vec<Range<usize>> {
    if costs.len() >= ranks {
        let mut longest_first: Vec<usize> = (0..costs.len()).collect();
        longest_first.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
        let (mut teams, mut times) = (vec![0..1; costs.len()], vec![0.0; ranks]);
        for job in longest_first {
            let rank = (1..ranks).fold(0, |least, rank| if times[rank] < times[least] { rank } else { least });
            times[rank] += costs[job];
            teams[job] = rank..rank + 1;
        }
        return teams;
    }
    let mut sizes = vec![1; costs.len()];
    let time = |sizes: &[usize], job: usize| costs[job] / sizes[job] as f64;
    for _ in costs.len()..ranks {
        let slower = |most: usize, job: usize| if time(&sizes, job) > time(&sizes, most) { job } else { most };
        if let Some(slowest) = (0..costs.len()).reduce(slower) {
            sizes[slowest] += 1;
        }
    }
    let mut end = 0;
    let following = |size: usize| {
        end += size;
        end - size..end
    };
    sizes.into_iter().map(following).collect()
}

/// What a function gives for the number of each job. A rank that does some for itself runs several at once, on all its threads; those of a team share one.
/// `None` where nothing was given.
pub(crate) fn results_of_all<T: Sent + Send>(teams: &[Range<usize>], run: impl Fn(usize) -> T + Sync) -> Vec<Option<T>> {
    results_on(world(), teams, |number, _| run(number))
}

/// The same on given ranks: the function is given those that share its job, where they are several.
fn results_on<T: Sent + Send>(
    world: &'static dyn Exchange,
    teams: &[Range<usize>],
    run: impl Fn(usize, Option<&dyn Exchange>) -> T + Sync,
) -> Vec<Option<T>> {
    let rank = world.rank();
    if let [team] = teams
        && team.len() == world.ranks()
    {
        return vec![Some(run(0, Some(world)))];
    }
    let own: Vec<usize> = (0..teams.len()).filter(|&number| teams[number].contains(&rank)).collect();
    let team = own.first().map_or(rank..rank + 1, |&number| teams[number].clone());
    let work = |group| match (&own[..], team.len()) {
        (&[number], 2..) => vec![Some(run(number, Some(group)))],
        _ => {
            let results: Vec<Mutex<Option<T>>> = own.iter().map(|_| Mutex::new(None)).collect();
            run_at_once(own.len(), rayon::current_num_threads(), |place| {
                let result = run(own[place], None);
                *results[place].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
            });
            results.into_iter().map(|own| own.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
        }
    };
    // that of its first rank is the result of a team
    let told = |results: Vec<Option<T>>| if team.start == rank { results } else { Vec::new() };
    let mut by_ranks: Vec<_> =
        gather_work(world, team.clone(), |group| told(work(group))).into_iter().map(Vec::into_iter).collect();
    teams.iter().map(|team| by_ranks[team.start].next().flatten()).collect()
}

/// Calls `run` once with each number below `count`, in their order, several at once: of all `threads` each call has its
/// share for itself. What a run gives has the same bits on any number of threads.
#[doc(hidden)]
pub fn run_at_once(count: usize, threads: usize, run: impl Fn(usize) + Sync) {
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
    use crate::exchange::{STARTED_AT_MOST, on_ranks};

    #[test]
    fn jobs_of_equal_costs_go_round_and_ranks_too_many_share_the_first() {
        assert_eq!(teams_of(3, &[1.0; 7]), [0, 1, 2, 0, 1, 2, 0].map(|rank| rank..rank + 1));
        assert_eq!(teams_of(1, &[1.0; 2]), [0..1, 0..1]);
        assert_eq!(teams_of(4, &[1.0]).first(), Some(&(0..4)));
        assert_eq!(teams_of(5, &[1.0; 3]), [0..2, 2..4, 4..5]);
        assert_eq!(teams_of(6, &[1.0; 3]), [0..2, 2..4, 4..6]);
        assert_eq!(teams_of(2, &[]), []);
    }

    #[test]
    fn ranks_go_where_the_work_is() {
        assert_eq!(teams_of(2, &[1.0, 1.0, 1.0, 3.0]), [1, 1, 1, 0].map(|rank| rank..rank + 1));
        assert_eq!(teams_of(2, &[2.0, 5.0, 4.0, 1.0]), [1, 0, 1, 0].map(|rank| rank..rank + 1));
        assert_eq!(teams_of(6, &[1.0, 10.0, 2.0]), [0..1, 1..5, 5..6]);
        assert_eq!(teams_of(6, &[1.0, 3.0, 2.9]), [0..1, 1..4, 4..6]);
        assert_eq!(teams_of(3, &[0.0, f64::NAN]), [0..2, 2..3]);
    }

    #[test]
    fn all_ranks_have_the_results_of_jobs_that_some_share() {
        for (ranks, costs) in [(5, &[1.0, 3.0][..]), (4, &[1.0; 3]), (3, &[2.0]), (2, &[1.0; 5]), (1, &[1.0; 3])] {
            let teams = teams_of(ranks, costs);
            let sizes: Vec<Option<usize>> = teams.iter().map(|team| Some(team.len())).collect();
            let per_rank = on_ranks(ranks, |world| {
                results_on(world, &teams, |number, group| {
                    assert!(teams[number].contains(&world.rank()), "job {number} on rank {}", world.rank());
                    group.map_or(1, |group| group.gather(&[1.0], &vec![1; group.ranks()]).len())
                })
            });
            assert_eq!(per_rank, vec![sizes; ranks], "{ranks} ranks");
        }
    }

    #[test]
    fn a_job_that_is_left_is_done_by_its_team_alone() {
        let teams = teams_of(5, &[1.0; 3]);
        let per_rank = on_ranks(5, |world| {
            results_on(world, &teams[1..2], |_, group| group.map_or(0, |group| 10 * group.ranks() + group.rank()))
        });
        assert_eq!(per_rank, vec![[Some(20)]; 5]);
    }

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
