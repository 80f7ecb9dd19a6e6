//! What the tests and studies of this repository reach into: no promise to anyone, and the whole list; parts are listed in
//! their folders.

pub use crate::assembly::{
    Equations, Jacobian, Level, Model, PartPrograms, Residual, StageCoefficients, StageSystem, System, SystemOptions,
    VectorsAvq,
};
pub use crate::design::{DesignMap, ModelNumbers};
pub use crate::elements::bodies::{EulerParameterNorm, NaturalBody, OrthonormalAxes, PointMass, RigidBody};
pub use crate::elements::dyn_layer::{ConstraintPhysics, ElementPhysics, RunScalar, motion_derivatives};
pub use crate::elements::flexible::{
    beam::BeamField, beam::STRAINS, beam_gravity::BeamGravityField, cable::Cable, cable_gravity::CableGravity,
    cable_inertia::CableInertia, distributed_load::DistributedLoadField, faces::Face, faces::NODE_PARAMETERS, faces::Quad4,
    faces::Quad9, faces::Triangle6, hermite::values as hermite_values, shape::AT_GAUSS_POINTS, shape::AT_TYING_POINTS,
    shape::TWO, shell::Shell, shell::ShellField, shell_pressure::ShellPressureField,
    small_strain_cable::SmallStrainCableField,
};
pub use crate::elements::forces::types::*;
pub use crate::elements::joints::types::*;
pub use crate::exchange::{Traffic, of_all_ranks, traffic};
pub use crate::functionals::quantities::types::*;
pub use crate::functionals::{
    element_sum::ElementSum, functional::Measured, load::JointLoad, measured_group::MeasuredGroup,
    quantity::MeasuredQuantity, weights::QuadratureWeights,
};
pub use crate::history::{checkpoints::Checkpoints, file::FileHistory, nothing::Nothing, rerun::Rerun};
pub use crate::integrators::{
    adaptive::march_adaptive, given::march, given::march_dividing, march::Problem, march::Run, tables::table_named,
};
pub use crate::linalg::factorization::{Factorization, SolverPlan, TransposedSolution, Work};
pub use crate::linalg::{own_unknowns::OwnUnknowns, owners::Owners};
#[cfg(feature = "files")]
pub use crate::program::Replay;
pub use crate::program::{
    ArgumentKind, Codes, Formula, Graph, Node, Program, ProgramWork, Reads, Recorded, formulas_made, lanes, making_time,
    record,
};
pub use crate::scalar::{moving::Moving, rotation::tensor_times};
