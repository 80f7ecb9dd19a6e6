//! Files that extend others, and whole numbers of `[define]` in loops.

use super::refused;
use costate::scenes::{AnyScene, FileScene, Prepared};
use std::path::{Path, PathBuf};

/// Masses on springs, as many as a number says.
const CHAIN: &str = r#"version = 1
name = "chain"
summary = "masses on springs"
settings = { end = 0.1, steps = 10 }

[variable]
stiffness = { count = "n", initial = 40, bounds = [1, 100], unit = "N/m" }

[define]
n = 2
last = "n - 1"

[[point]]
name = "mass {i}"
for = { i = { from = 0, to = "n - 1" } }
position = ["{i + 1}", 0, 0]
velocity = [0, 0, "0.1 * {i + n}"]
mass = 1

[[spring]]
name = "spring {i}"
for = { i = { from = 0, to = "last" } }
type = "line"
between = ["ground", "mass {i}"]
stiffness = "stiffness[{i}]"
rest_length = 0.5

[[functional]]
name = "height"
type = "position"
on = "mass 1"
direction = [0, 0, 1]
over = "terminal"
"#;

/// A folder with the chain in it.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("chain.toml"), CHAIN).unwrap();
    folder
}

/// A file of a folder with a text in it.
fn with_text(folder: &Path, name: &str, text: &str) -> Result<FileScene, String> {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    FileScene::read(&path)
}

fn values(scene: &FileScene) -> Vec<f64> {
    let prepared = Prepared::new(scene).unwrap();
    prepared.analysis().forward(&prepared.x).unwrap().values
}

/// What a file says goes into what it extends: numbers, entries by their names, lists behind lists; loops follow the numbers.
#[test]
fn a_file_that_extends_another_is_the_whole_file() {
    let folder = folder("extended");
    let longer = r#"version = 1
extends = "chain.toml"
define.n = 3
spring."spring {i}".rest_length = 0.25
settings.steps = 20
point = [{ name = "mass {i}", mass = 3 }, { name = "other", position = [0, 1, 0], velocity = [1, 0, 0], mass = 2 }]
functional = [{ name = "x", type = "position", on = "other", direction = [1, 0, 0], over = "terminal" }]
"#;
    let scene = with_text(&folder, "longer.toml", longer).unwrap();
    assert_eq!(scene.name(), "longer");
    assert_eq!(scene.summary(), "a scene from a file");
    assert_eq!(scene.variables().len(), 3);
    let whole = CHAIN
        .replace("n = 2", "n = 3")
        .replace("mass = 1\n", "mass = 3\n")
        .replace("rest_length = 0.5", "rest_length = 0.25")
        .replace("steps = 10", "steps = 20")
        .replace(
            "[[spring]]",
            "[[point]]\nname = \"other\"\nposition = [0, 1, 0]\nvelocity = [1, 0, 0]\nmass = 2\n\n[[spring]]",
        )
        + "\n[[functional]]\nname = \"x\"\ntype = \"position\"\non = \"other\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n";
    assert_eq!(values(&scene), values(&FileScene::parse("whole.toml", &whole).unwrap()));
    // one more step
    let last = "version = 1\nextends = \"longer.toml\"\nname = \"last\"\nsettings.steps = 10\ndefine.n = 4\n";
    let scene = with_text(&folder, "last.toml", last).unwrap();
    assert_eq!((scene.name().as_str(), scene.settings().steps, scene.variables().len()), ("last", 10, 4));
}

/// What is wrong is told where it stands, in either file.
#[test]
fn mistakes_of_both_files_are_told_in_their_own() {
    let folder = folder("extended-wrong");
    let refused = |text: &str| with_text(&folder, "own.toml", text).unwrap_err();
    let named = |file: &str| folder.join(file).display().to_string();
    let of = |own: &str| format!("version = 1\nextends = {own}\n");
    let own = refused(&(of("\"chain.toml\"") + "point.\"mass {i}\".mass = -1\n"));
    assert!(own.starts_with(&format!("{}:3:25: ", named("own.toml"))), "{own}");
    let other = refused(&(of("\"chain.toml\"") + "[[point]]\nname = \"mass 0\"\n"));
    assert!(other.contains("the name \"mass 0\" is taken"), "{other}");
    std::fs::write(folder.join("bad.toml"), CHAIN.replace("mass = 1\n", "mass = -1\n")).unwrap();
    let other = refused(&of("\"bad.toml\""));
    assert!(other.starts_with(&format!("{}:18:8: ", named("bad.toml"))), "{other}");
    std::fs::write(folder.join("no.toml"), "version = 1\n[[body]\n").unwrap();
    let other = refused(&of("\"no.toml\""));
    assert!(other.starts_with(&format!("{}:2:", named("no.toml"))) && other.contains("this is no TOML"), "{other}");
    std::fs::write(folder.join("bytes.toml"), b"name = \"\xff\"").unwrap();
    for (given, expected) in [
        ("\"own.toml\"", "own.toml:2:11: extends = \"own.toml\": the file extends itself"),
        ("\"missing.toml\"", "missing.toml: cannot be read: "),
        ("\"bytes.toml\"", "bytes.toml:1:9: this is no text in UTF-8"),
        ("\"../chain.toml\"", "extends is the text \"../chain.toml\"; it names a scene file in the same folder"),
        ("3", "own.toml:2:11: extends is the number 3; it names a scene file in the same folder"),
        ("\"\"", "it names a scene file in the same folder"),
    ] {
        let why = refused(&of(given));
        assert!(why.contains(expected), "{why}");
    }
    let why = refused(&(of("\"chain.toml\"") + "[[scenario]]\nname = \"a\"\nextends = \"chain.toml\"\n"));
    assert!(why.contains("extends is the same in all scenarios"), "{why}");
    std::fs::write(folder.join("circle.toml"), of("\"own.toml\"")).unwrap();
    let why = refused(&of("\"circle.toml\""));
    assert!(why.starts_with(&format!("{}:2:11: ", named("circle.toml"))) && why.contains("extends itself"), "{why}");
}

/// Loops and braces take whole numbers only, and those that the file defines.
#[test]
fn loops_say_which_numbers_they_know() {
    for (from, to, expected) in [
        ("n = 2", "n = 2.5", "for: i is a table"),
        ("to = \"n - 1\"", "to = \"n / 3\"", "for: i is a table"),
        ("to = \"n - 1\"", "to = \"stiffness[0]\"", "for: i is a table"),
        ("\"0.1 * {i + n}\"", "\"0.1 * {i + m}\"", "name \"m\" is not known"),
        ("\"0.1 * {i + n}\"", "\"0.1 * {i + n / 3}\"", "must be a whole number"),
    ] {
        let text = CHAIN.replacen(from, to, 1);
        assert_ne!(text, CHAIN, "{from}");
        let why = refused(&text);
        assert!(why.contains(expected), "{to}: {why}");
    }
}
