// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::multifrontal::pivots::{PANEL, SMALL, STRIP, eliminate_column, subtract_few, subtract_pivots};
use super::multifrontal::{Inertia, MultifrontalLu, largest};
use super::simd::{Kernel, dispatch};
use super::{LinearSolver, Singular};
use crate::linalg::SparsePattern;
use std::ops::Range;

/// Dense LU with partial pivoting: for up to about a hundred unknowns.
pub struct DenseLu {
    pattern: SparsePattern,
    /// L below the diagonal and U on and above it, column by column.
    lu: Vec<f64>,
    /// The equation that stands in each row.
    rows: Vec<usize>,
    permuted: Vec<f64>,
}

impl DenseLu {
    /// Workspace for a pattern.
    pub fn new(pattern: &SparsePattern) -> Self {
        let n = pattern.size;
        DenseLu { pattern: pattern.clone(), lu: vec![0.0; n * n], rows: vec![0; n], permuted: vec![0.0; n] }
    }

    fn column(&self, column: usize) -> &[f64] {
        let n = self.pattern.size;
        &self.lu[column * n..][..n]
    }

    /// P A = L U with the largest pivot of each column.
    fn eliminate(&mut self) {
        let n = self.pattern.size;
        self.rows.iter_mut().enumerate().for_each(|(row, equation)| *equation = row);
        for first in (0..n).step_by(PANEL) {
            let panel = first..(first + PANEL).min(n);
            dispatch(Panel { lu: &mut self.lu, rows: &mut self.rows, size: n, columns: panel.clone() });
            subtract_pivots(&mut self.lu, n, panel.clone(), panel.end, 1);
        }
    }

    /// The unknown that dominates the null vector belonging to the vanishing pivot `k`: U x = 0 with x_k = 1.
    fn dependent_unknown(&self, k: usize) -> usize {
        let mut x = vec![0.0; k + 1];
        x[k] = 1.0;
        for i in (0..k).rev() {
            let sum: f64 = (i + 1..=k).map(|j| self.column(j)[i] * x[j]).sum();
            x[i] = -sum / self.column(i)[i];
        }
        (0..=k).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())).unwrap_or(k)
    }
}

impl LinearSolver for DenseLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let n = self.pattern.size;
        self.lu.fill(0.0);
        self.pattern.spread(values, &mut self.lu);
        self.eliminate();
        for k in 0..n {
            let pivot = self.column(k)[k];
            if !pivot.is_finite() {
                return Err(Singular { unknown: k });
            }
            if pivot.abs() < crate::tolerances::ROUND_OFF {
                return Err(Singular { unknown: self.dependent_unknown(k) });
            }
        }
        Ok(())
    }

    fn inertia(&self, values: &[f64], known: usize) -> Inertia {
        MultifrontalLu::new(&self.pattern, 1).inertia(values, known)
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.pattern.size;
        let x = &mut self.permuted;
        for rhs in rhs.chunks_exact_mut(n.max(1)) {
            x.iter_mut().zip(&self.rows).for_each(|(x, &row)| *x = rhs[row]);
            for k in 0..n {
                let (column, known) = (&self.lu[k * n..][..n], x[k]);
                x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * known);
            }
            for k in (0..n).rev() {
                let column = &self.lu[k * n..][..n];
                x[k] /= column[k];
                let known = x[k];
                x[..k].iter_mut().zip(column).for_each(|(x, u)| *x -= u * known);
            }
            rhs.copy_from_slice(x);
        }
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        let n = self.pattern.size;
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for rhs in rhs.chunks_exact_mut(n.max(1)) {
            for k in 0..n {
                let column = self.column(k);
                rhs[k] = (rhs[k] - dot(&column[..k], &rhs[..k])) / column[k];
            }
            for k in (0..n).rev() {
                let column = self.column(k);
                rhs[k] -= dot(&column[k + 1..], &rhs[k + 1..]);
            }
            self.permuted.copy_from_slice(rhs);
            self.permuted.iter().zip(&self.rows).for_each(|(&x, &row)| rhs[row] = x);
        }
    }
}

/// Eliminates some columns, a few at a time; rows are exchanged in all columns.
struct Panel<'j> {
    lu: &'j mut [f64],
    rows: &'j mut [usize],
    size: usize,
    columns: Range<usize>,
}

impl Kernel for Panel<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Panel { lu, rows, size, columns } = self;
        let width = if size <= SMALL { PANEL } else { STRIP };
        for first in columns.clone().step_by(width) {
            let strip = first..(first + width).min(columns.end);
            for pivot in strip.clone() {
                let below = &lu[pivot * size + pivot..(pivot + 1) * size];
                let most = largest(below);
                // not a number at all: the pivot says so
                let row = pivot + below.iter().position(|value| value.abs() == most).unwrap_or(0);
                if row != pivot {
                    rows.swap(pivot, row);
                    lu.chunks_exact_mut(size).for_each(|column| column.swap(pivot, row));
                }
                eliminate_column::<FUSED>(&mut lu[..strip.end * size], size, pivot);
            }
            for column in strip.end..columns.end {
                subtract_few::<FUSED>(lu, size, strip.clone(), column);
            }
        }
    }
}
