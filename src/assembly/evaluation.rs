//! Programs of many parts, some side by side, on all threads, and on all ranks.

use super::gather_map::MOST_LANES;
use super::lanes::{LaneResults, Lanes};
use crate::elements::RunScalar;
use crate::exchange::{Exchange, world};
use crate::program::{Program, ProgramWork};
use rayon::prelude::*;
use std::ops::Range;

/// Numbers that start at a line of the cache.
#[derive(Clone, Debug)]
struct Aligned<S>(Vec<S>);

impl<S> Default for Aligned<S> {
    fn default() -> Self {
        Aligned(Vec::new())
    }
}

impl<S: RunScalar> Aligned<S> {
    /// The first `count` numbers, with any values.
    #[inline(always)]
    fn first(&mut self, count: usize) -> &mut [S] {
        const MARGIN: usize = 8;
        if self.0.len() < count + MARGIN {
            self.0.resize(count + MARGIN, S::zero());
        }
        let start = self.0.as_ptr().align_offset(64).min(MARGIN);
        &mut self.0[start..start + count]
    }
}

/// Workspace of evaluations.
#[derive(Clone, Debug)]
pub(crate) struct BatchWork<S> {
    groups: Vec<Group<S>>,
    workspaces: Vec<ThreadWorkspace<S>>,
    parallelism: Parallelism,
}

/// Who evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Parallelism {
    Thread,
    Threads,
    Ranks,
}

impl<S> BatchWork<S> {
    fn new(parallelism: Parallelism) -> Self {
        BatchWork { groups: Vec::new(), workspaces: Vec::new(), parallelism }
    }

    /// For evaluations that all ranks make in the same order: they share long ones.
    pub fn shared() -> Self {
        Self::new(Parallelism::Ranks)
    }

    /// For evaluations that other threads make others beside.
    pub fn on_one_thread() -> Self {
        Self::new(Parallelism::Thread)
    }

    /// Some groups and workspaces, made where they are not there yet.
    fn first(&mut self, groups: usize, workspaces: usize) -> (&mut [Group<S>], &mut [ThreadWorkspace<S>]) {
        self.groups.resize_with(self.groups.len().max(groups), Group::default);
        self.workspaces.resize_with(self.workspaces.len().max(workspaces), ThreadWorkspace::default);
        (&mut self.groups[..groups], &mut self.workspaces[..workspaces])
    }
}

impl<S> Default for BatchWork<S> {
    fn default() -> Self {
        Self::new(Parallelism::Threads)
    }
}

/// Elements that are evaluated side by side: the first one, and the results while they wait.
#[derive(Clone, Debug)]
struct Group<S> {
    first: usize,
    outputs: Aligned<S>,
}

super::empty_fields!(Group { first, outputs });

/// What one group after the other is evaluated with, so that it stays in the caches.
#[derive(Clone, Debug)]
struct ThreadWorkspace<S> {
    inputs: Aligned<S>,
    work: ProgramWork<S>,
}

super::empty_fields!(ThreadWorkspace { inputs, work });

/// Groups that several threads evaluate at a time, while the results of as many are taken: at least so many, and as many as have so many results.
const GROUPS: usize = 16;
const RESULTS: usize = 1 << 17;
/// How many times a thread takes some of them.
const CHUNKS: usize = 4;
/// Groups that go through a section of a long program together: what they store in between should stay in the second cache.
const TOGETHER: usize = 4;
/// Instructions of all parts together below which one thread does them: waking others costs more.
const PARALLEL: usize = 400_000;
/// The same below which each rank does them, and instructions of a part for each of its results: sending them costs more.
const SHARED: [usize; 2] = [10 * PARALLEL, 20];

/// How many parts are evaluated next, and in how many lanes: a few left over are done one by one.
fn next_group(left: usize, lanes: usize) -> (usize, usize) {
    if lanes > 1 && left * 3 > lanes { (left.min(lanes), lanes) } else { (1, 1) }
}

/// The first part of each group.
fn groups(count: usize, lanes: usize) -> impl ExactSizeIterator<Item = usize> + Clone {
    let (full, left) = (count / lanes, count % lanes);
    let further = if left > 0 && next_group(left, lanes).1 == lanes { 1 } else { left };
    (0..full + further).map(move |group| lanes * group.min(full) + group.saturating_sub(full))
}

/// Executes a program for `count` parts: `write` sets the arguments of those that are evaluated side by side, `read` takes their results, in the order of the parts.
pub(crate) fn run_lanes<S: RunScalar>(
    program: &Program,
    count: usize,
    work: &mut BatchWork<S>,
    write: impl Fn(Lanes<S>) + Sync,
    read: impl FnMut(LaneResults<S>) + Send,
) {
    let instructions = program.instructions();
    let is_long = count * instructions >= SHARED[0] && instructions >= SHARED[1] * program.outputs();
    if work.parallelism == Parallelism::Ranks && is_long && S::PARTS == 0 && world().ranks() > 1 {
        run_on_ranks(world(), program, count, work, write, read);
    } else {
        run_parts(program, 0..count, work, write, read);
    }
}

/// Parts of a rank.
fn own_parts(count: usize, rank: usize, ranks: usize) -> Range<usize> {
    let blocks = count.div_ceil(MOST_LANES);
    let first = |rank: usize| (blocks * rank / ranks * MOST_LANES).min(count);
    first(rank)..first(rank + 1)
}

/// Each rank evaluates some parts, and takes the results of all.
fn run_on_ranks<S: RunScalar>(
    world: &dyn Exchange,
    program: &Program,
    count: usize,
    work: &mut BatchWork<S>,
    write: impl Fn(Lanes<S>) + Sync,
    mut read: impl FnMut(LaneResults<S>) + Send,
) {
    let outputs = program.outputs();
    let of_rank = |rank: usize| own_parts(count, rank, world.ranks());
    let own = of_rank(world.rank());
    let mut results = Vec::with_capacity(own.len() * outputs);
    let mut keep = |lanes: LaneResults<S>| {
        lanes.for_each_part(|_, numbers| results.extend(numbers.take(outputs).map(|number| number.value())));
    };
    run_parts(program, own, work, write, &mut keep);
    let counts: Vec<usize> = (0..world.ranks()).map(|rank| of_rank(rank).len() * outputs).collect();
    let all = world.gather(&results, &counts);
    let mut numbers = Vec::with_capacity(outputs);
    for (part, own) in all.chunks_exact(outputs).enumerate() {
        numbers.clear();
        numbers.extend(own.iter().map(|&number| S::from(number)));
        read(LaneResults { numbers: &numbers, width: 1, parts: part..part + 1 });
    }
}

/// Executes a program for some parts.
fn run_parts<S: RunScalar>(
    program: &Program,
    parts: Range<usize>,
    work: &mut BatchWork<S>,
    write: impl Fn(Lanes<S>) + Sync,
    mut read: impl FnMut(LaneResults<S>) + Send,
) {
    let (begin, count) = (parts.start, parts.len());
    let lanes = S::lanes();
    let (inputs, outputs) = (program.inputs(), program.outputs());
    let fill = |(group, workspace): (&mut Group<S>, &mut ThreadWorkspace<S>)| {
        let (parts, width) = next_group(count - group.first, lanes);
        let numbers = workspace.inputs.first(inputs * width);
        write(Lanes { numbers, width, parts: begin + group.first..begin + group.first + parts, place: 0 });
    };
    let run = |section: usize, (group, workspace): (&mut Group<S>, &mut ThreadWorkspace<S>)| {
        let width = next_group(count - group.first, lanes).1;
        let (arguments, results) = (workspace.inputs.first(inputs * width), group.outputs.first(outputs * width));
        match (width, section) {
            (1, 0) => S::run(program, arguments, results, &mut workspace.work),
            (1, _) => {}
            _ => S::run_section(program, section, arguments, results, &mut workspace.work),
        }
    };
    let sections = if count * 3 > lanes { S::sections(program) } else { 1 };
    // as many groups together as workspaces
    let evaluate = |groups: &mut [Group<S>], workspaces: &mut [ThreadWorkspace<S>]| {
        for groups in groups.chunks_mut(workspaces.len()) {
            groups.iter_mut().zip(&mut *workspaces).for_each(fill);
            for section in 0..sections {
                groups.iter_mut().zip(&mut *workspaces).for_each(|both| run(section, both));
            }
        }
    };
    let mut take = |group: &mut Group<S>| {
        let (parts, width) = next_group(count - group.first, lanes);
        let numbers = &*group.outputs.first(outputs * width);
        read(LaneResults { numbers, width, parts: begin + group.first..begin + group.first + parts });
    };
    let together = if sections > 1 { TOGETHER } else { 1 };
    let mut firsts = groups(count, lanes);
    let mut set_firsts = |groups: &mut [Group<S>]| {
        let next = groups.iter_mut().zip(&mut firsts);
        next.map(|(group, first)| group.first = first).count()
    };
    let alone = work.parallelism == Parallelism::Thread || rayon::current_num_threads() == 1 || count < 2 * lanes;
    if alone || count * program.instructions() < PARALLEL {
        let (groups, workspaces) = work.first(together, together);
        loop {
            let ready = set_firsts(groups);
            if ready == 0 {
                return;
            }
            evaluate(&mut groups[..ready], workspaces);
            groups[..ready].iter_mut().for_each(&mut take);
        }
    }
    let at_once = (RESULTS / (outputs * lanes).max(1)).clamp(GROUPS, GROUPS.max(count / lanes));
    let chunk = at_once.div_ceil(CHUNKS * rayon::current_num_threads()).next_multiple_of(together);
    let (groups, workspaces) = work.first(2 * at_once, at_once.div_ceil(chunk) * together);
    let (mut now, mut next) = groups.split_at_mut(at_once);
    let mut start = |groups: &mut [Group<S>]| {
        let ready = set_firsts(groups);
        let chunks = groups[..ready].par_chunks_mut(chunk).zip(workspaces.par_chunks_mut(together));
        chunks.for_each(|(groups, workspaces)| evaluate(groups, workspaces));
        ready
    };
    let mut ready = start(now);
    while ready > 0 {
        let taking = || now[..ready].iter_mut().for_each(&mut take);
        let ((), following) = rayon::join(taking, || start(next));
        ready = following;
        std::mem::swap(&mut now, &mut next);
    }
}

#[cfg(test)]
mod tests {
    use super::super::gather_map::Starts;
    use super::*;
    use crate::exchange::on_ranks;
    use crate::program::Formula;
    use crate::scalar::Scalar;

    #[test]
    fn ranks_take_the_results_of_all_parts_in_their_order() {
        let formula = Formula::record(2, |x| vec![x[0] * x[1], (x[0] - x[1]).sin()]).expect("no branch");
        let values: Vec<f64> = (0..200).map(|place| 1.0 / f64::from(3 + place)).collect();
        for count in [1, 7, 8, 9, 16, 50, 99] {
            let starts = Starts::of_parts((0..count).map(|part| 2 * part..2 * part + 2));
            // sums over neighbours, which depend on the order of the parts
            let sums = |world: &dyn Exchange| {
                let (mut sums, mut work) = (vec![0.1; count + 1], BatchWork::default());
                let write = |mut lanes: Lanes<f64>| lanes.gather(&starts, &values);
                let read = |results: LaneResults<f64>| {
                    results.for_each_part(|part, own| own.enumerate().for_each(|(k, own)| sums[part + k] += own / 3.0));
                };
                match world.ranks() {
                    1 => run_parts(formula.values(), 0..count, &mut work, write, read),
                    _ => run_on_ranks(world, formula.values(), count, &mut work, write, read),
                }
                sums
            };
            let alone = on_ranks(1, sums).remove(0);
            for ranks in 2..=5 {
                let given = on_ranks(ranks, sums);
                assert!(given.iter().all(|given| *given == alone), "{count} parts on {ranks} ranks");
            }
        }
    }

    #[test]
    fn groups_hold_all_parts_once() {
        for lanes in [1, 2, 4, 8] {
            for count in 0..40 {
                let mut first = 0;
                for own in groups(count, lanes) {
                    assert_eq!(own, first, "{count} parts in {lanes} lanes");
                    first += next_group(count - first, lanes).0;
                }
                assert_eq!(first, count);
            }
        }
    }
}
