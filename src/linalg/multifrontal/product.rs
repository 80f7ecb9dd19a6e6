//! Large products of dense matrices: blocks of both factors are copied in the order in which a small tile of the result takes them.
//!
//! Source: Goto & van de Geijn (2008), Anatomy of high-performance matrix multiplication.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::matrix_view::{MatrixView, MatrixViewMut};
use crate::linalg::simd::{Kernel, dispatch, has_avx512, multiply_add};
use std::cell::Cell;
use std::ops::Range;

/// What a product does with the values that were there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// C <- C - A B.
    Reduced,
    /// C <- -A B.
    Replaced,
}

/// Terms of the sums in a block. An entry of C takes them one after the other, however the matrices are divided.
const DEPTH: usize = 256;
/// Entries of A that are copied at once, which a cache of the second level holds; a number of rows of them is a multiple of tiles.
const BLOCK_OF_A: usize = 192 * DEPTH;
/// Entries of B that are copied at once.
const BLOCK_OF_B: usize = 1024 * DEPTH;
/// Columns of a tile.
const WIDTH: usize = 6;
/// Rows of a tile with 32 registers of eight numbers.
const TALL: usize = 24;
/// Rows of a tile with 16 registers of four numbers.
const LOW: usize = 8;
/// Rows or columns below which a matrix is not divided among threads.
const DIVISIBLE: usize = 96;

/// C <- C - A B or C <- -A B.
pub fn subtract_large_product(c: MatrixViewMut<'_>, target: Target, a: MatrixView<'_>, b: MatrixView<'_>, threads: usize) {
    // more parts than threads, so that none waits long for a slower one
    divide(c, target, a, b, if threads > 1 { 2 * threads } else { 1 });
}

/// Halves the longer side of C as long as there are parts to do.
fn divide(c: MatrixViewMut<'_>, target: Target, a: MatrixView<'_>, b: MatrixView<'_>, parts: usize) {
    let (rows, columns) = (c.rows(), c.columns());
    if parts <= 1 || rows.max(columns) < 2 * DIVISIBLE {
        if has_avx512() {
            dispatch(Packed::<TALL> { c, target, a, b });
        } else {
            dispatch(Packed::<LOW> { c, target, a, b });
        }
        return;
    }
    let (fewer, depth) = (parts / 2, a.columns());
    let share = |length: usize, tile: usize| (length * fewer / parts).next_multiple_of(tile);
    if columns >= rows {
        let half = share(columns, WIDTH);
        let (left, right) = c.split_columns(half);
        rayon::join(
            || divide(left, target, a, b.block(0..depth, 0..half), fewer),
            || divide(right, target, a, b.block(0..depth, half..columns), parts - fewer),
        );
    } else {
        let half = share(rows, TALL);
        let (top, bottom) = c.split_rows(half);
        rayon::join(
            || divide(top, target, a.block(0..half, 0..depth), b, fewer),
            || divide(bottom, target, a.block(half..rows, 0..depth), b, parts - fewer),
        );
    }
}

thread_local! {
    /// Room for the copies.
    static COPIES: Cell<[Vec<f64>; 2]> = const { Cell::new([Vec::new(), Vec::new()]) };
}

/// The product in tiles of `H` rows.
struct Packed<'j, const H: usize> {
    c: MatrixViewMut<'j>,
    target: Target,
    a: MatrixView<'j>,
    b: MatrixView<'j>,
}

impl<const H: usize> Kernel for Packed<'_, H> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Packed { mut c, target, a, b } = self;
        let (rows, columns, depth) = (c.rows(), c.columns(), a.columns());
        assert!(a.rows() == rows && b.columns() == columns && b.rows() == depth, "sizes of a product");
        let [mut copy_of_a, mut copy_of_b] = COPIES.take();
        for terms in blocks(depth, DEPTH) {
            let target = if terms.start == 0 { target } else { Target::Reduced };
            let columns_at_once = BLOCK_OF_B / terms.len() / WIDTH * WIDTH;
            let rows_at_once = BLOCK_OF_A / terms.len() / TALL * TALL;
            for columns in blocks(columns, columns_at_once) {
                let right = pack_right(b.block(terms.clone(), columns.clone()), &mut copy_of_b);
                for rows in blocks(rows, rows_at_once) {
                    let left = pack_left::<H>(a.block(rows.clone(), terms.clone()), &mut copy_of_a);
                    let c = c.reborrow().block(rows, columns.clone());
                    add_packed::<FUSED, H>(c, target, left, right, terms.len());
                }
            }
        }
        COPIES.set([copy_of_a, copy_of_b]);
    }
}

/// Ranges of equal length; the last one may be shorter.
fn blocks(length: usize, step: usize) -> impl Iterator<Item = Range<usize>> {
    (0..length).step_by(step).map(move |first| first..(first + step).min(length))
}

/// C <- C - A B or C <- -A B with the copies of A and -B.
#[inline(always)]
fn add_packed<const FUSED: bool, const H: usize>(
    mut c: MatrixViewMut<'_>,
    target: Target,
    left: &[[f64; H]],
    right: &[[f64; WIDTH]],
    depth: usize,
) {
    for (strip, right) in right.chunks_exact(depth).enumerate() {
        let columns = strip * WIDTH..c.columns();
        for (panel, left) in left.chunks_exact(depth).enumerate() {
            let rows = panel * H..c.rows();
            if let Some(out) = c.tile_mut::<H, WIDTH>(rows.clone(), columns.clone()) {
                let mut sums = [[0.0; H]; WIDTH];
                if target == Target::Reduced {
                    for w in 0..WIDTH {
                        sums[w] = *out[w];
                    }
                }
                let sums = add_products::<FUSED, H>(sums, left.iter(), right);
                out.into_iter().zip(sums).for_each(|(out, sums)| *out = sums);
                continue;
            }
            // at the edge, in tiles that leave less unused
            let (parts, _) = left.as_flattened().as_chunks::<LOW>();
            for part in 0..rows.len().min(H).div_ceil(LOW) {
                let rows = rows.start + part * LOW..rows.end.min(rows.start + (part + 1) * LOW);
                let mut sums = [[0.0; LOW]; WIDTH];
                if target == Target::Reduced {
                    for (sums, column) in sums.iter_mut().zip(columns.clone()) {
                        sums[..rows.len()].copy_from_slice(&c.column_mut(column)[rows.clone()]);
                    }
                }
                let left = parts[part..].iter().step_by(H / LOW);
                let sums = add_products::<FUSED, LOW>(sums, left, right);
                for (sums, column) in sums.iter().zip(columns.clone()) {
                    c.column_mut(column)[rows.clone()].copy_from_slice(&sums[..rows.len()]);
                }
            }
        }
    }
}

/// S + A B for a tile S.
#[inline(always)]
fn add_products<'p, const FUSED: bool, const H: usize>(
    mut sums: [[f64; H]; WIDTH],
    left: impl Iterator<Item = &'p [f64; H]>,
    right: &[[f64; WIDTH]],
) -> [[f64; H]; WIDTH] {
    for (left, right) in left.zip(right) {
        for w in 0..WIDTH {
            for h in 0..H {
                sums[w][h] = multiply_add::<FUSED>(left[h], right[w], sums[w][h]);
            }
        }
    }
    sums
}

/// Room for some numbers from a boundary of the cache's lines on.
#[inline(always)]
fn aligned(copy: &mut Vec<f64>, length: usize) -> &mut [f64] {
    const LINE: usize = 64;
    if copy.len() < length + LINE / size_of::<f64>() {
        copy.resize(length + LINE / size_of::<f64>(), 0.0);
    }
    let offset = copy.as_ptr().align_offset(LINE).min(LINE / size_of::<f64>());
    &mut copy[offset..][..length]
}

/// Copies `H` rows after the other, each of their columns contiguous; rows that are missing at the end are zero.
#[inline(always)]
fn pack_left<'c, const H: usize>(a: MatrixView<'_>, copy: &'c mut Vec<f64>) -> &'c [[f64; H]] {
    let depth = a.columns();
    let (packed, _) = aligned(copy, a.rows().next_multiple_of(H) * depth).as_chunks_mut::<H>();
    for p in 0..depth {
        let (full, rest) = a.column(p).as_chunks::<H>();
        let mut places = packed[p..].iter_mut().step_by(depth);
        for (source, place) in full.iter().zip(&mut places) {
            *place = *source;
        }
        if let (false, Some(place)) = (rest.is_empty(), places.next()) {
            *place = [0.0; H];
            place[..rest.len()].copy_from_slice(rest);
        }
    }
    packed
}

/// Copies -B, a few columns after the other, each of their rows contiguous; columns that are missing at the end are zero.
#[inline(always)]
fn pack_right<'c>(b: MatrixView<'_>, copy: &'c mut Vec<f64>) -> &'c [[f64; WIDTH]] {
    let depth = b.rows();
    let (packed, _) = aligned(copy, b.columns().next_multiple_of(WIDTH) * depth).as_chunks_mut::<WIDTH>();
    for (strip, places) in packed.chunks_exact_mut(depth).enumerate() {
        let first = strip * WIDTH;
        if first + WIDTH <= b.columns() {
            let sources: [&[f64]; WIDTH] = std::array::from_fn(|w| &b.column(first + w)[..depth]);
            for (p, place) in places.iter_mut().enumerate() {
                for w in 0..WIDTH {
                    place[w] = -sources[w][p];
                }
            }
        } else {
            places.fill([0.0; WIDTH]);
            for column in first..b.columns() {
                let source = b.column(column);
                places.iter_mut().zip(source).for_each(|(place, value)| place[column - first] = -value);
            }
        }
    }
    packed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_size_gives_the_product_and_tiles_and_threads_do_not_change_its_bits() {
        let number = |i: usize| (1.0 + i as f64 * 1.7).sin();
        for (rows, columns, depth) in
            [(1, 12, 3), (24, 6, 8), (25, 13, 300), (47, 31, 257), (200, 193, 40), (500, 1, 9), (193, 401, 600)]
        {
            let a: Vec<f64> = (0..rows * depth).map(number).collect();
            let b: Vec<f64> = (0..depth * columns).map(|i| number(i + 7)).collect();
            let before: Vec<f64> = (0..rows * columns).map(|i| number(i + 3)).collect();
            for target in [Target::Reduced, Target::Replaced] {
                let product = |threads: usize| {
                    let mut c = before.clone();
                    let (a, b) = (MatrixView::new(&a, rows, depth), MatrixView::new(&b, depth, columns));
                    subtract_large_product(MatrixViewMut::new(&mut c, rows, columns), target, a, b, threads);
                    c
                };
                let alone = product(1);
                for (place, value) in alone.iter().enumerate() {
                    let (row, column) = (place % rows, place / rows);
                    let sum: f64 = (0..depth).map(|p| a[row + p * rows] * b[p + column * depth]).sum();
                    let exact = if target == Target::Reduced { before[place] - sum } else { -sum };
                    assert!((value - exact).abs() < 1e-14 * depth as f64, "{rows} x {columns} x {depth}: {value} {exact}");
                }
                let mut c = before.clone();
                let (left, right) = (MatrixView::new(&a, rows, depth), MatrixView::new(&b, depth, columns));
                dispatch(Packed::<LOW> { c: MatrixViewMut::new(&mut c, rows, columns), target, a: left, b: right });
                assert!(c == alone, "{rows} x {columns} x {depth} in low tiles");
                assert!([2, 3, 5].iter().all(|&threads| product(threads) == alone), "{rows} x {columns} x {depth}");
            }
        }
    }
}
