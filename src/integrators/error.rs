use crate::design::shortest;
use crate::linalg::Singular;
use std::fmt;

/// Why a simulation stopped: where, what, how much, what to try. Both forms are the sentence, so that `main() -> Result<(), RunError>`
/// prints it.
#[derive(Clone, PartialEq)]
pub enum RunError {
    /// Input that makes no sense, found before the first step.
    Input(String),
    /// A system that does not determine one of its unknowns.
    Singular {
        /// Where in the run.
        place: String,
        /// The unknown.
        unknown: String,
        /// What it means and what to try.
        hint: String,
    },
    /// Newton's method stopped without a solution.
    NoConvergence {
        /// Where in the run.
        place: String,
        /// Diverged, stagnated, or ran into numbers that are not finite.
        how: &'static str,
        /// Iterations made.
        iterations: usize,
        /// Size of the last correction, relative to the unknowns.
        correction: f64,
        /// The limit for it.
        limit: f64,
        /// Row with the largest residual.
        row: String,
        /// Its residual.
        residual: f64,
        /// What to try.
        hint: &'static str,
    },
    /// A formula that gives what is no number.
    NotFinite {
        /// Where in the run.
        place: String,
        /// The element or constraint, with its arguments.
        cause: String,
    },
    /// A constraint equation that was left out as redundant does not follow from the others.
    Redundant {
        /// Where in the run.
        place: String,
        /// The equation.
        equation: String,
        /// By how much it is violated [m or rad].
        violation: f64,
    },
    /// A chosen step became too small to advance.
    StepSize {
        /// Number of the step.
        step: usize,
        /// Its start \[s\].
        t: f64,
        /// Its size \[s\].
        h: f64,
    },
    /// Load steps became too small to find another equilibrium.
    NoEquilibrium {
        /// Load factor of the last equilibrium.
        t: f64,
        /// Smallest step that was tried.
        h: f64,
        /// What to try.
        hint: &'static str,
        /// What happened there.
        cause: String,
    },
    /// A step that could not be kept for the way back, or not be found again.
    History {
        /// Where in the run, and where it was to be kept.
        place: String,
        /// What happened.
        cause: String,
        /// What is left and what to try.
        hint: String,
    },
    /// The caller asked to stop.
    Interrupted {
        /// Steps finished before.
        steps: usize,
    },
}

impl RunError {
    /// Whether a shorter step may have a solution where this one has none.
    pub(super) fn is_of_step(&self) -> bool {
        matches!(self, RunError::NoConvergence { .. } | RunError::NotFinite { .. } | RunError::Singular { .. })
    }

    /// The same where no shorter step helped either.
    pub(super) fn of_all_steps(self) -> Self {
        match self {
            RunError::NoConvergence { place, how, iterations, correction, limit, row, residual, .. } => {
                let hint = "no smaller step helped: a force that jumps with the velocity, as friction by if_less(v, 0, -f, f), has no solution where it \
                            should rest; write it smoothly, f * tanh(v / 1e-3)";
                RunError::NoConvergence { place, how, iterations, correction, limit, row, residual, hint }
            }
            other => other,
        }
    }

    /// A pattern that no numbers could make regular.
    pub(crate) fn of_pattern(place: &str, singular: Singular) -> Self {
        RunError::Singular {
            place: place.into(),
            unknown: format!("unknown {}", singular.unknown),
            hint: "the pattern of the equations is singular: a coordinate has no equation".into(),
        }
    }
}

impl From<String> for RunError {
    fn from(what: String) -> Self {
        RunError::Input(what)
    }
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            RunError::Input(message) => f.write_str(message),
            RunError::Singular { place, unknown, hint } => {
                write!(f, "{place}: the equations do not determine {unknown}; {hint}")
            }
            RunError::NoConvergence { place, how, iterations, correction, limit, row, residual, hint } => write!(
                f,
                "{place}: Newton {how} after {iterations} iterations at a relative correction of {correction:.1e} (limit {limit:.0e}); \
                 largest row: {row} ({residual:.1e}); {hint}"
            ),
            RunError::NotFinite { place, cause } => {
                write!(f, "{place}: {cause}; if these arguments make sense, take a smaller step, otherwise mend the formula")
            }
            RunError::Redundant { place, equation, violation } => write!(
                f,
                "{place}: {equation} was left out as redundant, but is violated by {violation:.1e}: the constraints depend on each other \
                 at the start only, and the mechanism is locked or singular here; check the directions of axes and the closing of loops"
            ),
            RunError::StepSize { step, t, h } => write!(
                f,
                "step {step} (t = {} s): the error asks for a step of {h:.1e} s, which no longer advances; \
                 the motion is not smooth there, or the tolerance is below round-off: try a larger tolerance",
                shortest(*t)
            ),
            RunError::NoEquilibrium { t, h, hint, cause } => {
                write!(f, "no equilibrium was found beyond the load factor {t} with steps down to {h:.1e}: {hint} ({cause})")
            }
            RunError::History { place, cause, hint } => write!(f, "{place}: {cause}; {hint}"),
            RunError::Interrupted { steps } => write!(f, "interrupted after {steps} finished steps"),
        }
    }
}

// what `main` prints of an error is its Debug form: the sentence, not the names of fields
impl fmt::Debug for RunError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for RunError {}
