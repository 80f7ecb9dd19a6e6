//! Flexible elements, as formulas at points of interpolated fields. A new one is a file here and a line in this list.

mod beam;
mod beam_gravity;
mod beam_matrix;
mod beam_products;
mod distributed_load;
pub mod section;
pub mod shape;

pub use beam::{Beam, BeamField, STRAINS, TYING_POINTS};
pub use beam_gravity::{BeamGravity, BeamGravityField};
pub use distributed_load::{DistributedLoad, DistributedLoadField};
pub use section::{Material, Section};

use super::AnyElement;
use super::erased::compiled_here;

compiled_here!(dyn AnyElement: Beam, BeamGravity, DistributedLoad);
