//! Elements with inertia, and the constraints inside the nodes of bodies.

mod euler_parameter_norm;
#[doc(hidden)]
pub mod inertia_tensor;
mod natural_body;
mod orthonormal_axes;
mod point_mass;
mod rigid_body;

pub use euler_parameter_norm::EulerParameterNorm;
pub use natural_body::NaturalBody;
pub(super) use natural_body::kinetic_of_vectors;
pub use orthonormal_axes::OrthonormalAxes;
pub use point_mass::PointMass;
pub use rigid_body::RigidBody;

use super::AnyElement;
use super::dyn_layer::instantiate_here;

instantiate_here!(dyn AnyElement: NaturalBody, PointMass, RigidBody);
