//! The elimination inside a front: blocks of columns, and a search for pivots among the rows that no later contribution changes.

use super::kernels::{Target, largest, solve_unit_lower, subtract_columns, subtract_product};
use super::wide::{Job, widest};
use faer::prelude::ReborrowMut;
use faer::{MatMut, MatRef, Par};

/// Smallest pivot, as a share of the largest entry of its column.
pub const PIVOT_SHARE: f64 = 0.01;
/// Pivots smaller than this, in a matrix whose rows and columns have the size 1, are taken for zero.
pub const TINY_PIVOT: f64 = 1e-14;
/// Columns that are eliminated one by one before the rest of the front is changed.
const PANEL: usize = 32;

/// The columns of a front whose unknowns may be eliminated.
pub struct PivotBlock<'j> {
    /// All rows of these columns.
    pub values: &'j mut [f64],
    /// Number of rows.
    pub size: usize,
    /// Places of the unknowns' rows; they change with the order of the rows.
    pub rows: &'j mut [u32],
    /// Places of the unknowns of the columns.
    pub columns: &'j mut [u32],
    /// Exchanges of rows, in their order.
    pub exchanges: &'j mut Vec<(u32, u32)>,
    /// For each column the number of pivots that have been subtracted from it.
    pub subtracted: &'j mut Vec<u32>,
    /// Whether every pivot has to be found, however much smaller than its column.
    pub is_last: bool,
    /// Threads for large products.
    pub par: Par,
}

impl PivotBlock<'_> {
    /// Eliminates all columns that have a pivot, and moves the others to the end; returns the number of pivots.
    ///
    /// Afterwards the columns hold L below the diagonal and U on and above it; the others, their Schur complement below.
    pub fn eliminate(&mut self) -> usize {
        let count = self.columns.len();
        self.subtracted.clear();
        self.subtracted.resize(count, 0);
        // columns from `end` on found no pivot in this round
        let (mut done, mut end, mut done_before) = (0, count, 0);
        while done < end {
            let panel_end = (done + PANEL).min(end);
            let found = widest(Panel { block: self, first: done, end: panel_end });
            self.subtract_panel(done, found, panel_end);
            for failed in (found..panel_end).rev() {
                end -= 1;
                self.exchange(failed, end);
            }
            done = found;
            if done == end && done > done_before {
                (end, done_before) = (count, done);
            }
        }
        done
    }

    /// Subtracts the pivots of a panel from the columns beyond it.
    fn subtract_panel(&mut self, first: usize, found: usize, panel_end: usize) {
        let (size, count) = (self.size, self.columns.len());
        if found == first || panel_end == count {
            return;
        }
        let (done, rest) = self.values.split_at_mut(panel_end * size);
        let done = MatRef::from_column_major_slice(done, size, panel_end).subcols(first, found - first);
        let rest = MatMut::from_column_major_slice_mut(rest, size, count - panel_end);
        let (_, rest) = rest.split_at_row_mut(first);
        let (mut upper, lower) = rest.split_at_row_mut(found - first);
        solve_unit_lower(done.subrows(first, found - first), upper.rb_mut(), self.par);
        subtract_product(lower, Target::Reduced, done.subrows(found, size - found), upper.as_ref(), self.par);
    }

    /// Exchanges two unknowns, rows and columns.
    fn exchange(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        let (low, high) = (a.min(b), a.max(b));
        let (left, right) = self.values.split_at_mut(high * self.size);
        left[low * self.size..][..self.size].swap_with_slice(&mut right[..self.size]);
        self.columns.swap(a, b);
        self.subtracted.swap(a, b);
        self.exchange_rows(a, b);
    }

    #[inline(always)]
    fn exchange_rows(&mut self, a: usize, b: usize) {
        if a != b {
            self.values.chunks_exact_mut(self.size).for_each(|column| column.swap(a, b));
            self.rows.swap(a, b);
            self.exchanges.push((a as u32, b as u32));
        }
    }

    /// Subtracts pivots, the first of which is `from`, from a column.
    #[inline(always)]
    fn subtract<const FUSED: bool>(&mut self, column: usize, from: usize, to: usize) {
        if from == to {
            return;
        }
        let size = self.size;
        let (done, rest) = self.values.split_at_mut(column * size);
        let (upper, lower) = rest[from..size].split_at_mut(to - from);
        for pivot in from..to {
            let (known, rest) = upper[pivot - from..].split_first_mut().expect("a pivot above the end");
            for (value, l) in rest.iter_mut().zip(&done[pivot * size + pivot + 1..pivot * size + to]) {
                *value -= l * *known;
            }
        }
        subtract_columns::<FUSED>(&done[from * size + to..], size, upper, lower);
    }
}

/// Columns that are eliminated one after the other.
struct Panel<'p, 'j> {
    block: &'p mut PivotBlock<'j>,
    first: usize,
    end: usize,
}

impl Job for Panel<'_, '_> {
    /// The end of the pivots; columns without one follow up to the end of the panel, all pivots subtracted.
    type Output = usize;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> usize {
        let Panel { block, first, end } = self;
        let (size, count) = (block.size, block.columns.len());
        block.subtracted[first..end].fill(first as u32);
        let (mut next, mut candidates) = (first, end);
        while next < candidates {
            let from = block.subtracted[next] as usize;
            block.subtract::<FUSED>(next, from, next);
            block.subtracted[next] = next as u32;
            let column = &block.values[next * size..][..size];
            let most = largest(&column[next..]);
            let accepted = |value: f64| value.abs() >= PIVOT_SHARE * most && value.abs() > TINY_PIVOT && value.is_finite();
            let pivot = if accepted(column[next]) {
                Some(next)
            } else {
                let size_at = |row: &usize| if column[*row].is_nan() { -1.0 } else { column[*row].abs() };
                let best = (next..count).max_by(|a, b| size_at(a).total_cmp(&size_at(b)));
                let usable = |value: f64| block.is_last && value.abs() > TINY_PIVOT && value.is_finite();
                best.filter(|&row| accepted(column[row]) || usable(column[row]))
            };
            let Some(pivot) = pivot else {
                candidates -= 1;
                block.exchange(next, candidates);
                continue;
            };
            block.exchange_rows(next, pivot);
            let column = &mut block.values[next * size..][..size];
            let inverse = 1.0 / column[next];
            column[next + 1..].iter_mut().for_each(|value| *value *= inverse);
            next += 1;
        }
        for failed in next..end {
            let from = block.subtracted[failed] as usize;
            block.subtract::<FUSED>(failed, from, next);
        }
        next
    }
}
