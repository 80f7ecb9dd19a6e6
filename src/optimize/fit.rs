//! Scenes fitted to what was measured.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::confidence::Confidence;
use super::levenberg_marquardt::{Least, Residuals, levenberg_marquardt};
use super::runs_at_once::run_at_once;
use super::starts::starts;
use super::{Case, DesignHistory, DesignPoint, NoValue, Watcher};
use crate::design::{DesignVariable, check_design, shortest};
use crate::elements::RunScalar;
use crate::integrators::{RunError, TimeGrid};
use crate::scalar::{Complex64, Tangents};
use crate::scenes::{AnyScene, FitProblem, Loss, Measurement, Prepared, Prior, Scenario, unknown};
use crate::sensitivity::{Forward, Samples};
use nalgebra::{DMatrix, DVector};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// A scene with what was measured, checked, and how it is simulated.
///
/// ```no_run
/// use costate::optimize::Fit;
/// use costate::scenes::built_in;
/// let fit = Fit::of(built_in::named("damped-oscillator")?)?;
/// let fitted = fit.run(&fit.initial(), &mut ())?;
/// println!("{:?} with deviation {}", fitted.design, fitted.confidence.deviation(0));
/// # Ok::<(), costate::integrators::RunError>(())
/// ```
pub struct Fit<'s> {
    /// The scene.
    pub scene: &'s dyn AnyScene,
    /// What was measured.
    pub problem: FitProblem,
    /// In which circumstances a design is simulated: scenarios in which something was measured, or the scene itself.
    pub cases: Vec<Case<'s>>,
    /// Most iterations.
    pub iterations: usize,
    variables: Vec<DesignVariable>,
    varying: Vec<usize>,
    /// Of each measurement its case, the name of its functional there, and the place of its delay among the variables.
    places: Vec<(usize, String, Option<usize>)>,
    units: Vec<String>,
    /// The steps of each case at the initial design, whose numbers between breakpoints all designs have.
    grids: Vec<TimeGrid>,
}

/// A measurement beside what the fitted scene says.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedCurve {
    /// What the functional measures at the times of the measurement.
    pub values: Vec<f64>,
    /// Standard deviations of these by those of the variables.
    pub deviations: Vec<f64>,
    /// These less the measured values, in units of the deviations of the measurement where it has some.
    pub residuals: Vec<f64>,
    /// How far values between steps may be from those of the motion, estimated, in the same units; 0 at the ends of steps.
    pub between_steps: Vec<f64>,
}

/// A scene fitted to what was measured.
#[derive(Debug)]
pub struct Fitted {
    /// All design variables.
    pub design: Vec<f64>,
    /// Sum of the losses of all residuals, those of priors among them: chi^2 with the linear loss.
    pub sum: f64,
    /// Number of residuals less that of the variables that are estimated.
    pub degrees: usize,
    /// What is known of the variables.
    pub confidence: Confidence,
    /// The measurements in their order.
    pub curves: Vec<FittedCurve>,
    /// Iterations.
    pub iterations: usize,
    /// Whether it is a least sum at least nearby, to first order.
    pub is_optimum: bool,
    /// Whether it ended at the limit of iterations.
    pub is_limit: bool,
    /// All designs that were simulated, with the sum as objective.
    pub history: DesignHistory,
    /// What the last design that could not be simulated failed with.
    pub failure: Option<RunError>,
}

/// A design simulated in all cases.
struct Simulated<'s> {
    design: Vec<f64>,
    runs: Vec<CaseRun<'s>>,
    values: Vec<f64>,
    between_steps: Vec<f64>,
}

/// A case as its derivatives need it.
struct CaseRun<'s> {
    prepared: Prepared<'s>,
    forward: Forward,
    samples: Vec<Samples>,
}

impl<'s> Fit<'s> {
    /// A scene's own measurements, with its own methods and settings.
    ///
    /// # Errors
    /// A scene without measurements, and those of [`Fit::new`].
    pub fn of(scene: &'s dyn AnyScene) -> Result<Self, RunError> {
        let problem = scene.fit_problem();
        let problem =
            problem.ok_or_else(|| RunError::Input(format!("the scene \"{}\" has no measurements", scene.name())))?;
        let cases = Scenario::all_of(scene).into_iter().map(Case::of).collect::<Result<_, _>>()?;
        Self::new(scene, problem, cases)
    }

    /// Checks measurements against a scene that is simulated in some circumstances.
    ///
    /// # Errors
    /// A name that the scene has not, another unit, times outside of the run, fewer numbers than variables.
    pub fn new(scene: &'s dyn AnyScene, problem: FitProblem, cases: Vec<Case<'s>>) -> Result<Self, RunError> {
        let variables = scene.variables();
        let names: Vec<String> = variables.iter().map(|own| own.name.clone()).collect();
        let variable = |name: &String| {
            let found = names.iter().position(|own| own == name);
            found.ok_or_else(|| RunError::Input(unknown("design variable", name, &names)))
        };
        let varying = match &problem.varying {
            Some(names) => names.iter().map(variable).collect::<Result<Vec<_>, _>>()?,
            None => (0..variables.len()).filter(|&i| variables[i].lower < variables[i].upper).collect(),
        };
        problem.priors.iter().try_for_each(|own| variable(&own.variable).map(drop))?;
        let initial: Vec<f64> = variables.iter().map(|own| own.initial).collect();
        let (mut known, mut grids) = (Vec::new(), Vec::new());
        for (place, case) in cases.iter().enumerate() {
            let prepared = Prepared::with(case.scene, &initial, case.method.clone(), case.settings.clone())?;
            let named = |own: &crate::functionals::Functional| (place, own.name.clone(), own.unit);
            known.extend(prepared.functionals().iter().map(named));
            grids.push(prepared.grid);
        }
        let (mut places, mut units) = (Vec::new(), Vec::new());
        for own in &problem.measurements {
            let (case, functional, unit) = functional_of(own, &cases, &known)?;
            check_unit(own, &functional, unit)?;
            let delay = own.delay.as_ref().map(variable).transpose()?;
            check_times(own, cases[case].settings.end, delay.map(|place| &variables[place]))?;
            places.push((case, functional, delay));
            units.push(unit.to_string());
        }
        check_numbers(&problem, varying.len())?;
        let iterations = 100;
        Ok(Fit { scene, problem, cases, iterations, variables, varying, places, units, grids })
    }

    /// The design variables.
    pub fn variables(&self) -> &[DesignVariable] {
        &self.variables
    }

    /// Places of those that vary.
    pub fn varying(&self) -> &[usize] {
        &self.varying
    }

    /// Units of the measurements.
    pub fn units(&self) -> &[String] {
        &self.units
    }

    /// The scene's own design.
    pub fn initial(&self) -> Vec<f64> {
        self.variables.iter().map(|own| own.initial).collect()
    }

    /// Designs to start from: the given one, and others that fill the ranges of the variables that vary evenly, the same in every run.
    pub fn starts(&self, first: &[f64], count: usize) -> Vec<Vec<f64>> {
        starts(&self.variables, &self.varying, first, count)
    }

    /// Residuals of measurements and priors at a design, in units of their deviations.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn residuals(&self, design: &[f64]) -> Result<Vec<f64>, RunError> {
        let simulated = self.simulate(design, &|| false)?;
        Ok(self.residuals_of(design, &simulated.values))
    }

    /// Their derivatives by the variables that vary, `rows[residual][variable]`: by tangent runs, or by complex-step runs to check them.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn jacobian(&self, design: &[f64], by_complex_step: bool) -> Result<Vec<Vec<f64>>, RunError> {
        let simulated = self.simulate(design, &|| false)?;
        let rows = match by_complex_step {
            true => self.rows::<Complex64>(&simulated)?,
            false => self.rows::<Tangents>(&simulated)?,
        };
        Ok(rows.row_iter().map(|row| row.iter().copied().collect()).collect())
    }

    /// Fits from a design, by Levenberg and Marquardt's method within the bounds.
    ///
    /// # Errors
    /// A design out of bounds, a start that cannot be simulated, a design without derivatives, [`RunError::Interrupted`] at the wish of the watcher. A
    /// later design that cannot be simulated is no error: the step to it was too long.
    pub fn run(&self, start: &[f64], watcher: &mut dyn Watcher) -> Result<Fitted, RunError> {
        check_design(&self.variables, start).map_err(RunError::Input)?;
        let variables = self.variables.iter().map(|own| (own.name.clone(), own.unit.into())).collect();
        let history = DesignHistory { variables, ..DesignHistory::default() };
        let measured = self.problem.measurements.iter().map(|own| own.times.len()).sum();
        let mut search = Search { fit: self, start, measured, history, failure: None, watcher };
        let bounds: Vec<(f64, f64)> = self.of_varying(|own| (own.lower, own.upper));
        let first: Vec<f64> = self.varying.iter().map(|&place| start[place]).collect();
        let least = levenberg_marquardt(&mut search, &first, &bounds, self.iterations);
        let Search { history, failure, .. } = search;
        match (least, failure) {
            (Ok(least), failure) => Ok(self.fitted(least, history, failure)),
            (Err(NoValue::Failed), Some(failure)) => Err(failure),
            (Err(_), _) => Err(RunError::Interrupted { steps: 0 }),
        }
    }

    fn fitted(&self, least: Least<Simulated>, history: DesignHistory, failure: Option<RunError>) -> Fitted {
        let Least { x, evaluated, residuals, jacobian, curved, half_sum, iterations, is_optimum, is_limit } = least;
        let sizes: Vec<f64> = self.varying.iter().zip(&x).map(|(&i, &x)| self.variables[i].size(x)).collect();
        let is_inside = |place: usize| bound_of(&self.variables[self.varying[place]], x[place]).is_none();
        let estimated: Vec<usize> = (0..x.len()).filter(|&place| is_inside(place)).collect();
        let (sum, degrees) = (2.0 * half_sum, residuals.len() - estimated.len());
        let variance = if self.has_deviations() { 1.0 } else { sum / degrees as f64 };
        let confidence = Confidence::new(&curved, &sizes, estimated, variance);
        let (mut curves, mut first) = (Vec::new(), 0);
        for own in &self.problem.measurements {
            let rows = first..first + own.times.len();
            first = rows.end;
            let unit = |row: usize| own.deviation(row - rows.start);
            let deviation = |row: usize| {
                let derivatives: Vec<f64> = jacobian.row(row).iter().copied().collect();
                unit(row) * confidence.of_number(&derivatives, &sizes)
            };
            curves.push(FittedCurve {
                values: evaluated.values[rows.clone()].to_vec(),
                deviations: rows.clone().map(deviation).collect(),
                residuals: residuals.as_slice()[rows.clone()].to_vec(),
                between_steps: rows.clone().map(|row| evaluated.between_steps[row] / unit(row)).collect(),
            });
        }
        let design = evaluated.design;
        Fitted { design, sum, degrees, confidence, curves, iterations, is_optimum, is_limit, history, failure }
    }

    fn has_deviations(&self) -> bool {
        self.problem.measurements.iter().all(|own| own.deviations.is_some())
    }

    fn of_varying<T>(&self, of: impl Fn(&DesignVariable) -> T) -> Vec<T> {
        self.varying.iter().map(|&place| of(&self.variables[place])).collect()
    }

    /// Numbers of the cases in which something was measured.
    fn measured_cases(&self) -> Vec<usize> {
        (0..self.cases.len()).filter(|case| self.places.iter().any(|own| own.0 == *case)).collect()
    }

    /// Runs all cases, several at once.
    fn simulate(&self, design: &[f64], wants_to_stop: &(dyn Fn() -> bool + Sync)) -> Result<Simulated<'s>, RunError> {
        let cases = self.measured_cases();
        let runs = all_at_once(cases.len(), |number| {
            let case = &self.cases[cases[number]];
            let run = self.simulate_case(cases[number], design, wants_to_stop);
            run.map_err(|error| match error {
                RunError::Interrupted { .. } => error,
                _ if case.name.is_empty() => error,
                error => RunError::Input(case.told(error.to_string())),
            })
        })?;
        let (runs, of_cases) = runs.into_iter().unzip();
        let (values, between_steps) = self.in_order(&cases, of_cases).into_iter().unzip();
        Ok(Simulated { design: design.to_vec(), runs, values, between_steps })
    }

    /// A case with its values, and how exact these are between steps.
    fn simulate_case(
        &self,
        number: usize,
        design: &[f64],
        wants_to_stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<(CaseRun<'s>, Vec<(f64, f64)>), RunError> {
        let Case { scene, method, settings, .. } = &self.cases[number];
        let mut prepared = Prepared::with(*scene, design, method.clone(), settings.clone())?;
        prepared.keep_steps_of(&self.grids[number]);
        prepared
            .mechanism
            .functionals
            .retain(|own| self.places.iter().any(|place| place.0 == number && place.1 == own.name));
        let samples = self.places.iter().zip(&self.problem.measurements).filter(|(place, _)| place.0 == number);
        let samples: Vec<Samples> = samples
            .map(|((_, name, delay), own)| {
                let functional = prepared.functionals().iter().position(|own| own.name == *name).unwrap_or_default();
                Samples { functional, times: own.times.clone(), delay: *delay }
            })
            .collect();
        let sampled = prepared.analysis().sampled(design, &samples, &|| !wants_to_stop())?;
        if let Some(value) = sampled.values.iter().find(|own| !own.is_finite()) {
            return Err(RunError::Input(format!("a measured quantity is {value}: look at its formula and parameters")));
        }
        let values = sampled.values.into_iter().zip(sampled.between_steps).collect();
        Ok((CaseRun { prepared, forward: sampled.forward, samples }, values))
    }

    /// What cases have for their own measurements, in the order of all.
    fn in_order<T>(&self, cases: &[usize], of_cases: Vec<Vec<T>>) -> Vec<T> {
        let mut rest: Vec<_> = of_cases.into_iter().map(Vec::into_iter).collect();
        let mut all = Vec::new();
        for (place, own) in self.places.iter().zip(&self.problem.measurements) {
            let case = cases.iter().position(|case| *case == place.0).unwrap_or_default();
            all.extend(rest[case].by_ref().take(own.times.len()));
        }
        all
    }

    /// Residuals of computed values, and of priors behind them.
    fn residuals_of(&self, design: &[f64], values: &[f64]) -> Vec<f64> {
        let measured =
            self.problem.measurements.iter().flat_map(|own| (0..own.times.len()).map(|k| (own.values[k], own.deviation(k))));
        let of_prior = |own: &Prior| (design[self.place_of(own)] - own.mean) / own.deviation;
        let of_values = values.iter().zip(measured).map(|(value, (measured, deviation))| (value - measured) / deviation);
        of_values.chain(self.problem.priors.iter().map(of_prior)).collect()
    }

    fn place_of(&self, prior: &Prior) -> usize {
        self.variables.iter().position(|own| own.name == prior.variable).unwrap_or_default()
    }

    /// Derivatives of the residuals by the variables that vary.
    fn rows<S: RunScalar>(&self, simulated: &Simulated) -> Result<DMatrix<f64>, RunError> {
        let cases = self.measured_cases();
        let of_cases = all_at_once(cases.len(), |number| {
            let CaseRun { prepared, forward, samples } = &simulated.runs[number];
            let analysis = prepared.analysis();
            Ok(analysis.sampled_by_design::<S>(&simulated.design, &self.varying, forward, samples)?.0)
        })?;
        let mut rows = self.in_order(&cases, of_cases);
        let deviations = self.problem.measurements.iter().flat_map(|own| (0..own.times.len()).map(|k| own.deviation(k)));
        for (row, deviation) in rows.iter_mut().zip(deviations) {
            row.iter_mut().for_each(|entry| *entry /= deviation);
        }
        for prior in &self.problem.priors {
            let place = self.place_of(prior);
            let entry = |varying: &usize| if *varying == place { 1.0 / prior.deviation } else { 0.0 };
            rows.push(self.varying.iter().map(entry).collect());
        }
        if let Some(column) = (0..self.varying.len()).find(|&j| rows.iter().any(|row| !row[j].is_finite())) {
            let name = &self.variables[self.varying[column]].name;
            return Err(RunError::Input(format!(
                "a measured quantity has no derivative by \"{name}\" at a state of the run, as a distance or a norm has none where it vanishes; \
                 measure its square or a component"
            )));
        }
        Ok(DMatrix::from_fn(rows.len(), self.varying.len(), |i, j| rows[i][j]))
    }
}

/// The bound at which a variable is, up to round-off.
pub(super) fn bound_of(variable: &DesignVariable, x: f64) -> Option<f64> {
    let is_at = |bound: &f64| (x - bound).abs() <= crate::tolerances::LONG_SUM * variable.size(x);
    [variable.lower, variable.upper].into_iter().find(is_at)
}

/// Calls a function for each number, several at once where there are several; the first error counts.
fn all_at_once<T: Send>(count: usize, run: impl Fn(usize) -> Result<T, RunError> + Sync) -> Result<Vec<T>, RunError> {
    if count == 1 {
        return Ok(vec![run(0)?]);
    }
    let results: Vec<Mutex<Option<Result<T, RunError>>>> = (0..count).map(|_| Mutex::new(None)).collect();
    run_at_once(count, rayon::current_num_threads(), |number| {
        *results[number].lock().unwrap_or_else(PoisonError::into_inner) = Some(run(number));
    });
    let missing = || Err(RunError::Input("a case was not run".into()));
    results.into_iter().map(|own| own.into_inner().unwrap_or_else(PoisonError::into_inner).unwrap_or_else(missing)).collect()
}

/// The case of a measurement, the name of its functional there, and its unit.
fn functional_of(
    own: &Measurement,
    cases: &[Case],
    known: &[(usize, String, &'static str)],
) -> Result<(usize, String, &'static str), RunError> {
    let full = |(case, name, _): &(usize, String, &str)| cases[*case].full_name(name);
    let by_full_name = known.iter().find(|own_known| full(own_known) == own.functional);
    let by_name: Vec<_> = known.iter().filter(|(_, name, _)| *name == own.functional).collect();
    let found = match (by_full_name, &by_name[..]) {
        (Some(found), _) => found,
        (None, &[found]) => found,
        (None, []) => {
            let names: Vec<String> = known.iter().map(full).collect();
            let why = unknown("functional", &own.functional, &names);
            return Err(RunError::Input(format!("measurement \"{}\": {why}", own.name)));
        }
        (None, several) => {
            let names: Vec<String> = several.iter().map(|own| full(own)).collect();
            return Err(RunError::Input(format!(
                "measurement \"{}\": several scenarios have \"{}\": say which one, as in \"{}\"",
                own.name, own.functional, names[0]
            )));
        }
    };
    Ok(found.clone())
}

fn check_unit(own: &Measurement, functional: &str, unit: &str) -> Result<(), RunError> {
    let plain = |unit: &str| match unit.replace(['^', ' ', '*', '.'], "").replace('²', "2").as_str() {
        "" | "1" => "-".into(),
        plain => plain.to_string(),
    };
    match &own.unit {
        Some(measured) if plain(measured) != plain(unit) => Err(RunError::Input(format!(
            "measurement \"{}\" is in {measured}, but \"{functional}\" is in {unit}: write the column in {unit}, or measure by a formula that is in \
             {measured}",
            own.name
        ))),
        _ => Ok(()),
    }
}

/// Whether there are as many values and deviations as times, which lie in the run, whatever the delay.
fn check_times(own: &Measurement, end: f64, delay: Option<&DesignVariable>) -> Result<(), RunError> {
    let Measurement { name, times, values, deviations, .. } = own;
    let counts = [times.len(), values.len(), deviations.as_ref().map_or(times.len(), Vec::len)];
    let is_sound = counts.iter().all(|count| *count == counts[0])
        && values.iter().all(|own| own.is_finite())
        && deviations.iter().flatten().all(|own| *own > 0.0);
    if !is_sound {
        let [times, values, deviations] = counts;
        return Err(RunError::Input(format!(
            "measurement \"{name}\" has {times} times, {values} values and {deviations} deviations: there must be as many, values must be finite, and \
             deviations greater than 0"
        )));
    }
    let (least, most) = delay.map_or((0.0, 0.0), |own| (own.lower, own.upper));
    let (Some(first), Some(last)) = (own.times.first(), own.times.last()) else {
        return Err(RunError::Input(format!("measurement \"{}\" has no values", own.name)));
    };
    let outside = |t: f64, why: &str| {
        let (name, t, end) = (&own.name, shortest(t), shortest(end));
        Err(RunError::Input(format!(
            "measurement \"{name}\" has a value at {t} s{why}, but the run is one from 0 to {end} s: cut the table, or let the run end later"
        )))
    };
    let by = |delay: f64| if delay == 0.0 { String::new() } else { format!(", less a delay of {} s", shortest(delay)) };
    let rounding = crate::tolerances::SAME_TIME * end;
    match (first - most, last - least) {
        (early, _) if !(early >= -rounding) => outside(*first, &by(most)),
        (_, late) if !(late <= end + rounding) => outside(*last, &by(least)),
        _ => Ok(()),
    }
}

/// Whether there are as many numbers as variables, and deviations where these count.
fn check_numbers(problem: &FitProblem, varying: usize) -> Result<(), RunError> {
    let rows = problem.measurements.iter().map(|own| own.times.len()).sum::<usize>() + problem.priors.len();
    if varying == 0 {
        return Err(RunError::Input("no design variable may change: there is nothing to fit".into()));
    }
    if rows < varying {
        let names: Vec<String> = problem.measurements.iter().map(|own| format!("\"{}\"", own.name)).collect();
        let (names, priors) = (names.join(", "), if problem.priors.is_empty() { "" } else { " and priors" });
        return Err(RunError::Input(format!(
            "the {rows} numbers of measurement {names}{priors} cannot tell {varying} design variables: measure more, or name fewer by varying of [fit]"
        )));
    }
    let [with, without]: [Vec<&Measurement>; 2] = {
        let (with, without) = problem.measurements.iter().partition(|own| own.deviations.is_some());
        [with, without]
    };
    let Some(without) = without.first() else { return Ok(()) };
    let why = match (with.is_empty(), problem.priors.is_empty(), problem.loss) {
        (true, true, Loss::Linear) => return Ok(()),
        (false, ..) => "others have one",
        (_, false, _) => "priors count by theirs",
        _ => "the loss counts residuals by it",
    };
    Err(RunError::Input(format!("measurement \"{}\" needs a deviation, as {why}", without.name)))
}

/// A search on its way.
struct Search<'f, 's, 'w> {
    fit: &'f Fit<'s>,
    start: &'f [f64],
    /// Number of residuals before those of priors.
    measured: usize,
    history: DesignHistory,
    failure: Option<RunError>,
    watcher: &'w mut dyn Watcher,
}

impl Search<'_, '_, '_> {
    fn design(&self, x: &[f64]) -> Vec<f64> {
        let mut design = self.start.to_vec();
        self.fit.varying.iter().zip(x).for_each(|(&place, &x)| design[place] = x);
        design
    }

    fn failed(&mut self, error: RunError) -> NoValue {
        if matches!(error, RunError::Interrupted { .. }) {
            return NoValue::Stop;
        }
        self.failure = Some(error);
        NoValue::Failed
    }
}

impl<'s> Residuals for Search<'_, 's, '_> {
    type Evaluated = Simulated<'s>;

    fn residuals(&mut self, x: &[f64]) -> Result<(DVector<f64>, Simulated<'s>), NoValue> {
        let (design, begun) = (self.design(x), Instant::now());
        let found = self.fit.simulate(&design, &|| self.watcher.wants_to_stop());
        let mut point = DesignPoint { evaluation: self.history.points.len(), design, ..DesignPoint::default() };
        point.work.simulations = self.fit.cases.len();
        point.work.simulation_seconds = begun.elapsed().as_secs_f64();
        point.objective = f64::NAN;
        point.fingerprint = f64::NAN;
        let found = found.map(|simulated| {
            let residuals = self.fit.residuals_of(&point.design, &simulated.values);
            let losses = residuals.iter().enumerate().map(|(row, r)| self.loss(row).rho(r * r)[0]);
            point.objective = losses.sum();
            (residuals.into(), simulated)
        });
        self.history.points.push(point);
        let goes_on = self.watcher.changed(&self.history);
        match found {
            Ok(_) if !goes_on => Err(NoValue::Stop),
            found => found.map_err(|error| self.failed(error)),
        }
    }

    fn jacobian(&mut self, _: &[f64], simulated: &Simulated<'s>) -> Result<DMatrix<f64>, NoValue> {
        let begun = Instant::now();
        let rows = self.fit.rows::<Tangents>(simulated);
        if let Some(point) = self.history.points.iter_mut().rev().find(|own| own.design == simulated.design) {
            point.work.sweeps = self.fit.cases.len() * self.fit.varying.len().div_ceil(Tangents::PARTS);
            point.work.gradient_seconds = begun.elapsed().as_secs_f64();
        }
        rows.map_err(|error| self.failed(error))
    }

    fn loss(&self, row: usize) -> Loss {
        if row < self.measured { self.fit.problem.loss } else { Loss::Linear }
    }

    fn size(&self, variable: usize, x: f64) -> f64 {
        self.fit.variables[self.fit.varying[variable]].size(x)
    }

    fn reached(&mut self, x: &[f64], _: f64) {
        let (design, before) = (self.design(x), self.history.points.iter().filter_map(|own| own.iteration).count());
        if let Some(point) = self.history.points.iter_mut().rev().find(|own| own.design == design) {
            point.iteration = Some(before);
        }
        self.watcher.changed(&self.history);
    }
}
