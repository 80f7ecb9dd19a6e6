//! Flexible elements, as formulas at points of interpolated fields. A new one is a file here and a line in this list.

pub(crate) mod beam;
pub(crate) mod beam_gravity;
pub(crate) mod cable;
pub(crate) mod cable_gravity;
pub(crate) mod cable_inertia;
mod cable_section;
pub(crate) mod distributed_load;
#[doc(hidden)]
pub mod faces;
pub(crate) mod hermite;
mod laminate;
mod outline;
mod outline_stress;
pub(crate) mod section;
pub(crate) mod shape;
pub(crate) mod shell;
pub(crate) mod shell_pressure;
pub(crate) mod small_strain_cable;

pub(crate) use beam::{Beam, BeamField, STRAINS, TYING_POINTS};
pub(crate) use beam_gravity::{BeamGravity, BeamGravityField};
pub(crate) use cable::{Cable, GRAVITY};
pub(crate) use cable_gravity::CableGravity;
pub(crate) use cable_inertia::CableInertia;
pub use cable_section::{CableSection, CableStrain};
pub(crate) use distributed_load::DistributedLoad;
pub use faces::FaceKind;
pub use laminate::{Laminate, Ply, PlyStrength};
pub use outline::Outline;
pub use outline_stress::OutlineStress;
pub(crate) use section::{MATERIAL, MATERIAL_KEYS, OfShape, SECTION};
pub use section::{Material, Section, Shape};
pub(crate) use shell::Shell;
pub use shell::{ShellKind, ShellSection};
pub(crate) use shell_pressure::{PressureOnFace, ShellPressure};
pub(crate) use small_strain_cable::{SmallStrainCable, SmallStrainCableField};

use super::AnyElement;
use super::dyn_layer::instantiate_here;
use faces::{Quad4, Quad9, Triangle6};

instantiate_here!(dyn AnyElement: Beam, BeamGravity, Cable, CableGravity, CableInertia, DistributedLoad, SmallStrainCable);
instantiate_here!(dyn AnyElement: Shell<Quad4>, Shell<Quad9>, Shell<Triangle6>);
instantiate_here!(dyn AnyElement: ShellPressure<Quad4>, ShellPressure<Quad9>, ShellPressure<Triangle6>);
