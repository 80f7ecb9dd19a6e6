//! Timed runs of one motion with one method, from coarse to fine.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::course::{Forces, Member, run};
use crate::Clock;
use costate::integrators::{ConstraintLevel, Counters, Method, NewtonTolerance, StepControl, Table, tables};
use costate::scenes::{AnyScene, Prepared, Settings};

/// Error below which most motions are fine enough.
pub const FINE: f64 = 1e-8;
/// A run is repeated until this time is spent, so that short ones are measured too [s].
const LEAST_TIME: f64 = 10e-3;
/// Tolerances of runs that choose their steps, from coarse to fine.
const TOLERANCES: [f64; 11] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];

/// A motion that is compared.
pub struct Motion {
    pub name: &'static str,
    pub scene: &'static dyn AnyScene,
    /// Duration [s].
    pub end: f64,
    /// Steps of the coarsest run.
    pub coarsest: usize,
    /// Steps of the reference.
    pub reference_steps: usize,
    /// Most systems (stages and projections) of a run.
    pub most_systems: usize,
    /// Force in a stiff member.
    pub member: Option<Member>,
    /// What is compared, number by number, instead of the coordinates.
    pub compared: Option<Compared>,
    /// No finer run follows one whose error is below this.
    pub fine: f64,
}

/// Numbers to be compared for the coordinates of the model.
pub type Compared = fn(&Prepared, &[f64]) -> Vec<f64>;

/// A motion to compare with.
pub struct Reference {
    /// Coordinates at the end.
    pub end: Vec<f64>,
    /// Forces over the motion.
    pub forces: Forces,
    /// Relative error of the coordinates, estimated.
    pub error: f64,
    /// Relative error of the forces, estimated.
    pub force_error: f64,
    /// Steps with which it was found.
    pub steps: usize,
}

/// How the steps of a run are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steps {
    /// Of equal size, as many.
    Equal(usize),
    /// By the error allowed in each.
    Chosen(f64),
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    pub laid: Steps,
    /// Steps taken.
    pub steps: usize,
    /// Relative error of the coordinates at the end.
    pub error: f64,
    /// Relative error of the forces, the largest over the motion.
    pub force_error: f64,
    /// Time [s].
    pub seconds: f64,
    pub counters: Counters,
}

/// The runs of one table at one level.
pub struct Ladder {
    /// Name of the table, with words if it chooses its steps or does not go to round-off.
    pub name: String,
    pub level: ConstraintLevel,
    /// When Newton's method stops.
    pub newton: NewtonTolerance,
    /// From coarse to fine.
    pub runs: Vec<Run>,
    /// Steps with which there was no solution.
    pub failed: Vec<Steps>,
}

/// Largest difference of two vectors; a NaN wins.
pub fn difference(ours: &[f64], exact: &[f64]) -> f64 {
    let differences = ours.iter().zip(exact).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |most: f64, x| if x <= most { most } else { x })
}

impl Motion {
    /// The scene without its functionals, which would take time too.
    pub fn prepared(&self, method: Method, steps: Steps) -> Result<Prepared<'static>, String> {
        let x: Vec<f64> = self.scene.variables().iter().map(|variable| variable.initial).collect();
        let (steps, control) = match steps {
            Steps::Equal(steps) => (steps, None),
            Steps::Chosen(tolerance) => (1, Some(StepControl::new(tolerance))),
        };
        let settings = Settings { end: self.end, steps, control, ..self.scene.settings().without_method() };
        let mut prepared = Prepared::with(self.scene, &x, method, settings).map_err(|error| error.to_string())?;
        prepared.mechanism.functionals.clear();
        Ok(prepared)
    }

    /// Largest difference by the largest coordinate, or of each number by itself where others are compared.
    fn relative_error(&self, ours: &[f64], exact: &[f64]) -> f64 {
        let share = |a: &f64, b: &f64| (a - b).abs() / b.abs();
        match self.compared {
            Some(_) => {
                ours.iter().zip(exact).map(|(a, b)| share(a, b)).fold(0.0, |most: f64, x| if x <= most { most } else { x })
            }
            None => difference(ours, exact) / exact.iter().fold(0.0, |most: f64, x| most.max(x.abs())),
        }
    }

    /// What is compared: moving coordinates among those of the model, unless there is something else.
    pub fn moving(&self, prepared: &Prepared, q: &[f64]) -> Vec<f64> {
        if let Some(compared) = self.compared {
            return compared(prepared, q);
        }
        let moving = prepared.model().nodes.iter().filter(|node| !node.fixed).flat_map(|node| node.dofs.clone());
        moving.map(|index| q[index]).collect()
    }

    /// A long run with small steps of the table of the highest order, and how much it differs from that with twice the step.
    pub fn reference(&self) -> Result<Reference, String> {
        let best = tables().into_iter().max_by_key(|table| table.order).expect("a table is listed");
        let motion = |steps: usize| {
            let prepared = self.prepared(Method::new(best.clone(), ConstraintLevel::Acceleration), Steps::Equal(steps))?;
            let mut forces = Forces::default();
            let end = run(&prepared, self.member, Some(&mut forces));
            let (end, _) = end.map_err(|error| format!("reference of {}: {error}", self.name))?;
            Ok::<_, String>((self.moving(&prepared, &end.q), forces))
        };
        let steps = self.reference_steps;
        let ((coarse, coarse_forces), (end, forces)) = (motion(steps / 2)?, motion(steps)?);
        let (error, force_error) = (self.relative_error(&coarse, &end), coarse_forces.error(&forces));
        Ok(Reference { end, forces, error, force_error, steps })
    }

    /// Runs with halved steps until the error is fine enough or the work is done.
    pub fn ladder(
        &self,
        table: &Table,
        level: ConstraintLevel,
        newton: NewtonTolerance,
        reference: &Reference,
    ) -> Result<Ladder, String> {
        let implicit = table.stages.iter().filter(|stage| stage.known.is_none()).count();
        let projections = if level == ConstraintLevel::Acceleration { 2 } else { 0 };
        let mut ladder = Ladder::new(table.name.to_string(), level, newton);
        let mut steps = self.coarsest;
        while steps * (implicit + projections) <= self.most_systems {
            if ladder.add(self, table, Steps::Equal(steps), reference)? {
                break;
            }
            steps *= 2;
        }
        Ok(ladder)
    }

    /// Runs that choose their steps, with tolerances a tenth of the one before each, at acceleration level.
    pub fn chosen(&self, table: &Table, newton: NewtonTolerance, reference: &Reference) -> Result<Ladder, String> {
        let mut ladder = Ladder::new(format!("{}, chosen steps", table.name), ConstraintLevel::Acceleration, newton);
        // work grows with the root of the order of the error estimate
        let growth = table.embedded.as_ref().map_or(1.0, |embedded| 10f64.powf(1.0 / (embedded.order as f64 + 1.0)));
        for tolerance in TOLERANCES {
            let finished = ladder.add(self, table, Steps::Chosen(tolerance), reference)?;
            let systems = ladder.runs.last().map_or(0, |run| run.counters.systems);
            if finished || growth * systems as f64 > self.most_systems as f64 {
                break;
            }
        }
        Ok(ladder)
    }
}

impl Ladder {
    fn new(table: String, level: ConstraintLevel, newton: NewtonTolerance) -> Self {
        let rule = if newton == NewtonTolerance::RoundOff { String::new() } else { format!(", {}", newton.name()) };
        Ladder { name: format!("{table}{rule}"), level, newton, runs: Vec::new(), failed: Vec::new() }
    }

    /// Adds a run; true if no finer one is needed.
    fn add(&mut self, motion: &Motion, table: &Table, steps: Steps, reference: &Reference) -> Result<bool, String> {
        let method = Method { tolerance: self.newton, ..Method::new(table.clone(), self.level) };
        let prepared = motion.prepared(method, steps)?;
        let mut forces = Forces::default();
        let (clock, all) = (Clock::start(), Clock::start());
        let Ok((end, taken)) = run(&prepared, motion.member, Some(&mut forces)) else {
            self.failed.push(steps);
            return Ok(false);
        };
        let mut seconds = clock.seconds();
        while all.seconds() < LEAST_TIME {
            let clock = Clock::start();
            run(&prepared, None, None).map_err(|error| format!("{}, the second time: {error}", motion.name))?;
            seconds = seconds.min(clock.seconds());
        }
        let error = motion.relative_error(&motion.moving(&prepared, &end.q), &reference.end);
        let force_error = forces.error(&reference.forces);
        self.runs.push(Run { laid: steps, steps: taken, error, force_error, seconds, counters: end.counters });
        Ok(error < motion.fine)
    }

    /// Time [s] from which on `error` of all runs is below a limit, between the last run above it and the next on logarithmic
    /// scales; `None` if it was not reached.
    pub fn time_for(&self, error: fn(&Run) -> f64, limit: f64) -> Option<f64> {
        // a coarse run may be right by chance: the run after the last one above it counts
        let next = self.runs.iter().rposition(|run| !(error(run) <= limit)).map_or(0, |last| last + 1);
        let fine = self.runs.get(next)?;
        let Some(coarse) = next.checked_sub(1).map(|index| &self.runs[index]) else { return Some(fine.seconds) };
        let share = (limit / error(coarse)).ln() / (error(fine) / error(coarse)).ln();
        let time = (coarse.seconds.ln() + share * (fine.seconds / coarse.seconds).ln()).exp();
        // from a wild run to a good one nothing lies between
        Some(if time.is_finite() { time } else { fine.seconds })
    }
}

impl std::fmt::Display for Steps {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Steps::Equal(steps) => write!(f, "{steps}"),
            Steps::Chosen(tolerance) => write!(f, "tolerance {tolerance:e}"),
        }
    }
}
