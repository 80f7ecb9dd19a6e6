use super::console::{say, say_json};
use super::failure::Failure;
use super::options::SceneOptions;
use super::simulation::{Simulation, say_work, simulate};
use clap::Args;

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
    let prepared = options.prepare(&*scene)?;
    let simulation = simulate(&prepared, options)?;
    report(&simulation, &prepared);
    say_json(options.json, &simulation.json(&prepared).into());
    simulation.stopped.map_or(Ok(()), Err)
}

/// Prints what a simulation gave; of one that stopped early only what holds for the finished steps.
pub fn report(simulation: &Simulation, prepared: &costate::scenes::Prepared) {
    if simulation.stopped.is_none() {
        simulation.say_functionals(prepared);
    } else {
        let (done, planned) = (simulation.forward.history.steps.len(), prepared.grid.steps());
        say(format_args!("stopped after {done} of {planned} steps: the files hold the finished ones\n"));
    }
    say_work(&[("simulation", simulation.work())]);
    simulation.say_files();
}
