//! Numbers that a motion is judged by: quantities at a time, and what is made of them over time.

mod aggregate;
mod beam_quantity;
mod element_group;
mod element_sum;
mod extremes;
mod functional;
mod gradient;
mod law;
mod load;
mod measured_group;
mod over;
mod point_quantity;
mod quantity;
mod reactions;
mod refused;
mod shell_quantity;
mod step_ends;
mod values;
mod weights;

pub mod quantities;

pub use aggregate::{Aggregate, AggregateKind, PointWeights, Totals};
pub use beam_quantity::{BeamQuantity, OfBeams};
pub use element_group::ElementGroup;
pub use element_sum::ElementSum;
pub use extremes::{Extreme, Extremes};
pub use functional::{Functional, Measured, Sample};
pub use gradient::{FunctionalGradient, SampleBars};
pub use load::{JointLoad, LoadKind, joint_force_and_moment};
pub use measured_group::{Argument, GroupFormula, GroupPart, MeasuredGroup};
pub use over::{Over, Times};
pub use point_quantity::{AnyPointQuantity, PointParameters, PointQuantity, PointValue};
pub use quantity::{AnyQuantity, MeasuredQuantity, Quantity, QuantityPart, QuantityVisitor};
pub use reactions::least_multipliers;
pub(crate) use reactions::multipliers_without_forces;
pub use shell_quantity::{OfShells, ShellQuantity};
pub use step_ends::StepEnds;
pub use values::Values;
pub use weights::QuadratureWeights;
