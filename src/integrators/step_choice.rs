//! The march of a run, whatever chooses its steps.

use super::course::Course;
use super::march::{Method, Problem, Run};
use super::pause::TakenUp;
use super::record::{Recorder, StepRecord};
use super::step::Stepper;
use super::{Checkpoint, Clocks, RunError, Scheme, StartPlan, StartRecord};
use crate::elements::RunScalar;

/// A step that is to be tried.
pub(super) struct Attempt<'g> {
    /// About its size \[s\]; it is fitted to the stretch.
    pub h: f64,
    pub scheme: Scheme,
    /// That of a finished real run.
    pub guided: Option<&'g StepRecord<f64>>,
}

/// A step that was tried.
pub(super) struct Tried {
    /// Start and end as elements saw them \[s\].
    pub span: (f64, f64),
    /// Its end \[s\].
    pub reached: f64,
    /// Whether its systems were solved.
    pub made: Result<(), RunError>,
}

/// How a run chooses its steps. What goes from one step to the next stands in the pace of the course, which runs that are taken up keep.
pub(super) trait StepChoice<S> {
    /// Whether a step may be tried anew: only then is kept what it takes to go back.
    const GOES_BACK: bool;

    /// Looks for the first size, where the run is not taken up; the stepper is then as it was.
    fn begin(&mut self, _course: &mut Course, _stepper: &mut Stepper<S>, _before: &Checkpoint<S>) -> Result<(), RunError> {
        Ok(())
    }

    /// The step to be tried now.
    fn next(&mut self, course: &mut Course, stepper: &Stepper<S>) -> Result<Attempt<'_>, RunError>;

    /// Whether a step that was tried is taken; otherwise another one is tried from its start.
    ///
    /// # Errors
    /// Why no step could be taken there.
    fn accepts(
        &mut self,
        tried: Tried,
        course: &mut Course,
        stepper: &mut Stepper<S>,
        before: &Checkpoint<S>,
    ) -> Result<bool, RunError>;
}

/// What a run begins with, beside its problem.
pub(super) struct Beginning<'r, S> {
    pub plan: &'r StartPlan,
    pub clocks: Option<&'r Clocks<S>>,
    /// The start of a finished real run.
    pub guided: Option<&'r StartRecord<f64>>,
}

impl<'r, S> Beginning<'r, S> {
    /// By a plan alone.
    pub fn of(plan: &'r StartPlan) -> Self {
        Beginning { plan, clocks: None, guided: None }
    }
}

/// Runs a problem to the end of a course and hands every step that is taken to the recorder.
pub(super) fn march_by<S: RunScalar, C: StepChoice<S>>(
    problem: &Problem<S>,
    method: &Method,
    Beginning { plan, clocks, guided }: Beginning<S>,
    (mut choice, mut course): (C, Course),
    recorder: &mut dyn Recorder<S>,
) -> Result<Run<S>, RunError> {
    let system = method.system(problem.model, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &system, plan)?;
    if let Some(clocks) = clocks {
        stepper.clocks.clone_from(clocks);
    }
    recorder.start(stepper.start(course.t(), plan, guided)?)?;
    let mut before = Checkpoint::default();
    if let Some(taken_up) = TakenUp::by(&mut stepper, recorder)? {
        taken_up.follow(&mut course);
        before = taken_up.pause.checkpoint;
    } else if C::GOES_BACK {
        stepper.checkpoint_in(&mut before);
        choice.begin(&mut course, &mut stepper, &before)?;
    }
    while !course.at_end() {
        let index = stepper.next_step();
        if recorder.wants_checkpoint(index) {
            recorder.checkpoint(stepper.pause(course.t(), course.pace))?;
        }
        let reached = loop {
            let Attempt { h, scheme, guided } = choice.next(&mut course, &stepper)?;
            let (span, reached) = course.span(h);
            let made = stepper.step_over(scheme, span, course.at_breakpoint(), guided);
            if choice.accepts(Tried { span, reached, made }, &mut course, &mut stepper, &before)? {
                break reached;
            }
            stepper.resume(&before)?;
        };
        course.advance(reached);
        if C::GOES_BACK {
            stepper.checkpoint_in(&mut before);
        }
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    recorder.end(&|| stepper.pause(course.t(), course.pace))?;
    Ok(stepper.end(course.pace.rejected))
}
