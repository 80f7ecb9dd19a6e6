//! Memory for machine code that the system does not give.

use std::sync::atomic::{AtomicBool, Ordering};

static REFUSED: AtomicBool = AtomicBool::new(false);

/// Whether the system has refused memory for machine code, so that programs are executed by the loop.
pub fn refuses_machine_code() -> bool {
    REFUSED.load(Ordering::Relaxed)
}

pub(super) fn memory_refused() {
    REFUSED.store(true, Ordering::Relaxed);
}
