use super::{ConstraintLevel, Method, StartPlan};
use crate::assembly::{Model, System};

/// The numbered equations of a run.
pub struct Systems<'m> {
    /// Accelerations and projections; also stages, unless these have rate corrections.
    pub plain: System<'m>,
    /// Stages with rate corrections.
    pub with_rates: Option<System<'m>>,
}

impl<'m> Systems<'m> {
    /// Numbers the equations of a model for a method.
    pub fn new(model: &'m Model, method: &Method, plan: &StartPlan) -> Self {
        let plain = System::new(model, method.system_options(&plan.dropped, false));
        let stabilized = method.level == ConstraintLevel::Velocity && plain.is_constrained();
        let with_rates = stabilized.then(|| System::new(model, method.system_options(&plan.dropped, true)));
        Systems { plain, with_rates }
    }

    /// The equations of stages.
    pub fn stage(&self) -> &System<'m> {
        self.with_rates.as_ref().unwrap_or(&self.plain)
    }
}
