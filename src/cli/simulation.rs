use super::console::{count, print, seconds};
use super::energy_balance::{BalanceFunctionals, EnergyBalance, RunningBalance};
use super::failure::Failure;
use super::interrupt::Guard;
use super::measured_modes::MeasuredModes;
use super::measured_moments::{EnergyCourse, MeasuredRun};
use super::options::SceneOptions;
use super::projected_start::ProjectedStart;
use super::report::{Page, Shown};
use super::results::{Finished, Results, check_folder};
use super::stability::{self, Statement};
use super::summary::by_name;
use crate::io::{Cell, Progress, Table, cells, write_json};
use costate::design::shortest;
use costate::exchange::is_shared;
use costate::functionals::{Extreme, Extremes, Functional, Over, Times};
use costate::history::{Observer, Usage};
use costate::integrators::{
    ConstraintLevel, Counters, Crossing, DEFAULT_TABLE, Method, NewtonTolerance, RunError, StartRecord, StepControl,
    StepError, StepRecord,
};
use costate::linalg::SolverPlan;
use costate::program::{SwitchKind, making_time, refuses_machine_code};
use costate::scenes::{Prepared, Settings};
use costate::sensitivity::Forward;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Names and numbers of what something cost; the names are those of the JSON object.
pub type Work = Vec<(&'static str, Value)>;

/// A simulated scene with its files written.
pub struct Simulation {
    /// States and functionals, of the finished steps only if the run stopped early.
    pub forward: Forward,
    /// Wall time of the simulation with its functionals [s].
    pub seconds: f64,
    /// For recording formulas and compiling their programs [s]; those that were first needed during the simulation are part of its time.
    pub program_seconds: f64,
    pub measured: MeasuredRun,
    /// The balance of its energy, where that is not constant.
    pub balance: Option<EnergyBalance>,
    pub files: Vec<PathBuf>,
    /// Why other files could not be written.
    pub unwritten: Option<Failure>,
    pub stopped: Option<Failure>,
    pub folder: PathBuf,
    pub modes: MeasuredModes,
    /// What a projection of the start changed.
    pub start: Option<ProjectedStart>,
}

/// Writes results, moves the progress bar, and stops at Ctrl-C.
struct ProgressObserver<'p, 'g> {
    prepared: &'p Prepared<'p>,
    results: Results<'p>,
    start: Option<ProjectedStart>,
    balance: Option<RunningBalance<'g>>,
    progress: Progress,
    /// Marks of the progress bar per second.
    pace: f64,
    guard: &'g Guard,
}

/// Marks of the progress bar: steps that choose their size do not tell how many there will be.
const MARKS: f64 = 1000.0;

impl Observer for ProgressObserver<'_, '_> {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.balance.iter_mut().for_each(|balance| balance.start(start));
        self.start = ProjectedStart::of(self.prepared, start);
        self.results.start(start)
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.balance.iter_mut().for_each(|balance| balance.step(step));
        self.progress.set((self.pace * (step.t + step.h)) as u64);
        Ok(self.results.step(step)? && !self.guard.requested())
    }
}

/// Simulates a prepared scene and writes its files.
pub fn simulate(prepared: &Prepared, options: &SceneOptions) -> Result<Simulation, Failure> {
    let folder = options.folder(prepared.scene);
    check_folder(&folder)?;
    announce(prepared)?;
    let modes = MeasuredModes::of(prepared)?;
    let guard = Guard::new();
    let marks = if prepared.control.is_some() { MARKS } else { prepared.grid.steps() as f64 };
    let pace = (1.0 + f64::EPSILON) * marks / prepared.grid.times[prepared.grid.steps()];
    let progress = Progress::new("simulating", marks as u64);
    let output = options.output(prepared.scene);
    let results = Results::begin(prepared, &output, &folder)?;
    let functionals = BalanceFunctionals::new(prepared);
    let balance = functionals.as_ref().map(|own| own.begin(prepared));
    let mut observer = ProgressObserver { prepared, results, start: None, balance, progress, pace, guard: &guard };
    let begun = Instant::now();
    let (forward, mut stopped) = prepared.analysis().observed(&prepared.x, &mut observer)?;
    let (seconds, program_seconds) = (begun.elapsed().as_secs_f64(), making_time());
    if refuses_machine_code() {
        print("the system refuses memory for machine code: programs are executed by a loop, which takes longer");
    }
    let ProgressObserver { results, start, balance, progress, .. } = observer;
    drop(progress);
    start.iter().for_each(|start| start.summary().print());
    if stopped.is_none() {
        stopped = prepared.analysis().check_values(&forward).err();
    }
    let balance = balance.and_then(RunningBalance::finish);
    let Finished { files, unwritten, measured } = results.finish();
    if guard.requested() && stopped.is_none() {
        stopped = Some(RunError::Interrupted { steps: forward.history.steps() });
    }
    let stands = || match stability::statement(prepared, &forward) {
        Some(Statement::Warning(message)) if options.stable => Some(Failure::run(message)),
        _ => None,
    };
    let stopped = stopped.map(|error| with_hint(error, prepared)).or_else(stands);
    Ok(Simulation { forward, seconds, program_seconds, measured, balance, files, unwritten, stopped, folder, modes, start })
}

/// Says what will be simulated.
fn announce(prepared: &Prepared) -> Result<(), RunError> {
    let Prepared { scene, method, grid, .. } = prepared;
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    let end = grid.times[grid.steps()];
    let is_static = method.table.is_static();
    let steps = match prepared.control {
        Some(_) if is_static => "load steps chosen by the success of Newton's method".into(),
        Some(StepControl { coordinates, velocities, .. }) => {
            let (q, v) = (coordinates.relative, velocities.relative);
            format!("steps to a tolerance of {q:e} (coordinates) and {v:e} (velocities)")
        }
        None if is_static => count(grid.steps(), "load step"),
        None => count(grid.steps(), "step"),
    };
    let level = method.constraint_level().name();
    let newton = match method.tolerance {
        NewtonTolerance::RoundOff => String::new(),
        rule => format!(", Newton's method by the rule \"{}\"", rule.name()),
    };
    if is_static {
        print(format_args!("{}, equilibria, {steps} up to the load factor {}{newton}", method.table.name, shortest(end)));
    } else {
        print(format_args!("{}, constraints at {level} level, {steps} over {} s{newton}", method.table.name, shortest(end)));
    }
    let redundant = prepared.redundant();
    if !redundant.is_empty() {
        let names: Vec<_> = redundant.iter().map(|&row| prepared.model().equation_name(row)).collect();
        print(format_args!("redundant and left out: {}", names.join("; ")));
        let [joints, _] = prepared.undetermined();
        if !joints.is_empty() {
            let joints = quoted(&joints);
            print(format_args!(
                "not determined by the model: how the joints {joints} share their loads; those of least norm are given"
            ));
        }
    }
    let SolverPlan { backend, unknowns, work, ranks, ordering, .. } = prepared.linear_solver()?;
    let work =
        work.map(|work| format!(", {:.1e} multiplications a factorization", work.multiplications)).unwrap_or_default();
    let ordered = ordering.map(|ordering| format!(", ordered by {ordering}")).unwrap_or_default();
    print(format_args!("linear systems of {}: {} LU{ordered}{work}", count(unknowns, "unknown"), backend.name()));
    match ranks {
        1 if is_shared() => print("too small to be shared: each rank solves all of them"),
        1 => {}
        _ => print(format_args!("shared by {ranks} ranks")),
    }
    print("");
    Ok(())
}

/// How each of many designs is simulated.
pub fn steps_in_words(method: &Method, settings: &Settings) -> String {
    let steps = if settings.control.is_some() { "chosen steps".into() } else { count(settings.steps, "step") };
    format!("{}, {steps} over {} s", method.table.name, shortest(settings.end))
}

/// The failure, with the options that its advice is about.
pub fn with_hint(error: RunError, prepared: &Prepared) -> Failure {
    let failure = Failure::from(error);
    let option = match prepared.control {
        Some(_) => "--longest-step".into(),
        None => format!("--steps above {}", prepared.grid.steps()),
    };
    let chosen = if prepared.method.table.embedded.is_some() { "" } else { " with another method" };
    // what is used already is no remedy
    let own = format!(", or for stiff forces the method {}", prepared.method.table.name);
    let message = failure.message.replace(&own, "");
    let message = message.replace("a smaller step", &format!("a smaller step ({option})"));
    let message =
        message.replace("steps chosen by their error", &format!("steps chosen by their error (--tolerance 1e-6{chosen})"));
    Failure { message, ..failure }
}

/// The values of the functionals, and where that is asked for the largest and smallest values with their times and places.
pub fn functionals(prepared: &Prepared, forward: &Forward) -> Table {
    let titles = ["functional", "value", "unit", "true largest", "at [s]", "in", "true smallest", "at [s]", "in", "unit"];
    let keys = [
        "name",
        "value",
        "unit",
        "largest.value",
        "largest.t",
        "largest.element",
        "smallest.value",
        "smallest.t",
        "smallest.element",
        "",
    ];
    let shown = if forward.extremes.iter().any(Option::is_some) { titles.len() } else { 3 };
    let mut table = Table::new(&titles[..shown]).keyed(&keys);
    for ((functional, &value), extremes) in prepared.functionals().iter().zip(&forward.values).zip(&forward.extremes) {
        let mut row = cells![&functional.name, Cell::long(value), functional.value_unit()].to_vec();
        if let Some(Extremes { smallest, largest }) = extremes {
            for Extreme { value, t, element } in [largest, smallest] {
                row.extend(cells![*value, *t, element.as_deref()]);
            }
            row.push(functional.unit.into());
        }
        table.row(row);
    }
    table
}

/// Events that happened, each with how often and when; `None` where none did.
pub fn events(prepared: &Prepared, forward: &Forward) -> Option<Table> {
    let all = prepared.analysis().events(forward);
    let mut table = Table::new(&["event", "times", "first [s]", "last [s]"]).keyed(&["name", "count", "first_s", "last_s"]);
    let mut told: Vec<&str> = Vec::new();
    for own in &all {
        if told.contains(&own.name.as_str()) {
            continue;
        }
        told.push(&own.name);
        let times: Vec<f64> = all.iter().filter(|other| other.name == own.name).map(|other| other.t).collect();
        table.row(cells![&own.name, times.len(), Cell::long(times[0]), Cell::long(times[times.len() - 1])]);
    }
    (!all.is_empty()).then_some(table)
}

impl Simulation {
    pub fn work(&self, prepared: &Prepared) -> Work {
        let Counters { systems, iterations, residuals, factorizations, solves, choices, .. } = self.forward.counters;
        let mut work = vec![("steps", json!(self.forward.history.steps()))];
        // a run that stopped early does not tell
        if systems > 0 {
            if prepared.control.is_some() || self.forward.rejected > 0 {
                work.push(("rejected_steps", json!(self.forward.rejected)));
            }
            work.extend([
                ("systems", json!(systems)),
                ("newton_iterations", json!(iterations)),
                ("factorizations", json!(factorizations)),
                ("solves", json!(solves)),
                ("residual_evaluations", json!(residuals)),
            ]);
            if choices > 0 {
                work.push(("redundant_equations_chosen_anew", json!(choices)));
            }
        }
        let Usage { steps, checkpoints, written, taken_over, .. } = self.forward.history.usage();
        work.push(("steps_in_memory", json!(steps)));
        for (name, count) in [
            ("checkpoints", checkpoints as u64),
            ("history_bytes_written", written),
            ("steps_taken_over", taken_over as u64),
        ] {
            work.extend((count > 0).then(|| (name, json!(count))));
        }
        work.push(("time_s", json!(self.seconds)));
        work.push(("programs_s", json!(self.program_seconds)));
        work
    }

    /// What is told of it.
    pub fn shown(&self, prepared: &Prepared) -> Shown<'_> {
        Shown {
            forward: &self.forward,
            measured: &self.measured,
            start: self.start.as_ref(),
            balance: self.balance,
            warnings: self.warnings(prepared),
            stopped: self.stopped.as_ref().map(|failure| failure.message.as_str()),
        }
    }

    /// Warnings where the steps hardly resolve the motion, the model does not determine what is asked for, or an equilibrium does not stand.
    fn warnings(&self, prepared: &Prepared) -> Vec<String> {
        let mut warnings = warnings(prepared, &self.forward);
        warnings.extend(energy_in_words(self.measured.energy));
        warnings.extend_from_slice(&self.measured.left_tables);
        if let Some(balance) = self.balance.filter(|own| own.share().is_some_and(|share| share > StepError::COARSE)) {
            warnings.push(format!("{}: take smaller steps, or a smaller tolerance", balance.in_words()));
        }
        warnings.extend(self.forward.crossings.iter().map(ToString::to_string));
        if self.stopped.is_none() && prepared.analysis().runs_beyond_its_end(&self.forward) {
            warnings.push("no event has ended the run: it goes to the end of [settings]".into());
        }
        warnings
    }

    /// Writes the report, if there is one, and the summary, the last files of a run, and returns the summary with all files.
    pub fn conclude(&mut self, page: Option<Page>, mut summary: Value) -> Value {
        let [summary_file, report] = ["summary.json", "report.html"].map(|name| self.folder.join(name));
        if self.files.is_empty() {
            return summary;
        }
        let beside = [&self.files[..], std::slice::from_ref(&summary_file)].concat();
        let reported = page.map_or(Ok(()), |page| page.write(&report, &beside).map(|()| self.files.push(report)));
        self.files.push(summary_file);
        summary["files"] = names(&self.files);
        let summarized = write_json(&self.files[self.files.len() - 1], &summary);
        if summarized.is_err() {
            self.files.pop();
            summary["files"] = names(&self.files);
        }
        self.unwritten = self.unwritten.take().or(reported.err()).or(summarized.err().map(Failure::from));
        summary
    }

    /// What the program ends with: the simulation, unless it stopped early or files could not be written.
    pub fn verdict(mut self) -> Result<Self, Failure> {
        self.stopped.take().or(self.unwritten.take()).map_or(Ok(self), Err)
    }

    /// Writes the summary of what is there already, before work that may be stopped; [`Simulation::conclude`] replaces it, and says what
    /// could not be written.
    pub fn summarize(&self, summary: &Value) {
        if !self.files.is_empty() {
            let _ = write_json(&self.folder.join("summary.json"), summary);
        }
    }

    /// The parts of the JSON object that every simulation has, without those of which there is nothing to say.
    pub fn json(&self, prepared: &Prepared) -> Value {
        let Prepared { scene, method, grid, control, .. } = prepared;
        let Forward { error, leap, stability, crossings, .. } = &self.forward;
        let [joints, of_functionals] = prepared.undetermined();
        let changes = self.measured.energy.map(|energy| energy.shares());
        let change = |place: usize| changes.map(|all| json!({"share_of_kinetic": all[place].0, "t": all[place].1}));
        let step_error = |StepError { share, step, t, dof, in_velocity }| {
            let coordinate = prepared.model().dof_name(dof);
            json!({"share": share, "step": step, "t": t, "coordinate": coordinate, "velocity": in_velocity})
        };
        let mut object = json!({
            "scene": scene.name(),
            "method": method.table.name,
            "newton": method.tolerance.name(),
            "constraint_level": method.constraint_level().name(),
            "tolerance": control.map(|own| json!({"coordinates": own.coordinates.relative, "velocities": own.velocities.relative})),
            "planned_steps": control.is_none().then(|| grid.steps()),
            "end_s": self.forward.grid.times[self.forward.grid.steps()],
            "design": by_name(&prepared.variables, prepared.x.iter().copied()),
            "functionals": functionals(prepared, &self.forward).json(),
            "events": events(prepared, &self.forward).map(|table| table.json()),
            "modes": self.modes.json(prepared),
            "not_determined": (!joints.is_empty()).then(|| json!({"joints": joints, "functionals": of_functionals})),
            "projected_start": self.start.as_ref().map(ProjectedStart::json),
            "largest_step_error": error.map(step_error),
            "leap_over_dead_point": leap.map(|(t, step)| json!({"step": step, "t": t})),
            "stability": stability.as_ref().map(stability::json),
            "crossings": (!crossings.is_empty()).then(|| crossings_json(crossings)),
            "energy_growth": change(0),
            "energy_loss": change(1),
            "energy_balance_J": self.balance.map(|balance| balance.json()),
            "files": names(&self.files),
            "error": self.stopped.as_ref().map(|failure| &failure.message),
        });
        for (name, value) in self.work(prepared) {
            object[if name == "time_s" { "forward_s" } else { name }] = value;
        }
        object.as_object_mut().into_iter().for_each(|own| own.retain(|_, value| !value.is_null()));
        object
    }
}

/// Warnings where an energy changes that should be constant.
pub fn energy_in_words(energy: Option<EnergyCourse>) -> Vec<String> {
    let changes = ["grows", "falls"].into_iter().zip(energy.iter().flat_map(EnergyCourse::shares));
    let coarse = changes.filter(|(_, (share, _))| *share > StepError::COARSE);
    let words = coarse.map(|(word, (share, t))| {
        format!(
            "the energy of this scene is constant in an exact motion, but {word} by {:.1} % of the largest kinetic energy until \
             t = {} s: take smaller steps, or a smaller tolerance",
            100.0 * share,
            shortest(t)
        )
    });
    words.collect()
}

/// Warnings about a run where its steps hardly resolve the motion, the model does not determine what is asked for, or an equilibrium does
/// not stand.
pub fn warnings(prepared: &Prepared, forward: &Forward) -> Vec<String> {
    let mut warnings: Vec<String> = error_in_words(prepared, forward).and_then(|error| error.1).into_iter().collect();
    if let Some((t, step)) = forward.leap {
        warnings.push(format!(
            "step {step} (t = {} s) leaps over a dead point: the drives determine the motion, and it goes on along another branch from there on; \
             let the steps be chosen (--tolerance)",
            shortest(t)
        ));
    }
    let [_, functionals] = prepared.undetermined();
    if !functionals.is_empty() {
        warnings.push(format!(
            "the model does not determine {}: redundant joints share loads in many ways, of which the one of least norm is given; leave out \
             equations that the real joints do not have, or let parts be flexible",
            quoted(&functionals)
        ));
    }
    if let Some(Statement::Warning(words)) = stability::statement(prepared, forward) {
        warnings.push(words);
    }
    warnings.extend(rough_reactions(prepared).or_else(|| swinging_reactions(prepared, forward)));
    warnings.extend(beside_ends(prepared, forward));
    warnings
}

/// Share of a reaction by which it may swing from step to step.
const SWINGING: f64 = 0.01;

/// The warning of a method that does not damp the reactions of constraints at position level (Cardona & Geradin, Computers & Structures 33 (1989)),
/// or whose stages do not have them.
fn rough_reactions(prepared: &Prepared) -> Option<String> {
    let (table, level) = (&prepared.method.table, prepared.method.constraint_level());
    if level != ConstraintLevel::Position {
        return None;
    }
    let (fault, better) = match (table.radius_at_infinity < 1.0, table.reactions_converge()) {
        (false, _) => (
            "swing from each step to the next, undamped, and their derivatives need not converge",
            "a method that damps them",
        ),
        (_, false) => (
            "at stages are off by as much as they are themselves, in steps of any size: only their means over steps are right",
            "a method whose stages have order 2",
        ),
        _ => return None,
    };
    let reads =
        |own: &&Functional| own.over != Over::Integral && own.over.times() != Times::Start && own.reads_multipliers();
    let names: Vec<&str> = prepared.functionals().iter().filter(reads).map(|own| own.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: with \"{}\" and constraints at position level reactions {fault}; take constraints at acceleration level, or {better}, as \
             {DEFAULT_TABLE}",
            quoted(&names),
            table.name
        )
    })
}

/// The warning that reactions at the end alternate from step to step, as those of constraints at position level do behind a change of steps (Arnold,
/// Bruls, Cardona, Numerische Mathematik 129 (2015)).
fn swinging_reactions(prepared: &Prepared, forward: &Forward) -> Option<String> {
    let swinging = || prepared.functionals().iter().zip(&forward.swings).filter(|(_, share)| **share > SWINGING);
    let names: Vec<&str> = swinging().map(|(own, _)| own.name.as_str()).collect();
    let most = swinging().fold(0.0, |most: f64, (_, share)| most.max(*share));
    (!names.is_empty()).then(|| {
        format!(
            "{}: reactions swing by {:.1} % of the largest from each step to the next at the end of the run, and their derivatives by more, as those of constraints \
             at position level do where steps have changed; take constraints at acceleration level, or smaller steps",
            quoted(&names),
            100.0 * most
        )
    })
}

/// Warnings of a method whose stages do not lie where steps end.
fn beside_ends(prepared: &Prepared, forward: &Forward) -> Vec<String> {
    let (table, mut warnings) = (&prepared.method.table, Vec::new());
    if table.stiffly_accurate {
        return warnings;
    }
    let reads = |own: &&Functional| own.over.times() == Times::End && own.reads_multipliers();
    let names: Vec<&str> = prepared.functionals().iter().filter(reads).map(|own| own.name.as_str()).collect();
    if !names.is_empty() {
        warnings.push(format!(
            "{} at the end of the run: reactions are read at the last stage of \"{}\", which does not lie there, and are right to first order of the step \
             only; take a method whose last stage does, as {DEFAULT_TABLE}",
            quoted(&names),
            table.name
        ));
    }
    let (inside, grid) = (0.0..=1.0, &forward.grid);
    let place = grid.breakpoints.keys().find(|&&place| place > 0 && place < grid.steps());
    if let Some(&place) = place.filter(|_| table.stages.iter().any(|stage| !inside.contains(&stage.c))) {
        warnings.push(format!(
            "stages of \"{}\" lie before and behind their steps, and read what jumps or bends at t = {} s from its other side: the motion and gradients \
             are right to first order of the step only; take a method whose stages do not, as {DEFAULT_TABLE}",
            table.name,
            shortest(grid.times[place])
        ));
    }
    warnings
}

/// The largest estimated error of a step, and the warning that it is large.
pub fn error_in_words(prepared: &Prepared, forward: &Forward) -> Option<(String, Option<String>)> {
    let StepError { share, step, t, dof, in_velocity } = forward.error.filter(|own| own.share > 0.0)?;
    let of = if in_velocity { "largest velocity" } else { "model's length" };
    let name = prepared.model().dof_name(dof);
    let place = format!("step {step} (t = {} s), {name}{}", shortest(t), if in_velocity { ", velocity" } else { "" });
    let warning = (share > StepError::COARSE).then(|| {
        let steps = prepared.grid.steps();
        let chosen =
            if prepared.method.table.embedded.is_some() { "--tolerance" } else { "--tolerance with another method" };
        format!(
            "a step has an estimated error of {:.1} % of the {of}, {place}: the motion may be another one from there on; take smaller steps \
             (--steps above {steps}), or {chosen}",
            100.0 * share
        )
    });
    Some((format!("{share:.1e} of the {of}, {place}"), warning))
}

fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Crossings of switches for JSON.
pub fn crossings_json(crossings: &[Crossing]) -> Value {
    let object = |crossing: &Crossing| {
        let Crossing { part, is_functional, kind, step, t, count, last, passed_over } = crossing;
        let kind = if *kind == SwitchKind::Jump { "jump" } else { "kink" };
        json!({"part": part, "functional": is_functional, "kind": kind, "step": step, "t": t, "steps": count, "last_step": last,
               "passed_over_s": passed_over})
    };
    crossings.iter().map(object).collect()
}

pub fn names(files: &[PathBuf]) -> Value {
    files.iter().map(|file| json!(file.display().to_string())).collect()
}

/// Prints work as a table of two columns: `newton_iterations` as "Newton iterations".
pub fn print_work(columns: &[(&str, Work)]) {
    let mut header = vec![""];
    header.extend(columns.iter().map(|(name, _)| *name));
    let mut table = Table::new(&header);
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in columns.iter().flat_map(|(_, work)| work) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    names.sort_by_key(|name| name.ends_with("_s"));
    for name in names {
        let cell = |(_, work): &(&str, Work)| match work.iter().find(|(own, _)| *own == name) {
            Some((own, value)) if own.ends_with("_s") => seconds(value.as_f64().unwrap_or(f64::NAN)).into(),
            Some((_, value)) => Cell::count(value),
            None => "-".into(),
        };
        let words = match name {
            "time_s" => "time".into(),
            "programs_s" => "recording and compiling".into(),
            "newton_iterations" => "Newton iterations".into(),
            name => name.replace('_', " "),
        };
        table.row([Cell::from(words)].into_iter().chain(columns.iter().map(cell)));
    }
    print(format_args!("{table}\n"));
}
