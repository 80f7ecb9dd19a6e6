// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::console::{count, print, print_files, print_json, seconds, warn};
use super::earlier::keep_earlier;
use super::failure::{Failure, INTERRUPTED, LIMIT_REACHED};
use super::interrupt::Guard;
use super::kept_moments::KeptMoments;
use super::optimum::{conditions_json, largest_json, smooth_only};
use super::options::{SceneOptions, whole_number};
use super::report::Page;
use super::results::check_folder;
use super::simulation::{crossings_json, names, steps_in_words};
use super::snapshot::Snapshot;
use super::stability::{Statement, statement};
use super::summary::{Summary, by_name};
use super::{CommandLine, optimization_charts};
use crate::io::{Cell, Chart, IoError, Progress, Table, cells, read_csv, write_csv, write_json};
use clap::Args;
use costate::design::DesignVariable;
use costate::history::Keep;
use costate::integrators::{Crossing, RunError};
use costate::optimize::{
    Case, DesignHistory, DesignPoint, GradientBy, Optimization, Optimized, Optimizer, Reason, Watcher, optimizers,
};
use costate::scenes::{AnyScene, FunctionalConstraint, Prepared, Scenario, Sense, unknown};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Options of `costate optimize`.
#[derive(Args)]
pub struct OptimizeOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Optimizer: sqp; SciPy and others take values and gradients through Python
    #[arg(long, value_name = "NAME", default_value = "sqp")]
    optimizer: String,
    /// Where gradients come from: adjoint, complex-step, or difference:SHARE, one simulation for each variable at that share more of
    /// its value
    #[arg(long, value_name = "WHICH", default_value = "adjoint", value_parser = gradient_by)]
    gradient: GradientBy,
    /// Most iterations
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = whole_number::<MOST_ITERATIONS>, allow_negative_numbers = true)]
    iterations: usize,
    /// End after five iterations in a row that change the objective by less than this share
    #[arg(long, value_name = "SHARE", default_value_t = 1e-6, value_parser = share, allow_negative_numbers = true)]
    change: f64,
    /// Start at the best design of an earlier optimization.csv
    #[arg(long, value_name = "FILE")]
    restart: Option<PathBuf>,
    /// Go on with the optimization whose optimization.csv lies in the folder of results, as if it had not ended
    #[arg(long)]
    resume: bool,
    /// Starts: the given design, and others that fill the bounds evenly, on all processors; the best end counts
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole_number::<MOST_STARTS>, allow_negative_numbers = true)]
    starts: usize,
}

/// Relative change of variables for differences that balances their error and round-off.
const DEFAULT_SHARE: f64 = 1e-7;
pub(super) const MOST_ITERATIONS: usize = 1_000_000;
pub(super) const MOST_STARTS: usize = 10_000;

fn gradient_by(text: &str) -> Result<GradientBy, String> {
    let by_difference = |share| GradientBy::Difference { share };
    let by = match text {
        "adjoint" => Some(GradientBy::Adjoint),
        "complex-step" => Some(GradientBy::ComplexStep),
        "difference" => Some(by_difference(DEFAULT_SHARE)),
        _ => text.strip_prefix("difference:").and_then(|size| share(size).ok()).map(by_difference),
    };
    by.ok_or_else(|| {
        "it must be adjoint, complex-step, difference, or difference:SHARE with a number between 0 and 1, as in difference:0.01".into()
    })
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 => Ok(share),
        _ => Err("it must be a number between 0 and 1, as in 1e-6".into()),
    }
}

fn gradient_name(gradient: GradientBy) -> &'static str {
    match gradient {
        GradientBy::Adjoint => "adjoint",
        GradientBy::Difference { .. } => "difference",
        GradientBy::ComplexStep => "complex-step",
    }
}

/// Writes the history whenever it changes, but not before it has the points of the one that it goes on with; moves the
/// progress bar, and stops at Ctrl-C.
pub(super) struct Recording<'g> {
    pub path: PathBuf,
    /// How many points that one has.
    pub earlier: usize,
    pub guard: &'g Guard,
    pub progress: Option<Progress>,
    pub failed: Option<IoError>,
}

impl Watcher for Recording<'_> {
    fn changed(&mut self, history: &DesignHistory) -> bool {
        if let Some(iteration) = history.points.iter().rev().find_map(|point| point.iteration) {
            self.progress.iter().for_each(|progress| progress.set(iteration as u64));
        }
        if history.points.len() >= self.earlier {
            self.failed = write_csv(&self.path, &history.header(), history.rows()).err();
        }
        self.failed.is_none()
    }
    fn wants_to_stop(&self) -> bool {
        self.guard.requested()
    }
}

/// `costate optimize`: improves a scene's design, writes the history, prints before and after.
pub fn run(options: &OptimizeOptions, program: &CommandLine) -> Result<(), Failure> {
    let scene = options.scene.scene(program)?;
    let optimizer = optimizer(&options.optimizer)?;
    let problem = scene.optimization_problem().ok_or_else(|| program.no_problem(&*scene))?;
    options.scene.without_histories("an optimization")?;
    let cases = cases(&options.scene, &*scene)?;
    let located = |error| options.scene.located(&*scene, error);
    let mut optimization = Optimization::new(&*scene, problem, cases).map_err(located)?;
    optimization.gradient = options.gradient;
    optimization.stopping.iterations = options.iterations;
    optimization.stopping.change = options.change;
    let folder = options.scene.folder(&*scene);
    let path = folder.join("optimization.csv");
    let start = start(options, &optimization)?;
    if options.resume && (options.starts > 1 || options.restart.is_some() || !options.scene.set.is_empty()) {
        return Err(Failure::input(
            "--resume goes on from the start of the earlier optimization; leave --starts, --restart and --set out",
        ));
    }
    let recorded = match options.resume {
        true => Some(read_csv(&path).map_err(|message| Failure::input(format!("--resume {}: {message}", path.display())))?),
        false => None,
    };
    check_folder(&folder)?;
    if recorded.is_none() {
        keep_earlier(&path)?;
    }

    announce(&optimization, &*optimizer);
    let guard = Guard::new();
    let (optimized, mut files) = optimized(options, (&optimization, &*optimizer), &start, recorded, &folder, &guard)?;
    let (Some(first), Some(best)) = (optimized.history.points.first(), optimized.history.best()) else {
        return Err(Failure::run("no design could be simulated"));
    };
    let report = Report { optimization: &optimization, optimizer: &*optimizer, optimized: &optimized, first, best };
    let charts = optimization_charts::charts(&optimization, &optimized.history);
    let [page, summary] = ["optimization.html", "optimization.json"].map(|name| folder.join(name));
    files.extend([page.clone(), summary.clone()]);
    let motion = report.best_motion();
    let crossings = motion.as_ref().map_or(&[][..], |(_, _, crossings)| crossings);
    let mut shown = report.page(&charts, &motion);
    let warnings: Vec<String> = crossings.iter().map(ToString::to_string).collect();
    warnings.iter().for_each(|warning| shown.warning(format!("best design: {warning}")));
    shown.write(&page, &files)?;
    let mut json = report.json(&files);
    if !crossings.is_empty() {
        json["crossings"] = crossings_json(crossings);
    }
    write_json(&summary, &json)?;
    report.summary().print();
    warnings.iter().for_each(|warning| warn(&format!("best design: {warning}")));
    print_files(&files);
    print_json(options.scene.json, &json);
    report.verdict()
}

/// The scenarios of a scene, or the scene itself, as the options have them simulated.
pub(super) fn cases<'s>(options: &SceneOptions, scene: &'s dyn AnyScene) -> Result<Vec<Case<'s>>, Failure> {
    let case = |Scenario { name, scene }: Scenario<'s>| {
        let (method, settings) = options.simulation(scene)?;
        Ok(Case { name, scene, method: options.differentiable(method)?, settings })
    };
    options.scenarios(scene)?.into_iter().map(case).collect()
}

/// The best that comes of one start or of some, and the files written on the way.
fn optimized(
    options: &OptimizeOptions,
    (optimization, optimizer): (&Optimization, &dyn Optimizer),
    start: &[f64],
    recorded: Option<(Vec<String>, Vec<Vec<f64>>)>,
    folder: &Path,
    guard: &Guard,
) -> Result<(Optimized, Vec<PathBuf>), Failure> {
    let located = |error| options.scene.located(optimization.scene, error);
    let path = folder.join("optimization.csv");
    let earlier = recorded.as_ref().map_or(0, |own| own.1.len());
    let recording = |path: PathBuf, progress| Recording { path, earlier, guard, progress, failed: None };
    if options.starts == 1 {
        let progress = Progress::new("optimizing", options.iterations as u64);
        let mut recording = recording(path.clone(), Some(progress));
        let optimized = match &recorded {
            Some((header, rows)) => optimization.resume(optimizer, (header, rows), &mut recording),
            None => optimization.run(optimizer, start, &mut recording),
        };
        let optimized = optimized.map_err(located)?;
        recording.failed.map_or(Ok(()), Err)?;
        Ok((optimized, vec![path]))
    } else {
        let numbered = |number: usize| folder.join(format!("optimization.start-{number}.csv"));
        let mut recordings: Vec<Recording> = (1..=options.starts).map(|k| recording(numbered(k), None)).collect();
        let starts = optimization.starts(start, options.starts);
        let all = optimization.run_from_all(optimizer, &starts, &mut recordings);
        recordings.into_iter().try_for_each(|recording| recording.failed.map_or(Ok(()), Err))?;
        let (optimized, table) = best_of(optimization, all).map_err(located)?;
        print(format_args!("{table}\n"));
        write_csv(&path, &optimized.history.header(), optimized.history.rows())?;
        let files = (1..=options.starts).map(numbered).filter(|file| file.exists());
        Ok((optimized, files.chain([path]).collect()))
    }
}

/// The best end of several starts, and all of them as a table.
fn best_of(optimization: &Optimization, all: Vec<Result<Optimized, RunError>>) -> Result<(Optimized, Table), RunError> {
    let sign = if optimization.problem.sense == Sense::Maximize { -1.0 } else { 1.0 };
    let mut table = Table::new(&["start", "objective", "violation", "simulations", "ended"]);
    let mut best: Option<(Optimized, (u8, f64))> = None;
    let mut failure = None;
    for (k, own) in all.into_iter().enumerate() {
        let point = own.as_ref().ok().and_then(|optimized| optimized.history.best().cloned());
        match (own, point) {
            (Ok(optimized), Some(point)) => {
                let (simulations, ended) = (optimized.history.work().simulations, optimized.ended.reason.to_string());
                table.row(cells![k + 1, point.objective, point.violation, simulations, ended]);
                let satisfied = point.violation <= optimization.stopping.violation;
                let rank = (u8::from(!satisfied), if satisfied { sign * point.objective } else { point.violation });
                if best.as_ref().is_none_or(|(_, other)| rank < *other) {
                    best = Some((optimized, rank));
                }
            }
            (Ok(_), None) => {}
            (Err(error), _) => {
                let none = Cell::default();
                table.row(cells![k + 1, none.clone(), none.clone(), none, format!("failed: {error}")]);
                failure = Some(error);
            }
        }
    }
    match (best, failure) {
        (Some((optimized, _)), _) => Ok((optimized, table)),
        (None, failure) => Err(failure.unwrap_or_else(|| RunError::Input("no start could be simulated".into()))),
    }
}

fn optimizer(name: &str) -> Result<Box<dyn Optimizer>, Failure> {
    let known: Vec<String> = optimizers().iter().map(|optimizer| optimizer.name().into()).collect();
    optimizers().into_iter().find(|optimizer| optimizer.name() == name).ok_or_else(|| {
        let mut message = unknown("--optimizer", name, &known);
        if name.starts_with("nlopt") {
            message += "; in place of NLopt's, SciPy, IPOPT and others take values and gradients through Python";
        }
        Failure::input(message)
    })
}

impl CommandLine<'_> {
    fn no_problem(&self, scene: &dyn AnyScene) -> Failure {
        let able = self.all_scenes().into_iter().flatten().filter(|scene| scene.optimization_problem().is_some());
        let names: Vec<String> = able.map(|scene| scene.name()).collect();
        let others = if names.is_empty() { String::new() } else { format!("; scenes that do: {}", names.join(", ")) };
        Failure::input(format!("the scene \"{}\" states no optimization problem{others}", scene.name()))
    }
}

/// The design of `--restart` or `--set`.
fn start(options: &OptimizeOptions, optimization: &Optimization) -> Result<Vec<f64>, Failure> {
    let Some(file) = &options.restart else { return options.scene.design(optimization.scene) };
    let maximize = optimization.problem.sense == Sense::Maximize;
    restarted(file, &options.scene, optimization.variables(), maximize, optimization.stopping.violation)
}

/// The best design of the table of an earlier search.
pub(super) fn restarted(
    file: &Path,
    options: &SceneOptions,
    variables: &[DesignVariable],
    maximize: bool,
    tolerance: f64,
) -> Result<Vec<f64>, Failure> {
    let named = |message: String| Failure::input(format!("--restart {}: {message}", file.display()));
    if !options.set.is_empty() {
        return Err(named("the design comes from the file; leave --set out".into()));
    }
    let (header, rows) = read_csv(file).map_err(named)?;
    let best = DesignHistory::best_of_table(&header, &rows, variables, maximize, tolerance).map_err(named)?;
    print(format_args!("starts at evaluation {} of {}", best.evaluation, file.display()));
    Ok(best.design)
}

fn announce(optimization: &Optimization, optimizer: &dyn Optimizer) {
    let Optimization { scene, problem, cases, .. } = optimization;
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    print(format_args!("{} {}", problem.sense.name(), problem.objective_name()));
    let constraints = count(problem.constraints.len(), "nonlinear constraint");
    let linear = count(problem.linear.len(), "linear constraint");
    let variables = count(optimization.varying().len(), "variable");
    print(format_args!(
        "{variables}, {constraints}, {linear}; {}, gradients by {}",
        optimizer.name(),
        gradient_name(optimization.gradient)
    ));
    for Case { name, method, settings, .. } in cases {
        let which = if name.is_empty() { "each design".into() } else { format!("scenario \"{name}\"") };
        print(format_args!("{which}: {}", steps_in_words(method, settings)));
    }
    print("");
}

/// The best design once more: its motion, and where formulas pass from one piece to another.
type BestMotion<'r> = (Prepared<'r>, Vec<Snapshot>, Vec<Crossing>);

struct Report<'r> {
    optimization: &'r Optimization<'r>,
    optimizer: &'r dyn Optimizer,
    optimized: &'r Optimized,
    first: &'r DesignPoint,
    best: &'r DesignPoint,
}

impl<'r> Report<'r> {
    /// Objective, limits and linear constraints, before and after.
    fn wanted(&self) -> Table {
        let Report { optimization: Optimization { problem, .. }, optimized, first, best, .. } = self;
        let functionals = &optimized.history.functionals;
        let place = |name: &str| functionals.iter().position(|own| own.0 == name).unwrap_or_default();
        let keys = ["kind", "name", "sign", "limit", "before", "after", "unit"];
        let mut table = Table::new(&["", "", "", "limit", "before", "after", "unit"]).keyed(&keys);
        let unit = if let [only] = &problem.objective[..] { &*functionals[place(&only.0)].1 } else { "" };
        let (kind, name, none) = (problem.sense.name(), problem.objective_name(), Cell::default());
        table.row(cells![kind, name, none.clone(), none, first.objective, best.objective, unit]);
        for FunctionalConstraint { functional, limit, .. } in &problem.constraints {
            let place = place(functional);
            let [before, after] = [first, best].map(|point| point.functionals[place]);
            table.row(cells!["limit", functional, limit.sign(), limit.value(), before, after, &functionals[place].1]);
        }
        let [before, after] = [first, best].map(|point| self.optimization.linear_values(&point.design));
        for ((own, before), after) in problem.linear.iter().zip(before).zip(after) {
            table.row(cells!["linear", &own.name, own.limit.sign(), own.limit.value(), before, after, ""]);
        }
        table
    }

    /// Variables that vary, with what they were, what they are, and the bound they are at.
    fn variables(&self) -> Table {
        let keys = ["name", "before", "after", "lower", "upper", "unit", "at_bound"];
        let mut table = Table::new(&["variable", "before", "after", "from", "to", "unit", ""]).keyed(&keys);
        for i in self.optimization.varying() {
            let DesignVariable { name, lower, upper, unit, .. } = &self.optimization.variables()[i];
            let after = self.best.design[i];
            let is_close = |bound: f64| (after - bound).abs() <= 1e-6 * (upper - lower).min(bound.abs().max(after.abs()));
            let bound = [("lower", *lower), ("upper", *upper)].into_iter().find(|own| is_close(own.1));
            let bound = bound.map(|(bound, _)| Cell::of(format!("at its {bound} bound"), bound));
            table.row(cells![name, self.first.design[i], after, *lower, *upper, *unit, bound]);
        }
        table
    }

    fn iterations(&self) -> Table {
        let (mut table, mut simulations) = (Table::new(&["iteration", "simulations", "objective", "violation"]), 0);
        for point in &self.optimized.history.points {
            simulations += point.work.simulations;
            if let Some(iteration) = point.iteration {
                table.row(cells![iteration, simulations, point.objective, point.violation]);
            }
        }
        table
    }

    fn work(&self) -> Table {
        let work = self.optimized.history.work();
        let mut table = Table::new(&["", "number", "time"]);
        let sweeps = match self.optimization.gradient {
            GradientBy::Adjoint => "adjoint sweeps",
            GradientBy::Difference { .. } => "simulations for differences",
            GradientBy::ComplexStep => "complex-step simulations",
        };
        table.row(cells!["simulations", work.simulations, seconds(work.simulation_seconds)]);
        table.row(cells![sweeps, work.sweeps, seconds(work.gradient_seconds)]);
        table
    }

    /// What is told, on a page, too.
    fn summary(&self) -> Summary {
        let Report { optimization, optimized, best, .. } = self;
        let (mut summary, ended) = (Summary::default(), &optimized.ended);
        summary.table("", self.iterations());
        summary.table("What is wanted", self.wanted());
        summary.table("Design variables", self.variables());
        summary.table("", self.work());
        summary.words(format!("{}: {}", count(ended.iterations, "iteration"), ended.reason));
        if ended.failed > 0 {
            let why = optimized.failure.as_ref().map_or_else(String::new, |error| format!("; the last one: {error}"));
            summary.words(format!("{} could not be simulated{why}", count(ended.failed, "design")));
        }
        summary.conditions(optimization, optimized, best);
        summary.words(format!(
            "best design, evaluation {}:{}\n",
            best.evaluation,
            settings(optimization.variables(), &optimization.varying(), &best.design)
        ));
        summary
    }

    /// What is shown of it, with the motion of the best design.
    fn page(&self, charts: &[Chart], motion: &Result<BestMotion<'r>, RunError>) -> Page {
        let Report { optimization, optimizer, optimized, best, .. } = self;
        let (scene, ended) = (optimization.scene, &optimized.ended);
        let mut page = Page::by_command(scene, "optimization");
        page.fact("optimizer", format!("{}, gradients by {}", optimizer.name(), gradient_name(optimization.gradient)));
        page.fact("ended", format!("{}: {}", count(ended.iterations, "iteration"), ended.reason));
        page.fact("simulations", optimized.history.work().simulations.to_string());
        if !(best.violation <= optimization.stopping.violation) {
            page.warning(format!(
                "No design keeps all limits: the best one violates them by {:.1e} of their scale.",
                best.violation
            ));
        }
        self.summary().show(&mut page);
        match motion {
            Ok((prepared, moments, _)) => page.motion(prepared, moments),
            Err(error) => page.warning(format!("The best design could not be simulated again: {error}")),
        }
        page.charts("Optimization", charts);
        page
    }

    /// The best design once more, in all scenarios; the motion is that of the first.
    fn best_motion(&self) -> Result<BestMotion<'r>, RunError> {
        let mut first: Option<BestMotion<'r>> = None;
        for case in &self.optimization.cases {
            let Case { scene, method, settings, .. } = case;
            let mut prepared = Prepared::with(*scene, &self.best.design, method.clone(), settings.clone())?;
            prepared.keep = Keep::Nothing;
            let mut kept = KeptMoments::default();
            let (forward, stopped) = prepared.analysis().observed(&prepared.x, &mut kept)?;
            stopped.map_or(Ok(()), Err)?;
            if let Some(Statement::Warning(words)) = statement(&prepared, &forward) {
                warn(&case.told(words));
            }
            match &mut first {
                None => first = Some((prepared, kept.finish(), forward.crossings)),
                Some((_, _, crossings)) => crossings.extend(forward.crossings),
            }
        }
        first.ok_or_else(|| RunError::Input("there is no scenario to run".into()))
    }

    fn json(&self, files: &[PathBuf]) -> Value {
        let Report { optimization, optimizer, optimized, best, .. } = self;
        let (ended, work, wanted) = (&optimized.ended, optimized.history.work(), self.wanted().json());
        json!({
            "scene": optimization.scene.name(),
            "method": optimization.cases.first().map(|case| case.method.table.name.clone()),
            "scenarios": optimization.cases.iter().map(|case| &*case.name).filter(|name| !name.is_empty()).collect::<Vec<_>>(),
            "optimizer": optimizer.name(),
            "gradient": gradient_name(optimization.gradient),
            "reason": ended.reason.name(),
            "optimum": ended.reason.is_optimum(),
            "objective": wanted[0],
            "constraints": wanted[1..],
            "largest_violation": best.violation,
            "conditions": conditions_json(optimization, ended),
            "largest_values": largest_json(optimized, best),
            "kept_in_the_smooth_sense_only": smooth_only(optimization, optimized, best),
            "variables": self.variables().json(),
            "design": by_name(optimization.variables(), best.design.iter().copied()),
            "best_evaluation": best.evaluation,
            "iterations": ended.iterations,
            "simulations": work.simulations,
            "simulation_newton_iterations": work.simulation.iterations,
            "simulation_factorizations": work.simulation.factorizations,
            "simulation_s": work.simulation_seconds,
            "gradient_sweeps": work.sweeps,
            "gradient_factorizations": work.gradient.factorizations,
            "gradient_s": work.gradient_seconds,
            "failed_designs": ended.failed,
            "history": self.iterations().json(),
            "files": names(files),
        })
    }

    fn verdict(&self) -> Result<(), Failure> {
        let Report { optimization, optimized, best, .. } = self;
        let tolerance = optimization.stopping.violation;
        match optimized.ended.reason {
            Reason::Stopped => Err(Failure {
                code: INTERRUPTED,
                message: format!(
                    "stopped after {}; the best design so far is printed, and optimization.csv can be taken up by --restart",
                    count(optimized.ended.iterations, "iteration")
                ),
            }),
            Reason::Iterations => Err(Failure {
                code: LIMIT_REACHED,
                message: format!(
                    "no optimum: the limit of {} is reached{}; take more of them (--iterations), from here by --restart",
                    count(optimized.ended.iterations, "iteration"),
                    if best.violation <= tolerance {
                        String::new()
                    } else {
                        format!(", and the best design violates limits by {:.1e} of their scale", best.violation)
                    }
                ),
            }),
            reason if !(best.violation <= tolerance) => Err(Failure::run(format!(
                "no design keeps all limits: the best one violates them by {:.1e} of their scale ({reason}); another start may find one \
                 that does",
                best.violation
            ))),
            reason if !reason.is_optimum() => Err(Failure::run(format!(
                "the best design keeps all limits, but it is no verified optimum: {reason}; try another start, or more exact runs and \
                 gradients"
            ))),
            _ => Ok(()),
        }
    }
}

/// `--set` options that repeat a design.
pub(super) fn settings(variables: &[DesignVariable], varying: &[usize], design: &[f64]) -> String {
    let option = |&place: &usize| {
        let (name, value) = (&variables[place].name, design[place]);
        let quote = if name.contains(' ') { "\"" } else { "" };
        format!(" --set {quote}{name}={value}{quote}")
    };
    varying.iter().map(option).collect()
}
