//! Parts with the same program are evaluated side by side.

use super::constraint_programs::ConstraintLayout;
use super::element_programs::{ElementLayout, Force};
use super::numbering::{DofMap, System};
use super::reduction::NodeReduction;
use crate::elements::{ConstraintPhysics, RunScalar};
use crate::program::{Formula, Program, ProgramCache, ProgramWork};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Parts whose formulas are the same and whose nodes are of the same kinds.
pub(super) struct Batch<L> {
    /// Places of the parts in their list.
    pub parts: Vec<usize>,
    /// Kinds of their nodes.
    pub nodes: Box<[NodeReduction]>,
    /// The formula.
    pub formula: Arc<Formula>,
    /// Places of arguments.
    pub layout: L,
    /// Its programs.
    pub programs: ProgramCache,
}

/// Elements.
pub(super) type ElementBatch = Batch<ElementLayout>;
/// Constraints.
pub(super) type ConstraintBatch = Batch<ConstraintLayout>;

/// Sorts parts that have a formula into batches, in the order in which their kinds first come.
fn sorted<L>(
    count: usize,
    kind: impl Fn(usize) -> Option<(Arc<Formula>, Box<[NodeReduction]>, bool)>,
    layout: impl Fn(usize) -> L,
) -> Vec<Batch<L>> {
    let mut batches: Vec<Batch<L>> = Vec::new();
    let mut places: HashMap<(*const Formula, Box<[NodeReduction]>, bool), usize> = HashMap::new();
    for part in 0..count {
        let Some((formula, nodes, flag)) = kind(part) else { continue };
        let place = *places.entry((Arc::as_ptr(&formula), nodes.clone(), flag)).or_insert_with(|| {
            batches.push(Batch {
                parts: Vec::new(),
                nodes,
                formula,
                layout: layout(part),
                programs: ProgramCache::default(),
            });
            batches.len() - 1
        });
        batches[place].parts.push(part);
    }
    batches
}

impl System<'_> {
    fn reductions(&self, part: &DofMap) -> Box<[NodeReduction]> {
        part.nodes.iter().map(|&node| self.reduction(node)).collect()
    }

    /// How the coordinates of a node follow from its unknowns.
    pub(super) fn reduction(&self, node: usize) -> NodeReduction {
        let (dofs, unknowns) = (self.model.nodes[node].dofs.len(), &self.nodes[node]);
        let copies = if self.options.stabilized { 2 } else { 1 };
        if unknowns.columns.is_empty() {
            return NodeReduction::Fixed { dofs };
        }
        match unknowns.local.map(|local| self.locals[local].form.turning()) {
            None => NodeReduction::Free { dofs },
            Some(Some(turning)) if !self.options.stabilized => {
                NodeReduction::RotationCoordinates { free: dofs - turning.coordinates(), turning }
            }
            Some(_) => NodeReduction::Dense { dofs, unknowns: unknowns.columns.len() / copies },
        }
    }

    /// Elements by what they add to F.
    pub(super) fn sort_elements(&self, force: Force) -> Vec<ElementBatch> {
        let kind = |part: usize| {
            let formula = Arc::clone(force.formula(&self.model.elements[part].physics)?);
            Some((formula, self.reductions(&self.element_parts[part]), false))
        };
        let layout = |part: usize| ElementLayout::new(&self.model.elements[part].physics, force);
        sorted(self.model.elements.len(), kind, layout)
    }

    /// Constraints whose multipliers are unknowns.
    pub(super) fn sort_constraints(&self) -> Vec<ConstraintBatch> {
        let physics = |part: usize| self.global_constraint(part).map(|joint| joint.physics);
        let kind = |part: usize| match physics(part) {
            Some(own) => {
                Some((Arc::clone(own.formula()), self.reductions(&self.constraint_parts[part]), own.is_nonholonomic()))
            }
            None => unreachable!("each part has a constraint"),
        };
        let layout = |part: usize| match physics(part) {
            Some(own) => ConstraintLayout::of(own),
            None => unreachable!("each part has a constraint"),
        };
        sorted(self.constraint_parts.len(), kind, layout)
    }

    /// The constraint of a batch: its first one stands for all.
    pub(super) fn constraint_of(&self, batch: &ConstraintBatch) -> &ConstraintPhysics {
        match self.global_constraint(batch.parts[0]) {
            Some(joint) => joint.physics,
            None => unreachable!("a batch has a part"),
        }
    }
}

/// One of several elements whose numbers lie side by side.
pub(crate) struct Lane<'i, S> {
    numbers: &'i mut [S],
    width: usize,
    lane: usize,
}

impl<S: Copy> Lane<'_, S> {
    /// Sets an argument.
    #[inline(always)]
    pub fn set(&mut self, place: usize, value: S) {
        self.numbers[place * self.width + self.lane] = value;
    }
    /// Sets arguments from a place on; returns the place behind them.
    #[inline(always)]
    pub fn copy(&mut self, first: usize, values: &[S]) -> usize {
        let own = self.numbers[first * self.width..].chunks_exact_mut(self.width);
        for (target, &value) in own.zip(values) {
            target[self.lane] = value;
        }
        first + values.len()
    }
    /// Sets arguments from a place on to those of a part's coordinates.
    #[inline(always)]
    pub(super) fn copy_segments(&mut self, first: usize, part: &DofMap, values: &[S]) -> usize {
        let mut place = first;
        for segment in &part.segments {
            place = self.copy(place, &values[segment.clone()]);
        }
        place
    }
}

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
    group: Group<S>,
    pieces: Vec<Group<S>>,
    /// Results of several elements, one element after the other.
    results: Vec<S>,
}

/// Elements that are evaluated side by side.
#[derive(Clone, Debug)]
struct Group<S> {
    /// Its first one, while it waits.
    first: usize,
    inputs: Aligned<S>,
    outputs: Aligned<S>,
    work: ProgramWork<S>,
}

impl<S> Default for Group<S> {
    fn default() -> Self {
        Group { first: 0, inputs: Aligned::default(), outputs: Aligned::default(), work: ProgramWork::default() }
    }
}

impl<S> Default for BatchWork<S> {
    fn default() -> Self {
        BatchWork { group: Group::default(), pieces: Vec::new(), results: Vec::new() }
    }
}

/// Groups that several threads evaluate at a time, while the results of as many are taken.
const PIECES: usize = 16;
/// Instructions of all parts together below which one thread does them: waking others costs more.
const PARALLEL: usize = 400_000;

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

/// Executes a program for `count` parts: `write` sets the arguments of one, `read` takes its results, in the order of the parts.
pub(crate) fn run_parts<S: RunScalar>(
    program: &Program,
    count: usize,
    work: &mut BatchWork<S>,
    write: impl Fn(usize, &mut Lane<S>) + Sync,
    mut read: impl FnMut(usize, &[S]) + Send,
) {
    let lanes = S::lanes();
    let run = |first: usize, group: &mut Group<S>| {
        let (parts, width) = next_group(count - first, lanes);
        let inputs = group.inputs.first(program.inputs() * width);
        for lane in 0..width {
            write(first + lane.min(parts - 1), &mut Lane { numbers: &mut *inputs, width, lane });
        }
        let outputs = group.outputs.first(program.outputs() * width);
        if width == 1 {
            S::run(program, inputs, outputs, &mut group.work);
        } else {
            S::run_lanes(program, inputs, outputs, &mut group.work);
        }
    };
    let BatchWork { group, pieces, results } = work;
    let mut take = |first: usize, group: &mut Group<S>| {
        let (parts, width) = next_group(count - first, lanes);
        let numbers = &*group.outputs.first(program.outputs() * width);
        if width == 1 {
            return read(first, numbers);
        }
        transpose(numbers, width, results);
        let own = results.chunks_exact(program.outputs().max(1));
        own.take(parts).enumerate().for_each(|(lane, own)| read(first + lane, own));
    };
    let mut firsts = groups(count, lanes);
    let alone = rayon::current_num_threads() == 1 || count < 2 * lanes;
    if alone || count * program.listing().instructions.len() < PARALLEL {
        for first in firsts {
            run(first, group);
            take(first, group);
        }
        return;
    }
    pieces.resize_with(2 * PIECES, Group::default);
    let (mut now, mut next) = pieces.split_at_mut(PIECES);
    let evaluate = |firsts: &mut (dyn Iterator<Item = usize> + Send), groups: &mut [Group<S>]| -> usize {
        let mut ready = 0;
        for (group, first) in groups.iter_mut().zip(firsts) {
            group.first = first;
            ready += 1;
        }
        groups[..ready].par_iter_mut().for_each(|group| run(group.first, group));
        ready
    };
    let mut ready = evaluate(&mut firsts, now);
    while ready > 0 {
        let taking = || now[..ready].iter_mut().for_each(|group| take(group.first, group));
        let ((), following) = rayon::join(taking, || evaluate(&mut firsts, next));
        ready = following;
        std::mem::swap(&mut now, &mut next);
    }
}

/// Results that lie side by side, one element after the other.
fn transpose<S: RunScalar>(numbers: &[S], width: usize, results: &mut Vec<S>) {
    let count = numbers.len() / width;
    results.resize(numbers.len(), S::zero());
    // in squares, so that lines of the cache are read and written whole
    for first in (0..count).step_by(width) {
        let last = count.min(first + width);
        for lane in 0..width {
            for (result, place) in results[lane * count + first..lane * count + last].iter_mut().zip(first..) {
                *result = numbers[place * width + lane];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_hold_all_parts_once() {
        for lanes in [1, 4, 8] {
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

    #[test]
    fn results_of_lanes_are_told_apart() {
        let (mut results, count) = (Vec::new(), 13);
        let numbers: Vec<f64> = (0..8 * count).map(|place| (place % 8 * 100 + place / 8) as f64).collect();
        transpose(&numbers, 8, &mut results);
        assert!(results.iter().enumerate().all(|(place, &own)| own == (place / count * 100 + place % count) as f64));
    }
}
