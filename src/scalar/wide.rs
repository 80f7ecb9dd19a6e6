//! Wide vector instructions, where the processor has them.

/// Work on numbers with lanes. What `run` calls gains only where it is inlined: mark it, and the formulas in it, `#[inline(always)]`.
pub trait Job {
    /// Its result.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Runs a job, compiled for the widest vectors that this processor has: the same operations in the same order, and the same bits.
#[inline]
pub fn widest<J: Job>(job: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has the instructions.
            return unsafe { with_avx512(job) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { with_avx2(job) };
        }
    }
    job.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn with_avx512<J: Job>(job: J) -> J::Output {
    job.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<J: Job>(job: J) -> J::Output {
    job.run()
}
