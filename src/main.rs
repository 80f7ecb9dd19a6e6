//! The command line of costate: its built-in scenes, and the studies of `verification`.

mod allocations;
#[path = "../verification/mod.rs"]
mod verification;

use costate::cli::CommandLine;
use costate::scenes::built_in;
use std::process::ExitCode;

fn main() -> ExitCode {
    let (scenes, studies) = (built_in::all(), verification::all());
    CommandLine::new(scenes.iter().map(|scene| &**scene)).with_studies(studies.iter().map(|study| &**study)).main()
}
