use super::CommandLine;
use super::console::print;
use super::failure::Failure;
use crate::io::write_file;
use clap::Args;
use std::path::PathBuf;

/// Options of `costate new`.
#[derive(Args)]
pub struct NewOptions {
    /// Path of the new scene file (.toml), which must not exist
    file: PathBuf,
}

/// A flexible arm with a word about each section.
const START: &str = include_str!("new_scene.toml");

/// `costate new`: writes a scene file to start from.
pub fn run(options: &NewOptions, program: &CommandLine) -> Result<(), Failure> {
    let path = options.file.as_path();
    let shown = path.display();
    if path.extension().is_none_or(|ending| ending != "toml") {
        return Err(Failure::input(format!("new {shown}: a scene file is named with .toml, as in new arm.toml")));
    }
    if path.exists() {
        return Err(Failure::input(format!("new {shown}: the file exists already; name another, or remove it")));
    }
    // commands in its head are those of this program for this file
    let lines = START.lines().map(|line| match line.strip_prefix("#   ") {
        Some(command) => format!("#   {} {}\n", program.name, command.replace("NAME.toml", &shown.to_string())),
        None => format!("{line}\n"),
    });
    write_file(path, lines.collect::<String>().as_bytes()).map_err(|error| Failure::input(error.to_string()))?;
    print(format_args!("wrote {shown}: simulate it with {} run {shown}", program.name));
    Ok(())
}
