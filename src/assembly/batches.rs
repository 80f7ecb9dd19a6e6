//! Parts with the same program are evaluated side by side.

use super::constraint_programs::ConstraintLayout;
use super::element_programs::{ElementLayout, Force};
use super::null_spaces::{LEFT, NullSpaces, RIGHT, starts_of_numbers};
use super::numbering::{DofMap, System};
use super::places::{MOST_LANES, Places, Starts};
use super::reduction::{NodeReduction, RotationCoordinates};
use crate::elements::{ConstraintPhysics, RunScalar};
use crate::program::{Formula, Program, ProgramCache, ProgramWork};
use rayon::prelude::*;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::ops::Range;
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
    /// Where the numbers of the parts stand.
    pub places: Places,
    /// Where the numbers of the bases of each node begin, N_L and N_R.
    pub bases: SmallVec<[[Starts; 2]; 3]>,
    /// Its programs.
    pub programs: ProgramCache,
}

/// Elements.
pub(super) type ElementBatch = Batch<ElementLayout>;
impl<L: Copy> Batch<L> {
    /// Some of its parts, by their places in it, whose programs are those of the whole.
    pub fn of_chosen(&self, chosen: &[usize]) -> Self {
        let bases = self.bases.iter().map(|sides| sides.each_ref().map(|starts| starts.of_chosen(chosen)));
        Batch {
            parts: chosen.iter().map(|&place| self.parts[place]).collect(),
            nodes: self.nodes.clone(),
            formula: self.formula.clone(),
            layout: self.layout,
            places: self.places.of_chosen(chosen),
            bases: bases.collect(),
            programs: ProgramCache::default(),
        }
    }
}

/// Constraints.
pub(super) type ConstraintBatch = Batch<ConstraintLayout>;

/// Sorts parts that have a formula into batches, in the order in which their kinds first come.
fn sorted<'p, L>(
    count: usize,
    kind: impl Fn(usize) -> Option<(Arc<Formula>, Box<[NodeReduction]>, bool)>,
    layout: impl Fn(usize) -> L,
    numbers: impl Fn(usize) -> (&'p DofMap, Range<usize>),
    bases: &[[Range<usize>; 2]],
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
                places: Places::default(),
                bases: SmallVec::new(),
                programs: ProgramCache::default(),
            });
            batches.len() - 1
        });
        batches[place].parts.push(part);
    }
    for batch in &mut batches {
        batch.places = Places::of(batch.parts.iter().map(|&part| numbers(part)));
        let of_node = |node: usize, side: usize| {
            Starts::of_parts(batch.parts.iter().map(|&part| bases[numbers(part).0.nodes[node]][side].clone()))
        };
        let nodes = 0..batch.places.nodes.len();
        batch.bases = nodes.map(|node| [LEFT, RIGHT].map(|side| of_node(node, side))).collect();
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
        if unknowns.columns.is_empty() {
            return NodeReduction::Fixed { dofs };
        }
        match unknowns.local.and(RotationCoordinates::of(self.model.nodes[node].kind)) {
            None => NodeReduction::Free { dofs },
            Some(turning) => NodeReduction::RotationCoordinates { free: dofs - turning.coordinates(), turning },
        }
    }

    /// Elements by what they add to F.
    pub(super) fn sort_elements(&self, force: Force) -> Vec<ElementBatch> {
        let kind = |part: usize| {
            let formula = Arc::clone(force.formula(&self.model.elements[part].physics)?);
            Some((formula, self.reductions(&self.element_parts[part]), false))
        };
        let layout = |part: usize| ElementLayout::new(&self.model.elements[part].physics, force);
        let numbers = |part: usize| (&self.element_parts[part], 0..0);
        sorted(self.model.elements.len(), kind, layout, numbers, &starts_of_numbers(self))
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
        let numbers = |part: usize| (&self.constraint_parts[part], self.equations_of(part));
        sorted(self.constraint_parts.len(), kind, layout, numbers, &starts_of_numbers(self))
    }

    /// Constraints inside nodes that are eliminated.
    pub(super) fn sort_nodes(&self) -> Vec<ConstraintBatch> {
        let own = if self.options.unreduced { &[] } else { &self.locals[..] };
        let kind = |part: usize| Some((Arc::clone(own[part].physics.formula()), self.reductions(&own[part].part), false));
        let layout = |part: usize| ConstraintLayout {
            n: own[part].part.segments[0].len(),
            ..ConstraintLayout::of(&own[part].physics)
        };
        let numbers = |part: usize| (&own[part].part, own[part].equations.clone());
        sorted(own.len(), kind, layout, numbers, &starts_of_numbers(self))
    }

    /// The constraint of a batch: its first one stands for all.
    pub(super) fn constraint_of(&self, batch: &ConstraintBatch) -> &ConstraintPhysics {
        match self.global_constraint(batch.parts[0]) {
            Some(joint) => joint.physics,
            None => unreachable!("a batch has a part"),
        }
    }
}

/// Arguments of parts that are evaluated side by side, written one after the other: number i of lane l stands at i times their width + l.
pub(crate) struct Lanes<'i, S> {
    numbers: &'i mut [S],
    width: usize,
    /// The parts, one for each lane; further lanes have the numbers of the last one.
    pub parts: Range<usize>,
    place: usize,
}

impl<S: RunScalar> Lanes<'_, S> {
    /// The next numbers of each part come from a list.
    #[inline(always)]
    pub fn gather(&mut self, starts: &Starts, values: &[S]) {
        self.gather_at(self.place, starts, values);
        self.place += starts.length;
    }

    #[inline(always)]
    fn gather_at(&mut self, place: usize, starts: &Starts, values: &[S]) {
        self.gather_range(place..place + starts.length, starts, values);
    }

    /// Arguments are the first so many numbers of each part.
    #[inline(always)]
    fn gather_range(&mut self, arguments: Range<usize>, starts: &Starts, values: &[S]) {
        let target = &mut self.numbers[arguments.start * self.width..arguments.end * self.width];
        let (places, length) = (starts.places_from(self.parts.start), arguments.len());
        match self.width {
            1 => target.copy_from_slice(&values[places[0] as usize..][..length]),
            2 => gather::<S, 2>(length, places, values, target),
            4 => gather::<S, 4>(length, places, values, target),
            8 => gather::<S, 8>(length, places, values, target),
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
    }

    /// Runs of arguments come from a list, wherever they stand among the arguments.
    pub fn gather_runs(&mut self, runs: &[Run], lists: &[Starts], values: &[S]) {
        for Run { numbers, list, offset } in runs {
            self.gather_range(numbers.clone(), &lists[*list], &values[*offset..]);
        }
    }

    /// The argument at a place, and those behind it, are the same for all parts.
    pub fn spread_at(&mut self, place: usize, values: &[S]) {
        let rows = self.numbers[place * self.width..].chunks_exact_mut(self.width);
        rows.zip(values).for_each(|(row, &value)| row.fill(value));
    }

    /// The next numbers of each part are those of its nodes in one list after the other.
    #[inline(always)]
    pub fn gather_nodes<const LISTS: usize>(&mut self, segments: &[Starts], lists: [&[S]; LISTS]) {
        let count: usize = segments.iter().map(|starts| starts.length).sum();
        let mut first = self.place;
        for starts in segments {
            for (list, values) in lists.iter().enumerate() {
                self.gather_at(first + list * count, starts, values);
            }
            first += starts.length;
        }
        self.place += LISTS * count;
    }
    /// The next number is the same for all parts.
    #[inline(always)]
    pub fn spread(&mut self, value: S) {
        self.numbers[self.place * self.width..(self.place + 1) * self.width].fill(value);
        self.place += 1;
    }
    /// The next numbers of each part are those that `push` appends to a list.
    #[inline(always)]
    pub fn each(&mut self, list: &mut Vec<S>, push: impl Fn(usize, &mut Vec<S>)) {
        list.clear();
        self.parts.clone().for_each(|part| push(part, list));
        let (last, length) = (self.parts.len() - 1, list.len() / self.parts.len());
        let starts: [u32; MOST_LANES] = std::array::from_fn(|lane| (lane.min(last) * length) as u32);
        let target = &mut self.numbers[self.place * self.width..(self.place + length) * self.width];
        match self.width {
            1 => target.copy_from_slice(list),
            2 => gather::<S, 2>(length, &starts, list, target),
            4 => gather::<S, 4>(length, &starts, list, target),
            8 => gather::<S, 8>(length, &starts, list, target),
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
        self.place += length;
    }
    /// Leaves so many numbers what they are.
    pub fn skip(&mut self, count: usize) {
        self.place += count;
    }
}

impl Lanes<'_, f64> {
    /// The next numbers of each part are those that the bases of its nodes are made of.
    #[inline(always)]
    pub(super) fn gather_bases<L>(&mut self, batch: &Batch<L>, bases: &NullSpaces) {
        for starts in &batch.bases {
            for side in [LEFT, RIGHT] {
                self.gather(&starts[side], bases.numbers(side));
            }
        }
    }
}

/// Numbers of parts, one after the other in a list, moved to lie side by side.
#[inline(always)]
fn gather<S: Copy, const WIDTH: usize>(length: usize, starts: &[u32], values: &[S], target: &mut [S]) {
    #[inline(always)]
    fn block<S: Copy, const WIDTH: usize, const LENGTH: usize>(
        starts: &[u32; WIDTH],
        first: usize,
        values: &[S],
        rows: &mut [[S; WIDTH]],
    ) {
        let rows: &mut [[S; WIDTH]; LENGTH] = (&mut rows[first..first + LENGTH]).try_into().expect("its own length");
        for lane in 0..WIDTH {
            let start = starts[lane] as usize + first;
            let own: &[S; LENGTH] = values[start..start + LENGTH].try_into().expect("its own length");
            (0..LENGTH).for_each(|place| rows[place][lane] = own[place]);
        }
    }
    let starts: &[u32; WIDTH] = starts.first_chunk().expect("one for each lane");
    let rows = target.as_chunks_mut::<WIDTH>().0;
    if length == 7 {
        return block::<S, WIDTH, 7>(starts, 0, values, rows);
    }
    let mut first = 0;
    while first + 8 <= length {
        block::<S, WIDTH, 8>(starts, first, values, rows);
        first += 8;
    }
    if first + 4 <= length {
        block::<S, WIDTH, 4>(starts, first, values, rows);
        first += 4;
    }
    if first + 2 <= length {
        block::<S, WIDTH, 2>(starts, first, values, rows);
        first += 2;
    }
    if first < length {
        block::<S, WIDTH, 1>(starts, first, values, rows);
    }
}

/// values += factor times the numbers of a lane.
#[inline(always)]
fn add_lane<S: RunScalar, const WIDTH: usize>(own: &[[S; WIDTH]], lane: usize, factor: f64, values: &mut [S]) {
    #[inline(always)]
    fn add<S: RunScalar, const WIDTH: usize>(own: &[[S; WIDTH]], lane: usize, factor: f64, values: &mut [S]) {
        if factor == 1.0 {
            values.iter_mut().zip(own).for_each(|(value, row)| *value += row[lane]);
        } else {
            values.iter_mut().zip(own).for_each(|(value, row)| *value += row[lane] * factor);
        }
    }
    // a body, Euler parameters alone: without a loop
    if let (Ok(own), Ok(values)) = (<&[[S; WIDTH]; 7]>::try_from(own), <&mut [S; 7]>::try_from(&mut *values)) {
        add(own, lane, factor, values);
    } else if let (Ok(own), Ok(values)) = (<&[[S; WIDTH]; 4]>::try_from(own), <&mut [S; 4]>::try_from(&mut *values)) {
        add(own, lane, factor, values);
    } else {
        add(own, lane, factor, values);
    }
}

/// Arguments or results that follow each other and belong to numbers of a part that do so, too.
#[derive(Debug)]
pub(crate) struct Run {
    /// The arguments or results.
    numbers: Range<usize>,
    /// In which list of starts the part's numbers begin.
    list: usize,
    /// How far behind their begin.
    offset: usize,
}

impl Run {
    /// Adds an argument or result, behind those of the last run if it goes on there.
    pub fn extend(runs: &mut Vec<Run>, number: usize, list: usize, offset: usize) {
        match runs.last_mut() {
            Some(last) if last.list == list && last.numbers.end == number && last.offset + last.numbers.len() == offset => {
                last.numbers.end += 1;
            }
            _ => runs.push(Run { numbers: number..number + 1, list, offset }),
        }
    }
}

/// Results of parts that were evaluated side by side.
pub(crate) struct LaneResults<'r, S> {
    numbers: &'r [S],
    width: usize,
    /// The parts, one for each lane.
    pub parts: Range<usize>,
}

/// A rounding of a number of order one, up or down by its place in a list: in no pattern that numbers could follow.
pub(super) fn last_bit(place: usize) -> f64 {
    let up = (place as u32).wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15) >> 31 == 0;
    if up { f64::EPSILON } else { -f64::EPSILON }
}

impl<S: RunScalar> LaneResults<'_, S> {
    /// Adds the last bits of the first results, some up and some down, to the coordinates of the parts' nodes: what adding them up may lose.
    pub fn add_last_bits(&self, segments: &[Starts], values: &mut [S]) {
        for (lane, part) in self.parts.clone().enumerate() {
            let mut numbers = Strided { numbers: self.numbers.get(lane..).unwrap_or_default(), width: self.width };
            for place in segments.iter().flat_map(|starts| starts.of(part)) {
                let Some(own) = numbers.next() else { return };
                values[place] += own * last_bit(part.wrapping_mul(31).wrapping_add(place));
            }
        }
    }

    /// Adds results from a place on, times a factor, to the coordinates of the parts' nodes, part by part; returns the place behind them.
    #[inline(always)]
    pub fn add_to_nodes(&self, first: usize, segments: &[Starts], factor: f64, values: &mut [S]) -> usize {
        match self.width {
            1 => self.add_rows::<1>(first, segments, factor, values),
            2 => self.add_rows::<2>(first, segments, factor, values),
            4 => self.add_rows::<4>(first, segments, factor, values),
            8 => self.add_rows::<8>(first, segments, factor, values),
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
    }

    #[inline(always)]
    fn add_rows<const WIDTH: usize>(&self, first: usize, segments: &[Starts], factor: f64, values: &mut [S]) -> usize {
        let rows = self.numbers.as_chunks::<WIDTH>().0;
        let mut behind = first;
        for lane in 0..self.parts.len().min(WIDTH) {
            behind = first;
            for starts in segments {
                let own = &rows[behind..behind + starts.length];
                behind += starts.length;
                add_lane(own, lane, factor, &mut values[starts.of(self.parts.start + lane)]);
            }
        }
        behind
    }

    /// Adds runs of results, the first of which stands at a place, times a factor, to the numbers of the parts, part by part.
    #[inline(always)]
    pub fn add_runs(&self, first: usize, runs: &[Run], lists: &[Starts], factor: f64, values: &mut [S]) {
        match self.width {
            1 => self.add_runs_of::<1>(first, runs, lists, factor, values),
            2 => self.add_runs_of::<2>(first, runs, lists, factor, values),
            4 => self.add_runs_of::<4>(first, runs, lists, factor, values),
            8 => self.add_runs_of::<8>(first, runs, lists, factor, values),
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
    }

    fn add_runs_of<const WIDTH: usize>(&self, first: usize, runs: &[Run], lists: &[Starts], factor: f64, values: &mut [S]) {
        let rows = &self.numbers.as_chunks::<WIDTH>().0[first..];
        for lane in 0..self.parts.len().min(WIDTH) {
            for run in runs {
                let start = lists[run.list].of(self.parts.start + lane).start + run.offset;
                let own = &rows[run.numbers.clone()];
                add_lane(own, lane, factor, &mut values[start..start + own.len()]);
            }
        }
    }

    /// Adds results from a place on, times a factor, to numbers of the parts: as far behind their begin as `offsets` say.
    #[inline(always)]
    pub fn add_numbers(&self, first: usize, offsets: &[u32], starts: &Starts, factor: f64, values: &mut [S]) {
        let rows = self.numbers[first * self.width..].chunks_exact(self.width);
        for (lane, part) in self.parts.clone().enumerate() {
            let values = &mut values[starts.of(part)];
            for (&offset, row) in offsets.iter().zip(rows.clone()) {
                values[offset as usize] += row[lane] * factor;
            }
        }
    }

    /// Writes results from a place on to a list where `wanted` says so; returns the place behind them.
    #[inline(always)]
    pub fn write(&self, first: usize, starts: &Starts, wanted: &[Option<usize>], values: &mut [S]) -> usize {
        let behind = first + starts.length;
        for (lane, part) in self.parts.clone().enumerate() {
            let own = starts.of(part);
            let rows = self.numbers[first * self.width..behind * self.width].chunks_exact(self.width);
            for ((value, wanted), row) in values[own.clone()].iter_mut().zip(&wanted[own]).zip(rows) {
                if wanted.is_some() {
                    *value = row[lane];
                }
            }
        }
        behind
    }

    /// Results of each part, one part after the other.
    #[inline(always)]
    pub fn for_each_part(&self, mut f: impl FnMut(usize, Strided<S>)) {
        for (lane, part) in self.parts.clone().enumerate() {
            f(part, Strided { numbers: self.numbers.get(lane..).unwrap_or_default(), width: self.width });
        }
    }
}

/// Numbers that stand some places apart.
#[derive(Clone)]
pub(crate) struct Strided<'r, S> {
    numbers: &'r [S],
    width: usize,
}

impl Strided<'_, f64> {
    /// values += the numbers from one on.
    #[inline(always)]
    pub fn add_to(&self, first: usize, values: &mut [f64]) {
        match self.width {
            1 => self.add_strided::<1>(first, values),
            2 => self.add_strided::<2>(first, values),
            4 => self.add_strided::<4>(first, values),
            8 => self.add_strided::<8>(first, values),
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
    }

    #[inline(always)]
    fn add_strided<const WIDTH: usize>(&self, first: usize, values: &mut [f64]) {
        let own = self.numbers[first * WIDTH..].iter().step_by(WIDTH);
        values.iter_mut().zip(own).for_each(|(value, own)| *value += own);
    }
}

impl<S: Copy> Iterator for Strided<'_, S> {
    type Item = S;
    #[inline(always)]
    fn next(&mut self) -> Option<S> {
        let own = *self.numbers.first()?;
        self.numbers = self.numbers.get(self.width..).unwrap_or_default();
        Some(own)
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
    pieces: Vec<Group<S>>,
}

impl<S> BatchWork<S> {
    /// Some groups, made where they are not there yet.
    fn first(&mut self, count: usize) -> &mut [Group<S>] {
        if self.pieces.len() < count {
            self.pieces.resize_with(count, Group::default);
        }
        &mut self.pieces[..count]
    }
}

/// Elements that are evaluated side by side.
#[derive(Clone, Debug)]
struct Group<S> {
    /// Its first one, while it waits.
    first: usize,
    /// Arguments, one element after the other, where they are written so.
    apart: Vec<S>,
    inputs: Aligned<S>,
    outputs: Aligned<S>,
    work: ProgramWork<S>,
}

impl<S> Default for Group<S> {
    fn default() -> Self {
        Group {
            first: 0,
            apart: Vec::new(),
            inputs: Aligned::default(),
            outputs: Aligned::default(),
            work: ProgramWork::default(),
        }
    }
}

impl<S> Default for BatchWork<S> {
    fn default() -> Self {
        BatchWork { pieces: Vec::new() }
    }
}

/// Groups that several threads evaluate at a time, while the results of as many are taken.
const PIECES: usize = 16;
/// Groups that go through a section of a long program together: what they store in between should stay in the second cache.
const TOGETHER: usize = 4;
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

/// Executes a program for `count` parts: `write` sets the arguments of those that are evaluated side by side, with a list to use as it likes;
/// `read` takes their results, in the order of the parts.
pub(crate) fn run_lanes<S: RunScalar>(
    program: &Program,
    count: usize,
    work: &mut BatchWork<S>,
    write: impl Fn(Lanes<S>, &mut Vec<S>) + Sync,
    mut read: impl FnMut(LaneResults<S>) + Send,
) {
    let lanes = S::lanes();
    let (inputs, outputs) = (program.inputs(), program.outputs());
    let fill = |group: &mut Group<S>| {
        let (parts, width) = next_group(count - group.first, lanes);
        let numbers = group.inputs.first(inputs * width);
        write(Lanes { numbers, width, parts: group.first..group.first + parts, place: 0 }, &mut group.apart);
    };
    let run = |section: usize, group: &mut Group<S>| {
        let width = next_group(count - group.first, lanes).1;
        let (arguments, results) = (group.inputs.first(inputs * width), group.outputs.first(outputs * width));
        match (width, section) {
            (1, 0) => S::run(program, arguments, results, &mut group.work),
            (1, _) => {}
            _ => S::run_section(program, section, arguments, results, &mut group.work),
        }
    };
    let sections = if count * 3 > lanes { S::sections(program) } else { 1 };
    let evaluate = |groups: &mut [Group<S>]| {
        groups.iter_mut().for_each(fill);
        for section in 0..sections {
            groups.iter_mut().for_each(|group| run(section, group));
        }
    };
    let mut take = |group: &mut Group<S>| {
        let (parts, width) = next_group(count - group.first, lanes);
        let numbers = &*group.outputs.first(outputs * width);
        read(LaneResults { numbers, width, parts: group.first..group.first + parts });
    };
    let together = if sections > 1 { TOGETHER } else { 1 };
    let mut firsts = groups(count, lanes);
    let mut set_firsts = |groups: &mut [Group<S>]| {
        let next = groups.iter_mut().zip(&mut firsts);
        next.map(|(group, first)| group.first = first).count()
    };
    let alone = rayon::current_num_threads() == 1 || count < 2 * lanes;
    if alone || count * program.listing().instructions.len() < PARALLEL {
        let pieces = work.first(together);
        loop {
            let ready = set_firsts(pieces);
            if ready == 0 {
                return;
            }
            evaluate(&mut pieces[..ready]);
            pieces[..ready].iter_mut().for_each(&mut take);
        }
    }
    let (mut now, mut next) = work.first(2 * PIECES).split_at_mut(PIECES);
    let mut start = |groups: &mut [Group<S>]| {
        let ready = set_firsts(groups);
        groups[..ready].par_chunks_mut(together).for_each(evaluate);
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
    use super::*;

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

    #[test]
    fn numbers_are_gathered_into_lanes_and_results_added_from_them() {
        let values: Vec<f64> = (0..400).map(f64::from).collect();
        for width in [1, 4, 8] {
            for length in 1..24 {
                // three parts, the last of which fills the lanes that are left
                let starts = Starts::of_parts([7, 100, 250].into_iter().map(|start| start..start + length));
                let parts = 0..width.min(3);
                let mut numbers = vec![-1.0; width * (length + 1)];
                let mut lanes = Lanes { numbers: &mut numbers, width, parts: parts.clone(), place: 0 };
                lanes.gather(&starts, &values);
                lanes.spread(0.5);
                for lane in 0..width {
                    let own = starts.of(lane.min(2));
                    assert!((0..length).all(|place| numbers[place * width + lane] == values[own.start + place]));
                    assert_eq!(numbers[length * width + lane], 0.5);
                }
                for factor in [1.0, -2.0] {
                    let mut sums = vec![1.0; 400];
                    let results = LaneResults { numbers: &numbers, width, parts: parts.clone() };
                    let segments = std::slice::from_ref(&starts);
                    assert_eq!(results.add_to_nodes(0, segments, factor, &mut sums), length);
                    let added: Vec<usize> = parts.clone().flat_map(|part| starts.of(part)).collect();
                    let expected = |place| if added.contains(&place) { 1.0 + factor * values[place] } else { 1.0 };
                    assert!(sums.iter().enumerate().all(|(place, &sum)| sum == expected(place)), "{width} {length}");
                }
            }
        }
    }

    #[test]
    fn parts_of_a_program_without_results_have_none() {
        for width in [1, 4, 8] {
            let results = LaneResults::<f64> { numbers: &[], width, parts: 0..width };
            let mut count = 0;
            results.for_each_part(|_, mut own| count += usize::from(own.next().is_none()));
            assert_eq!(count, width);
        }
    }
}
