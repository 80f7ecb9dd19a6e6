//! Dense kernels of fronts: own loops while the matrices are small, faer's where they are large.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use crate::linalg::simd::{Kernel, dispatch, multiply_add};
use faer::linalg::matmul::matmul;
use faer::prelude::ReborrowMut;
use faer::{Accum, MatMut, MatRef, Par};

/// Operations beyond which faer's product is faster than the own one.
const OWN_PRODUCT: usize = 1 << 17;

/// What a product does with the values that were there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// C <- C - A B.
    Reduced,
    /// C <- -A B.
    Replaced,
}

/// C <- C - A B or C <- -A B; all columns contiguous.
pub fn subtract_product(c: MatMut<'_, f64>, target: Target, a: MatRef<'_, f64>, b: MatRef<'_, f64>, par: Par) {
    if c.nrows() * c.ncols() * a.ncols() <= OWN_PRODUCT {
        dispatch(Product { c, target, a, b });
    } else {
        let accum = if target == Target::Reduced { Accum::Add } else { Accum::Replace };
        matmul(c, accum, a, b, -1.0, par);
    }
}

/// Where a block of columns stands in memory.
#[derive(Clone, Copy)]
struct Columns {
    first: *const f64,
    stride: usize,
}

impl Columns {
    fn of(matrix: MatRef<'_, f64>) -> Self {
        assert!(matrix.nrows() <= 1 || matrix.row_stride() == 1, "columns must be contiguous");
        Columns { first: matrix.as_ptr(), stride: matrix.col_stride() as usize }
    }
    /// # Safety
    /// The entry is one of the matrix.
    #[inline(always)]
    unsafe fn at(self, row: usize, column: usize) -> *const f64 {
        // SAFETY: promised by the caller.
        unsafe { self.first.add(row + column * self.stride) }
    }
}

struct Product<'j> {
    c: MatMut<'j, f64>,
    target: Target,
    a: MatRef<'j, f64>,
    b: MatRef<'j, f64>,
}

impl Kernel for Product<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Product { c, target, a, b } = self;
        let (rows, columns, depth) = (c.nrows(), c.ncols(), a.ncols());
        assert!(a.nrows() == rows && b.ncols() == columns && b.nrows() == depth, "sizes of a product");
        let tiles = Tiles { c: Columns::of(c.as_ref()), a: Columns::of(a), b: Columns::of(b), depth, rows, target };
        let mut column = 0;
        // SAFETY: all tiles lie in the matrices, whose sizes were compared; C is ours alone.
        unsafe {
            while column + 6 <= columns {
                tiles.strip::<FUSED, 6>(column);
                column += 6;
            }
            while column + 2 <= columns {
                tiles.strip::<FUSED, 2>(column);
                column += 2;
            }
            if column < columns {
                tiles.strip::<FUSED, 1>(column);
            }
        }
    }
}

struct Tiles {
    c: Columns,
    a: Columns,
    b: Columns,
    depth: usize,
    rows: usize,
    target: Target,
}

impl Tiles {
    /// # Safety
    /// `W` columns from `column` on are in the matrices.
    #[inline(always)]
    unsafe fn strip<const FUSED: bool, const W: usize>(&self, column: usize) {
        let mut row = 0;
        // SAFETY: promised by the caller for columns, checked here for rows.
        unsafe {
            while row + 24 <= self.rows {
                self.tile::<FUSED, 24, W>(row, column);
                row += 24;
            }
            while row + 8 <= self.rows {
                self.tile::<FUSED, 8, W>(row, column);
                row += 8;
            }
            if row + 4 <= self.rows {
                self.tile::<FUSED, 4, W>(row, column);
                row += 4;
            }
            if row + 2 <= self.rows {
                self.tile::<FUSED, 2, W>(row, column);
                row += 2;
            }
            if row < self.rows {
                self.tile::<FUSED, 1, W>(row, column);
            }
        }
    }

    /// # Safety
    /// The tile is in the matrices.
    #[inline(always)]
    unsafe fn tile<const FUSED: bool, const H: usize, const W: usize>(&self, row: usize, column: usize) {
        let mut sums = [[0.0; H]; W];
        for p in 0..self.depth {
            // SAFETY: promised by the caller.
            let left = unsafe { &*self.a.at(row, p).cast::<[f64; H]>() };
            for (w, sum) in sums.iter_mut().enumerate() {
                // SAFETY: as above.
                let right = unsafe { *self.b.at(p, column + w) };
                for h in 0..H {
                    sum[h] = multiply_add::<FUSED>(left[h], right, sum[h]);
                }
            }
        }
        for (w, sum) in sums.iter().enumerate() {
            // SAFETY: as above, and no other reference to C is alive.
            let out = unsafe { &mut *self.c.at(row, column + w).cast_mut().cast::<[f64; H]>() };
            for h in 0..H {
                out[h] = if self.target == Target::Reduced { out[h] - sum[h] } else { -sum[h] };
            }
        }
    }
}

/// Unknowns of a triangular system that is solved in one go: a column of them fills a vector register.
const TRIANGLE: usize = 8;

/// B <- L^-1 B with a unit lower triangle.
pub fn solve_unit_lower(l: MatRef<'_, f64>, b: MatMut<'_, f64>, par: Par) {
    let size = l.nrows();
    if size <= 1 {
        return;
    }
    if size <= TRIANGLE {
        dispatch(UnitLower { l, b });
        return;
    }
    let half = (size / 2).next_multiple_of(TRIANGLE);
    let (top, _, left, bottom) = l.split_at(half, half);
    let (mut first, mut second) = b.split_at_row_mut(half);
    solve_unit_lower(top, first.rb_mut(), par);
    subtract_product(second.rb_mut(), Target::Reduced, left, first.as_ref(), par);
    solve_unit_lower(bottom, second, par);
}

struct UnitLower<'j> {
    l: MatRef<'j, f64>,
    b: MatMut<'j, f64>,
}

impl Kernel for UnitLower<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let UnitLower { l, b } = self;
        let (size, columns) = (l.nrows(), b.ncols());
        assert!(l.ncols() == size && b.nrows() == size && size <= TRIANGLE, "sizes of a triangular system");
        let (l, b) = (Columns::of(l), Columns::of(b.as_ref()));
        let mut negative = [[0.0; TRIANGLE]; TRIANGLE];
        for p in 0..size {
            for row in p + 1..size {
                // SAFETY: inside L.
                negative[p][row] = -unsafe { *l.at(row, p) };
            }
        }
        let mut column = 0;
        // SAFETY: `size` rows of the columns of B, which is ours alone.
        unsafe {
            while column + 4 <= columns {
                match size {
                    6 => unit_lower::<FUSED, 4>(&negative, 6, b, column),
                    8 => unit_lower::<FUSED, 4>(&negative, 8, b, column),
                    _ => unit_lower::<FUSED, 4>(&negative, size, b, column),
                }
                column += 4;
            }
            while column < columns {
                unit_lower::<FUSED, 1>(&negative, size, b, column);
                column += 1;
            }
        }
    }
}

/// B <- L^-1 B for some columns, given -L below the diagonal by columns.
///
/// # Safety
/// `size` rows and `W` columns from `column` on are in the matrix.
#[inline(always)]
unsafe fn unit_lower<const FUSED: bool, const W: usize>(
    negative: &[[f64; TRIANGLE]; TRIANGLE],
    size: usize,
    b: Columns,
    column: usize,
) {
    let mut x = [[0.0; TRIANGLE]; W];
    for w in 0..W {
        for row in 0..size {
            // SAFETY: promised by the caller.
            x[w][row] = unsafe { *b.at(row, column + w) };
        }
    }
    for p in 0..size - 1 {
        for w in 0..W {
            let known = x[w][p];
            for row in 0..TRIANGLE {
                x[w][row] = multiply_add::<FUSED>(negative[p][row], known, x[w][row]);
            }
        }
    }
    for w in 0..W {
        for row in 0..size {
            // SAFETY: promised by the caller.
            unsafe { *b.at(row, column + w).cast_mut() = x[w][row] };
        }
    }
}

/// y <- y - x f.
#[inline(always)]
pub fn subtract_multiple<const FUSED: bool>(x: &[f64], factor: f64, y: &mut [f64]) {
    let rows = x.len().min(y.len());
    let mut row = 0;
    while row + 8 <= rows {
        subtract_rows::<FUSED, 8>(x, factor, y, row);
        row += 8;
    }
    if row + 4 <= rows {
        subtract_rows::<FUSED, 4>(x, factor, y, row);
        row += 4;
    }
    if row + 2 <= rows {
        subtract_rows::<FUSED, 2>(x, factor, y, row);
        row += 2;
    }
    if row < rows {
        subtract_rows::<FUSED, 1>(x, factor, y, row);
    }
}

/// The same for `H` rows from `row` on.
#[inline(always)]
fn subtract_rows<const FUSED: bool, const H: usize>(x: &[f64], factor: f64, y: &mut [f64], row: usize) {
    if let (Some(x), Some(y)) = (x[row..].first_chunk::<H>(), y[row..].first_chunk_mut::<H>()) {
        for h in 0..H {
            y[h] = multiply_add::<FUSED>(x[h], -factor, y[h]);
        }
    }
}

/// y <- y - A x.
#[inline(always)]
pub fn subtract_columns<const FUSED: bool>(a: &[f64], stride: usize, x: &[f64], y: &mut [f64]) {
    let rows = y.len();
    let mut column = 0;
    while column + 4 <= x.len() {
        let part = |p: usize| &a[(column + p) * stride..][..rows];
        let (a0, a1, a2, a3) = (part(0), part(1), part(2), part(3));
        let (x0, x1, x2, x3) = (-x[column], -x[column + 1], -x[column + 2], -x[column + 3]);
        for i in 0..rows {
            let first = multiply_add::<FUSED>(a0[i], x0, y[i]);
            let second = multiply_add::<FUSED>(a1[i], x1, first);
            let third = multiply_add::<FUSED>(a2[i], x2, second);
            y[i] = multiply_add::<FUSED>(a3[i], x3, third);
        }
        column += 4;
    }
    for (p, &x) in x.iter().enumerate().skip(column) {
        for (y, a) in y.iter_mut().zip(&a[p * stride..][..rows]) {
            *y = multiply_add::<FUSED>(*a, -x, *y);
        }
    }
}

/// Sum of products, in lanes.
#[inline(always)]
pub fn dot<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a_lanes, b_lanes) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let mut rest = 0.0;
    for (a, b) in a_lanes.remainder().iter().zip(b_lanes.remainder()) {
        rest = multiply_add::<FUSED>(*a, *b, rest);
    }
    for (a, b) in a_lanes.zip(b_lanes) {
        for lane in 0..LANES {
            sums[lane] = multiply_add::<FUSED>(a[lane], b[lane], sums[lane]);
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Largest absolute value, not counting what is not a number.
#[inline(always)]
pub fn largest(values: &[f64]) -> f64 {
    const LANES: usize = 8;
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let mut lanes = [0.0; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest = chunks.remainder().iter().fold(0.0, |most, value| larger(most, value.abs()));
    for chunk in chunks {
        for lane in 0..LANES {
            lanes[lane] = larger(lanes[lane], chunk[lane].abs());
        }
    }
    for width in [4, 2, 1] {
        for lane in 0..width {
            lanes[lane] = larger(lanes[lane], lanes[lane + width]);
        }
    }
    larger(rest, lanes[0])
}
