//! Numbers that a motion is judged by: quantities at a time, and what is made of them over time.

mod functional;
mod load;
mod quantity;
mod reactions;
mod values;
mod weights;

pub mod quantities;

pub use functional::{Functional, Measured, Member, Over, Sample};
pub use load::{JointLoad, LoadKind};
pub use quantity::{AnyQuantity, MeasuredQuantity, Quantity};
pub use reactions::least_multipliers;
pub use values::Values;
pub use weights::QuadratureWeights;
