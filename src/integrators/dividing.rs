//! Given steps, divided where Newton's method cannot make them.

use super::course::Course;
use super::march::{Method, Problem, Run};
use super::record::Recorder;
use super::step::Stepper;
use super::step_choice::{Attempt, Beginning, StepChoice, Tried, march_by};
use super::{Checkpoint, Pace, RunError, StartPlan, TimeGrid};

/// How often a step is halved before the run is given up.
const MOST_HALVINGS: usize = 8;

/// Runs a problem over a grid, each step of which is halved, and its halves again, where Newton's method finds no solution: a snap
/// that is faster than the step leaves none near by.
///
/// Returns the steps taken and what `march` returns; the run counts the attempts that were given up. A run over the steps
/// taken gives the same numbers bit by bit.
pub fn march_dividing(
    problem: &Problem<f64>,
    method: &Method,
    steps: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    let mut grid = TimeGrid::begin(steps.times[0], steps.asked);
    let course = Course::new(steps, &mut grid, WHOLE);
    let run = march_by(problem, method, Beginning::of(plan), (Dividing, course), recorder);
    (grid, run)
}

/// A given step is one part of itself until it is halved.
const WHOLE: Pace = Pace { h: f64::INFINITY, last_error: 0.0, rejected: 0, halvings: 0, left: 1 };

struct Dividing;

impl StepChoice<f64> for Dividing {
    const GOES_BACK: bool = true;

    fn next(&mut self, course: &mut Course, stepper: &Stepper<f64>) -> Result<Attempt<'_>, RunError> {
        let h = course.pace.h;
        Ok(Attempt { h, scheme: course.scheme(&stepper.method.table, h), guided: None })
    }

    fn accepts(
        &mut self,
        Tried { span, reached, made }: Tried,
        course: &mut Course,
        stepper: &mut Stepper<f64>,
        _before: &Checkpoint<f64>,
    ) -> Result<bool, RunError> {
        let Pace { rejected, halvings, left, .. } = course.pace;
        let stability = if made.is_ok() { stepper.stability() } else { None };
        let is_divided = halvings < MOST_HALVINGS
            && match &made {
                // a shorter step tells a path that loses its stability from a leap onto another one
                Ok(()) => stepper.loses(stability),
                Err(error) => error.is_of_step(),
            };
        if is_divided {
            let h = 0.5 * (reached - span.0);
            course.pace = Pace { h, rejected: rejected + 1, halvings: halvings + 1, left: 2 * left, ..WHOLE };
            return Ok(false);
        }
        made?;
        stepper.note_error();
        stepper.note_stability(stability);
        course.pace.left -= 1;
        if course.pace.left == 0 {
            course.pace = Pace { rejected, ..WHOLE };
        }
        Ok(true)
    }
}
