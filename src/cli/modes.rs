use super::CommandLine;
use super::console::{count, json_number, say, say_json};
use super::failure::Failure;
use super::motions::{mode_moments, mode_picture, motion};
use super::options::{changed_design, located, only_scenario};
use super::report::{Clip, Page};
use super::results::Snapshot;
use super::simulation::{long_number, names};
use crate::assembly::Model;
use crate::integrators::{Mode, STATIC_TABLE};
use crate::io::{Cell, Table, number as number_of, write_file};
use crate::scenes::Prepared;
use clap::Args;
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Options of `costate modes`.
#[derive(Args)]
pub struct ModesOptions {
    /// Name of a scene (see `list`), or path of a scene file (.toml)
    scene: String,
    /// Number of modes: those whose omega^2 are nearest to zero
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = mode_count, allow_negative_numbers = true)]
    count: usize,
    /// About the equilibrium after the scene's load steps instead of its start; scenes of equilibria do so anyway
    #[arg(long = "static")]
    statics: bool,
    /// Folder for the pictures [default: out/SCENE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// One of the scenarios of the scene
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Change a design variable; may be given once for each
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Print one JSON object with all figures on the last line of stdout
    #[arg(long)]
    json: bool,
}

/// Most modes that are drawn.
const MOST_PICTURES: usize = 12;
/// Frames of a period.
const FRAMES: usize = 24;
/// Most modes.
const MOST_MODES: usize = 10_000;

fn mode_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if (1..=MOST_MODES).contains(&count) => Ok(count),
        _ => Err(format!("it must be a whole number from 1 to {MOST_MODES}")),
    }
}

/// `costate modes`: frequencies and shapes of small undamped vibrations.
pub fn run(options: &ModesOptions, program: &CommandLine) -> Result<(), Failure> {
    let found = program.find_scene(&options.scene)?;
    let scene = only_scenario(&*found, options.scenario.as_deref())?;
    let x = changed_design(&scene.variables(), &options.set)?;
    let settings = scene.settings();
    let settings = if options.statics { settings.with_method(STATIC_TABLE) } else { settings };
    let method = Prepared::method_of(&settings)?;
    let named = |error| {
        let failure = Failure::from(error);
        let message = failure.message.replace("by the method \"static\"", "(--static), or correct the start");
        located(scene, &options.scene, Failure { message, ..failure })
    };
    let prepared = Prepared::with(scene, &x, method, settings.clone()).map_err(named)?;
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name()));
    let (q, modes) = prepared.modes_with_state(options.count).map_err(named)?;
    let about = if prepared.method.table.is_static() { "equilibrium" } else { "start" };
    say(format_args!("{}: {}", scene.name(), scene.summary()));
    match about {
        "start" if prepared.plan.equilibrium.is_some() => {
            say("small undamped vibrations about the equilibrium at which the motion begins\n");
        }
        "start" => say("small undamped vibrations about the start\n"),
        _ => say(format_args!("small undamped vibrations about the equilibrium at the load factor {}\n", settings.end)),
    }
    say_modes(prepared.model(), &modes);
    if modes.is_empty() {
        say("there is no mode: nothing that could move has inertia\n");
    } else if modes.len() < options.count {
        say(format_args!("there {} only {}\n", if modes.len() == 1 { "is" } else { "are" }, count(modes.len(), "mode")));
    }
    let mut files = draw(&prepared, &q, &modes, &folder)?;
    let [report, summary] = ["modes.html", "modes.json"].map(|name| folder.join(name));
    files.extend([report.clone(), summary.clone()]);
    page(&prepared, &q, &modes, about).write(&report, &files)?;
    files.iter().for_each(|file| say(format_args!("wrote {}", file.display())));
    let design = prepared.variables.iter().zip(&prepared.x).map(|(v, &x)| (v.name.clone(), json_number(x)));
    let object = json!({
        "scene": scene.name(),
        "about": about,
        "design": Value::from(design.collect::<Map<_, _>>()),
        "modes": modes.iter().map(|mode| json_of(prepared.model(), mode)).collect::<Vec<_>>(),
        "files": names(&files),
    });
    write_file(&summary, format!("{object:#}\n").as_bytes())?;
    say_json(options.json, &object);
    Ok(())
}

/// The modes as a page on which they swing.
fn page(prepared: &Prepared, q: &[f64], modes: &[Mode], about: &str) -> Page {
    let mut page = Page::new(prepared.scene, "small vibrations");
    page.fact("about", format!("the {about}"));
    page.table(
        "Modes",
        &MODE_COLUMNS,
        mode_rows(prepared.model(), modes).into_iter().map(|row| row.map(Value::from).to_vec()).collect(),
    );
    page.design(&prepared.variables, &prepared.x);
    let angles = || (0..=FRAMES).map(|k| TAU * k as f64 / FRAMES as f64);
    let swinging: Vec<(String, Vec<Snapshot>)> = (1..=MOST_PICTURES)
        .zip(modes)
        .filter_map(|(number, mode)| {
            let name = format!("mode {number}: {}", what(mode));
            Some((name, mode_moments(prepared, q, mode, angles())?))
        })
        .collect();
    let clips: Vec<Clip> = swinging
        .iter()
        .map(|(name, moments)| {
            let moments = moments.iter().map(|moment| (moment.t, &moment.q[..])).collect();
            Clip { name: name.clone(), swings: true, moments }
        })
        .collect();
    if let Some(picture) = swinging.first().and_then(|(_, moments)| motion(prepared, moments)) {
        page.space(&prepared.mechanism.solids(), picture.view, &clips);
    }
    page
}

fn what(mode: &Mode) -> String {
    if mode.is_unstable() { "unstable".into() } else { format!("{} Hz", number_of(mode.frequency / TAU)) }
}

/// Draws the modes that have a place in space: mode-1.png/.svg and so on.
fn draw(prepared: &Prepared, q: &[f64], modes: &[Mode], folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for (number, mode) in (1..=MOST_PICTURES).zip(modes) {
        let Some(mut picture) = mode_picture(prepared, q, mode) else { continue };
        picture.title = format!("{}: mode {number}, {}", prepared.scene.name(), what(mode));
        let stem = folder.join(format!("mode-{number}"));
        picture.write(&stem)?;
        files.extend(["png", "svg"].map(|ending| stem.with_extension(ending)));
    }
    Ok(files)
}

const MODE_COLUMNS: [&str; 5] = ["mode", "omega [rad/s]", "frequency [Hz]", "growth [1/s]", "moves most"];

fn mode_rows(model: &Model, modes: &[Mode]) -> Vec<[String; 5]> {
    let row = |(number, mode): (usize, &Mode)| {
        let largest = (0..model.dofs).max_by(|&a, &b| mode.shape[a].abs().total_cmp(&mode.shape[b].abs()));
        [
            (number + 1).to_string(),
            long_number(mode.frequency),
            long_number(mode.frequency / TAU),
            if mode.is_unstable() { format!("{} unstable", long_number(mode.growth)) } else { "0".into() },
            largest.map_or_else(String::new, |dof| model.dof_name(dof)),
        ]
    };
    modes.iter().enumerate().map(row).collect()
}

fn say_modes(model: &Model, modes: &[Mode]) {
    let mut table = Table::new(&MODE_COLUMNS);
    for row in mode_rows(model, modes) {
        table.row(row.map(Cell::from));
    }
    say(format_args!("{table}\n"));
}

fn json_of(model: &Model, mode: &Mode) -> Value {
    let list = |values: &[f64]| values.iter().copied().map(json_number).collect::<Vec<_>>();
    let shape = |values: &[f64]| -> Map<String, Value> {
        model.nodes.iter().map(|node| (node.name.clone(), list(&values[node.dofs.clone()]).into())).collect()
    };
    json!({
        "omega_rad_s": json_number(mode.frequency),
        "frequency_hz": json_number(mode.frequency / TAU),
        "growth_1_s": json_number(mode.growth),
        "shape": shape(&mode.shape),
        "ahead": shape(&mode.ahead),
    })
}
