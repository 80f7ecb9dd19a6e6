//! The tree is the way of the data: a folder of `src` uses only folders before it.

use std::path::Path;

const ORDER: [&str; 13] = [
    "program",
    "design",
    "elements",
    "linalg",
    "assembly",
    "integrators",
    "history",
    "functionals",
    "sensitivity",
    "scenes",
    "optimize",
    "cli",
    "guide",
];

fn check(folder: &Path, place: usize, violations: &mut Vec<String>, files: &mut usize) {
    for entry in std::fs::read_dir(folder).expect("a folder of src").map(|entry| entry.expect("readable").path()) {
        if entry.is_dir() {
            check(&entry, place, violations, files);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            *files += 1;
            let text = std::fs::read_to_string(&entry).expect("readable");
            for (line, code) in text.lines().enumerate().filter(|(_, code)| !code.trim_start().starts_with("//")) {
                for used in code.split("crate::").skip(1) {
                    let module: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                    if ORDER.iter().position(|&name| name == module).is_some_and(|used| used > place) {
                        violations.push(format!("{}:{}: uses {module}", entry.display(), line + 1));
                    }
                }
            }
        }
    }
}

#[test]
fn folders_use_only_folders_before_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut violations, mut files) = (Vec::new(), 0);
    for (place, name) in ORDER.iter().enumerate() {
        check(&source.join(name), place, &mut violations, &mut files);
    }
    assert!(files > 50, "only {files} files were read");
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn every_folder_is_on_the_list() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in
        std::fs::read_dir(source).expect("src").map(|entry| entry.expect("readable").path()).filter(|path| path.is_dir())
    {
        let name = entry.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_string();
        // the package for Python is a crate of its own
        assert!(ORDER.contains(&name.as_str()) || name == "python", "src/{name} has no place in the way of the data");
    }
}
