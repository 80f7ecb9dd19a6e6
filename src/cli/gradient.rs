use super::CommandLine;
use super::console::{brief, print, print_files, print_json};
use super::failure::Failure;
use super::histories::{keep, resumed};
use super::influences::{gradients, insert_gradient};
use super::interrupt::set_last_words;
use super::meshes::write_gradients;
use super::options::SceneOptions;
use super::part_sensitivities::PartSensitivities;
use super::report::Page;
use super::run::{each_scenario, report};
use super::simulation::{Simulation, Work, print_work, simulate};
use super::summary::by_name;
use crate::io::{Progress, number};
use clap::{Args, ValueEnum};
use costate::design::DesignVariable;
use costate::history::Keep;
use costate::integrators::{Counters, RunError};
use costate::program::making_time;
use costate::scenes::{OF_QUOTIENTS, Prepared, SCATTER};
use costate::sensitivity::{Forward, Gradient, SwitchError};
use serde_json::{Value, json};
use std::time::Instant;

/// Options of `costate gradient`.
#[derive(Args)]
pub struct GradientOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Compare with complex-step runs of the whole simulation, or, as --check=independent, with difference quotients of whole runs, each
    /// built and solved by itself (18 to 22 for each variable); exit code 1 if they differ
    #[arg(
        long, value_enum, value_name = "WAY", num_args = 0..=1, require_equals = true, default_missing_value = "complex-step"
    )]
    check: Option<CheckWay>,
    /// Where steps are kept for the way back: auto (in memory, or as checkpoints where that would take more than a third of what is
    /// free), memory, file:PATH, or checkpoints:MEGABYTES with the steps between computed again
    #[arg(long, value_name = "WHERE", default_value = "auto", value_parser = keep)]
    history: Keep,
    /// Go on with the run in the file of --history where it stopped, bit for bit; a finished one is not simulated again
    #[arg(long)]
    resume: bool,
}

/// What a gradient is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CheckWay {
    // along the states of the real run
    ComplexStep,
    // by difference quotients of real runs that share nothing with the gradient
    Independent,
}

impl CheckWay {
    fn words(self) -> &'static str {
        match self {
            CheckWay::ComplexStep => "complex step",
            CheckWay::Independent => "quotient of runs",
        }
    }
    fn key(self) -> &'static str {
        match self {
            CheckWay::ComplexStep => "complex_step",
            CheckWay::Independent => "quotient",
        }
    }
    /// Largest relative difference that passes.
    fn limit(self) -> f64 {
        match self {
            CheckWay::ComplexStep => LIMIT,
            CheckWay::Independent => OF_QUOTIENTS,
        }
    }
}

/// Largest relative difference between adjoint and complex step that passes.
const LIMIT: f64 = 1e-10;
/// Limit beyond which a comparison with quotients shows nothing.
const BLIND: f64 = 1e-2;
/// Entries that matter less than this share of the largest one are compared relative to that share.
const SMALL: f64 = 1e-2;

/// Share of the functional itself by which the changes that relative changes of the variables make count at least: the derivative by what it
/// does not depend on is what round-off leaves of terms of that size, and zero against zero is zero.
const ZERO: f64 = 1e-2;

/// Roundings of what a functional reads by which its derivatives may be off: each step of the way back adds some.
const ROUNDINGS: f64 = 100.0;

struct Timed {
    gradient: Gradient,
    /// Steps computed again between checkpoints.
    recomputed: usize,
    seconds: f64,
    /// For programs that were first needed here [s].
    program_seconds: f64,
}

/// Another gradient and how far the adjoint is from it.
struct Check {
    way: CheckWay,
    other: Timed,
    differences: Vec<Vec<f64>>,
    /// Of each functional, what round-off does to the other derivatives: of complex steps where the differences made it worth a look.
    scatter: Vec<Option<f64>>,
    /// Round-off of the functionals themselves, where the differences made it worth a look: derivatives that differ by less are the same.
    round_off: Vec<f64>,
    /// Of each functional, whether runs beside the design tell of a jump.
    jumps: Vec<bool>,
}

/// `costate gradient`: simulates, writes, differentiates, checks, prints.
pub fn run(options: &GradientOptions, program: &CommandLine) -> Result<(), Failure> {
    let keep = resumed(options.history.clone(), options.resume)?;
    each_scenario(&options.scene, &keep, program, |own, prepared| {
        prepared.method = own.differentiable(prepared.method.clone())?;
        differentiated(own, prepared, options.check)
    })
}

/// A simulation with its gradient.
fn differentiated(options: &SceneOptions, prepared: &Prepared, check: Option<CheckWay>) -> Result<Simulation, Failure> {
    let scene = prepared.scene;
    let mut simulation = simulate(prepared, options)?;
    let output = options.output(scene);
    let begun = || Page::by_command(scene, "simulation and gradient");
    let mut page = (!options.no_report).then(|| begun().with_simulation(prepared, &simulation.shown(prepared)));
    if simulation.stopped.is_some() {
        let json = simulation.conclude(page, simulation.json(prepared));
        report(&simulation, prepared);
        print_json(options.json, &json);
        return simulation.verdict();
    }
    let (analysis, x, forward) = (prepared.analysis(), &prepared.x, &simulation.forward);
    print_simulated(&simulation, prepared, options.json);
    let parts = PartSensitivities::of(prepared, page.is_some(), output.meshes);
    let mut by_parameters = Vec::new();
    let adjoint = timed("adjoint", forward, || {
        if parts.asked.is_empty() {
            return analysis.adjoint(x, forward);
        }
        let (gradient, rows) = analysis.adjoint_by_parameters(x, forward, &parts.asked)?;
        by_parameters = rows;
        Ok(gradient)
    });
    let adjoint = adjoint.inspect_err(|_| print_files(&simulation.files))?;
    if let Err(error) = simulation.modes.differentiate(prepared) {
        print_files(&simulation.files);
        return Err(error.into());
    }
    let forward = &simulation.forward;
    let switched = analysis.switch_errors(forward, &adjoint.gradient).inspect_err(|_| print_files(&simulation.files))?;
    let behind: Vec<&str> =
        switched.iter().filter(|own| own.refused().is_some()).map(|own| own.functional.as_str()).collect();
    let check = check.map(|way| Check::by(way, prepared, forward, &adjoint)).transpose().inspect_err(|_| {
        gradients(prepared, &forward.values, &adjoint.gradient.rows, None).print();
        print_files(&simulation.files);
    })?;

    set_last_words(None);
    let other = check.as_ref().map(|own| (own.way.words(), [&own.other.gradient.rows[..], &own.differences]));
    let (gradients, modes) =
        (gradients(prepared, &forward.values, &adjoint.gradient.rows, other), simulation.modes.summary(prepared));
    gradients.print();
    modes.print();
    let mut work = vec![("simulation", simulation.work(prepared)), ("adjoint", adjoint_work(&adjoint))];
    work.extend(check.iter().map(|Check { way, other, .. }| (way.words(), work_of_check(*way, other))));
    print_work(&work);
    let ratio = adjoint.seconds / simulation.seconds;
    print(format_args!("adjoint time / forward time: {}", number(ratio)));
    check.iter().for_each(|check| check.print(&behind, prepared));
    print("");
    if output.meshes {
        let written = write_gradients(prepared, &by_parameters, &options.folder(scene));
        match written {
            Ok(path) => simulation.files.extend(path),
            Err(error) => simulation.unwritten = simulation.unwritten.or(Some(error.into())),
        }
    }
    if let Some(page) = &mut page {
        parts.colour(prepared, &by_parameters, page);
        modes.show(page);
        gradients.show(page);
        check.iter().for_each(|check| page.fact("gradient", check.in_words(&behind, prepared)));
    }
    let summary = json_of(&simulation, prepared, &adjoint, check.as_ref(), &behind);
    let summary = simulation.conclude(page, summary);
    print_files(&simulation.files);
    print_json(options.json, &summary);
    switched.iter().find_map(SwitchError::refused).map_or(Ok(()), |why| Err(Failure::run(why)))?;
    check.map_or(Ok(()), |check| check.verdict(&behind, prepared))?;
    simulation.verdict()
}

/// What is there is said before what may fail; a sweep that is stopped leaves it as its last words.
fn print_simulated(simulation: &Simulation, prepared: &Prepared, as_json: bool) {
    simulation.shown(prepared).summary(prepared).print();
    print_checkpoints(prepared, &simulation.forward);
    let mut simulated = simulation.json(prepared);
    simulated["error"] = json!("interrupted before the gradient was there");
    simulation.summarize(&simulated);
    set_last_words(as_json.then(|| simulated.to_string()));
}

fn print_checkpoints(prepared: &Prepared, forward: &Forward) {
    let checkpoints = forward.history.usage().checkpoints;
    if checkpoints > 0 && prepared.keep == Keep::Auto {
        let steps = forward.history.steps();
        print(format_args!(
            "{steps} steps would take more than a third of the free memory: {checkpoints} checkpoints are kept, and the steps between them \
             computed again (--history file:PATH keeps all)\n"
        ));
    }
}

fn timed(
    sweep: &str,
    forward: &Forward,
    differentiate: impl FnOnce() -> Result<Gradient, RunError>,
) -> Result<Timed, Failure> {
    // the sweeps do not tell how far they are: the bar only says which one is at work
    let progress = Progress::new(sweep, 1);
    progress.set(0);
    let programs = making_time();
    let begun = Instant::now();
    let before = forward.history.usage().recomputed;
    let gradient = differentiate()?;
    let recomputed = forward.history.usage().recomputed - before;
    let seconds = begun.elapsed().as_secs_f64();
    Ok(Timed { gradient, recomputed, seconds, program_seconds: making_time() - programs })
}

impl Check {
    fn by(way: CheckWay, prepared: &Prepared, forward: &Forward, adjoint: &Timed) -> Result<Self, Failure> {
        match way {
            CheckWay::ComplexStep => Check::by_complex_step(prepared, forward, adjoint),
            CheckWay::Independent => Check::independent(prepared, forward, adjoint),
        }
    }

    /// What it shows of each functional.
    fn print(&self, behind: &[&str], prepared: &Prepared) {
        for (k, functional) in prepared.functionals().iter().enumerate() {
            let (largest, limit) = (self.largest(k), self.limit(k));
            let verdict = match largest <= limit {
                true if self.blind(k, behind, prepared).is_some() => "shows nothing",
                true => "pass",
                false => "FAIL",
            };
            let scatter = self.scatter[k].filter(|_| limit > self.way.limit()).map(brief);
            let rounding = match (scatter, self.way) {
                _ if self.round_off[k] > 0.0 && self.is_within(k) => {
                    let round_off = brief(self.round_off[k]);
                    format!("; changes of the variables by their sizes make no other difference than round-off, {round_off}")
                }
                (None, _) => String::new(),
                (Some(scatter), CheckWay::ComplexStep) => {
                    format!("; a rounding of the variables changes its complex-step derivatives by {scatter} of them")
                }
                (Some(scatter), CheckWay::Independent) => format!("; round-off of the runs is {scatter} of its quotients"),
            };
            let (largest, name, other) = (brief(largest), &functional.name, self.way.words());
            print(format_args!(
                "{name}: largest relative difference to {other}: {largest} (limit {limit:.0e}): {verdict}{rounding}"
            ));
        }
    }

    fn in_words(&self, behind: &[&str], prepared: &Prepared) -> String {
        let (verdict, (largest, limit)) = (if self.passes() { "within" } else { "NOT within" }, self.figures());
        let blind =
            self.first_blind(behind, prepared).map_or_else(String::new, |why| format!(", which shows nothing: {why}"));
        let (other, largest) = (self.way.words(), brief(largest));
        format!("{verdict} {limit:.0e} of the {other}: largest relative difference {largest}{blind}")
    }

    fn verdict(&self, behind: &[&str], prepared: &Prepared) -> Result<(), Failure> {
        if self.passes() {
            return self.first_blind(behind, prepared).map_or(Ok(()), |why| Err(Failure::run(why)));
        }
        let name = self.worst_functional().map_or("", |k| prepared.functionals()[k].name.as_str());
        let ((largest, limit), other) = (self.figures(), self.way.words());
        let largest = brief(largest);
        Err(Failure::run(format!(
            "the adjoint gradient of \"{name}\" differs from the {other} by {largest}, more than {limit:.0e}"
        )))
    }

    fn by_complex_step(prepared: &Prepared, forward: &Forward, adjoint: &Timed) -> Result<Self, Failure> {
        let other = timed("complex step", forward, || prepared.analysis().complex_step(&prepared.x, forward))?;
        let mut check = Check::of(CheckWay::ComplexStep, (prepared, &forward.values), adjoint, other);
        if check.passes() {
            return Ok(check);
        }
        let (nearby, roundings) = (prepared.complex_steps_nearby()?, prepared.analysis().roundings(forward)?);
        for (k, (&value, rounding)) in forward.values.iter().zip(roundings).enumerate() {
            if check.is_within(k) {
                continue;
            }
            let apart = nearby.iter().map(|run| (run.values[k] - value).abs());
            check.round_off[k] = apart.fold(ROUNDINGS * rounding, f64::max);
            let measure = Measure { round_off: check.round_off[k], ..Measure::of(prepared, value) };
            check.differences[k] = measure.differences([&adjoint.gradient.rows[k], &check.other.gradient.rows[k]]);
            let own = std::iter::once(&check.other.gradient.rows[k][..]);
            let rows: Vec<&[f64]> = own.chain(nearby.iter().map(|run| &run.rows[k][..])).collect();
            let pairs = rows.iter().flat_map(|one| rows.iter().map(move |other| [*one, *other]));
            let apart: Vec<_> = pairs.map(|pair| measure.differences(pair)).collect();
            check.scatter[k] = Some(largest_of(&apart));
        }
        Ok(check)
    }

    /// By quotients of runs with the steps of the real one, one variable after the other.
    fn independent(prepared: &Prepared, forward: &Forward, adjoint: &Timed) -> Result<Self, Failure> {
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let analysis = if prepared.control.is_some() || prepared.divide { analysis.on_steps_of(forward) } else { analysis };
        let mut floors = vec![Vec::new(); forward.values.len()];
        let mut jumps = vec![false; forward.values.len()];
        let other = timed("quotients of runs", forward, || {
            let mut rows = vec![Vec::new(); forward.values.len()];
            for place in 0..x.len() {
                let size = prepared.variables[place].size(x[place]);
                let mut direction = vec![0.0; x.len()];
                direction[place] = size;
                for (k, quotient) in analysis.quotients(x, &direction)?.into_iter().enumerate() {
                    rows[k].push(quotient.value / size);
                    floors[k].push(quotient.floor / size);
                    jumps[k] |= !quotient.is_smooth;
                }
            }
            Ok(Gradient { rows, counters: Counters::default() })
        })?;
        let mut check = Check::of(CheckWay::Independent, (prepared, &forward.values), adjoint, other);
        check.jumps = jumps;
        for (k, floors) in floors.iter().enumerate() {
            let row = &check.other.gradient.rows[k];
            let off: Vec<f64> = row.iter().zip(floors).map(|(value, floor)| value + floor).collect();
            check.scatter[k] = Some(largest_of(&[Measure::of(prepared, forward.values[k]).differences([&off, row])]));
        }
        Ok(check)
    }

    fn of(way: CheckWay, (prepared, values): (&Prepared, &[f64]), adjoint: &Timed, other: Timed) -> Self {
        let rows = adjoint.gradient.rows.iter().zip(&other.gradient.rows);
        let rows = rows.zip(values).map(|((own, other), &value)| Measure::of(prepared, value).differences([own, other]));
        let differences: Vec<_> = rows.collect();
        let (scatter, jumps) = (vec![None; differences.len()], vec![false; differences.len()]);
        let round_off = vec![0.0; differences.len()];
        Check { way, other, differences, scatter, round_off, jumps }
    }

    /// Whether a functional is within the limit of the comparison itself, whatever roundings do.
    fn is_within(&self, k: usize) -> bool {
        self.largest(k) <= self.way.limit()
    }

    fn passes(&self) -> bool {
        self.worst() <= 1.0
    }

    /// Why agreement would show nothing of a functional.
    fn blind(&self, k: usize, behind: &[&str], prepared: &Prepared) -> Option<String> {
        let name = prepared.functionals()[k].name.as_str();
        match self.way {
            _ if behind.contains(&name) => Some(format!(
                "the gradient of {name} is wrong because of a switch within a step, which complex step and runs of the same steps pass, too: their \
                 agreement shows nothing"
            )),
            CheckWay::Independent if self.jumps[k] => Some(format!(
                "{name} jumps from one run to another beside this design: the quotient is the slope of one of its pieces"
            )),
            CheckWay::Independent if self.limit(k) > BLIND => {
                Some(format!("round-off of the runs hides the quotients of {name}"))
            }
            CheckWay::ComplexStep if !self.is_within(k) && self.limit(k) > OF_QUOTIENTS => Some(format!(
                "a rounding of the variables changes the complex-step derivatives of {name} by so much that agreement with them shows nothing: \
                 compare with runs, --check=independent"
            )),
            _ => None,
        }
    }

    /// The first of these reasons.
    fn first_blind(&self, behind: &[&str], prepared: &Prepared) -> Option<String> {
        (0..self.differences.len()).find_map(|k| self.blind(k, behind, prepared))
    }

    fn largest(&self, k: usize) -> f64 {
        largest_of(&self.differences[k..=k])
    }

    /// What can be asked for of a functional: not less than what a rounding of the variables does to its own derivatives.
    fn limit(&self, k: usize) -> f64 {
        self.way.limit().max(SCATTER * self.scatter[k].unwrap_or(0.0))
    }

    /// The functional that is nearest to its limit, or furthest beyond.
    fn worst_functional(&self) -> Option<usize> {
        let size = |k: usize| self.largest(k) / self.limit(k);
        // what is no number is worst
        let key = |k: usize| if size(k).is_nan() { f64::INFINITY } else { size(k) };
        (0..self.differences.len()).max_by(|&i, &j| key(i).total_cmp(&key(j)))
    }

    /// Its difference by its limit; NaN does not pass.
    fn worst(&self) -> f64 {
        self.worst_functional().map_or(0.0, |k| self.largest(k) / self.limit(k))
    }

    /// Difference and limit of that functional.
    fn figures(&self) -> (f64, f64) {
        self.worst_functional().map_or((0.0, self.way.limit()), |k| (self.largest(k), self.limit(k)))
    }
}

/// The largest number, or NaN if there is one: max() of floats would lose it.
fn largest_of(differences: &[Vec<f64>]) -> f64 {
    differences.iter().flatten().fold(0.0, |most: f64, &d| if d <= most || most.is_nan() { most } else { d })
}

/// By what differences of two gradients of a functional are measured.
struct Measure<'p> {
    variables: &'p [DesignVariable],
    x: &'p [f64],
    value: f64,
    /// Change of the functional that is round-off.
    round_off: f64,
}

impl<'p> Measure<'p> {
    fn of(prepared: &'p Prepared, value: f64) -> Self {
        Measure { variables: &prepared.variables, x: &prepared.x, value, round_off: 0.0 }
    }

    /// Each relative to the entry, or to [`SMALL`] of the largest change of the functional by a relative change of any variable: an entry
    /// that is zero but for round-off has no relative error of its own. None where a change of the variable by its whole size changes the
    /// functional differently by no more than round-off does.
    fn differences(&self, [adjoint, complex_step]: [&[f64]; 2]) -> Vec<f64> {
        let size = |i: usize| self.variables[i].size(self.x[i]);
        let least = ZERO * self.value.abs();
        let largest = complex_step.iter().enumerate().fold(least, |most: f64, (i, g)| most.max((g * size(i)).abs()));
        let difference = |(i, (a, c)): (usize, (&f64, &f64))| {
            let apart = (a - c).abs();
            if apart * size(i) <= self.round_off { 0.0 } else { apart / c.abs().max(SMALL * largest / size(i)) }
        };
        adjoint.iter().zip(complex_step).enumerate().map(difference).collect()
    }
}

fn work_of_check(way: CheckWay, other: &Timed) -> Work {
    let Counters { systems, iterations, residuals, factorizations, solves, .. } = other.gradient.counters;
    let mut work = vec![("time_s", json!(other.seconds)), ("programs_s", json!(other.program_seconds))];
    if way == CheckWay::ComplexStep {
        let counted = [
            ("systems", systems),
            ("newton_iterations", iterations),
            ("factorizations", factorizations),
            ("solves", solves),
            ("residual_evaluations", residuals),
            ("recomputed_steps", other.recomputed),
        ];
        work.splice(0..0, counted.map(|(name, count)| (name, json!(count))));
    }
    work
}

fn adjoint_work(adjoint: &Timed) -> Work {
    let Counters { systems, factorizations, solves, products, .. } = adjoint.gradient.counters;
    vec![
        ("systems", json!(systems)),
        ("factorizations", json!(factorizations)),
        ("solves", json!(solves)),
        ("element_products", json!(products)),
        ("recomputed_steps", json!(adjoint.recomputed)),
        ("time_s", json!(adjoint.seconds)),
        ("programs_s", json!(adjoint.program_seconds)),
    ]
}

fn insert_work(object: &mut Value, sweep: &str, work: Work) {
    for (name, value) in work {
        let name = if name == "time_s" { format!("{sweep}_s") } else { format!("{sweep}_{name}") };
        object[name] = value;
    }
}

fn json_of(simulation: &Simulation, prepared: &Prepared, adjoint: &Timed, check: Option<&Check>, behind: &[&str]) -> Value {
    let mut object = simulation.json(prepared);
    for (row, own) in adjoint.gradient.rows.iter().enumerate() {
        let functional = &mut object["functionals"][row];
        insert_gradient(functional, prepared, simulation.forward.values[row], own);
        if let Some(check) = check {
            let named = |rows: &[Vec<f64>]| by_name(&prepared.variables, rows[row].iter().copied());
            functional[check.way.key()] = named(&check.other.gradient.rows);
            functional["relative_difference"] = named(&check.differences);
            functional["limit"] = json!(check.limit(row));
        }
    }
    insert_work(&mut object, "adjoint", adjoint_work(adjoint));
    object["adjoint_per_forward"] = json!(adjoint.seconds / simulation.seconds);
    if let Some(check) = check {
        insert_work(&mut object, check.way.key(), work_of_check(check.way, &check.other));
        let (largest, limit) = check.figures();
        object["largest_relative_difference"] = json!(largest);
        object["limit"] = json!(limit);
        object["pass"] = json!(check.passes() && check.first_blind(behind, prepared).is_none());
    }
    object
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variables() -> Vec<DesignVariable> {
        let bounds = [(0.0, 10.0), (0.0, 1e6), (-1.0, 1.0)];
        bounds.into_iter().enumerate().map(|(i, bounds)| DesignVariable::new(format!("x{i}"), 0.0, bounds, "-")).collect()
    }

    #[test]
    fn a_wrong_or_missing_entry_is_seen_and_round_off_of_a_zero_is_not() {
        let x = [2.0, 1e5, 0.0];
        let right = [3.0, 4e-5, 0.0];
        let measure = |value: f64, round_off: f64, rows: [&[f64; 3]; 2]| {
            let measure = Measure { variables: &variables(), x: &x, value, round_off };
            largest_of(&[measure.differences(rows.map(|row| &row[..]))])
        };
        let compare = |adjoint: [f64; 3]| measure(1e-9, 0.0, [&adjoint, &right]);
        assert_eq!(compare(right), 0.0);
        assert!(compare([3.0, 4e-5, 1e-15]) <= LIMIT);
        // in its unit the second entry is small, but it changes the functional as much as the first
        assert!((compare([3.0, 4e-5 * (1.0 + 1e-6), 0.0]) - 1e-6).abs() < 1e-12);
        assert!(compare([3.0 + 1e-8, 4e-5, 0.0]) > LIMIT);
        assert!(compare([3.0, 4e-5, 1e-3]) > LIMIT);
        // of a functional of order one round-off is no derivative, and what is more is one
        let nothing = |size: f64| measure(1.0, 0.0, [&[0.5 * size, 0.0, 0.0], &[-0.5 * size, 0.0, 0.0]]);
        assert!(nothing(1e-16) <= LIMIT && nothing(1e-12) > LIMIT);
        // of a functional that is round-off itself, so are derivatives by which a whole variable changes it no more: sizes 2 and 1e5, a range of 2
        for (place, size) in [2.0, 1e5, 2.0].into_iter().enumerate() {
            let mut row = [0.0; 3];
            row[place] = 1e-17 / size;
            let of = |round_off: f64| measure(1e-17, round_off, [&row, &[0.0; 3]]);
            assert!(of(1.1e-17) == 0.0 && of(0.9e-17) > LIMIT);
        }
        for place in 0..3 {
            let mut adjoint = right;
            adjoint[place] = f64::NAN;
            assert!(compare(adjoint).is_nan());
        }
    }
}
