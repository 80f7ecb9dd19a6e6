//! The scenes of `examples/scenes` with the files that they name: compiled in, and read when they are asked for.
//!
//! ```
//! use costate::prelude::*;
//! use costate::scenes::{AnyScene, built_in};
//!
//! let five_bar = Prepared::new(built_in::named("five-bar")?)?;
//! let run = five_bar.run()?;
//! println!("psi = {:.6}", run.value("psi")?);
//! // with changes, in the words of a file that extends it
//! let shorter = built_in::changed("five-bar", "settings = { end = 1.0, steps = 100 }")?;
//! assert_eq!(shorter.settings().end, 1.0);
//! # Ok::<(), RunError>(())
//! ```

use super::{FileScene, unknown};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The folder in which these files stand, as messages call it.
const FOLDER: &str = "<built-in>";
/// How the names of scene files end.
const SCENE: &str = ".toml";

macro_rules! files {
    ($($file:literal)*) => {
        &[$(($file, include_bytes!(concat!("../../examples/scenes/", $file)))),*]
    };
}

/// Files by their names, scenes in the order in which they are listed.
const FILES: &[(&str, &[u8])] = files!(
    "pendulum.toml" "double-pendulum.toml" "free-body.toml" "heavy-top.toml" "five-bar.toml" "slider-crank.toml"
    "car-axis.toml" "two-four-bar.toml" "andrews.toml" "bricard.toml" "universal-shaft.toml" "spatial-slider-crank.toml"
    "screw.toml" "gear-train.toml" "flyball-governor.toml" "delta-robot.toml" "controlled-arm.toml" "quarter-car.toml"
    "tyre.toml" "flexible-four-bar.toml" "stressed-four-bar.toml" "flexible-pendulum.toml" "plate-pendulum.toml"
    "box-tube-pendulum.toml" "stiffened-plate.toml" "bracket.toml" "bracket.msh" "perforated-plate.toml"
    "perforated-plate.msh" "rigid-spring-beam.toml" "suspension.toml" "princeton-beam.toml" "spin-up-beam.toml"
    "flying-rod.toml" "right-angle-cantilever.toml" "chain-common.toml" "chain-separate.toml" "von-mises-truss.toml"
    "air-loads.toml" "rotor.toml" "ground-resonance.toml" "rotor-hub.toml" "rotor-hub-flight.toml" "road.csv"
    "bouncing-ball.toml" "knee-stop.toml" "latching-panel.toml" "pendulum-lets-go.toml" "crane-rope.toml"
    "mode-controller.toml" "escapement.toml" "billiards.toml" "cam.toml" "gripper.toml"
    "slider-crank-clearance.toml" "walking-toy.toml" "damped-oscillator.toml" "damped-oscillator.csv"
);

/// Names of the scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().filter_map(|(file, _)| file.strip_suffix(SCENE))
}

/// A scene by its name.
///
/// # Errors
/// A name that none of them has, with the nearest one.
pub fn named(name: &str) -> Result<&'static FileScene, String> {
    static READ: [OnceLock<Result<FileScene, String>>; FILES.len()] = [const { OnceLock::new() }; FILES.len()];
    let place = place_of(name)?;
    let read = READ[place].get_or_init(|| FileScene::read(&Path::new(FOLDER).join(FILES[place].0)));
    read.as_ref().map_err(String::clone)
}

/// A scene with changes, in the words of a scene file that [extends](super::file#a-file-that-extends-another) it.
///
/// # Errors
/// A name that no scene has, and what is wrong in the changes.
pub fn changed(name: &str, changes: &str) -> Result<FileScene, String> {
    place_of(name)?;
    let text = format!("version = 1\nextends = \"{name}{SCENE}\"\nname = \"{name}\"\n{changes}");
    FileScene::parse(&format!("{FOLDER}/{name}, changed{SCENE}"), &text)
}

/// The place of a scene's file.
fn place_of(name: &str) -> Result<usize, String> {
    let place = FILES.iter().position(|(file, _)| file.strip_suffix(SCENE) == Some(name));
    place.ok_or_else(|| unknown("built-in scene", name, &names().map(String::from).collect::<Vec<_>>()))
}

/// What stands in a file, if it is one of these.
pub(super) fn bytes_of(path: &Path) -> Option<&'static [u8]> {
    FILES.iter().find(|(file, _)| path == PathBuf::from(FOLDER).join(file)).map(|own| own.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::AnyScene;

    #[test]
    fn all_files_of_the_folder_are_built_in_and_have_the_names_of_their_scenes() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        // what meshes are made of
        let files = files.filter(|file| !file.ends_with(".geo"));
        let (mut found, mut listed): (Vec<String>, Vec<String>) =
            (files.collect(), FILES.iter().map(|own| own.0.into()).collect());
        found.sort();
        listed.sort();
        assert_eq!(listed, found);
        for name in names() {
            assert_eq!(named(name).unwrap_or_else(|why| panic!("{why}")).name(), name);
        }
        assert!(named("six-bar").unwrap_err().contains("five-bar"));
    }
}
