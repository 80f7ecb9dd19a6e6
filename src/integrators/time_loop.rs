//! The time loop of a run, whatever selects the step sizes.

use super::march::{Method, Problem, Run};
use super::record::{Observer, StepRecord};
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::{Checkpoint, Clocks, RunError, Scheme, StartPlan, StartRecord};
use crate::elements::RunScalar;

pub(super) struct TrialStep<'g> {
    /// About its size \[s\]; it is fitted to the stretch.
    pub h: f64,
    pub scheme: Scheme,
    pub guided: Option<&'g StepRecord<f64>>,
}

pub(super) struct TrialOutcome {
    /// Start and end as elements saw them \[s\].
    pub span: (f64, f64),
    pub reached: f64,
    pub made: Result<(), RunError>,
}

/// How a run selects its step sizes. What goes from one step to the next stands in the state of the interval, which resumed runs keep.
pub(super) trait StepSelection<S> {
    /// Whether a step may be tried anew: only then is kept what it takes to go back.
    fn goes_back(&self) -> bool {
        true
    }

    /// Looks for the first size, where the run is not taken up; the stepper is then as it was.
    fn begin(
        &mut self,
        _interval: &mut RunInterval,
        _stepper: &mut Stepper<S>,
        _before: &Checkpoint<S>,
    ) -> Result<(), RunError> {
        Ok(())
    }

    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<S>) -> Result<TrialStep<'_>, RunError>;

    /// Whether a trial step is accepted; otherwise another one is tried from its start.
    fn accepts(
        &mut self,
        trial: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<S>,
        before: &Checkpoint<S>,
    ) -> Result<bool, RunError>;
}

pub(super) struct RunStart<'r, S> {
    pub plan: &'r StartPlan,
    pub clocks: Option<&'r Clocks<S>>,
    pub guided: Option<&'r StartRecord<f64>>,
}

/// Runs a problem to the end of a interval and hands every step that is taken to the recorder.
pub(super) fn time_loop<S: RunScalar, C: StepSelection<S>>(
    problem: &Problem<S>,
    method: &Method,
    RunStart { plan, clocks, guided }: RunStart<S>,
    (mut selection, mut interval): (C, RunInterval),
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    let system = method.system(problem.model, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &system, plan)?;
    if let Some(clocks) = clocks {
        stepper.clocks.clone_from(clocks);
    }
    recorder.start(&stepper.start(interval.t(), plan, guided)?)?;
    let mut before = Checkpoint::default();
    let mut begins = Vec::new();
    let pause = recorder.take_up(stepper.rule(), &mut |step| {
        begins.push(step.t);
        Ok(true)
    })?;
    if let Some(pause) = pause {
        stepper.take_up(&pause)?;
        let ends = begins.iter().skip(1).chain([&pause.t]);
        ends.take(begins.len()).for_each(|&end| interval.advance(end));
        interval.step_size = pause.step_size;
        before = pause.checkpoint;
    } else if selection.goes_back() {
        stepper.checkpoint_in(&mut before);
        selection.begin(&mut interval, &mut stepper, &before)?;
    }
    while !interval.at_end() {
        let index = stepper.next_step();
        recorder.checkpoint(index, &|| stepper.pause(interval.t(), interval.step_size))?;
        let reached = loop {
            let TrialStep { h, scheme, guided } = selection.next(&mut interval, &stepper)?;
            let (span, reached) = interval.span(h);
            let made = stepper.step_over(scheme, span, interval.at_breakpoint(), guided);
            if selection.accepts(TrialOutcome { span, reached, made }, &mut interval, &mut stepper, &before)? {
                break reached;
            }
            stepper.resume(&before)?;
        };
        interval.advance(reached);
        if selection.goes_back() {
            stepper.checkpoint_in(&mut before);
        }
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    recorder.end(&|| stepper.pause(interval.t(), interval.step_size))?;
    Ok(stepper.end(interval.step_size.rejected))
}
