//! Solutions with the factors of small fronts.
//!
//! A^T = (L D U)^T is of the same form with U^T for L and L^T for U, in rows where A has columns: with factors that are
//! transposed once, both systems are solved by the same columns of vector registers.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::small_front::{LANES, SMALL_FRONT, Shape, SmallPlan};
use crate::linalg::vectors::{Instructions, Vector};
use std::mem::MaybeUninit;

/// A small front with its factors, those of A or of A^T.
#[derive(Clone, Copy)]
pub struct SmallFactors<'f> {
    plan: SmallPlan,
    /// L as [`Shape`] says; D^-1 and U follow, and `LANES` numbers or more without a meaning.
    lower: *const f64,
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
        debug_assert!(
            values.len() >= line + Shape { pivots: plan.pivots as usize, others }.storage() + LANES,
            "factors of a small front"
        );
        // SAFETY: a plan lies inside the lists that it was made for, whose lengths its analysis tells.
        unsafe {
            SmallFactors { plan: *plan, lower: values.as_ptr().add(line), others: rows.get_unchecked(first..first + others) }
        }
    }

    /// Place of the first pivot.
    #[inline(always)]
    pub fn first(&self) -> usize {
        self.plan.first as usize
    }

    /// Where U begins.
    #[inline(always)]
    fn upper(&self) -> *const f64 {
        self.lower.wrapping_add(self.plan.pivots as usize * self.plan.lower_stride as usize)
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
        let SmallFactors { plan, lower, .. } = *self;
        let (first, pivots, stride) = (self.first(), plan.pivots as usize, plan.lower_stride as usize);
        let mut row = 0;
        // SAFETY: columns of the factors; what is read or written behind the last row has no meaning and is written
        // later or not at all.
        unsafe {
            let (mut given, mut known) = (residual, solution);
            for w in 0..W {
                (given[w], known[w]) = (residual[w].add(first), solution[w].add(first));
            }
            while row < pivots {
                let sums = products::<I::Eight, W>(lower.add(row), stride, row, known);
                let triangle = lower.add(row * stride + row);
                if W == 1 {
                    // numbers one by one: each waits for one product, and none for other fronts' vectors
                    let mut lanes = [0.0; LANES];
                    sums[0].store(lanes.as_mut_ptr());
                    unit_lower_numbers::<I>(given[0].add(row), &lanes, triangle, stride, pivots - row, known[0].add(row));
                } else {
                    let mut x = sums;
                    for w in 0..W {
                        x[w] = I::Eight::load(given[w].add(row)).plus(sums[w]);
                    }
                    x = unit_lower::<I, W>(x, triangle, stride, pivots - row);
                    for w in 0..W {
                        x[w].store(known[w].add(row));
                    }
                }
                row += LANES;
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
        let SmallFactors { plan, lower, others } = *self;
        let (first, pivots, stride) = (self.first(), plan.pivots as usize, plan.lower_stride as usize);
        // SAFETY: as for the rows of the pivots.
        unsafe {
            let mut known = solution;
            for w in 0..W {
                known[w] = solution[w].add(first);
            }
            let mut other = 0;
            while other < others.len() {
                let sums = products::<I::Eight, W>(lower.add(pivots + other), stride, pivots, known);
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
            let mut end = plan.upper_stride as usize;
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
        let (pivots, height, upper) = (self.plan.pivots as usize, self.plan.upper_stride as usize, self.upper());
        // SAFETY: columns of the factors, which are zero behind the last pivot, and their inverse pivots, which are 1
        // there.
        unsafe {
            let mut x = [V::splat(0.0); W];
            for w in 0..W {
                x[w] = V::load(solution[w].add(row)).times(V::load(upper.add(row)));
            }
            let mut column = upper.add(pivots * height + row);
            for other in 0..self.others.len() {
                let u = V::load(column);
                for w in 0..W {
                    x[w] = x[w].minus_product(u, V::splat(others[w][other].assume_init()));
                }
                column = column.add(height);
            }
            for k in row + V::LANES..pivots {
                let u = V::load(upper.add(k * height + row));
                for w in 0..W {
                    x[w] = x[w].minus_product(u, V::splat(*solution[w].add(k)));
                }
            }
            let triangle = upper.add(row * height + row);
            if W == 1 {
                let mut lanes = [0.0; LANES];
                x[0].store(lanes.as_mut_ptr());
                unit_upper_numbers::<I>(&lanes, triangle, height, V::LANES.min(pivots - row), solution[0].add(row));
            } else {
                x = unit_upper::<V, W>(x, triangle, height, pivots - row);
                for w in 0..W {
                    x[w].store(solution[w].add(row));
                }
            }
        }
    }
}

/// -L y for some rows of `count` columns, `stride` numbers apart.
///
/// # Safety
/// There are so many columns, and as many numbers in each vector.
#[inline(always)]
unsafe fn products<V: Vector, const W: usize>(
    mut column: *const f64,
    stride: usize,
    count: usize,
    known: [*mut f64; W],
) -> [V; W] {
    let mut sums = [V::splat(0.0); W];
    let mut k = 0;
    // SAFETY: promised by the caller.
    unsafe {
        while k + 2 <= count {
            let (l, next) = (V::load(column), V::load(column.add(stride)));
            for w in 0..W {
                sums[w] = sums[w].minus_product(l, V::splat(*known[w].add(k)));
                sums[w] = sums[w].minus_product(next, V::splat(*known[w].add(k + 1)));
            }
            column = column.add(2 * stride);
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
    column: *const f64,
    stride: usize,
    count: usize,
    solved: *mut f64,
) {
    let mut x = [0.0; LANES];
    macro_rules! rows {
        ($($row:literal: $($p:literal)*;)*) => {$(
            if $row >= count {
                return;
            }
            // SAFETY: promised by the caller.
            unsafe {
                x[$row] = *b.add($row) + s[$row];
                $(x[$row] = I::minus_product(x[$row], *column.add($p * stride + $row), x[$p]);)*
                *solved.add($row) = x[$row];
            }
        )*};
    }
    rows!(0: ; 1: 0; 2: 0 1; 3: 0 1 2; 4: 0 1 2 3; 5: 0 1 2 3 4; 6: 0 1 2 3 4 5; 7: 0 1 2 3 4 5 6;);
}

/// U^-1 x with a unit upper triangle of `count` columns.
///
/// # Safety
/// There are so many columns and numbers.
#[inline(always)]
unsafe fn unit_upper_numbers<I: Instructions>(
    lanes: &[f64; LANES],
    column: *const f64,
    stride: usize,
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
                            x[$row] = I::minus_product(x[$row], *column.add($p * stride + $row), x[$p]);
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
    column: *const f64,
    stride: usize,
    count: usize,
) -> [I::Eight; W] {
    macro_rules! steps {
        ($($p:literal)*) => {$(
            if $p + 1 >= count {
                return x;
            }
            // SAFETY: promised by the caller.
            let l = unsafe { I::Eight::load(column.add($p * stride)) };
            for w in 0..W {
                x[w] = x[w].minus_product(l, x[w].broadcast::<$p>());
            }
        )*};
    }
    steps!(0 1 2 3 4 5 6);
    x
}

/// U^-1 x with a unit upper triangle of `count` columns, of which as many as lanes are used.
///
/// # Safety
/// There are so many columns.
#[inline(always)]
unsafe fn unit_upper<V: Vector, const W: usize>(mut x: [V; W], column: *const f64, stride: usize, count: usize) -> [V; W] {
    macro_rules! steps {
        ($($p:literal)*) => {$(
            if $p < V::LANES && $p < count {
                // SAFETY: promised by the caller.
                let u = unsafe { V::load(column.add($p * stride)) };
                for w in 0..W {
                    x[w] = x[w].minus_product(u, x[w].broadcast::<$p>());
                }
            }
        )*};
    }
    steps!(7 6 5 4 3 2 1);
    x
}

/// The factors of A^T from those of A; both as [`Shape`] says, and all zero before the first time where zeros belong.
#[inline(always)]
pub fn transpose_small<I: Instructions>(shape: Shape, values: &[f64], transposed: &mut [f64]) {
    let (stride, height, size, pivots) = (shape.lower_stride(), shape.upper_stride(), shape.size(), shape.pivots);
    assert!(values.len() >= shape.storage() && transposed.len() >= shape.storage(), "factors of a small front");
    // SAFETY: sizes of both triangles; strides are whole tiles.
    unsafe {
        let (lower, upper) = (values.as_ptr(), values.as_ptr().add(shape.upper()));
        let (lower_transposed, upper_transposed) = (transposed.as_mut_ptr(), transposed.as_mut_ptr().add(shape.upper()));
        for column in (0..pivots).step_by(SIDE) {
            for row in (column..size).step_by(SIDE) {
                // L below its diagonal, and U right of it
                let l = tile::<I>(lower.add(column * stride + row), stride, pivots - column);
                store_tile::<I>(l, upper_transposed.add(row * height + column), height, size - row);
                let u = tile::<I>(upper.add(row * height + column), height, size - row);
                store_tile::<I>(u, lower_transposed.add(column * stride + row), stride, pivots - column);
            }
        }
        // in the place of the first column of U: the inverse pivots, which have no place in L
        upper_transposed.copy_from_nonoverlapping(upper, height);
        for column in 0..pivots {
            *lower_transposed.add(column * stride) = 0.0;
        }
    }
}

/// Rows and columns of a tile.
const SIDE: usize = 4;

/// Some rows of `count` columns `stride` apart, transposed; columns that are missing are zero.
///
/// # Safety
/// There are so many columns.
#[inline(always)]
unsafe fn tile<I: Instructions>(from: *const f64, stride: usize, count: usize) -> [I::Four; SIDE] {
    let mut columns = [I::Four::splat(0.0); SIDE];
    for column in 0..SIDE {
        if column < count {
            // SAFETY: promised by the caller.
            columns[column] = unsafe { I::Four::load(from.add(column * stride)) };
        }
    }
    I::transpose(columns)
}

/// Writes the first `count` columns of a tile.
///
/// # Safety
/// There are so many columns.
#[inline(always)]
unsafe fn store_tile<I: Instructions>(tile: [I::Four; SIDE], to: *mut f64, stride: usize, count: usize) {
    for column in 0..SIDE {
        if column < count {
            // SAFETY: promised by the caller.
            unsafe { tile[column].store(to.add(column * stride)) };
        }
    }
}
