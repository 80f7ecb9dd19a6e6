use super::RunError;
use super::newton::{Newton, ROUND_OFF};
use crate::assembly::Equations;
use crate::elements::RunScalar;

/// Why one system was not solved; the caller knows where in the run it was.
pub struct Failure {
    pub(super) how: FailureKind,
    pub(super) iterations: usize,
    pub(super) correction: f64,
}

pub(super) enum FailureKind {
    Singular(usize),
    Diverged,
    Stagnated,
    NotFinite,
}

impl<S: RunScalar> Newton<'_, S> {
    /// The failure in words.
    pub fn describe(&self, failure: &Failure, equations: &Equations, place: &str) -> RunError {
        let model = self.system.model;
        let how = match failure.how {
            FailureKind::Singular(unknown) => {
                let unknown = self.system.unknown_name(unknown, &self.jacobian);
                let hint = if unknown.starts_with("joint") {
                    "its reaction is not determined: the joint is redundant or the mechanism is in a singular pose"
                } else if equations.is_static() {
                    "nothing holds it in equilibrium: give it a support, a joint or a spring; at a limit of the load take smaller \
                     steps, or follow the path by its arc length"
                } else {
                    "it has no inertia, or nothing holds it: give it a mass or a constraint"
                };
                return RunError::Singular { place: place.into(), unknown, hint: hint.into() };
            }
            FailureKind::Diverged => "diverged",
            FailureKind::Stagnated => "stagnated",
            FailureKind::NotFinite => "met a number that is not finite",
        };
        let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
        let largest = |values: &[S]| {
            (0..values.len())
                .max_by(|&i, &j| size(values[i].value()).total_cmp(&size(values[j].value())))
                .map(|i| (i, values[i].value()))
        };
        let force = largest(&self.residual.f).map(|(i, f)| (model.dof_name(i), f));
        let gap = largest(&self.residual.g).map(|(i, g)| (model.equation_name(i), g));
        let (row, residual) = match (force, gap) {
            (Some(force), Some(gap)) => {
                if size(gap.1) > size(force.1) {
                    gap
                } else {
                    force
                }
            }
            (force, gap) => force.or(gap).unwrap_or_default(),
        };
        RunError::NoConvergence {
            place: place.into(),
            how,
            iterations: failure.iterations,
            correction: failure.correction,
            limit: ROUND_OFF,
            row,
            residual,
        }
    }
}
