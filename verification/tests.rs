//! The list of studies is that of the folders, and what is asked for by another name is told.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn verify(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_costate-verify")).arg("verify").args(arguments).output().unwrap()
}

#[test]
fn each_folder_with_a_study_is_listed_with_what_it_shows() {
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).read_dir().unwrap().map(|own| own.unwrap().path());
    let folders: BTreeSet<String> = folders
        .filter(|path| path.join("study.rs").is_file())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_string())
        .collect();
    let said = String::from_utf8(verify(&["--json"]).stdout).unwrap();
    let list: serde_json::Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    let studies = list["studies"].as_array().unwrap();
    let names: BTreeSet<String> = studies.iter().map(|own| own["study"].as_str().unwrap().to_string()).collect();
    assert_eq!(names, folders);
    for study in studies {
        assert!(said.contains(study["summary"].as_str().unwrap()), "{study}");
    }
}

#[test]
fn studies_and_forms_that_are_not_there_are_told() {
    let cases: [(&[&str], &str); 2] = [
        (&["no-such-study"], "study \"no-such-study\" is not known"),
        (&["orders", "--long"], "\"orders\" has no long form; these have one: "),
    ];
    for (arguments, expected) in cases {
        let ended = verify(arguments);
        let said = String::from_utf8(ended.stderr).unwrap();
        assert!(ended.status.code() == Some(2) && said.contains(expected), "{said}");
    }
}
