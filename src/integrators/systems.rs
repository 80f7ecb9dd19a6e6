use super::{ConstraintLevel, Method};
use crate::assembly::{Model, System};
use std::sync::Arc;

/// The numbered equations of a run, for one choice of redundant equations.
pub struct Systems<'m> {
    /// Accelerations and projections.
    pub plain: Arc<System<'m>>,
    /// Stages: the same, unless these have rate corrections.
    pub stage: Arc<System<'m>>,
}

impl<'m> Systems<'m> {
    /// Numbers the equations of a model for a method, without the constraint equations `dropped`.
    pub fn new(model: &'m Model, method: &Method, dropped: &[usize]) -> Self {
        let plain = Arc::new(System::new(model, method.system_options(dropped, false)));
        let stabilized = method.constraint_level() == ConstraintLevel::Velocity && plain.is_constrained();
        let stage =
            if stabilized { Arc::new(System::new(model, method.system_options(dropped, true))) } else { plain.clone() };
        Systems { plain, stage }
    }
}
