//! Dense kernels of fronts: tiles of registers straight from the matrices while these are small, copied blocks where they are large.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::matrix_view::{MatrixView, MatrixViewMut};
use super::product::{Target, subtract_large_product};
use crate::linalg::simd::{Kernel, dispatch, multiply_add, prefetch};
use crate::linalg::vectors::sums_of_lanes;

/// Multiplications beyond which copies of the factors pay.
const SMALL_PRODUCT: usize = 1 << 17;
/// Columns of the result below which copies never pay: each entry of A is used too seldom.
const FEW_COLUMNS: usize = 12;

/// Who computes some columns of a result.
#[derive(Clone, Copy, Debug)]
pub struct ColumnThreads {
    /// Threads of this process.
    pub threads: usize,
    /// Columns that others compute: kernels, which round in different ways, are chosen by all.
    pub elsewhere: usize,
}

impl From<usize> for ColumnThreads {
    /// Threads that compute all columns.
    fn from(threads: usize) -> Self {
        ColumnThreads { threads, elsewhere: 0 }
    }
}

/// C <- C - A B or C <- -A B; the same bits with any number of threads, and whoever computes other columns.
pub fn subtract_product(
    c: MatrixViewMut<'_>,
    target: Target,
    a: MatrixView<'_>,
    b: MatrixView<'_>,
    workers: impl Into<ColumnThreads>,
) {
    let ColumnThreads { threads, elsewhere } = workers.into();
    let columns = c.columns() + elsewhere;
    if columns < FEW_COLUMNS || c.rows() * columns * a.columns() <= SMALL_PRODUCT {
        dispatch(Product { c, target, a, b });
    } else {
        subtract_large_product(c, target, a, b, threads);
    }
}

/// C <- C - A^T B.
pub fn subtract_transposed_product(c: MatrixViewMut<'_>, a: MatrixView<'_>, b: MatrixView<'_>) {
    dispatch(TransposedProduct { c, a, b });
}

struct Product<'j> {
    c: MatrixViewMut<'j>,
    target: Target,
    a: MatrixView<'j>,
    b: MatrixView<'j>,
}

impl Kernel for Product<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        let (rows, columns, depth) = (self.c.rows(), self.c.columns(), self.a.columns());
        let same = self.a.rows() == rows && self.b.columns() == columns && self.b.rows() == depth;
        assert!(same, "sizes of a product");
        let mut column = 0;
        // SAFETY: all tiles lie in the matrices, whose sizes were compared; C is ours alone.
        unsafe {
            while column + 6 <= columns {
                self.strip::<FUSED, 6>(column);
                column += 6;
            }
            while column + 2 <= columns {
                self.strip::<FUSED, 2>(column);
                column += 2;
            }
            if column < columns {
                self.strip::<FUSED, 1>(column);
            }
        }
    }
}

impl Product<'_> {
    /// # Safety
    /// `W` columns from `column` on are in the matrices.
    #[inline(always)]
    unsafe fn strip<const FUSED: bool, const W: usize>(&mut self, column: usize) {
        let (mut row, rows) = (0, self.c.rows());
        // SAFETY: promised by the caller for columns, checked here for rows.
        unsafe {
            while row + 24 <= rows {
                self.tile::<FUSED, 24, W>(row, column);
                row += 24;
            }
            while row + 8 <= rows {
                self.tile::<FUSED, 8, W>(row, column);
                row += 8;
            }
            if row + 4 <= rows {
                self.tile::<FUSED, 4, W>(row, column);
                row += 4;
            }
            if row + 2 <= rows {
                self.tile::<FUSED, 2, W>(row, column);
                row += 2;
            }
            if row < rows {
                self.tile::<FUSED, 1, W>(row, column);
            }
        }
    }

    /// # Safety
    /// The tile is in the matrices.
    #[inline(always)]
    unsafe fn tile<const FUSED: bool, const H: usize, const W: usize>(&mut self, row: usize, column: usize) {
        let mut sums = [[0.0; H]; W];
        for p in 0..self.a.columns() {
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
            let out = unsafe { &mut *self.c.at(row, column + w).cast::<[f64; H]>() };
            for h in 0..H {
                out[h] = if self.target == Target::Reduced { out[h] - sum[h] } else { -sum[h] };
            }
        }
    }
}

/// C <- C - A^T B.
struct TransposedProduct<'j> {
    c: MatrixViewMut<'j>,
    a: MatrixView<'j>,
    b: MatrixView<'j>,
}

impl Kernel for TransposedProduct<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let TransposedProduct { mut c, a, b } = self;
        let (rows, columns) = (c.rows(), c.columns());
        assert!(a.columns() == rows && b.columns() == columns && a.rows() == b.rows(), "sizes of a product");
        // rows outside: the columns of A are many and long, those of B are few
        let mut row = 0;
        while row + 3 <= rows {
            let left = [a.column(row), a.column(row + 1), a.column(row + 2)];
            let mut column = 0;
            while column + 2 <= columns {
                let sums = dots::<FUSED, false, 3, 2>(left, [b.column(column), b.column(column + 1)], 0);
                for w in 0..2 {
                    c.column_mut(column + w)[row..row + 3].iter_mut().zip(&sums[w]).for_each(|(c, sum)| *c -= sum);
                }
                column += 2;
            }
            if column < columns {
                let [sums] = dots::<FUSED, false, 3, 1>(left, [b.column(column)], 0);
                c.column_mut(column)[row..row + 3].iter_mut().zip(&sums).for_each(|(c, sum)| *c -= sum);
            }
            row += 3;
        }
        for row in row..rows {
            for column in 0..columns {
                let [[sum]] = dots::<FUSED, false, 1, 1>([a.column(row)], [b.column(column)], 0);
                c.column_mut(column)[row] -= sum;
            }
        }
    }
}

/// Numbers of a vector that are multiplied at a time.
const LANES: usize = 8;

/// Adds the products of `LANES` numbers of some vectors with those of another.
///
/// # Safety
/// Each has so many numbers from `first` on.
#[inline(always)]
unsafe fn add_products<const FUSED: bool, const H: usize>(
    sums: &mut [[f64; LANES]; H],
    a: &[&[f64]; H],
    b: &[f64],
    first: usize,
) {
    // SAFETY: promised by the caller.
    let right = unsafe { &*b.as_ptr().add(first).cast::<[f64; LANES]>() };
    for h in 0..H {
        // SAFETY: as above.
        let left = unsafe { &*a[h].as_ptr().add(first).cast::<[f64; LANES]>() };
        for lane in 0..LANES {
            sums[h][lane] = multiply_add::<FUSED>(left[lane], right[lane], sums[h][lane]);
        }
    }
}

/// Sums of products of each of some vectors with one or two others, all of one length, in lanes: each sum has the bits that it has alone. Of columns
/// of factors in memory, with `AHEAD`, asks for the numbers that stand `ahead` of those of `a`.
#[inline(always)]
pub fn dots<const FUSED: bool, const AHEAD: bool, const H: usize, const W: usize>(
    a: [&[f64]; H],
    b: [&[f64]; W],
    ahead: isize,
) -> [[f64; H]; W] {
    const { assert!(W == 1 || W == 2) };
    let length = b[0].len();
    // loops: a closure would not be compiled for wide vectors
    for a in &a {
        assert_eq!(a.len(), length, "lengths of vectors");
    }
    for b in &b {
        assert_eq!(b.len(), length, "lengths of vectors");
    }
    let mut totals = [[0.0; H]; W];
    let mut first = 0;
    if length >= LANES {
        let (mut of_first, mut of_last) = ([[0.0; LANES]; H], [[0.0; LANES]; H]);
        while first + LANES <= length {
            if AHEAD {
                for a in &a {
                    prefetch(a.as_ptr().wrapping_add(first).wrapping_offset(ahead));
                }
            }
            // SAFETY: so many numbers are left in each vector.
            unsafe {
                add_products::<FUSED, H>(&mut of_first, &a, b[0], first);
                if W > 1 {
                    add_products::<FUSED, H>(&mut of_last, &a, b[W - 1], first);
                }
            }
            first += LANES;
        }
        totals[0] = sums_of::<FUSED, H>(of_first);
        if W > 1 {
            totals[W - 1] = sums_of::<FUSED, H>(of_last);
        }
    }
    while first < length {
        for w in 0..W {
            for h in 0..H {
                // SAFETY: inside each vector.
                let (left, right) = unsafe { (*a[h].get_unchecked(first), *b[w].get_unchecked(first)) };
                totals[w][h] = multiply_add::<FUSED>(left, right, totals[w][h]);
            }
        }
        first += 1;
    }
    totals
}

/// The sum of the lanes of each vector.
#[inline(always)]
fn sums_of<const FUSED: bool, const H: usize>(lanes: [[f64; LANES]; H]) -> [f64; H] {
    // what is done with the lanes would make the compiler turn the loop before by 90 degrees, which takes a shuffle for each product
    let lanes = std::hint::black_box(lanes);
    if let Some(lanes) = lanes.first_chunk::<4>().filter(|_| H == 4) {
        // SAFETY: kernels are fused only where the processor has AVX2.
        let sums = unsafe { sums_of_lanes::<FUSED>(lanes) };
        return std::array::from_fn(|h| sums[h]);
    }
    let mut sums = [0.0; H];
    for h in 0..H {
        let [s0, s1, s2, s3, s4, s5, s6, s7] = lanes[h];
        sums[h] = ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));
    }
    sums
}

/// Unknowns of a triangular system that is solved in one go: a column of them fills a vector register.
const TRIANGLE: usize = 8;

/// B <- L^-1 B with a unit lower triangle; what stands above it is not read.
pub fn solve_unit_lower(l: MatrixView<'_>, b: MatrixViewMut<'_>, workers: impl Into<ColumnThreads>) {
    let (size, workers) = (l.rows(), workers.into());
    if size <= 1 {
        return;
    }
    if size <= TRIANGLE {
        dispatch(UnitLower { l, b });
        return;
    }
    let half = half_of(size);
    let (mut first, mut second) = b.split_rows(half);
    solve_unit_lower(l.block(0..half, 0..half), first.reborrow(), workers);
    subtract_product(second.reborrow(), Target::Reduced, l.block(half..size, 0..half), first.as_view(), workers);
    solve_unit_lower(l.block(half..size, half..size), second, workers);
}

/// B <- U^-1 B with an upper triangle; what stands below it is not read.
pub fn solve_upper(u: MatrixView<'_>, mut b: MatrixViewMut<'_>) {
    let size = u.rows();
    if size <= TRIANGLE {
        for column in 0..b.columns() {
            let x = b.column_mut(column);
            for p in (0..size).rev() {
                let known = x[p] / u.column(p)[p];
                x[p] = known;
                x[..p].iter_mut().zip(u.column(p)).for_each(|(x, u)| *x -= u * known);
            }
        }
        return;
    }
    let half = half_of(size);
    let (mut first, mut second) = b.split_rows(half);
    solve_upper(u.block(half..size, half..size), second.reborrow());
    subtract_product(first.reborrow(), Target::Reduced, u.block(0..half, half..size), second.as_view(), 1);
    solve_upper(u.block(0..half, 0..half), first);
}

/// B <- U^-T B with an upper triangle; what stands below it is not read.
pub fn solve_upper_transposed(u: MatrixView<'_>, mut b: MatrixViewMut<'_>) {
    let size = u.rows();
    if size <= TRIANGLE {
        for column in 0..b.columns() {
            let x = b.column_mut(column);
            for p in 0..size {
                let known: f64 = u.column(p)[..p].iter().zip(&x[..p]).map(|(u, x)| u * x).sum();
                x[p] = (x[p] - known) / u.column(p)[p];
            }
        }
        return;
    }
    let half = half_of(size);
    let (mut first, mut second) = b.split_rows(half);
    solve_upper_transposed(u.block(0..half, 0..half), first.reborrow());
    subtract_transposed_product(second.reborrow(), u.block(0..half, half..size), first.as_view());
    solve_upper_transposed(u.block(half..size, half..size), second);
}

/// B <- L^-T B with a unit lower triangle; what stands above it is not read.
pub fn solve_unit_lower_transposed(l: MatrixView<'_>, mut b: MatrixViewMut<'_>) {
    let size = l.rows();
    if size <= TRIANGLE {
        for column in 0..b.columns() {
            let x = b.column_mut(column);
            for p in (0..size).rev() {
                let known: f64 = l.column(p)[p + 1..].iter().zip(&x[p + 1..]).map(|(l, x)| l * x).sum();
                x[p] -= known;
            }
        }
        return;
    }
    let half = half_of(size);
    let (mut first, mut second) = b.split_rows(half);
    solve_unit_lower_transposed(l.block(half..size, half..size), second.reborrow());
    subtract_transposed_product(first.reborrow(), l.block(half..size, 0..half), second.as_view());
    solve_unit_lower_transposed(l.block(0..half, 0..half), first);
}

/// Where a triangle is divided.
fn half_of(size: usize) -> usize {
    (size / 2).next_multiple_of(TRIANGLE)
}

struct UnitLower<'j> {
    l: MatrixView<'j>,
    b: MatrixViewMut<'j>,
}

impl Kernel for UnitLower<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let UnitLower { l, mut b } = self;
        let (size, columns) = (l.rows(), b.columns());
        assert!(l.columns() == size && b.rows() == size && size <= TRIANGLE, "sizes of a triangular system");
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
                    6 => unit_lower::<FUSED, 4>(&negative, 6, &mut b, column),
                    8 => unit_lower::<FUSED, 4>(&negative, 8, &mut b, column),
                    _ => unit_lower::<FUSED, 4>(&negative, size, &mut b, column),
                }
                column += 4;
            }
            while column < columns {
                unit_lower::<FUSED, 1>(&negative, size, &mut b, column);
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
    b: &mut MatrixViewMut<'_>,
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
            unsafe { *b.at(row, column + w) = x[w][row] };
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

/// Largest absolute value, not counting what is not a number.
#[inline(always)]
pub fn largest(values: &[f64]) -> f64 {
    const LANES: usize = 8;
    const HALF: usize = LANES / 2;
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let length = values.len();
    if length < HALF {
        let mut most = 0.0;
        for value in values {
            most = larger(most, value.abs());
        }
        return most;
    }
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            lanes[lane] = larger(lanes[lane], chunk[lane].abs());
        }
    }
    let mut half = [0.0; HALF];
    for lane in 0..HALF {
        half[lane] = larger(lanes[lane], lanes[lane + HALF]);
    }
    // the last ones again with those before them
    let firsts = [rest.first_chunk::<HALF>(), values.last_chunk::<HALF>()];
    for part in firsts.into_iter().flatten() {
        for lane in 0..HALF {
            half[lane] = larger(half[lane], part[lane].abs());
        }
    }
    larger(larger(half[0], half[2]), larger(half[1], half[3]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solves with each triangle of a matrix, plain and transposed, and returns the largest entries of the residuals.
    fn residuals(size: usize, columns: usize) -> [f64; 4] {
        let number = |i: usize| (1.0 + i as f64 * 2.3).sin() / size as f64;
        let mut values: Vec<f64> = (0..size * size).map(number).collect();
        (0..size).for_each(|i| values[i * (size + 1)] = 2.0 + number(i));
        let rhs: Vec<f64> = (0..size * columns).map(|i| number(i + 5)).collect();
        let matrix = MatrixView::new(&values, size, size);
        let lower = |i: usize, j: usize| {
            if i == j {
                1.0
            } else if i > j {
                values[i + j * size]
            } else {
                0.0
            }
        };
        let upper = |i: usize, j: usize| if i <= j { values[i + j * size] } else { 0.0 };
        let residual = |entry: &dyn Fn(usize, usize) -> f64, solve: &dyn Fn(MatrixViewMut<'_>)| {
            let mut x = rhs.clone();
            solve(MatrixViewMut::new(&mut x, size, columns));
            let left = |place: usize| {
                let (row, column) = (place % size, place / size);
                rhs[place] - (0..size).map(|j| entry(row, j) * x[j + column * size]).sum::<f64>()
            };
            (0..rhs.len()).fold(0.0, |most: f64, place| most.max(left(place).abs()))
        };
        [
            residual(&lower, &|b| solve_unit_lower(matrix, b, 1)),
            residual(&upper, &|b| solve_upper(matrix, b)),
            residual(&|i, j| lower(j, i), &|b| solve_unit_lower_transposed(matrix, b)),
            residual(&|i, j| upper(j, i), &|b| solve_upper_transposed(matrix, b)),
        ]
    }

    #[test]
    fn columns_have_the_bits_that_they_have_beside_others() {
        let number = |i: usize| (1.0 + i as f64 * 2.3).sin();
        for (size, columns, rows) in [(5, 14, 3), (32, 40, 9), (40, 200, 70), (300, 90, 310)] {
            let scaled = |i: usize| number(i) / size as f64;
            let left: Vec<f64> = (0..(size + rows) * size).map(scaled).collect();
            let given: Vec<f64> = (0..(size + rows) * columns).map(|i| number(i + 5)).collect();
            let left = MatrixView::new(&left, size + rows, size);
            let change = |first: usize, end: usize| {
                let mut all = given[first * (size + rows)..end * (size + rows)].to_vec();
                let workers = ColumnThreads { threads: 1, elsewhere: columns - (end - first) };
                let (mut upper, lower) = MatrixViewMut::new(&mut all, size + rows, end - first).split_rows(size);
                solve_unit_lower(left.block(0..size, 0..size), upper.reborrow(), workers);
                subtract_product(lower, Target::Reduced, left.block(size..size + rows, 0..size), upper.as_view(), workers);
                all
            };
            let together = change(0, columns);
            for cut in [1, columns / 3, columns - 2] {
                assert!([change(0, cut), change(cut, columns)].concat() == together, "{size}, {cut} of {columns}");
            }
        }
    }

    #[test]
    fn triangles_are_solved_plain_and_transposed() {
        for (size, columns) in [(1, 1), (3, 2), (8, 5), (9, 1), (17, 4), (70, 13), (200, 32)] {
            let residuals = residuals(size, columns);
            assert!(residuals.iter().all(|&residual| residual < 1e-15), "{size} x {columns}: {residuals:?}");
        }
    }
}
