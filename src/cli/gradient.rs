use super::CommandLine;
use super::console::{json_number, say, say_json, warn};
use super::failure::Failure;
use super::histories::{check_history, keep, resumed};
use super::interrupt::set_last_words;
use super::meshes::write_gradients;
use super::options::SceneOptions;
use super::part_sensitivities::PartSensitivities;
use super::report::{GradientRows, Page};
use super::run::report;
use super::simulation::{Simulation, Work, long_number, say_work, simulate};
use crate::design::DesignVariable;
use crate::history::Keep;
use crate::integrators::{Counters, RunError};
use crate::io::{Cell, Progress, Table, number};
use crate::program::making_time;
use crate::scenes::Prepared;
use crate::sensitivity::{Forward, Gradient};
use clap::Args;
use serde_json::{Map, Value, json};
use std::time::Instant;

/// Options of `costate gradient`.
#[derive(Args)]
pub struct GradientOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Compare with complex-step runs of the whole simulation; exit code 1 if they differ
    #[arg(long)]
    check: bool,
    /// Where steps are kept for the way back: auto (in memory, or as checkpoints where that would take more than a third of what is
    /// free), memory, file:PATH, or checkpoints:MEGABYTES with the steps between computed again
    #[arg(long, value_name = "WHERE", default_value = "auto", value_parser = keep)]
    history: Keep,
    /// Go on with the run in the file of --history where it stopped, bit for bit; a finished one is not simulated again
    #[arg(long)]
    resume: bool,
}

/// Largest relative difference between adjoint and complex step that passes.
const LIMIT: f64 = 1e-10;
/// How many times the effect of a rounding of the variables two derivatives may be apart.
const SCATTER: f64 = 4.0;
/// Entries that matter less than this share of the largest one are compared relative to that share.
const SMALL: f64 = 1e-2;

/// Share of the functional itself by which the changes that relative changes of the variables make count at least: the derivative by what it
/// does not depend on is what round-off leaves of terms of that size, and zero against zero is zero.
const ZERO: f64 = 1e-2;

/// A gradient and the time it took.
struct Timed {
    gradient: Gradient,
    /// Steps computed again between checkpoints.
    recomputed: usize,
    seconds: f64,
    /// For programs that were first needed here [s].
    program_seconds: f64,
}

/// The complex-step gradient and how far the adjoint is from it.
struct Check {
    complex_step: Timed,
    /// Relative differences, for each functional and variable.
    differences: Vec<Vec<f64>>,
    /// Of each functional, what a rounding of the variables does to its complex-step derivatives, where the differences made it worth a look.
    scatter: Vec<Option<f64>>,
}

/// `costate gradient`: simulates, writes, differentiates, checks, prints.
pub fn run(options: &GradientOptions, program: &CommandLine) -> Result<(), Failure> {
    let scene = options.scene.scene(program)?;
    let mut prepared = options.scene.prepare(&*scene)?;
    prepared.method = options.scene.differentiable(prepared.method)?;
    prepared.keep = resumed(options.history.clone(), options.resume)?;
    check_history(&prepared.keep, &options.scene.folder(&*scene))?;
    let mut simulation = simulate(&prepared, &options.scene)?;
    let output = options.scene.output(&*scene);
    let reported = || Page::of_simulation(&prepared, &simulation, "simulation and gradient");
    let mut page = options.scene.reports().then(reported);
    if simulation.stopped.is_some() {
        simulation.conclude(page, simulation.json(&prepared).into());
        report(&simulation, &prepared);
        say_json(options.scene.json, &simulation.json(&prepared).into());
        return simulation.stopped.map_or(Ok(()), Err);
    }
    let (analysis, x, forward) = (prepared.analysis(), &prepared.x, &simulation.forward);
    // what is there is said before what may fail
    simulation.say_functionals(&prepared);
    simulation.say_resolution(&prepared);
    let crossings = simulation.crossings_in_words();
    crossings.iter().for_each(|crossing| warn(crossing));
    if let Some(page) = &mut page {
        crossings.iter().for_each(|crossing| page.warning(crossing));
    }
    let behind = simulation.behind_jumps(&prepared);
    let checkpoints = forward.history.usage().checkpoints;
    if checkpoints > 0 && prepared.keep == Keep::Auto {
        let steps = forward.history.steps();
        say(format_args!(
            "{steps} steps would take more than a third of the free memory: {checkpoints} checkpoints are kept, and the steps between them \
             computed again (--history file:PATH keeps all)\n"
        ));
    }
    // a sweep that is stopped leaves what the simulation gave
    let mut simulated = simulation.json(&prepared);
    simulated.insert("error".into(), json!("interrupted before the gradient was there"));
    simulation.summarize(&simulated);
    set_last_words(options.scene.json.then(|| Value::from(simulated).to_string()));
    let parts = PartSensitivities::of(&prepared, page.is_some(), output.meshes);
    let mut by_parameters = Vec::new();
    let adjoint = timed("adjoint", forward, || {
        if parts.asked.is_empty() {
            return analysis.adjoint(x, forward);
        }
        let (gradient, rows) = analysis.adjoint_by_parameters(x, forward, &parts.asked)?;
        by_parameters = rows;
        Ok(gradient)
    });
    let adjoint = adjoint.inspect_err(|_| simulation.say_files())?;
    let check = if options.check {
        let complex_step = timed("complex step", forward, || analysis.complex_step(x, forward));
        let check = complex_step.and_then(|complex_step| Check::new(&prepared, &forward.values, &adjoint, complex_step));
        Some(check.inspect_err(|_| {
            (0..prepared.functionals().len()).for_each(|row| say_gradient(&prepared, row, &adjoint, None));
            simulation.say_files();
        })?)
    } else {
        None
    };

    set_last_words(None);
    for row in 0..prepared.functionals().len() {
        say_gradient(&prepared, row, &adjoint, check.as_ref());
    }
    say_work(&work(&simulation, &adjoint, check.as_ref()));
    let ratio = adjoint.seconds / simulation.seconds;
    say(format_args!("adjoint time / forward time: {}", number(ratio)));
    if let Some(check) = &check {
        for (k, functional) in prepared.functionals().iter().enumerate() {
            let (largest, limit) = (check.largest(k), check.limit(k));
            let verdict = match largest <= limit {
                true if behind.contains(&functional.name.as_str()) => "shows nothing behind a jump",
                true => "pass",
                false => "FAIL",
            };
            let rounding = check.scatter[k].filter(|_| limit > LIMIT).map_or_else(String::new, |scatter| {
                format!("; a rounding of the variables changes its complex-step derivatives by {} of them", brief(scatter))
            });
            let largest = brief(largest);
            say(format_args!(
                "{}: largest relative difference to complex step: {largest} (limit {limit:.0e}): {verdict}{rounding}",
                functional.name
            ));
        }
    }
    say("");
    if output.meshes {
        let written = write_gradients(&prepared, &by_parameters, &options.scene.folder(&*scene));
        match written {
            Ok(path) => simulation.files.extend(path),
            Err(error) => simulation.unwritten = simulation.unwritten.or(Some(error.into())),
        }
    }
    if let Some(page) = &mut page {
        parts.colour(&prepared, &by_parameters, page);
        page.gradient(&prepared, &rows_of(&adjoint, check.as_ref(), &behind));
    }
    let summary = json_of(&simulation, &prepared, &adjoint, check.as_ref(), &behind);
    simulation.conclude(page, summary);
    simulation.say_files();
    say_json(options.scene.json, &json_of(&simulation, &prepared, &adjoint, check.as_ref(), &behind));
    match check {
        Some(check) if !check.passes() => {
            let name = check.worst_functional().map_or("", |k| prepared.functionals()[k].name.as_str());
            let (largest, limit) = check.figures();
            let largest = brief(largest);
            Err(Failure::run(format!(
                "the adjoint gradient of \"{name}\" differs from complex step by {largest}, more than {limit:.0e}"
            )))
        }
        Some(_) if !behind.is_empty() => Err(Failure::run(format!(
            "the gradient of {} is behind a jump, where it is wrong: complex step passes the same jump, so their agreement shows nothing",
            behind.join(", ")
        ))),
        _ => simulation.unwritten.map_or(Ok(()), Err),
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

fn rows_of<'g>(adjoint: &'g Timed, check: Option<&'g Check>, behind: &[&str]) -> GradientRows<'g> {
    let verdict = check.map_or_else(String::new, |check| {
        let (verdict, (largest, limit)) = (if check.passes() { "within" } else { "NOT within" }, check.figures());
        let jump = if behind.is_empty() { "" } else { ", which shows nothing behind a jump" };
        format!("{verdict} {limit:.0e} of complex step: largest relative difference {}{jump}", brief(largest))
    });
    let check = check.map(|check| [&check.complex_step.gradient.rows[..], &check.differences]);
    GradientRows { adjoint: &adjoint.gradient.rows, check, verdict }
}

fn brief(difference: f64) -> String {
    if difference == 0.0 { "0".into() } else { format!("{difference:.1e}") }
}

impl Check {
    fn new(prepared: &Prepared, values: &[f64], adjoint: &Timed, complex_step: Timed) -> Result<Self, Failure> {
        let rows = adjoint.gradient.rows.iter().zip(&complex_step.gradient.rows);
        let design = (&prepared.variables[..], &prepared.x[..]);
        let rows = rows.zip(values).map(|((own, other), &value)| relative_differences(design, value, [own, other]));
        let differences: Vec<_> = rows.collect();
        let mut check = Check { complex_step, scatter: vec![None; differences.len()], differences };
        if check.passes() {
            return Ok(check);
        }
        let nearby = prepared.complex_steps_nearby()?;
        for (k, scatter) in check.scatter.iter_mut().enumerate() {
            let rows = nearby.each_ref().map(|rows| &rows[k][..]);
            let pairs = rows.iter().flat_map(|one| rows.iter().map(move |other| [*one, *other]));
            let apart: Vec<_> = pairs.map(|pair| relative_differences(design, values[k], pair)).collect();
            *scatter = Some(largest_of(&apart));
        }
        Ok(check)
    }
}

impl Check {
    /// Whether each functional is within its limit.
    fn passes(&self) -> bool {
        self.worst() <= 1.0
    }

    /// The largest difference of a functional.
    fn largest(&self, k: usize) -> f64 {
        largest_of(&self.differences[k..=k])
    }

    /// What can be asked for of a functional: not less than what a rounding of the variables does to its own derivatives.
    fn limit(&self, k: usize) -> f64 {
        LIMIT.max(SCATTER * self.scatter[k].unwrap_or(0.0))
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
        self.worst_functional().map_or((0.0, LIMIT), |k| (self.largest(k), self.limit(k)))
    }
}

/// The largest number, or NaN if there is one: max() of floats would lose it.
fn largest_of(differences: &[Vec<f64>]) -> f64 {
    differences.iter().flatten().fold(0.0, |most: f64, &d| if d <= most || most.is_nan() { most } else { d })
}

/// Differences of two gradients, each relative to the entry, or to [`SMALL`] of the largest change of the functional by a
/// relative change of any variable: an entry that is zero but for round-off has no relative error of its own.
fn relative_differences(
    (variables, x): (&[DesignVariable], &[f64]),
    value: f64,
    [adjoint, complex_step]: [&[f64]; 2],
) -> Vec<f64> {
    let size = |i: usize| {
        let range = variables[i].upper - variables[i].lower;
        match x[i].abs() {
            0.0 if range.is_finite() && range > 0.0 => range,
            0.0 => 1.0,
            size => size,
        }
    };
    let least = ZERO * value.abs();
    let largest = complex_step.iter().enumerate().fold(least, |most: f64, (i, g)| most.max((g * size(i)).abs()));
    let difference = |(i, (a, c)): (usize, (&f64, &f64))| {
        let apart = (a - c).abs();
        if apart == 0.0 { 0.0 } else { apart / c.abs().max(SMALL * largest / size(i)) }
    };
    adjoint.iter().zip(complex_step).enumerate().map(difference).collect()
}

fn say_gradient(prepared: &Prepared, row: usize, adjoint: &Timed, check: Option<&Check>) {
    let functional = &prepared.functionals()[row];
    let mut table = match check {
        Some(_) => Table::new(&["variable", "value", "unit", "adjoint", "complex step", "difference"]),
        None => Table::new(&["variable", "value", "unit", "adjoint"]),
    };
    for (i, (variable, &x)) in prepared.variables.iter().zip(&prepared.x).enumerate() {
        let mut cells: Vec<Cell> = vec![variable.name.as_str().into(), x.into(), variable.unit.into()];
        cells.push(long_number(adjoint.gradient.rows[row][i]).into());
        if let Some(check) = check {
            cells.push(long_number(check.complex_step.gradient.rows[row][i]).into());
            cells.push(brief(check.differences[row][i]).into());
        }
        table.row(cells);
    }
    say(format_args!("gradient of {} [{} / unit of the variable]\n{table}\n", functional.name, functional.value_unit()));
}

fn work(simulation: &Simulation, adjoint: &Timed, check: Option<&Check>) -> Vec<(&'static str, Work)> {
    let mut columns = vec![("simulation", simulation.work()), ("adjoint", adjoint_work(adjoint))];
    if let Some(Check { complex_step, .. }) = check {
        columns.push(("complex step", complex_step_work(complex_step)));
    }
    columns
}

fn complex_step_work(complex_step: &Timed) -> Work {
    let Counters { systems, iterations, residuals, factorizations, solves, .. } = complex_step.gradient.counters;
    vec![
        ("systems", json!(systems)),
        ("newton_iterations", json!(iterations)),
        ("factorizations", json!(factorizations)),
        ("solves", json!(solves)),
        ("residual_evaluations", json!(residuals)),
        ("recomputed_steps", json!(complex_step.recomputed)),
        ("time_s", json_number(complex_step.seconds)),
        ("programs_s", json_number(complex_step.program_seconds)),
    ]
}

fn adjoint_work(adjoint: &Timed) -> Work {
    let Counters { systems, factorizations, solves, products, .. } = adjoint.gradient.counters;
    vec![
        ("systems", json!(systems)),
        ("factorizations", json!(factorizations)),
        ("solves", json!(solves)),
        ("element_products", json!(products)),
        ("recomputed_steps", json!(adjoint.recomputed)),
        ("time_s", json_number(adjoint.seconds)),
        ("programs_s", json_number(adjoint.program_seconds)),
    ]
}

fn insert_work(object: &mut Map<String, Value>, sweep: &str, work: Work) {
    for (name, value) in work {
        let name = if name == "time_s" { format!("{sweep}_s") } else { format!("{sweep}_{name}") };
        object.insert(name, value);
    }
}

fn json_of(simulation: &Simulation, prepared: &Prepared, adjoint: &Timed, check: Option<&Check>, behind: &[&str]) -> Value {
    let mut object = simulation.json(prepared);
    let named = |row: &[f64]| -> Value {
        let pairs = prepared.variables.iter().zip(row);
        pairs.map(|(variable, &value)| (variable.name.clone(), json_number(value))).collect::<Map<_, _>>().into()
    };
    if let Some(Value::Array(functionals)) = object.get_mut("functionals") {
        for (row, functional) in functionals.iter_mut().enumerate() {
            functional["gradient"] = named(&adjoint.gradient.rows[row]);
            if let Some(check) = check {
                functional["complex_step"] = named(&check.complex_step.gradient.rows[row]);
                functional["relative_difference"] = named(&check.differences[row]);
                functional["limit"] = json_number(check.limit(row));
            }
        }
    }
    insert_work(&mut object, "adjoint", adjoint_work(adjoint));
    object.insert("adjoint_per_forward".into(), json_number(adjoint.seconds / simulation.seconds));
    if let Some(check) = check {
        insert_work(&mut object, "complex_step", complex_step_work(&check.complex_step));
        let (largest, limit) = check.figures();
        object.insert("largest_relative_difference".into(), json_number(largest));
        object.insert("limit".into(), json_number(limit));
        object.insert("pass".into(), json!(check.passes() && behind.is_empty()));
    }
    object.into()
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
        let compare = |adjoint: [f64; 3]| largest_of(&[relative_differences((&variables(), &x), 1e-9, [&adjoint, &right])]);
        assert_eq!(compare(right), 0.0);
        assert!(compare([3.0, 4e-5, 1e-15]) <= LIMIT);
        // in its unit the second entry is small, but it changes the functional as much as the first
        assert!((compare([3.0, 4e-5 * (1.0 + 1e-6), 0.0]) - 1e-6).abs() < 1e-12);
        assert!(compare([3.0 + 1e-8, 4e-5, 0.0]) > LIMIT);
        assert!(compare([3.0, 4e-5, 1e-3]) > LIMIT);
        // of a functional of order one round-off is no derivative, and what is more is one
        let nothing = |size: f64| {
            largest_of(&[relative_differences((&variables(), &x), 1.0, [&[0.5 * size, 0.0, 0.0], &[-0.5 * size, 0.0, 0.0]])])
        };
        assert!(nothing(1e-16) <= LIMIT && nothing(1e-12) > LIMIT);
        for place in 0..3 {
            let mut adjoint = right;
            adjoint[place] = f64::NAN;
            assert!(compare(adjoint).is_nan());
        }
    }
}
