//! Steps that are given.

use super::course::Course;
use super::march::{Method, Problem, Run};
use super::record::{Guide, Recorder, Steps};
use super::step::Stepper;
use super::step_choice::{Attempt, Beginning, StepChoice, Tried, march_by};
use super::{Checkpoint, Clocks, Pace, RunError, StartPlan, TimeGrid};
use crate::elements::RunScalar;

/// Runs a problem over a grid and hands every step to the recorder.
///
/// # Errors
/// [`RunError`] with step and time; steps before it have reached the recorder.
pub fn march<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    grid: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<S>,
) -> Result<Run<S>, RunError> {
    march_along(problem, method, (grid, &Vec::new()), plan, None, recorder)
}

/// As [`march`], with the values of a finished real run of the same problem where a guide is given: only derivative parts are
/// solved for, so that they belong to exactly the states of that run. Clocks have the derivative parts of the ends of steps.
///
/// # Errors
/// As for [`march`]; also a guide that does not solve the problem.
pub fn march_along<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    (grid, clocks): (&TimeGrid, &Clocks<S>),
    plan: &StartPlan,
    guide: Option<Guide>,
    recorder: &mut dyn Recorder<S>,
) -> Result<Run<S>, RunError> {
    let (guided, steps) = guide.map_or((None, None), |guide| (Some(guide.start), Some(guide.steps)));
    let mut taken = TimeGrid::begin(grid.times[0], grid.asked);
    taken.times.reserve_exact(grid.steps());
    let course = Course::new(grid, &mut taken, Pace::default());
    march_by(problem, method, Beginning { plan, clocks: Some(clocks), guided }, (Given { steps }, course), recorder)
}

/// Each stretch of the course is a step.
struct Given<'g> {
    /// Those of a finished real run.
    steps: Option<&'g mut dyn Steps>,
}

impl<S: RunScalar> StepChoice<S> for Given<'_> {
    const GOES_BACK: bool = false;

    fn next(&mut self, course: &mut Course, stepper: &Stepper<S>) -> Result<Attempt<'_>, RunError> {
        let guided = match &mut self.steps {
            Some(steps) => steps.next()?,
            None => None,
        };
        let h = f64::INFINITY;
        Ok(Attempt { h, scheme: course.scheme(&stepper.method.table, h), guided })
    }

    fn accepts(
        &mut self,
        tried: Tried,
        _course: &mut Course,
        stepper: &mut Stepper<S>,
        _before: &Checkpoint<S>,
    ) -> Result<bool, RunError> {
        tried.made?;
        if self.steps.is_none() {
            stepper.note_error();
            let stability = stepper.stability();
            stepper.note_stability(stability);
        }
        Ok(true)
    }
}
