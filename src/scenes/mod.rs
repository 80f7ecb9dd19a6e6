//! Scenes: mechanisms as generic functions of their design variables.

mod builder;
mod differentiated_modes;
mod facets;
#[cfg(feature = "files")]
pub mod file;
mod file_bytes;
#[doc(hidden)]
pub mod fingerprint;
mod fit_problem;
#[doc(hidden)]
pub mod folder_name;
mod gmsh;
mod joint_ends;
mod mesh_data;
mod mode_measure;
mod optimization_problem;
mod periodic_modes;
mod prepared;
mod run;
mod scene;
mod signal;
mod sketch;
mod solid;
mod solids;
mod statics;
mod surfaces;
mod triangle_surface;
mod unknown;
mod violation;

#[cfg(feature = "files")]
pub mod built_in;

pub use crate::assembly::{ConstraintId, ElementId, NodeId};
pub use crate::design::DesignVariable;

#[doc(hidden)]
pub use builder::LineElement;
pub use builder::{
    BeamLine, BeamMember, BushingRates, CableLine, CableMember, ContactShape, DRILLING, Edge, Extrusion, Force, FreeMesh,
    MechanismBuilder, MeshedShell, Profile, ShellMember, ShellMesh, ShellPart, SoftLaw, SpringDamper, StopLaw, SurfaceMesh,
    ThinWalls, Torque,
};
pub use differentiated_modes::{DifferentiatedModes, ModeGradient};
#[cfg(feature = "files")]
pub use file::FileScene;
use file_bytes::file_bytes;
#[doc(hidden)]
pub use fingerprint::fingerprint;
pub(crate) use fingerprint::whole_number;
pub use fit_problem::{FitProblem, Loss, Measurement, Prior};
#[cfg(feature = "files")]
#[doc(hidden)]
pub use folder_name::check_folders;
#[doc(hidden)]
pub use folder_name::{COMPARISON, folder_name};
pub use gmsh::{parse_gmsh, read_gmsh};
pub use joint_ends::JointEnd;
pub use mesh_data::{FilePlace, MeshData};
pub use mode_measure::ModeMeasure;
#[doc(hidden)]
pub use mode_measure::check_modes;
pub use optimization_problem::{FunctionalConstraint, Limit, LinearConstraint, OptimizationProblem, Sense};
pub use periodic_modes::PeriodicModes;
pub use prepared::Prepared;
#[doc(hidden)]
pub use prepared::{OF_QUOTIENTS, SCATTER};
pub use run::{JointHistory, NodeHistory, Run, TimeSeries};
use scene::built;
pub use scene::{AnyScene, Output, Scenario, Scene, Settings};
pub use signal::Signal;
#[doc(hidden)]
pub use sketch::{Drawn, NodePoint, Sketch};
pub use solid::{Solid, SolidShape};
#[doc(hidden)]
pub use solids::Solids;
pub use statics::Equilibrium;
#[doc(hidden)]
pub use surfaces::Surface;
pub use triangle_surface::TriangleSurface;
#[doc(hidden)]
pub use unknown::unknown;
pub use violation::Violation;
