//! Parts by the unknowns that they touch: those of a rank, and those of each thread.

use super::batches::Batch;
use super::constraint_programs::ConstraintLayout;
use super::element_programs::{ElementLayout, Force};
use super::evaluation::BatchWork;
use super::numbering::{ScatterMap, System};
use crate::linalg::{OwnUnknowns, Owners, SparsePattern, ranges_where};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Some parts of a batch.
struct OwnBatch<L> {
    parts: Batch<L>,
    /// Where those stand of which only some columns are taken.
    some: Vec<Option<Box<ScatterMap>>>,
}

/// Parts of a batch that are added to a matrix.
pub(super) struct Taken<'b, L> {
    /// All of the batch, whose programs are those of some.
    pub whole: &'b Batch<L>,
    pub parts: &'b Batch<L>,
    some: &'b [Option<Box<ScatterMap>>],
}

impl<'b, L> Taken<'b, L> {
    /// Where a part stands, by its place among those that are taken, if all of it stands where `whole` says.
    pub fn block(&self, place: usize, whole: impl Fn(usize) -> &'b ScatterMap) -> &'b ScatterMap {
        self.some.get(place).and_then(Option::as_deref).unwrap_or_else(|| whole(self.parts.parts[place]))
    }
}

/// Parts that touch unknowns of one owner, in the batches of all.
pub(super) struct OwnParts {
    owners: Arc<Owners>,
    owner: usize,
    /// Whether other columns are left to their owners.
    is_by_columns: bool,
    elements: [OnceLock<Vec<OwnBatch<ElementLayout>>>; Force::KINDS],
    constraints: OnceLock<Vec<OwnBatch<ConstraintLayout>>>,
    nodes: OnceLock<Vec<OwnBatch<ConstraintLayout>>>,
}

impl OwnParts {
    fn new(owners: &Arc<Owners>, owner: usize, is_by_columns: bool) -> Self {
        OwnParts {
            owners: Arc::clone(owners),
            owner,
            is_by_columns,
            elements: Default::default(),
            constraints: OnceLock::new(),
            nodes: OnceLock::new(),
        }
    }

    /// Those of each batch, by the columns of a part and where it stands.
    fn of<'b, L: Copy, C: Iterator<Item = Range<usize>>>(
        &self,
        system: &System,
        whole: &[Batch<L>],
        columns: impl Fn(usize) -> C,
        block: impl Fn(usize) -> &'b ScatterMap,
    ) -> Vec<OwnBatch<L>> {
        let starts = &system.pattern.column_starts;
        let is_own = |place: usize| self.owners.of(starts.partition_point(|&start| start <= place) - 1) == self.owner;
        let some = |&part: &usize| {
            let is_all = !self.is_by_columns || columns(part).all(|own| self.owners.has_all(self.owner, own));
            (!is_all).then(|| Box::new(block(part).at_some(is_own)))
        };
        let touches = |part: usize| columns(part).any(|own| self.owners.has_any(self.owner, own));
        let of_batch = |batch: &Batch<L>| {
            let chosen: Vec<usize> = (0..batch.parts.len()).filter(|&place| touches(batch.parts[place])).collect();
            let parts = batch.of_chosen(&chosen);
            OwnBatch { some: parts.parts.iter().map(some).collect(), parts }
        };
        whole.iter().map(of_batch).collect()
    }

    fn elements(&self, system: &System, force: Force) -> &[OwnBatch<ElementLayout>] {
        self.elements[force.kind()].get_or_init(|| {
            let columns = |part: usize| system.columns_of(&system.element_parts[part].nodes);
            self.of(system, system.element_batches(force), columns, |part| &system.element_blocks[part])
        })
    }

    fn constraints(&self, system: &System) -> &[OwnBatch<ConstraintLayout>] {
        self.constraints.get_or_init(|| {
            let columns = |part: usize| system.columns_of_constraint(part);
            self.of(system, system.constraint_batches(), columns, |part| &system.constraint_blocks[part])
        })
    }

    fn nodes(&self, system: &System) -> &[OwnBatch<ConstraintLayout>] {
        self.nodes.get_or_init(|| {
            let columns = |part: usize| system.columns_of(&system.locals[part].part.nodes);
            self.of(system, system.node_batches(), columns, |part| system.block_inside(part))
        })
    }
}

/// All parts of batches, or some.
fn taken<'b, L>(whole: &'b [Batch<L>], some: Option<&'b [OwnBatch<L>]>) -> impl ExactSizeIterator<Item = Taken<'b, L>> {
    whole.iter().enumerate().map(move |(place, whole)| match some.map(|some| &some[place]) {
        Some(OwnBatch { parts, some }) => Taken { whole, parts, some },
        None => Taken { whole, parts: whole, some: &[] },
    })
}

impl System<'_> {
    /// Unknowns of some nodes.
    fn columns_of(&self, nodes: &[usize]) -> impl Iterator<Item = Range<usize>> {
        nodes.iter().map(|&node| self.nodes[node].columns.clone())
    }

    /// Unknowns of the nodes of a constraint, and its multipliers.
    fn columns_of_constraint(&self, part: usize) -> impl Iterator<Item = Range<usize>> {
        let own = self.multiplier_columns[self.equations_of(part)].iter().flatten();
        self.columns_of(&self.constraint_parts[part].nodes).chain(own.map(|&column| column..column + 1))
    }

    /// Elements that add to a matrix: all, or those of an owner.
    pub(super) fn taken_elements<'s>(
        &'s self,
        force: Force,
        own: Option<&'s OwnParts>,
    ) -> impl Iterator<Item = Taken<'s, ElementLayout>> {
        taken(self.element_batches(force), own.map(|own| own.elements(self, force)))
    }

    /// Constraints between nodes that do.
    pub(super) fn taken_constraints<'s>(
        &'s self,
        own: Option<&'s OwnParts>,
    ) -> impl Iterator<Item = Taken<'s, ConstraintLayout>> {
        taken(self.constraint_batches(), own.map(|own| own.constraints(self)))
    }

    /// Constraints inside nodes that do.
    pub(super) fn taken_nodes<'s>(&'s self, own: Option<&'s OwnParts>) -> impl Iterator<Item = Taken<'s, ConstraintLayout>> {
        taken(self.node_batches(), own.map(|own| own.nodes(self)))
    }
}

/// Parts that touch unknowns of this rank.
pub(super) struct PartsOfRank {
    pub unknowns: Arc<OwnUnknowns>,
    pub parts: OwnParts,
    entries: OnceLock<Vec<Range<usize>>>,
}

impl PartsOfRank {
    /// Of this rank's unknowns.
    pub fn new(unknowns: &Arc<OwnUnknowns>) -> Self {
        let parts = OwnParts::new(unknowns.owners(), unknowns.rank(), false);
        PartsOfRank { unknowns: Arc::clone(unknowns), parts, entries: OnceLock::new() }
    }

    /// Entries of the matrix in columns that are own ones or have own rows.
    pub fn entries(&self, pattern: &SparsePattern) -> &[Range<usize>] {
        self.entries.get_or_init(|| {
            let entries = |columns: Range<usize>| pattern.column_starts[columns.start]..pattern.column_starts[columns.end];
            let touches =
                |column: usize| self.unknowns.touches(column..column + 1, &pattern.rows[entries(column..column + 1)]);
            ranges_where(pattern.size, touches).into_iter().map(entries).collect()
        })
    }

    /// How many elements they are, once they have been asked for.
    pub fn elements(&self) -> Option<usize> {
        let batches = self.parts.elements[Force::Residual.kind()].get()?;
        Some(batches.iter().map(|batch| batch.parts.parts.len()).sum())
    }
}

/// Parts that each thread evaluates, and adds to the columns of its own unknowns alone: one that touches those of several is evaluated by all
/// of them.
pub(super) struct PartsOfThreads {
    pub owners: Arc<Owners>,
    pub threads: Vec<(OwnParts, BatchWork<f64>)>,
}

impl PartsOfThreads {
    /// Of threads with unknowns of their own.
    pub fn new(owners: &Arc<Owners>) -> Self {
        let thread = |number| (OwnParts::new(owners, number, true), BatchWork::on_one_thread());
        PartsOfThreads { owners: Arc::clone(owners), threads: (0..owners.count()).map(thread).collect() }
    }
}
