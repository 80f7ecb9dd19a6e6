//! From a start to the end of the motion: tables, stages, projections, Newton's method; equilibria, their paths, and the small
//! vibrations about them.
//!
//! An integrator is a [`Table`]: which stages it has and how they and the carried vectors combine. Forward, tangent,
//! complex-step and adjoint runs are written once, for all tables and all constraint levels.

pub(crate) mod adaptive;
mod amplitudes;
mod arc_length;
mod butcher;
mod checkpoint;
mod complex_modes;
mod counters;
mod crossings;
mod error;
mod error_terms;
mod events;
pub(crate) mod given;
mod grid;
mod harmonic_response;
mod implicit_weights;
mod initial_guess;
mod krylov;
mod lists;
mod load_steps;
mod location;
pub(crate) mod march;
mod mode_vectors;
mod newton;
mod not_finite;
mod positive_weights;
mod prediction;
pub(crate) mod record;
mod redundancy;
mod resolution;
mod restart;
mod resting_start;
mod round_off;
mod run_interval;
mod slipping;
mod stability;
mod start;
mod steady_turn;
mod step;
mod step_points;
mod table;
pub(crate) mod tables;
mod time_loop;
mod variational_momentum;
mod vibrations;
mod whole_basis;

use crate::elements::RunScalar;
pub use crate::program::SwitchKind;
use crate::scalar::COMPLEX_STEP;
pub(crate) use adaptive::march_adaptive;
pub use adaptive::{StepControl, Tolerance};
pub(crate) use arc_length::follow_path;
pub use arc_length::{ArcLength, Path, PathEnd, PathPoint};
pub use butcher::Butcher;
pub(crate) use checkpoint::{Checkpoint, StepState};
pub(crate) use complex_modes::complex_modes;
pub use counters::Counters;
pub(crate) use counters::Phase;
pub use crossings::Crossing;
#[doc(hidden)]
pub use crossings::{Place, SwitchWatch, each_formula};
pub use error::{RunError, Stop};
pub(crate) use events::{Events, Moment, along_axis, from_axis};
#[doc(hidden)]
pub use events::{SetNumber, SideChange};
pub(crate) use given::{march, march_along, march_dividing, march_given};
pub(crate) use grid::EndMoves;
pub use grid::TimeGrid;
#[doc(hidden)]
pub use grid::{Clocks, MOST_STEPS, clock_at, moved_apart};
pub(crate) use harmonic_response::{Response, Vibration, harmonic_response};
pub use march::Method;
pub(crate) use march::Problem;
pub(crate) use mode_vectors::{
    Amplitude, ModeGroup, ModeVectors, SAME as SAME_MODE, SHIFT as RESTING_SHIFT, is_cut, mode_vectors, value_of,
};
pub use newton::NewtonTolerance;
pub(crate) use newton::{Contraction, Contractions, FactoredAt, Floor, KeptFactorization, Renewal, coordinate_scales, kind};
pub(crate) use prediction::{MOST as MOST_TRACKED, Prediction, Track};
#[doc(hidden)]
pub use record::{AxisRecord, ImpactRecord, OtherHit, SlipBefore};
pub(crate) use record::{Observer, Replay, Steps};
pub use record::{SolveRecord, StageRecord, StartRecord, StepRecord};
pub use resolution::StepError;
pub(crate) use resolution::StepErrors;
pub(crate) use restart::{Pause, StepSizeState};
pub(crate) use resting_start::{resting_start, staying_states};
pub(crate) use round_off::HeldRoundings;
pub(crate) use slipping::{moves, speed_of};
pub use stability::{Stability, StabilityCourse, Verdict};
pub use start::ConstraintPolicy;
pub(crate) use start::{InitialState, RestingPlan, StartPlan};
pub(crate) use steady_turn::forces_turn;
pub(crate) use step::Stepper;
pub(crate) use step_points::StepRule;
pub use table::{Carried, Combination, Embedded, Quadrature, Scheme, Stage, Starter, Table};
#[doc(hidden)]
pub use tables::table_named;
pub use tables::{DEFAULT_TABLE, STATIC_TABLE, table_by_name, table_names, tables};
pub use variational_momentum::discrete_momentum;
pub use vibrations::Mode;
pub(crate) use vibrations::{Modes, RestingProblem, equilibrium_at, vibrations};

/// On which time derivative the constraints are kept while stages are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ConstraintLevel {
    /// g = 0 at the stages (index 3), as in Boopathy & Kennedy; velocities and multipliers lose orders.
    Position,
    /// d2g/dt2 = 0 at the stages, then (q, v) projected onto g = 0 and dg/dt = 0: full order for every table.
    #[default]
    Acceleration,
}

impl ConstraintLevel {
    /// All levels.
    pub const ALL: [ConstraintLevel; 2] = [ConstraintLevel::Position, ConstraintLevel::Acceleration];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ConstraintLevel::Position => "position",
            ConstraintLevel::Acceleration => "acceleration",
        }
    }

    /// The level with a given name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }
}

/// Derivative part that stands for a derivative of 1: a complex number carries its derivative times the step.
pub(crate) fn unit_part<S: RunScalar>() -> f64 {
    if S::PARTS == 1 { COMPLEX_STEP } else { 1.0 }
}
