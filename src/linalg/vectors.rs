//! Vectors of four numbers and pairs of them, for kernels whose registers and instructions matter: from arrays a
//! compiler makes these only in simple loops.

// a vector of an instruction set exists only where its kernel runs, on a processor that has the set
#![allow(clippy::missing_safety_doc)]
// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

#[cfg(target_arch = "x86_64")]
use super::simd::{has_avx2, has_avx512};

/// Numbers that are worked on together.
pub trait Vector: Copy {
    /// How many they are.
    const LANES: usize;
    /// All lanes equal.
    fn splat(value: f64) -> Self;
    /// From memory; the numbers have to be there.
    unsafe fn load(from: *const f64) -> Self;
    /// To memory; there has to be room.
    unsafe fn store(self, to: *mut f64);
    /// self - a b; of numbers of vectors: [`Instructions::minus_product`].
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// self b
    fn times(self, b: Self) -> Self;
    /// self + b
    fn plus(self, b: Self) -> Self;
    /// The lane `P` in all lanes.
    fn broadcast<const P: usize>(self) -> Self;
    /// The bits that are in a mask too, from memory; it has to have as many lanes.
    unsafe fn masked(self, mask: *const u64) -> Self;
}

/// A set of vector instructions.
pub trait Instructions {
    /// Whether a product and a sum are one instruction.
    const FUSED: bool;
    /// Eight numbers.
    type Eight: Vector;
    /// Four numbers.
    type Four: Vector;
    /// The rows of a matrix of four columns.
    fn transpose(columns: [Self::Four; 4]) -> [Self::Four; 4];
    /// Largest absolute value in some vectors, not counting what is not a number.
    fn largest<const N: usize>(x: &[Self::Four; N]) -> f64;
    /// a - b c, as the lanes of vectors.
    #[inline(always)]
    fn minus_product(a: f64, b: f64, c: f64) -> f64 {
        if Self::FUSED { b.mul_add(-c, a) } else { a - b * c }
    }
}

/// Work on vectors. What `run` calls has to be inlined: mark it `#[inline(always)]`.
pub trait VectorKernel {
    /// Its result.
    type Output;
    /// Does the work.
    fn run<I: Instructions>(self) -> Self::Output;
}

/// Runs a kernel with vectors of four numbers, where the processor has them, and with 32 registers for them, where it
/// has those: fronts are too small for vectors of eight, whose loads and stores wait for each other longer.
#[inline]
pub fn dispatch_vectors<K: VectorKernel>(kernel: K) -> K::Output {
    #[cfg(test)]
    if ONLY_PORTABLE.get() {
        return kernel.run::<Portable>();
    }
    #[cfg(target_arch = "x86_64")]
    {
        if has_avx512() {
            // SAFETY: the processor has all instructions that the function is compiled for.
            return unsafe { x86::with_avx512(kernel) };
        }
        if has_avx2() {
            // SAFETY: as above.
            return unsafe { x86::with_avx2(kernel) };
        }
    }
    kernel.run::<Portable>()
}

#[cfg(test)]
thread_local! {
    /// Whether tests of this thread do without the vectors of the processor.
    pub static ONLY_PORTABLE: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// The sums of the lanes of four vectors of eight, halves first.
///
/// # Safety
/// With `FUSED` it is part of a kernel with fused products, on a processor that has AVX2.
#[inline(always)]
pub unsafe fn sums_of_lanes<const FUSED: bool>(vectors: &[[f64; 8]; 4]) -> [f64; 4] {
    #[cfg(target_arch = "x86_64")]
    if FUSED {
        return sums_with::<x86::Avx2>(vectors);
    }
    sums_with::<Portable>(vectors)
}

#[inline(always)]
fn sums_with<I: Instructions>(vectors: &[[f64; 8]; 4]) -> [f64; 4] {
    let mut sums = [0.0; 4];
    // SAFETY: eight numbers in each vector, four of the sums.
    unsafe {
        let mut halves = [I::Four::splat(0.0); 4];
        for v in 0..4 {
            halves[v] = I::Four::load(vectors[v].as_ptr()).plus(I::Four::load(vectors[v].as_ptr().add(4)));
        }
        let [first, second, third, fourth] = I::transpose(halves);
        first.plus(third).plus(second.plus(fourth)).store(sums.as_mut_ptr());
    }
    sums
}

/// What every processor has.
struct Portable;

impl Instructions for Portable {
    const FUSED: bool = false;
    type Eight = Array<8>;
    type Four = Array<4>;
    #[inline(always)]
    fn transpose(columns: [Array<4>; 4]) -> [Array<4>; 4] {
        let mut rows = columns;
        for row in 0..4 {
            for column in 0..4 {
                rows[row].0[column] = columns[column].0[row];
            }
        }
        rows
    }
    #[inline(always)]
    fn largest<const N: usize>(x: &[Array<4>; N]) -> f64 {
        let lanes = x.iter().flat_map(|x| x.0.map(f64::abs));
        lanes.fold(0.0, |most, lane| if lane > most { lane } else { most })
    }
}

#[derive(Clone, Copy)]
struct Array<const N: usize>([f64; N]);

impl<const N: usize> Vector for Array<N> {
    const LANES: usize = N;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Array([value; N])
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: promised by the caller.
        Array(unsafe { *from.cast() })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: promised by the caller.
        unsafe { *to.cast() = self.0 }
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Array(std::array::from_fn(|lane| self.0[lane] - a.0[lane] * b.0[lane]))
    }
    #[inline(always)]
    fn times(self, b: Self) -> Self {
        Array(std::array::from_fn(|lane| self.0[lane] * b.0[lane]))
    }
    #[inline(always)]
    fn plus(self, b: Self) -> Self {
        Array(std::array::from_fn(|lane| self.0[lane] + b.0[lane]))
    }
    #[inline(always)]
    fn broadcast<const P: usize>(self) -> Self {
        Array([self.0[P % N]; N])
    }
    #[inline(always)]
    unsafe fn masked(self, mask: *const u64) -> Self {
        // SAFETY: promised by the caller.
        let mask: [u64; N] = unsafe { *mask.cast() };
        Array(std::array::from_fn(|lane| f64::from_bits(self.0[lane].to_bits() & mask[lane])))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Instructions, Vector, VectorKernel};
    use std::arch::x86_64::*;

    #[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
    pub fn with_avx512<K: VectorKernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }

    #[target_feature(enable = "avx2,fma")]
    pub fn with_avx2<K: VectorKernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }

    pub struct Avx2;
    impl Instructions for Avx2 {
        const FUSED: bool = true;
        type Eight = Pair;
        type Four = Ymm;
        #[inline(always)]
        fn transpose([a, b, c, d]: [Ymm; 4]) -> [Ymm; 4] {
            // SAFETY: as below.
            unsafe {
                let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Ymm(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                    Ymm(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                    Ymm(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                    Ymm(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
                ]
            }
        }
        #[inline(always)]
        fn largest<const N: usize>(x: &[Ymm; N]) -> f64 {
            // SAFETY: as below.
            unsafe {
                let mut most = _mm256_setzero_pd();
                for x in x {
                    // of what is not a number, the second one
                    most = _mm256_max_pd(_mm256_andnot_pd(_mm256_set1_pd(-0.0), x.0), most);
                }
                let half = _mm_max_pd(_mm256_castpd256_pd128(most), _mm256_extractf128_pd::<1>(most));
                _mm_cvtsd_f64(_mm_max_sd(half, _mm_unpackhi_pd(half, half)))
            }
        }
    }

    #[derive(Clone, Copy)]
    pub struct Ymm(__m256d);

    // SAFETY of all calls: vectors exist only where a kernel runs, on a processor that has the instructions
    #[allow(clippy::undocumented_unsafe_blocks)]
    impl Vector for Ymm {
        const LANES: usize = 4;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Ymm(unsafe { _mm256_set1_pd(value) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            Ymm(unsafe { _mm256_loadu_pd(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm256_storeu_pd(to, self.0) }
        }
        #[inline(always)]
        fn minus_product(self, a: Self, b: Self) -> Self {
            Ymm(unsafe { _mm256_fnmadd_pd(a.0, b.0, self.0) })
        }
        #[inline(always)]
        fn times(self, b: Self) -> Self {
            Ymm(unsafe { _mm256_mul_pd(self.0, b.0) })
        }
        #[inline(always)]
        fn plus(self, b: Self) -> Self {
            Ymm(unsafe { _mm256_add_pd(self.0, b.0) })
        }
        #[inline(always)]
        fn broadcast<const P: usize>(self) -> Self {
            Ymm(unsafe {
                match P {
                    0 => _mm256_permute4x64_pd::<0x00>(self.0),
                    1 => _mm256_permute4x64_pd::<0x55>(self.0),
                    2 => _mm256_permute4x64_pd::<0xaa>(self.0),
                    _ => _mm256_permute4x64_pd::<0xff>(self.0),
                }
            })
        }
        #[inline(always)]
        unsafe fn masked(self, mask: *const u64) -> Self {
            Ymm(unsafe { _mm256_and_pd(self.0, _mm256_loadu_pd(mask.cast())) })
        }
    }

    #[derive(Clone, Copy)]
    pub struct Pair(Ymm, Ymm);

    impl Vector for Pair {
        const LANES: usize = 8;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Pair(Ymm::splat(value), Ymm::splat(value))
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            // SAFETY: promised by the caller.
            unsafe { Pair(Ymm::load(from), Ymm::load(from.add(4))) }
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            // SAFETY: promised by the caller.
            unsafe {
                self.0.store(to);
                self.1.store(to.add(4));
            }
        }
        #[inline(always)]
        fn minus_product(self, a: Self, b: Self) -> Self {
            Pair(self.0.minus_product(a.0, b.0), self.1.minus_product(a.1, b.1))
        }
        #[inline(always)]
        fn times(self, b: Self) -> Self {
            Pair(self.0.times(b.0), self.1.times(b.1))
        }
        #[inline(always)]
        fn plus(self, b: Self) -> Self {
            Pair(self.0.plus(b.0), self.1.plus(b.1))
        }
        #[inline(always)]
        fn broadcast<const P: usize>(self) -> Self {
            let half = if P < 4 { self.0 } else { self.1 };
            let all = match P % 4 {
                0 => half.broadcast::<0>(),
                1 => half.broadcast::<1>(),
                2 => half.broadcast::<2>(),
                _ => half.broadcast::<3>(),
            };
            Pair(all, all)
        }
        #[inline(always)]
        unsafe fn masked(self, mask: *const u64) -> Self {
            // SAFETY: promised by the caller.
            unsafe { Pair(self.0.masked(mask), self.1.masked(mask.add(4))) }
        }
    }
}
