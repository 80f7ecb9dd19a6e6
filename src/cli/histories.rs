//! Where runs keep their steps.

use super::failure::Failure;
use costate::history::Keep;
use std::path::Path;

/// What `--history` and `--resume` say together.
pub fn resumed(keep: Keep, resume: bool) -> Result<Keep, Failure> {
    match keep {
        keep if !resume => Ok(keep),
        Keep::File(path) => Ok(Keep::Resumed(path)),
        _ => Err(Failure::input("--resume goes on with a run in a file: name it, as in --history file:run.history")),
    }
}

pub fn keep(text: &str) -> Result<Keep, String> {
    let megabytes = |text: &str| text.parse::<f64>().ok().filter(|size| *size > 0.0 && size.is_finite());
    match text.split_once(':') {
        None if text == "auto" => return Ok(Keep::Auto),
        None if text == "memory" => return Ok(Keep::Memory),
        Some(("file", path)) if !path.is_empty() => return Ok(Keep::File(path.into())),
        Some(("checkpoints", size)) => {
            // a float to an integer saturates
            if let Some(size) = megabytes(size) {
                return Ok(Keep::Checkpoints((size * 1e6) as usize));
            }
        }
        _ => {}
    }
    Err("it must be auto, memory, file:PATH, or checkpoints:MEGABYTES with a number above 0".into())
}

/// Endings of the files that this program writes for people and other programs.
const RESULTS: [&str; 5] = ["arrow", "csv", "html", "json", "svg"];

/// Refuses to keep the steps of several runs in one file, or where a result of the same run will stand.
pub fn check_history(keep: &Keep, runs: usize, folder: &Path) -> Result<(), Failure> {
    let (Keep::File(path) | Keep::Resumed(path)) = keep else { return Ok(()) };
    let is_result = path.extension().is_some_and(|ending| RESULTS.iter().any(|result| ending == *result));
    let why = match runs {
        2.. => format!("each of {runs} scenarios wants a file of its own: choose one with --scenario"),
        _ if is_result && path.parent() == Some(folder) => {
            "results are written there; name a file with another ending".into()
        }
        _ => return Ok(()),
    };
    Err(Failure::input(format!("--history file:{}: {why}", path.display())))
}
