//! Bodies, forces and joints: the mechanics, each definition written once.
//!
//! * [`Element`]: residual R(a, v, q, p, t), or the energies and forces from which it follows
//! * [`Field`]: the same at points of interpolated fields, for flexible elements
//! * [`Constraint`]: g(q, p, t) = 0 and nothing else
//! * [`NonholonomicConstraint`]: h(v, q, p, t) = 0, linear in v, and nothing else
//! * [`Friction`]: velocities at which surfaces slip, and limits by the multipliers of a joint
//!
//! Sign: the residual is inertia + internal - applied = 0; a constraint adds A^T mu with A = dg/dq, so the force of the
//! constraint on the bodies is -A^T mu.

mod at_rest;
mod characteristic;
mod constraint;
pub(crate) mod dyn_layer;
mod element;
mod field;
mod frame;
mod friction;
mod lagrangian;
mod node_kind;
mod nonholonomic;
mod parameter;
mod table;
mod time_formula;
mod time_function;

#[doc(hidden)]
pub mod bodies;
pub mod entries;
pub mod flexible;
pub mod forces;
pub mod joints;

pub(crate) use at_rest::{AtRest, OfStates, SPIN_PARAMETERS, turn, turn_gradient};
pub use characteristic::{Characteristic, ForceLaw};
pub use constraint::Constraint;
#[doc(hidden)]
pub use dyn_layer::ElementPhysics;
pub use dyn_layer::{AnyConstraint, AnyElement};
pub(crate) use dyn_layer::{
    ConstraintPhysics, FormulaWork, RunScalar, dofs_of, instantiate_here, motion_derivatives, multipliers_behind,
    split_arguments, unrelated_numbers,
};
pub use element::{Element, Output, State};
pub(crate) use field::interpolate;
pub use field::{Field, Flexible, Interpolation};
pub use frame::Frame;
pub use friction::Friction;
pub(crate) use friction::{AnyFriction, LEAST_SPEED, Slipping, Sticking, directed_by, going_on};
pub(crate) use lagrangian::paired;
pub use node_kind::NodeKind;
pub(crate) use node_kind::NodePair;
pub use nonholonomic::{Nonholonomic, NonholonomicConstraint};
pub use parameter::{Admissible, Parameter};
pub use table::Table;
pub(crate) use time_formula::RecordedFunction;
pub use time_formula::TimeFormula;
pub use time_function::TimeFunction;
