//! The README and the guide say what is there: commands run, options, files and names exist, links lead somewhere.
//!
//! Programs on the pages are doc-tests; scene files on them are run by the tests of scene files.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

fn root() -> &'static Path {
    static ROOT: LazyLock<PathBuf> =
        LazyLock::new(|| Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).canonicalize().unwrap());
    &ROOT
}

/// All files below a folder whose names end so, as paths from the root.
fn files_below(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap()) {
        let path = format!("{folder}/{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            found.extend(files_below(&path, ending));
        } else if path.ends_with(ending) {
            found.push(path.into());
        }
    }
    found.sort();
    found
}

/// Names and texts of the pages.
fn pages() -> Vec<(String, String)> {
    let paths = files_below("src/guide", ".md").into_iter().chain(["README.md".into(), "src/scenes/file/format.md".into()]);
    let read = |path: PathBuf| (path.display().to_string(), fs::read_to_string(root().join(path)).unwrap());
    let pages: Vec<_> = paths.map(read).collect();
    assert!(pages.len() > 25, "only {} pages", pages.len());
    pages
}

/// Blocks of code in a language.
fn blocks<'p>(page: &'p str, language: &str) -> Vec<&'p str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

/// What stands outside of blocks of code.
fn prose(page: &str) -> String {
    page.split("```").step_by(2).collect()
}

/// What stands in backticks outside of blocks of code.
fn quoted(page: &str) -> Vec<String> {
    prose(page).split('`').skip(1).step_by(2).map(String::from).collect()
}

/// Words of a command, of which some stand in quotes.
fn words(line: &str) -> Vec<String> {
    let pieces = line.split('"').enumerate();
    let mut words: Vec<String> = vec![String::new()];
    for (place, piece) in pieces {
        let mut parts = if place % 2 == 1 { vec![piece] } else { piece.split(' ').collect() }.into_iter();
        words.last_mut().unwrap().push_str(parts.next().unwrap_or_default());
        words.extend(parts.map(String::from));
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Arguments of `costate` in a line, if it calls it.
fn arguments(line: &str) -> Option<Vec<String>> {
    let line = line.split("    #").next().unwrap();
    let call = ["costate ", "cargo run --release -- "].iter().find_map(|start| line.strip_prefix(start));
    call.map(words)
}

fn costate(folder: &Path, arguments: &[String]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_costate")).current_dir(folder).args(arguments).output().unwrap()
}

/// Whether a command takes longer than a test should: studies, optimizations without a limit, and large scenes.
fn is_long(arguments: &[String]) -> bool {
    let has = |own: &str| arguments.iter().any(|argument| argument == own);
    let unlimited = arguments[0] == "optimize" && !has("--iterations") && !has("arm.toml");
    arguments[0] == "verify" || unlimited || has("suspension") || has("box-tube-pendulum")
}

#[test]
fn commands_on_the_pages_run() {
    let folder = std::env::temp_dir().join(format!("costate-guide-{}", std::process::id()));
    let (mut studies, mut run) = (BTreeSet::new(), 0);
    for (name, page) in pages() {
        // each page for itself, in the order of its lines
        let here = folder.join(name.replace('/', "-"));
        fs::create_dir_all(&here).unwrap();
        if blocks(&page, "sh").iter().any(|block| block.contains("arm.toml") && !block.contains("new arm.toml")) {
            assert!(costate(&here, &["new".into(), "arm.toml".into()]).status.success());
        }
        let lines: Vec<Vec<String>> = blocks(&page, "sh").into_iter().flat_map(str::lines).filter_map(arguments).collect();
        for own in lines {
            let done = if is_long(&own) {
                studies.extend((own[0] == "verify").then(|| own[1].clone()));
                // what is wrong with an argument is said before the help
                costate(&here, &[own.clone(), vec!["--help".into()]].concat())
            } else {
                run += 1;
                costate(&here, &own)
            };
            let said = String::from_utf8_lossy(&done.stderr).into_owned();
            // a few iterations end at their limit, which has a code of its own
            let is_limited =
                own[0] == "optimize" && own.contains(&"--iterations".to_string()) && done.status.code() == Some(3);
            assert!(done.status.success() || is_limited, "{name}: costate {}: {said}", own.join(" "));
        }
    }
    fs::remove_dir_all(&folder).unwrap();
    assert!(run > 20, "only {run} commands");
    let is_study = |study: &&String| root().join("verification").join(study).join("study.rs").is_file();
    let unknown: Vec<_> = studies.iter().filter(|study| !is_study(study)).collect();
    assert!(studies.len() > 10 && unknown.is_empty(), "no studies: {unknown:?}");
}

#[test]
fn options_on_the_pages_exist() {
    let commands = ["run", "gradient", "optimize", "fit", "sweep", "modes", "verify", "check", "list", "import", "response"];
    let help: String = commands
        .iter()
        .map(|command| String::from_utf8(costate(root(), &[command.to_string(), "--help".into()]).stdout).unwrap())
        .collect();
    for (name, page) in pages() {
        for own in quoted(&page).iter().filter_map(|own| own.strip_prefix("--")) {
            let option = own.split([' ', '=']).next().unwrap();
            let of_cargo = ["features", "release", "open", "example", "help"].contains(&option);
            let listed = || help.split_whitespace().any(|word| word == format!("--{option}"));
            assert!(of_cargo || listed(), "{name}: there is no option --{option}");
        }
    }
}

#[test]
fn files_on_the_pages_exist() {
    for (name, page) in pages() {
        for own in quoted(&page) {
            let is_path = own.contains('/') && !own.contains([' ', '*', '(', '"', '<']);
            let known = ["src/", "tests/", "examples/", "verification/", ".ci/"].iter().any(|start| own.starts_with(start));
            if is_path && known && !own.contains("NAME") {
                assert!(root().join(&own).exists(), "{name}: there is no {own}");
            }
        }
    }
}

#[test]
fn names_on_the_pages_are_those_of_the_source() {
    let sources: String = ["src", "verification"]
        .iter()
        .flat_map(|folder| [files_below(folder, ".rs"), files_below(folder, ".py")].concat())
        .map(|path| fs::read_to_string(root().join(path)).unwrap())
        .collect();
    let known: BTreeSet<&str> = sources.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let is_name = |own: &str| {
        let head = own.chars().next().is_some_and(|c| c.is_alphabetic());
        head && own.chars().all(|c| c.is_alphanumeric() || c == '_')
            && (own.contains('_') || own.chars().any(char::is_uppercase))
    };
    let mut count = 0;
    for (name, page) in pages() {
        for own in quoted(&page) {
            // `Settings::statics(10)`: both words
            let head = own.split('(').next().unwrap().trim_start_matches('.');
            let parts: Vec<&str> = head.split("::").flat_map(|part| part.split('.')).collect();
            let is_command = own.contains([' ', '/', '-']) || own.ends_with(".md");
            if is_command
                || !parts.iter().all(|part| part.is_empty() || part.chars().all(|c| c.is_alphanumeric() || c == '_'))
            {
                continue;
            }
            for part in parts.into_iter().filter(|part| is_name(part)) {
                count += 1;
                let of_others = ["SCENE", "RAYON_NUM_THREADS", "pandas", "read_feather", "read_ipc", "rc"].contains(&part);
                // symbols of mechanics: E_rs, A_33
                let is_symbol = part.len() <= 5;
                assert!(of_others || is_symbol || known.contains(part), "{name}: nothing is called {part} (in `{own}`)");
            }
        }
    }
    assert!(count > 100, "only {count} names");
}

/// The anchor of a heading.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Definitions of reference links: labels in small letters, and where they lead.
fn definitions(text: &str) -> BTreeMap<String, String> {
    let definition = |line: &str| -> Option<(String, String)> {
        let (label, target) = line.strip_prefix('[')?.split_once("]: ")?;
        Some((label.to_lowercase(), target.to_string()))
    };
    text.lines().filter_map(definition).collect()
}

/// The file and the heading that a link on a page leads to.
fn destination(page: &str, target: &str) -> (PathBuf, String) {
    let (path, heading) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() { page.into() } else { Path::new(page).parent().unwrap().join(path) };
    let file = root().join(file).canonicalize().unwrap_or_else(|_| panic!("{page}: there is no {target}"));
    let text = if heading.is_empty() { String::new() } else { fs::read_to_string(&file).unwrap() };
    let found = prose(&text).lines().any(|line| line.starts_with('#') && anchor(line) == heading);
    assert!(heading.is_empty() || found, "{page}: no heading for {target}");
    (file, heading.into())
}

/// Whether a link of rustdoc leads to what a file says under a heading.
fn is_same(path: &str, file: &Path, heading: &str) -> bool {
    let (path, own) = path.split_once('#').unwrap_or((path, ""));
    let parts: Vec<&str> = path.split("::").skip(1).collect();
    let (last, module) = (parts[parts.len() - 1], root().join("src").join(parts.join("/")));
    let places = match parts[..] {
        ["guide", ..] => vec![module.with_extension("md"), module.join("index.md")],
        ["scenes", "file"] => vec![module.join("format.md"), module.join("reference.md")],
        _ if module.with_extension("rs") == file => vec![file.into()],
        _ => {
            // the source that declares it
            let text = fs::read_to_string(file).unwrap();
            let kinds = ["struct", "enum", "trait", "fn", "const", "static"].map(|kind| format!("pub {kind} {last}"));
            // a field, or a list of entries
            let names = [format!("pub {last}: "), format!("    {last}:\n")];
            let declared = kinds.iter().chain(&names).any(|words| text.contains(words));
            vec![if declared { file.into() } else { PathBuf::new() }]
        }
    };
    own == heading && places.iter().any(|place| place == file)
}

/// A text without what stands in backticks, unless it is what a link shows.
fn with_links(text: &str) -> String {
    let pieces: Vec<&str> = text.split('`').collect();
    let is_link = |place: usize| pieces[place - 1].ends_with('[') && pieces[place + 1].starts_with(']');
    let kept = |(place, piece): (usize, &&str)| match place % 2 {
        1 if is_link(place) => format!("`{piece}`"),
        1 => String::new(),
        _ => piece.to_string(),
    };
    pieces.iter().enumerate().map(kept).collect()
}

/// Whether a text has a link by a label, and not only one with a label or a place of its own behind it.
fn is_used(label: &str, text: &str) -> bool {
    let label = format!("[{label}]");
    text.match_indices(&label).any(|(place, _)| !text[place + label.len()..].starts_with(['[', '(']))
}

#[test]
fn links_lead_to_the_same_on_a_page_of_the_repository_and_in_rustdoc() {
    let of_rustdoc = definitions(&fs::read_to_string(root().join("src/guide/links.txt")).unwrap());
    let reference = "src/scenes/file/reference.md";
    let (mut used, mut count) = (BTreeSet::new(), 0);
    for (name, page) in pages().into_iter().chain([(reference.into(), fs::read_to_string(root().join(reference)).unwrap())])
    {
        let own = definitions(&page);
        let (_, text): (Vec<_>, Vec<_>) = page.lines().partition(|line| !definitions(line).is_empty());
        let text = with_links(&prose(&text.join("\n"))).to_lowercase();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            // rustdoc has no files beside the page
            assert!(target.starts_with('#') || name == "README.md", "{name}: [..]({target}) leads nowhere in rustdoc");
            destination(&name, target);
            count += 1;
        }
        for (label, path) in &of_rustdoc {
            if !is_used(label, &text) {
                continue;
            }
            let target = own.get(label).unwrap_or_else(|| panic!("{name}: [{label}] is not defined at its end"));
            let (file, heading) = destination(&name, target);
            assert!(is_same(path, &file, &heading), "{name}: [{label}] leads to {target}, but in rustdoc to {path}");
            used.insert(label.clone());
            count += 1;
        }
        for (label, target) in &own {
            assert!(!target.contains("::"), "{name}: {target} leads nowhere on a page of the repository");
            assert!(of_rustdoc.contains_key(label), "{name}: [{label}] is not in links.txt");
            assert!(is_used(label, &text), "{name}: nothing leads to [{label}]");
        }
    }
    assert!(count > 150, "only {count} links");
    assert!(of_rustdoc.keys().all(|label| used.contains(label)), "links.txt has links that no page uses");
}

#[test]
fn every_page_has_an_address() {
    let modules = fs::read_to_string(root().join("src/guide/mod.rs")).unwrap();
    let listed = |folder: &str, stem: &str| {
        let list = modules.split(&format!("pages!(\"{folder}\":")).nth(1).and_then(|rest| rest.split(')').next());
        list.is_some_and(|list| list.split_whitespace().any(|word| word == stem))
    };
    for page in files_below("src/guide", ".md") {
        let page = page.strip_prefix("src/guide").unwrap().display().to_string();
        let (folder, stem) = page.trim_end_matches(".md").split_at(page.rfind('/').map_or(0, |end| end + 1));
        let included = modules.contains(&format!("include_str!(\"{page}\")"));
        assert!(included || listed(folder, stem), "src/guide/{page} is on no page of the documentation");
    }
}

#[test]
fn the_readme_is_one_page_and_its_program_an_example() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let lines = readme.lines().count();
    assert!(lines <= 90, "{lines} lines");
    let example = fs::read_to_string(root().join("examples/01_gradient.rs")).unwrap();
    let program = blocks(&readme, "rust");
    assert_eq!(program.len(), 1);
    let code = example.split_once("\n\n").unwrap().1;
    assert_eq!(program[0], code, "the program of the README is that of examples/01_gradient.rs");
}

#[test]
fn the_pages_claim_of_drawn_scenes_what_was_recorded() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap_or_default();
    let record = read("verification/random-scenes/result.md");
    let claim = record.lines().find(|line| line.starts_with("Of ") && line.contains(" motions drawn by lot"));
    for page in ["README.md", "src/guide/measured.md"] {
        let text = read(page).split_whitespace().collect::<Vec<_>>().join(" ");
        match claim {
            Some(claim) => assert!(text.contains(claim), "{page} must say: {claim}"),
            None => assert!(!text.contains(" motions drawn by lot"), "{page} claims what no record has"),
        }
    }
}
