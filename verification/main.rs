//! `costate verify`: the command line of costate with the studies of this folder, a program of its own beside it.

mod allocations;
#[path = "mod.rs"]
mod verification;

use costate::cli::CommandLine;
use costate::scenes::built_in;
use std::process::ExitCode;

fn main() -> ExitCode {
    let (scenes, studies) = (built_in::all(), verification::all());
    CommandLine::new(scenes.iter().map(|scene| &**scene)).with_studies(studies.iter().map(|study| &**study)).main()
}
