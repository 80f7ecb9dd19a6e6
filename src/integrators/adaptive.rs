//! Steps as long as the error allows: an embedded solution measures it, a PI controller chooses the next size.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::checkpoint::StepState;
use super::course::Course;
use super::load_steps::march_loading;
use super::march::{Method, Problem, Run, embedded_difference};
use super::pause::TakenUp;
use super::record::{Recorder, SolveRecord, StepRecord};
use super::step::{InitialGuess, Stepper};
use super::{Embedded, Pace, RunError, Scheme, StartPlan, Systems, Table, TimeGrid};

/// Error allowed in one step: absolute + relative times the size of each entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative to the entry.
    pub relative: f64,
    /// In the unit of the entry.
    pub absolute: f64,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// For coordinates.
    pub coordinates: Tolerance,
    /// For velocities.
    pub velocities: Tolerance,
    /// Longest step \[s\].
    pub longest: f64,
}

/// Share of the step that the error would just allow.
const SAFETY: f64 = 0.9;
/// Least and largest ratio of two successive steps.
const CHANGE: [f64; 2] = [0.2, 5.0];
/// Exponents of the error of this step and of the one before, times the order of the estimate.
const EXPONENTS: [f64; 2] = [0.7, 0.4];
/// How often a step is halved after a failure of Newton's method.
const MOST_HALVINGS: usize = 8;
/// Steps below this share of the run do not advance it.
const SHORTEST: f64 = 1e-13;

impl StepControl {
    /// The same number for all tolerances: relative, and absolute in the units of coordinates and velocities.
    pub fn new(tolerance: f64) -> Self {
        let both = Tolerance { relative: tolerance, absolute: tolerance };
        StepControl { coordinates: both, velocities: both, longest: f64::INFINITY }
    }

    /// Checks the control and the method for a run with chosen steps.
    ///
    /// # Errors
    /// [`RunError::Input`]: a number out of range, or a method without embedded weights.
    pub fn check(&self, table: &Table) -> Result<(), RunError> {
        for (what, Tolerance { relative, absolute }) in [("coordinates", self.coordinates), ("velocities", self.velocities)]
        {
            if !(relative >= 0.0 && absolute > 0.0 && relative.is_finite() && absolute.is_finite()) {
                return Err(RunError::Input(format!(
                    "tolerances of {what} are {relative} (relative) and {absolute} (absolute); the first must be at least 0, the second above 0"
                )));
            }
        }
        if !(self.longest > 0.0) {
            return Err(RunError::Input(format!("the longest step is {} s; it must be above 0", self.longest)));
        }
        // equilibria have no error of their own: their steps are those that Newton's method can make
        if !table.is_static() && (table.embedded.is_none() || table.starter.is_some()) {
            return Err(RunError::Input(format!(
                "\"{}\" does not measure its error, so it cannot choose its steps; give it a number of steps, or use one of {}",
                table.name,
                super::tables()
                    .iter()
                    .filter(|t| t.embedded.is_some())
                    .map(|t| t.name.clone())
                    .collect::<Vec<_>>()
                    .join(", ")
            )));
        }
        Ok(())
    }
}

/// Runs a problem with steps chosen by their error (equilibria: by the success of Newton's method); `stretches` holds the start, the breakpoints and the end.
///
/// Returns the steps taken, also where the run stopped early, and its end or the reason with step and time; steps before it have
/// reached the recorder. Steps that were given up leave no trace: a run over the steps taken gives the same numbers bit by bit.
pub fn march_adaptive(
    problem: &Problem<f64>,
    method: &Method,
    control: &StepControl,
    stretches: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    let mut grid = TimeGrid::begin(stretches.times[0], 0);
    let course = Course::new(stretches, &mut grid);
    let run = control.check(&method.table).and_then(|()| {
        let march = if method.table.is_static() { march_loading } else { march_choosing };
        march(problem, method, control, course, plan, recorder)
    });
    (grid, run)
}

/// As [`march_adaptive`], with the steps taken added to the course.
fn march_choosing(
    problem: &Problem<f64>,
    method: &Method,
    control: &StepControl,
    course: Course,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<f64>,
) -> Result<Run<f64>, RunError> {
    let systems = Systems::new(problem.model, method, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &systems, plan)?;
    recorder.start(stepper.start(course.t(), plan, None)?)?;
    let mut choice = Choice::new(&stepper, control, course);
    let mut before = stepper.checkpoint();
    if let Some(taken_up) = TakenUp::by(&mut stepper, recorder)? {
        taken_up.follow(&mut choice.course);
        before = taken_up.pause.checkpoint;
        let Pace { h, last_error, rejected, .. } = taken_up.pause.pace;
        (choice.h, choice.last_error, choice.rejected) = (h, last_error, rejected);
    } else {
        choice.first_step(&mut stepper)?;
        stepper.resume(&before)?;
    }
    while !choice.course.at_end() {
        let index = choice.course.grid.steps();
        if recorder.wants_checkpoint(index) {
            recorder.checkpoint(stepper.pause(choice.course.t(), choice.pace()))?;
        }
        let reached = loop {
            let breakpoint = choice.course.at_breakpoint();
            let (span, reached) = choice.span();
            match stepper.step_over(Scheme::Main, span, breakpoint, None) {
                Ok(()) => {
                    let error = choice.error(stepper.record(), &before.between, &stepper.between);
                    if choice.accepts(error)? {
                        break reached;
                    }
                }
                Err(failure) => choice.halve(failure)?,
            }
            stepper.resume(&before)?;
        };
        choice.course.advance(reached);
        stepper.checkpoint_in(&mut before);
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    recorder.end(&|| stepper.pause(choice.course.t(), choice.pace()))?;
    Ok(stepper.end(choice.rejected))
}

/// The choice of the next step.
struct Choice<'c> {
    control: &'c StepControl,
    table: &'c Table,
    embedded: &'c Embedded,
    course: Course<'c>,
    /// Moving coordinates: those of fixed nodes have no error.
    moving: Vec<usize>,
    /// Next size \[s\], before it is fitted to the stretch.
    h: f64,
    /// Error of the last accepted step, as a share of the allowed one.
    last_error: f64,
    rejected: usize,
    halvings: usize,
    /// The step just tried was too long.
    retried: bool,
    /// Difference of the embedded solution.
    difference: Vec<f64>,
}

impl<'c> Choice<'c> {
    fn new(stepper: &Stepper<'c, f64>, control: &'c StepControl, course: Course<'c>) -> Self {
        let table = &stepper.method.table;
        let embedded = table.embedded.as_ref().expect("checked before the run");
        let nodes = stepper.problem.model.nodes.iter().filter(|node| !node.fixed);
        Choice {
            control,
            table,
            embedded,
            course,
            moving: nodes.flat_map(|node| node.dofs.clone()).collect(),
            h: 0.0,
            last_error: 1.0,
            rejected: 0,
            halvings: 0,
            retried: false,
            difference: Vec::new(),
        }
    }

    /// What the next steps depend on.
    fn pace(&self) -> Pace {
        Pace { h: self.h, last_error: self.last_error, rejected: self.rejected, ..Pace::default() }
    }

    /// Largest ratio of entries to what is allowed for them; NaN stays.
    fn ratio(&self, tolerance: Tolerance, values: &[f64], sizes: [&[f64]; 2]) -> f64 {
        let allowed = |i: usize| tolerance.absolute + tolerance.relative * sizes[0][i].abs().max(sizes[1][i].abs());
        let ratios = self.moving.iter().map(|&i| values[i].abs() / allowed(i));
        ratios.fold(0.0, |worst: f64, ratio| if ratio <= worst { worst } else { ratio })
    }

    /// First size: 1 % of the change of the state, and an estimated error of 1 % of the allowed one.
    ///
    /// Source: Hairer, Norsett, Wanner, Solving ODEs I, II.4.
    fn first_step(&mut self, stepper: &mut Stepper<f64>) -> Result<(), RunError> {
        let state = stepper.between.clone();
        let (q, v, a) = (&state.carried[0], &state.carried[1], state.acceleration());
        let duration = self.course.span(f64::INFINITY).1 - self.course.t();
        let StepControl { coordinates, velocities, .. } = *self.control;
        let states = self.ratio(coordinates, q, [q, q]).max(self.ratio(velocities, v, [v, v]));
        let changes = self.ratio(coordinates, v, [q, q]).max(self.ratio(velocities, a, [v, v]));
        let trial = if states > 1e-5 && changes > 1e-5 { 0.01 * states / changes } else { 1e-6 * duration };
        let trial = trial.min(self.control.longest).min(duration);
        // the change of the acceleration along an explicit step
        let moved = |x: &[f64], rate: &[f64]| -> Vec<f64> { x.iter().zip(rate).map(|(x, rate)| x + trial * rate).collect() };
        let mut later = SolveRecord::empty();
        let solved = stepper.solve_acceleration(
            (&moved(q, v), &moved(v, a)),
            self.course.t() + trial,
            0,
            InitialGuess::Zero,
            &mut later,
        );
        let curvature = match solved {
            Ok(()) => {
                let change: Vec<f64> = later.unknowns.x.iter().zip(a).map(|(new, old)| (new - old) / trial).collect();
                self.ratio(velocities, &change, [v, v])
            }
            // the trial went too far to tell
            Err(_) => 0.0,
        };
        let fastest: f64 = changes.max(curvature);
        let exponent = 1.0 / (self.embedded.order as f64 + 1.0);
        let h = if fastest > 1e-15 { (0.01 / fastest).powf(exponent) } else { 1e-3 * duration };
        self.h = h.min(100.0 * trial).min(self.control.longest);
        Ok(())
    }

    /// Start and end of the next step as elements see them, and its end.
    fn span(&mut self) -> ((f64, f64), f64) {
        self.h = self.h.min(self.control.longest);
        self.course.span(self.h)
    }

    /// Estimated error of a step as a share of the allowed one.
    fn error(&mut self, step: &StepRecord<f64>, before: &StepState<f64>, after: &StepState<f64>) -> f64 {
        let mut error = std::mem::take(&mut self.difference);
        let of = |place: usize, tolerance, error: &[f64]| {
            self.ratio(tolerance, error, [&before.carried[place], &after.carried[place]])
        };
        let solutions = (self.table, self.embedded);
        embedded_difference(solutions, 0, step, &before.carried, &mut error);
        let of_q = of(0, self.control.coordinates, &error);
        embedded_difference(solutions, 1, step, &before.carried, &mut error);
        let of_v = of(1, self.control.velocities, &error);
        self.difference = error;
        if of_q >= of_v || of_q.is_nan() { of_q } else { of_v }
    }

    /// Judges the step just made and chooses the next size.
    fn accepts(&mut self, error: f64) -> Result<bool, RunError> {
        let order = self.embedded.order as f64 + 1.0;
        if error <= 1.0 {
            let least = error.max(1e-10);
            let factor = SAFETY * least.powf(-EXPONENTS[0] / order) * self.last_error.powf(EXPONENTS[1] / order);
            // right after a failure there is no reason to grow
            let most = if self.retried { 1.0 } else { CHANGE[1] };
            self.h = self.tried() * factor.clamp(CHANGE[0], most);
            (self.last_error, self.retried, self.halvings) = (least, false, 0);
            return Ok(true);
        }
        let factor =
            if error.is_finite() { (SAFETY * error.powf(-1.0 / order)).clamp(CHANGE[0], SAFETY) } else { CHANGE[0] };
        self.shorten(factor)?;
        Ok(false)
    }

    /// Size of the step just tried \[s\].
    fn tried(&mut self) -> f64 {
        let ((t, end), _) = self.span();
        end - t
    }

    /// Shortens the step after a failure of Newton's method, or gives up.
    fn halve(&mut self, failure: RunError) -> Result<(), RunError> {
        self.halvings += 1;
        if self.halvings > MOST_HALVINGS {
            return Err(failure);
        }
        self.shorten(0.5).map_err(|_| failure)
    }

    fn shorten(&mut self, factor: f64) -> Result<(), RunError> {
        self.rejected += 1;
        self.retried = true;
        self.h = factor * self.tried();
        if self.h > SHORTEST * self.course.duration() {
            return Ok(());
        }
        Err(RunError::StepSize { step: self.course.grid.steps() + 1, t: self.course.t(), h: self.h })
    }
}
