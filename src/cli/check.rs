use super::CommandLine;
use super::console::{count, print, print_json};
use super::failure::Failure;
use super::options::{located, named};
use clap::Args;
use costate::integrators::RunError;
use costate::optimize::{Fit, Optimization};
use costate::scenes::file::OwnParts;
use costate::scenes::{AnyScene, Prepared, Scenario, check_modes};
use serde_json::json;

/// Options of `costate check`.
#[derive(Args)]
pub struct CheckOptions {
    /// Path of a scene file (.toml), or name of a scene
    pub scene: String,
    /// Print one JSON object on the last line of stdout
    #[arg(long)]
    pub json: bool,
}

/// `costate check`: reads and builds a scene and checks its start, without running it.
pub fn run(options: &CheckOptions, program: &CommandLine) -> Result<(), Failure> {
    let scene = program.find_scene(&options.scene)?;
    check_problem(&*scene, options)?;
    Scenario::all_of(&*scene).into_iter().try_for_each(|own| check(options, &own.name, own.scene))
}

/// Checks the optimization problem of a scene, its measurements, and the names in them.
fn check_problem(scene: &dyn AnyScene, options: &CheckOptions) -> Result<(), Failure> {
    if scene.optimization_problem().is_some() {
        Optimization::of(scene).map_err(|why| named(&options.scene, Failure::from(why)))?;
    }
    if scene.fit_problem().is_some() {
        Fit::of(scene).map_err(|why| Failure::input(located(scene, &options.scene, why.into()).message))?;
    }
    Ok(())
}

/// Builds a scene or a scenario and checks its start.
fn check(options: &CheckOptions, name: &str, scene: &dyn AnyScene) -> Result<(), Failure> {
    // whatever keeps it from starting is a mistake of the scene
    let told = |error: RunError| Failure::input(located(scene, &options.scene, error.into()).message);
    let prepared = Prepared::new(scene).map_err(told)?;
    check_modes(&scene.modes(), prepared.functionals()).map_err(told)?;
    let model = prepared.model();
    let parts = [
        (prepared.variables.len(), "design variable"),
        (model.nodes.len(), "node"),
        (model.elements.len(), "element"),
        (model.constraints.len(), "joint"),
        (prepared.functionals().len(), "functional"),
    ];
    let words = parts.map(|(number, word)| count(number, word)).join(", ");
    let scenario = if name.is_empty() { String::new() } else { format!(", scenario \"{name}\"") };
    print(format_args!("{}{scenario}: in order; {words}", options.scene));
    let dropped = prepared.redundant().len();
    if dropped > 0 {
        print(format_args!("{} left out", count(dropped, "redundant constraint equation")));
    }
    let notes = scene.notes();
    notes.iter().for_each(print);
    let object = json!({
        "scene": scene.name(),
        "variables": parts[0].0,
        "nodes": parts[1].0,
        "elements": parts[2].0,
        "joints": parts[3].0,
        "functionals": parts[4].0,
        "notes": notes,
    });
    print_json(options.json, &object);
    Ok(())
}

/// `costate schema`: the JSON schema of scene files.
pub fn schema(parts: &OwnParts) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(&costate::scenes::file::schema(parts));
    print(text.map_err(|error| Failure::run(format!("the schema cannot be written: {error}")))?);
    Ok(())
}
