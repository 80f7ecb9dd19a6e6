//! costate
pub mod scalar;
pub mod elements;
pub mod assembly;
pub mod io;
