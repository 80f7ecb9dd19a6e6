//! Timed runs of one motion with one method, from coarse to fine.

use costate::history::{Keep, Watch};
use costate::integrators::{ConstraintLevel, Counters, Method, RunError, StepRecord, Table, march, tables};
use costate::scenes::{AnyScene, Prepared, Settings};
use std::time::Instant;

/// No finer run follows one whose error is below this.
pub const FINE: f64 = 1e-8;
/// Smaller errors are not shown: the references are not good enough.
pub const LEAST: f64 = 1e-10;
/// Most systems (stages and projections) of a run.
const MOST_SYSTEMS: usize = 30_000;
/// A run is repeated once, and again until this time is spent, so that short ones are measured too [s].
const LEAST_TIME: f64 = 2e-3;

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
}

/// The end of a motion, to compare with.
pub struct Reference {
    /// Coordinates.
    pub end: Vec<f64>,
    /// Their relative error, estimated.
    pub error: f64,
    /// Steps with which it was found.
    pub steps: usize,
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    pub steps: usize,
    /// Relative error of the coordinates at the end.
    pub error: f64,
    /// Time [s].
    pub seconds: f64,
    pub counters: Counters,
}

/// The runs of one table at one level.
pub struct Ladder {
    pub table: String,
    pub level: ConstraintLevel,
    /// From coarse to fine.
    pub runs: Vec<Run>,
    /// Steps with which there was no solution.
    pub failed: Vec<usize>,
}

/// Largest difference of two vectors by the largest entry of the second.
pub fn relative_error(ours: &[f64], exact: &[f64]) -> f64 {
    let largest =
        |x: &mut dyn Iterator<Item = f64>| x.fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() });
    largest(&mut ours.iter().zip(exact).map(|(a, b)| a - b)) / largest(&mut exact.iter().copied())
}

/// Moving coordinates at the end, and the work done.
fn end_of(prepared: &Prepared) -> Result<(Vec<f64>, Counters), RunError> {
    let mut nothing = Watch(|_: &StepRecord<f64>| true);
    let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut nothing)?;
    let moving = prepared.model().nodes.iter().filter(|node| !node.fixed).flat_map(|node| node.dofs.clone());
    Ok((moving.map(|index| run.q[index]).collect(), run.counters))
}

impl Motion {
    /// The scene without its functionals, which would take time too; nothing is kept.
    fn prepared(&self, method: Method, steps: usize) -> Result<Prepared<'static>, String> {
        let x: Vec<f64> = self.scene.design_variables().iter().map(|variable| variable.initial).collect();
        let settings = Settings { end: self.end, steps, ..self.scene.default_settings() };
        let mut prepared = Prepared::with(self.scene, &x, method, settings).map_err(|error| error.to_string())?;
        prepared.keep = Keep::Nothing;
        prepared.mechanism.functionals.clear();
        Ok(prepared)
    }

    /// The table of the highest order, at acceleration level.
    pub fn reference_method(&self) -> Method {
        let best = tables().into_iter().max_by_key(|table| table.order).expect("a table is listed");
        Method::new(best, ConstraintLevel::Acceleration)
    }

    /// A long run with small steps, and how much its end differs from that with twice the step.
    ///
    /// Where a stiff member drowns the smallest steps in round-off, longer ones are taken.
    pub fn reference(&self) -> Result<Reference, String> {
        let end = |steps: usize| {
            let prepared = self.prepared(self.reference_method(), steps)?;
            end_of(&prepared).map(|(q, _)| q).map_err(|error| format!("reference of {}: {error}", self.name))
        };
        let mut steps = self.reference_steps;
        loop {
            match end(steps).and_then(|fine| Ok((end(steps / 2)?, fine))) {
                Ok((coarse, end)) => return Ok(Reference { error: relative_error(&coarse, &end), end, steps }),
                Err(error) if steps < 2 * self.coarsest => return Err(error),
                Err(_) => steps /= 2,
            }
        }
    }

    /// Runs with halved steps until the error is below [`FINE`] or the work is done.
    pub fn ladder(&self, table: &Table, level: ConstraintLevel, exact: &[f64]) -> Result<Ladder, String> {
        let implicit = table.stages.iter().filter(|stage| stage.known.is_none()).count();
        let projections = if level == ConstraintLevel::Acceleration { 2 } else { 0 };
        let mut ladder = Ladder { table: table.name.to_string(), level, runs: Vec::new(), failed: Vec::new() };
        let mut steps = self.coarsest;
        while steps * (implicit + projections) <= MOST_SYSTEMS {
            match self.timed(Method::new(table.clone(), level), steps, exact)? {
                Some(run) => {
                    ladder.runs.push(run);
                    if run.error < FINE {
                        break;
                    }
                }
                None => ladder.failed.push(steps),
            }
            steps *= 2;
        }
        Ok(ladder)
    }

    /// `None` where the steps were too long to find a solution.
    fn timed(&self, method: Method, steps: usize, exact: &[f64]) -> Result<Option<Run>, String> {
        let prepared = self.prepared(method, steps)?;
        let analysis = prepared.analysis();
        let begun = Instant::now();
        let Ok((q, counters)) = end_of(&prepared) else { return Ok(None) };
        let mut seconds = begun.elapsed().as_secs_f64();
        let (mut repeated, all) = (false, Instant::now());
        while !repeated || all.elapsed().as_secs_f64() < LEAST_TIME {
            let begun = Instant::now();
            analysis.values(&prepared.x).map_err(|error| format!("{}, the second time: {error}", self.name))?;
            seconds = seconds.min(begun.elapsed().as_secs_f64());
            repeated = true;
        }
        Ok(Some(Run { steps, error: relative_error(&q, exact), seconds, counters }))
    }
}

impl Ladder {
    /// Runs whose error is shown.
    pub fn shown(&self) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(|run| run.error >= LEAST)
    }

    /// Time [s] for an error, between the last run above it and the next, on logarithmic scales; `None` if it was not reached.
    pub fn time_for(&self, error: f64) -> Option<f64> {
        // a coarse run may be right by chance: the run after the last one above it counts
        let next = self.runs.iter().rposition(|run| !(run.error <= error)).map_or(0, |last| last + 1);
        let fine = self.runs.get(next)?;
        let Some(coarse) = next.checked_sub(1).map(|index| &self.runs[index]) else { return Some(fine.seconds) };
        let share = (error / coarse.error).ln() / (fine.error / coarse.error).ln();
        let time = (coarse.seconds.ln() + share * (fine.seconds / coarse.seconds).ln()).exp();
        // from a wild run to a good one nothing lies between
        Some(if time.is_finite() { time } else { fine.seconds })
    }
}
