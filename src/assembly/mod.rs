//! From elements to the equations of the whole: numbering, residual, Jacobian, transposed products.
//!
//! One [`System`] evaluates, for unknowns x (accelerations) and mu (multipliers),
//!
//! ```text
//! F = R(a + gamma x, v + beta x, q + alpha x, p, t) [- R(a, v, q, p, t)] + A^T mu        = 0
//! G = g, dg/dt or d2g/dt2 at (a + gamma' x, v + beta' x, q + alpha' x), scaled           = 0
//! ```
//!
//! which is a Runge-Kutta stage, an initial acceleration or a projection, depending on the shifts (see
//! [`Equations`]). Constraints inside a node are eliminated there and never reach the matrix.

mod batches;
mod clock;
mod constraint_programs;
mod constraint_rows;
mod element_programs;
mod equations;
mod evaluation;
mod event;
mod gather_map;
mod inside_nodes;
mod jacobian;
mod lanes;
mod matrix_values;
mod model;
mod node_programs;
mod node_runs;
mod null_spaces;
mod numbering;
mod own_parts;
mod part_programs;
mod products;
mod reduction;
mod residual;
mod resting;
mod structural_signature;
mod terms;
mod unit_length;
mod variational;

pub use clock::Clock;
pub use constraint_programs::ConstraintPart;
pub(crate) use constraint_rows::ConstraintRows;
pub use element_programs::Force;
pub use equations::{Equations, Level, StageCoefficients, StageSystem, Unknowns, VectorsAvq};
pub(crate) use equations::{clone_fields, empty_fields};
pub(crate) use evaluation::{BatchWork, run_lanes};
#[doc(hidden)]
pub use event::{Closing, Event, EventArguments, JointFriction, Reset, Stop, Target};
pub(crate) use gather_map::Starts;
pub use jacobian::Jacobian;
#[doc(hidden)]
pub use lanes::last_bit;
pub(crate) use lanes::{LaneResults, Lanes, Run};
pub(crate) use model::ModelIdentity;
pub use model::{Attached, ConstraintId, ElementId, Model, Node, NodeId, Spin};
pub use numbering::{System, SystemOptions};
pub use part_programs::PartPrograms;
pub use products::{Adjoints, NodeSeeds, ProductPoint, ProductSeeds, Products};
pub use residual::Residual;
pub(crate) use resting::RestingModel;
pub(crate) use structural_signature::StructuralSignature;
pub use terms::{Term, TermPoint};
pub use variational::Variational;
