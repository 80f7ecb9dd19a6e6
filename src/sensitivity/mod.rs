//! Gradients of functionals: discrete adjoint, tangent, complex step, and the checks between them.

mod adjoint;
mod analysis;
mod at_times;
mod breakpoints;
mod checks;
mod happened;
mod mode_gradients;
mod moving_steps;
mod over_time;
mod quotients;
mod roundings;
mod signature;
mod solvers;
mod switched;
mod transition;
mod transposed;

pub use analysis::{Analysis, Forward, Gradient};
pub(crate) use at_times::Samples;
pub(crate) use breakpoints::Breakpoints;
pub use checks::{TaylorTest, largest_difference};
pub use happened::EventTime;
pub(crate) use mode_gradients::{Still, ValueSeeds, value_rates};
pub use over_time::GradientCourse;
pub use quotients::Quotient;
pub use switched::SwitchError;
pub(crate) use transition::Transition;
