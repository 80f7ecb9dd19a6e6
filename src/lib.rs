//! Flexible multibody dynamics whose elements are written once, generic over a scalar, with exact gradients of anything a
//! mechanism does.
//!
//! The way of the data, and the order of the modules: each uses only those before it.
//!
//! ```text
//! scalar        number types: real, complex step, dual, recorded
//! program       recorded formulas and what is made of them: derivatives, structure, fast execution
//! design        design variables x, the map x -> p, q0, v0 and its transpose
//! elements      residuals R(a, v, q, p, t), constraints g(q, p, t)
//! linalg        factor, solve, solve transposed
//! assembly      numbering, residual, Jacobian, transposed products
//! integrators   start, stages, projections, step by step through time
//! history       states kept for the way back
//! functionals   f of the motion
//! sensitivity   backwards: adjoint variables, df/dp, df/dx
//! scenes        mechanisms as functions of x
//! optimize      better designs: programs, optimizers, histories
//! io            plots, pictures, tables, files
//! cli           the command line of any scenes (feature `cli`)
//! ```
//!
//! # Conventions
//!
//! * residual: inertia + internal - applied = 0; constraints add A^T mu with A = dg/dq, so the force on the bodies is -A^T mu
//! * a body node: position of its frame in the world, then Euler parameters with the scalar part first; R(e) takes body
//!   components to world components; angular velocity in the body frame is 2 G(e) de/dt
//! * a body in natural coordinates: position of its frame, then its axes as world vectors; a cable's node: position, then slope dr/dx
//! * units are the caller's, consistent; documentation names SI
//!
//! # Symbols
//!
//! | symbol | meaning |
//! |---|---|
//! | q, v, a | coordinates, velocities, accelerations |
//! | p | parameters: every physical number of the model |
//! | x | design variables; in a solved system: its unknowns |
//! | mu | multipliers of the constraints g |
//! | alpha, beta, gamma | dq/dx, dv/dx, da/dx of a system's unknowns |
//! | lambda | adjoint variables of a system |
//! | a bar behind a name | derivative of the functional with respect to it |

pub mod scalar;

pub mod program;

pub mod design;

pub mod elements;

pub mod linalg;

pub mod assembly;

pub mod integrators;

pub mod history;

pub mod functionals;

pub mod sensitivity;

pub mod scenes;

pub mod optimize;

pub mod io;

#[cfg(feature = "cli")]
pub mod cli;

pub mod testing;

/// What a file with a user's own element or scene needs.
pub mod prelude {
    pub use crate::design::DesignVariable;
    pub use crate::elements::{
        Admissible, Constraint, Element, NodeKind, NonholonomicConstraint, Parameter, State, TimeFunction,
    };
    pub use crate::functionals::{
        Aggregate, AggregateKind, ElementGroup, Over, PointParameters, PointQuantity, PointValue, Quantity, Times,
    };
    pub use crate::integrators::{ConstraintLevel, Method, RunError, table_by_name};
    pub use crate::scalar::{Matrix3, Quaternion, Scalar, SpatialVector, Vector3};
    pub use crate::scenes::{Limit, MechanismBuilder, OptimizationProblem, Prepared, Scene, Settings};
    pub use crate::sensitivity::largest_difference;
}
