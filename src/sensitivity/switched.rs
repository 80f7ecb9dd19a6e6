//! What gradients are worth where formulas pass from one piece to another within steps.

use super::checks::largest_difference;
use super::{Analysis, Forward, Gradient};
use crate::functionals::{Functional, Measured, Times};
use crate::history::Keep;
use crate::integrators::{Crossing, RunError};
use crate::program::SwitchKind;

/// What a switch within a step does to the gradient of a functional.
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchError {
    /// Name of the functional.
    pub functional: String,
    /// How much of the gradient changes where all steps are halved; `None` behind a jump, where it is wrong whatever the steps are.
    pub share: Option<f64>,
    /// The first crossing that does it.
    pub crossing: Crossing,
}

impl SwitchError {
    /// Share of a gradient that may change where steps are halved: one that changes by more has not the two digits that decide a design.
    pub const LIMIT: f64 = 0.01;

    /// Why the gradient is none; `None` where it is one to the share that is known.
    pub fn refused(&self) -> Option<String> {
        let SwitchError { functional, share, crossing } = self;
        let Crossing { part, step, t, .. } = crossing;
        let place = format!("step {step} (t = {t} s)");
        match share {
            None => Some(format!(
                "the gradient of \"{functional}\" is wrong, and so are its complex steps: the formula of \"{part}\" jumps in {place}, within a \
                 step; keep the motion on one side, or write the formula without the jump"
            )),
            Some(share) if *share <= Self::LIMIT => None,
            Some(share) => Some(format!(
                "the gradient of \"{functional}\" is wrong: {:.1} % of it changes where all steps are halved, because the formula of \"{part}\" \
                 has a kink in {place} that the steps do not resolve; take smaller ones, or let them be chosen to come close to it (--tolerance 1e-12), until this is below \
                 {:.0} %",
                100.0 * share,
                100.0 * Self::LIMIT
            )),
        }
    }
}

impl Analysis<'_> {
    /// What switches within the steps of a run do to the gradients that were computed along it: one entry for each functional that reads behind one.
    /// Where switches only bend formulas, the run and its gradient are computed once more with all steps halved.
    ///
    /// # Errors
    /// Those of that run and of its gradient.
    pub fn switch_errors(&self, forward: &Forward, gradient: &Gradient) -> Result<Vec<SwitchError>, RunError> {
        let affects = |crossing: &Crossing, functional: &Functional| match crossing.is_functional {
            true => crossing.part == functional.name,
            false => functional.over.times() != Times::Start && !functional.is_still(self.model),
        };
        let crossing = |functional: &Functional| forward.crossings.iter().find(|crossing| affects(crossing, functional));
        let affected: Vec<(usize, &Crossing)> =
            (0..).zip(self.functionals).filter_map(|(k, own)| Some((k, crossing(own)?))).collect();
        let halved = match affected.iter().any(|(_, crossing)| crossing.kind == SwitchKind::Kink) {
            true => Some(self.gradient_by_halved_steps(forward)?),
            false => None,
        };
        let error = |(k, crossing): (usize, &Crossing)| SwitchError {
            functional: self.functionals[k].name.clone(),
            share: (crossing.kind == SwitchKind::Kink)
                .then(|| halved.as_ref().map_or(f64::NAN, |halved| largest_difference(&halved.rows[k], &gradient.rows[k]))),
            crossing: crossing.clone(),
        };
        Ok(affected.into_iter().map(error).collect())
    }

    fn gradient_by_halved_steps(&self, forward: &Forward) -> Result<Gradient, RunError> {
        let (grid, keep) = (forward.grid.halved(), Keep::default());
        let halved = Analysis { grid: &grid, control: None, divide: false, keep: &keep, ..*self };
        halved.adjoint(&forward.x, &halved.forward(&forward.x)?)
    }
}

impl Functional {
    /// Whether it measures what no motion changes, as a mass.
    fn is_still(&self, model: &crate::assembly::Model) -> bool {
        matches!(&self.measured, Measured::Group(group) if group.is_still(model))
    }
}
