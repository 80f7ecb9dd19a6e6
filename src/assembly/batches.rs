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

/// Results of one of several elements.
#[derive(Clone, Copy)]
pub(crate) struct Results<'o, S> {
    numbers: &'o [S],
    width: usize,
    lane: usize,
}

impl<'o, S: Copy> Results<'o, S> {
    /// One result after the other.
    #[inline(always)]
    pub fn iter(self) -> impl Iterator<Item = S> + 'o {
        self.numbers.chunks_exact(self.width).map(move |own| own[self.lane])
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
    inputs: Aligned<S>,
    outputs: Aligned<S>,
    work: ProgramWork<S>,
    pieces: Vec<Piece<S>>,
}

/// What one of several threads needs.
#[derive(Clone, Debug)]
struct Piece<S> {
    inputs: Aligned<S>,
    outputs: Vec<Aligned<S>>,
    work: ProgramWork<S>,
}

impl<S> Default for Piece<S> {
    fn default() -> Self {
        Piece { inputs: Aligned::default(), outputs: Vec::new(), work: ProgramWork::default() }
    }
}

impl<S> Default for BatchWork<S> {
    fn default() -> Self {
        let (inputs, outputs) = (Aligned::default(), Aligned::default());
        BatchWork { inputs, outputs, work: ProgramWork::default(), pieces: Vec::new() }
    }
}

/// Pieces into which the evaluation of many parts is divided, whatever the number of threads.
const PIECES: usize = 16;
/// Instructions of all parts together below which one thread does them: waking others costs more.
const PARALLEL: usize = 400_000;

/// How many parts are evaluated next, and in how many lanes: a few left over are done one by one.
fn next_group(left: usize, lanes: usize) -> (usize, usize) {
    if lanes > 1 && left * 3 > lanes { (left.min(lanes), lanes) } else { (1, 1) }
}

/// Executes a program for `count` parts: `write` sets the arguments of one, `read` takes its results, in the order of the parts.
pub(crate) fn run_parts<S: RunScalar>(
    program: &Program,
    count: usize,
    work: &mut BatchWork<S>,
    write: impl Fn(usize, &mut Lane<S>) + Sync,
    mut read: impl FnMut(usize, Results<S>),
) {
    let lanes = S::lanes();
    let run = |first: usize, inputs: &mut Aligned<S>, outputs: &mut Aligned<S>, work: &mut ProgramWork<S>| {
        let (parts, width) = next_group(count - first, lanes);
        let inputs = inputs.first(program.inputs() * width);
        for lane in 0..width {
            write(first + lane.min(parts - 1), &mut Lane { numbers: &mut *inputs, width, lane });
        }
        let outputs = outputs.first(program.outputs() * width);
        if width == 1 {
            S::run(program, inputs, outputs, work);
        } else {
            S::run_lanes(program, inputs, outputs, work);
        }
        (parts, width)
    };
    let mut take = |first: usize, (parts, width): (usize, usize), outputs: &mut Aligned<S>| {
        let numbers = &*outputs.first(program.outputs() * width);
        (0..parts).for_each(|lane| read(first + lane, Results { numbers, width, lane }));
    };
    if count * program.listing().instructions.len() < PARALLEL || count < 2 * lanes {
        let mut first = 0;
        while first < count {
            let group = run(first, &mut work.inputs, &mut work.outputs, &mut work.work);
            take(first, group, &mut work.outputs);
            first += group.0;
        }
        return;
    }
    let groups = count.div_ceil(lanes);
    let each = groups.div_ceil(PIECES);
    work.pieces.resize_with(PIECES, Piece::default);
    work.pieces.par_iter_mut().enumerate().for_each(|(index, piece)| {
        piece.outputs.resize_with(piece.outputs.len().max(each * lanes), Aligned::default);
        let (mut first, last) = (index * each * lanes, count.min((index + 1) * each * lanes));
        let mut outputs = piece.outputs.iter_mut();
        while first < last {
            let Some(own) = outputs.next() else { break };
            first += run(first, &mut piece.inputs, own, &mut piece.work).0;
        }
    });
    for (index, piece) in work.pieces.iter_mut().enumerate() {
        let (mut first, last) = (index * each * lanes, count.min((index + 1) * each * lanes));
        let mut outputs = piece.outputs.iter_mut();
        while first < last {
            let Some(own) = outputs.next() else { break };
            let group = next_group(count - first, lanes);
            take(first, group, own);
            first += group.0;
        }
    }
}
