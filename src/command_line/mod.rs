//! `costate`: simulate scenes, differentiate them, verify the program.

mod check;
mod console;
mod failure;
mod gradient;
mod histories;
mod interrupt;
mod list;
mod meshes;
mod modes;
mod motions;
mod optimization_charts;
mod optimize;
mod options;
mod results;
mod run;
mod simulation;
mod verify;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Flexible multibody dynamics with exact gradients.
///
/// Exit codes: 0 done; 1 a run failed, or a check or study is out of tolerance; 2 bad input; 130 interrupted.
#[derive(Parser)]
#[command(name = "costate", version, arg_required_else_help = true)]
struct Costate {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Simulate a scene: functionals, histories, a picture of the motion
    Run(run::RunOptions),
    /// Simulate a scene and differentiate its functionals by the discrete adjoint
    Gradient(gradient::GradientOptions),
    /// Improve a scene's design by what the scene states: objective, limits, variables
    Optimize(optimize::OptimizeOptions),
    /// Frequencies and shapes of small vibrations about the start of a scene or another equilibrium
    Modes(modes::ModesOptions),
    /// Measure a study of verification/ against its reference; without a name: list the studies
    Verify(verify::VerifyOptions),
    /// Read a scene file and check what it says, without running it
    Check(check::CheckOptions),
    /// Print the JSON schema of scene files, from which editors complete them
    Schema,
    /// List the scenes and their design variables
    List(list::ListOptions),
}

/// Runs the command line and returns the exit code.
pub fn main() -> ExitCode {
    let command = Costate::parse().command;
    let done = interrupt::install().and_then(|()| match command {
        Command::Run(options) => run::run(&options),
        Command::Gradient(options) => gradient::run(&options),
        Command::Optimize(options) => optimize::run(&options),
        Command::Modes(options) => modes::run(&options),
        Command::Verify(options) => verify::run(&options),
        Command::Check(options) => check::run(&options),
        Command::Schema => check::schema(),
        Command::List(options) => list::run(&options),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console::complain(&failure.message);
            ExitCode::from(failure.code)
        }
    }
}
