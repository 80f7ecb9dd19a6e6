//! `costate verify`: the command line of costate with the studies of this folder, a program of its own beside it.

mod allocations;
#[path = "mod.rs"]
mod verification;

use costate_cli::CommandLine;
use std::process::ExitCode;

fn main() -> ExitCode {
    let studies = verification::all();
    CommandLine::new([]).with_built_in().with_studies(studies.iter().map(|study| &**study)).main()
}
