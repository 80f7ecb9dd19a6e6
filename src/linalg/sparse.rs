use super::{LinearSolver, Singular};
use crate::linalg::SparsePattern;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par};

/// Sparse LU with partial pivoting and a column ordering found once: for chains and small meshes.
pub struct SparseLu {
    pattern: SparsePattern,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl SparseLu {
    /// Orders and analyses a pattern.
    ///
    /// # Errors
    /// [`Singular`] if the pattern itself has no full set of pivots.
    pub fn new(pattern: &SparsePattern) -> Result<Self, Singular> {
        let view =
            SymbolicSparseColMatRef::new_checked(pattern.size, pattern.size, &pattern.column_starts, None, &pattern.rows);
        let symbolic = factorize_symbolic_lu(view, Default::default()).map_err(|_| Singular { unknown: 0 })?;
        let memory = StackReq::any_of(&[
            symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            symbolic.solve_transpose_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let memory = MemBuffer::new(memory);
        Ok(SparseLu { pattern: pattern.clone(), symbolic, numeric: NumericLu::new(), memory })
    }
}

impl LinearSolver for SparseLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let n = self.pattern.size;
        let pattern = &self.pattern;
        let symbolic = SymbolicSparseColMatRef::new_checked(n, n, &pattern.column_starts, None, &pattern.rows);
        let matrix = SparseColMatRef::new(symbolic, values);
        let memory = MemStack::new(&mut self.memory);
        use faer::sparse::linalg::LuError;
        match self.symbolic.factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, memory, Default::default()) {
            Ok(_) => Ok(()),
            Err(LuError::SymbolicSingular { index }) => Err(Singular { unknown: index }),
            Err(LuError::Generic(_)) => Err(Singular { unknown: 0 }),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let rhs = faer::ColMut::from_slice_mut(rhs).as_mat_mut();
        let lu = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        lu.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut self.memory));
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        let rhs = faer::ColMut::from_slice_mut(rhs).as_mat_mut();
        let lu = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        lu.solve_transpose_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut self.memory));
    }
}
