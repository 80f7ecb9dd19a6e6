//! Machine code of a listing, for x86-64 and for aarch64 with Linux: one, two, four or eight elements at a time.
//!
//! | elements | instructions | registers |
//! |---|---|---|
//! | 1 | AVX, NEON | 16, with AVX-512 32, with NEON 23 |
//! | 2 | NEON | 23 |
//! | 4 | AVX2 | 16, with AVX-512 32 |
//! | 8 | AVX-512 F, DQ, VL | 32 |
//!
//! The results have the bits of plain evaluation: nothing is contracted to fused multiply-add, and functions beyond
//! those that the processor has call what everything else calls. On other machines, and where the system refuses
//! executable memory, nothing is compiled and the loop ([`LoopCode`](super::loop_code::LoopCode)) serves.

use std::sync::atomic::{AtomicBool, Ordering};

static REFUSED: AtomicBool = AtomicBool::new(false);

/// Whether the system has refused memory for machine code, so that programs are executed by the loop.
pub fn refuses_machine_code() -> bool {
    REFUSED.load(Ordering::Relaxed)
}

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

impl NativeCode {
    /// The most elements that this machine evaluates together; none where no code is made.
    pub fn most_lanes() -> Option<usize> {
        let listing = crate::listing::Listing::default();
        [8, 4, 2, 1].into_iter().find(|&lanes| NativeCode::compile(&listing, lanes).is_some())
    }
}
