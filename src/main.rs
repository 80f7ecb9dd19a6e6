//! The command line of costate with its built-in scenes.

use costate::cli::CommandLine;
use costate::scenes::built_in;
use std::process::ExitCode;

fn main() -> ExitCode {
    let scenes = built_in::all();
    CommandLine::new(scenes.iter().map(|scene| &**scene)).main()
}
