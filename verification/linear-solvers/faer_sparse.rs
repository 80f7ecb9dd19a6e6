//! faer's sparse LU, to compare with.

use super::Foreign;
use super::patterns::Matrix;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par};

/// Sparse LU with partial pivoting and a column ordering found once.
pub struct FaerSparse<'m> {
    matrix: &'m Matrix,
    /// Rows of its entries, in the width that faer asks for.
    rows: Vec<usize>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

fn view<'m>(matrix: &'m Matrix, rows: &'m [usize]) -> SymbolicSparseColMatRef<'m, usize> {
    let pattern = &matrix.pattern;
    SymbolicSparseColMatRef::new_checked(pattern.size, pattern.size, &pattern.column_starts, None, rows)
}

impl<'m> FaerSparse<'m> {
    /// Orders and analyses the pattern of a matrix.
    ///
    /// # Errors
    /// In words, with the error of faer.
    pub fn new(matrix: &'m Matrix) -> Result<Self, String> {
        let rows: Vec<usize> = matrix.pattern.rows.iter().map(|&row| row as usize).collect();
        let symbolic = factorize_symbolic_lu(view(matrix, &rows), Default::default());
        let symbolic = symbolic.map_err(|error| format!("faer: {error:?}"))?;
        let memory = StackReq::any_of(&[
            symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            symbolic.solve_transpose_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        Ok(FaerSparse { matrix, rows, symbolic, numeric: NumericLu::new(), memory: MemBuffer::new(memory) })
    }
}

impl Foreign for FaerSparse<'_> {
    fn factor(&mut self) -> Result<(), String> {
        let matrix = SparseColMatRef::new(view(self.matrix, &self.rows), &self.matrix.values);
        let memory = MemStack::new(&mut self.memory);
        let factored = self.symbolic.factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, memory, Default::default());
        factored.map(|_| ()).map_err(|error| format!("faer: {error:?}"))
    }

    fn solve(&mut self, transposed: bool, rhs: &mut [f64]) -> Result<(), String> {
        let rhs = faer::ColMut::from_slice_mut(rhs).as_mat_mut();
        let lu = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        let memory = MemStack::new(&mut self.memory);
        if transposed {
            lu.solve_transpose_in_place_with_conj(Conj::No, rhs, Par::Seq, memory);
        } else {
            lu.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, memory);
        }
        Ok(())
    }
}
