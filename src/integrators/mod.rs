//! From a start to the end of the motion: tables, stages, projections, Newton's method; equilibria, their paths, and the small
//! vibrations about them.
//!
//! An integrator is a [`Table`]: which stages it has and how they and the carried vectors combine. Forward, tangent,
//! complex-step and adjoint runs are written once, for all tables and all constraint levels.

mod adaptive;
mod arc_length;
mod butcher;
mod checkpoint;
mod complex_modes;
mod counters;
mod course;
mod crossings;
mod dividing;
mod error;
mod error_terms;
mod given;
mod grid;
mod krylov;
mod lists;
mod load_steps;
mod march;
mod newton;
mod not_finite;
mod pause;
mod prediction;
mod record;
mod redundancy;
mod resolution;
mod resting_start;
mod round_off;
mod stability;
mod start;
mod steady_turn;
mod step;
mod step_choice;
mod systems;
mod table;
mod tables;
mod variational_momentum;
mod vibrations;

pub use adaptive::{StepControl, Tolerance, march_adaptive};
pub use arc_length::{ArcLength, Path, PathEnd, PathPoint, follow_path};
pub use butcher::Butcher;
pub use checkpoint::{Checkpoint, FactoredAt, KeptFactorization, StepState};
pub use complex_modes::complex_modes;
pub use counters::Counters;
pub(crate) use counters::Phase;
pub use crossings::{Crossing, Place, SwitchWatch};
pub use dividing::march_dividing;
pub use error::RunError;
pub use given::{march, march_along};
pub use grid::{Clocks, MOST_STEPS, TimeGrid};
pub(crate) use grid::{clock_at, moved_apart};
pub use march::{Method, Problem, Run};
pub use newton::{Contraction, Contractions, Floor, Newton, NewtonTolerance, Renewal};
pub use pause::{Pace, Pause};
pub(crate) use prediction::MOST as MOST_TRACKED;
pub use prediction::{Prediction, Track};
pub use record::{Guide, Recorder, Replay, SolveRecord, StageRecord, StartRecord, StepRecord, Steps};
pub use resolution::{StepError, StepErrors};
pub use resting_start::resting_start;
pub use round_off::RoundOff;
pub use stability::{Stability, StabilityCourse, Verdict};
pub use start::{ConstraintPolicy, InitialState, StartPlan};
pub use step::Stepper;
pub use systems::Systems;
pub use table::{Carried, Combination, Embedded, Quadrature, Scheme, Stage, Starter, Table};
pub use tables::{DEFAULT_TABLE, STATIC_TABLE, table_by_name, table_named, table_names, tables};
pub use variational_momentum::discrete_momentum;
pub use vibrations::{Mode, vibrations};

/// On which time derivative the constraints are kept while stages are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ConstraintLevel {
    /// g = 0 at the stages (index 3), as in Boopathy & Kennedy; velocities and multipliers lose orders.
    Position,
    /// g = 0 and dg/dt = 0 at the stages with rate corrections (Gear, Gupta, Leimkuhler).
    Velocity,
    /// d2g/dt2 = 0 at the stages, then (q, v) projected onto g = 0 and dg/dt = 0: full order for every table.
    #[default]
    Acceleration,
}

impl ConstraintLevel {
    /// All levels.
    pub const ALL: [ConstraintLevel; 3] =
        [ConstraintLevel::Position, ConstraintLevel::Velocity, ConstraintLevel::Acceleration];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ConstraintLevel::Position => "position",
            ConstraintLevel::Velocity => "velocity",
            ConstraintLevel::Acceleration => "acceleration",
        }
    }

    /// The level with a given name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }
}
