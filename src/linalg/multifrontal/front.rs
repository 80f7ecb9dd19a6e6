//! One front: assembly of entries and contributions, elimination, and the contribution to the front above.

// equations, state, parameters, time and targets are arguments
#![allow(clippy::too_many_arguments)]

use super::entries::EntryBlock;
use super::factors::{FrontStorage, Part};
use super::kernels::{ColumnThreads, solve_unit_lower, subtract_product};
use super::matrix_view::{MatrixView, MatrixViewMut};
use super::pivots::PivotBlock;
use super::product::Target;
use super::small_front::{LANES, Scratch, SmallFront};
use super::symbolic::{Front, Run, Symbolic};
use crate::linalg::Singular;
use crate::linalg::vectors::dispatch_vectors;

/// What a front leaves to the one above: a square matrix, the rows of delayed pivots first, column by column.
#[derive(Clone, Copy)]
pub struct Contribution<'c> {
    /// Number of the front.
    pub front: usize,
    /// Places of the rows whose pivots are delayed.
    pub delayed_rows: &'c [u32],
    /// Places of the columns whose pivots are delayed.
    pub delayed_columns: &'c [u32],
    /// The matrix.
    pub values: &'c [f64],
}

/// Lists that are used in one front after the other.
#[derive(Default)]
pub struct Workspace {
    pub runs: Vec<Run>,
    /// First run of each child, first that does not belong to rows whose pivots are looked for, and end.
    pub bounds: Vec<[usize; 3]>,
    exchanges: Vec<(u32, u32)>,
    scratch: Scratch,
}

impl Workspace {
    /// Where the rows of each child stand in a front; those of delayed pivots follow the front's own, and are noted there.
    pub fn place(
        &mut self,
        symbolic: &Symbolic,
        front: &Front,
        children: &[Contribution<'_>],
        rows: &mut [u32],
        columns: &mut [u32],
    ) {
        let Workspace { runs, bounds, .. } = self;
        runs.clear();
        bounds.clear();
        let delayed = rows.len() - front.pivots;
        let mut next = front.pivots;
        for child in children {
            let start = runs.len();
            let own_delayed = child.delayed_rows.len();
            if own_delayed > 0 {
                rows[next..next + own_delayed].copy_from_slice(child.delayed_rows);
                columns[next..next + own_delayed].copy_from_slice(child.delayed_columns);
                runs.push(Run { from: 0, to: next as u32, length: own_delayed as u32 });
                next += own_delayed;
            }
            let shifted = |run: &Run| {
                let shift = if run.to as usize >= front.pivots { delayed } else { 0 };
                Run { from: run.from + own_delayed as u32, to: run.to + shift as u32, length: run.length }
            };
            runs.extend(symbolic.extensions[symbolic.fronts[child.front].extensions.clone()].iter().map(shifted));
            let own = runs[start..].iter().take_while(|run| (run.to as usize) < rows.len()).count();
            bounds.push([start, start + own, runs.len()]);
        }
    }

    /// What children contribute, and where: all rows, those whose pivots are looked for, and the others.
    pub fn extensions<'w>(
        &'w self,
        symbolic: &'w Symbolic,
        children: &'w [Contribution<'w>],
    ) -> impl Iterator<Item = ([&'w [Run]; 3], Columns<'w>)> {
        children.iter().zip(&self.bounds).map(move |(child, &[start, middle, end])| {
            let order = child.delayed_rows.len() + symbolic.fronts[child.front].others();
            let runs = [&self.runs[start..end], &self.runs[start..middle], &self.runs[middle..end]];
            (runs, Columns { values: child.values, length: order })
        })
    }
}

/// Contributions that wait for the front above, the last one first.
#[derive(Default)]
pub struct Stack {
    pub memory: Vec<f64>,
    pub height: usize,
}

impl Stack {
    /// A place for some numbers, whatever they are, and for up to `LANES` more that may be written over.
    fn space(&mut self, length: usize) -> &mut [f64] {
        let start = self.height;
        self.height += length;
        if self.memory.len() < self.height + LANES {
            self.memory.resize(self.height + LANES, 0.0);
        }
        &mut self.memory[start..self.height + LANES]
    }
}

/// Assembles and factors a front, and writes its contribution.
///
/// # Errors
/// [`Singular`] with the column that has no pivot, if the front is a last one.
pub fn factor_front(
    symbolic: &Symbolic,
    number: usize,
    values: &[f64],
    part: &mut Part<'_>,
    children: &[Contribution<'_>],
    output: &mut Stack,
    workspace: &mut Workspace,
    threads: usize,
) -> Result<(), Singular> {
    let front = &symbolic.fronts[number];
    if front.is_small() && children.iter().all(|child| child.delayed_rows.is_empty()) {
        let (storage, rows) = part.prepare_small(symbolic, number);
        let (contribution, scratch) = (output.space(front.others().pow(2)), &mut workspace.scratch);
        let form = dispatch_vectors(SmallFront { symbolic, front, values, children, rows, storage, contribution, scratch });
        if part.set_small(symbolic, number, form) {
            return Ok(());
        }
        output.height -= front.others().pow(2);
    }
    let delayed: usize = children.iter().map(|child| child.delayed_rows.len()).sum();
    let FrontStorage { lower, upper, rows, columns } = part.prepare(symbolic, number, delayed);
    let (summed, others) = (rows.len(), front.others());
    let size = summed + others;
    let blocks = &symbolic.entries[front.entries.clone()];
    add_entries(blocks, values, Summed { lower, upper, pivots: front.pivots, delayed, size });

    workspace.place(symbolic, front, children, rows, columns);
    for ([runs, own, later], source) in workspace.extensions(symbolic, children) {
        extend(source, [runs, own], lower, size, [0, 0]);
        extend(source, [own, later], upper, summed, [0, summed]);
    }

    let exchanges = &mut workspace.exchanges;
    exchanges.clear();
    let mut block = PivotBlock { values: &mut *lower, size, rows, columns, exchanges, is_last: front.is_last(), threads };
    let found = block.eliminate();
    if found < summed && front.is_last() {
        return Err(Singular { unknown: symbolic.order[columns[found] as usize] as usize });
    }
    let order = size - found;
    let contribution = &mut output.space(order * order)[..order * order];
    reduce_others(lower, upper, [size, summed, found], exchanges, contribution, threads.into());
    for ([_, _, later], source) in workspace.extensions(symbolic, children) {
        extend(source, [later, later], contribution, order, [found, found]);
    }
    part.set_eliminated(number, found);
    Ok(())
}

/// Solves and reduces some of the other columns with all pivots, after exchanges of rows: U, and columns of the contribution, before which those
/// of delayed pivots stand where there is room for them.
///
/// * `[size, summed, found]` rows of the front, those whose pivots are looked for, and those that have one
pub fn reduce_others(
    lower: &[f64],
    upper: &mut [f64],
    [size, summed, found]: [usize; 3],
    exchanges: &[(u32, u32)],
    contribution: &mut [f64],
    workers: ColumnThreads,
) {
    let (own, left, order) = (upper.len() / summed.max(1), summed - found, size - found);
    for column in upper.chunks_exact_mut(summed.max(1)) {
        exchanges.iter().for_each(|&(a, b)| column.swap(a as usize, b as usize));
    }
    let lower = MatrixView::new(lower, size, summed);
    let (mut known, unknown) = MatrixViewMut::new(upper, summed, own).split_rows(found);
    solve_unit_lower(lower.block(0..found, 0..found), known.reborrow(), workers);
    let width = contribution.len() / order.max(1);
    let (mut late, matrix) = MatrixViewMut::new(contribution, order, width).split_columns(width - own);
    if width > own {
        late.copy_from(lower.block(found..size, found..summed));
    }
    let (mut top, bottom) = matrix.split_rows(left);
    if left > 0 {
        top.copy_from(unknown.as_view());
        subtract_product(top, Target::Reduced, lower.block(found..summed, 0..found), known.as_view(), workers);
    }
    subtract_product(bottom, Target::Replaced, lower.block(summed..size, 0..found), known.as_view(), workers);
}

/// target += source, without a loop for the unknowns of one or two nodes.
#[inline(always)]
pub fn add(target: &mut [f64], source: &[f64]) {
    #[inline(always)]
    fn of<const W: usize>(target: &mut [f64], source: &[f64]) {
        if let (Some(target), Some(source)) = (target.first_chunk_mut::<W>(), source.first_chunk::<W>()) {
            for i in 0..W {
                target[i] += source[i];
            }
        }
    }
    match source.len() {
        1 => of::<1>(target, source),
        2 => of::<2>(target, source),
        3 => of::<3>(target, source),
        6 => of::<6>(target, source),
        12 => of::<12>(target, source),
        _ => target.iter_mut().zip(source).for_each(|(target, source)| *target += source),
    }
}

/// Columns and rows of a front whose pivots are looked for, some of which other fronts have delayed.
pub struct Summed<'j> {
    /// All rows of these columns.
    pub lower: &'j mut [f64],
    /// These rows of the other columns.
    pub upper: &'j mut [f64],
    /// Number of the front's own pivots, of delayed ones, and of all rows.
    pub pivots: usize,
    pub delayed: usize,
    pub size: usize,
}

/// Adds entries of the matrix to the columns and rows of pivots.
pub fn add_entries(blocks: &[EntryBlock], values: &[f64], summed: Summed<'_>) {
    let Summed { lower, upper, pivots, delayed, size } = summed;
    for block in blocks {
        let (row, column) = (block.row as usize, block.column as usize);
        if row >= pivots && column >= pivots {
            continue;
        }
        let (target, stride) = if column < pivots {
            let row = if row < pivots { row } else { row + delayed };
            (&mut lower[row + column * size..], size)
        } else {
            let summed = pivots + delayed;
            (&mut upper[row + (column - pivots) * summed..], summed)
        };
        let (source, height) = (&values[block.source as usize..], block.height as usize);
        for column in 0..block.width as usize {
            let source = &source[column * block.stride as usize..][..height];
            add(&mut target[column * stride..][..height], source);
        }
    }
}

/// A matrix by columns.
#[derive(Clone, Copy)]
pub struct Columns<'j> {
    values: &'j [f64],
    /// Number of rows.
    length: usize,
}

/// Adds what of a contribution belongs to some rows and columns of a matrix, which begins with the row and column `first` of the front.
pub fn extend(source: Columns<'_>, [rows, columns]: [&[Run]; 2], values: &mut [f64], length: usize, first: [usize; 2]) {
    for columns in columns {
        for column in 0..columns.length as usize {
            let source = &source.values[(columns.from as usize + column) * source.length..][..source.length];
            let target = &mut values[(columns.to as usize + column - first[1]) * length..][..length];
            add_rows(rows, source, target, first[0]);
        }
    }
}

/// target += source in some rows, the target beginning with the row `first`.
#[inline(always)]
pub fn add_rows(rows: &[Run], source: &[f64], target: &mut [f64], first: usize) {
    for run in rows {
        let (from, to, length) = (run.from as usize, run.to as usize - first, run.length as usize);
        add(&mut target[to..][..length], &source[from..][..length]);
    }
}
