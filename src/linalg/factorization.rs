use super::{DenseLu, LinearSolver, Singular, SparseLu};
use crate::assembly::SparsePattern;

/// Which solver factors the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Backend {
    /// Dense up to [`DENSE_LIMIT`] unknowns, sparse above.
    #[default]
    Automatic,
    /// Dense LU.
    Dense,
    /// Sparse LU.
    Sparse,
}

/// Largest number of unknowns for which the dense solver is chosen.
pub const DENSE_LIMIT: usize = 100;

/// Growth of a random vector under A^-1 (in the scaled matrix) beyond which the matrix counts as singular.
const SINGULAR_GROWTH: f64 = 1e14;

/// A factored matrix: scaled to rows and columns of size 1 by powers of two, with refinement against the matrix itself.
pub struct Factorization {
    pattern: SparsePattern,
    solver: Box<dyn LinearSolver>,
    scaled: Vec<f64>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    work: Vec<f64>,
    correction: Vec<f64>,
    checked: bool,
}

impl Factorization {
    /// Analyses a pattern.
    ///
    /// # Errors
    /// [`Singular`] if no values could make the pattern regular.
    pub fn new(pattern: &SparsePattern, backend: Backend) -> Result<Self, Singular> {
        let dense = match backend {
            Backend::Automatic => pattern.size <= DENSE_LIMIT,
            Backend::Dense => true,
            Backend::Sparse => false,
        };
        let solver: Box<dyn LinearSolver> =
            if dense { Box::new(DenseLu::new(pattern)) } else { Box::new(SparseLu::new(pattern)?) };
        let n = pattern.size;
        Ok(Factorization {
            pattern: pattern.clone(),
            solver,
            scaled: vec![0.0; pattern.rows.len()],
            row_scale: vec![1.0; n],
            column_scale: vec![1.0; n],
            work: vec![0.0; n],
            correction: vec![0.0; n],
            checked: false,
        })
    }

    /// Factors values given in the order of the pattern; the first ones are examined for singularity.
    ///
    /// # Errors
    /// [`Singular`] with the unknown that the matrix does not determine.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            let column = self.pattern.column_starts.partition_point(|&start| start <= place) - 1;
            return Err(Singular { unknown: column });
        }
        self.set_scales(values);
        for column in 0..self.pattern.size {
            for place in self.entries(column) {
                let factor = self.row_scale[self.pattern.rows[place]] * self.column_scale[column];
                self.scaled[place] = values[place] * factor;
            }
        }
        self.solver.factor(&self.scaled)?;
        if !self.checked {
            self.examine()?;
            self.checked = true;
        }
        Ok(())
    }

    /// Looks for a vector that A^-1 enlarges beyond all measure.
    ///
    /// # Errors
    /// [`Singular`] with the largest entry of that vector: the unknown that the matrix leaves free.
    pub fn examine(&mut self) -> Result<(), Singular> {
        // two steps of inverse iteration from a vector without symmetry
        let mut x: Vec<f64> = (0..self.pattern.size).map(|i| 1.0 + 0.3 * ((i * 7919 % 101) as f64 / 101.0)).collect();
        for _ in 0..2 {
            let norm = x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            x.iter_mut().for_each(|x| *x /= norm);
            self.solver.solve(&mut x);
            let largest = (0..x.len()).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs()));
            if let Some(unknown) = largest
                && !(x[unknown].abs() < SINGULAR_GROWTH)
            {
                return Err(Singular { unknown });
            }
        }
        Ok(())
    }

    /// Replaces b by A^-1 b.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        for (b, scale) in rhs.iter_mut().zip(&self.row_scale) {
            *b *= scale;
        }
        self.solver.solve(rhs);
        for (x, scale) in rhs.iter_mut().zip(&self.column_scale) {
            *x *= scale;
        }
    }

    /// Replaces b by A^-T b, refined once against the matrix: adjoint variables are not corrected by a later iteration.
    pub fn solve_transposed(&mut self, rhs: &mut [f64]) {
        for ((b, work), scale) in rhs.iter_mut().zip(&mut self.work).zip(&self.column_scale) {
            *b *= scale;
            *work = *b;
        }
        self.solver.solve_transposed(rhs);
        for column in 0..self.pattern.size {
            let product: f64 = self.entries(column).map(|place| self.scaled[place] * rhs[self.pattern.rows[place]]).sum();
            self.correction[column] = self.work[column] - product;
        }
        let mut correction = std::mem::take(&mut self.correction);
        self.solver.solve_transposed(&mut correction);
        for ((x, correction), scale) in rhs.iter_mut().zip(&correction).zip(&self.row_scale) {
            *x = (*x + correction) * scale;
        }
        self.correction = correction;
    }

    fn entries(&self, column: usize) -> std::ops::Range<usize> {
        self.pattern.column_starts[column]..self.pattern.column_starts[column + 1]
    }

    /// Powers of two that bring the largest entry of every row, then of every column, near 1.
    fn set_scales(&mut self, values: &[f64]) {
        let power = |largest: f64| if largest > 0.0 { (-largest.log2().round()).exp2() } else { 1.0 };
        self.row_scale.fill(0.0);
        for (&row, value) in self.pattern.rows.iter().zip(values) {
            self.row_scale[row] = self.row_scale[row].max(value.abs());
        }
        self.row_scale.iter_mut().for_each(|scale| *scale = power(*scale));
        for column in 0..self.pattern.size {
            let largest = self
                .entries(column)
                .map(|place| values[place].abs() * self.row_scale[self.pattern.rows[place]])
                .fold(0.0, f64::max);
            self.column_scale[column] = power(largest);
        }
    }
}
