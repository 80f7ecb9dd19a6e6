/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Systems solved: stages, projections, accelerations.
    pub systems: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Those of projections of coordinates and of velocities among them.
    pub projecting: [usize; 2],
    /// Evaluations of the residual of the whole model.
    pub residuals: usize,
    /// Jacobians assembled and factored.
    pub factorizations: usize,
    /// Solutions with a factored matrix, transposed or not.
    pub solves: usize,
    /// Transposed products with all elements (adjoint only).
    pub products: usize,
    /// Blocks of elements differentiated for matrices.
    pub blocks: usize,
    /// Times from which on other redundant constraint equations were left out.
    pub choices: usize,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.systems += other.systems;
        self.iterations += other.iterations;
        self.projecting.iter_mut().zip(other.projecting).for_each(|(own, other)| *own += other);
        self.residuals += other.residuals;
        self.factorizations += other.factorizations;
        self.solves += other.solves;
        self.products += other.products;
        self.blocks += other.blocks;
        self.choices += other.choices;
    }
}
