//! The way up the tree of fronts: subtrees one front after the other, and the fronts above them by several threads.

use super::factors::Part;
use super::front::{Contribution, Stack, Workspace, factor_front};
use super::small_front::LANES;
use super::symbolic::Symbolic;
use crate::linalg::Singular;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::ops::Range;

/// Fronts that one thread factors, or the one front above other tasks in which threads work together.
struct Task {
    fronts: Range<usize>,
    /// Number of tasks below.
    below: usize,
    /// Contributions of fronts of even and of odd depth: those of a front's children then stand on top of one stack while its own
    /// goes onto the other.
    stacks: [Stack; 2],
    workspace: Workspace,
}

/// Factors fronts in the order of the tree: all of them, a subtree, or one front whose children others factor.
pub struct Traversal {
    tasks: Vec<Task>,
    threads: usize,
}

/// Operations below which a subtree is not worth a task.
const TASK_FLOPS: f64 = 2e6;
/// Tasks per thread.
const TASKS_PER_THREAD: f64 = 4.0;

impl Traversal {
    /// All fronts, divided among a number of threads.
    pub fn new(symbolic: &Symbolic, threads: usize) -> Self {
        let roots: Vec<usize> = (0..symbolic.fronts.len()).filter(|&front| symbolic.fronts[front].is_last()).collect();
        Self::of_subtrees(symbolic, &roots, &symbolic.subtree_flops(), threads)
    }

    /// The subtrees below some fronts, which follow each other; `flops` are those of all subtrees.
    pub fn of_subtrees(symbolic: &Symbolic, roots: &[usize], flops: &[f64], threads: usize) -> Self {
        let total: f64 = roots.iter().map(|&root| flops[root]).sum();
        let share = (total / (threads as f64 * TASKS_PER_THREAD)).max(TASK_FLOPS);
        let mut tasks = Vec::new();
        if threads <= 1 || total <= TASK_FLOPS {
            let first = roots.first().map_or(0, |&root| symbolic.fronts[root].subtree);
            tasks.push(Task::new(symbolic, first..roots.last().map_or(0, |&root| root + 1), 0));
        } else {
            roots.iter().for_each(|&root| divide(symbolic, root, flops, share, &mut tasks));
        }
        Traversal { tasks, threads }
    }

    /// One front, which takes up contributions of others.
    pub fn of_front(symbolic: &Symbolic, front: usize, threads: usize) -> Self {
        let below = symbolic.fronts[front].children.len();
        Traversal { tasks: vec![Task::new(symbolic, front..front + 1, below)], threads }
    }

    fn last(&self) -> &Task {
        self.tasks.last().expect("a traversal has a task")
    }

    /// All fronts.
    pub fn fronts(&self) -> Range<usize> {
        self.tasks[0].fronts.start..self.last().fronts.end
    }

    /// The front above all others of it.
    pub fn root(&self) -> usize {
        self.last().fronts.end - 1
    }

    /// Bytes of waiting contributions at their peak.
    pub fn bytes(&self) -> usize {
        let stacks = self.tasks.iter().flat_map(|task| &task.stacks);
        size_of::<f64>() * stacks.map(|stack| stack.memory.len()).sum::<usize>()
    }

    /// Factors values given in the order of the pattern; the fronts begin the part.
    ///
    /// # Errors
    /// [`Singular`] with the column that has no pivot.
    pub fn factor(&mut self, symbolic: &Symbolic, values: &[f64], mut part: Part<'_>) -> Result<(), Singular> {
        if let [task] = &mut self.tasks[..] {
            return task.factor_subtree(symbolic, values, &mut part);
        }
        let (mut running, mut rest) = (Vec::with_capacity(self.tasks.len()), part);
        for task in &mut self.tasks {
            let (part, after) = rest.split_at(symbolic, task.fronts.end);
            running.push(Running { task, part });
            rest = after;
        }
        factor_subtrees(symbolic, values, &mut running, self.threads)
    }

    /// Factors a front alone, which begins the part.
    ///
    /// # Errors
    /// As for [`Traversal::factor`].
    pub fn factor_front(
        &mut self,
        symbolic: &Symbolic,
        values: &[f64],
        part: &mut Part<'_>,
        children: &[Contribution<'_>],
    ) -> Result<(), Singular> {
        let number = self.root();
        let Task { stacks, workspace, .. } = self.tasks.last_mut().expect("a traversal has a task");
        let output = &mut stacks[symbolic.fronts[number].depth % 2];
        output.height = 0;
        factor_front(symbolic, number, values, part, children, output, workspace, self.threads)
    }

    /// What the front above all others contributes; the part has it.
    pub fn contribution<'c>(&'c self, symbolic: &Symbolic, part: &'c Part<'_>) -> Contribution<'c> {
        let root = self.root();
        contribution(symbolic, part, root, &self.last().stacks[symbolic.fronts[root].depth % 2].memory, |_| 0)
    }
}

fn divide(symbolic: &Symbolic, front: usize, flops: &[f64], share: f64, tasks: &mut Vec<Task>) {
    let planned = &symbolic.fronts[front];
    if flops[front] <= share || planned.children.is_empty() {
        tasks.push(Task::new(symbolic, planned.subtree..front + 1, 0));
        return;
    }
    let before = tasks.len();
    for &child in &symbolic.children[planned.children.clone()] {
        divide(symbolic, child as usize, flops, share, tasks);
    }
    tasks.push(Task::new(symbolic, front..front + 1, tasks.len() - before));
}

impl Task {
    fn new(symbolic: &Symbolic, fronts: Range<usize>, below: usize) -> Self {
        let peaks = if below == 0 {
            symbolic.stack_peaks(fronts.clone())
        } else {
            let front = &symbolic.fronts[fronts.start];
            let mut peaks = [0; 2];
            peaks[front.depth % 2] = front.others().pow(2);
            peaks
        };
        let stacks = peaks.map(|peak| Stack { memory: vec![0.0; peak + LANES], height: 0 });
        Task { fronts, below, stacks, workspace: Workspace::default() }
    }

    fn factor_subtree(&mut self, symbolic: &Symbolic, values: &[f64], part: &mut Part<'_>) -> Result<(), Singular> {
        self.stacks.iter_mut().for_each(|stack| stack.height = 0);
        for number in self.fronts.clone() {
            let front = &symbolic.fronts[number];
            let (before, mut own) = part.reborrow().split_at(symbolic, number);
            let [even, odd] = &mut self.stacks;
            let (output, waiting) = if front.depth.is_multiple_of(2) { (even, odd) } else { (odd, even) };
            let mut children: SmallVec<[Contribution<'_>; 8]> = SmallVec::new();
            let mut end = waiting.height;
            for &child in symbolic.children[front.children.clone()].iter().rev() {
                let contribution = contribution(symbolic, &before, child as usize, &waiting.memory, |length| end - length);
                end -= contribution.values.len();
                children.push(contribution);
            }
            children.reverse();
            factor_front(symbolic, number, values, &mut own, &children, output, &mut self.workspace, 1)?;
            waiting.height = end;
        }
        Ok(())
    }
}

/// The contribution of a front, which starts in the memory where `start` of its length says.
fn contribution<'c>(
    symbolic: &Symbolic,
    part: &'c Part<'_>,
    front: usize,
    memory: &'c [f64],
    start: impl Fn(usize) -> usize,
) -> Contribution<'c> {
    let [delayed_rows, delayed_columns] = part.delayed(front);
    let order = delayed_rows.len() + symbolic.fronts[front].others();
    Contribution { front, delayed_rows, delayed_columns, values: &memory[start(order * order)..][..order * order] }
}

struct Running<'r> {
    task: &'r mut Task,
    part: Part<'r>,
}

/// Factors the subtrees of all tasks that no other of them takes up.
fn factor_subtrees(symbolic: &Symbolic, values: &[f64], tasks: &mut [Running<'_>], threads: usize) -> Result<(), Singular> {
    let (mut subtrees, mut rest) = (Vec::new(), tasks);
    while let Some(root) = rest.len().checked_sub(1) {
        let (others, subtree) = rest.split_at_mut(root - rest[root].task.below);
        subtrees.push(subtree);
        rest = others;
    }
    let results: Vec<_> =
        subtrees.into_par_iter().map(|subtree| factor_subtree(symbolic, values, subtree, threads)).collect();
    results.into_iter().rev().collect()
}

fn factor_subtree(symbolic: &Symbolic, values: &[f64], tasks: &mut [Running<'_>], threads: usize) -> Result<(), Singular> {
    let Some((Running { task, part }, below)) = tasks.split_last_mut() else {
        return Ok(());
    };
    if below.is_empty() {
        return task.factor_subtree(symbolic, values, part);
    }
    factor_subtrees(symbolic, values, below, threads)?;
    let number = task.fronts.start;
    let of_child = |child: u32| {
        let child = child as usize;
        let below = below.iter().find(|running| running.task.fronts.end == child + 1);
        let Running { task, part } = below.expect("each child ends a task");
        let memory = &task.stacks[symbolic.fronts[child].depth % 2].memory;
        contribution(symbolic, part, child, memory, |_| 0)
    };
    let children = symbolic.children[symbolic.fronts[number].children.clone()].iter().map(|&child| of_child(child));
    let children: SmallVec<[Contribution<'_>; 8]> = children.collect();
    let output = &mut task.stacks[symbolic.fronts[number].depth % 2];
    output.height = 0;
    factor_front(symbolic, number, values, part, &children, output, &mut task.workspace, threads)
}
