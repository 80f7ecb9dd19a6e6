use super::CommandLine;
use super::console::{count, print, print_json};
use super::failure::Failure;
use super::options::located;
use crate::io::{Cell, Table, cells};
use clap::Args;
use costate::design::DesignVariable;
use costate::elements::entries::Key;
use costate::scenes::{AnyScene, Prepared};
use serde_json::{Value, json};

/// Options of `costate list`.
#[derive(Args)]
pub struct ListOptions {
    /// Name of a scene, or path of a scene file (.toml): lists its design variables and functionals
    scene: Option<String>,
    /// Lists the joints, drivers, springs, dampers and functionals that scene files may have, with their keys
    #[arg(long, conflicts_with = "scene")]
    parts: bool,
    /// Print one JSON object on the last line of stdout
    #[arg(long)]
    json: bool,
}

/// `costate list`: the scenes, a line each; of one scene its design variables and functionals.
pub fn run(options: &ListOptions, program: &CommandLine) -> Result<(), Failure> {
    match &options.scene {
        Some(name) => one(&*program.find_scene(name)?, name, options.json)?,
        None if options.parts => parts(program, options.json),
        None => all(&program.all_scenes()?, program, options.json),
    }
    Ok(())
}

/// Joints, drivers, springs, dampers and functionals by their entries.
fn parts(program: &CommandLine, json: bool) {
    let titles = ["part", "section", "what it is", "keys; optional ones in brackets"];
    let mut table = Table::new(&titles).keyed(&["name", "section", "doc", "keys"]);
    for (section, form) in program.parts.listed() {
        let key = |key: &Key| if key.is_needed { key.name.to_string() } else { format!("[{}]", key.name) };
        let words = form.keys.iter().map(key).collect::<Vec<_>>().join(" ");
        let keys = form.keys.iter().map(|key| json!({"name": key.name, "needed": key.is_needed, "doc": key.doc}));
        table.row(cells![form.name, section, form.doc, Cell::of(words, keys.collect::<Vec<_>>())]);
    }
    print(format_args!("{table}\n\nall sections and keys: {} schema", program.name));
    print_json(json, &json!({ "parts": table.json() }));
}

fn all(scenes: &[&dyn AnyScene], program: &CommandLine, json: bool) {
    let mut table = Table::new(&["scene", "what it is", "variables", "to optimize"]);
    for scene in scenes {
        table.row(cells![scene.name(), scene.summary(), scene.variables().len(), wanted(*scene)]);
    }
    let name = &program.name;
    if scenes.is_empty() {
        print("this program has no scenes of its own; it takes scene files");
    } else {
        print(format_args!(
            "{table}\n\nvariables and functionals of one: {name} list SCENE; a scene file to start from: {name} new FILE"
        ));
    }
    let scenes: Vec<Value> = scenes.iter().map(|scene| object(*scene)).collect();
    print_json(json, &json!({ "scenes": scenes }));
}

fn one(scene: &dyn AnyScene, name: &str, json: bool) -> Result<(), Failure> {
    let prepared = Prepared::new(scene).map_err(|error| located(scene, name, error.into()))?;
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    let settings = scene.settings();
    let steps = match settings.control {
        Some(_) => "chosen steps".into(),
        None => count(settings.steps, "step"),
    };
    let method = &prepared.method.table;
    let span = if method.is_static() { format!("load factor {}", settings.end) } else { format!("{} s", settings.end) };
    print(format_args!("{}, {steps}, {span}", method.name));
    if let Some(wanted) = wanted(scene) {
        print(format_args!("to optimize: {wanted}"));
    }
    print(format_args!("\n{}", variables(scene)));
    let measured = prepared.functionals().iter().map(|own| (own.name.clone(), own.value_unit()));
    let modes = scene.modes();
    let modes = modes.iter().map(|own| (own.name.clone(), own.unit().to_string()));
    let mut table = Table::new(&["functional", "unit"]).keyed(&["name", "unit"]);
    for (name, unit) in measured.chain(modes) {
        table.row(cells![name, unit]);
    }
    print(format_args!("\n{table}"));
    let mut own = object(scene);
    let mut functionals = table.json();
    own["modes"] = functionals.split_off(prepared.functionals().len()).into();
    own["functionals"] = functionals.into();
    print_json(json, &own);
    Ok(())
}

/// What `optimize` would do.
fn wanted(scene: &dyn AnyScene) -> Option<String> {
    let problem = scene.optimization_problem()?;
    Some(format!("{} {}", problem.sense.name(), problem.objective_name()))
}

fn variables(scene: &dyn AnyScene) -> Table {
    let titles = ["variable", "initial", "from", "to", "unit"];
    let mut table = Table::new(&titles).keyed(&["name", "initial", "lower", "upper", "unit"]);
    for DesignVariable { name, initial, lower, upper, unit } in scene.variables() {
        table.row(cells![name, initial, lower, upper, unit]);
    }
    table
}

fn object(scene: &dyn AnyScene) -> Value {
    let settings = scene.settings();
    json!({
        "scene": scene.name(),
        "summary": scene.summary(),
        "end_s": settings.end,
        "steps": settings.steps,
        "variables": variables(scene).json(),
        "optimization": wanted(scene),
    })
}
