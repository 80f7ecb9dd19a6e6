use super::Newton;
use crate::assembly::{Equations, VectorsAvq};
use crate::elements::RunScalar;
use crate::integrators::not_finite::not_finite;
use crate::integrators::{RunError, Stop, unit_part};
use crate::linalg::Singular;
use crate::tolerances::{ROUND_OFF, SAME_DERIVATIVE};

const IN_TIME: &str = "try a smaller step, steps chosen by their error, or for stiff forces the method sdirk4";
const STATIC: &str = "try a smaller step; what only its own tension holds, as a straight cable, finds its equilibrium by start = \"equilibrium\" \
                      with a method of motion";
pub const NOT_HELD: &str = "nothing holds it in equilibrium: give it a support, a joint or a spring; what only its own tension holds, as a straight \
                            cable or chain, finds its equilibrium by start = \"equilibrium\" with a method of motion; at a limit of the load take smaller \
                            steps, or follow the path by its arc length";

/// Why one system was not solved; the caller knows where in the run it was.
pub struct Failure {
    pub(super) how: FailureKind,
    pub(super) iterations: usize,
    pub(super) correction: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FailureKind {
    Singular(usize),
    Diverged,
    Stagnated,
    NotFinite,
    Unbalanced,
    /// Of the derivative parts alone, the value being a solution: what happened.
    Parts(&'static str),
}

impl Failure {
    pub(super) fn singular(Singular { unknown }: Singular, iterations: usize) -> Self {
        Failure { how: FailureKind::Singular(unknown), iterations, correction: f64::NAN }
    }
}

impl<S: RunScalar> Newton<'_, S> {
    pub fn describe(&self, failure: &Failure, equations: &Equations, place: &str) -> RunError {
        let model = self.system.model;
        if let FailureKind::NotFinite | FailureKind::Singular(_) = failure.how {
            let values = |list: &[S]| list.iter().map(|x| x.value()).collect::<Vec<f64>>();
            let VectorsAvq { a, v, q } = &self.residual.at;
            let at = VectorsAvq { a: values(a), v: values(v), q: values(q) };
            if let Some(cause) = not_finite(model, &self.p, &at, self.t, true) {
                return RunError::not_finite(place, cause);
            }
        }
        let how = match failure.how {
            FailureKind::Singular(unknown) => {
                let unknown = self.system.unknown_name(unknown, &self.jacobian);
                let hint = if unknown.starts_with("joint") {
                    "its reaction is not determined: the joint is redundant or the mechanism is in a singular pose"
                } else if unknown.contains(", state ") {
                    "a state at rest needs a rate that depends on it, or on what it acts on: what integrates alone has no rest"
                } else if equations.is_static() {
                    NOT_HELD
                } else {
                    "it has no inertia, or nothing holds it: give it a mass or a constraint"
                };
                return RunError::singular(place, &unknown, hint);
            }
            FailureKind::Diverged => "diverged",
            FailureKind::Stagnated => "stagnated",
            FailureKind::NotFinite => "met a number that is not finite",
            FailureKind::Unbalanced => "ended where the equations do not hold",
            FailureKind::Parts(how) => how,
        };
        let of_parts = matches!(failure.how, FailureKind::Parts(_));
        let (row, residual) = self.largest_row(of_parts);
        let (Failure { iterations, correction, .. }, limit) = (failure, if of_parts { SAME_DERIVATIVE } else { ROUND_OFF });
        let cause = format!(
            "Newton {how} after {iterations} iterations at a relative correction of {correction:.1e} (limit {limit:.0e}); \
             largest row: {row} ({residual:.1e})"
        );
        RunError::stopped(Stop::NoConvergence, place, cause, if equations.is_static() { STATIC } else { IN_TIME })
    }

    /// The row that is least in balance, and what is left there, or in its derivative parts.
    fn largest_row(&self, of_parts: bool) -> (String, f64) {
        let model = self.system.model;
        let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
        let seen = |value: &S| {
            let parts = (0..S::PARTS).map(|part| value.part(part) / unit_part::<S>());
            if of_parts {
                parts.fold(0.0, |most, part| if size(part) > size(most) { part } else { most })
            } else {
                value.value()
            }
        };
        let largest = |values: &[S]| {
            let rows = values.iter().map(seen).enumerate();
            rows.max_by(|(_, a), (_, b)| size(*a).total_cmp(&size(*b)))
        };
        let force = largest(&self.residual.f).map(|(i, f)| (model.dof_name(i), f));
        let gap = largest(&self.residual.g).map(|(i, g)| (model.equation_name(i), g));
        match (force, gap) {
            (Some(force), Some(gap)) if size(gap.1) > size(force.1) => gap,
            (force, gap) => force.or(gap).unwrap_or_default(),
        }
    }
}
