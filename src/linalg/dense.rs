// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::{LinearSolver, Singular};
use crate::linalg::SparsePattern;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::{Mat, Par};

/// Dense LU with partial pivoting: for up to about a hundred unknowns, where plain loops solve faster than blocked kernels.
pub struct DenseLu {
    pattern: SparsePattern,
    lu: Mat<f64>,
    rows: Vec<usize>,
    rows_inverse: Vec<usize>,
    permuted: Vec<f64>,
    memory: MemBuffer,
}

/// Pivots smaller than this, in a matrix whose rows and columns have the size 1, are taken for zero.
const TINY_PIVOT: f64 = 1e-14;

impl DenseLu {
    /// Workspace for a pattern.
    pub fn new(pattern: &SparsePattern) -> Self {
        let n = pattern.size;
        let memory = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        DenseLu {
            pattern: pattern.clone(),
            lu: Mat::zeros(n, n),
            rows: vec![0; n],
            rows_inverse: vec![0; n],
            permuted: vec![0.0; n],
            memory: MemBuffer::new(memory),
        }
    }

    /// The unknown that dominates the null vector belonging to the vanishing pivot `k`: U x = 0 with x_k = 1.
    fn dependent_unknown(&self, k: usize) -> usize {
        let mut x = vec![0.0; k + 1];
        x[k] = 1.0;
        for i in (0..k).rev() {
            let sum: f64 = (i + 1..=k).map(|j| self.lu[(i, j)] * x[j]).sum();
            x[i] = -sum / self.lu[(i, i)];
        }
        (0..=k).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())).unwrap_or(k)
    }
}

impl LinearSolver for DenseLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let n = self.pattern.size;
        self.lu.fill(0.0);
        for column in 0..n {
            for place in self.pattern.column_starts[column]..self.pattern.column_starts[column + 1] {
                self.lu[(self.pattern.rows[place], column)] = values[place];
            }
        }
        factor::lu_in_place(
            self.lu.as_mut(),
            &mut self.rows,
            &mut self.rows_inverse,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        for k in 0..n {
            let pivot = self.lu[(k, k)];
            if !pivot.is_finite() {
                return Err(Singular { unknown: k });
            }
            if pivot.abs() < TINY_PIVOT {
                return Err(Singular { unknown: self.dependent_unknown(k) });
            }
        }
        Ok(())
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.pattern.size;
        let x = &mut self.permuted;
        x.iter_mut().zip(&self.rows).for_each(|(x, &row)| *x = rhs[row]);
        for k in 0..n {
            let (column, known) = (self.lu.col_as_slice(k), x[k]);
            x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * known);
        }
        for k in (0..n).rev() {
            let column = self.lu.col_as_slice(k);
            x[k] /= column[k];
            let known = x[k];
            x[..k].iter_mut().zip(column).for_each(|(x, u)| *x -= u * known);
        }
        rhs.copy_from_slice(x);
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        let n = self.pattern.size;
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for k in 0..n {
            let column = self.lu.col_as_slice(k);
            rhs[k] = (rhs[k] - dot(&column[..k], &rhs[..k])) / column[k];
        }
        for k in (0..n).rev() {
            let column = self.lu.col_as_slice(k);
            rhs[k] -= dot(&column[k + 1..], &rhs[k + 1..]);
        }
        self.permuted.copy_from_slice(rhs);
        self.permuted.iter().zip(&self.rows).for_each(|(&x, &row)| rhs[row] = x);
    }
}
