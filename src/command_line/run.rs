use super::console::{say, say_json};
use super::failure::Failure;
use super::options::SceneOptions;
use super::simulation::{Simulation, say_work, simulate};
use clap::Args;
use costate::history::Keep;

/// Options of `costate run`.
#[derive(Args)]
pub struct RunOptions {
    #[command(flatten)]
    scene: SceneOptions,
}

/// `costate run`: simulates, writes, prints.
pub fn run(options: &RunOptions) -> Result<(), Failure> {
    let options = &options.scene;
    let scene = options.scene()?;
    let mut prepared = options.prepare(&*scene)?;
    // no gradient is asked for
    prepared.keep = Keep::Nothing;
    let simulation = simulate(&prepared, options)?;
    report(&simulation, &prepared);
    say_json(options.json, &simulation.json(&prepared).into());
    simulation.stopped.or(simulation.unwritten).map_or(Ok(()), Err)
}

/// Prints what a simulation gave; of one that stopped early only what holds for the finished steps.
pub fn report(simulation: &Simulation, prepared: &costate::scenes::Prepared) {
    if simulation.stopped.is_none() {
        simulation.say_functionals(prepared);
        simulation.say_resolution(prepared);
    } else {
        let done = simulation.forward.history.steps();
        let planned = if prepared.control.is_some() { String::new() } else { format!(" of {}", prepared.grid.steps()) };
        say(format_args!("stopped after {done}{planned} steps: the files hold the finished ones\n"));
    }
    say_work(&[("simulation", simulation.work())]);
    simulation.say_files();
}
