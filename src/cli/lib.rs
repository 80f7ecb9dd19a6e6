//! The command line: scenes are run, differentiated, improved, and written down, those of a program or of files.
//!
//! A program of its own for scenes of its own:
//!
//! ```no_run
//! use costate::prelude::*;
//! use std::process::ExitCode;
//!
//! struct Ball;
//! impl Scene for Ball {
//!     fn name(&self) -> String {
//!         "ball".into()
//!     }
//!     fn variables(&self) -> Vec<DesignVariable> {
//!         vec![DesignVariable::new("speed", 5.0, (1.0, 20.0), "m/s")]
//!     }
//!     fn settings(&self) -> Settings {
//!         Settings::new(1.0, 100)
//!     }
//!     fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
//!         let ball = m.point("ball", Vector3::zeros());
//!         m.point_mass("ball", ball, S::one());
//!         m.set_velocity(ball, Vector3::new(x[0], x[0], S::zero()), Vector3::zeros());
//!         m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
//!         m.coordinate_functional("height", Over::Terminal, ball, 1);
//!         Ok(())
//!     }
//! }
//!
//! fn main() -> ExitCode {
//!     costate_cli::main(&[&Ball])
//! }
//! ```

mod campbell;
mod check;
mod columns;
mod comparison;
mod console;
mod earlier;
mod energy_balance;
mod examples;
mod failure;
mod fit;
mod gradient;
mod histories;
mod history_charts;
mod import;
mod influences;
mod interrupt;
pub mod io;
mod kept_moments;
mod list;
mod manual;
mod measured_modes;
mod measured_moments;
mod meshes;
mod mode_gradients;
mod modes;
mod motions;
mod new;
mod optimization_charts;
mod optimize;
mod optimum;
mod options;
mod part_sensitivities;
mod projected_start;
mod rates;
mod report;
mod response;
mod results;
mod run;
mod simulation;
mod snapshot;
mod stability;
mod still;
mod study;
mod summary;
mod sweep;
mod table_ranges;
mod verify;

pub use crate::io::{Chart, Series, Style};
pub use report::RunReport;
pub use study::{Figure, Form, Report, Study};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use costate::design::repeated;
use costate::exchange;
use costate::scenes::file::OwnParts;
use costate::scenes::{AnyScene, built_in};
use failure::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Flexible multibody dynamics with exact gradients.
///
/// Exit codes: 0 done; 1 a run failed, or a check or study is out of tolerance; 2 bad input; 130 interrupted.
#[derive(Parser)]
#[command(arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Simulate a scene: functionals, histories, a report to look at
    Run(run::RunOptions),
    /// Simulate a scene and differentiate its functionals by the discrete adjoint
    Gradient(gradient::GradientOptions),
    /// Improve a scene's design by what the scene states: objective, limits, variables
    Optimize(optimize::OptimizeOptions),
    /// Fit a scene to what was measured: values of its variables, how exactly these are known
    Fit(fit::FitOptions),
    /// Run a scene at many designs, several at once: grids and samples of its variables
    Sweep(sweep::SweepOptions),
    /// Frequencies and shapes of small vibrations about the start of a scene or another equilibrium
    Modes(modes::ModesOptions),
    /// How functionals answer a harmonic change of a design variable: amplitudes and phases over its rate
    Response(response::ResponseOptions),
    /// Measure a study against its reference; without a name: list the studies
    Verify(verify::VerifyOptions),
    /// Read a scene file and check what it says, without running it
    Check(check::CheckOptions),
    /// Write a commented scene file to start from
    New(new::NewOptions),
    /// Make a scene file of a robot's description in URDF
    Import(import::ImportOptions),
    /// Print the JSON schema of scene files, from which editors complete them
    Schema,
    /// List the scenes; of one scene its design variables and functionals
    List(list::ListOptions),
    /// Print what a shell needs to complete commands and options
    Completions(manual::CompletionOptions),
    /// Write the pages of the manual into a folder
    Man(manual::ManualOptions),
}

/// Runs the command line for some scenes, and for scene files, with the arguments of the process; returns the exit code.
pub fn main(scenes: &[&dyn AnyScene]) -> ExitCode {
    CommandLine::new(scenes.iter().copied()).main()
}

/// Columns of help.
const COLUMNS: usize = 80;
/// Columns before what is said of an option, which stands below it, and of a command, which stands beside it.
const BEFORE: [usize; 2] = [10, 15];

/// Help in lines that a terminal shows whole.
fn wrapped(command: clap::Command) -> clap::Command {
    let [of_option, of_command] = BEFORE.map(|before| COLUMNS - before);
    let about = command.get_about().map(|text| lines(&text.to_string(), of_command));
    let is_leaf = !command.has_subcommands();
    let command = command.next_line_help(is_leaf).mut_args(|own| match own.get_help() {
        Some(help) => {
            let help = lines(&help.to_string(), of_option);
            own.help(help)
        }
        None => own,
    });
    let command = command.mut_subcommands(wrapped);
    if let Some(about) = about { command.about(about) } else { command }
}

/// A text in lines of at most so many columns, if its words are not longer.
fn lines(text: &str, columns: usize) -> String {
    let (mut all, mut used) = (String::new(), 0);
    for word in text.split_whitespace() {
        let length = word.chars().count();
        let separator = match used {
            0 => "",
            used if used + 1 + length > columns => "\n",
            _ => " ",
        };
        used = if separator == " " { used + 1 + length } else { length };
        all += separator;
        all += word;
    }
    all
}

/// Starts the threads that share work, which would start with the first of it, and panic where the system refuses one.
fn start_threads() -> Result<(), Failure> {
    let failed = rayon::ThreadPoolBuilder::new().build_global().err();
    // a program of one's own may have started them
    let refused = failed.as_ref().and_then(std::error::Error::source);
    let message = |cause| format!("the system starts no thread: {cause}; RAYON_NUM_THREADS sets a number of them");
    refused.map_or(Ok(()), |cause| Err(Failure::run(message(cause))))
}

/// A command line with its scenes and studies.
pub struct CommandLine<'p> {
    /// As which the program was called.
    name: String,
    scenes: Vec<&'p dyn AnyScene>,
    built_in: Vec<&'static str>,
    studies: Vec<&'p dyn Study>,
    parts: OwnParts,
}

impl<'p> CommandLine<'p> {
    /// For some scenes, beside those of files.
    pub fn new(scenes: impl IntoIterator<Item = &'p dyn AnyScene>) -> Self {
        let called = std::env::args_os().next();
        let name = called.as_ref().and_then(|path| Path::new(path).file_stem()?.to_str()).unwrap_or("costate").into();
        let scenes = scenes.into_iter().collect();
        CommandLine { name, scenes, built_in: Vec::new(), studies: Vec::new(), parts: OwnParts::default() }
    }

    /// With the scenes that are [built in](built_in).
    #[must_use]
    pub fn with_built_in(mut self) -> Self {
        self.built_in = built_in::names().collect();
        self
    }

    /// With studies that `verify` measures.
    #[must_use]
    pub fn with_studies(mut self, studies: impl IntoIterator<Item = &'p dyn Study>) -> Self {
        self.studies.extend(studies);
        self
    }

    /// With parts of one's own, which scene files may have by their names.
    #[must_use]
    pub fn with_parts(mut self, parts: OwnParts) -> Self {
        self.parts = parts;
        self
    }

    /// Does what the arguments of the process ask for and returns the exit code.
    pub fn main(&self) -> ExitCode {
        let matches = wrapped(self.command()).try_get_matches();
        let arguments = matches.and_then(|matches| Arguments::from_arg_matches(&matches));
        if let (Ok(Arguments { command: Command::Verify(_) }), true) = (&arguments, self.studies.is_empty()) {
            return verify::hand_over();
        }
        let ranks = match exchange::start() {
            Ok(ranks) => ranks,
            Err(message) => {
                console::print_error(&message);
                return ExitCode::from(Failure::input(message).code);
            }
        };
        let done = match arguments {
            Ok(arguments) => self.checked().and_then(|()| self.run(&arguments.command)),
            Err(error) if exchange::is_shared() => {
                console::print_argument_error(&error);
                ranks.finish(error.exit_code() as u8, "");
                return ExitCode::from(error.exit_code() as u8);
            }
            Err(error) => error.exit(),
        };
        let failure = done.err().unwrap_or(Failure { code: 0, message: String::new() });
        if failure.code != 0 {
            console::print_error(&failure.message);
            interrupt::was_told(failure.code);
        }
        ranks.finish(failure.code, &failure.message);
        ExitCode::from(failure.code)
    }

    /// Of commands that several ranks run, each does all, but for what they share.
    fn check_ranks(&self, command: &Command) -> Result<(), Failure> {
        let is_for_ranks = |name: &str| self.studies.iter().any(|study| study.name() == name && study.is_for_ranks());
        match command {
            Command::Verify(options) if options.name.as_deref().is_some_and(is_for_ranks) => Ok(()),
            Command::Run(_) | Command::Gradient(_) | Command::Optimize(_) | Command::Sweep(_) => Ok(()),
            _ if !exchange::is_shared() => Ok(()),
            _ => Err(Failure::input("ranks share the work of run, gradient, optimize and sweep: start this without mpirun")),
        }
    }

    fn command(&self) -> clap::Command {
        let command = Arguments::command().bin_name(&self.name).display_name(&self.name).version(env!("CARGO_PKG_VERSION"));
        command.mut_subcommands(|own| {
            let examples = self.examples(own.get_name());
            own.after_help(examples)
        })
    }

    /// Scenes are found by their names.
    fn checked(&self) -> Result<(), Failure> {
        let names = self.names();
        if let Some(name) = repeated(names.iter().map(String::as_str)) {
            return Err(Failure::input(format!("two scenes of this program are named \"{name}\"")));
        }
        self.parts.check().map_err(Failure::input)
    }

    fn run(&self, command: &Command) -> Result<(), Failure> {
        self.check_ranks(command)?;
        interrupt::install()?;
        start_threads()?;
        match command {
            Command::Run(options) => run::run(options, self),
            Command::Gradient(options) => gradient::run(options, self),
            Command::Optimize(options) => optimize::run(options, self),
            Command::Fit(options) => fit::run(options, self),
            Command::Sweep(options) => sweep::run(options, self),
            Command::Modes(options) => modes::run(options, self),
            Command::Response(options) => response::run(options, self),
            Command::Verify(options) => verify::run(options, self),
            Command::Check(options) => check::run(options, self),
            Command::New(options) => new::run(options, self),
            Command::Import(options) => import::run(options, self),
            Command::Schema => check::schema(&self.parts),
            Command::List(options) => list::run(options, self),
            Command::Completions(options) => manual::complete(options, self),
            Command::Man(options) => manual::write(options, self),
        }
    }
}
