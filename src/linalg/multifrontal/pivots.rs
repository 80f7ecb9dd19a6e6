//! The elimination inside a front: blocks of columns, and a search for pivots among the rows that no later contribution changes.

use super::kernels::{ColumnThreads, largest, solve_unit_lower, subtract_columns, subtract_multiple, subtract_product};
use super::matrix_view::{MatrixView, MatrixViewMut};
use super::product::Target;
use crate::linalg::simd::{Kernel, dispatch};
use std::ops::Range;

/// Smallest pivot, as a share of the largest entry of its column: that of MA57 and MUMPS.
pub const PIVOT_SHARE: f64 = 0.01;
/// Columns that are eliminated before the rest of the front is changed.
pub const PANEL: usize = 32;
/// Columns that are eliminated one by one before the rest of their panel is changed.
pub const STRIP: usize = 4;
/// Rows up to which all columns of a panel are changed one by one.
pub const SMALL: usize = 64;

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
    /// Whether every pivot has to be found, however much smaller than its column.
    pub is_last: bool,
    /// Threads for large products.
    pub threads: usize,
}

impl PivotBlock<'_> {
    /// Eliminates all columns that have a pivot, and moves the others to the end; returns the number of pivots.
    ///
    /// Afterwards the columns hold L below the diagonal and U on and above it; the others, their Schur complement below.
    pub fn eliminate(&mut self) -> usize {
        self.eliminate_behind(0, self.columns.len())
    }

    /// The same behind columns that have their pivots; those from `end` on have found none in this round.
    fn eliminate_behind(&mut self, mut done: usize, mut end: usize) -> usize {
        let (count, mut done_before) = (self.columns.len(), 0);
        loop {
            if done == end {
                if done == done_before || done == count {
                    return done;
                }
                (end, done_before) = (count, done);
            }
            let panel = done..(done + PANEL).min(end);
            let found = self.eliminate_panel(panel.clone());
            self.subtract(done..found, panel.end..count, 0);
            self.postpone(found..panel.end, &mut end);
            done = found;
        }
    }

    /// The same from the first panel on in which a column has no pivot, whose pivots are subtracted already.
    pub fn eliminate_behind_first_failure(&mut self, panel: Range<usize>, found: usize) -> usize {
        let mut end = self.columns.len();
        self.postpone(found..panel.end, &mut end);
        self.eliminate_behind(found, end)
    }

    /// Eliminates the columns of a panel that have a pivot, and moves the others to its end; returns the end of the pivots.
    pub fn eliminate_panel(&mut self, panel: Range<usize>) -> usize {
        dispatch(Panel { block: self, columns: panel })
    }

    /// Moves columns without a pivot to the end of those that are still tried.
    #[inline(always)]
    fn postpone(&mut self, failed: Range<usize>, end: &mut usize) {
        for column in failed.rev() {
            *end -= 1;
            self.exchange(column, *end);
        }
    }

    /// Subtracts pivots from columns, while others subtract them from more columns.
    pub fn subtract(&mut self, pivots: Range<usize>, columns: Range<usize>, elsewhere: usize) {
        if !pivots.is_empty() && !columns.is_empty() {
            let workers = ColumnThreads { threads: self.threads, elsewhere };
            subtract_pivots(&mut self.values[..columns.end * self.size], self.size, pivots, columns.start, workers);
        }
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
        self.exchange_rows(a, b);
    }

    /// Exchanges two rows of all columns, and notes it.
    #[inline(always)]
    pub fn exchange_rows(&mut self, a: usize, b: usize) {
        if a != b {
            self.values.chunks_exact_mut(self.size).for_each(|column| column.swap(a, b));
            self.rows.swap(a, b);
            self.exchanges.push((a as u32, b as u32));
        }
    }

    /// Eliminates columns one after the other, each pivot subtracted from all of them at once; returns the end of the pivots.
    #[inline(always)]
    fn eliminate_strip<const FUSED: bool>(&mut self, columns: Range<usize>) -> usize {
        let size = self.size;
        let (mut next, mut end) = (columns.start, columns.end);
        while next < end {
            let Some(row) = self.pivot(next) else {
                self.postpone(next..next + 1, &mut end);
                continue;
            };
            self.exchange_rows(next, row);
            eliminate_column::<FUSED>(&mut self.values[..columns.end * size], size, next);
            next += 1;
        }
        next
    }

    /// The row of the pivot of a column, if it has one at `first` or below.
    #[inline(always)]
    fn pivot(&self, first: usize) -> Option<usize> {
        let column = &self.values[first * self.size..][..self.size];
        let usable = |value: f64| value.abs() > crate::tolerances::ROUND_OFF && value.is_finite();
        if usable(column[first]) {
            let limit = column[first].abs() / PIVOT_SHARE;
            if !column[first..].iter().fold(false, |exceeded, value| exceeded | (value.abs() > limit)) {
                return Some(first);
            }
        }
        let size_at = |row: &usize| if column[*row].is_nan() { -1.0 } else { column[*row].abs() };
        let best = (first..self.columns.len()).max_by(|a, b| size_at(a).total_cmp(&size_at(b)));
        let least = if self.is_last { 0.0 } else { PIVOT_SHARE * largest(&column[first..]) };
        best.filter(|&row| usable(column[row]) && column[row].abs() >= least)
    }
}

/// Divides what stands below a pivot by it, and subtracts it from all columns behind.
#[inline(always)]
pub fn eliminate_column<const FUSED: bool>(values: &mut [f64], size: usize, pivot: usize) {
    let (done, rest) = values.split_at_mut((pivot + 1) * size);
    let column = &mut done[pivot * size..];
    let inverse = 1.0 / column[pivot];
    let below = &mut column[pivot + 1..];
    below.iter_mut().for_each(|value| *value *= inverse);
    for column in rest.chunks_exact_mut(size) {
        subtract_multiple::<FUSED>(below, column[pivot], &mut column[pivot + 1..]);
    }
}

/// Subtracts a few pivots from a column.
#[inline(always)]
pub fn subtract_few<const FUSED: bool>(values: &mut [f64], size: usize, pivots: Range<usize>, column: usize) {
    let (done, rest) = values.split_at_mut(column * size);
    let (upper, lower) = rest[pivots.start..size].split_at_mut(pivots.len());
    for pivot in pivots.clone() {
        let (known, rest) = upper[pivot - pivots.start..].split_first_mut().expect("a pivot above the end");
        for (value, l) in rest.iter_mut().zip(&done[pivot * size + pivot + 1..]) {
            *value -= l * *known;
        }
    }
    subtract_columns::<FUSED>(&done[pivots.start * size + pivots.end..], size, upper, lower);
}

/// Subtracts the pivots of a panel from all columns from `first` on.
pub fn subtract_pivots(
    values: &mut [f64],
    size: usize,
    pivots: Range<usize>,
    first: usize,
    workers: impl Into<ColumnThreads>,
) {
    let (workers, columns) = (workers.into(), values.len() / size - first);
    let (done, rest) = values.split_at_mut(first * size);
    let done = MatrixView::new(done, size, first).block(pivots.start..size, pivots.clone());
    let rest = MatrixViewMut::new(rest, size, columns).block(pivots.start..size, 0..columns);
    let (mut upper, lower) = rest.split_rows(pivots.len());
    solve_unit_lower(done.block(0..pivots.len(), 0..pivots.len()), upper.reborrow(), workers);
    let below = done.block(pivots.len()..done.rows(), 0..pivots.len());
    subtract_product(lower, Target::Reduced, below, upper.as_view(), workers);
}

/// Columns that are eliminated a few at a time.
struct Panel<'p, 'j> {
    block: &'p mut PivotBlock<'j>,
    columns: Range<usize>,
}

impl Kernel for Panel<'_, '_> {
    /// The end of the pivots; columns without one follow up to the end of the panel, all pivots subtracted.
    type Output = usize;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> usize {
        let Panel { block, columns: Range { start: mut done, end: panel_end } } = self;
        let width = if block.size <= SMALL { PANEL } else { STRIP };
        let mut end = panel_end;
        while done < end {
            let strip = done..(done + width).min(end);
            let found = block.eliminate_strip::<FUSED>(strip.clone());
            if done < found {
                for column in strip.end..panel_end {
                    subtract_few::<FUSED>(block.values, block.size, done..found, column);
                }
            }
            block.postpone(found..strip.end, &mut end);
            done = found;
        }
        done
    }
}
