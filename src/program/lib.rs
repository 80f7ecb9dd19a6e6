//! Record a formula once, derive what is needed of it, run it fast.
//!
//! * [`Recorded`]: the number with which a formula is recorded into a [`Graph`]
//! * derivatives forward, in reverse and of derivatives: transformations of the graph
//! * [`Program`]: a straight line of operations that is executed, by a loop in any scalar or as machine code for one or several elements at a time
//! * [`Formula`]: a recording shared by all elements whose recordings are equal, with its programs

pub mod scalar;

mod arguments;
#[cfg(test)]
mod back_ends;
mod batches;
mod derivatives;
mod digest;
mod formula;
mod graph;
mod linear_forms;
mod listing;
mod loop_code;
mod native;
mod operation;
mod recorded;
mod replay;
mod running;
mod sides;
mod switch_times;
mod switches;
mod table_arguments;
pub mod tolerances;
mod undefined;

pub use arguments::ArgumentKind;
pub use digest::Digest;
pub use formula::{Codes, Formula, ProgramCache, ProgramKey, Stages, formulas_made, panic_is_caught};
pub use graph::Graph;
pub use linear_forms::LinearForm;
pub use native::refuses_machine_code;
pub use operation::Node;
pub use recorded::{Recorded, Recording, along_motion, continued, evaluate, gradient_of, is_from_energies, record};
pub use replay::Replay;
pub use running::{Program, ProgramWork, lanes, making_time};
pub use switch_times::SwitchTime;
pub use switches::{Excess, PassBuffers, Reads, SwitchKind, Switches, between};
pub use table_arguments::TableRange;
