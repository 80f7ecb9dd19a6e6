//! Words for people on stdout, one JSON object behind them, messages on stderr; of several ranks the first one says them.

use costate::exchange::is_first;
use serde_json::Value;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Prints a line to stdout.
///
/// A reader that has gone away (`costate list | head -1`) is no reason to stop; a full disk is.
pub fn print(line: impl Display) {
    if !is_first() {
        return;
    }
    match writeln!(io::stdout(), "{line}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            print_error(&format!("cannot write to stdout: {error}"));
            std::process::exit(1);
        }
        _ => {}
    }
}

/// Prints which files were written, and of a page what to do with it.
pub fn print_files(files: &[impl AsRef<Path>]) {
    for file in files.iter().map(AsRef::as_ref) {
        let is_page = file.extension().is_some_and(|ending| ending == "html");
        let hint = if is_page { ": open it in a browser" } else { "" };
        print(format_args!("wrote {}{hint}", file.display()));
    }
}

/// Prints help, or what is wrong with the arguments.
pub fn print_argument_error(error: &clap::Error) {
    if is_first() {
        let _ = error.print();
    }
}

/// Prints the message with which the program ends.
pub fn print_error(message: &str) {
    print_to_stderr(&format!("error: {message}\n"));
}

/// Prints what a user should know about results that stand.
pub fn warn(message: &str) {
    print_to_stderr(&format!("warning: {message}\n"));
}

/// Writes a line to stderr at once: what others write in the meantime, as `mpirun` does, is not in the middle of it.
fn print_to_stderr(line: &str) {
    if is_first() {
        // nobody is left to tell if stderr is gone, too
        let _ = io::stderr().write_all(line.as_bytes());
    }
}

/// Prints the JSON object as the last line of stdout if it was asked for.
pub fn print_json(wanted: bool, object: &Value) {
    if wanted {
        print(object);
    }
}

/// A difference in two digits, zero as 0.
pub fn brief(difference: f64) -> String {
    if difference == 0.0 { "0".into() } else { format!("{difference:.1e}") }
}

/// Seconds as people read them.
pub fn seconds(value: f64) -> String {
    match value {
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.3} ms", s * 1e3),
        s => format!("{s:.3} s"),
    }
}

/// Singular or plural, with the count.
pub fn count(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}
/// Relative change of a functional by a relative change of a variable, (x / f) df/dx; none where x or f is zero.
pub fn relative_effect(x: f64, derivative: f64, value: f64) -> Option<f64> {
    (x != 0.0 && value != 0.0).then_some(x * derivative / value)
}
