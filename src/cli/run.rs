use super::CommandLine;
use super::comparison::Comparison;
use super::console::{print, print_files, print_json};
use super::failure::Failure;
use super::histories::{check_history, keep, resumed};
use super::options::SceneOptions;
use super::report::Page;
use super::simulation::{Simulation, print_work, simulate};
use clap::Args;
use costate::history::Keep;
use costate::scenes::{Prepared, Scenario};

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
    each_scenario(&options.scene, &keep, program, |options, prepared| {
        let mut simulation = simulate(prepared, options)?;
        let page = (!options.no_report).then(|| {
            let page = Page::by_command(prepared.scene, "simulation");
            let mut page = page.with_simulation(prepared, &simulation.shown(prepared));
            simulation.modes.summary(prepared).show(&mut page);
            page.design(&prepared.variables, &prepared.x);
            page
        });
        let json = simulation.conclude(page, simulation.json(prepared));
        report(&simulation, prepared);
        print_json(options.json, &json);
        simulation.verdict()
    })
}

/// Runs a scene or its scenarios, one after the other, and compares what they gave.
pub fn each_scenario(
    options: &SceneOptions,
    keep: &Keep,
    program: &CommandLine,
    run_one: impl Fn(&SceneOptions, &mut Prepared) -> Result<Simulation, Failure>,
) -> Result<(), Failure> {
    let scene = options.scene(program)?;
    let scenarios = options.scenarios(&*scene)?;
    let count = scenarios.len();
    let mut comparison = Comparison::default();
    for Scenario { name, scene } in scenarios {
        let own = options.of_scenario(&name, count);
        check_history(keep, count, &own.folder(scene))?;
        let mut prepared = own.prepare(scene)?;
        prepared.keep = keep.clone();
        let simulation = run_one(&own, &mut prepared)?;
        comparison.add(&name, &prepared, &simulation);
    }
    comparison.conclude(&*scene, options)
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
