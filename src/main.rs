//! The command line of costate.

mod allocations;
mod command_line;
#[path = "../verification/mod.rs"]
mod verification;

fn main() -> std::process::ExitCode {
    command_line::main()
}
