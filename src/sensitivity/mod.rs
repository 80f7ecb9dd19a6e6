//! Gradients of functionals: discrete adjoint, tangent, complex step, and the checks between them.

mod adjoint;
mod analysis;
mod checks;
mod mode_gradients;
mod moving_steps;
mod over_time;
mod quotients;
mod roundings;
mod signature;
mod solvers;
mod transition;
mod transposed;

pub use analysis::{Analysis, Forward, Gradient};
pub use checks::{TaylorTest, largest_difference};
pub(crate) use mode_gradients::{Still, ValueBars, value_rates};
pub use over_time::GradientCourse;
pub use quotients::Quotient;
pub(crate) use transition::Transition;
