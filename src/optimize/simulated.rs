//! A design simulated in all its cases, several at once, and differentiated there.

use super::Work;
use super::optimization::{Case, GradientBy, Optimization};
use super::runs_at_once::{results_of_all, teams};
use super::scaling::Scaling;
use crate::exchange::{Sent, sent_by_fields};
use crate::functionals::Extremes;
use crate::history::Watch;
use crate::integrators::{Counters, RunError, StepRecord};
use crate::scenes::{ModeMeasure, Prepared};
use crate::sensitivity::Forward;
use std::ops::Range;
use std::sync::OnceLock;
use std::time::Instant;

/// A simulated design, as its gradient needs it.
pub(super) struct Simulated<'s> {
    pub design: Vec<f64>,
    /// Of the functionals that the problem names, in their order.
    pub values: Vec<f64>,
    /// What their aggregates are made of.
    pub extremes: Vec<Option<Extremes>>,
    /// Names of the events of all runs.
    pub events: Vec<String>,
    runs: Vec<CaseRun<'s>>,
}

/// A case in which the problem measures something.
struct CaseRun<'s> {
    result: CaseResult,
    /// The ranks that have its steps.
    team: Range<usize>,
    kept: OnceLock<Kept<'s>>,
}

/// What its gradient needs, where it was simulated.
struct Kept<'s> {
    prepared: Prepared<'s>,
    /// None where nothing but modes is measured.
    forward: Option<Forward>,
    modes: Vec<ModeMeasure>,
}

/// What all ranks know of it.
struct CaseResult {
    /// Of its functionals.
    values: Vec<f64>,
    extremes: Vec<Option<Extremes>>,
    events: Vec<String>,
    /// Their numbers among those of the problem.
    places: Vec<usize>,
    counters: Counters,
    /// What it took.
    seconds: f64,
}
sent_by_fields!(CaseResult { values, extremes, events, places, counters, seconds });

/// What a gradient is made with.
pub(super) struct Differentiation<'p> {
    pub scaling: &'p Scaling,
    /// Functionals whose gradients count.
    pub wanted: &'p [bool],
    /// Asked between runs.
    pub wants_to_stop: &'p (dyn Fn() -> bool + Sync),
}

/// Calls a function for each job, several at once where there are several; the first error counts.
fn all_at_once<T: Sent + Send>(
    teams: &[Range<usize>],
    run: impl Fn(usize) -> Result<T, RunError> + Sync,
) -> Result<Vec<T>, RunError> {
    let missing = || Err(RunError::Input("a case was not run".into()));
    results_of_all(teams, run).into_iter().map(|own| own.unwrap_or_else(missing)).collect()
}

impl<'o> Optimization<'o> {
    /// Builds a design and simulates it in the cases of which the problem names a functional. `costs` are the times of one rank that each case has
    /// taken last; for all ranks the same numbers, unless there is only one case.
    pub(super) fn simulate(
        &'o self,
        design: &[f64],
        costs: &mut [f64],
        wants_to_stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<Simulated<'o>, RunError> {
        let measures = |case: &usize| self.places.iter().any(|place| place.0 == *case);
        let cases: Vec<usize> = (0..self.cases.len()).filter(measures).collect();
        let teams = teams(&cases.iter().map(|&case| costs[case]).collect::<Vec<_>>());
        let mut kept: Vec<OnceLock<Kept>> = cases.iter().map(|_| OnceLock::new()).collect();
        let results = all_at_once(&teams, |number| {
            let (case, begun) = (&self.cases[cases[number]], Instant::now());
            let run = self.case_run(cases[number], design, wants_to_stop);
            let (own, mut result) = run.map_err(|error| in_case(case, error))?;
            result.seconds = begun.elapsed().as_secs_f64();
            kept[number].get_or_init(|| own);
            Ok(result)
        })?;
        for ((&case, own), team) in cases.iter().zip(&results).zip(&teams) {
            costs[case] = own.seconds * team.len() as f64;
        }
        let (mut values, mut extremes) = (vec![f64::NAN; self.places.len()], vec![None; self.places.len()]);
        for own in &results {
            for (&place, (&value, extreme)) in own.places.iter().zip(own.values.iter().zip(&own.extremes)) {
                values[place] = value;
                extremes[place] = extreme.clone();
            }
        }
        let events = results.iter().flat_map(|own| own.events.iter().cloned()).collect();
        let runs = results.into_iter().zip(teams).zip(kept.drain(..));
        let runs = runs.map(|((result, team), kept)| CaseRun { result, team, kept }).collect();
        Ok(Simulated { design: design.to_vec(), values, extremes, events, runs })
    }

    fn case_run(
        &'o self,
        number: usize,
        design: &[f64],
        wants_to_stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<(Kept<'o>, CaseResult), RunError> {
        let Case { scene, method, settings, .. } = &self.cases[number];
        let mut prepared = Prepared::with(*scene, design, method.clone(), settings.clone())?;
        prepared.keep_steps_of(&self.grids[number]);
        let known = |name: &str| self.places.iter().position(|place| place.0 == number && place.1 == name);
        prepared.mechanism.functionals.retain(|functional| known(&functional.name).is_some());
        prepared.mechanism.functionals.sort_by_key(|functional| known(&functional.name));
        prepared.keep = self.keep.clone();
        let modes = scene.modes().into_iter().filter(|mode| known(&mode.name).is_some()).collect::<Vec<_>>();
        let names = prepared.functionals().iter().map(|own| &own.name).chain(modes.iter().map(|mode| &mode.name));
        let places = names.filter_map(|name| known(name)).collect();
        let (values, extremes, events, counters) = Default::default();
        let mut result = CaseResult { values, extremes, events, places, counters, seconds: 0.0 };
        let mut forward = None;
        if !prepared.functionals().is_empty() {
            let mut watch = Watch(|_: &StepRecord<f64>| !wants_to_stop());
            let (own, stopped) = prepared.analysis().observed(design, &mut watch)?;
            if wants_to_stop() {
                return Err(RunError::Interrupted { steps: own.history.steps() });
            }
            stopped.map_or(Ok(()), Err)?;
            prepared.analysis().check_values(&own)?;
            (result.values, result.extremes, result.counters) = (own.values.clone(), own.extremes.clone(), own.counters);
            result.events = prepared.analysis().events(&own).into_iter().map(|own| own.name).collect();
            forward = Some(own);
        }
        result.values.extend(prepared.measured_modes(&modes)?);
        result.extremes.resize(result.values.len(), None);
        Ok((Kept { prepared, forward, modes }, result))
    }

    /// Gradients of the functionals with respect to all design variables; zero for those that do not count.
    pub(super) fn rows(
        &self,
        simulated: &Simulated,
        how: &Differentiation,
        work: &mut Work,
    ) -> Result<Vec<Vec<f64>>, RunError> {
        let counts = |run: &&CaseRun| run.result.places.iter().any(|&place| how.wanted[place]);
        let runs: Vec<&CaseRun> = simulated.runs.iter().filter(counts).collect();
        let teams: Vec<Range<usize>> = runs.iter().map(|run| run.team.clone()).collect();
        let made = all_at_once(&teams, |number| {
            let (mut own, CaseRun { result, kept, .. }) = (Work::default(), runs[number]);
            let kept = kept.get().ok_or_else(|| RunError::Input("a case was not kept".into()))?;
            let rows = kept.rows(&result.places, self.gradient, how, &mut own)?;
            Ok((rows, own))
        })?;
        let mut all = vec![vec![0.0; simulated.design.len()]; simulated.values.len()];
        for (run, (rows, own)) in runs.into_iter().zip(made) {
            *work += own;
            for (&place, row) in run.result.places.iter().zip(rows).filter(|(place, _)| how.wanted[**place]) {
                all[place] = row;
            }
        }
        Ok(all)
    }
}

/// An error with the name of the scenario; what was interrupted stays that.
fn in_case(case: &Case, error: RunError) -> RunError {
    let stays = case.name.is_empty() || matches!(error, RunError::Interrupted { .. });
    if stays { error } else { RunError::Input(case.told(error.to_string())) }
}

impl Simulated<'_> {
    /// The work of all its runs.
    pub fn add_counters(&self, work: &mut Work) {
        self.runs.iter().for_each(|run| work.simulation += run.result.counters);
        work.simulations += self.runs.len();
    }
}

impl Kept<'_> {
    /// Of functionals, then of modes, whose derivatives are always their own.
    fn rows(
        &self,
        places: &[usize],
        by: GradientBy,
        how: &Differentiation,
        work: &mut Work,
    ) -> Result<Vec<Vec<f64>>, RunError> {
        let (of_run, of_modes) = places.split_at(self.prepared.functionals().len());
        let mut rows = match &self.forward {
            Some(forward) => self.rows_of_run(forward, of_run, by, how, work)?,
            None => Vec::new(),
        };
        let wanted = self.modes.iter().zip(of_modes).filter(|(_, place)| how.wanted[**place]);
        let wanted: Vec<ModeMeasure> = wanted.map(|own| own.0.clone()).collect();
        let mut found = self.prepared.measured_modes_by_design(&wanted)?.into_iter();
        let zeros = || vec![0.0; self.prepared.x.len()];
        rows.extend(of_modes.iter().map(|&place| how.wanted[place].then(|| found.next()).flatten().unwrap_or_else(zeros)));
        Ok(rows)
    }

    fn rows_of_run(
        &self,
        forward: &Forward,
        places: &[usize],
        by: GradientBy,
        how: &Differentiation,
        work: &mut Work,
    ) -> Result<Vec<Vec<f64>>, RunError> {
        let prepared = &self.prepared;
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let gradient = match by {
            GradientBy::Adjoint => {
                work.sweeps += 1;
                let wanted: Vec<bool> = places.iter().map(|&place| how.wanted[place]).collect();
                analysis.adjoint_of(x, forward, &wanted)?
            }
            GradientBy::ComplexStep => {
                work.sweeps += x.len();
                analysis.complex_step(x, forward)?
            }
            GradientBy::Difference { share } => return self.differences(forward, share, how, work),
        };
        work.gradient += gradient.counters;
        Ok(gradient.rows)
    }

    /// One simulation for each variable that varies, at a design that differs by a share of its value (of its scale where it is 0).
    fn differences(
        &self,
        forward: &Forward,
        share: f64,
        how: &Differentiation,
        work: &mut Work,
    ) -> Result<Vec<Vec<f64>>, RunError> {
        let prepared = &self.prepared;
        let analysis = prepared.analysis().on_steps_of(forward);
        let mut rows = vec![vec![0.0; prepared.x.len()]; forward.values.len()];
        for (&variable, &(_, size)) in how.scaling.varying.iter().zip(&how.scaling.measures) {
            let mut x = prepared.x.clone();
            let step = share * if x[variable] == 0.0 { size } else { x[variable].abs() };
            let inside = x[variable] + step <= prepared.variables[variable].upper;
            x[variable] += if inside { step } else { -step };
            let step = x[variable] - prepared.x[variable];
            let Forward { values, counters, .. } = analysis.forward(&x)?;
            work.sweeps += 1;
            work.gradient += counters;
            for ((row, value), here) in rows.iter_mut().zip(values).zip(&forward.values) {
                row[variable] = (value - here) / step;
            }
            if (how.wants_to_stop)() {
                return Err(RunError::Interrupted { steps: 0 });
            }
        }
        Ok(rows)
    }
}
