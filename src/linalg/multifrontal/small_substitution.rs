//! Solutions with the factors of small fronts.
//!
//! A^T = (L D U)^T is of the same form with U^T for L and L^T for U, in rows where A has columns: with factors that are
//! transposed once, both systems are solved by the same columns of vector registers.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::small_front::{LANES, MASK, SMALL_FRONT, Shape, SmallPlan};
use crate::linalg::simd::prefetch;
use crate::linalg::vectors::{Instructions, Vector};
use std::mem::MaybeUninit;
use std::ops::Range;

/// A small front with its factors, those of A or of A^T.
#[derive(Clone, Copy)]
pub struct SmallFactors<'f> {
    plan: SmallPlan,
    /// U, D^-1 and L where [`Shape`] says, and `LANES` numbers or more without a meaning.
    factors: *const f64,
    /// Places of the other rows.
    others: &'f [u32],
}

impl<'f> SmallFactors<'f> {
    /// Of a plan, from the factors of all small fronts and the places of the rows of all fronts, for which it was made.
    #[inline(always)]
    pub fn new(plan: &SmallPlan, values: &'f [f64], rows: &'f [u32]) -> Self {
        let (first, others) = (plan.rows as usize, plan.others as usize);
        let line = plan.line as usize * LANES;
        debug_assert!(rows.len() >= first + others);
        debug_assert!(values.len() >= line + plan.shape().storage(), "factors of a small front");
        // SAFETY: a plan lies inside the lists that it was made for, whose lengths its analysis tells.
        unsafe {
            let factors = values.as_ptr().add(line);
            SmallFactors { plan: *plan, factors, others: rows.get_unchecked(first..first + others) }
        }
    }

    /// Place of the first pivot.
    #[inline(always)]
    pub fn first(&self) -> usize {
        self.plan.first as usize
    }

    /// Where a row of the first column of L would be, and the distance from there to that of the second one, one more than to the third.
    #[inline(always)]
    fn lower(&self) -> (*const f64, isize) {
        let shape = self.plan.shape();
        (self.factors.wrapping_add(shape.lower()).wrapping_sub(1), shape.size() as isize - 2)
    }

    /// Asks for L before it is read.
    #[inline(always)]
    pub fn prefetch_lower(&self) {
        let shape = self.plan.shape();
        self.prefetch(shape.lower()..shape.storage());
    }

    /// Asks for U and D^-1 before they are read.
    #[inline(always)]
    pub fn prefetch_upper(&self) {
        self.prefetch(0..self.plan.shape().lower());
    }

    #[inline(always)]
    fn prefetch(&self, numbers: Range<usize>) {
        numbers.step_by(LANES).for_each(|number| prefetch(self.factors.wrapping_add(number)));
    }
}

// in loops: a closure would not be compiled for the vectors
impl SmallFactors<'_> {
    /// L y = b for `W` vectors: y to `solution`, and what it takes from the other rows.
    ///
    /// # Safety
    /// Each vector has all places of the front and `LANES` numbers more.
    #[inline(always)]
    pub unsafe fn forward<I: Instructions, const W: usize>(&self, residual: [*mut f64; W], solution: [*mut f64; W]) {
        let (first, pivots) = (self.first(), self.plan.pivots as usize);
        let (mut triangle, mut step) = self.lower();
        let mut row = 0;
        // SAFETY: columns of the factors; what is read or written behind the last row has no meaning and is written
        // later or not at all.
        unsafe {
            let (mut given, mut known) = (residual, solution);
            for w in 0..W {
                (given[w], known[w]) = (residual[w].add(first), solution[w].add(first));
            }
            while row < pivots {
                let sums = products::<I::Eight, W>(self.lower(), row, row, known);
                if W == 1 {
                    // numbers one by one: each waits for one product, and none for other fronts' vectors
                    let mut lanes = [0.0; LANES];
                    sums[0].store(lanes.as_mut_ptr());
                    let columns = (triangle.wrapping_add(row), step);
                    unit_lower_numbers::<I>(given[0].add(row), &lanes, columns, pivots - row, known[0].add(row));
                } else {
                    let mut x = sums;
                    for w in 0..W {
                        x[w] = I::Eight::load(given[w].add(row)).plus(sums[w]);
                    }
                    x = unit_lower::<I, W>(x, (triangle.wrapping_add(row), step), pivots - row);
                    for w in 0..W {
                        x[w].store(known[w].add(row));
                    }
                }
                row += LANES;
                (triangle, step) = skip((triangle, step), LANES as isize);
            }
            self.reduce_others::<I, W>(residual, solution);
        }
    }

    /// What y takes from the other rows for `W` vectors.
    ///
    /// # Safety
    /// As for [`SmallFactors::forward`].
    #[inline(always)]
    unsafe fn reduce_others<I: Instructions, const W: usize>(&self, residual: [*mut f64; W], solution: [*mut f64; W]) {
        let SmallFactors { plan, others, .. } = *self;
        let (first, pivots) = (self.first(), plan.pivots as usize);
        // SAFETY: as for the rows of the pivots.
        unsafe {
            let mut known = solution;
            for w in 0..W {
                known[w] = solution[w].add(first);
            }
            let mut other = 0;
            while other < others.len() {
                let sums = products::<I::Eight, W>(self.lower(), pivots + other, pivots, known);
                let rows = &others[other..others.len().min(other + LANES)];
                for w in 0..W {
                    // lanes by a changing number, through memory
                    let mut lanes = [0.0; LANES];
                    sums[w].store(lanes.as_mut_ptr());
                    for (lane, &place) in rows.iter().enumerate() {
                        *residual[w].add(place as usize) += lanes[lane];
                    }
                }
                other += LANES;
            }
        }
    }

    /// D U x = y for `W` vectors, in place of y.
    ///
    /// # Safety
    /// As for [`SmallFactors::forward`].
    #[inline(always)]
    pub unsafe fn backward<I: Instructions, const W: usize>(&self, solution: [*mut f64; W]) {
        let SmallFactors { plan, others, .. } = *self;
        let first = self.first();
        let mut known = [[const { MaybeUninit::<f64>::uninit() }; SMALL_FRONT]; W];
        // SAFETY: places of the front.
        unsafe {
            let mut own = solution;
            for w in 0..W {
                own[w] = solution[w].add(first);
            }
            for (other, &place) in others.iter().enumerate() {
                for w in 0..W {
                    known[w][other].write(*solution[w].add(place as usize));
                }
            }
            let mut end = (plan.pivots as usize).next_multiple_of(LANES / 2);
            if !end.is_multiple_of(LANES) {
                end -= LANES / 2;
                self.backward_rows::<I, I::Four, W>(own, &known, end);
            }
            while end > 0 {
                end -= LANES;
                self.backward_rows::<I, I::Eight, W>(own, &known, end);
            }
        }
    }

    /// As many rows as lanes, from `row` on.
    ///
    /// # Safety
    /// The vectors have so many numbers, and the others have been written.
    #[inline(always)]
    unsafe fn backward_rows<I: Instructions, V: Vector, const W: usize>(
        &self,
        solution: [*mut f64; W],
        others: &[[MaybeUninit<f64>; SMALL_FRONT]; W],
        row: usize,
    ) {
        let (shape, pivots) = (self.plan.shape(), self.plan.pivots as usize);
        // SAFETY: columns of the factors and their inverse pivots; what is read behind the last pivot has no meaning and is not written.
        unsafe {
            let mut x = [V::splat(0.0); W];
            for w in 0..W {
                x[w] = V::load(solution[w].add(row)).times(V::load(self.factors.add(shape.inverses() + row)));
            }
            let mut column = self.factors.add(shape.beside() + row);
            for other in 0..self.others.len() {
                let u = V::load(column);
                for w in 0..W {
                    x[w] = x[w].minus_product(u, V::splat(others[w][other].assume_init()));
                }
                column = column.wrapping_add(pivots);
            }
            let upper = self.factors.add(row);
            let behind = row + V::LANES;
            let mut column = upper.wrapping_add(behind * (behind - 1) / 2);
            for k in behind..pivots {
                let u = V::load(column);
                for w in 0..W {
                    x[w] = x[w].minus_product(u, V::splat(*solution[w].add(k)));
                }
                column = column.wrapping_add(k);
            }
            // of the column before the first one of the triangle, to which `row` columns are added
            let triangle = upper.wrapping_add(row * row.saturating_sub(1) / 2);
            let count = V::LANES.min(pivots - row);
            let mut lanes = [0.0; LANES];
            if W == 1 {
                x[0].store(lanes.as_mut_ptr());
                unit_upper_numbers::<I>(&lanes, triangle, row, count, solution[0].add(row));
            } else {
                x = unit_upper::<V, W>(x, triangle, row, count);
                for w in 0..W {
                    x[w].store(lanes.as_mut_ptr());
                    solution[w].add(row).copy_from_nonoverlapping(lanes.as_ptr(), count);
                }
            }
        }
    }
}

/// Where a row stands in one of the columns of L further on, and the distance from there to the next column.
#[inline(always)]
fn skip((column, step): (*const f64, isize), columns: isize) -> (*const f64, isize) {
    (column.wrapping_offset(columns * step - columns * (columns - 1) / 2), step - columns)
}

/// -L y for some rows of the first `count` columns, from `row` on.
///
/// # Safety
/// There are so many columns, and as many numbers in each vector.
#[inline(always)]
unsafe fn products<V: Vector, const W: usize>(
    (column, mut step): (*const f64, isize),
    row: usize,
    count: usize,
    known: [*mut f64; W],
) -> [V; W] {
    let mut sums = [V::splat(0.0); W];
    let mut column = column.wrapping_add(row);
    let mut k = 0;
    // SAFETY: promised by the caller.
    unsafe {
        while k + 2 <= count {
            let (l, next) = (V::load(column), V::load(column.wrapping_offset(step)));
            for w in 0..W {
                sums[w] = sums[w].minus_product(l, V::splat(*known[w].add(k)));
                sums[w] = sums[w].minus_product(next, V::splat(*known[w].add(k + 1)));
            }
            (column, step) = skip((column, step), 2);
            k += 2;
        }
        if k < count {
            let l = V::load(column);
            for w in 0..W {
                sums[w] = sums[w].minus_product(l, V::splat(*known[w].add(k)));
            }
        }
    }
    sums
}

/// L^-1 (b + s) with a unit lower triangle of `count` columns, of which as many as lanes are used.
///
/// # Safety
/// There are so many columns and numbers.
#[inline(always)]
unsafe fn unit_lower_numbers<I: Instructions>(
    b: *const f64,
    s: &[f64; LANES],
    columns: (*const f64, isize),
    count: usize,
    solved: *mut f64,
) {
    let mut x = [0.0; LANES];
    let column = columns_of(columns);
    macro_rules! rows {
        ($($row:literal: $($p:literal)*;)*) => {$(
            if $row >= count {
                return;
            }
            // SAFETY: promised by the caller.
            unsafe {
                x[$row] = *b.add($row) + s[$row];
                $(x[$row] = I::minus_product(x[$row], *column[$p].add($row), x[$p]);)*
                *solved.add($row) = x[$row];
            }
        )*};
    }
    rows!(0: ; 1: 0; 2: 0 1; 3: 0 1 2; 4: 0 1 2 3; 5: 0 1 2 3 4; 6: 0 1 2 3 4 5; 7: 0 1 2 3 4 5 6;);
}

/// So many columns of L as are solved together.
#[inline(always)]
fn columns_of(mut first: (*const f64, isize)) -> [*const f64; LANES] {
    let mut columns = [first.0; LANES];
    for own in &mut columns {
        *own = first.0;
        first = skip(first, 1);
    }
    columns
}

/// U^-1 x with a unit upper triangle of `count` columns, the first of which has `above` rows above it.
///
/// # Safety
/// There are so many columns and numbers.
#[inline(always)]
unsafe fn unit_upper_numbers<I: Instructions>(
    lanes: &[f64; LANES],
    column: *const f64,
    above: usize,
    count: usize,
    solved: *mut f64,
) {
    let mut x = *lanes;
    macro_rules! rows {
        ($($row:literal: $($p:literal)*;)*) => {$(
            if $row < count {
                // SAFETY: promised by the caller.
                unsafe {
                    $(
                        if $p < count {
                            x[$row] = I::minus_product(x[$row], *column.add($p * above + $p * ($p - 1) / 2 + $row), x[$p]);
                        }
                    )*
                    *solved.add($row) = x[$row];
                }
            }
        )*};
    }
    rows!(7: ; 6: 7; 5: 7 6; 4: 7 6 5; 3: 7 6 5 4; 2: 7 6 5 4 3; 1: 7 6 5 4 3 2; 0: 7 6 5 4 3 2 1;);
}

/// L^-1 x with a unit lower triangle of `count` columns, as many as lanes at most.
///
/// # Safety
/// There are so many columns.
#[inline(always)]
unsafe fn unit_lower<I: Instructions, const W: usize>(
    mut x: [I::Eight; W],
    columns: (*const f64, isize),
    count: usize,
) -> [I::Eight; W] {
    let column = columns_of(columns);
    macro_rules! steps {
        ($($p:literal)*) => {$(
            if $p + 1 >= count {
                return x;
            }
            // SAFETY: promised by the caller.
            let l = unsafe { I::Eight::load(column[$p]).masked(MASK.as_ptr().add(SMALL_FRONT - 1 - $p)) };
            for w in 0..W {
                x[w] = x[w].minus_product(l, x[w].broadcast::<$p>());
            }
        )*};
    }
    steps!(0 1 2 3 4 5 6);
    x
}

/// The same in vectors.
///
/// # Safety
/// There are so many columns.
#[inline(always)]
unsafe fn unit_upper<V: Vector, const W: usize>(mut x: [V; W], column: *const f64, above: usize, count: usize) -> [V; W] {
    macro_rules! steps {
        ($($p:literal)*) => {$(
            if $p < V::LANES && $p < count {
                // SAFETY: promised by the caller.
                let u = unsafe {
                    V::load(column.add($p * above + $p * ($p - 1) / 2)).masked(MASK.as_ptr().add(2 * SMALL_FRONT - $p))
                };
                for w in 0..W {
                    x[w] = x[w].minus_product(u, x[w].broadcast::<$p>());
                }
            }
        )*};
    }
    steps!(7 6 5 4 3 2 1);
    x
}

/// The factors of A^T from those of A; both where [`Shape`] says.
pub fn transpose_small(shape: Shape, values: &[f64], transposed: &mut [f64]) {
    let inverses = shape.inverses()..shape.lower();
    transposed[inverses.clone()].copy_from_slice(&values[inverses]);
    let (mut lower, mut beside) = (shape.lower(), 0);
    for pivot in 0..shape.pivots {
        // the row of U right of the pivot, and the column of L below it
        let mut upper = beside;
        for column in pivot + 1..shape.size() {
            transposed[lower] = values[upper];
            transposed[upper] = values[lower];
            lower += 1;
            upper += column.min(shape.pivots);
        }
        beside += pivot + 2;
    }
}
