//! Andrews' squeezer of the example.

// its `main` is not called here
#[allow(dead_code)]
#[path = "../examples/06_andrews.rs"]
mod example;

pub use example::{Andrews, PUBLISHED, START};
