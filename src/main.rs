//! The command line of costate: its built-in scenes, and the studies of `verification`.

mod allocations;
#[path = "../verification/mod.rs"]
mod verification;

use costate::cli::CommandLine;
use std::process::ExitCode;

fn main() -> ExitCode {
    let studies = verification::all();
    CommandLine::new([]).with_built_in().with_studies(studies.iter().map(|study| &**study)).main()
}
