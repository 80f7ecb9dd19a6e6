use std::sync::atomic::{AtomicBool, Ordering};
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
    /// Time spent on evaluations of the residual, on matrices, their factorization, and solutions \[ns\]; zero unless
    /// [`measure_phases`] asks for it.
    pub nanoseconds: [usize; 4],
}

static MEASURING: AtomicBool = AtomicBool::new(false);

/// Whether runs and sweeps of this process measure from now on what the parts of their steps take: [`Counters::nanoseconds`]. Looking at the clock
/// takes a share of the steps of small systems.
pub fn measure_phases(measuring: bool) {
    MEASURING.store(measuring, Ordering::Relaxed);
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
    /// What `work` returns; its time counts for a phase.
    #[inline]
    pub(crate) fn timed<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        if !MEASURING.load(Ordering::Relaxed) {
            return work();
        }
        let begun = Instant::now();
        let done = work();
        self.nanoseconds[phase as usize] += begun.elapsed().as_nanos() as usize;
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
        self.nanoseconds.iter_mut().zip(other.nanoseconds).for_each(|(own, other)| *own += other);
    }
}
