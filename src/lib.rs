//! Flexible multibody dynamics whose elements are written once, generic over a scalar, with exact gradients of anything a
//! mechanism does.
//!
//! **Start with the [guide]**: [getting started](guide::getting_started), [programs of your own](guide::programs), [your own element or
//! joint](guide::own_parts), [the theory](guide::theory). Conventions, symbols and words are in its [glossary](guide::glossary), keys of scene files
//! in `scenes::file`.
//!
//! | to | use |
//! |---|---|
//! | write a scene | [`prelude`], [`scenes::Scene`], [`scenes::MechanismBuilder`] |
//! | run and differentiate it | [`scenes::Prepared`], [`sensitivity::Analysis`] |
//! | write an element, a joint, a functional | [`elements::Element`], [`elements::Field`], [`elements::Constraint`], [`functionals::Quantity`] |
//! | give a joint or spring its keys, from the geometry | [`elements::entries::Entry`] |
//! | check what was written | [`testing`] |
//! | improve a design | [`optimize::Optimization`] |
//! | have the command line for scenes of one's own | `costate_cli::main` |
//!
//! # The way of the data
//!
//! The order of the modules: each uses only those before it.
//!
//! ```text
//! program       number types (scalar), recorded formulas and what is made of them: a crate of its own
//! design        design variables x, the map x -> p, q0, v0 and its transpose
//! elements      residuals R(a, v, q, p, t), constraints g(q, p, t)
//! linalg        factor, solve, solve transposed, ranks that share this (exchange): a crate of its own
//! assembly      numbering, residual, Jacobian, transposed products
//! integrators   start, stages, projections, step by step through time
//! history       states kept for the way back
//! functionals   f of the motion
//! sensitivity   backwards: adjoint variables, df/dp, df/dx
//! scenes        mechanisms as functions of x
//! optimize      better designs: programs, optimizers, histories
//! cli           the command line of any scenes: a crate of its own, which uses this one
//! guide         how to use all of this, and what it computes: text alone
//! python        the package for Python: a crate of its own, which uses this one
//! ```

// much of what scene files draw on is used by nothing else
#![cfg_attr(not(feature = "files"), allow(dead_code, unused_imports))]

/// The number types: one formula in, every derivative out.
pub mod scalar {
    #[doc(hidden)]
    pub use costate_program::scalar::*;
    #[doc(inline)]
    pub use costate_program::scalar::{
        COMPLEX_STEP, Complex64, Curve, Interpolant, MOST_BREAKPOINTS, Matrix3, Quaternion, Scalar, SpatialVector, TANGENTS,
        Tangents, Vector3,
    };
}

#[doc(hidden)]
pub use costate_program as program;
use costate_program::tolerances;

#[doc(hidden)]
pub mod design;

pub mod elements;

#[doc(hidden)]
pub use costate_linalg::exchange;

/// Linear systems: analyse a pattern once, factor values, solve, solve transposed.
pub mod linalg {
    #[cfg(feature = "mumps")]
    #[doc(inline)]
    pub use costate_linalg::MumpsLu;
    #[doc(hidden)]
    pub use costate_linalg::*;
    #[doc(inline)]
    pub use costate_linalg::{Backend, DenseLu, Inertia, LinearSolver, MultifrontalLu, Singular, SparsePattern};
}

#[doc(hidden)]
pub mod assembly;

pub mod integrators;

pub mod history;

pub mod functionals;

pub mod sensitivity;

pub mod scenes;

pub mod optimize;

pub mod testing;

#[doc(hidden)]
pub mod internals;

// text alone: no page that changes asks for another build
#[cfg(any(doc, doctest))]
pub mod guide;

/// What a file with a user's own element or scene needs.
pub mod prelude {
    pub use crate::assembly::{ConstraintId, ElementId, NodeId};
    pub use crate::design::DesignVariable;
    pub use crate::elements::flexible::{CableSection, Laminate, Material, Ply, Section, Shape};
    pub use crate::elements::forces::LoadFrame;
    pub use crate::elements::joints::Freedom;
    pub use crate::elements::{
        Admissible, Constraint, Element, NodeKind, NonholonomicConstraint, Parameter, State, TimeFormula, TimeFunction,
    };
    pub use crate::functionals::{
        Aggregate, AggregateKind, ElementGroup, LoadKind, Over, PointParameters, PointQuantity, PointValue, Quantity, Times,
    };
    pub use crate::history::{Keep, Observer, Watch};
    pub use crate::integrators::{ConstraintLevel, Method, RunError, StartRecord, StepControl, StepRecord, table_by_name};
    pub use crate::scalar::{Interpolant, Matrix3, Quaternion, Scalar, SpatialVector, Vector3};
    pub use crate::scenes::{
        BeamLine, BushingRates, CableLine, Force, Limit, MechanismBuilder, OptimizationProblem, Prepared, Scene, Settings,
        ShellMesh, Signal, SpringDamper, Torque,
    };
    pub use crate::sensitivity::largest_difference;
}
