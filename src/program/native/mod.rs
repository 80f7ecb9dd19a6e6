//! Machine code of a listing, for x86-64 and for aarch64 with Linux: one, two, four or eight elements at a time.
//!
//! | width | instructions | registers |
//! |---|---|---|
//! | [`Width::One`] | AVX, NEON | 16, with AVX-512 32, with NEON 23 |
//! | [`Width::Two`] | NEON | 23 |
//! | [`Width::Four`] | AVX2 | 16, with AVX-512 32 |
//! | [`Width::Eight`] | AVX-512 F, DQ, VL | 32 |
//!
//! The results have the bits of plain evaluation: nothing is contracted to fused multiply-add, and functions beyond
//! those that the processor has call what everything else calls. On other machines, and where the system refuses
//! executable memory, nothing is compiled and the loop ([`LoopCode`](super::loop_code::LoopCode)) serves.

/// Items for the machines for which code is made, and one for the others.
macro_rules! where_code_is_made {
    ({ $($item:item)* } else { $($other:item)* }) => {
        $(#[cfg(all(any(target_arch = "x86_64", all(target_arch = "aarch64", target_os = "linux")), not(miri)))] $item)*
        $(#[cfg(not(all(any(target_arch = "x86_64", all(target_arch = "aarch64", target_os = "linux")), not(miri))))] $other)*
    };
}

where_code_is_made! {
    {
        mod call;
        mod code;
        mod emitter;
        #[cfg_attr(target_arch = "aarch64", path = "neon_encoder.rs")]
        mod encoder;
        mod next_uses;
        #[cfg_attr(target_arch = "aarch64", path = "neon_operations.rs")]
        mod operations;
        mod storage;
        pub use code::NativeCode;
        #[cfg(test)]
        pub(super) use encoder::Level;
    } else {
        mod unavailable;
        pub use unavailable::NativeCode;
    }
}

/// How many elements are evaluated together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// One element.
    One,
    /// Two elements, their numbers side by side.
    Two,
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
            Width::Two => 2,
            Width::Four => 4,
            Width::Eight => 8,
        }
    }
}

impl NativeCode {
    /// The most elements that this machine evaluates together; none where no code is made.
    pub fn widest() -> Option<Width> {
        let listing = crate::program::listing::Listing::default();
        [Width::Eight, Width::Four, Width::Two, Width::One]
            .into_iter()
            .find(|&width| NativeCode::compile(&listing, width).is_some())
    }
}
