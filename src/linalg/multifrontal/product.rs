//! Large products of dense matrices: blocks of both factors are copied in the order in which a small tile of the result takes them.
//!
//! Source: Goto & van de Geijn (2008), Anatomy of high-performance matrix multiplication.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::kernels::Target;
use super::matrix_view::{MatrixView, MatrixViewMut};
use crate::linalg::simd::{Kernel, dispatch, has_avx512, multiply_add};
use std::cell::Cell;
use std::ops::Range;

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
                    for (strip, right) in right.chunks_exact(terms.len()).enumerate() {
                        let first = columns.start + strip * WIDTH;
                        for (panel, left) in left.chunks_exact(terms.len()).enumerate() {
                            let row = rows.start + panel * H;
                            if let Some(out) = c.tile_mut::<H, WIDTH>(row..rows.end, first..columns.end) {
                                let mut sums = [[0.0; H]; WIDTH];
                                if target == Target::Reduced {
                                    for w in 0..WIDTH {
                                        sums[w] = *out[w];
                                    }
                                }
                                let sums = add_products::<FUSED, H>(sums, left, right);
                                out.into_iter().zip(sums).for_each(|(out, sums)| *out = sums);
                            } else {
                                let rows = row..rows.end.min(row + H);
                                let mut sums = [[0.0; H]; WIDTH];
                                if target == Target::Reduced {
                                    for (sums, column) in sums.iter_mut().zip(first..columns.end) {
                                        sums[..rows.len()].copy_from_slice(&c.column_mut(column)[rows.clone()]);
                                    }
                                }
                                sums = add_products::<FUSED, H>(sums, left, right);
                                for (sums, column) in sums.iter().zip(first..columns.end) {
                                    c.column_mut(column)[rows.clone()].copy_from_slice(&sums[..rows.len()]);
                                }
                            }
                        }
                    }
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

/// S + A B for a tile S.
#[inline(always)]
fn add_products<const FUSED: bool, const H: usize>(
    mut sums: [[f64; H]; WIDTH],
    left: &[[f64; H]],
    right: &[[f64; WIDTH]],
) -> [[f64; H]; WIDTH] {
    for (left, right) in left.iter().zip(right) {
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
