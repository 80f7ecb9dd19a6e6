//! What the signs of a symmetric matrix say: Sylvester's law, with the constraints of its multipliers.

use super::Factorization;
use crate::linalg::{Inertia, SparseRow, sign_of_determinant};
use crate::tolerances;
use nalgebra::DMatrix;

/// Signs of the symmetric part of a matrix, and how far it is from the matrix itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signs {
    /// Numbers of its eigenvalues.
    pub inertia: Inertia,
    /// Whether entries and mirrored ones are the same but for round-off.
    pub is_symmetric: bool,
}

/// Difference of an entry and its mirrored one, in a matrix whose rows and columns have the size 1, up to which they count as equal.
const SYMMETRIC: f64 = 1e-8;
/// Unknowns up to which the sign of a determinant is looked for.
const MOST_UNKNOWNS: usize = 600;

impl Factorization {
    /// Signs of the symmetric part of the values, in the scales of what was factored last, from `first` on those of multipliers.
    pub fn signs(&self, values: &[f64], first: usize) -> Signs {
        let scale = |i: usize| if i < first { self.scaling.columns[i] } else { self.scaling.rows[i] };
        let mut symmetric = vec![0.0; values.len()];
        let mut is_symmetric = true;
        for column in 0..self.pattern.size {
            for place in self.entries(column) {
                let row = self.pattern.rows[place] as usize;
                let mirrored = self.pattern.position(column, row).map_or(0.0, |mirrored| values[mirrored]);
                let own = values[place];
                let scale = scale(row) * scale(column);
                is_symmetric &= (own - mirrored).abs() * scale <= SYMMETRIC;
                symmetric[place] = 0.5 * (own + mirrored) * scale;
            }
        }
        Signs { inertia: self.solver.inertia(&symmetric, self.pattern.size - first), is_symmetric }
    }

    /// Sign of the determinant of the values; `None` of large matrices, and of those that round-off might make singular.
    pub fn determinant_sign(&self, values: &[f64]) -> Option<f64> {
        let size = self.pattern.size;
        let mut scaled = vec![0.0; values.len()];
        self.scaling.apply(values, &mut scaled);
        let mut columns = vec![0.0; if size > MOST_UNKNOWNS { return None } else { size * size }];
        self.pattern.spread(&scaled, &mut columns);
        let matrix = DMatrix::from_column_slice(size, size, &columns);
        let norm =
            |matrix: &DMatrix<f64>| matrix.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
        let round_off = tolerances::FACTORIZATION * size as f64 * norm(&matrix);
        let inverse = matrix.try_inverse().map_or(f64::INFINITY, |inverse| norm(&inverse));
        // that of the transpose is the same
        let column = |column: usize| self.entries(column).map(|place| (self.pattern.rows[place] as usize, scaled[place]));
        let columns: Vec<SparseRow> = (0..size).map(|own| column(own).collect()).collect();
        (round_off * inverse < 1.0).then(|| sign_of_determinant(&columns)).filter(|sign| *sign != 0.0)
    }
}
