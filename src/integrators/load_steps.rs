//! Load steps as long as Newton's method finds the next equilibrium.

use super::course::Course;
use super::march::{Method, Problem, Run};
use super::pause::TakenUp;
use super::record::Recorder;
use super::step::Stepper;
use super::{Pace, RunError, Scheme, StartPlan, StepControl, Systems};

/// First step, as a share of the load.
const FIRST: f64 = 0.1;
/// Steps below this share of the load find no equilibrium any more.
const SHORTEST: f64 = 1e-6;
/// Steps below this share of the load are taken where their end is unstable, too: it is the path that loses its stability.
const SHORT: f64 = 1e-3;
/// Newton iterations up to which the next step may be longer.
const QUICK: usize = 8;
/// By how much a step grows after quick convergence; a failed one is divided by it.
const GROWTH: f64 = 2.0;

/// Finds equilibria up to the end of the course: steps are halved where Newton's method fails and doubled where it converges
/// quickly; of the control only the longest step counts.
pub(super) fn march_loading(
    problem: &Problem<f64>,
    method: &Method,
    control: &StepControl,
    mut course: Course,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> Result<Run<f64>, RunError> {
    let systems = Systems::new(problem.model, method, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &systems, plan)?;
    recorder.start(stepper.start(course.t(), plan, None)?)?;
    let mut before = stepper.checkpoint();
    let mut pace = Pace { h: FIRST * course.duration(), ..Pace::default() };
    if let Some(taken_up) = TakenUp::by(&mut stepper, recorder)? {
        taken_up.follow(&mut course);
        (before, pace) = (taken_up.pause.checkpoint, taken_up.pause.pace);
    }
    while !course.at_end() {
        let index = course.grid.steps();
        if recorder.wants_checkpoint(index) {
            recorder.checkpoint(stepper.pause(course.t(), pace))?;
        }
        let mut failed = false;
        let (reached, quick, stability) = loop {
            pace.h = pace.h.min(control.longest);
            let (span, reached) = course.span(pace.h);
            let iterations = stepper.counters().iterations;
            match stepper.step_over(Scheme::Main, span, course.at_breakpoint(), None) {
                Ok(()) => {
                    let (stability, h) = (stepper.stability(), reached - span.0);
                    if h < SHORT * course.duration() || !stepper.loses(stability) {
                        break (reached, !failed && stepper.counters().iterations - iterations <= QUICK, stability);
                    }
                    (failed, pace.rejected, pace.h) = (true, pace.rejected + 1, h / GROWTH);
                }
                Err(cause @ (RunError::NoConvergence { .. } | RunError::NotFinite { .. } | RunError::Singular { .. })) => {
                    (failed, pace.rejected) = (true, pace.rejected + 1);
                    let h = (reached - span.0) / GROWTH;
                    pace.h = h;
                    if h < SHORTEST * course.duration() {
                        let t = course.t();
                        // the very first equilibrium fails for reasons of its own
                        let hint =
                            "the load may have reached its limit; follow the path by its arc length, or simulate the motion";
                        let ended = RunError::NoEquilibrium { t, h, hint, cause: cause.to_string() };
                        return Err(if index == 0 { cause } else { ended });
                    }
                }
                Err(other) => return Err(other),
            }
            stepper.resume(&before)?;
        };
        stepper.note_stability(stability);
        course.advance(reached);
        stepper.checkpoint_in(&mut before);
        if quick {
            pace.h *= GROWTH;
        }
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    recorder.end(&|| stepper.pause(course.t(), pace))?;
    Ok(stepper.end(pace.rejected))
}
