//! Machine code of a listing, for x86-64: one, four or eight elements at a time.
//!
//! | width | instructions | registers |
//! |---|---|---|
//! | [`Width::One`] | AVX | 16, with AVX-512 32 |
//! | [`Width::Four`] | AVX2 | 16, with AVX-512 32 |
//! | [`Width::Eight`] | AVX-512 F, DQ, VL | 32 |
//!
//! The results have the bits of plain evaluation: nothing is contracted to fused multiply-add, and functions beyond
//! those that the processor has call what everything else calls. On other machines, and where the system refuses
//! executable memory, nothing is compiled and the loop ([`LoopCode`](super::loop_code::LoopCode)) serves.

#[cfg(all(target_arch = "x86_64", not(miri)))]
mod call;
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod code;
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod emitter;
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod encoder;
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod next_uses;
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod storage;
#[cfg(all(target_arch = "x86_64", not(miri)))]
pub use code::NativeCode;
#[cfg(all(test, target_arch = "x86_64", not(miri)))]
pub(super) use encoder::Level;

#[cfg(not(all(target_arch = "x86_64", not(miri))))]
mod unavailable;
#[cfg(not(all(target_arch = "x86_64", not(miri))))]
pub use unavailable::NativeCode;

/// How many elements are evaluated together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// One element.
    One,
    /// Four elements, their numbers side by side.
    Four,
    /// Eight elements, their numbers side by side.
    Eight,
}

impl Width {
    /// Number of elements.
    pub fn lanes(self) -> usize {
        match self {
            Width::One => 1,
            Width::Four => 4,
            Width::Eight => 8,
        }
    }
}

impl NativeCode {
    /// The most elements that this machine evaluates together; none where no code is made.
    pub fn widest() -> Option<Width> {
        let listing = crate::program::Listing::default();
        [Width::Eight, Width::Four, Width::One].into_iter().find(|&width| NativeCode::compile(&listing, width).is_some())
    }
}
