// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::CommandLine;
use super::console::{count, print, print_files, print_json, seconds};
use super::earlier::keep_earlier;
use super::failure::{Failure, INTERRUPTED, LIMIT_REACHED};
use super::interrupt::Guard;
use super::optimize::{MOST_ITERATIONS, MOST_STARTS, Recording, cases, restarted, settings};
use super::options::{SceneOptions, whole_number};
use super::report::Page;
use super::results::check_folder;
use super::simulation::{names, steps_in_words};
use super::summary::{Summary, by_name};
use crate::io::{Cell, Chart, Progress, Series, Style, Table, cells, number, write_csv, write_json};
use clap::Args;
use costate::design::DesignVariable;
use costate::integrators::RunError;
use costate::optimize::runs_at_once::run_at_once;
use costate::optimize::{Case, Combined, Fit, Fitted, FittedCurve};
use costate::scalar::TANGENTS;
use costate::scenes::{AnyScene, Measurement};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Options of `costate fit`.
#[derive(Args)]
pub struct FitOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Most iterations
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole_number::<MOST_ITERATIONS>, allow_negative_numbers = true)]
    iterations: usize,
    /// Start at the best design of an earlier fit.csv
    #[arg(long, value_name = "FILE")]
    restart: Option<PathBuf>,
    /// Starts: the given design, and others that fill the bounds evenly, on all processors; the least sum counts
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole_number::<MOST_STARTS>, allow_negative_numbers = true)]
    starts: usize,
}

/// Coefficients of a combination below this are not told.
const NO_PART: f64 = 0.05;
/// A combination known to no more than its own size is one of which the measurements say next to nothing.
const UNKNOWN: f64 = 1.0;
/// Beyond so many standard deviations of white noise a correlation of residuals, or their sum, is no chance.
const NO_CHANCE: f64 = 4.0;
/// Values between steps that may be wrong by more than this share of a deviation change what is fitted.
const BETWEEN_STEPS: f64 = 0.1;
/// Deviations within which 95 % of the points of two normal variables lie: the root of -2 ln 0.05.
const ELLIPSE: f64 = 2.447_746_830_680_816;
/// Starts whose sums differ by less than this share end at the same place.
const SAME_SUM: f64 = 1e-6;

/// `costate fit`: fits a scene to its measurements, writes the history and residuals, prints variables and how exactly they are known.
pub fn run(options: &FitOptions, program: &CommandLine) -> Result<(), Failure> {
    let scene = options.scene.scene(program)?;
    let problem = scene.fit_problem().ok_or_else(|| program.no_measurements(&*scene))?;
    options.scene.without_histories("a fit")?;
    let located = |error: RunError| options.scene.located(&*scene, error);
    let mut fit = Fit::new(&*scene, problem, cases(&options.scene, &*scene)?).map_err(located)?;
    fit.iterations = options.iterations;
    let folder = options.scene.folder(&*scene);
    let start = match &options.restart {
        Some(file) => restarted(file, &options.scene, fit.variables(), false, 0.0)?,
        None => options.scene.design(&*scene)?,
    };
    check_folder(&folder)?;
    let path = folder.join("fit.csv");
    keep_earlier(&path)?;
    announce(&fit);
    let fitted = fitted(options, &fit, &start, &path)?;
    let [page, summary, residuals] = ["fit.html", "fit.json", "residuals.csv"].map(|name| folder.join(name));
    let files = [path, residuals.clone(), page.clone(), summary.clone()];
    let report = Report { fit: &fit, fitted: &fitted, start: &start };
    write_csv(&residuals, &RESIDUALS.map(String::from), report.residuals())?;
    report.page().write(&page, &files)?;
    let json = report.json(&files);
    write_json(&summary, &json)?;
    report.summary().print();
    print_files(&files);
    print_json(options.scene.json, &json);
    report.verdict()
}

/// The best that comes of one start or of some; its history is written on the way, or at the end.
fn fitted(options: &FitOptions, fit: &Fit, start: &[f64], path: &Path) -> Result<Fitted, Failure> {
    let guard = Guard::new();
    let recording = |progress| Recording { path: path.into(), earlier: 0, guard: &guard, progress, failed: None };
    let failure = |error: RunError| match error {
        RunError::Interrupted { .. } => Failure {
            code: INTERRUPTED,
            message: format!("stopped; designs so far are in {}, and can be taken up by --restart", path.display()),
        },
        error => options.scene.located(fit.scene, error),
    };
    if options.starts == 1 {
        let mut recording = recording(Some(Progress::new("fitting", options.iterations as u64)));
        let fitted = fit.run(start, &mut recording);
        recording.failed.map_or(Ok(()), Err)?;
        return fitted.map_err(failure);
    }
    let starts = fit.starts(start, options.starts);
    let all: Vec<Mutex<Option<Result<Fitted, RunError>>>> = starts.iter().map(|_| Mutex::new(None)).collect();
    run_at_once(starts.len(), rayon::current_num_threads(), |k| {
        // each start writes what it finds beside the others
        let numbered = path.with_file_name(format!("fit.start-{}.csv", k + 1));
        let mut recording = Recording { path: numbered, ..recording(None) };
        *all[k].lock().unwrap_or_else(PoisonError::into_inner) = Some(fit.run(&starts[k], &mut recording));
    });
    let mut table = Table::new(&["start", "sum", "iterations", "simulations", "ended"]);
    let (mut best, mut error, mut sums): (Option<Fitted>, _, _) = (None, None, Vec::new());
    for (k, own) in all.into_iter().enumerate() {
        match own.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Ok(own)) => {
                table.row(cells![k + 1, own.sum, own.iterations, own.history.points.len(), ended(&own)]);
                sums.push(own.sum);
                if best.as_ref().is_none_or(|best| own.sum < best.sum) {
                    best = Some(own);
                }
            }
            Some(Err(why)) => {
                let none = Cell::default();
                table.row(cells![k + 1, none.clone(), none.clone(), none, format!("failed: {why}")]);
                error = Some(why);
            }
            None => {}
        }
    }
    print(format_args!("{table}\n"));
    let missing = || RunError::Input("no start could be simulated".into());
    let best = best.ok_or_else(|| failure(error.unwrap_or_else(missing)))?;
    let same = sums.iter().filter(|sum| **sum - best.sum <= SAME_SUM * best.sum).count();
    print(format_args!("{same} of {} end at the least sum\n", count(starts.len(), "start")));
    write_csv(path, &best.history.header(), best.history.rows())?;
    Ok(best)
}

impl CommandLine<'_> {
    fn no_measurements(&self, scene: &dyn AnyScene) -> Failure {
        let able = self.all_scenes().into_iter().flatten().filter(|scene| scene.fit_problem().is_some());
        let names: Vec<String> = able.map(|scene| scene.name()).collect();
        let others = if names.is_empty() { String::new() } else { format!("; scenes that have some: {}", names.join(", ")) };
        let name = scene.name();
        Failure::input(format!("the scene \"{name}\" has no measurements: say them by [[measurement]]{others}"))
    }
}

fn announce(fit: &Fit) {
    let Fit { scene, problem, cases, .. } = fit;
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    let values: usize = problem.measurements.iter().map(|own| own.times.len()).sum();
    let priors = match problem.priors.len() {
        0 => String::new(),
        priors => format!(" and {}", count(priors, "prior")),
    };
    let varying = fit.varying().len();
    print(format_args!(
        "{}, {} by {}{priors}; Levenberg and Marquardt's method, loss {}",
        count(varying, "variable"),
        count(values, "value"),
        count(problem.measurements.len(), "measurement"),
        problem.loss.name()
    ));
    print(format_args!(
        "derivatives by {} for up to {TANGENTS} variables each, where adjoint sweeps would be {values}",
        count(varying.div_ceil(TANGENTS), "tangent run")
    ));
    for Case { name, method, settings, .. } in cases {
        let which = if name.is_empty() { "each design".into() } else { format!("scenario \"{name}\"") };
        print(format_args!("{which}: {}", steps_in_words(method, settings)));
    }
    print("");
}

fn ended(fitted: &Fitted) -> &'static str {
    match (fitted.is_optimum, fitted.is_limit) {
        (true, _) => "the sum is least nearby",
        (false, true) => "the limit of iterations is reached",
        (false, false) => "no step makes the sum less, but it is not least: the accuracy of the runs is used up",
    }
}

/// Columns of the residuals.
const RESIDUALS: [&str; 6] = ["measurement", "t [s]", "measured", "computed", "deviation of computed", "residual"];

struct Report<'r> {
    fit: &'r Fit<'r>,
    fitted: &'r Fitted,
    start: &'r [f64],
}

/// What the residuals of a measurement look like.
struct Whiteness {
    /// Root of their mean square.
    size: f64,
    /// Correlation of each with the one before.
    correlation: f64,
    /// Sum of the squares of their differences by that of their squares: 2 where they are white.
    ///
    /// Source: Durbin & Watson (1950).
    durbin_watson: f64,
}

impl Whiteness {
    fn of(residuals: &[f64]) -> Self {
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        let pairs = || residuals.windows(2).map(|pair| (pair[0], pair[1]));
        Whiteness {
            size: (squares / residuals.len() as f64).sqrt(),
            correlation: pairs().map(|(a, b)| a * b).sum::<f64>() / squares,
            durbin_watson: pairs().map(|(a, b)| (b - a).powi(2)).sum::<f64>() / squares,
        }
    }
}

impl<'r> Report<'r> {
    fn measurements(&self) -> impl Iterator<Item = (&'r Measurement, &'r FittedCurve, &'r str)> {
        let units = self.fit.units().iter().map(String::as_str);
        self.fit
            .problem
            .measurements
            .iter()
            .zip(&self.fitted.curves)
            .zip(units)
            .map(|((own, curve), unit)| (own, curve, unit))
    }

    fn variable(&self, estimated: usize) -> &'r DesignVariable {
        &self.fit.variables()[self.fit.varying()[self.fitted.confidence.estimated[estimated]]]
    }

    fn residuals(&self) -> impl Iterator<Item = Vec<f64>> {
        self.measurements().enumerate().flat_map(|(number, (own, curve, _))| {
            let row = move |k: usize| {
                let FittedCurve { values, deviations, residuals, .. } = curve;
                vec![(number + 1) as f64, own.times[k], own.values[k], values[k], deviations[k], residuals[k]]
            };
            (0..own.times.len()).map(row)
        })
    }

    /// Variables that vary: what they were, what they are, how exactly that is known.
    fn variables(&self) -> Table {
        let header = ["variable", "before", "estimate", "deviation", "from", "to", "unit", ""];
        let keys = ["name", "before", "estimate", "deviation", "lower", "upper", "unit", "remark"];
        let (mut table, confidence) = (Table::new(&header).keyed(&keys), &self.fitted.confidence);
        for (place, &i) in self.fit.varying().iter().enumerate() {
            let DesignVariable { name, lower, upper, unit, .. } = &self.fit.variables()[i];
            let estimated = confidence.estimated.iter().position(|own| *own == place);
            let deviation = estimated.map(|own| confidence.deviation(own)).filter(|own| own.is_finite());
            let remark = match (estimated, deviation) {
                (None, _) => "at a bound, which is taken as known",
                (Some(_), None) => "not determined",
                _ => "",
            };
            table.row(cells![name, self.start[i], self.fitted.design[i], deviation, *lower, *upper, *unit, remark]);
        }
        table
    }

    /// Variables that are determined.
    fn known(&self) -> Vec<usize> {
        let confidence = &self.fitted.confidence;
        (0..confidence.estimated.len()).filter(|&own| confidence.deviation(own).is_finite()).collect()
    }

    /// Correlations of the variables that are determined.
    fn correlations(&self) -> Table {
        let (confidence, known) = (&self.fitted.confidence, self.known());
        let names = known.iter().map(|&own| self.variable(own).name.as_str());
        let mut table = Table::new(&["correlation"].into_iter().chain(names).collect::<Vec<_>>());
        for &i in known.iter().filter(|_| known.len() > 1) {
            let row = known.iter().map(|&j| Cell::from(confidence.correlation(i, j)));
            table.row([Cell::from(&self.variable(i).name)].into_iter().chain(row));
        }
        table
    }

    /// A combination in words: "0.71 stiffness - 0.70 mass".
    fn words(&self, combined: &Combined) -> String {
        let mut terms: Vec<(f64, &str)> =
            combined.coefficients.iter().enumerate().map(|(own, c)| (*c, &*self.variable(own).name)).collect();
        terms.retain(|(coefficient, _)| coefficient.abs() >= NO_PART);
        terms.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        let term = |(k, (c, name)): (usize, &(f64, &str))| match (k, *c < 0.0) {
            (0, _) => format!("{c:.2} {name}"),
            (_, true) => format!(" - {:.2} {name}", -c),
            (_, false) => format!(" + {c:.2} {name}"),
        };
        terms.iter().enumerate().map(term).collect()
    }

    /// What the measurements say next to nothing of.
    fn unknown(&self) -> Vec<String> {
        let least = self.fitted.confidence.combinations.iter().filter(|own| own.deviation > UNKNOWN);
        let told = |own: &Combined| match own.deviation.is_finite() {
            false => format!(
                "cannot be told apart: {}, changes by shares of the values: nothing that was measured changes with it; measure something else, hold a \
                 variable, or give a prior",
                self.words(own)
            ),
            true => format!(
                "hardly known: {}, changes by shares of the values, to {} %",
                self.words(own),
                number(100.0 * own.deviation)
            ),
        };
        least.map(told).collect()
    }

    fn curves(&self) -> Table {
        let header = ["measurement", "values", "residual", "unit", "in deviations", "correlation", "Durbin-Watson"];
        let keys = ["name", "values", "residual", "unit", "in_deviations", "correlation", "durbin_watson"];
        let mut table = Table::new(&header).keyed(&keys);
        for (own, curve, unit) in self.measurements() {
            let apart: f64 = curve.values.iter().zip(&own.values).map(|(a, b)| (a - b).powi(2)).sum();
            let Whiteness { size, correlation, durbin_watson } = Whiteness::of(&curve.residuals);
            let size = own.deviations.is_some().then_some(size);
            let residual = (apart / own.times.len() as f64).sqrt();
            table.row(cells![&own.name, own.times.len(), residual, unit, size, correlation, durbin_watson]);
        }
        table
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.unknown();
        for (own, curve, _) in self.measurements() {
            let (name, count) = (&own.name, own.times.len() as f64);
            let Whiteness { correlation, .. } = Whiteness::of(&curve.residuals);
            if correlation.abs() * count.sqrt() > NO_CHANCE {
                warnings.push(format!(
                    "residuals of \"{name}\" are not white: each is correlated with the one before by {correlation:.2}, where noise would be by \
                     {:.2}; something is missing in the model, or the errors of the measurement hang together, and deviations of the variables are \
                     too small",
                    1.0 / count.sqrt()
                ));
            }
            let between = curve.between_steps.iter().fold(0.0, |most: f64, own| most.max(*own));
            let size = if own.deviations.is_some() { 1.0 } else { Whiteness::of(&curve.residuals).size };
            if between > BETWEEN_STEPS * size {
                warnings.push(format!(
                    "values of \"{name}\" between the ends of steps may be wrong by {} of a deviation: take smaller steps, or such that end at the \
                     times that were measured",
                    number(between / size)
                ));
            }
        }
        let (sum, degrees) = (self.fitted.sum, self.fitted.degrees as f64);
        let has_deviations = self.fit.problem.measurements.iter().all(|own| own.deviations.is_some());
        if has_deviations && degrees > 0.0 && (sum - degrees).abs() > NO_CHANCE * (2.0 * degrees).sqrt() {
            let why = match sum > degrees {
                true => "deviations of the measurements are too small, or something is missing in the model",
                false => "deviations of the measurements are too large, or the loss takes outliers out",
            };
            warnings.push(format!("the sum is {} for {degrees} degrees of freedom: {why}", number(sum)));
        }
        warnings
    }

    fn iterations(&self) -> Table {
        let (mut table, mut simulations) = (Table::new(&["iteration", "simulations", "sum"]), 0);
        for point in &self.fitted.history.points {
            simulations += point.work.simulations;
            if let Some(iteration) = point.iteration {
                table.row(cells![iteration, simulations, point.objective]);
            }
        }
        table
    }

    fn variance_in_words(&self) -> String {
        let Fitted { sum, degrees, confidence, .. } = self.fitted;
        let with = self.fit.problem.measurements.iter().all(|own| own.deviations.is_some());
        match with {
            true => format!("{} for {degrees} degrees of freedom; deviations are those that were given", number(*sum)),
            false => format!(
                "{} for {degrees} degrees of freedom; no deviations were given: that of the residuals is {}",
                number(*sum),
                number(confidence.variance.sqrt())
            ),
        }
    }

    fn summary(&self) -> Summary {
        let (mut summary, fitted) = (Summary::default(), self.fitted);
        summary.table("", self.iterations());
        summary.table("Design variables", self.variables());
        summary.table("Correlations", self.correlations());
        summary.table("Measurements", self.curves());
        summary.fact("sum", self.variance_in_words());
        if let Some(least) = fitted.confidence.combinations.first().filter(|own| own.deviation <= UNKNOWN) {
            let words = format!("{}, by shares of the values, to {} %", self.words(least), number(100.0 * least.deviation));
            summary.fact("least known", words);
        }
        summary.warnings(self.warnings());
        let work = fitted.history.work();
        summary.words(format!(
            "{}: {}; {} in {}, {} in {}",
            count(fitted.iterations, "iteration"),
            ended(fitted),
            count(work.simulations, "simulation"),
            seconds(work.simulation_seconds),
            count(work.sweeps, "tangent run"),
            seconds(work.gradient_seconds)
        ));
        let failed = fitted.history.points.iter().filter(|own| own.failed()).count();
        if failed > 0 {
            let why = fitted.failure.as_ref().map_or_else(String::new, |error| format!("; the last one: {error}"));
            summary.words(format!("{} could not be simulated{why}", count(failed, "design")));
        }
        summary.words(format!("fitted design:{}\n", settings(self.fit.variables(), self.fit.varying(), &fitted.design)));
        summary
    }

    /// Measured and computed curves on top of each other, and residuals.
    fn charts(&self) -> Vec<Chart> {
        let mut charts = Vec::new();
        for (own, curve, unit) in self.measurements() {
            let FittedCurve { values, deviations, residuals, .. } = curve;
            let series = |name: &str, style, value: &dyn Fn(usize) -> f64| Series {
                name: name.into(),
                points: own.times.iter().enumerate().map(|(k, &t)| (t, value(k))).collect(),
                style,
            };
            let chart = |title: String, y_label, series| Chart {
                title,
                x_label: "time [s]".into(),
                y_label,
                series,
                ..Chart::default()
            };
            let both = vec![
                series("computed", Style::Line, &|k| values[k]),
                series("measured", Style::Markers, &|k| own.values[k]),
                series("+2 deviations", Style::Line, &|k| values[k] + 2.0 * deviations[k]),
                series("-2 deviations", Style::Line, &|k| values[k] - 2.0 * deviations[k]),
            ];
            charts.push(chart(own.name.clone(), format!("{} [{unit}]", own.functional), both));
            let label = if own.deviations.is_some() { "residual [deviations]".into() } else { format!("residual [{unit}]") };
            let left = vec![series("residual", Style::Markers, &|k| residuals[k])];
            charts.push(chart(format!("{}: computed less measured", own.name), label, left));
        }
        charts
    }

    /// The ellipse in which the two variables that are most correlated lie with a probability of 95 %.
    fn ellipse(&self) -> Option<Chart> {
        let (confidence, known) = (&self.fitted.confidence, self.known());
        let pairs = known.iter().enumerate().flat_map(|(k, &i)| known[..k].iter().map(move |&j| (j, i)));
        let size = |pair: &(usize, usize)| confidence.correlation(pair.0, pair.1).abs();
        let (i, j) = pairs.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let correlation = confidence.correlation(i, j);
        let of = |own: usize| {
            let place = self.fit.varying()[confidence.estimated[own]];
            (self.fitted.design[place], confidence.deviation(own), &self.fit.variables()[place])
        };
        let ((x, by_x, first), (y, by_y, second)) = (of(i), of(j));
        let half = |name: &str, sign: f64| {
            let point = |k: i32| {
                let angle = f64::from(k) / 120.0 * std::f64::consts::PI;
                let (along, across) = (-ELLIPSE * angle.cos(), sign * ELLIPSE * angle.sin());
                let up = correlation * along + (1.0 - correlation * correlation).sqrt() * across;
                (x + by_x * along, y + by_y * up)
            };
            Series { name: name.into(), points: (0..=120).map(point).collect(), style: Style::Line }
        };
        Some(Chart {
            title: format!("{} and {}: 95 % lie within", first.name, second.name),
            x_label: format!("{} [{}]", first.name, first.unit),
            y_label: format!("{} [{}]", second.name, second.unit),
            series: vec![half("from above", 1.0), half("from below", -1.0)],
            ..Chart::default()
        })
    }

    fn page(&self) -> Page {
        let Report { fit, fitted, .. } = self;
        let mut page = Page::by_command(fit.scene, "fit to measurements");
        page.fact("ended", format!("{}: {}", count(fitted.iterations, "iteration"), ended(fitted)));
        page.fact("loss", fit.problem.loss.name());
        self.summary().show(&mut page);
        page.charts("Measured and computed", &self.charts());
        page.charts("Most correlated variables", self.ellipse().as_slice());
        page
    }

    fn json(&self, files: &[PathBuf]) -> Value {
        let Report { fit, fitted, .. } = self;
        let confidence = &fitted.confidence;
        let estimated: Vec<&str> = (0..confidence.estimated.len()).map(|own| self.variable(own).name.as_str()).collect();
        let combination = |own: &Combined| {
            let coefficients: serde_json::Map<_, _> =
                own.coefficients.iter().enumerate().map(|(k, c)| (self.variable(k).name.clone(), json!(c))).collect();
            json!({"coefficients": coefficients, "deviation": own.deviation})
        };
        let work = fitted.history.work();
        json!({
            "scene": fit.scene.name(),
            "loss": fit.problem.loss.name(),
            "optimum": fitted.is_optimum,
            "sum": fitted.sum,
            "degrees_of_freedom": fitted.degrees,
            "variables": self.variables().json(),
            "design": by_name(fit.variables(), fitted.design.iter().copied()),
            "estimated": estimated,
            "covariance": confidence.covariance,
            "combinations": confidence.combinations.iter().map(combination).collect::<Vec<_>>(),
            "measurements": self.curves().json(),
            "warnings": self.warnings(),
            "iterations": fitted.iterations,
            "simulations": work.simulations,
            "simulation_s": work.simulation_seconds,
            "tangent_runs": work.sweeps,
            "tangent_s": work.gradient_seconds,
            "history": self.iterations().json(),
            "files": names(files),
        })
    }

    fn verdict(&self) -> Result<(), Failure> {
        let Fitted { is_optimum, is_limit, iterations, .. } = self.fitted;
        match (is_optimum, is_limit) {
            (true, _) => Ok(()),
            (false, true) => Err(Failure {
                code: LIMIT_REACHED,
                message: format!(
                    "the limit of {} is reached; take more of them (--iterations), from here by --restart",
                    count(*iterations, "iteration")
                ),
            }),
            (false, false) => Err(Failure::run(format!("{}; try another start, or more exact runs", ended(self.fitted)))),
        }
    }
}
