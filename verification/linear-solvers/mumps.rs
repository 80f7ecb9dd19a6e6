use super::Foreign;
use super::patterns::Matrix;
use costate::linalg::{LinearSolver, MultifrontalLu, MumpsLu};

/// MUMPS on one thread, with METIS where its library has that: what others are measured by.
pub struct Mumps {
    pub lu: MumpsLu,
    values: Vec<f64>,
}

impl Mumps {
    /// Analyses the pattern of a matrix, of which the own solver has been made.
    ///
    /// # Errors
    /// A pattern that no values make regular.
    pub fn new(matrix: &Matrix, own: MultifrontalLu) -> Result<Self, String> {
        let lu = MumpsLu::new(&matrix.pattern, own).map_err(|singular| format!("{singular:?}"))?;
        Ok(Mumps { lu, values: matrix.values.clone() })
    }
}

impl Foreign for Mumps {
    fn factor(&mut self) -> Result<(), String> {
        self.lu.factor(&self.values).map_err(|singular| format!("{singular:?}"))
    }

    fn solve(&mut self, transposed: bool, rhs: &mut [f64]) -> Result<(), String> {
        if transposed {
            self.lu.solve_transposed(rhs)
        } else {
            self.lu.solve(rhs)
        }
        Ok(())
    }
}
