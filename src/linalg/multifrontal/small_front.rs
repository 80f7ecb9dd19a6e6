//! Factors of small fronts, for which calls, lists and searches would take longer than the arithmetic: one program of fixed sizes assembles and
//! eliminates in columns of whole vector registers, and stores without gaps, in the order in which solutions read.
//!
//! P A = L D U in a front: L and U have ones on their diagonals, which are not stored.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::factors::Form;
use super::front::Contribution;
use super::pivots::PIVOT_SHARE;
use super::symbolic::{Front, Symbolic};
use crate::linalg::vectors::{Instructions, Vector, VectorKernel};

/// Most rows of a small front.
pub const SMALL_FRONT: usize = 32;
/// Numbers that solutions work on together.
pub const LANES: usize = 8;
/// Numbers to which columns are padded.
const CHUNK: usize = 4;

/// Where the factors of a small front stand in their storage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Number of pivots.
    pub pivots: usize,
    /// Number of rows that are not pivots.
    pub others: usize,
}

impl Shape {
    /// Of a front.
    #[inline(always)]
    pub fn of(front: &Front) -> Self {
        Shape { pivots: front.pivots, others: front.others() }
    }
    /// Number of rows.
    #[inline(always)]
    pub fn size(self) -> usize {
        self.pivots + self.others
    }
    /// Where the columns of U without pivots begin, behind those of the rows above their pivots.
    #[inline(always)]
    pub fn beside(self) -> usize {
        self.pivots * self.pivots.saturating_sub(1) / 2
    }
    /// Where the inverses of the pivots begin, behind U.
    #[inline(always)]
    pub fn inverses(self) -> usize {
        self.beside() + self.pivots * self.others
    }
    /// Where L begins: columns of the rows below their pivots.
    #[inline(always)]
    pub fn lower(self) -> usize {
        self.inverses() + self.pivots
    }
    /// Numbers of L and U, in whole lines: the last chunk of a column is written as a whole.
    #[inline(always)]
    pub fn storage(self) -> usize {
        (self.lower() + self.inverses() + CHUNK - 1).next_multiple_of(LANES)
    }
}

/// Where a small front stands among all: what solutions need of it, close together.
#[derive(Clone, Copy, Debug)]
pub struct SmallPlan {
    /// Place of the first pivot.
    pub first: u32,
    /// Where the places of the other rows begin in the list of all.
    pub rows: u32,
    /// Where the factors begin among those of all small fronts, in lines of `LANES` numbers.
    pub line: u32,
    /// Number of pivots.
    pub pivots: u8,
    /// Number of rows that are not pivots.
    pub others: u8,
}

impl SmallPlan {
    /// Of a front; without a meaning if that is not small.
    pub fn of(front: &Front) -> Self {
        let shape = if front.is_small() { Shape::of(front) } else { Shape { pivots: 0, others: 0 } };
        SmallPlan {
            first: front.first as u32,
            rows: front.rows.start as u32,
            line: u32::try_from(front.small / LANES).expect("fewer than 2^32 lines of factors of small fronts"),
            pivots: shape.pivots as u8,
            others: shape.others as u8,
        }
    }

    /// Of the front.
    #[inline(always)]
    pub fn shape(&self) -> Shape {
        Shape { pivots: self.pivots as usize, others: self.others as usize }
    }
}

/// All columns of a small front, and those of L.
pub struct Scratch([Lines; 2]);

impl Default for Scratch {
    fn default() -> Self {
        Scratch([0; 2].map(|_| Lines::new(SMALL_FRONT * SMALL_FRONT + LANES)))
    }
}

/// Numbers from the beginning of a line of the cache on: what lies in two lines is not passed on from a store to a
/// load.
#[derive(Default)]
pub struct Lines(Vec<Line>);

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([f64; LANES]);

impl Lines {
    /// At least so many zeros.
    pub fn new(length: usize) -> Self {
        Lines(vec![Line([0.0; LANES]); length.div_ceil(LANES)])
    }
}

impl std::ops::Deref for Lines {
    type Target = [f64];
    #[inline(always)]
    fn deref(&self) -> &[f64] {
        // SAFETY: a line is `LANES` numbers and no more.
        unsafe { std::slice::from_raw_parts(self.0.as_ptr().cast(), self.0.len() * LANES) }
    }
}

impl std::ops::DerefMut for Lines {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.0.as_mut_ptr().cast(), self.0.len() * LANES) }
    }
}

/// Assembles and factors a small front none of whose children delayed a pivot.
pub struct SmallFront<'j> {
    /// The analysis.
    pub symbolic: &'j Symbolic,
    /// The front.
    pub front: &'j Front,
    /// Entries of the matrix.
    pub values: &'j [f64],
    /// What the fronts below leave.
    pub children: &'j [Contribution<'j>],
    /// Takes the places of the rows in the order of the pivots, where rows were exchanged.
    pub rows: &'j mut [u32],
    /// Takes the factors, where [`Shape`] says.
    pub storage: &'j mut [f64],
    /// Takes what is left to the front above, and up to `LANES` numbers without a meaning behind it.
    pub contribution: &'j mut [f64],
    /// Workspace.
    pub scratch: &'j mut Scratch,
}

impl VectorKernel for SmallFront<'_> {
    /// How the front is stored: as a large one where a column has no pivot that is large enough, and what was written has no meaning.
    type Output = Form;
    #[inline(always)]
    fn run<I: Instructions>(self) -> Form {
        let shape = Shape::of(self.front);
        let (others, size) = (shape.others, shape.size());
        assert!(size <= SMALL_FRONT && self.storage.len() >= shape.storage() && self.rows.len() == shape.pivots);
        assert!(others == 0 || self.contribution.len() >= others * others + LANES);
        // SAFETY: sizes were compared above.
        unsafe {
            match shape.size().div_ceil(CHUNK) {
                0 | 1 => self.factor::<I, 1>(shape),
                2 => self.factor::<I, 2>(shape),
                3 => self.factor::<I, 3>(shape),
                4 => self.factor::<I, 4>(shape),
                5 => self.factor::<I, 5>(shape),
                6 => self.factor::<I, 6>(shape),
                7 => self.factor::<I, 7>(shape),
                _ => self.factor::<I, 8>(shape),
            }
        }
    }
}

/// A column in registers.
type Column<V, const CHUNKS: usize> = [V; CHUNKS];

#[inline(always)]
unsafe fn load<V: Vector, const CHUNKS: usize>(from: *const f64) -> Column<V, CHUNKS> {
    // loops: a closure would not be compiled for the vectors
    let mut x = [V::splat(0.0); CHUNKS];
    for chunk in 0..CHUNKS {
        // SAFETY: promised by the caller.
        x[chunk] = unsafe { V::load(from.add(chunk * CHUNK)) };
    }
    x
}

#[inline(always)]
unsafe fn store<V: Vector, const CHUNKS: usize>(x: Column<V, CHUNKS>, to: *mut f64) {
    for chunk in 0..CHUNKS {
        // SAFETY: promised by the caller.
        unsafe { x[chunk].store(to.add(chunk * CHUNK)) }
    }
}

impl SmallFront<'_> {
    /// # Safety
    /// The front has at most `CHUNKS` times `CHUNK` rows, and all lists the lengths that [`Kernel::run`] compares.
    #[inline(always)]
    unsafe fn factor<I: Instructions, const CHUNKS: usize>(self, shape: Shape) -> Form {
        let SmallFront { symbolic, front, values, children, rows, storage, contribution, scratch } = self;
        let Shape { pivots, others } = shape;
        let (stride, size) = (CHUNKS * CHUNK, shape.size());
        let [all, lower] = &mut scratch.0;
        let (all, lower) = (all.as_mut_ptr(), lower.as_mut_ptr());
        // SAFETY: `size` columns of the scratch; entries and contributions lie in the front.
        unsafe {
            // hidden: a call that fills memory takes longer
            let zero = std::hint::black_box(0.0);
            for column in 0..size {
                store([I::Four::splat(zero); CHUNKS], all.add(column * stride));
            }
            for block in &symbolic.entries[front.entries.clone()] {
                let (row, column) = (block.row as usize, block.column as usize);
                let from = values.as_ptr().add(block.source as usize);
                let size = [block.height as usize, block.width as usize];
                put::<false>((from, block.stride as usize), (all.add(row + column * stride), stride), size);
            }
            for child in children {
                let below = &symbolic.fronts[child.front];
                let (runs, order) = (&symbolic.extensions[below.extensions.clone()], below.others());
                for columns in runs {
                    for rows in runs {
                        let from = child.values.as_ptr().add(rows.from as usize + columns.from as usize * order);
                        let to = all.add(rows.to as usize + columns.to as usize * stride);
                        put::<true>((from, order), (to, stride), [rows.length as usize, columns.length as usize]);
                    }
                }
            }
        }
        let mut inverses = [0.0; SMALL_FRONT];
        let mut outcome = Form::Small;
        // two pivots at a time: every column is loaded and stored half as often
        for first in (0..pivots).step_by(2) {
            let mut l = [[I::Four::splat(0.0); CHUNKS]; 2];
            let end = pivots.min(first + 2);
            for own in first..end {
                // SAFETY: columns of the scratch and of L.
                unsafe {
                    let column = all.add(own * stride);
                    let (mut x, mut pivot) = (load(column), *column.add(own));
                    if own > first {
                        let known = *column.add(first);
                        // the pivot by itself: its inverse is what takes longest and what all others wait for
                        let factor = *column.sub(stride).add(own) * inverses[first];
                        pivot = I::minus_product(pivot, factor, known);
                        x = subtract_column::<I, CHUNKS>(x, &l[0], I::Four::splat(known));
                        // numbers by their rows, through memory
                        store(x, column);
                    }
                    inverses[own] = 1.0 / pivot;
                    let mut below = scaled_below::<I, CHUNKS>(&x, own, inverses[own]);
                    if !is_usable(pivot) || I::largest(&below) > 1.0 / PIVOT_SHARE {
                        let values = std::slice::from_raw_parts(column, stride);
                        let Some(row) = other_pivot(values, own..pivots, front.is_last()) else {
                            return Form::Large;
                        };
                        if row != own {
                            if outcome == Form::Small {
                                rows.iter_mut().zip(front.first as u32..).for_each(|(row, place)| *row = place);
                                outcome = Form::SmallExchanged;
                            }
                            rows.swap(own, row);
                            (0..own).for_each(|k| lower.add(k * stride + own).swap(lower.add(k * stride + row)));
                            (own..size).for_each(|k| all.add(k * stride + own).swap(all.add(k * stride + row)));
                            l[0] = load(lower.add(first * stride));
                        }
                        inverses[own] = 1.0 / *column.add(own);
                        below = scaled_below::<I, CHUNKS>(&load(column), own, inverses[own]);
                    }
                    store(below, lower.add(own * stride));
                    l[own - first] = below;
                }
            }
            // SAFETY: the columns behind, and two of L.
            unsafe {
                let l = (&l, lower.add(first * stride).cast_const());
                match first / LANES {
                    0 => subtract_pair::<I, CHUNKS, 0>(all, end..size, l, first),
                    1 => subtract_pair::<I, CHUNKS, 2>(all, end..size, l, first),
                    2 => subtract_pair::<I, CHUNKS, 4>(all, end..size, l, first),
                    _ => subtract_pair::<I, CHUNKS, 6>(all, end..size, l, first),
                }
            }
        }
        // SAFETY: columns of the scratch, and so many numbers of the storage.
        unsafe {
            // columns that follow each other write over what the one before left behind itself
            let mut to = storage.as_mut_ptr();
            for column in 1..size {
                let (from, rows) = (all.add(column * stride), column.min(pivots));
                for row in (0..CHUNKS * CHUNK).step_by(CHUNK) {
                    if row < rows {
                        let inverses = I::Four::load(inverses.as_ptr().add(row));
                        I::Four::load(from.add(row)).times(inverses).store(to.add(row));
                    }
                }
                to = to.add(rows);
            }
            copy_chunks::<I, CHUNKS>(inverses.as_ptr(), to, pivots);
            to = to.add(pivots);
            for own in 0..pivots {
                copy_chunks::<I, CHUNKS>(lower.add(own * stride + own + 1), to, size - own - 1);
                to = to.add(size - own - 1);
            }
            let to = contribution.as_mut_ptr();
            for other in 0..others {
                let from = all.add((pivots + other) * stride + pivots);
                let mut row = 0;
                while row < others {
                    I::Eight::load(from.add(row)).store(to.add(other * others + row));
                    row += LANES;
                }
            }
        }
        outcome
    }
}

/// Copies up to `CHUNKS` chunks of numbers, and what follows the last one in its chunk.
///
/// # Safety
/// There are so many.
#[inline(always)]
unsafe fn copy_chunks<I: Instructions, const CHUNKS: usize>(from: *const f64, to: *mut f64, count: usize) {
    // no loop of so many rounds: their number changes from column to column
    for row in (0..CHUNKS * CHUNK).step_by(CHUNK) {
        if row < count {
            // SAFETY: promised by the caller.
            unsafe { I::Four::load(from.add(row)).store(to.add(row)) };
        }
    }
}

#[inline(always)]
fn is_usable(pivot: f64) -> bool {
    pivot.abs() > crate::tolerances::ROUND_OFF && pivot.is_finite()
}

/// No bits of the first `SMALL_FRONT` numbers, all bits of as many more, and none of as many again.
pub static MASK: [u64; 3 * SMALL_FRONT] = {
    let mut bits = [0; 3 * SMALL_FRONT];
    let mut place = SMALL_FRONT;
    while place < 2 * SMALL_FRONT {
        bits[place] = u64::MAX;
        place += 1;
    }
    bits
};

/// The rows below the pivot times a factor, zero above.
#[inline(always)]
fn scaled_below<I: Instructions, const CHUNKS: usize>(
    x: &Column<I::Four, CHUNKS>,
    pivot: usize,
    factor: f64,
) -> Column<I::Four, CHUNKS> {
    let mask = MASK[SMALL_FRONT - 1 - pivot..][..CHUNKS * CHUNK].as_ptr();
    let factor = I::Four::splat(factor);
    let mut scaled = *x;
    for chunk in 0..CHUNKS {
        // SAFETY: so many chunks were cut out above.
        scaled[chunk] = unsafe { x[chunk].masked(mask.add(chunk * CHUNK)).times(factor) };
    }
    scaled
}

/// Subtracts two pivots, or one and zeros, from columns: all but the chunks before `FROM`, where L is zero.
///
/// # Safety
/// There are so many columns, and two of L where `lower` begins.
#[inline(always)]
unsafe fn subtract_pair<I: Instructions, const CHUNKS: usize, const FROM: usize>(
    all: *mut f64,
    columns: std::ops::Range<usize>,
    (l, lower): (&[Column<I::Four, CHUNKS>; 2], *const f64),
    first: usize,
) {
    // SAFETY: promised by the caller.
    unsafe {
        let factor = *lower.add(first + 1);
        for column in columns {
            let column = all.add(column * CHUNKS * CHUNK);
            let known = *column.add(first);
            let next = I::minus_product(*column.add(first + 1), factor, known);
            let (known, next) = (I::Four::splat(known), I::Four::splat(next));
            for chunk in FROM..CHUNKS {
                let x = I::Four::load(column.add(chunk * CHUNK));
                let x = x.minus_product(l[0][chunk], known).minus_product(l[1][chunk], next);
                x.store(column.add(chunk * CHUNK));
            }
        }
    }
}

/// x - l f.
#[inline(always)]
fn subtract_column<I: Instructions, const CHUNKS: usize>(
    mut x: Column<I::Four, CHUNKS>,
    l: &Column<I::Four, CHUNKS>,
    factor: I::Four,
) -> Column<I::Four, CHUNKS> {
    for chunk in 0..CHUNKS {
        x[chunk] = x[chunk].minus_product(l[chunk], factor);
    }
    x
}

/// The row of the pivot of a column whose own row is too small for it.
#[cold]
#[inline(never)]
fn other_pivot(column: &[f64], rows: std::ops::Range<usize>, is_last: bool) -> Option<usize> {
    let size = |row: usize| if column[row].is_nan() { -1.0 } else { column[row].abs() };
    let best = rows.clone().max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
    let largest = (rows.start..column.len()).map(size).fold(0.0, f64::max);
    let is_enough = is_usable(column[best]) && (is_last || column[best].abs() >= PIVOT_SHARE * largest);
    is_enough.then_some(best)
}

/// Writes a block to columns of `stride` numbers, or adds it to what stands there.
///
/// # Safety
/// The block, whose columns are `step` numbers apart, lies in what it is read from and in the columns.
#[inline(always)]
unsafe fn put<const ADDED: bool>(
    (source, step): (*const f64, usize),
    (target, stride): (*mut f64, usize),
    [height, width]: [usize; 2],
) {
    #[inline(always)]
    unsafe fn of<const ADDED: bool, const H: usize>(
        (source, step): (*const f64, usize),
        (target, stride): (*mut f64, usize),
        width: usize,
    ) {
        for column in 0..width {
            // SAFETY: promised by the caller.
            let (source, target) = unsafe {
                (&*source.add(column * step).cast::<[f64; H]>(), &mut *target.add(column * stride).cast::<[f64; H]>())
            };
            if !ADDED {
                *target = *source;
                continue;
            }
            for row in 0..H {
                target[row] += source[row];
            }
        }
    }
    let (from, to) = ((source, step), (target, stride));
    // SAFETY: promised by the caller.
    unsafe {
        match height {
            1 => of::<ADDED, 1>(from, to, width),
            2 => of::<ADDED, 2>(from, to, width),
            3 => of::<ADDED, 3>(from, to, width),
            6 => of::<ADDED, 6>(from, to, width),
            12 => of::<ADDED, 12>(from, to, width),
            _ => {
                for column in 0..width {
                    for row in 0..height {
                        let (source, target) = (source.add(row + column * step), target.add(row + column * stride));
                        *target = if ADDED { *target + *source } else { *source };
                    }
                }
            }
        }
    }
}
