//! Elements by the unknowns that they touch: those of a rank, and those of each thread.

use super::batches::ElementBatch;
use super::element_programs::Force;
use super::evaluation::BatchWork;
use super::numbering::{ScatterMap, System};
use crate::linalg::{OwnUnknowns, Owners, SparsePattern, ranges_where};
use std::ops::Range;
use std::sync::Arc;

/// The elements of each batch whose nodes have some unknowns that are looked for.
fn touching(system: &System, force: Force, has_any: impl Fn(Range<usize>) -> bool) -> Vec<ElementBatch> {
    let is_own = |part: &usize| {
        let nodes = &system.element_parts[*part].nodes;
        nodes.iter().any(|&node| has_any(system.nodes[node].columns.clone()))
    };
    let of_batch = |batch: &ElementBatch| {
        let chosen: Vec<usize> = (0..batch.parts.len()).filter(|&place| is_own(&batch.parts[place])).collect();
        batch.of_chosen(&chosen)
    };
    system.element_batches(force).iter().map(of_batch).collect()
}

/// Elements that touch unknowns of this rank.
pub(super) struct OwnElements {
    pub unknowns: Arc<OwnUnknowns>,
    batches: [Option<Vec<ElementBatch>>; Force::KINDS],
    entries: Option<Vec<Range<usize>>>,
}

impl OwnElements {
    /// Of this rank's unknowns.
    pub fn new(unknowns: &Arc<OwnUnknowns>) -> Self {
        OwnElements { unknowns: Arc::clone(unknowns), batches: Default::default(), entries: None }
    }

    /// Entries of the matrix in columns that are own ones or have own rows.
    pub fn entries(&mut self, pattern: &SparsePattern) -> &[Range<usize>] {
        self.entries.get_or_insert_with(|| {
            let entries = |columns: Range<usize>| pattern.column_starts[columns.start]..pattern.column_starts[columns.end];
            let touches =
                |column: usize| self.unknowns.touches(column..column + 1, &pattern.rows[entries(column..column + 1)]);
            ranges_where(pattern.size, touches).into_iter().map(entries).collect()
        })
    }

    /// Those of each batch of all.
    pub fn batches(&mut self, system: &System, force: Force) -> &[ElementBatch] {
        self.batches[force.kind()].get_or_insert_with(|| touching(system, force, |columns| self.unknowns.has_any(columns)))
    }

    /// How many they are, once they have been asked for.
    pub fn count(&self) -> Option<usize> {
        let batches = self.batches[Force::Residual.kind()].as_ref()?;
        Some(batches.iter().map(|batch| batch.parts.len()).sum())
    }
}

/// Elements that each thread evaluates, and adds to the columns of its own unknowns alone: one that touches those of several is evaluated by all
/// of them.
pub(super) struct ThreadElements {
    pub owners: Arc<Owners>,
    threads: Vec<OfThread>,
}

/// Elements of one thread.
pub(super) struct OfThread {
    number: usize,
    batches: [Option<Vec<ColumnBatch>>; Force::KINDS],
    pub work: BatchWork<f64>,
}

/// Elements of a batch with own columns.
pub(super) struct ColumnBatch {
    pub elements: ElementBatch,
    /// Where the own columns of an element stand, if it has others.
    some: Vec<Option<Box<ScatterMap>>>,
}

impl ColumnBatch {
    fn new(system: &System, elements: ElementBatch, owners: &Owners, thread: usize) -> Self {
        let some = |&part: &usize| {
            let nodes = &system.element_parts[part].nodes;
            let is_all = nodes.iter().all(|&node| owners.has_all(thread, system.nodes[node].columns.clone()));
            let starts = &system.pattern.column_starts;
            let is_own = |place: usize| owners.of(starts.partition_point(|&start| start <= place) - 1) == thread;
            (!is_all).then(|| Box::new(system.element_blocks[part].at_some(is_own)))
        };
        ColumnBatch { some: elements.parts.iter().map(some).collect(), elements }
    }

    /// Where the own columns of an element stand, by its place in the batch.
    pub fn block<'b>(&'b self, system: &'b System, place: usize) -> &'b ScatterMap {
        self.some[place].as_deref().unwrap_or(&system.element_blocks[self.elements.parts[place]])
    }
}

impl ThreadElements {
    /// Of threads with unknowns of their own.
    pub fn new(owners: &Arc<Owners>) -> Self {
        let thread = |number| OfThread { number, batches: Default::default(), work: BatchWork::on_one_thread() };
        ThreadElements { owners: Arc::clone(owners), threads: (0..owners.count()).map(thread).collect() }
    }

    /// All threads, with the elements of each batch of all.
    pub fn threads(&mut self, system: &System, force: Force) -> &mut [OfThread] {
        for OfThread { number, batches, .. } in &mut self.threads {
            batches[force.kind()].get_or_insert_with(|| {
                let all = touching(system, force, |columns| self.owners.has_any(*number, columns)).into_iter();
                all.map(|elements| ColumnBatch::new(system, elements, &self.owners, *number)).collect()
            });
        }
        &mut self.threads
    }
}

impl OfThread {
    /// Those of each batch of all, and their workspace.
    pub fn batches(&mut self, force: Force) -> (&[ColumnBatch], &mut BatchWork<f64>) {
        let batches = self.batches[force.kind()].as_deref();
        (batches.expect("made for all threads"), &mut self.work)
    }
}
