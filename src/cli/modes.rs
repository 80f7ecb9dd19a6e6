use super::CommandLine;
use super::campbell::Branches;
use super::console::{count, print, print_files, print_json, warn};
use super::failure::Failure;
use super::mode_gradients::Gradients;
use super::motions::{mode_moments, view};
use super::options::whole_number;
use super::rates::Rates;
use super::report::{Clip, Page};
use super::simulation::names;
use super::snapshot::Snapshot;
use super::still::StillOptions;
use super::summary::{Summary, by_name};
use crate::io::{Cell, Table, cells, long_number, number as number_of, write_json};
use clap::Args;
use costate::integrators::{Mode, RunError};
use costate::scenes::{DifferentiatedModes, PeriodicModes, Prepared};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;

/// Options of `costate modes`.
#[derive(Args)]
pub struct ModesOptions {
    #[command(flatten)]
    still: StillOptions,
    /// Number of modes: those whose omega^2 are nearest to zero
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = whole_number::<MOST_MODES>, allow_negative_numbers = true)]
    count: usize,
    /// With dampers, states of first order and what else depends on velocities: complex modes; about a steady turn they are that anyway
    #[arg(long)]
    damped: bool,
    /// About the motion of a run that is one period long and ends as it began (Floquet): rotors on supports that differ by direction, periodic drives
    #[arg(long, conflicts_with_all = ["damped", "gradients", "speed"])]
    periodic: bool,
    /// Derivatives of frequencies and growth by all design variables, through the equilibrium
    #[arg(long)]
    gradients: bool,
    /// Modes over the rate of a steady turn [rad/s], followed by their shapes: campbell.csv and campbell.svg
    #[arg(long, value_name = "FIRST:LAST:NUMBER", allow_hyphen_values = true)]
    speed: Option<Rates>,
}

/// Most modes that swing on the page.
const MOST_SHOWN: usize = 12;
/// Frames of a period.
const FRAMES: usize = 24;
const MOST_MODES: usize = 10_000;

/// `costate modes`: frequencies and shapes of small vibrations.
pub fn run(options: &ModesOptions, program: &CommandLine) -> Result<(), Failure> {
    options.still.with_scene(program, |prepared, named| modes(options, prepared, named))
}

fn modes(options: &ModesOptions, mut prepared: Prepared, named: &dyn Fn(RunError) -> Failure) -> Result<(), Failure> {
    let scene = prepared.scene;
    let folder = options.still.of.folder(scene);
    let spins = prepared.spin_rate().is_some();
    let mut kind = if options.damped || spins { Kind::Complex } else { Kind::Undamped };
    let found = if options.periodic {
        let found = prepared.periodic_modes(options.count).map_err(named)?;
        let PeriodicModes { period, gap, q, modes, faded, kinks } = found;
        kinks.iter().for_each(|kink| warn(&kink.to_string()));
        kind = Kind::Periodic { period, gap, faded };
        DifferentiatedModes { q, modes, gradients: Vec::new(), proved: true }
    } else {
        find(options, &prepared, kind).map_err(named)?
    };
    let DifferentiatedModes { q, modes, proved, .. } = &found;
    let about = match kind {
        Kind::Periodic { .. } => "motion of a period",
        _ if prepared.method.table.is_static() => "equilibrium",
        _ => "start",
    };
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    print_about(&prepared, kind, scene.settings().end);
    let mut summary = Summary::default();
    summary.table("Modes", table(&prepared, (q, kind), modes));
    summary.print();
    if let Kind::Periodic { period, faded, .. } = kind {
        let share = number_of(TAU / period);
        print(format_args!(
            "omega is known up to multiples of 2 pi by the period, {share} rad/s: the next ones stand beside it"
        ));
        if faded > 0 {
            print(format_args!("{} fade to nothing within a period", count(faded, "more mode")));
        }
        print("");
    }
    if modes.is_empty() {
        print("there is no mode: nothing that could move has inertia\n");
    } else if modes.len() < options.count && *proved {
        print(format_args!("there {} only {}\n", if modes.len() == 1 { "is" } else { "are" }, count(modes.len(), "mode")));
    }
    if !proved {
        print(
            "that no mode is missing is not proved: the model is large, and its matrices have no symmetry that would tell\n",
        );
    }
    let [report, json] = ["modes.html", "modes.json"].map(|name| folder.join(name));
    let mut files = vec![report.clone(), json.clone()];
    let branches = follow(options, &mut prepared)?;
    if let Some(branches) = &branches {
        branches.print();
        files.extend(branches.write(format!("{}: modes over the rate of the turn", scene.name()), &folder)?);
    }
    let mut page = page(&prepared, q, modes);
    page.fact("about", format!("the {about}"));
    summary.show(&mut page);
    page.design(&prepared.variables, &prepared.x);
    let gradients = Gradients { prepared: &prepared, own: &found, are_complex: kind != Kind::Undamped };
    if options.gradients {
        let summary = gradients.summary();
        summary.print();
        summary.show(&mut page);
        files.push(gradients.write(&folder)?);
    }
    page.write(&report, &files)?;
    print_files(&files);
    let object = json!({
        "scene": scene.name(),
        "about": about,
        "design": by_name(&prepared.variables, prepared.x.iter().copied()),
        "kind": kind.word(),
        "period_s": kind.period(),
        "modes": modes.iter().map(|mode| json_of(&prepared, q, mode)).collect::<Vec<_>>(),
        "gradients": options.gradients.then(|| (0..modes.len()).map(|mode| gradients.json(mode)).collect::<Vec<_>>()),
        "speeds": branches.as_ref().map(Branches::json),
        "files": names(&files),
    });
    write_json(&json, &object)?;
    print_json(options.still.of.json, &object);
    Ok(())
}

/// The modes about a state, with their derivatives if they are asked for.
fn find(options: &ModesOptions, prepared: &Prepared, kind: Kind) -> Result<DifferentiatedModes, RunError> {
    if options.gradients {
        return prepared.modes_with_gradients(options.count, kind == Kind::Complex);
    }
    prepared.modes_at_rest(options.count, kind == Kind::Complex)
}

fn follow(options: &ModesOptions, prepared: &mut Prepared) -> Result<Option<Branches>, Failure> {
    let Some(rates) = &options.speed else { return Ok(None) };
    if prepared.spin_rate().is_none() {
        let text = "--speed needs a scene that begins with a steady turn ([[spin]] and start = \"steady\" of a scene file)";
        return Err(Failure::input(text));
    }
    Branches::follow(prepared, &rates.list, options.count).map(Some)
}

/// What vibrates, and about which state.
fn print_about(prepared: &Prepared, kind: Kind, end: f64) {
    if let Kind::Periodic { period, gap, .. } = kind {
        let [period, gap] = [period, gap].map(number_of);
        print(format_args!(
            "small motions about one that repeats itself after {period} s (it returns within {gap} of its size)\n"
        ));
        return;
    }
    let what = if kind == Kind::Complex { "small vibrations with damping" } else { "small undamped vibrations" };
    if prepared.method.table.is_static() {
        print(format_args!("{what} about the equilibrium at the load factor {end}\n"));
    } else if prepared.spin_rate().is_some() {
        print("small vibrations about the steady turn at which the motion begins, in the frame that turns, with damping\n");
    } else if prepared.plan.equilibrium.is_some() {
        print(format_args!("{what} about the equilibrium at which the motion begins\n"));
    } else {
        print(format_args!("{what} about the start\n"));
    }
}

fn page(prepared: &Prepared, q: &[f64], modes: &[Mode]) -> Page {
    let mut page = Page::by_command(prepared.scene, "small vibrations");
    let angles = || (0..=FRAMES).map(|k| TAU * k as f64 / FRAMES as f64);
    let swinging: Vec<(String, Vec<Snapshot>)> = (1..=MOST_SHOWN)
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
    if let Some(view) = swinging.first().and_then(|(_, moments)| view(prepared, moments)) {
        page.space(&prepared.mechanism.solids(), view, &clips);
    }
    page
}

fn what(mode: &Mode) -> String {
    if mode.is_unstable() { "unstable".into() } else { format!("{} Hz", number_of(mode.frequency / TAU)) }
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Undamped,
    Complex,
    /// Period, by how much the motion does not return, number of modes that are not told.
    Periodic {
        period: f64,
        gap: f64,
        faded: usize,
    },
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Kind::Undamped => "undamped",
            Kind::Complex => "complex",
            Kind::Periodic { .. } => "periodic",
        }
    }

    fn period(self) -> Option<f64> {
        match self {
            Kind::Periodic { period, .. } => Some(period),
            _ => None,
        }
    }

    fn columns(self) -> &'static [&'static str] {
        match self {
            Kind::Periodic { .. } => {
                &["mode", "omega [rad/s]", "next below [rad/s]", "next above [rad/s]", "growth [1/s]", "moves most"]
            }
            Kind::Undamped => &["mode", "omega [rad/s]", "frequency [Hz]", "growth [1/s]", "moves most"],
            Kind::Complex => {
                &["mode", "omega [rad/s]", "frequency [Hz]", "growth [1/s]", "damping ratio", "whirl", "moves most"]
            }
        }
    }
}

fn table(prepared: &Prepared, (q, kind): (&[f64], Kind), modes: &[Mode]) -> Table {
    let (model, mut table) = (prepared.model(), Table::new(kind.columns()));
    for (place, mode) in modes.iter().enumerate() {
        let size = |dof: usize| mode.shape[dof].hypot(mode.ahead[dof]);
        let largest = (0..model.dofs).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        let growth = match kind {
            _ if mode.is_unstable() => format!("{} unstable", long_number(mode.growth)).into(),
            Kind::Undamped => "0".into(),
            _ => Cell::long(mode.growth),
        };
        let mut row = cells![(place + 1).to_string(), Cell::long(mode.frequency)].to_vec();
        match kind.period() {
            Some(period) => {
                row.extend([TAU / period - mode.frequency, TAU / period + mode.frequency].map(Cell::long));
                row.push(growth);
            }
            None => row.extend([Cell::long(mode.frequency / TAU), growth]),
        }
        if kind == Kind::Complex {
            let whirl = prepared.whirl(q, mode).map(|whirl| format!("{whirl:+.2}"));
            row.extend(cells![number_of(mode.damping_ratio()), whirl]);
        }
        row.push(largest.map(|dof| model.dof_name(dof)).into());
        table.row(row);
    }
    table
}

fn json_of(prepared: &Prepared, q: &[f64], mode: &Mode) -> Value {
    let model = prepared.model();
    let shape = |values: &[f64]| -> Map<String, Value> {
        model.nodes.iter().map(|node| (node.name.clone(), values[node.dofs.clone()].into())).collect()
    };
    json!({
        "omega_rad_s": mode.frequency,
        "frequency_hz": mode.frequency / TAU,
        "growth_1_s": mode.growth,
        "damping_ratio": mode.damping_ratio(),
        "whirl": prepared.whirl(q, mode),
        "shape": shape(&mode.shape),
        "ahead": shape(&mode.ahead),
    })
}
