//! A part is described in one file: how many others name it.

use std::path::{Path, PathBuf};

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("readable").path()) {
        if entry.is_dir() {
            files(&entry, found);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push(entry);
        }
    }
}

/// Files of some folders that have one of some words, but one; scenes use parts, and describe none.
fn places(folders: &[&str], own: &str, words: &[&str]) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    folders.iter().for_each(|folder| files(&root.join(folder), &mut all));
    let own = root.join(own);
    assert!(all.contains(&own), "{} is not there", own.display());
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    let names = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("readable");
        words.iter().any(|word| {
            text.match_indices(word)
                .any(|(at, _)| !text[..at].ends_with(letter) && !text[at + word.len()..].starts_with(letter))
        })
    };
    let others = all.iter().filter(|path| **path != own);
    let others = others.filter(|path| path.file_name().is_none_or(|name| name != "places.rs"));
    others.filter(|path| names(path)).map(|path| path.display().to_string()).collect()
}

#[test]
fn few_files_name_a_part_outside_its_own() {
    let everywhere = ["src", "tests", "verification", "examples"];
    for (folders, own, words, most) in [
        (&everywhere[..], "src/elements/joints/universal.rs", &["UniversalJoint"][..], 2),
        (&everywhere, "src/elements/forces/torsion_spring_damper.rs", &["TorsionSpringDamper"], 2),
        (&everywhere, "src/functionals/quantities/joint_rate.rs", &["JointRate"], 2),
        // tests and studies use loads, what rolls, sections and integrators by their names
        (&everywhere[..1], "src/elements/forces/applied_force.rs", &["AppliedForce"], 1),
        (&everywhere[..1], "src/elements/flexible/shell_pressure.rs", &["PressureOnFace"], 2),
        (&everywhere[..1], "src/elements/joints/rolling.rs", &["RollingSphere"], 1),
        (&everywhere[..1], "src/elements/flexible/section.rs", &["tube(", "\"tube\""], 0),
        (&everywhere[..1], "src/elements/time_function.rs", &["\"smooth_ramp\""], 0),
        // a message names it as the remedy for stiff forces
        (&everywhere[..1], "src/integrators/tables/dirk.rs", &["sdirk4"], 4),
        (
            &everywhere[..1],
            "src/scenes/file/functionals/of_sections.rs",
            &["\"largest_cable_stress\"", "\"cable_curvature\""],
            0,
        ),
        (&everywhere[..1], "src/scenes/file/functionals/of_elements.rs", &["\"tsai_wu\""], 0),
        // the list of sections that have elements
        (&everywhere[..1], "src/scenes/file/parts/thin_walls.rs", &["\"thin_walls\""], 1),
        (&everywhere[..1], "src/scenes/file/parts/rigid_interface.rs", &["\"rigid_interface\""], 0),
    ] {
        let named = places(folders, own, words);
        assert!(named.len() <= most, "{words:?} stands in {} files beside {own}: {}", named.len(), named.join(", "));
        println!("{}: {}", words[0], named.len());
    }
}
