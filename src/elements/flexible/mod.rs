//! Flexible elements, as formulas at points of interpolated fields. A new one is a file here and a line in this list.

mod beam;
mod beam_gravity;
mod cable;
mod cable_gravity;
mod cable_inertia;
mod cable_section;
mod distributed_load;
pub mod faces;
pub mod hermite;
mod laminate;
mod outline;
mod outline_stress;
pub mod section;
pub mod shape;
mod shell;
mod shell_pressure;
mod small_strain_cable;

pub use beam::{Beam, BeamField, STRAINS, TYING_POINTS};
pub use beam_gravity::{BeamGravity, BeamGravityField};
pub use cable::Cable;
pub(crate) use cable::GRAVITY;
pub use cable_gravity::CableGravity;
pub use cable_inertia::CableInertia;
pub use cable_section::{CableSection, CableStrain};
pub use distributed_load::{DistributedLoad, DistributedLoadField};
pub use laminate::{Laminate, Ply, PlyStrength};
pub use outline::Outline;
pub use outline_stress::OutlineStress;
pub use section::{Material, Section};
pub use shell::{DRILLING_INERTIA, Shell, ShellField, ShellKind, ShellPoint, ShellSection};
pub(crate) use shell_pressure::shell_pressure;
pub use shell_pressure::{ShellPressure, ShellPressureField};
pub use small_strain_cable::{SmallStrainCable, SmallStrainCableField};

use super::AnyElement;
use super::dyn_layer::instantiate_here;
use faces::{Quad4, Quad9, Triangle6};

instantiate_here!(dyn AnyElement: Beam, BeamGravity, Cable, CableGravity, CableInertia, DistributedLoad, SmallStrainCable);
instantiate_here!(dyn AnyElement: Shell<Quad4>, Shell<Quad9>, Shell<Triangle6>);
instantiate_here!(dyn AnyElement: ShellPressure<Quad4>, ShellPressure<Quad9>, ShellPressure<Triangle6>);
