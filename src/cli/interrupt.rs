//! Ctrl-C: at once when there is nothing to lose, after the step in hand when there is.

use super::failure::{Failure, INTERRUPTED};
use costate::exchange::is_shared;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

const LEAVE_AT_ONCE: u8 = 0;
const FINISH_FIRST: u8 = 1;
const REQUESTED: u8 = 2;
/// Why it ends was told: what stops it from now on, as `mpirun` does once another rank has ended, adds nothing.
const TOLD: u8 = 3;

static STATE: AtomicU8 = AtomicU8::new(LEAVE_AT_ONCE);

/// The exit code of a program that has told why it ends.
static CODE: AtomicU8 = AtomicU8::new(INTERRUPTED);

/// What is still said before the program leaves at once: the line of JSON that was asked for.
static LAST_WORDS: Mutex<Option<String>> = Mutex::new(None);

/// Sets what is said on stdout if the program is stopped from now on.
pub fn set_last_words(words: Option<String>) {
    *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = words;
}

/// Ends without another word from now on, with the code of a failure that was told.
pub fn was_told(code: u8) {
    CODE.store(code, Ordering::SeqCst);
    STATE.store(TOLD, Ordering::SeqCst);
}

pub fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if STATE.load(Ordering::SeqCst) == TOLD {
            std::process::exit(CODE.load(Ordering::SeqCst).into());
        }
        // ranks would finish different steps, and wait for each other
        let first =
            !is_shared() && STATE.compare_exchange(FINISH_FIRST, REQUESTED, Ordering::SeqCst, Ordering::SeqCst).is_ok();
        if !first {
            if let Some(words) = LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner).take() {
                super::console::print(words);
            }
            // mpirun stops those that are left in the same way
            super::console::print_error(if is_shared() { "interrupted, or another rank has failed" } else { "interrupted" });
            std::process::exit(INTERRUPTED.into());
        }
    })
    .map_err(|error| Failure::run(format!("cannot listen for Ctrl-C: {error}")))
}

/// While it lives, a first Ctrl-C only asks to stop; a second one leaves at once.
pub struct Guard(());

impl Guard {
    pub fn new() -> Self {
        STATE.store(FINISH_FIRST, Ordering::SeqCst);
        Guard(())
    }

    /// True after Ctrl-C.
    pub fn requested(&self) -> bool {
        STATE.load(Ordering::Relaxed) == REQUESTED
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        STATE.store(LEAVE_AT_ONCE, Ordering::SeqCst);
    }
}
