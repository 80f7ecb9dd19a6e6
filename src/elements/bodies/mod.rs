//! Elements with inertia, and the constraint inside a body node.

mod euler_parameter_norm;
mod point_mass;
mod rigid_body;

pub use euler_parameter_norm::EulerParameterNorm;
pub use point_mass::PointMass;
pub use rigid_body::RigidBody;

use super::AnyElement;
use super::erased::compiled_here;

compiled_here!(dyn AnyElement: PointMass, RigidBody);
