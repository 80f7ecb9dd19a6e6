//! Solutions with the factors, front by front, for any number of right-hand sides.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::factors::{Factors, FrontFactors};
use super::kernels::{
    dots, solve_unit_lower, solve_unit_lower_transposed, solve_upper, solve_upper_transposed, subtract_columns,
    subtract_product, subtract_transposed_product,
};
use super::matrix_view::{MatrixView, MatrixViewMut};
use super::product::Target;
use super::small_front::{LANES, SMALL_FRONT};
use super::symbolic::Symbolic;
use crate::linalg::simd::{Kernel, dispatch, multiply_add, prefetch};
use crate::linalg::vectors::{Instructions, VectorKernel, dispatch_vectors};
use std::ops::Range;

/// Which of the two systems is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// A x = b.
    Plain,
    /// A^T x = b.
    Transposed,
}

/// Right-hand sides that are solved at once.
pub const BLOCK: usize = 32;
/// Right-hand sides that go through a front together: each has the bits that it has alone. More of them are worth products of matrices.
const FEW: usize = 4;
/// How many fronts ahead of the one at work the factors of a small one are asked for: what no cache holds takes as long as ten of them.
const AHEAD: usize = 12;

/// Vectors in the order of elimination: residuals that turn into intermediate results, and solutions.
#[derive(Default)]
pub struct Substitution {
    residual: Vec<f64>,
    solution: Vec<f64>,
    front: Vec<f64>,
}

/// Numbers from one vector to the next: small fronts read and write behind their last row.
fn stride(symbolic: &Symbolic) -> usize {
    symbolic.size + LANES
}

impl Substitution {
    /// Residuals, one vector after the other.
    pub fn residuals(&mut self, symbolic: &Symbolic) -> impl Iterator<Item = &mut [f64]> {
        self.residual.chunks_exact_mut(stride(symbolic))
    }

    /// Solutions, likewise.
    pub fn solutions(&mut self, symbolic: &Symbolic) -> impl Iterator<Item = &mut [f64]> {
        self.solution.chunks_exact_mut(stride(symbolic))
    }

    /// Replaces up to [`BLOCK`] right-hand sides, column by column, by solutions.
    pub fn solve(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, rhs: &mut [f64]) {
        self.load(symbolic, rhs);
        let all = 0..symbolic.fronts.len();
        self.forward(symbolic, factors, side, all.clone());
        self.backward(symbolic, factors, side, all);
        self.store(symbolic, rhs, 0..symbolic.size);
    }

    /// Memory for as many vectors as right-hand sides.
    pub fn make_room(&mut self, symbolic: &Symbolic, rhs: &[f64]) {
        let length = rhs.len() / symbolic.size.max(1) * stride(symbolic);
        for own in [&mut self.residual, &mut self.solution] {
            if own.is_empty() {
                // what is never written takes no memory
                *own = vec![0.0; length];
            }
            own.resize(length, 0.0);
        }
    }

    /// Takes right-hand sides over.
    fn load(&mut self, symbolic: &Symbolic, rhs: &[f64]) {
        let size = symbolic.size.max(1);
        self.make_room(symbolic, rhs);
        let columns = self.residual.chunks_exact_mut(stride(symbolic)).zip(rhs.chunks_exact(size));
        for (residual, rhs) in columns {
            for (own, &unknown) in residual.iter_mut().zip(&symbolic.order) {
                // SAFETY: the order is one of all `size` unknowns, as many as numbers of a right-hand side.
                *own = unsafe { *rhs.get_unchecked(unknown as usize) };
            }
        }
    }

    /// Gives solutions out at some places.
    pub fn store(&self, symbolic: &Symbolic, rhs: &mut [f64], places: Range<usize>) {
        let columns = self.solution.chunks_exact(stride(symbolic)).zip(rhs.chunks_exact_mut(symbolic.size.max(1)));
        for (solution, rhs) in columns {
            for (own, &unknown) in solution[places.clone()].iter().zip(&symbolic.order[places.clone()]) {
                // SAFETY: as above.
                unsafe { *rhs.get_unchecked_mut(unknown as usize) = *own };
            }
        }
    }

    /// L y = b, or U^T y = b; y stands among the solutions, at the places of its columns (or rows). In small fronts U has ones on its
    /// diagonal, and the way back divides by the pivots.
    pub fn forward(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, all: Range<usize>) {
        let mut first = all.start;
        while first < all.end {
            let is_small = factors.is_small(first);
            let end = (first + 1..all.end).find(|&front| factors.is_small(front) != is_small);
            let fronts = first..end.unwrap_or(all.end);
            first = fronts.end;
            if is_small {
                let Substitution { residual, solution, .. } = self;
                dispatch_vectors(SmallFronts { symbolic, factors, side, fronts, residual: Some(residual), solution });
            } else {
                let Substitution { residual, solution, front } = self;
                dispatch(Forward { symbolic, factors, side, fronts, residual, solution, front });
            }
        }
    }

    /// The same for fronts whose turn comes after that of fronts behind them: small ones write over what follows their unknowns.
    pub fn forward_late(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, fronts: Range<usize>) {
        let last = &symbolic.fronts[fronts.end - 1];
        let end = last.first + last.pivots;
        let mut kept = [[0.0; LANES]; BLOCK];
        for (kept, solution) in kept.iter_mut().zip(self.solutions(symbolic)) {
            kept.copy_from_slice(&solution[end..end + LANES]);
        }
        self.forward(symbolic, factors, side, fronts);
        for (kept, solution) in kept.iter().zip(self.solutions(symbolic)) {
            solution[end..end + LANES].copy_from_slice(kept);
        }
    }

    /// U x = y, or L^T x = y, in place of y.
    pub fn backward(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, all: Range<usize>) {
        let mut end = all.end;
        while end > all.start {
            let is_small = factors.is_small(end - 1);
            let before = (all.start..end - 1).rev().find(|&front| factors.is_small(front) != is_small);
            let fronts = before.map_or(all.start, |front| front + 1)..end;
            end = fronts.start;
            if is_small {
                let solution = &mut self.solution;
                dispatch_vectors(SmallFronts { symbolic, factors, side, fronts, residual: None, solution });
            } else {
                let Substitution { solution, front, .. } = self;
                dispatch(Backward { symbolic, factors, side, fronts, solution, front });
            }
        }
    }
}

/// Where the rows of a front stand in the vectors.
#[derive(Clone, Copy)]
struct Lists<'l> {
    factors: FrontFactors<'l>,
    /// Of the equations.
    given: &'l [u32],
    /// Of the unknowns that the pivots of these equations determine.
    own: &'l [u32],
    others: &'l [u32],
}

impl<'l> Lists<'l> {
    #[inline(always)]
    fn new(symbolic: &'l Symbolic, front: usize, factors: FrontFactors<'l>, side: Side) -> Self {
        let (given, own) = match side {
            Side::Plain => (factors.rows, factors.columns),
            Side::Transposed => (factors.columns, factors.rows),
        };
        Lists { factors, given, own, others: &symbolic.rows[symbolic.fronts[front].rows.clone()] }
    }

    /// Of the unknowns.
    #[inline(always)]
    fn swapped(self) -> Self {
        Lists { given: self.own, ..self }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.given.len() + self.others.len()
    }

    /// Copies the rows below the pivots back to a vector.
    #[inline(always)]
    fn scatter_rest(&self, values: &[f64], vector: &mut [f64]) {
        let delayed = &self.given[self.factors.eliminated..];
        let (of_delayed, of_others) = values.split_at(delayed.len());
        delayed.iter().zip(of_delayed).for_each(|(&place, value)| vector[place as usize] = *value);
        self.others.iter().zip(of_others).for_each(|(&place, value)| vector[place as usize] = *value);
    }

    /// Copies the rows of the front out of vectors, place by place for up to [`FEW`] of them; asks for the factors meanwhile, a cache line a place
    /// from `factors` on by `step`.
    #[inline(always)]
    fn gather(&self, vectors: &[f64], size: usize, front: &mut Vec<f64>, factors: *const f64, step: isize) {
        let (count, order) = (vectors.len() / size, self.len());
        front.resize(count * order, 0.0);
        match count {
            1 => self.gather_columns::<1>(columns_of(vectors, size), columns_of_mut(front, order), factors, step),
            2 => self.gather_columns::<2>(columns_of(vectors, size), columns_of_mut(front, order), factors, step),
            3 => self.gather_columns::<3>(columns_of(vectors, size), columns_of_mut(front, order), factors, step),
            FEW => self.gather_columns::<FEW>(columns_of(vectors, size), columns_of_mut(front, order), factors, step),
            _ => {
                for (vector, front) in vectors.chunks_exact(size).zip(front.chunks_exact_mut(order.max(1))) {
                    self.gather_columns::<1>([vector], [front], factors, 0);
                }
            }
        }
    }

    #[inline(always)]
    fn gather_columns<const W: usize>(&self, from: [&[f64]; W], to: [&mut [f64]; W], mut factors: *const f64, step: isize) {
        let mut row = 0;
        for places in [self.given, self.others] {
            for &place in places {
                prefetch(factors);
                factors = factors.wrapping_offset(step);
                for w in 0..W {
                    to[w][row] = from[w][place as usize];
                }
                row += 1;
            }
        }
    }
}

/// `W` columns of so many rows.
#[inline(always)]
fn columns_of<const W: usize>(values: &[f64], rows: usize) -> [&[f64]; W] {
    std::array::from_fn(|column| &values[column * rows..][..rows])
}

#[inline(always)]
fn columns_of_mut<const W: usize>(mut values: &mut [f64], rows: usize) -> [&mut [f64]; W] {
    std::array::from_fn(|_| {
        let (column, rest) = std::mem::take(&mut values).split_at_mut(rows);
        values = rest;
        column
    })
}

/// Small fronts that follow each other: forward with residuals, backward without.
struct SmallFronts<'j> {
    symbolic: &'j Symbolic,
    factors: &'j Factors,
    side: Side,
    fronts: Range<usize>,
    residual: Option<&'j mut [f64]>,
    solution: &'j mut [f64],
}

impl VectorKernel for SmallFronts<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Instructions>(mut self) {
        let (mut column, columns) = (0, self.solution.len() / stride(self.symbolic));
        while column < columns {
            match columns - column {
                1 => self.columns::<I, 1>(column),
                2 => self.columns::<I, 2>(column),
                3 => self.columns::<I, 3>(column),
                _ => self.columns::<I, FEW>(column),
            }
            column += FEW;
        }
    }
}

impl SmallFronts<'_> {
    /// For `W` vectors from `column` on.
    #[inline(always)]
    fn columns<I: Instructions, const W: usize>(&mut self, column: usize) {
        let SmallFronts { symbolic, factors, side, ref fronts, ref mut residual, ref mut solution } = *self;
        let (stride, is_transposed) = (stride(symbolic), side == Side::Transposed);
        let solution = &mut solution[column * stride..][..W * stride];
        let mut solutions = [solution.as_mut_ptr(); W];
        for w in 0..W {
            solutions[w] = solutions[w].wrapping_add(w * stride);
        }
        if let Some(residual) = residual {
            let residual = &mut residual[column * stride..][..W * stride];
            let mut residuals = [residual.as_mut_ptr(); W];
            for w in 0..W {
                residuals[w] = residuals[w].wrapping_add(w * stride);
            }
            for number in fronts.clone() {
                let small = factors.small(symbolic, number, is_transposed);
                if number + AHEAD < symbolic.fronts.len() {
                    factors.small(symbolic, number + AHEAD, is_transposed).prefetch_lower();
                }
                // SAFETY: `stride` numbers from each pointer on, all places and some more.
                unsafe {
                    if let (Some(rows), false) = (factors.exchanged(symbolic, number), is_transposed) {
                        residuals.iter().for_each(|&vector| gather_rows(rows, small.first(), vector));
                    }
                    small.forward::<I, W>(residuals, solutions);
                }
            }
        } else {
            for number in fronts.clone().rev() {
                let small = factors.small(symbolic, number, is_transposed);
                if number >= AHEAD {
                    factors.small(symbolic, number - AHEAD, is_transposed).prefetch_upper();
                }
                // SAFETY: as above.
                unsafe {
                    small.backward::<I, W>(solutions);
                    if let (Some(rows), true) = (factors.exchanged(symbolic, number), is_transposed) {
                        solutions.iter().for_each(|&vector| scatter_rows(rows, small.first(), vector));
                    }
                }
            }
        }
    }
}

/// Brings the numbers of exchanged rows into the order of the pivots.
///
/// # Safety
/// The vector has all these places.
#[cold]
#[inline(never)]
unsafe fn gather_rows(rows: &[u32], first: usize, vector: *mut f64) {
    let mut own = [0.0; SMALL_FRONT];
    for (own, &place) in own.iter_mut().zip(rows) {
        // SAFETY: promised by the caller.
        *own = unsafe { *vector.add(place as usize) };
    }
    // SAFETY: as above.
    unsafe { vector.add(first).copy_from(own.as_ptr(), rows.len()) }
}

/// Brings them back.
///
/// # Safety
/// As for [`gather_rows`].
#[cold]
#[inline(never)]
unsafe fn scatter_rows(rows: &[u32], first: usize, vector: *mut f64) {
    let mut own = [0.0; SMALL_FRONT];
    // SAFETY: promised by the caller.
    unsafe {
        vector.add(first).copy_to(own.as_mut_ptr(), rows.len());
        for (own, &place) in own.iter().zip(rows) {
            *vector.add(place as usize) = *own;
        }
    }
}

/// L y = b, or U^T y = b, in large fronts that follow each other.
struct Forward<'j> {
    symbolic: &'j Symbolic,
    factors: &'j Factors,
    side: Side,
    fronts: Range<usize>,
    residual: &'j mut [f64],
    solution: &'j mut [f64],
    front: &'j mut Vec<f64>,
}

impl Kernel for Forward<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Forward { symbolic, factors, side, fronts, residual, solution, front } = self;
        let size = stride(symbolic);
        for number in fronts {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side);
            let FrontFactors { eliminated, lower, upper, .. } = lists.factors;
            // what is read first, or beside a triangle that is short
            let factors = if side == Side::Plain { lower } else { upper };
            lists.gather(residual, size, front, factors.as_ptr(), LANES as isize);
            let order = lists.len().max(1);
            match side {
                _ if front.len() > FEW * order => forward_many(&lists, side, front),
                // loops: a closure would not be compiled for wide vectors
                Side::Plain => {
                    for front in front.chunks_exact_mut(order) {
                        lower_triangle::<FUSED>(lower.entries(), lower.rows(), eliminated, front);
                    }
                }
                Side::Transposed => in_columns::<FUSED>(front, order, ForwardTransposed { lists: &lists }),
            }
            let vectors = residual.chunks_exact_mut(size).zip(solution.chunks_exact_mut(size));
            for (front, (residual, solution)) in front.chunks_exact(order).zip(vectors) {
                let (own, rest) = front.split_at(eliminated);
                lists.own.iter().zip(own).for_each(|(&place, value)| solution[place as usize] = *value);
                lists.scatter_rest(rest, residual);
            }
        }
    }
}

/// L y = b, or U^T y = b, in a front with many vectors.
fn forward_many(lists: &Lists, side: Side, front: &mut [f64]) {
    let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
    let (order, columns) = (lists.len(), front.len() / lists.len());
    let (mut own, mut rest) = MatrixViewMut::new(front, order, columns).split_rows(eliminated);
    let pivots = 0..eliminated;
    let square = lower.block(pivots.clone(), pivots.clone());
    match side {
        Side::Plain => {
            solve_unit_lower(square, own.reborrow(), 1);
            let below = lower.block(eliminated..order, pivots);
            subtract_product(rest, Target::Reduced, below, own.as_view(), 1);
        }
        Side::Transposed => {
            solve_upper_transposed(square, own.reborrow());
            let (delayed, others) = rest.reborrow().split_rows(rows.len() - eliminated);
            let beside = lower.block(pivots.clone(), eliminated..rows.len());
            subtract_transposed_product(delayed, beside, own.as_view());
            let beside = upper.block(pivots, 0..upper.columns());
            subtract_transposed_product(others, beside, own.as_view());
        }
    }
}

/// U x = y, or L^T x = y, in a front with many vectors.
fn backward_many(lists: &Lists, side: Side, front: &mut [f64]) {
    let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
    let (order, columns) = (lists.len(), front.len() / lists.len());
    let (mut own, rest) = MatrixViewMut::new(front, order, columns).split_rows(eliminated);
    let rest = rest.as_view();
    let pivots = 0..eliminated;
    let square = lower.block(pivots.clone(), pivots.clone());
    match side {
        Side::Plain => {
            let left = rows.len() - eliminated;
            let beside = lower.block(pivots.clone(), eliminated..rows.len());
            subtract_product(own.reborrow(), Target::Reduced, beside, rest.block(0..left, 0..columns), 1);
            let (beside, others) = (upper.block(pivots, 0..upper.columns()), rest.block(left..rest.rows(), 0..columns));
            subtract_product(own.reborrow(), Target::Reduced, beside, others, 1);
            solve_upper(square, own);
        }
        Side::Transposed => {
            subtract_transposed_product(own.reborrow(), lower.block(eliminated..order, pivots), rest);
            solve_unit_lower_transposed(square, own);
        }
    }
}

/// Work on the vectors of a front, one or two at once.
trait OnColumns: Copy {
    fn run<const FUSED: bool, const W: usize>(self, x: [&mut [f64]; W]);
}

/// Runs it on the vectors in a front, of `order` numbers each: each has the bits that it has alone.
#[inline(always)]
fn in_columns<const FUSED: bool>(front: &mut [f64], order: usize, work: impl OnColumns) {
    let mut pairs = front.chunks_exact_mut(2 * order);
    // loops: a closure would not be compiled for wide vectors
    for pair in &mut pairs {
        let (first, second) = pair.split_at_mut(order);
        work.run::<FUSED, 2>([first, second]);
    }
    for last in pairs.into_remainder().chunks_exact_mut(order) {
        work.run::<FUSED, 1>([last]);
    }
}

/// Columns of a triangle that meet a vector at a time.
const STRIP: usize = 4;

/// Numbers from a strip of columns to that after it, or further where these are short: what is read from memory is asked for so far ahead.
#[inline(always)]
fn ahead(columns: MatrixView) -> isize {
    const LEAST: usize = 256;
    (STRIP * columns.stride()).max(LEAST) as isize
}

/// U^T y = b in a front.
#[derive(Clone, Copy)]
struct ForwardTransposed<'l> {
    lists: &'l Lists<'l>,
}

impl OnColumns for ForwardTransposed<'_> {
    #[inline(always)]
    fn run<const FUSED: bool, const W: usize>(self, x: [&mut [f64]; W]) {
        let FrontFactors { eliminated, lower, upper, rows, .. } = self.lists.factors;
        let mut first = 0;
        while first < eliminated {
            let strip = STRIP.min(eliminated - first);
            // those before the strip, then those in it
            let columns: [&[f64]; STRIP] = std::array::from_fn(|p| lower.column(first + p.min(strip - 1)));
            let known: [&[f64]; W] = std::array::from_fn(|w| &x[w][..first]);
            let sums = dots::<FUSED, true, STRIP, W>(columns.map(|column| &column[..first]), known, ahead(lower));
            for w in 0..W {
                for p in 0..strip {
                    let mut value = x[w][first + p] - sums[w][p];
                    for before in 0..p {
                        value = multiply_add::<FUSED>(columns[p][first + before], -x[w][first + before], value);
                    }
                    x[w][first + p] = value / columns[p][first + p];
                }
            }
            first += strip;
        }
        let left = rows.len() - eliminated;
        let column = |index: usize| match index.checked_sub(left) {
            None => &lower.column(eliminated + index)[..eliminated],
            Some(index) => &upper.column(index)[..eliminated],
        };
        let below = x.map(|x| {
            let (own, rest) = x.split_at_mut(eliminated);
            (&*own, rest)
        });
        let own: [&[f64]; W] = std::array::from_fn(|w| below[w].0);
        let mut rest = below.map(|(_, rest)| rest);
        let count = left + upper.columns();
        let mut index = 0;
        while index + STRIP <= count {
            let sums = dots::<FUSED, true, STRIP, W>(std::array::from_fn(|p| column(index + p)), own, ahead(upper));
            for w in 0..W {
                rest[w][index..index + STRIP].iter_mut().zip(sums[w]).for_each(|(value, sum)| *value -= sum);
            }
            index += STRIP;
        }
        while index < count {
            let sums = dots::<FUSED, false, 1, W>([column(index)], own, 0);
            (0..W).for_each(|w| rest[w][index] -= sums[w][0]);
            index += 1;
        }
    }
}

/// L^T x = y in a front.
#[derive(Clone, Copy)]
struct BackwardTransposed<'l> {
    lists: &'l Lists<'l>,
}

impl OnColumns for BackwardTransposed<'_> {
    #[inline(always)]
    fn run<const FUSED: bool, const W: usize>(self, x: [&mut [f64]; W]) {
        let FrontFactors { eliminated, lower, .. } = self.lists.factors;
        let mut end = eliminated;
        while end > 0 {
            let first = end.saturating_sub(STRIP);
            let strip = end - first;
            // those behind the strip, then those in it
            let columns: [&[f64]; STRIP] = std::array::from_fn(|p| lower.column(first + p.min(strip - 1)));
            let known: [&[f64]; W] = std::array::from_fn(|w| &x[w][end..]);
            let sums = dots::<FUSED, true, STRIP, W>(columns.map(|column| &column[end..]), known, -ahead(lower));
            for w in 0..W {
                for p in (0..strip).rev() {
                    let mut value = x[w][first + p] - sums[w][p];
                    for behind in p + 1..strip {
                        value = multiply_add::<FUSED>(columns[p][first + behind], -x[w][first + behind], value);
                    }
                    x[w][first + p] = value;
                }
            }
            end = first;
        }
    }
}

/// U x = y, or L^T x = y, in large fronts that follow each other.
struct Backward<'j> {
    symbolic: &'j Symbolic,
    factors: &'j Factors,
    side: Side,
    fronts: Range<usize>,
    solution: &'j mut [f64],
    front: &'j mut Vec<f64>,
}

impl Kernel for Backward<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Backward { symbolic, factors, side, fronts, solution, front } = self;
        let size = stride(symbolic);
        for number in fronts.rev() {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side).swapped();
            let FrontFactors { lower, upper, .. } = lists.factors;
            let (factors, step) = match side {
                Side::Plain => (upper.as_ptr(), LANES as isize),
                Side::Transposed => (lower.entries().as_ptr_range().end, -(LANES as isize)),
            };
            lists.gather(solution, size, front, factors, step);
            let order = lists.len().max(1);
            match side {
                _ if front.len() > FEW * order => backward_many(&lists, side, front),
                Side::Plain => {
                    for front in front.chunks_exact_mut(order) {
                        backward_plain::<FUSED>(&lists, front);
                    }
                }
                Side::Transposed => in_columns::<FUSED>(front, order, BackwardTransposed { lists: &lists }),
            }
            for (front, solution) in front.chunks_exact(order).zip(solution.chunks_exact_mut(size)) {
                let own = lists.own.iter().zip(&front[..lists.factors.eliminated]);
                own.for_each(|(&place, value)| solution[place as usize] = *value);
            }
        }
    }
}

/// U x = y in a front.
#[inline(always)]
fn backward_plain<const FUSED: bool>(lists: &Lists, front: &mut [f64]) {
    let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
    let (own, rest) = front.split_at_mut(eliminated);
    let (delayed, others) = rest.split_at(rows.len() - eliminated);
    if eliminated > 0 && !delayed.is_empty() {
        let beside = &lower.entries()[eliminated * lower.rows()..];
        subtract_columns::<FUSED>(beside, lower.rows(), delayed, own);
    }
    if eliminated > 0 && !others.is_empty() {
        subtract_columns::<FUSED>(upper.entries(), upper.rows(), others, own);
    }
    upper_triangle::<FUSED>(lower.entries(), lower.rows(), eliminated, front);
}

/// x_1 <- L_11^-1 x_1, x_2 <- x_2 - L_21 x_1 with `count` columns of a unit lower triangle L_11 and the rows below.
#[inline(always)]
fn lower_triangle<const FUSED: bool>(l: &[f64], stride: usize, count: usize, x: &mut [f64]) {
    let mut first = 0;
    while first < count {
        let columns = LANES.min(count - first);
        let l = &l[first * stride + first..];
        let (solved, below) = x[first..].split_at_mut(LANES.min(stride - first));
        if let Some(lanes) = solved.first_chunk_mut::<LANES>() {
            let mut x = *lanes;
            for p in 0..LANES {
                if p == columns {
                    break;
                }
                let column = l[p * stride..].first_chunk::<LANES>().expect("as many rows as lanes");
                let known = x[p];
                for row in 0..LANES {
                    x[row] = if row > p { multiply_add::<FUSED>(column[row], -known, x[row]) } else { x[row] };
                }
            }
            *lanes = x;
        } else {
            for p in 0..columns {
                let known = solved[p];
                for row in p + 1..solved.len() {
                    solved[row] -= l[p * stride + row] * known;
                }
            }
        }
        if !below.is_empty() {
            subtract_columns::<FUSED>(&l[LANES..], stride, &solved[..columns], below);
        }
        first += columns;
    }
}

/// x <- U^-1 x with an upper triangle of `count` columns.
#[inline(always)]
fn upper_triangle<const FUSED: bool>(u: &[f64], stride: usize, count: usize, x: &mut [f64]) {
    let mut end = count;
    while end > 0 {
        let first = end.saturating_sub(LANES);
        let columns = end - first;
        let u = &u[first * stride..];
        let (above, solved) = x.split_at_mut(first);
        let mut inverses = [1.0; LANES];
        for p in 0..columns {
            inverses[p] = u[p * stride + first + p];
        }
        inverses.iter_mut().for_each(|pivot| *pivot = 1.0 / *pivot);
        if let Some(lanes) = solved.first_chunk_mut::<LANES>() {
            let mut x = *lanes;
            for p in (0..LANES).rev() {
                if p >= columns {
                    continue;
                }
                let column = u[p * stride + first..].first_chunk::<LANES>().expect("as many rows as lanes");
                x[p] *= inverses[p];
                let known = x[p];
                for row in 0..LANES {
                    x[row] = if row < p { multiply_add::<FUSED>(column[row], -known, x[row]) } else { x[row] };
                }
            }
            *lanes = x;
        } else {
            for p in (0..columns).rev() {
                solved[p] *= inverses[p];
                let known = solved[p];
                for row in 0..p {
                    solved[row] -= u[p * stride + first + row] * known;
                }
            }
        }
        if !above.is_empty() {
            subtract_columns::<FUSED>(u, stride, &solved[..columns], above);
        }
        end = first;
    }
}
