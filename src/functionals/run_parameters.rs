use crate::assembly::Model;
use crate::elements::RunScalar;
use crate::integrators::{Events, SideChange, StartRecord, StepRecord};

/// Parameters of a run, with the sides of switches of functionals, and directions of slip, in the step that is made.
pub(crate) struct RunParameters<S> {
    p: Vec<S>,
    /// These sides and where they stand, if there are any.
    sides: Vec<f64>,
    switches: Option<Events>,
}

impl<S: RunScalar> RunParameters<S> {
    /// Before the start.
    pub fn new(model: &Model, p: &[S]) -> Self {
        let switches = (!model.measured.is_empty() || !model.frictions.is_empty()).then(|| Events::new(model));
        RunParameters { p: p.to_vec(), sides: Vec::new(), switches }
    }

    /// The start of the run.
    pub fn start(&mut self, start: &StartRecord<S>) {
        self.sides.clone_from(&start.sides);
        self.change_sides(&[]);
    }

    /// The next step.
    pub fn step(&mut self, step: &StepRecord<S>) {
        if !step.switched.is_empty() {
            self.change_sides(&step.switched);
        }
    }

    /// The parameters.
    pub fn p(&self) -> &[S] {
        &self.p
    }

    fn change_sides(&mut self, changes: &[SideChange]) {
        let Some(events) = self.switches.as_ref().filter(|_| !self.sides.is_empty()) else { return };
        changes.iter().for_each(|own| self.sides[own.switch] = own.sides[1]);
        events.write(&self.sides, &mut self.p);
    }
}
