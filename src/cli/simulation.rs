use super::console::{count, json_number, long_number, print, print_files, seconds, warn};
use super::energy_balance::{Course, EnergyBalance, Ledger};
use super::failure::Failure;
use super::interrupt::Guard;
use super::measured_modes::MeasuredModes;
use super::measured_moments::EnergyCourse;
use super::options::SceneOptions;
use super::projected_start::ProjectedStart;
use super::report::{Page, Shown};
use super::results::{Finished, Results, check_folder};
use super::snapshot::Snapshot;
use super::stability::{self, Statement};
use crate::io::{Cell, Chart, Progress, Table, write_file};
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
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Names and numbers of what something cost; the names are those of the JSON object.
pub type Work = Vec<(&'static str, Value)>;

/// A simulated scene with its files written.
pub struct Simulation {
    /// States and functionals, of the finished steps only if the run stopped early.
    pub forward: Forward,
    /// Steps were chosen by their error.
    pub chosen_steps: bool,
    /// Wall time of the simulation with its functionals [s].
    pub seconds: f64,
    /// For recording formulas and compiling their programs [s]; those that were first needed during the simulation are part of its time.
    pub program_seconds: f64,
    /// How the energy changed, where it should be constant.
    pub energy: Option<EnergyCourse>,
    /// Its balance, where it should not.
    pub balance: Option<EnergyBalance>,
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Why other files could not be written.
    pub unwritten: Option<Failure>,
    /// Why the run stopped before its end.
    pub stopped: Option<Failure>,
    /// Where its files are.
    pub folder: PathBuf,
    /// Histories as charts.
    pub charts: Vec<Chart>,
    /// The moments that a page shows.
    pub moments: Vec<Snapshot>,
    /// What is measured of modes.
    pub modes: MeasuredModes,
    /// What a projection of the start changed.
    pub start: Option<ProjectedStart>,
    /// Warnings where tables were read beyond their points.
    left_tables: Vec<String>,
}

/// Writes results, moves the progress bar, and stops at Ctrl-C.
struct Watched<'p, 'g> {
    prepared: &'p Prepared<'p>,
    results: Results<'p>,
    start: Option<ProjectedStart>,
    balance: Option<Course<'g>>,
    progress: Progress,
    /// Marks of the progress bar per second.
    pace: f64,
    guard: &'g Guard,
}

/// Marks of the progress bar: steps that choose their size do not tell how many there will be.
const MARKS: f64 = 1000.0;

impl Observer for Watched<'_, '_> {
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
///
/// # Errors
/// A folder or file that cannot be written. A run that stops early is no error here: its finished steps are written first.
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
    let ledger = Ledger::new(prepared);
    let balance = ledger.as_ref().map(|ledger| ledger.begin(prepared));
    let mut watched = Watched { prepared, results, start: None, balance, progress, pace, guard: &guard };
    let begun = Instant::now();
    let (forward, mut stopped) = prepared.analysis().observed(&prepared.x, &mut watched)?;
    let elapsed = begun.elapsed().as_secs_f64();
    let program_seconds = making_time();
    if refuses_machine_code() {
        print("the system refuses memory for machine code: programs are executed by a loop, which takes longer");
    }
    let Watched { results, start, balance, progress, .. } = watched;
    progress.finish();
    start.iter().for_each(|start| print(format_args!("{}\n", start.in_words())));
    if stopped.is_none() {
        stopped = prepared.analysis().check_values(&forward).err();
    }
    let left_tables = results.left_tables();
    let (energy, balance) = (results.energy_course(), balance.and_then(Course::finish));
    let Finished { files, unwritten, charts, moments } = results.finish();
    if guard.requested() && stopped.is_none() {
        stopped = Some(RunError::Interrupted { steps: forward.history.steps() });
    }
    let chosen_steps = prepared.control.is_some();
    let stands = || match stability::statement(prepared, &forward) {
        Some(Statement::Warning(message)) if options.requires_stability() => Some(Failure::run(message)),
        _ => None,
    };
    let stopped = stopped.map(|error| with_hint(error, prepared)).or_else(stands);
    Ok(Simulation {
        forward,
        chosen_steps,
        seconds: elapsed,
        program_seconds,
        energy,
        balance,
        files,
        unwritten,
        stopped,
        folder,
        charts,
        moments,
        modes,
        start,
        left_tables,
    })
}

/// Says what will be simulated.
fn announce(prepared: &Prepared) -> Result<(), RunError> {
    let Prepared { scene, method, grid, plan, .. } = prepared;
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
    if !plan.dropped.is_empty() {
        let names: Vec<_> = plan.dropped.iter().map(|&row| prepared.model().equation_name(row)).collect();
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

/// A value with its time and place.
pub fn json_extreme(Extreme { value, t, element }: &Extreme) -> Value {
    json!({"value": json_number(*value), "t": json_number(*t), "element": element})
}

impl Simulation {
    /// Prints the values of the functionals.
    pub fn print_functionals(&self, prepared: &Prepared) {
        if prepared.functionals().is_empty() {
            return print("the scene has no functional\n");
        }
        let has_aggregates = self.forward.extremes.iter().any(Option::is_some);
        let names = ["functional", "value", "unit", "true largest", "at [s]", "in", "true smallest", "at [s]", "in", "unit"];
        let mut table = Table::new(if has_aggregates { &names } else { &names[..3] });
        let functionals = prepared.functionals().iter().zip(&self.forward.values);
        for ((functional, &value), extremes) in functionals.zip(&self.forward.extremes) {
            let mut row: Vec<Cell> =
                vec![functional.name.as_str().into(), long_number(value).into(), functional.value_unit().into()];
            if let Some(Extremes { smallest, largest }) = extremes {
                for Extreme { value, t, element } in [largest, smallest] {
                    let element = element.as_deref().map_or(Cell::Empty, Into::into);
                    row.extend([(*value).into(), (*t).into(), element]);
                }
                row.push(functional.unit.into());
            }
            table.row(row);
        }
        print(format_args!("{table}\n"));
    }

    /// What the simulation cost.
    pub fn work(&self) -> Work {
        let Counters { systems, iterations, residuals, factorizations, solves, choices, .. } = self.forward.counters;
        let mut work = vec![("steps", json!(self.forward.history.steps()))];
        // a run that stopped early does not tell
        if systems > 0 {
            if self.chosen_steps || self.forward.rejected > 0 {
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
        work.push(("time_s", json_number(self.seconds)));
        work.push(("programs_s", json_number(self.program_seconds)));
        work
    }

    /// Says how well equal steps resolve the motion, or whether an equilibrium stands, and warns where they hardly do.
    pub fn print_resolution(&self, prepared: &Prepared) {
        if let Some((error, _)) = error_in_words(prepared, &self.forward) {
            print(format_args!("largest estimated error of a step: {error}\n"));
        }
        if let Some(balance) = &self.balance {
            print(format_args!("{}\n", balance.in_words()));
        }
        if let Some(Statement::Stable(words)) = stability::statement(prepared, &self.forward) {
            print(format_args!("{words}\n"));
        }
        self.resolution(prepared).iter().for_each(|warning| warn(warning));
    }

    /// What a page shows of it.
    pub fn shown(&self, prepared: &Prepared) -> Shown<'_> {
        Shown {
            forward: &self.forward,
            start: self.start.as_ref(),
            energy: self.energy,
            balance: self.balance,
            moments: &self.moments,
            charts: &self.charts,
            warnings: self.resolution(prepared),
            stopped: self.stopped.as_ref().map(|failure| failure.message.as_str()),
        }
    }

    /// Warnings where the steps hardly resolve the motion, the model does not determine what is asked for, or an equilibrium does not stand.
    pub fn resolution(&self, prepared: &Prepared) -> Vec<String> {
        let mut warnings = warnings(prepared, &self.forward);
        warnings.extend(energy_in_words(self.energy));
        warnings.extend_from_slice(&self.left_tables);
        if let Some(balance) = self.balance.filter(|own| own.share().is_some_and(|share| share > StepError::COARSE)) {
            warnings.push(format!("{}: take smaller steps, or a smaller tolerance", balance.in_words()));
        }
        warnings.extend(self.forward.crossings.iter().map(ToString::to_string));
        warnings
    }

    /// Writes the report, if there is one, and the summary, the last files of a run.
    pub fn conclude(&mut self, page: Option<Page>, mut summary: Value) {
        let [summary_file, report] = ["summary.json", "report.html"].map(|name| self.folder.join(name));
        if self.files.is_empty() {
            return;
        }
        let beside = [&self.files[..], std::slice::from_ref(&summary_file)].concat();
        let reported = page.map_or(Ok(()), |page| page.write(&report, &beside).map(|()| self.files.push(report)));
        self.files.push(summary_file.clone());
        summary["files"] = names(&self.files);
        let text = format!("{summary:#}\n");
        let summarized = write_file(&summary_file, text.as_bytes()).map_err(|error| {
            self.files.pop();
            Failure::from(error)
        });
        let failed = reported.err().or(summarized.err());
        self.unwritten = self.unwritten.take().or(failed);
    }

    /// Writes the summary of what is there already, before work that may be stopped; [`Simulation::conclude`] replaces it, and says what
    /// could not be written.
    pub fn summarize(&self, summary: &Map<String, Value>) {
        if !self.files.is_empty() {
            let text = format!("{:#}\n", Value::from(summary.clone()));
            let _ = write_file(&self.folder.join("summary.json"), text.as_bytes());
        }
    }

    /// Prints the files.
    pub fn print_files(&self) {
        print_files(&self.files);
    }

    /// The parts of the JSON object that every simulation has.
    pub fn json(&self, prepared: &Prepared) -> Map<String, Value> {
        let design = prepared.variables.iter().zip(&prepared.x).map(|(v, &x)| (v.name.clone(), json_number(x)));
        let functionals = prepared.functionals().iter().zip(&self.forward.values).zip(&self.forward.extremes);
        let functionals: Vec<Value> = functionals
            .map(|((f, &value), extremes)| {
                let mut own = json!({"name": f.name, "value": json_number(value), "unit": f.value_unit()});
                if let Some(Extremes { smallest, largest }) = extremes {
                    (own["largest"], own["smallest"]) = (json_extreme(largest), json_extreme(smallest));
                }
                own
            })
            .collect();
        let mut object = Map::new();
        object.insert("scene".into(), json!(prepared.scene.name()));
        object.insert("method".into(), json!(prepared.method.table.name));
        object.insert("newton".into(), json!(prepared.method.tolerance.name()));
        object.insert("constraint_level".into(), json!(prepared.method.constraint_level().name()));
        match prepared.control {
            Some(control) => {
                let (q, v) = (control.coordinates.relative, control.velocities.relative);
                object.insert("tolerance".into(), json!({"coordinates": json_number(q), "velocities": json_number(v)}));
            }
            None => drop(object.insert("planned_steps".into(), json!(prepared.grid.steps()))),
        }
        object.insert("end_s".into(), json_number(prepared.grid.times[prepared.grid.steps()]));
        object.insert("design".into(), design.collect::<Map<_, _>>().into());
        object.insert("functionals".into(), functionals.into());
        object.extend(self.modes.json(prepared).map(|modes| ("modes".into(), modes)));
        let [joints, of_functionals] = prepared.undetermined();
        if !joints.is_empty() {
            object.insert("not_determined".into(), json!({"joints": joints, "functionals": of_functionals}));
        }
        for (name, value) in self.work() {
            object.insert(if name == "time_s" { "forward_s".into() } else { name.into() }, value);
        }
        object.extend(self.start.as_ref().map(|start| ("projected_start".into(), start.json())));
        if let Some(StepError { share, step, t, dof, in_velocity }) = self.forward.error {
            let coordinate = prepared.model().dof_name(dof);
            let error = json!({"share": json_number(share), "step": step, "t": json_number(t), "coordinate": coordinate, "velocity": in_velocity});
            object.insert("largest_step_error".into(), error);
        }
        if let Some((t, step)) = self.forward.leap {
            object.insert("leap_over_dead_point".into(), json!({"step": step, "t": json_number(t)}));
        }
        if let Some(course) = &self.forward.stability {
            object.insert("stability".into(), stability::json(course));
        }
        if !self.forward.crossings.is_empty() {
            object.insert("crossings".into(), crossings_json(&self.forward.crossings));
        }
        let changes =
            ["energy_growth", "energy_loss"].into_iter().zip(self.energy.iter().flat_map(|energy| energy.shares()));
        for (name, (share, t)) in changes {
            object.insert(name.into(), json!({"share_of_kinetic": json_number(share), "t": json_number(t)}));
        }
        self.balance.iter().for_each(|balance| drop(object.insert("energy_balance_J".into(), balance.json())));
        object.insert("files".into(), names(&self.files));
        if let Some(failure) = &self.stopped {
            object.insert("error".into(), json!(failure.message));
        }
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
    warnings.extend(undamped_reactions(prepared));
    warnings.extend(beside_ends(prepared, forward));
    warnings
}

/// The warning of a method that does not damp the reactions of constraints at position level (Cardona & Geradin, Computers & Structures 33 (1989)).
fn undamped_reactions(prepared: &Prepared) -> Option<String> {
    let (table, level) = (&prepared.method.table, prepared.method.constraint_level());
    if level != ConstraintLevel::Position || table.radius_at_infinity < 1.0 {
        return None;
    }
    let reads =
        |own: &&Functional| own.over != Over::Integral && own.over.times() != Times::Start && own.reads_multipliers();
    let names: Vec<&str> = prepared.functionals().iter().filter(reads).map(|own| own.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: with \"{}\" and constraints at position level reactions swing from each step to the next, undamped, and their derivatives need not \
             converge; take constraints at acceleration level, or a method that damps them, as {DEFAULT_TABLE}",
            quoted(&names),
            table.name
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
fn error_in_words(prepared: &Prepared, forward: &Forward) -> Option<(String, Option<String>)> {
    let StepError { share, step, t, dof, in_velocity } = forward.error?;
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

/// Names in words.
fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Crossings of switches for JSON.
pub fn crossings_json(crossings: &[Crossing]) -> Value {
    let object = |crossing: &Crossing| {
        let Crossing { part, is_functional, kind, step, t, count, last, passed_over } = crossing;
        let kind = if *kind == SwitchKind::Jump { "jump" } else { "kink" };
        let passed = passed_over.map(json_number);
        json!({"part": part, "functional": is_functional, "kind": kind, "step": step, "t": json_number(*t), "steps": count, "last_step": last,
               "passed_over_s": passed})
    };
    crossings.iter().map(object).collect()
}

/// Names of files.
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
        let cell = |work: &Work| match work.iter().find(|(own, _)| *own == name) {
            Some((own, value)) if own.ends_with("_s") => seconds(value.as_f64().unwrap_or(f64::NAN)),
            Some((_, value)) => value.to_string(),
            None => "-".into(),
        };
        let cells: Vec<String> = columns.iter().map(|(_, work)| cell(work)).collect();
        let words = match name {
            "time_s" => "time".into(),
            "programs_s" => "recording and compiling".into(),
            "newton_iterations" => "Newton iterations".into(),
            name => name.replace('_', " "),
        };
        table.row([Cell::from(words)].into_iter().chain(cells.into_iter().map(|cell| Cell::Text(format!("{cell:>12}")))));
    }
    print(format_args!("{table}\n"));
}
