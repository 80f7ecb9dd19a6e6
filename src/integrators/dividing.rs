//! Given steps, divided where Newton's method cannot make them.

use super::course::Course;
use super::march::{Method, Problem, Run};
use super::pause::TakenUp;
use super::record::Recorder;
use super::step::Stepper;
use super::{Pace, RunError, StartPlan, Systems, TimeGrid};

/// How often a step is halved before the run is given up.
const MOST_HALVINGS: usize = 8;

/// Runs a problem over a grid, each step of which is halved, and its halves again, where Newton's method finds no solution: a snap
/// that is faster than the step leaves none near by.
///
/// Returns the steps taken and what [`march`](super::march) returns; the run counts the attempts that were given up. A run over the steps
/// taken gives the same numbers bit by bit.
pub fn march_dividing(
    problem: &Problem<f64>,
    method: &Method,
    steps: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    let mut grid = TimeGrid::begin(steps.times[0], steps.asked);
    let run = divide(problem, method, Course::new(steps, &mut grid), plan, recorder);
    (grid, run)
}

fn divide(
    problem: &Problem<f64>,
    method: &Method,
    mut course: Course,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> Result<Run<f64>, RunError> {
    let systems = Systems::new(problem.model, method, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &systems, plan)?;
    recorder.start(stepper.start(course.t(), plan, None)?)?;
    let mut before = stepper.checkpoint();
    // a given step is one part of itself until it is halved
    let whole = Pace { h: f64::INFINITY, left: 1, ..Pace::default() };
    let mut pace = whole;
    if let Some(taken_up) = TakenUp::by(&mut stepper, recorder)? {
        taken_up.follow(&mut course);
        (before, pace) = (taken_up.pause.checkpoint, taken_up.pause.pace);
    }
    while !course.at_end() {
        let index = course.grid.steps();
        if recorder.wants_checkpoint(index) {
            recorder.checkpoint(stepper.pause(course.t(), pace))?;
        }
        let (span, reached) = course.span(pace.h);
        course.grid.times.push(reached);
        let scheme = method.table.scheme_at(course.grid, index);
        course.grid.times.pop();
        let made = stepper.step_over(scheme, span, course.at_breakpoint(), None);
        let stability = if made.is_ok() { stepper.stability() } else { None };
        match made {
            // a shorter step tells a path that loses its stability from a leap onto another one
            Ok(()) if pace.halvings == MOST_HALVINGS || !stepper.loses(stability) => {}
            Ok(()) | Err(RunError::NoConvergence { .. } | RunError::NotFinite { .. } | RunError::Singular { .. })
                if pace.halvings < MOST_HALVINGS =>
            {
                let Pace { rejected, halvings, left, .. } = pace;
                let h = 0.5 * (reached - span.0);
                pace = Pace { h, rejected: rejected + 1, halvings: halvings + 1, left: 2 * left, ..whole };
                stepper.resume(&before)?;
                continue;
            }
            Ok(()) => {}
            Err(error) => return Err(error),
        }
        stepper.note_error();
        stepper.note_stability(stability);
        course.advance(reached);
        stepper.checkpoint_in(&mut before);
        pace.left -= 1;
        if pace.left == 0 {
            pace = Pace { rejected: pace.rejected, ..whole };
        }
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    recorder.end(&|| stepper.pause(course.t(), pace))?;
    Ok(stepper.end(pace.rejected))
}
