//! Scenes: mechanisms as generic functions of their design variables.

mod builder;
mod prepared;
mod scene;
mod violation;

pub mod built_in;

pub use builder::{Drawing, MechanismBuilder};
pub use prepared::{Prepared, Settings};
pub use scene::{AnyScene, Scene};
pub use violation::Violation;
