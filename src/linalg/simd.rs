//! Wide vector instructions, where the processor has them.

use super::vectors::{Instructions, VectorKernel, dispatch_vectors};

/// Work on lists of numbers. What `run` calls gains only where it is inlined: mark it `#[inline(always)]`.
pub trait Kernel {
    /// Its result.
    type Output;
    /// Does the work; `FUSED`: whether a product and a sum are one instruction, on x86-64 that of AVX2 and FMA.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs a kernel, compiled for the widest vectors that this processor has.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    dispatch_vectors(AnyVectors(kernel))
}

/// A kernel of which the compiler makes the vectors.
struct AnyVectors<K>(K);

impl<K: Kernel> VectorKernel for AnyVectors<K> {
    type Output = K::Output;
    #[inline(always)]
    fn run<I: Instructions>(self) -> K::Output {
        if I::FUSED { self.0.run::<true>() } else { self.0.run::<false>() }
    }
}

/// Whether kernels have registers of four numbers.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

/// Whether kernels have 32 registers of eight numbers.
#[inline]
pub fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        // each by itself: a virtual machine may hide one and show another
        std::arch::is_x86_feature_detected!("avx512f")
            && std::arch::is_x86_feature_detected!("avx512vl")
            && std::arch::is_x86_feature_detected!("fma")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

/// a b + c.
#[inline(always)]
pub fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Asks for the numbers of a cache line before they are read.
#[inline(always)]
pub fn prefetch(address: *const f64) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: nothing is read; an address without memory is ignored.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
