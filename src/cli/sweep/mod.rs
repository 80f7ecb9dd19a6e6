//! `costate sweep`: a parameter study, each design an ordinary run, several at once.

mod findings;
mod pictures;
mod rows;
mod summary;
mod variation;

use super::CommandLine;
use super::console::{count, print, print_files, print_json};
use super::failure::{Failure, INTERRUPTED};
use super::interrupt::Guard;
use super::measured_modes::MeasuredModes;
use super::options::{SceneOptions, whole_number};
use super::results::check_folder;
use super::simulation::{steps_in_words, warnings, with_hint};
use super::stability::{Statement, statement};
use crate::io::{Progress, write_json};
use clap::Args;
use costate::exchange::{is_first, of_first_at_work, see_work, world};
use costate::history::{Keep, Watch};
use costate::integrators::{Method, StepRecord};
use costate::optimize::runs_at_once::run_at_once;
use costate::scenes::{AnyScene, Prepared, Settings, check_modes, fingerprint};
use rows::{Outcome, Outcomes, Rows, row};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use variation::{MOST_DESIGNS, Sampling, Variation};

/// Options of `costate sweep`.
#[derive(Args)]
pub struct SweepOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Vary a design variable: NAME=FROM:TO:COUNT in equal steps, NAME=FROM:TO:COUNT:log in equal steps of the logarithm, or
    /// NAME=VALUE,VALUE; given for several variables, a grid. With --samples a range: NAME=FROM:TO or NAME=FROM:TO:log
    #[arg(long, value_name = "NAME=VALUES")]
    vary: Vec<String>,
    /// Draw N designs in the ranges of --vary, or without it within the bounds of all variables but those of --set
    #[arg(long, value_name = "N", value_parser = whole_number::<MOST_DESIGNS>, allow_negative_numbers = true)]
    samples: Option<usize>,
    /// How designs are drawn: a Latin hypercube, or Sobol's sequence in up to 21 variables
    #[arg(long, value_enum, value_name = "WAY", default_value_t = Sampling::LatinHypercube, requires = "samples")]
    sampling: Sampling,
    /// Other designs of the same kind: a whole number; without it Sobol's sequence begins at the lower ends
    #[arg(long, value_name = "SEED", requires = "samples")]
    seed: Option<u64>,
    /// Threads: as many designs are run at once [default: all]
    #[arg(long, value_name = "N", value_parser = whole_number::<MOST_THREADS>, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Each design also gets the derivatives of all functionals by the variables that vary, by the adjoint: a column for each,
    /// d FUNCTIONAL / d VARIABLE
    #[arg(long)]
    gradient: bool,
    /// Go on with the sweep whose sweep.csv lies in the folder of results: its rows are kept, where they follow from what is
    /// simulated here; one design is run again to see that they are of this machine
    #[arg(long)]
    resume: bool,
}

const MOST_THREADS: usize = 4096;

struct Sweep<'s> {
    options: &'s SweepOptions,
    scene: &'s dyn AnyScene,
    /// At the design of `--set`.
    base: Prepared<'s>,
    method: Method,
    settings: Settings,
    variation: Variation,
    /// Names and units of the functionals, then of modes.
    functionals: Vec<(String, String)>,
    threads: usize,
}

/// `costate sweep`: runs the designs, writes their rows, draws and prints what they show.
pub fn run(options: &SweepOptions, program: &CommandLine) -> Result<(), Failure> {
    let found = options.scene.scene(program)?;
    let scene = options.scene.only_scenario(&*found)?;
    options.scene.without_histories("a sweep")?;
    let sweep = Sweep::new(options, scene)?;
    let folder = options.scene.folder(scene);
    let (path, names) = (folder.join("sweep.csv"), sweep.column_names());
    let (mut rows, mut outcomes) = sweep.begin(&folder, &path, &names)?;
    let kept = outcomes.iter().flatten().count();
    let guard = Guard::new();
    sweep.announce(kept);
    sweep.check_kept(&outcomes, &path, &guard)?;
    if let Some(rows) = &mut rows {
        remove_outdated(&folder)?;
        rows.cut()?;
    }
    let begun = Instant::now();
    sweep.run_all(rows, &mut outcomes, &guard)?;
    let summary = summary::Summary::new(&sweep, &outcomes, kept, begun.elapsed().as_secs_f64());
    let mut files = vec![path];
    #[cfg(feature = "arrow")]
    {
        files.push(folder.join("sweep.arrow"));
        rows::write_columns(&files[1], &names, &outcomes, &sweep.variation)?;
    }
    files.extend(summary.draw(&folder)?);
    files.push(folder.join("sweep.json"));
    let json = summary.json(&files);
    write_json(&files[files.len() - 1], &json)?;
    summary.print();
    print_files(&files);
    print_json(options.scene.json, &json);
    summary.verdict()
}

/// Removes what an earlier sweep has made of its table: one that is killed leaves nothing beside its rows that is not of them.
fn remove_outdated(folder: &Path) -> Result<(), Failure> {
    let whole = ["sweep.arrow", "sweep.json", "sensitivity.svg"].map(|name| folder.join(name)).into_iter();
    let by_variable = (1..).map(|axis: usize| folder.join(format!("scatter-{axis}.svg"))).take_while(|path| path.is_file());
    for path in whole.chain(by_variable).filter(|path| path.is_file()) {
        let cannot = |cause| Failure::run(format!("cannot remove {} of an earlier sweep: {cause}", path.display()));
        std::fs::remove_file(&path).map_err(cannot)?;
    }
    Ok(())
}

impl<'s> Sweep<'s> {
    fn new(options: &'s SweepOptions, scene: &'s dyn AnyScene) -> Result<Self, Failure> {
        let variables = scene.variables();
        let (mut method, settings) = options.scene.simulation(scene)?;
        if options.gradient {
            method = options.scene.differentiable(method)?;
        }
        options.scene.design(scene)?;
        let variation = Variation::of(options, &variables, &options.scene.set_places(&variables))?;
        let base = options.scene.prepare(scene)?;
        let own = base.functionals().iter().map(|own| (own.name.clone(), own.value_unit().to_string()));
        let modes = scene.modes();
        check_modes(&modes, base.functionals())?;
        let functionals = own.chain(modes.iter().map(|mode| (mode.name.clone(), mode.unit().into()))).collect();
        let threads = options.threads.unwrap_or_else(rayon::current_num_threads);
        Ok(Sweep { options, scene, base, method, settings, variation, functionals, threads })
    }

    /// The file of the first rank, and what is finished.
    fn begin(&self, folder: &Path, path: &Path, names: &[String]) -> Result<(Option<Rows>, Outcomes), Failure> {
        let open = || match self.options.resume {
            true => Rows::resume(path, names, &self.variation),
            false => {
                check_folder(folder)?;
                Ok((Rows::begin(path, names)?, vec![None; self.variation.points.len()]))
            }
        };
        let (rows, opened) = match is_first().then(open) {
            Some(Ok((rows, outcomes))) => (Some(rows), Some(Ok(outcomes))),
            Some(Err(failure)) => (None, Some(Err(failure))),
            None => (None, None),
        };
        Ok((rows, of_first_at_work(world(), opened)?))
    }

    fn name(&self) -> String {
        self.scene.name()
    }

    /// Name of a variable that varies.
    fn axis_name(&self, axis: usize) -> &str {
        &self.base.variables[self.variation.axes[axis].place].name
    }

    /// The same with its unit.
    fn axis_label(&self, axis: usize) -> String {
        format!("{} [{}]", self.axis_name(axis), self.base.variables[self.variation.axes[axis].place].unit)
    }

    /// Names of the numbers of a row: variables, functionals, and the derivatives of each functional if these are asked for.
    fn column_names(&self) -> Vec<String> {
        let axes = 0..self.variation.axes.len();
        let functional = |(name, unit): &(String, String)| format!("functional {name} [{unit}]");
        let mut names: Vec<String> = axes.clone().map(|axis| format!("design {}", self.axis_label(axis))).collect();
        names.extend(self.functionals.iter().map(functional));
        if self.options.gradient {
            names.extend(self.functionals.iter().flat_map(|(name, unit)| {
                axes.clone().map(move |axis| {
                    let by = self.base.variables[self.variation.axes[axis].place].unit;
                    format!("d {name} / d {} [{}]", self.axis_name(axis), ratio_of_units(unit, by))
                })
            }));
        }
        names
    }

    fn announce(&self, kept: usize) {
        let Sweep { scene, variation: Variation { axes, points, words }, settings, .. } = self;
        print(format_args!("{}: {}", scene.name(), scene.summary()));
        let kept = if kept > 0 { format!(", of which {kept} are finished") } else { String::new() };
        let [designs, variables, threads] =
            [(points.len(), "design"), (axes.len(), "variable"), (self.threads, "thread")].map(|(n, word)| count(n, word));
        let ranks = match world().ranks() {
            1 => String::new(),
            ranks => format!(" of each of {ranks} ranks"),
        };
        print(format_args!("{designs} {words} in {variables}, on {threads}{ranks}{kept}"));
        print(format_args!("each design: {}\n", steps_in_words(&self.method, settings)));
    }

    /// Runs a design as `costate run` does, but keeps no step beyond its gradient; `None` if it was stopped.
    fn outcome(&self, place: usize, guard: &Guard) -> Option<Outcome> {
        let run = || -> Result<(Vec<f64>, Vec<String>), Failure> {
            let x = self.variation.design(&self.base.x, place);
            let mut prepared = Prepared::with(self.scene, &x, self.method.clone(), self.settings.clone())
                .map_err(|error| self.options.scene.located(self.scene, error))?;
            prepared.keep_steps_of(&self.base.grid);
            // there are as many runs at once as threads
            prepared.keep = if self.options.gradient { Keep::shared_by(self.threads) } else { Keep::Nothing };
            let names = prepared.functionals().iter().map(|own| &own.name);
            let count = names.len();
            if self.functionals.len() < count || !names.eq(self.functionals[..count].iter().map(|own| &own.0)) {
                return Err(Failure::input("the scene has other functionals at this design"));
            }
            let mut watch = Watch(|_: &StepRecord<f64>| !guard.requested());
            let (forward, stopped) = prepared.analysis().observed(&prepared.x, &mut watch)?;
            let checked = stopped.map_or_else(|| prepared.analysis().check_values(&forward), Err);
            checked.map_err(|error| with_hint(error, &prepared))?;
            let mut modes = MeasuredModes::of(&prepared)?;
            let values: Vec<f64> = forward.values.iter().chain(&modes.values).copied().collect();
            match statement(&prepared, &forward) {
                Some(Statement::Warning(message)) if self.options.scene.stable => Err(Failure::run(message)),
                _ if self.options.gradient => {
                    modes.differentiate(&prepared)?;
                    let of_modes = modes.rows.iter().flatten().cloned();
                    let rows = prepared.analysis().adjoint(&prepared.x, &forward)?.rows.into_iter().chain(of_modes);
                    let own = |row: Vec<f64>| self.variation.axes.iter().map(move |axis| row[axis.place]);
                    let told = [warnings(&prepared, &forward), forward.crossings.iter().map(ToString::to_string).collect()]
                        .concat();
                    Ok((values.into_iter().chain(rows.flat_map(own)).collect(), told))
                }
                _ => Ok((values, warnings(&prepared, &forward))),
            }
        };
        let run = run();
        if guard.requested() {
            return None;
        }
        let fingerprint = self.fingerprint(place);
        Some(match run {
            Ok((values, warnings)) => Outcome { values, fingerprint, failed: false, message: warnings.join("; ") },
            Err(Failure { message, .. }) => {
                let numbers = self.column_names().len() - self.variation.axes.len();
                Outcome { values: vec![f64::NAN; numbers], fingerprint, failed: true, message }
            }
        })
    }

    /// What the row of a design follows from.
    fn fingerprint(&self, place: usize) -> f64 {
        let x = self.variation.design(&self.base.x, place);
        fingerprint(self.scene, &x, (&self.method, &self.settings), |_| true, self.options.gradient)
    }

    /// Whether the rows of the file follow from what this sweep simulates; runs the first of these designs again: the same
    /// laws and numbers on the same machine give the same bits.
    fn check_kept(&self, outcomes: &[Option<Outcome>], path: &Path, guard: &Guard) -> Result<(), Failure> {
        let refused = |what: String| {
            let anew = "without --resume it is kept under another name";
            Failure::input(format!("--resume {}: {what}; {anew}", path.display()))
        };
        let kept: Vec<(usize, &Outcome)> =
            outcomes.iter().enumerate().filter_map(|(place, own)| Some((place, own.as_ref()?))).collect();
        let Some(&(place, there)) = kept.first() else { return Ok(()) };
        let other = Mutex::new(None);
        run_at_once(kept.len(), self.threads, |number| {
            let (place, there) = kept[number];
            let here = self.fingerprint(place);
            if here != there.fingerprint && !(here.is_nan() && there.fingerprint.is_nan()) {
                let mut other = other.lock().unwrap_or_else(PoisonError::into_inner);
                *other = Some(other.map_or(place, |known: usize| known.min(place)));
            }
        });
        if let Some(place) = other.into_inner().unwrap_or_else(PoisonError::into_inner) {
            let what = "follows from other formulas, numbers, methods or settings than it would here: the file is of another scene, \
                        method or version";
            return Err(refused(format!("design {} {what}", place + 1)));
        }
        let Some(here) = self.outcome(place, guard) else {
            return Err(Failure { code: INTERRUPTED, message: "interrupted".into() });
        };
        let [there, here] = [there, &here].map(|own| row(place + 1, &self.variation.points[place], own));
        if there == here {
            return Ok(());
        }
        Err(refused(format!(
            "design {} gave {}, but here it gives {}: the file is of another machine",
            place + 1,
            there.trim_end(),
            here.trim_end()
        )))
    }

    /// Runs the designs that are not finished, dealt over the ranks; the first one writes each row when it is there, and sorts all at the end.
    fn run_all(&self, rows: Option<Rows>, outcomes: &mut Outcomes, guard: &Guard) -> Result<(), Failure> {
        let places: Vec<usize> = (0..outcomes.len()).filter(|&place| outcomes[place].is_none()).collect();
        let progress = Progress::new("designs", outcomes.len() as u64);
        let mut finished = outcomes.len() - places.len();
        progress.set(finished as u64);
        let shared = Mutex::new((rows, None));
        let lock = || shared.lock().unwrap_or_else(PoisonError::into_inner);
        let see = |place: usize, outcome: Outcome| {
            let (rows, unwritten) = &mut *lock();
            let row = row(place + 1, &self.variation.points[place], &outcome);
            *unwritten = rows.as_mut().and_then(|rows| rows.add(&row).err());
            if unwritten.is_none() {
                outcomes[place] = Some(outcome);
                finished += 1;
                progress.set(finished as u64);
            }
            unwritten.is_none()
        };
        let own: Vec<usize> = places.iter().copied().skip(world().rank()).step_by(world().ranks()).collect();
        let wanted = || !guard.requested() && lock().1.is_none();
        let run_own = |found: &(dyn Fn(usize, Outcome) + Sync)| {
            run_at_once(own.len(), self.threads, |number| {
                if wanted()
                    && let Some(outcome) = self.outcome(own[number], guard)
                {
                    found(own[number], outcome);
                }
            });
        };
        see_work(world(), run_own, see);
        let (rows, unwritten) = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
        unwritten.map_or(Ok(()), Err)?;
        *outcomes = of_first_at_work(world(), is_first().then(|| outcomes.clone()));
        rows.map_or(Ok(()), |rows| rows.sort(outcomes, &self.variation))?;
        Ok(())
    }
}

/// The unit of a derivative: `m / (N/m)`.
fn ratio_of_units(of: &str, by: &str) -> String {
    match by {
        "-" => of.into(),
        by if by.chars().all(char::is_alphanumeric) => format!("{of} / {by}"),
        by => format!("{of} / ({by})"),
    }
}
