use crate::design::shortest;
use crate::linalg::Singular;
use std::fmt;

/// Why a simulation stopped: where, what, how much, what to try. Both forms are the sentence, so that `main() -> Result<(), RunError>`
/// prints it.
#[derive(Clone, PartialEq)]
pub enum RunError {
    /// Input that makes no sense, found before the first step.
    Input(String),
    /// A run that cannot go on.
    Stopped {
        /// What kind of failure it is.
        reason: Stop,
        /// Where in the run.
        place: String,
        /// What happened, and how much.
        cause: String,
        /// What it means and what to try.
        hint: String,
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
    /// The caller asked to stop.
    Interrupted {
        /// Steps finished before.
        steps: usize,
    },
}

/// What keeps a run from going on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A system that does not determine one of its unknowns.
    Singular,
    /// Newton's method stopped without a solution.
    NoConvergence,
    /// A formula that gives what is no number.
    NotFinite,
    /// A constraint equation that was left out as redundant does not follow from the others.
    Redundant,
    /// A chosen step became too small to advance.
    StepSize,
    /// A step that could not be kept for the way back, or not be found again.
    History,
}

impl RunError {
    pub(crate) fn stopped(
        reason: Stop,
        place: impl Into<String>,
        cause: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        RunError::Stopped { reason, place: place.into(), cause: cause.into(), hint: hint.into() }
    }

    /// An unknown that the equations do not determine.
    pub(crate) fn singular(place: impl Into<String>, unknown: &str, hint: &str) -> Self {
        Self::stopped(Stop::Singular, place, format!("the equations do not determine {unknown}"), hint)
    }

    /// A formula whose value is no number.
    pub(super) fn not_finite(place: &str, cause: String) -> Self {
        let hint = "if these arguments make sense, take a smaller step, otherwise mend the formula";
        Self::stopped(Stop::NotFinite, place, cause, hint)
    }

    /// A step that is too small to advance.
    pub(super) fn step_size(step: usize, t: f64, h: f64) -> Self {
        Self::stopped(
            Stop::StepSize,
            format!("step {step} (t = {} s)", shortest(t)),
            format!("the error asks for a step of {h:.1e} s, which no longer advances"),
            "the motion is not smooth there, or the tolerance is below round-off: try a larger tolerance",
        )
    }

    /// A pattern that no numbers could make regular.
    pub(crate) fn of_pattern(place: &str, Singular { unknown }: Singular) -> Self {
        let hint = "the pattern of the equations is singular: a coordinate has no equation";
        Self::singular(place, &format!("unknown {unknown}"), hint)
    }

    pub(super) fn is(&self, kinds: &[Stop]) -> bool {
        matches!(self, RunError::Stopped { reason, .. } if kinds.contains(reason))
    }

    /// Whether a shorter step may have a solution where this one has none.
    pub(super) fn is_of_step(&self) -> bool {
        self.is(&[Stop::NoConvergence, Stop::NotFinite, Stop::Singular])
    }

    /// The same where no shorter step helped either.
    pub(super) fn of_all_steps(mut self) -> Self {
        if let RunError::Stopped { reason: Stop::NoConvergence, hint, .. } = &mut self {
            *hint = "no smaller step helped: a force that jumps with the velocity, as friction by if_less(v, 0, -f, f), has no solution where it \
                     should rest; write it smoothly, f * tanh(v / 1e-3)"
                .into();
        }
        self
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
            RunError::Stopped { place, cause, hint, .. } => write!(f, "{place}: {cause}; {hint}"),
            RunError::NoEquilibrium { t, h, hint, cause } => {
                write!(f, "no equilibrium was found beyond the load factor {t} with steps down to {h:.1e}: {hint} ({cause})")
            }
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
