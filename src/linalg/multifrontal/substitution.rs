//! Solutions with the factors, front by front, for any number of right-hand sides.

use super::factors::{Factors, FrontFactors};
use super::kernels::{
    Target, dot, solve_unit_lower, solve_unit_lower_transposed, solve_upper, solve_upper_transposed, subtract_columns,
    subtract_product, subtract_transposed_product,
};
use super::matrix_view::MatrixViewMut;
use super::symbolic::Symbolic;
use crate::linalg::simd::{Kernel, dispatch, multiply_add};
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
/// Right-hand sides that go through a front one after the other, while it is near: each has the bits that it has alone. More of them are worth
/// products of matrices.
const FEW: usize = 4;

/// Vectors in the order of elimination: residuals that turn into intermediate results, and solutions.
#[derive(Default)]
pub struct Substitution {
    residual: Vec<f64>,
    solution: Vec<f64>,
    front: Vec<f64>,
}

impl Substitution {
    /// Replaces right-hand sides, column by column, by solutions.
    pub fn solve(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, rhs: &mut [f64]) {
        let all = 0..symbolic.fronts.len();
        for block in rhs.chunks_mut(BLOCK * symbolic.size.max(1)) {
            self.load(symbolic, block);
            self.forward(symbolic, factors, side, all.clone());
            self.backward(symbolic, factors, side, all.clone());
            self.store(symbolic, block);
        }
    }

    /// Takes right-hand sides over.
    pub fn load(&mut self, symbolic: &Symbolic, rhs: &[f64]) {
        self.residual.resize(rhs.len(), 0.0);
        self.solution.resize(rhs.len(), 0.0);
        let columns = self.residual.chunks_exact_mut(symbolic.size.max(1)).zip(rhs.chunks_exact(symbolic.size.max(1)));
        for (residual, rhs) in columns {
            residual.iter_mut().zip(&symbolic.order).for_each(|(own, &unknown)| *own = rhs[unknown as usize]);
        }
    }

    /// Gives solutions out.
    pub fn store(&self, symbolic: &Symbolic, rhs: &mut [f64]) {
        let columns = self.solution.chunks_exact(symbolic.size.max(1)).zip(rhs.chunks_exact_mut(symbolic.size.max(1)));
        for (solution, rhs) in columns {
            solution.iter().zip(&symbolic.order).for_each(|(own, &unknown)| rhs[unknown as usize] = *own);
        }
    }

    /// L y = b, or U^T y = b; y stands among the solutions, at the places of its columns (or rows).
    pub fn forward(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, fronts: Range<usize>) {
        let Substitution { residual, solution, front } = self;
        if residual.len() <= FEW * symbolic.size {
            return dispatch(ForwardFew { symbolic, factors, side, fronts, residual, solution, front });
        }
        for number in fronts {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side);
            let columns = lists.gather(residual, symbolic.size, front);
            let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
            let order = lists.len();
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
            for (values, (residual, solution)) in front
                .chunks_exact(order.max(1))
                .zip(residual.chunks_mut(symbolic.size).zip(solution.chunks_mut(symbolic.size)))
            {
                lists.own.iter().zip(values).take(eliminated).for_each(|(&place, value)| solution[place as usize] = *value);
                lists.scatter_rest(&values[eliminated..], residual);
            }
        }
    }

    /// U x = y, or L^T x = y, in place of y.
    pub fn backward(&mut self, symbolic: &Symbolic, factors: &Factors, side: Side, fronts: Range<usize>) {
        let Substitution { solution, front, .. } = self;
        if solution.len() <= FEW * symbolic.size {
            return dispatch(BackwardFew { symbolic, factors, side, fronts, solution, front });
        }
        for number in fronts.rev() {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side).swapped();
            let columns = lists.gather(solution, symbolic.size, front);
            let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
            let order = lists.len();
            let (mut own, rest) = MatrixViewMut::new(front, order, columns).split_rows(eliminated);
            let rest = rest.as_view();
            let pivots = 0..eliminated;
            let square = lower.block(pivots.clone(), pivots.clone());
            match side {
                Side::Plain => {
                    let left = rows.len() - eliminated;
                    let beside = lower.block(pivots.clone(), eliminated..rows.len());
                    subtract_product(own.reborrow(), Target::Reduced, beside, rest.block(0..left, 0..columns), 1);
                    let (beside, others) =
                        (upper.block(pivots, 0..upper.columns()), rest.block(left..rest.rows(), 0..columns));
                    subtract_product(own.reborrow(), Target::Reduced, beside, others, 1);
                    solve_upper(square, own);
                }
                Side::Transposed => {
                    subtract_transposed_product(own.reborrow(), lower.block(eliminated..order, pivots), rest);
                    solve_unit_lower_transposed(square, own);
                }
            }
            for (values, solution) in front.chunks_exact(order.max(1)).zip(solution.chunks_mut(symbolic.size)) {
                lists.own.iter().zip(values).take(eliminated).for_each(|(&place, value)| solution[place as usize] = *value);
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

    /// Copies the rows of the front out of vectors; returns the number of vectors.
    #[inline(always)]
    fn gather(&self, vectors: &[f64], size: usize, front: &mut Vec<f64>) -> usize {
        front.clear();
        for vector in vectors.chunks_exact(size.max(1)) {
            front.extend(self.given.iter().map(|&place| vector[place as usize]));
            front.extend(self.others.iter().map(|&place| vector[place as usize]));
        }
        vectors.len() / size.max(1)
    }
}

struct ForwardFew<'j> {
    symbolic: &'j Symbolic,
    factors: &'j Factors,
    side: Side,
    fronts: Range<usize>,
    residual: &'j mut [f64],
    solution: &'j mut [f64],
    front: &'j mut Vec<f64>,
}

impl Kernel for ForwardFew<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let ForwardFew { symbolic, factors, side, fronts, residual, solution, front } = self;
        let size = symbolic.size.max(1);
        for number in fronts {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side);
            for (residual, solution) in residual.chunks_exact_mut(size).zip(solution.chunks_exact_mut(size)) {
                lists.gather(residual, size, front);
                forward_one::<FUSED>(&lists, side, front);
                let (own, rest) = front.split_at(lists.factors.eliminated);
                lists.own.iter().zip(own).for_each(|(&place, value)| solution[place as usize] = *value);
                lists.scatter_rest(rest, residual);
            }
        }
    }
}

/// L y = b, or U^T y = b, in a front.
#[inline(always)]
fn forward_one<const FUSED: bool>(lists: &Lists, side: Side, front: &mut [f64]) {
    let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
    if side == Side::Plain {
        return lower_triangle::<FUSED>(lower.entries(), lower.rows(), eliminated, front);
    }
    let (own, rest) = front.split_at_mut(eliminated);
    for pivot in 0..eliminated {
        let column = lower.column(pivot);
        own[pivot] = (own[pivot] - dot::<FUSED>(&column[..pivot], &own[..pivot])) / column[pivot];
    }
    let (delayed, others) = rest.split_at_mut(rows.len() - eliminated);
    for (index, value) in delayed.iter_mut().enumerate() {
        *value -= dot::<FUSED>(&lower.column(eliminated + index)[..eliminated], own);
    }
    for (index, value) in others.iter_mut().enumerate() {
        *value -= dot::<FUSED>(&upper.column(index)[..eliminated], own);
    }
}

struct BackwardFew<'j> {
    symbolic: &'j Symbolic,
    factors: &'j Factors,
    side: Side,
    fronts: Range<usize>,
    solution: &'j mut [f64],
    front: &'j mut Vec<f64>,
}

impl Kernel for BackwardFew<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let BackwardFew { symbolic, factors, side, fronts, solution, front } = self;
        let size = symbolic.size.max(1);
        for number in fronts.rev() {
            let lists = Lists::new(symbolic, number, factors.front(symbolic, number), side).swapped();
            for solution in solution.chunks_exact_mut(size) {
                lists.gather(solution, size, front);
                backward_one::<FUSED>(&lists, side, front);
                let own = lists.own.iter().zip(&front[..lists.factors.eliminated]);
                own.for_each(|(&place, value)| solution[place as usize] = *value);
            }
        }
    }
}

/// U x = y, or L^T x = y, in a front.
#[inline(always)]
fn backward_one<const FUSED: bool>(lists: &Lists, side: Side, front: &mut [f64]) {
    let FrontFactors { eliminated, lower, upper, rows, .. } = lists.factors;
    let (own, rest) = front.split_at_mut(eliminated);
    if side == Side::Transposed {
        for pivot in (0..eliminated).rev() {
            let column = lower.column(pivot);
            let later = dot::<FUSED>(&column[pivot + 1..eliminated], &own[pivot + 1..]);
            own[pivot] -= later + dot::<FUSED>(&column[eliminated..], rest);
        }
        return;
    }
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

/// Rows of a triangle that are solved in a vector register.
const LANES: usize = 8;

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
