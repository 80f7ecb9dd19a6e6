//! Numbers that a motion is judged by: quantities at a time, and what is made of them over time.

mod aggregate;
mod beam_quantity;
mod element_group;
pub(crate) mod element_sum;
mod extremes;
pub(crate) mod functional;
mod gradient;
mod kinematic_loops;
mod law;
pub(crate) mod load;
pub(crate) mod measured_group;
mod over;
mod point_quantity;
pub(crate) mod quantity;
mod reactions;
mod refused;
mod run_parameters;
mod shell_quantity;
mod step_ends;
mod values;
pub(crate) mod weights;

pub mod quantities;

pub use aggregate::{Aggregate, AggregateKind};
pub(crate) use aggregate::{PointWeights, Totals};
pub use beam_quantity::{BeamQuantity, OfBeams};
pub use element_group::ElementGroup;
#[doc(hidden)]
pub use element_sum::ElementSum;
pub use extremes::{Extreme, Extremes};
#[doc(hidden)]
pub use functional::Measured;
pub use functional::{Functional, Sample};
pub(crate) use gradient::{FunctionalGradient, SampleSeeds};
pub use load::LoadKind;
#[doc(hidden)]
pub use load::{JointLoad, joint_force_and_moment};
#[doc(hidden)]
pub use measured_group::{GroupFormula, GroupPart, MeasuredGroup};
pub use over::{Over, Times};
pub use point_quantity::{AnyPointQuantity, PointParameters, PointQuantity, PointValue};
pub(crate) use quantity::MeasuredQuantity;
pub use quantity::{AnyQuantity, Quantity, QuantityPart, QuantityVisitor};
pub(crate) use reactions::multipliers_without_forces;
pub(crate) use run_parameters::RunParameters;
pub use shell_quantity::{OfShells, ShellQuantity};
#[doc(hidden)]
pub use step_ends::StepEnds;
#[doc(hidden)]
pub use values::Values;
pub(crate) use weights::{QuadratureWeights, StageWeight};
