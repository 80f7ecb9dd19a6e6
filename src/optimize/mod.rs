//! Optimization: designs that make a functional small or large within bounds and constraints.
//!
//! A scene states its [`OptimizationProblem`](crate::scenes::OptimizationProblem) by names of functionals and design variables.
//! [`Optimization`] makes a [`NonlinearProgram`] of it, in scaled variables: each point is one simulation, and one adjoint sweep
//! where gradients are wanted, for all functionals of the problem together. An [`Optimizer`] goes from point to point along a
//! [`Evaluations`], which remembers values, keeps the best point and says when to end. [`Sqp`] is the default one.

mod conditions;
mod confidence;
mod curvature;
mod design_program;
mod escape;
mod evaluations;
mod fit;
mod history;
mod levenberg_marquardt;
mod optimization;
mod optimizer;
mod program;
mod quadratic;
mod run;
#[doc(hidden)]
pub mod runs_at_once;
mod scaling;
mod sent;
mod simulated;
mod sqp;
mod starts;
mod subproblem;

pub use conditions::Conditions;
pub use confidence::{Combined, Confidence};
pub use evaluations::{Ended, Evaluations, Point, Reason, Stopping};
pub use fit::{Fit, Fitted, FittedCurve};
pub use history::{DesignHistory, DesignPoint, Work};
pub use optimization::{Case, GradientBy, Optimization, Optimized, Watcher};
pub use optimizer::{Optimizer, minimize, optimizers};
pub use program::{ConstraintKind, Gradients, NoValue, NonlinearProgram, Values};
pub use sqp::Sqp;
