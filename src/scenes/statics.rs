use super::Prepared;
use crate::integrators::{
    ArcLength, InitialState, Mode, Path, Problem, Recorder, RunError, StabilityCourse, StartRecord, StepRecord, follow_path,
    march, march_adaptive, march_dividing, resting_start, vibrations,
};

/// The last state of a run over load steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equilibrium {
    /// Load factor.
    pub load: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Multipliers.
    pub mu: Vec<f64>,
    /// Redundant constraint equations that were left out.
    pub dropped: Vec<usize>,
    /// Whether it stands, and where the path to it lost its stability.
    pub stability: Option<StabilityCourse>,
}

impl Recorder<f64> for Equilibrium {
    fn start(&mut self, _start: StartRecord<f64>) -> Result<(), RunError> {
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.load = step.t + step.h;
        self.q.clone_from(&step.q);
        self.dropped.clone_from(&step.dropped);
        if let Some(last) = step.stages.last() {
            self.mu.clone_from(&last.solve.unknowns.mu);
        }
        Ok(true)
    }
}

impl Prepared<'_> {
    /// The equilibrium at the end of the load steps, with the method `static`.
    ///
    /// # Errors
    /// Another method, or a load step without equilibrium.
    pub fn equilibrium(&self) -> Result<Equilibrium, RunError> {
        if !self.method.table.is_static() {
            let name = &self.method.table.name;
            return Err(RunError::Input(format!("the method is \"{name}\"; equilibria are found by \"static\"")));
        }
        let (problem, mut last) = (self.problem(), Equilibrium::default());
        let run = match &self.control {
            Some(control) => march_adaptive(&problem, &self.method, control, &self.grid, &self.plan, &mut last).1?,
            None if self.divide => march_dividing(&problem, &self.method, &self.grid, &self.plan, &mut last).1?,
            None => march(&problem, &self.method, &self.grid, &self.plan, &mut last)?,
        };
        last.stability = run.stability;
        Ok(last)
    }

    /// Coordinates of the equilibrium at which the motion begins; those that the scene gives where it does not begin at one.
    ///
    /// # Errors
    /// An equilibrium that is not found.
    pub fn resting_start(&self) -> Result<Vec<f64>, RunError> {
        resting_start(&self.problem(), &self.method, &self.plan)
    }

    /// Equilibria along their path, through limits of the load; the load factor is 0 at the start, whatever the method.
    ///
    /// # Errors
    /// A start or options that are no good, a first equilibrium that is not found, or a path that ends, with its last load.
    pub fn path(&self, arc: &ArcLength) -> Result<Path, RunError> {
        follow_path(&self.problem(), &self.method, &self.plan, arc)
    }

    /// Lowest modes of small undamped vibrations: with the method `static` about the equilibrium at the end of the load steps, otherwise
    /// about the start, which must be one, or is looked for in a run from equilibrium.
    ///
    /// # Errors
    /// See [`Prepared::equilibrium`], and modes that are there by their count, but were not found.
    pub fn modes(&self, count: usize) -> Result<Vec<Mode>, RunError> {
        Ok(self.modes_with_state(count)?.1)
    }

    /// The same, with the coordinates about which they vibrate first.
    ///
    /// # Errors
    /// As for [`Prepared::modes`].
    pub fn modes_with_state(&self, count: usize) -> Result<(Vec<f64>, Vec<Mode>), RunError> {
        let mut problem = self.problem();
        if !self.method.table.is_static() {
            if self.plan.equilibrium.is_some() {
                problem.start.q = self.resting_start()?;
            }
            let modes = vibrations(&problem, &self.method, &self.plan, 0.0, count)?;
            return Ok((problem.start.q, modes));
        }
        let Equilibrium { load, q, dropped, .. } = self.equilibrium()?;
        let start = InitialState { q: q.clone(), ..problem.start };
        let plan = crate::integrators::StartPlan { dropped, ..self.plan.clone() };
        let modes = vibrations(&Problem { start, ..problem }, &self.method, &plan, load, count)?;
        Ok((q, modes))
    }
}
