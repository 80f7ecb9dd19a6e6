//! costate
pub mod assembly;
pub mod design;
pub mod elements;
pub mod functionals;
pub mod history;
pub mod integrators;
pub mod io;
pub mod linalg;
pub mod scalar;
pub mod scenes;
pub mod sensitivity;
