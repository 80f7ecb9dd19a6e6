use super::console::{json_number, say, say_json};
use super::failure::Failure;
use clap::Args;
use costate::io::Table;
use costate::scenes::built_in;
use serde_json::{Value, json};

/// Options of `costate list`.
#[derive(Args)]
pub struct ListOptions {
    /// Print one JSON object on the last line of stdout
    #[arg(long)]
    json: bool,
}

/// `costate list`: scenes, their defaults and their design variables.
pub fn run(options: &ListOptions) -> Result<(), Failure> {
    let mut scenes: Vec<Value> = Vec::new();
    for scene in built_in::all() {
        let (name, summary, settings) = (scene.scene_name(), scene.scene_summary(), scene.default_settings());
        match settings.method {
            Some(method) => say(format_args!("{name}: {summary} ({method}, {} steps)", settings.steps)),
            None => say(format_args!("{name}: {summary} ({} s, {} steps)", settings.end, settings.steps)),
        }
        let problem =
            scene.optimization_problem().map(|problem| format!("{} {}", problem.sense.name(), problem.objective_name()));
        if let Some(problem) = &problem {
            say(format_args!("  costate optimize {name}: {problem}"));
        }
        let mut table = Table::new(&["  variable", "initial", "from", "to", "unit"]);
        let mut variables: Vec<Value> = Vec::new();
        for v in scene.design_variables() {
            table.row([format!("  {}", v.name).into(), v.initial.into(), v.lower.into(), v.upper.into(), v.unit.into()]);
            let [initial, lower, upper] = [v.initial, v.lower, v.upper].map(json_number);
            variables.push(json!({"name": v.name, "initial": initial, "lower": lower, "upper": upper, "unit": v.unit}));
        }
        say(format_args!("{table}\n"));
        let end = json_number(settings.end);
        scenes.push(json!({
            "scene": name,
            "summary": summary,
            "end_s": end,
            "steps": settings.steps,
            "variables": variables,
            "optimization": problem,
        }));
    }
    say_json(options.json, &json!({ "scenes": scenes }));
    Ok(())
}
