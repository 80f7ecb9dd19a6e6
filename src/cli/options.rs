use super::CommandLine;
use super::console::print;
use super::failure::Failure;
use clap::Args;
use costate::design::{DesignVariable, check_design, shortest};
use costate::integrators::{
    ConstraintLevel, DEFAULT_TABLE, MOST_STEPS, Method, NewtonTolerance, StepControl, table_named, table_names,
};
use costate::linalg::Backend;
use costate::scenes::{AnyScene, FileScene, Output, Prepared, Scenario, Settings, built_in, check_folders, unknown};
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// Which scene at which design, and where results go.
#[derive(Args, Clone, Debug)]
pub struct DesignOptions {
    /// Name of a scene (see `list`), or path of a scene file (.toml)
    scene: String,
    /// Folder for the results [default: out/SCENE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// One of the scenarios of the scene; without it `run`, `gradient` and `optimize` take all of them
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Change a design variable; may be given once for each
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Print one JSON object with all figures on the last line of stdout
    #[arg(long)]
    pub json: bool,
}

/// What is simulated, and how.
#[derive(Args, Clone, Debug)]
pub struct SceneOptions {
    #[command(flatten)]
    of: DesignOptions,
    /// End of the motion [s] [default: the scene's]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    end: Option<f64>,
    /// Number of steps [default: the scene's]
    #[arg(long, value_name = "N", value_parser = whole_number::<MOST_STEPS>, allow_negative_numbers = true)]
    steps: Option<usize>,
    /// Choose steps by their error: tolerance of coordinates and velocities, relative and absolute (methods with an error
    /// estimate); load steps of --method static by the success of Newton's method, whatever the number
    #[arg(long, value_name = "TOL", value_parser = positive, allow_negative_numbers = true, conflicts_with = "steps")]
    tolerance: Option<f64>,
    /// The same for velocities alone [default: that of --tolerance]
    #[arg(long, value_name = "TOL", value_parser = positive, allow_negative_numbers = true, requires = "tolerance")]
    velocity_tolerance: Option<f64>,
    /// Longest step that --tolerance may choose [s]
    #[arg(long, value_name = "H", value_parser = positive, allow_negative_numbers = true, requires = "tolerance")]
    longest_step: Option<f64>,
    /// Write histories at multiples of this time instead of at the steps [s]
    #[arg(long, value_name = "DT", value_parser = positive, allow_negative_numbers = true)]
    output_step: Option<f64>,
    /// Write meshes for ParaView: fields.pvd, with a .vtu file for each row of the histories, and with `gradient` gradients.vtu, the
    /// derivatives by the thickness of each shell element
    #[arg(long)]
    vtk: bool,
    // it was an option, and its error says what serves instead
    #[arg(long, hide = true)]
    film: bool,
    /// Write no report.html, and differentiate by nothing that only its colours show
    #[arg(long)]
    pub no_report: bool,
    /// Integrator: midpoint, dirk2, dirk3, sdirk2, sdirk3, sdirk4, esdirk3, esdirk4, esdirk5, newmark, generalized-alpha, bdf1,
    /// bdf2, bdf3, variational; generalized-alpha:0.6 has spectral radius 0.6 instead of 0.8, variational:1 its quadrature point at
    /// the end of the step instead of the middle. Equilibria, with time as the load factor: static [default: the scene's, else esdirk4]
    #[arg(long, value_name = "TABLE")]
    method: Option<String>,
    /// Time derivative on which constraints are kept: position, acceleration [default: the scene's, else acceleration]
    #[arg(long, value_name = "LEVEL")]
    constraint_level: Option<String>,
    /// When Newton's method stops: at round-off; by residual (1e-9 of the first, or 1e-12) as in Boopathy & Kennedy; or scaled, at a
    /// hundredth of the estimated error of a step, for motions that nobody differentiates [default: the scene's, else round-off]
    #[arg(long, value_name = "RULE")]
    newton: Option<String>,
    /// Solver of the linear systems: automatic (by the work that its analysis predicts), dense, multifrontal, mumps (with the feature mumps)
    /// [default: the scene's, else automatic]
    #[arg(long, value_name = "NAME")]
    solver: Option<String>,
    /// Project an inconsistent start onto the constraints instead of refusing it
    #[arg(long)]
    project_start: bool,
    /// End with an error where the last equilibrium of --method static, or that at which the motion begins, is unstable, or not known to be stable
    #[arg(long)]
    pub stable: bool,
}

impl Deref for SceneOptions {
    type Target = DesignOptions;
    fn deref(&self) -> &DesignOptions {
        &self.of
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
    number.ok_or_else(|| "it must be a number above 0, as in 1e-6".into())
}

pub(super) fn whole_number<const MOST: usize>(text: &str) -> Result<usize, String> {
    let number = text.parse::<usize>().ok().filter(|number| (1..=MOST).contains(number));
    number.ok_or_else(|| format!("it must be a whole number from 1 to {MOST}"))
}

/// True for the path of a scene file.
pub(super) fn is_path(name: &str) -> bool {
    name.ends_with(".toml") || name.contains(['/', '\\'])
}

/// A scene of the program, or that of a file.
pub(super) enum FoundScene<'p> {
    Own(&'p dyn AnyScene),
    File(Box<FileScene>),
}

impl<'p> Deref for FoundScene<'p> {
    type Target = dyn AnyScene + 'p;
    fn deref(&self) -> &Self::Target {
        match self {
            FoundScene::Own(scene) => *scene,
            FoundScene::File(scene) => &**scene,
        }
    }
}

impl<'p> CommandLine<'p> {
    pub(super) fn names(&self) -> Vec<String> {
        self.scenes.iter().map(|scene| scene.name()).chain(self.built_in.iter().map(|&name| name.into())).collect()
    }

    pub(super) fn all_scenes(&self) -> Result<Vec<&'p dyn AnyScene>, Failure> {
        self.scenes.iter().map(|&scene| Ok(scene)).chain(self.built_in.iter().map(|name| read_built_in(name))).collect()
    }

    /// The scene of this name, unless it is that of a file.
    pub(super) fn own_scene(&self, name: &str) -> Result<Option<&'p dyn AnyScene>, Failure> {
        match self.scenes.iter().copied().find(|scene| scene.name() == name) {
            None if self.built_in.contains(&name) => read_built_in(name).map(Some),
            own => Ok(own),
        }
    }

    /// The scene with a given name, or in a given file.
    pub(super) fn find_scene(&self, name: &str) -> Result<FoundScene<'p>, Failure> {
        let found = self.own_scene(name)?;
        if is_path(name) || found.is_none() && Path::new(name).is_file() {
            return Ok(FoundScene::File(Box::new(
                FileScene::read_with(Path::new(name), &self.parts).map_err(Failure::input)?,
            )));
        }
        let unknown =
            || Failure::input(format!("{}; a scene file is named with .toml", unknown("scene", name, &self.names())));
        let scene = found.ok_or_else(unknown)?;
        check_names(scene)?;
        Ok(FoundScene::Own(scene))
    }
}

fn read_built_in(name: &str) -> Result<&'static dyn AnyScene, Failure> {
    built_in::named(name).map(|scene| scene as &dyn AnyScene).map_err(Failure::input)
}

/// Checks that results of a scene and its scenarios have folders of their own; a file has been checked when it was read.
fn check_names(scene: &dyn AnyScene) -> Result<(), Failure> {
    let scenarios = scene.scenarios();
    let own = scenarios.iter().map(|own| own.name.as_str());
    let alone = scenarios.iter().map(|own| own.scene.name()).chain([scene.name()]).collect::<Vec<_>>();
    let checked = check_folders(own).and_then(|()| check_folders(alone.iter().map(String::as_str)));
    checked.map_err(|(_, why)| Failure::input(format!("scene \"{}\": {why}", scene.name())))
}

pub(super) fn variable_named(variables: &[DesignVariable], name: &str) -> Result<usize, String> {
    let known = || variables.iter().map(|variable| variable.name.clone()).collect::<Vec<_>>();
    let place = variables.iter().position(|variable| variable.name == name);
    place.ok_or_else(|| unknown("design variable", name, &known()))
}

fn example(variables: &[DesignVariable]) -> String {
    variables
        .first()
        .map_or_else(|| "length=2".into(), |variable| format!("{}={}", variable.name, shortest(variable.initial)))
}

/// A failure with the name of the scene before it; messages about a file name it themselves.
pub(super) fn named(scene: &str, failure: Failure) -> Failure {
    if failure.message.starts_with(scene) {
        return failure;
    }
    Failure { message: format!("scene \"{scene}\": {}", failure.message), ..failure }
}

/// The same, with the place of the first part that the message names, where the scene has a text.
pub(super) fn located(scene: &dyn AnyScene, given: &str, failure: Failure) -> Failure {
    let quoted = failure.message.split('"').skip(1).step_by(2);
    // nodes and elements of a member have its name and a number or an end
    let parts = quoted.flat_map(|name| [name, name.split(['.', '[']).next().unwrap_or(name)]);
    let place = parts.into_iter().find_map(|part| scene.place_of(part));
    match place {
        Some(place) if !failure.message.starts_with(given) => {
            Failure { message: format!("{place}: {}", failure.message), ..failure }
        }
        _ => named(given, failure),
    }
}

/// The one of some that an option names, if it is given.
fn chosen<T: Copy, const N: usize>(
    option: &str,
    given: &Option<String>,
    all: [T; N],
    name: fn(T) -> &'static str,
) -> Result<Option<T>, Failure> {
    let Some(given) = given else { return Ok(None) };
    let found = all.into_iter().find(|&one| name(one) == given);
    let known = || all.map(|one| name(one).to_string());
    found.map(Some).ok_or_else(|| Failure::input(unknown(option, given, &known())))
}

impl DesignOptions {
    pub fn scene<'p>(&self, program: &CommandLine<'p>) -> Result<FoundScene<'p>, Failure> {
        program.find_scene(&self.scene)
    }

    /// What of it is run: itself, its scenarios, or the one that is chosen.
    pub fn scenarios<'s>(&self, scene: &'s dyn AnyScene) -> Result<Vec<Scenario<'s>>, Failure> {
        let Some(name) = &self.scenario else { return Ok(Scenario::all_of(scene)) };
        let all = scene.scenarios();
        let known: Vec<String> = all.iter().map(|own| own.name.clone()).collect();
        if known.is_empty() {
            return Err(Failure::input(format!("--scenario {name}: the scene \"{}\" has no scenarios", scene.name())));
        }
        let found = all.into_iter().find(|own| own.name == *name);
        found.map(|own| vec![own]).ok_or_else(|| Failure::input(unknown("--scenario", name, &known)))
    }

    /// The one that is run, for a command that runs no more.
    pub fn only_scenario<'s>(&self, scene: &'s dyn AnyScene) -> Result<&'s dyn AnyScene, Failure> {
        match &self.scenarios(scene)?[..] {
            [only] => Ok(only.scene),
            several => {
                let names: Vec<&str> = several.iter().map(|own| own.name.as_str()).collect();
                Err(Failure::input(format!("the scene has the scenarios {}: choose one with --scenario", names.join(", "))))
            }
        }
    }

    /// The initial design with the changes of `--set`.
    pub fn design(&self, scene: &dyn AnyScene) -> Result<Vec<f64>, Failure> {
        let variables = scene.variables();
        let mut x: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
        let mut seen: Vec<&str> = Vec::new();
        for change in &self.set {
            let Some((name, value)) = change.split_once('=') else {
                return Err(Failure::input(format!(
                    "--set \"{change}\": it must read NAME=VALUE, as in --set {}",
                    example(&variables)
                )));
            };
            let (name, value) = (name.trim(), value.trim());
            let index =
                variable_named(&variables, name).map_err(|message| Failure::input(format!("--set {change}: {message}")))?;
            if seen.contains(&name) {
                return Err(Failure::input(format!("--set {change}: \"{name}\" was already set; give it once")));
            }
            seen.push(name);
            let DesignVariable { lower, upper, unit, .. } = &variables[index];
            let [lower, upper] = [*lower, *upper].map(shortest);
            x[index] = value.parse().map_err(|_| {
                Failure::input(format!(
                    "--set {change}: \"{value}\" is not a number; it must lie between {lower} and {upper} {unit}"
                ))
            })?;
            check_design(&variables[index..=index], &x[index..=index])
                .map_err(|message| Failure::input(format!("--set {change}: {message}")))?;
        }
        Ok(x)
    }

    /// Places of the variables that `--set` names.
    pub fn set_places(&self, variables: &[DesignVariable]) -> Vec<usize> {
        let names = self.set.iter().filter_map(|change| change.split_once('=')).map(|(name, _)| name.trim());
        names.filter_map(|name| variable_named(variables, name).ok()).collect()
    }

    /// A failure, with the scene and the place in its text.
    pub fn located(&self, scene: &dyn AnyScene, failure: impl Into<Failure>) -> Failure {
        located(scene, &self.scene, failure.into())
    }

    pub fn folder(&self, scene: &dyn AnyScene) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name()))
    }
}

impl SceneOptions {
    /// The same options for one of several scenarios: results of each stand in a folder of its own.
    pub fn of_scenario(&self, name: &str, count: usize) -> Self {
        let own_folder = |folder: &PathBuf| if count > 1 { folder.join(name) } else { folder.clone() };
        SceneOptions { of: DesignOptions { out: self.out.as_ref().map(own_folder), ..self.of.clone() }, ..self.clone() }
    }

    /// The scene at the chosen design with the chosen method and steps.
    pub fn prepare<'s>(&self, scene: &'s dyn AnyScene) -> Result<Prepared<'s>, Failure> {
        let (method, settings) = self.simulation(scene)?;
        let x = self.design(scene)?;
        let prepared = Prepared::with(scene, &x, method, settings);
        prepared.map_err(|error| self.located(scene, error))
    }

    pub fn simulation(&self, scene: &dyn AnyScene) -> Result<(Method, Settings), Failure> {
        if self.film {
            return Err(Failure::input("--film: the report plays the motion, report.html among the results"));
        }
        let mut settings = scene.settings();
        let own = settings.method.take();
        let name = self.method.as_deref().or(own.as_deref()).unwrap_or(DEFAULT_TABLE);
        let table = table_named(name).map_err(|message| Failure::input(format!("--method: {message}")))?;
        let table = table.ok_or_else(|| Failure::input(unknown("--method", name, &table_names())))?;
        let level = chosen("--constraint-level", &self.constraint_level, ConstraintLevel::ALL, ConstraintLevel::name)?;
        let mut method = Method::new(table, level.unwrap_or(settings.level));
        let newton = chosen("--newton", &self.newton, NewtonTolerance::ALL, NewtonTolerance::name)?;
        let solver = chosen("--solver", &self.solver, Backend::ALL, Backend::name)?;
        method.tolerance = newton.unwrap_or(settings.newton);
        method.backend = solver.unwrap_or(settings.solver);
        method.locates = settings.locate;
        settings.end = self.end.unwrap_or(settings.end);
        settings.steps = self.steps.unwrap_or(settings.steps);
        settings.policy.project_start |= self.project_start;
        if let Some(tolerance) = self.tolerance {
            let mut control = StepControl::new(tolerance);
            control.velocities = StepControl::new(self.velocity_tolerance.unwrap_or(tolerance)).velocities;
            control.longest = self.longest_step.unwrap_or(f64::INFINITY);
            settings.control = Some(control);
        } else if self.steps.is_some() {
            settings.control = None;
        }
        if let Some(dt) = self.output(scene).step.filter(|dt| settings.end / dt > MOST_STEPS as f64) {
            return Err(Failure::input(format!(
                "--output-step {dt}: at most {MOST_STEPS} times fit into {} s",
                settings.end
            )));
        }
        Ok((method, settings))
    }

    /// The method for gradients: Newton's method to round-off where the scene leaves it more.
    pub fn differentiable(&self, mut method: Method) -> Result<Method, Failure> {
        if method.tolerance == NewtonTolerance::Scaled {
            let why = "what Newton's method leaves of a system by the error of its step has no exact derivative";
            if self.newton.is_some() {
                return Err(Failure::input(format!("--newton {}: {why}; leave it out here", method.tolerance.name())));
            }
            method.tolerance = NewtonTolerance::RoundOff;
            print(format_args!(
                "Newton's method goes to round-off instead of \"{}\": {why}",
                NewtonTolerance::Scaled.name()
            ));
        }
        Ok(method)
    }

    /// What is written: by the options, else by the scene.
    pub fn output(&self, scene: &dyn AnyScene) -> Output {
        let own = scene.output();
        Output { step: self.output_step.or(own.step), meshes: self.vtk || own.meshes, ..own }
    }

    /// Refuses what is written for one motion alone.
    pub fn without_histories(&self, what: &str) -> Result<(), Failure> {
        let given = [("--output-step", self.output_step.is_some()), ("--vtk", self.vtk)];
        given.iter().find(|option| option.1).map_or(Ok(()), |(option, _)| {
            Err(Failure::input(format!("{option}: {what} writes no histories of motions; leave it out")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_help_names_every_integrator_and_level() {
        let mut command = super::super::Arguments::command();
        let run = command.find_subcommand_mut("run").unwrap();
        let help = run.render_long_help().to_string();
        let levels = ConstraintLevel::ALL.map(|level| level.name()).join(", ");
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(table_names().iter().all(|name| help.contains(name)), "{help}");
        assert!(help.contains(&format!("else {DEFAULT_TABLE}")) && help.contains(&levels), "{help}");
        assert!(Backend::ALL.iter().all(|backend| help.contains(backend.name())), "{help}");
    }
}
