//! `costate import`: descriptions of robots of other programs as scene files.

mod robot;
mod scene_text;
mod welded;

use super::CommandLine;
use super::check::{self, CheckOptions};
use super::console::print;
use super::failure::Failure;
use crate::io::write_file;
use clap::Args;
use costate::scenes::FileScene;
use robot::Robot;
use std::path::PathBuf;

/// Options of `costate import`.
#[derive(Args)]
pub struct ImportOptions {
    /// Description of a robot (.urdf)
    file: PathBuf,
    /// Scene file to write, which must not exist [default: the description's name with .toml]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Let the root link move freely instead of holding it on the ground
    #[arg(long)]
    free: bool,
}

/// Largest description in bytes.
const LARGEST: u64 = 100_000_000;

/// Writes the scene file, says what it leaves out or changes, and checks it as `check` does.
pub fn run(options: &ImportOptions, program: &CommandLine) -> Result<(), Failure> {
    let (file, shown) = (&options.file, options.file.display());
    let told = |why: String| Failure::input(format!("import {shown}: {why}"));
    let target = options.out.clone().unwrap_or_else(|| file.with_extension("toml"));
    if target.extension().is_none_or(|ending| ending != "toml") {
        return Err(told(format!("--out {}: a scene file is named with .toml", target.display())));
    }
    if target.exists() {
        return Err(told(format!("{} exists already; name another by --out, or remove it", target.display())));
    }
    let size = std::fs::metadata(file).map_err(|error| told(format!("cannot be read: {error}")))?.len();
    if size > LARGEST {
        return Err(told(format!("it has {size} bytes, and a description has at most {LARGEST}")));
    }
    let text = std::fs::read_to_string(file).map_err(|error| told(format!("cannot be read: {error}")))?;
    let robot = Robot::parse(&text).map_err(&told)?;
    let (scene, notes) = scene_text::write(&robot, file, &target, options.free).map_err(&told)?;
    let name = target.display().to_string();
    // what this program writes it can read, or says what is wrong before there is a file
    let own = target.parent().filter(|folder| !folder.as_os_str().is_empty());
    FileScene::parse(&own.map_or_else(|| name.clone(), |folder| folder.join("import.toml").display().to_string()), &scene)
        .map_err(|why| told(format!("what was made of it is no scene: {why}")))?;
    write_file(&target, scene.as_bytes()).map_err(|error| Failure::input(error.to_string()))?;
    notes.iter().for_each(|note| print(format_args!("note: {note}")));
    let (links, joints) = (robot.links.len(), robot.joints.len());
    print(format_args!("wrote {name}: {links} links, {joints} joints; simulate it with {} run {name}", program.name));
    let checked = check::run(&CheckOptions { scene: name.clone(), json: false }, program);
    checked.map_err(|why| Failure::input(format!("{name} was written, but it cannot start as it is: {}", why.message)))
}
