//! Steps as long as the error allows: an embedded solution measures it, a PI controller chooses the next size.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::checkpoint::StepState;
use super::initial_guess::InitialGuess;
use super::load_steps::{Loading, first_step_size};
use super::march::{Method, Problem, Run, embedded_difference};
use super::record::{Observer, SolveRecord, StepRecord};
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::time_loop::{RunStart, StepSelection, TrialOutcome, TrialStep, time_loop};
use super::{Checkpoint, Embedded, RunError, Scheme, StartPlan, StepSizeState, Table, TimeGrid};

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

/// Share of the step that the error would just allow, as in Hairer, Norsett, Wanner, II.4.
const SAFETY: f64 = 0.9;
/// Least and largest ratio of two successive steps.
const CHANGE: [f64; 2] = [0.2, 5.0];
/// Exponents of the error of this step and of the one before, times the order of the estimate: Hairer, Wanner, Solving ODEs II, IV.2.
const EXPONENTS: [f64; 2] = [0.7, 0.4];
/// How often a step is halved after a failure of Newton's method.
const MOST_HALVINGS: usize = 8;
/// Steps below this share of the run do not advance it: its times are rounded by a thousandth of such a step.
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
    recorder: &mut dyn Observer<f64>,
) -> (TimeGrid, Result<Run<f64>, RunError>) {
    let mut grid = TimeGrid::begin(stretches.times[0], 0);
    let mut interval = RunInterval::new(stretches, &mut grid, FIRST_STEP_SIZE);
    let run = control.check(&method.table).and_then(|()| {
        let start = RunStart { plan, clocks: None, guided: None };
        if method.table.is_static() {
            interval.step_size = first_step_size(interval.duration());
            return time_loop(problem, method, start, (Loading::new(control), interval), recorder);
        }
        let selection = ByError::new(problem, &method.table, control);
        time_loop(problem, method, start, (selection, interval), recorder)
    });
    (grid, run)
}

const FIRST_STEP_SIZE: StepSizeState = StepSizeState { h: 0.0, last_error: 1.0, rejected: 0, halvings: 0, left: 0 };

struct ByError<'c> {
    control: &'c StepControl,
    table: &'c Table,
    embedded: &'c Embedded,
    /// Moving coordinates: those of fixed nodes have no error.
    moving: Vec<usize>,
    retried: bool,
    difference: Vec<f64>,
}

impl<'c> ByError<'c> {
    fn new(problem: &Problem<f64>, table: &'c Table, control: &'c StepControl) -> Self {
        let embedded = table.embedded.as_ref().expect("checked before the run");
        let nodes = problem.model.nodes.iter().filter(|node| !node.fixed);
        let moving = nodes.flat_map(|node| node.dofs.clone()).collect();
        ByError { control, table, embedded, moving, retried: false, difference: Vec::new() }
    }

    /// Largest ratio of entries to what is allowed for them; NaN stays.
    fn ratio(&self, tolerance: Tolerance, values: &[f64], sizes: [&[f64]; 2]) -> f64 {
        let allowed = |i: usize| tolerance.absolute + tolerance.relative * sizes[0][i].abs().max(sizes[1][i].abs());
        let ratios = self.moving.iter().map(|&i| values[i].abs() / allowed(i));
        ratios.fold(0.0, |worst: f64, ratio| if ratio <= worst { worst } else { ratio })
    }

    /// Estimated error of a step as a share of the allowed one. In a step that begins with an acceleration of its own, the solution without the
    /// explicit first stage has a say where it is further away than is allowed.
    fn error(&mut self, step: &StepRecord<f64>, before: &StepState<f64>, after: &StepState<f64>) -> f64 {
        let own = self.error_of(self.embedded, step, before, after);
        let implicit = self.embedded.implicit.as_deref().filter(|_| step.begins_anew(before.step));
        let other = implicit.map_or(0.0, |implicit| self.error_of(implicit, step, before, after));
        if other <= 1.0 || own >= other || own.is_nan() { own } else { other }
    }

    fn error_of(
        &mut self,
        other: &Embedded,
        step: &StepRecord<f64>,
        before: &StepState<f64>,
        after: &StepState<f64>,
    ) -> f64 {
        let mut error = std::mem::take(&mut self.difference);
        let of = |place: usize, tolerance, error: &[f64]| {
            self.ratio(tolerance, error, [&before.carried[place], &after.carried[place]])
        };
        embedded_difference((self.table, other), 0, step, &mut error);
        let of_q = of(0, self.control.coordinates, &error);
        embedded_difference((self.table, other), 1, step, &mut error);
        let of_v = of(1, self.control.velocities, &error);
        self.difference = error;
        if of_q >= of_v || of_q.is_nan() { of_q } else { of_v }
    }

    /// Whether a step of size `h` with this error is taken; chooses the next size.
    fn accepts_error(&mut self, error: f64, h: f64, interval: &mut RunInterval) -> Result<bool, RunError> {
        let order = self.embedded.order as f64 + 1.0;
        if error <= 1.0 {
            let least = error.max(1e-10);
            let factor =
                SAFETY * least.powf(-EXPONENTS[0] / order) * interval.step_size.last_error.powf(EXPONENTS[1] / order);
            // right after a failure there is no reason to grow
            let most = if self.retried { 1.0 } else { CHANGE[1] };
            self.retried = false;
            interval.step_size =
                StepSizeState { h: h * factor.clamp(CHANGE[0], most), last_error: least, halvings: 0, ..interval.step_size };
            return Ok(true);
        }
        let factor =
            if error.is_finite() { (SAFETY * error.powf(-1.0 / order)).clamp(CHANGE[0], SAFETY) } else { CHANGE[0] };
        self.shorten(factor * h, interval)?;
        Ok(false)
    }

    fn shorten(&mut self, h: f64, interval: &mut RunInterval) -> Result<(), RunError> {
        self.retried = true;
        interval.step_size.rejected += 1;
        interval.step_size.h = h;
        if h > SHORTEST * interval.duration() {
            return Ok(());
        }
        Err(RunError::step_size(interval.grid.steps() + 1, interval.t(), h))
    }
}

impl StepSelection<f64> for ByError<'_> {
    /// First size: 1 % of the change of the state, and an estimated error of 1 % of the allowed one.
    ///
    /// Source: Hairer, Norsett, Wanner, Solving ODEs I, II.4.
    fn begin(
        &mut self,
        interval: &mut RunInterval,
        stepper: &mut Stepper<f64>,
        before: &Checkpoint<f64>,
    ) -> Result<(), RunError> {
        let state = &before.between;
        let (q, v, a) = (&state.carried[0], &state.carried[1], state.acceleration());
        let duration = interval.span(f64::INFINITY).1 - interval.t();
        let StepControl { coordinates, velocities, .. } = *self.control;
        let states = self.ratio(coordinates, q, [q, q]).max(self.ratio(velocities, v, [v, v]));
        let changes = self.ratio(coordinates, v, [q, q]).max(self.ratio(velocities, a, [v, v]));
        let trial = if states > 1e-5 && changes > 1e-5 { 0.01 * states / changes } else { 1e-6 * duration };
        let trial = trial.min(self.control.longest).min(duration);
        // the change of the acceleration along an explicit step
        let moved = |x: &[f64], rate: &[f64]| -> Vec<f64> { x.iter().zip(rate).map(|(x, rate)| x + trial * rate).collect() };
        let mut later = SolveRecord::default();
        let solved = stepper.solve_acceleration(
            (&moved(q, v), &moved(v, a)),
            interval.t() + trial,
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
        interval.step_size.h = h.min(100.0 * trial).min(self.control.longest);
        stepper.resume(before)
    }

    fn next(&mut self, interval: &mut RunInterval, _stepper: &Stepper<f64>) -> Result<TrialStep<'_>, RunError> {
        interval.step_size.h = interval.step_size.h.min(self.control.longest);
        Ok(TrialStep { h: interval.step_size.h, scheme: Scheme::Main, guided: None })
    }

    fn accepts(
        &mut self,
        TrialOutcome { span: (t, end), made, .. }: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<f64>,
        before: &Checkpoint<f64>,
    ) -> Result<bool, RunError> {
        let h = end - t;
        let Err(failure) = made else {
            let error = self.error(stepper.record(), &before.between, &stepper.between);
            return self.accepts_error(error, h, interval);
        };
        interval.step_size.halvings += 1;
        if interval.step_size.halvings > MOST_HALVINGS {
            return Err(failure.of_all_steps());
        }
        self.shorten(0.5 * h, interval).map(|()| false).map_err(|_| failure.of_all_steps())
    }
}
