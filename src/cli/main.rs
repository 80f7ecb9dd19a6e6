//! The command line of costate with its built-in scenes.

use costate_cli::CommandLine;
use std::process::ExitCode;

fn main() -> ExitCode {
    CommandLine::new([]).with_built_in().main()
}
