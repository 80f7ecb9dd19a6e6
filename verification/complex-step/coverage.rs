//! Whether every type of `src/elements` is the subject of a scene.

use super::scenes::Case;
use std::collections::BTreeSet;

/// Where elements, fields, constraints, nonholonomic constraints, drivers and forces are listed.
const LISTS: [&str; 4] = [
    include_str!("../../src/elements/bodies/mod.rs"),
    include_str!("../../src/elements/flexible/mod.rs"),
    include_str!("../../src/elements/forces/mod.rs"),
    include_str!("../../src/elements/joints/mod.rs"),
];

/// Names of options and of entries there, which have no formula of their own.
const OPTIONS: [&str; 26] = [
    "AngleLaw",
    "CableSection",
    "CableHinge",
    "CableStrain",
    "CableWeld",
    "FaceKind",
    "Freedom",
    "HeldSlope",
    "Laminate",
    "LineLaw",
    "LoadFrame",
    "Material",
    "OfShape",
    "Outline",
    "OutlineStress",
    "Ply",
    "PlyStrength",
    "PressureOnFace",
    "Section",
    "Shape",
    "ShellKind",
    "ShellPoint",
    "ShellSection",
    "SlideLaw",
    "Stretch",
    "TorsionLaw",
];

/// What acts in the equilibrium alone at which a motion begins: no scene of this study begins at one, files of the tests do, and have their gradients
/// held to complex steps (`tests/scene_files/coverage/equilibrium.toml`).
const AT_REST: [&str; 1] = ["HeldNode"];

/// Friction, whose motions have events: files of the tests and the study of events have their gradients held to complex steps
/// (`tests/scene_files/coverage/friction.toml`).
const OF_FRICTION: [&str; 7] =
    ["Apart", "JointSurfaces", "SoftContact", "SphereFriction", "SpheresFriction", "Surfaces", "Touching"];

/// The names that a file hands on: the last one of each path of a `pub use`, over as many lines as it takes.
fn names_of(file: &str) -> impl Iterator<Item = &str> {
    let uses = file.split(';').filter_map(|statement| {
        let (before, paths) = statement.rsplit_once(" use ")?;
        before.lines().last()?.trim().starts_with("pub").then_some(paths)
    });
    let paths = uses.flat_map(|paths| paths.split(['{', '}', ',']));
    paths.map(|path| path.trim().rsplit("::").next().unwrap_or(path))
}

/// The last names of all paths in that of a type, those of its arguments included.
fn names_in(type_name: &str) -> impl Iterator<Item = &str> {
    type_name.split(['<', '>', ',', ' ']).filter_map(|path| path.rsplit("::").next()).filter(|name| !name.is_empty())
}

/// All names, and those among them that no scene has as its subject.
pub fn missing(cases: &[Case]) -> (usize, Vec<&'static str>) {
    let subjects: Vec<&'static str> = cases.iter().flat_map(Case::types).collect();
    let seen: BTreeSet<&str> = subjects.iter().flat_map(|name| names_in(name)).collect();
    let is_type = |name: &&str| {
        let is_named = name.starts_with(char::is_uppercase) && name.contains(char::is_lowercase);
        is_named && !OPTIONS.contains(name) && !AT_REST.contains(name) && !OF_FRICTION.contains(name)
    };
    let all: Vec<&str> = LISTS.iter().flat_map(|file| names_of(file)).filter(is_type).collect();
    // a flexible element is an alias for its field at points of interpolation
    let covered = |name: &&&str| seen.contains(**name) || seen.contains(format!("{name}Field").as_str());
    let missing = all.iter().filter(|name| !covered(name)).copied().collect();
    (all.len(), missing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complex_step::scenes;

    #[test]
    fn every_element_and_constraint_is_the_subject_of_a_scene() {
        let (count, missing) = missing(&scenes::list());
        assert!(count >= 40, "{count} names were read");
        assert_eq!(missing, Vec::<&str>::new());
    }

    #[test]
    fn a_subject_that_is_taken_off_the_list_is_missed() {
        let mut cases = scenes::list();
        cases.retain(|case| !case.name.starts_with("cable-end"));
        assert_eq!(missing(&cases).1, ["CableEnd"]);
    }
}
