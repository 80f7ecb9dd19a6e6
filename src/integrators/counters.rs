use std::time::Instant;

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Systems solved: stages, projections, accelerations.
    pub systems: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Those of projections of coordinates and of velocities among them.
    pub projecting: [usize; 2],
    /// Evaluations of the residual; in a sweep only at nodes with constraints inside, whose multipliers follow from it.
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
    /// Time spent on evaluations of the residual, on matrices, their factorization, and solutions \[ns\]; measured where
    /// [`Method::measures_phases`](super::Method::measures_phases) asks for it.
    pub nanoseconds: Option<[usize; 4]>,
}

/// A part of a step whose time is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Residual,
    Matrix,
    Factorization,
    Solution,
}

impl Counters {
    /// Nothing done yet; with the time of phases or without.
    pub(crate) fn measuring(phases: bool) -> Self {
        Counters { nanoseconds: phases.then_some([0; 4]), ..Counters::default() }
    }

    /// What was done so far, which counts no more.
    pub(crate) fn handed_over(&mut self) -> Self {
        let emptied = Self::measuring(self.nanoseconds.is_some());
        std::mem::replace(self, emptied)
    }

    /// What `work` returns; its time counts for a phase.
    #[inline]
    pub(crate) fn timed<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let Some(nanoseconds) = &mut self.nanoseconds else { return work() };
        let begun = Instant::now();
        let done = work();
        nanoseconds[phase as usize] += begun.elapsed().as_nanos() as usize;
        done
    }
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
        if let Some(other) = other.nanoseconds {
            self.nanoseconds.get_or_insert_default().iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
    }
}
