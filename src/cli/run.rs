use super::CommandLine;
use super::comparison::Comparison;
use super::console::{print, print_files, print_json};
use super::failure::Failure;
use super::histories::{check_history, check_one_history, keep, resumed};
use super::options::SceneOptions;
use super::report::Page;
use super::simulation::{Simulation, print_work, simulate};
use clap::Args;
use costate::history::Keep;
use costate::scenes::{AnyScene, Prepared, Scenario};

/// Options of `costate run`.
#[derive(Args)]
pub struct RunOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Keep the steps, too: in file:PATH, with which --resume goes on, and `gradient` [default: not at all]
    #[arg(long, value_name = "WHERE", value_parser = keep)]
    history: Option<Keep>,
    /// Go on with the run in the file of --history where it stopped, bit for bit; a finished one is not simulated again
    #[arg(long)]
    resume: bool,
}

/// `costate run`: simulates, writes, prints.
pub fn run(options: &RunOptions, program: &CommandLine) -> Result<(), Failure> {
    // no gradient is asked for
    let keep = resumed(options.history.clone().unwrap_or(Keep::Nothing), options.resume)?;
    let options = &options.scene;
    let scene = options.scene(program)?;
    let scenarios = options.scenarios(&*scene)?;
    check_one_history(&keep, scenarios.len())?;
    let count = scenarios.len();
    let mut comparison = Comparison::default();
    scenarios.into_iter().try_for_each(|Scenario { name, scene }| {
        run_one(&options.of_scenario(&name, count), scene, keep.clone(), |prepared, simulation| {
            comparison.add(&name, prepared, simulation)
        })
    })?;
    comparison.conclude(&*scene, options)
}

/// Simulates a scene or a scenario, writes, prints, and shows what it gave.
fn run_one(
    options: &SceneOptions,
    scene: &dyn AnyScene,
    keep: Keep,
    show: impl FnOnce(&Prepared, &Simulation),
) -> Result<(), Failure> {
    check_history(&keep, &options.folder(scene))?;
    let mut prepared = options.prepare(scene)?;
    prepared.keep = keep;
    let mut simulation = simulate(&prepared, options)?;
    let page = (!options.no_report).then(|| {
        let mut page = Page::by_command(scene, "simulation").with_simulation(&prepared, &simulation.shown(&prepared));
        simulation.modes.summary(&prepared).show(&mut page);
        page.design(&prepared.variables, &prepared.x);
        page
    });
    simulation.conclude(page, simulation.json(&prepared));
    report(&simulation, &prepared);
    show(&prepared, &simulation);
    print_json(options.json, &simulation.json(&prepared));
    simulation.stopped.or(simulation.unwritten).map_or(Ok(()), Err)
}

/// Prints what a simulation gave; of one that stopped early only what holds for the finished steps.
pub fn report(simulation: &Simulation, prepared: &Prepared) {
    if simulation.stopped.is_none() {
        simulation.shown(prepared).summary(prepared).print();
        simulation.modes.summary(prepared).print();
    } else {
        let done = simulation.forward.history.steps();
        let planned = if prepared.control.is_some() { String::new() } else { format!(" of {}", prepared.grid.steps()) };
        print(format_args!("stopped after {done}{planned} steps: the files hold the finished ones"));
        if let Keep::File(path) | Keep::Resumed(path) = &prepared.keep {
            print(format_args!("with --history file:{} --resume it goes on from there", path.display()));
        }
        print("");
    }
    print_work(&[("simulation", simulation.work(prepared))]);
    print_files(&simulation.files);
}
