//! Parameter studies as users meet them: the bits of single runs on any number of threads, rows that survive, messages.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// An empty folder of its own for one test, removed when dropped; the program runs inside it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("costate-sweep-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
        command.args(arguments).current_dir(&self.0);
        command
    }

    /// Output of a command that ends with a code.
    fn run(&self, code: i32, arguments: &[&str]) -> Output {
        let output = self.command(arguments).output().expect("it runs");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", text(&output.stderr));
        output
    }

    fn read(&self, file: &str) -> String {
        fs::read_to_string(self.0.join(file)).expect("a file")
    }

    fn write(&self, file: &str, text: &str) {
        fs::write(self.0.join(file), text).expect("written");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

fn json(output: &Output) -> Value {
    serde_json::from_str(text(&output.stdout).lines().last().expect("a line")).expect("an object")
}

/// Numbers behind the word "value" in the last line, to the last bit: the parser of JSON here rounds otherwise.
fn values(output: &Output) -> Vec<f64> {
    let text = text(&output.stdout);
    let words = text.lines().last().expect("a line").split("\"value\":").skip(1);
    words.map(|word| number(word.split([',', '}']).next().expect("a word"))).collect()
}

/// Header and rows of a table.
fn table(text: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut lines = text.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    (lines.next().expect("a header"), lines.collect())
}

fn number(word: &str) -> f64 {
    word.parse().expect("a number")
}

const PENDULUM: [&str; 9] =
    ["sweep", "pendulum", "--end", "0.5", "--steps", "20", "--vary", "length=0.5:2:4", "--vary=gravity=9.81,1.62"];

const FILES: [&str; 2] = ["out/pendulum/sweep.csv", "out/pendulum/sweep.json"];

#[test]
fn a_design_has_the_bits_of_its_single_run_on_any_number_of_threads() {
    let folder = Folder::new("bits");
    let common = ["five-bar", "--end", "0.5", "--steps", "20"];
    let vary = ["--vary", "c=1.5:20:3:log", "--vary", "L01=1.9,2.1"];
    let mut tables = BTreeSet::new();
    for threads in ["1", "2", "7"] {
        folder.run(0, &[&["sweep"], &common[..], &vary, &["--threads", threads, "--out", threads]].concat());
        tables.insert(folder.read(&format!("{threads}/sweep.csv")));
    }
    assert_eq!(tables.len(), 1, "{tables:?}");
    let (header, rows) = table(tables.first().expect("one"));
    assert_eq!(header[..3], ["number", "design c [N s/m]", "design L01 [m]"]);
    assert_eq!(rows.iter().map(|row| &row[0][..]).collect::<Vec<_>>(), ["1", "2", "3", "4", "5", "6"]);
    for row in rows {
        let set = [format!("c={}", row[1]), format!("L01={}", row[2])];
        let output =
            folder.run(0, &[&["run"], &common[..], &["--json", "--no-report", "--set", &set[0], "--set", &set[1]]].concat());
        let values = values(&output);
        assert_eq!(values.len() + 6, header.len());
        for (value, word) in values.iter().zip(&row[3..]) {
            assert_eq!(value.to_bits(), number(word).to_bits(), "{set:?} {value}");
        }
        assert_eq!(row[row.len() - 2], "done");
    }
}

/// Numbers that stand behind the names of variables in the gradients of the last line, in their order.
fn derivatives(output: &Output, variables: &[&str]) -> Vec<f64> {
    let text = text(&output.stdout);
    let gradients = text.lines().last().expect("a line").split("\"gradient\":{").skip(1);
    let of_one = |gradient: &str| -> Vec<f64> {
        let own = gradient.split('}').next().expect("an object");
        let entry =
            |name: &&str| number(own.split(&format!("\"{name}\":")).nth(1).expect("a name").split(',').next().expect("one"));
        variables.iter().map(entry).collect()
    };
    gradients.flat_map(of_one).collect()
}

#[test]
fn gradients_of_the_designs_have_the_bits_of_single_runs_and_survive() {
    let folder = Folder::new("gradients");
    let common = ["five-bar", "--end", "0.5", "--steps", "20"];
    let sweep = [&["sweep"], &common[..], &["--vary", "c=1.5,20", "--vary", "L01=1.9,2.1", "--gradient"]].concat();
    let file = "out/five-bar/sweep.csv";
    folder.run(0, &[&sweep[..], &["--threads", "1"]].concat());
    let whole = folder.read(file);
    folder.run(0, &[&sweep[..], &["--threads", "3"]].concat());
    assert_eq!(folder.read(file), whole);
    let (header, rows) = table(&whole);
    let values = header.len() - 6;
    let functionals = values / 3;
    assert!(functionals > 0 && values == 3 * functionals, "{header:?}");
    let named = &header[3 + functionals..][..2];
    assert!(named[0].starts_with("d psi / d c [") && named[0].ends_with(" / (N s/m)]"), "{named:?}");
    assert!(named[1].starts_with("d psi / d L01 [") && named[1].ends_with(" / m]"), "{named:?}");
    for row in &rows {
        let set = [format!("c={}", row[1]), format!("L01={}", row[2])];
        let output = folder
            .run(0, &[&["gradient"], &common[..], &["--json", "--no-report", "--set", &set[0], "--set", &set[1]]].concat());
        let own = derivatives(&output, &["c", "L01"]);
        let columns: Vec<f64> = row[3 + functionals..][..2 * functionals].iter().map(|word| number(word)).collect();
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&own), bits(&columns), "{set:?} {own:?} {columns:?}");
        assert!(columns.iter().all(|derivative| *derivative != 0.0), "{columns:?}");
    }
    // one row is enough to go on, and a table without gradients is not taken for one with them
    let lines: Vec<&str> = whole.lines().collect();
    folder.write(file, &format!("{}\n{}\n", lines[0], lines[2]));
    let resume = [&sweep[..], &["--resume", "--json"]].concat();
    assert_eq!(json(&folder.run(0, &resume))["taken_over"], 1);
    assert_eq!(folder.read(file), whole);
    let without: Vec<&str> = resume.iter().copied().filter(|word| *word != "--gradient").collect();
    assert!(text(&folder.run(2, &without).stderr).contains("of another scene or variation"));
    assert_eq!(folder.read(file), whole);
}

#[cfg(feature = "arrow")]
#[test]
fn the_columns_of_arrow_are_those_of_the_table() {
    use arrow_array::Float64Array;
    let folder = Folder::new("arrow");
    folder.write("stone.toml", STONE);
    folder.run(1, &["sweep", "stone.toml", "--vary", "load=0.5:2.5:3", "--vary", "lift=2,4", "--gradient"]);
    let (header, rows) = table(&folder.read("out/stone/sweep.csv"));
    let file = fs::File::open(folder.0.join("out/stone/sweep.arrow")).expect("a file");
    let reader = arrow_ipc::reader::FileReader::try_new(file, None).expect("of Arrow");
    let names: Vec<String> = reader.schema().fields().iter().map(|field| field.name().clone()).collect();
    let numbers = header.len() - 2;
    assert_eq!((&names[..numbers], &names[numbers..]), (&header[..numbers], &["failed".to_string()][..]));
    let batch = reader.map(|batch| batch.expect("rows")).next().expect("a batch");
    for (column, name) in names.iter().enumerate() {
        let column_of_arrow = batch.column(column).as_any().downcast_ref::<Float64Array>().expect("numbers");
        let of_table =
            rows.iter().map(|row| if column < numbers { number(&row[column]) } else { f64::from(row[column] == "failed") });
        let bits: Vec<u64> = of_table.map(f64::to_bits).collect();
        assert_eq!(column_of_arrow.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>(), bits, "{name}");
    }
}

#[test]
fn extremes_correlations_and_pictures_are_those_of_the_rows() {
    let folder = Folder::new("shown");
    let output = folder.run(0, &[&PENDULUM[..], &["--json"]].concat());
    let (_, rows) = table(&folder.read(FILES[0]));
    let object = json(&output);
    let written: Value = serde_json::from_str(&folder.read(FILES[1])).expect("an object");
    assert_eq!(object, written);
    assert_eq!((&object["designs"], &object["failed"], &object["sampling"]), (&8.into(), &0.into(), &"grid".into()));
    let functionals = object["functionals"].as_array().expect("functionals");
    for (k, (own, extremes)) in functionals.iter().zip(values(&output).chunks(2)).enumerate() {
        assert!(own["rank_correlation"]["length"].as_f64().is_some_and(|rho| rho.abs() <= 1.0), "{own}");
        let column: Vec<f64> = rows.iter().map(|row| number(&row[3 + k])).collect();
        let [least, most] = ["smallest", "largest"].map(|name| own[name]["design"].as_u64().expect("a number") as usize - 1);
        assert_eq!([column[least], column[most]], extremes);
        assert!(column.iter().all(|value| (extremes[0]..=extremes[1]).contains(value)), "{column:?}");
    }
    let stdout = text(&output.stdout);
    for part in ["8 designs of a grid in 2 variables, on ", "rank correlation of", "gravity", "8 designs finished in "] {
        assert!(stdout.contains(part), "{part}: {stdout}");
    }
    for name in ["scatter-1", "scatter-2", "sensitivity"] {
        assert!(folder.read(&format!("out/pendulum/{name}.svg")).contains("x at the end"), "{name}");
    }
    assert!(folder.read("out/pendulum/sensitivity.svg").contains("Spearman's rank correlation over 8 designs"));
    // an earlier table is kept
    let first = folder.read(FILES[0]);
    let output = folder.run(0, &["sweep", "pendulum", "--end", "0.5", "--steps", "20", "--vary", "length=1"]);
    assert!(text(&output.stdout).contains("kept the earlier table as out/pendulum/sweep.1.csv"));
    assert_eq!(folder.read("out/pendulum/sweep.1.csv"), first);
}

#[test]
fn a_sweep_that_was_cut_off_goes_on_and_ends_with_the_same_table() {
    let folder = Folder::new("resume");
    folder.run(0, &PENDULUM);
    let whole = folder.read(FILES[0]);
    let lines: Vec<&str> = whole.lines().collect();
    let resume = [&PENDULUM[..], &["--resume", "--json"]].concat();
    let torn = format!("{}\n{}\n{}\n{}", lines[0], lines[6], lines[2], &lines[4][..lines[4].len() / 2]);
    for (left, taken_over) in [(torn, 2), ("num".into(), 0), (String::new(), 0), (whole.clone(), 8)] {
        folder.write(FILES[0], &left);
        let output = folder.run(0, &resume);
        assert_eq!(json(&output)["taken_over"], taken_over, "{left}");
        assert_eq!(folder.read(FILES[0]), whole);
    }
    // what is not of this sweep stays as it is
    let cases: [(&[&str], String, &str); 7] = [
        (&[], "my notes".into(), "it is no table of a sweep"),
        (
            &["--method", "dirk2"],
            format!("{whole}torn"),
            "design 1 follows from other formulas, numbers, methods or settings",
        ),
        (&["--set", "mass=2"], whole.clone(), "the file is of another scene, method or version"),
        (&["--vary", "mass=1:2:2"], whole.clone(), "of another scene or variation"),
        (&[], format!("{whole}{}\n", lines[3]), "line 10: the design 3 stands there twice"),
        (&[], format!("{whole}9,{}\n", &lines[3][2..]), "line 10: there is a design 9, but this sweep has 8"),
        (
            &[],
            format!("{}\n4{}\n", lines[0], &lines[3][1..]),
            "line 2: design 4 is [1.0, 9.81], but [1.0, 1.62] in this sweep",
        ),
    ];
    for (more, left, message) in cases {
        folder.write(FILES[0], &left);
        let said = text(&folder.run(2, &[&resume[..], more].concat()).stderr);
        assert!(said.contains(message) && said.contains("--resume out/pendulum/sweep.csv"), "{message}: {said}");
        assert_eq!(folder.read(FILES[0]), left);
    }
    fs::remove_file(folder.0.join(FILES[0])).expect("removed");
    assert!(text(&folder.run(2, &resume).stderr).contains("--resume out/pendulum/sweep.csv: "));
}

/// A mass on a spring, pushed: what is pushed how stiffly is said behind.
const PUSHED: &str = r#"
version = 1
variable.k = { initial = 100, bounds = [10, 1000] }
define.limit = 100
settings = { end = 1, steps = 20 }
point = [{ name = "p", position = [0, 0, 0], mass = 2 }]
force = [{ name = "push", on = "p", direction = [1, 0, 0], size = 3 }]
spring = [{ name = "s", type = "slide", between = ["ground", "p"], axis = [1, 0, 0], damping = 1, stiffness = "k" }]
functional = [{ name = "x", type = "position", on = "p", direction = [1, 0, 0], over = "terminal" }]
optimization = { minimize = "x" }
"#;

/// The first row is the same for all of these: what follows for others, or how its gradient does, is another thing.
#[test]
fn tables_of_other_laws_are_not_gone_on_with_and_stay_where_they_are() {
    let folder = Folder::new("other laws");
    let sweep = ["sweep", "s.toml", "--out", "out", "--vary", "k=100,400", "--gradient"];
    let optimize = ["optimize", "s.toml", "--out", "out", "--iterations", "2"];
    folder.write("s.toml", PUSHED);
    folder.run(0, &sweep);
    folder.command(&optimize).output().expect("it runs");
    let tables = ["out/sweep.csv", "out/optimization.csv"].map(|file| (file, folder.read(file)));
    let all = |folder: &Folder| {
        let entries = fs::read_dir(folder.0.join("out")).expect("a folder").map(|entry| entry.expect("an entry").path());
        entries.collect::<BTreeSet<_>>()
    };
    let files = all(&folder);
    for (what, by) in [
        ("stiffness = \"k\"", "stiffness = \"min(k, 100)\""),
        ("stiffness = \"k\"", "stiffness = \"min(k, limit)\""),
        ("stiffness = \"k\"", "stiffness = \"100 + 2 * (k - 100)\""),
        ("stiffness = \"k\"", "stiffness = \"max(k, 100)\""),
        ("size = 3", "size = \"3 + (k - 100)\""),
        ("mass = 2", "mass = \"2 * k / 100\""),
        ("steps = 20", "steps = 20, constraint_level = \"position\""),
    ] {
        assert!(PUSHED.contains(what), "{what}");
        folder.write("s.toml", &PUSHED.replace(what, by));
        for (arguments, message) in [
            (&sweep[..], "other formulas, numbers, methods or settings than it would here"),
            (&optimize, "of the history follows from other formulas, numbers, methods or settings"),
        ] {
            let said = text(&folder.run(2, &[arguments, &["--resume"]].concat()).stderr);
            assert!(said.contains(message), "{by}: {said}");
        }
        tables.iter().for_each(|(file, before)| assert_eq!(folder.read(file), *before, "{file} after {by}"));
        assert_eq!(all(&folder), files, "{by}");
    }
    // what changes nothing that is measured
    folder.write("s.toml", &PUSHED.replace("define.limit = 100", "define.limit = 7\nsummary = \"a mass\""));
    folder.run(0, &[&sweep[..], &["--resume"]].concat());
    assert_eq!(folder.read("out/sweep.csv"), tables[0].1);
    let output = folder.command(&[&optimize[..], &["--resume"]].concat()).output().expect("it runs");
    assert_ne!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert_eq!(folder.read("out/optimization.csv"), tables[1].1);
    assert!(!folder.0.join("out/optimization.1.csv").exists());
}

/// A stone whose mass vanishes where the load is 2.
const STONE: &str = r#"
version = 1
gravity = [0, 0, -10]
[variable]
load = { initial = 1, bounds = [0, 3], unit = "kg" }
lift = { initial = 3, bounds = [1, 8], unit = "m/s" }
[settings]
end = 0.5
steps = 10
[[point]]
name = "stone"
mass = "2 - load"
position = [0, 0, 0]
velocity = [0, 0, "lift"]
[[functional]]
name = "height"
type = "position"
on = "stone"
direction = [0, 0, 1]
over = "terminal"
"#;

#[test]
fn a_failed_design_is_named_with_its_reason_and_the_others_are_run() {
    let folder = Folder::new("failed");
    folder.write("stone.toml", STONE);
    let output = folder.run(1, &["sweep", "stone.toml", "--vary", "load=0.5:2.5:3", "--vary", "lift=2,4", "--json"]);
    let said = text(&output.stderr);
    assert!(said.contains("2 of 6 designs failed; the first, design 5: stone.toml:") && said.contains("-0.5"), "{said}");
    let object = json(&output);
    assert_eq!((&object["finished"], &object["failed"]), (&6.into(), &2.into()));
    let csv = folder.read("out/stone/sweep.csv");
    let (_, rows) = table(&csv);
    let states: Vec<&str> = rows.iter().map(|row| &row[5][..]).collect();
    assert_eq!(states, ["done", "done", "done", "done", "failed", "failed"]);
    assert!(rows[4][3] == "NaN" && csv.contains("mass: at this design the value is -0.5"), "{csv}");
    // 2.0 * 0.5 - 10 * 0.5^2 / 2
    assert!((number(&rows[0][3]) + 0.25).abs() < 1e-12, "{csv}");
    // failed designs are not run again, and the code remains
    let output =
        folder.run(1, &["sweep", "stone.toml", "--vary", "load=0.5:2.5:3", "--vary", "lift=2,4", "--json", "--resume"]);
    assert_eq!(json(&output)["taken_over"], 6);
    assert_eq!(folder.read("out/stone/sweep.csv"), csv);
    // steps that are too large, with a message of commas and quotes
    let large = ["sweep", "pendulum", "--steps", "20", "--vary", "length=0.5:2:3"];
    let said = text(&folder.run(1, &large).stderr);
    assert!(
        said.contains("3 of 3 designs failed") && said.contains("Newton") && said.contains("--steps above 20"),
        "{said}"
    );
    let csv = folder.read(FILES[0]);
    assert!(csv.contains("\"\"bob\"\", x"), "{csv}");
    folder.run(1, &[&large[..], &["--resume"]].concat());
    assert_eq!(folder.read(FILES[0]), csv);
    assert!(!folder.0.join("out/pendulum/sensitivity.svg").exists(), "there is nothing to show");
}

#[test]
fn samples_fill_the_ranges_evenly_and_leave_what_is_set() {
    let folder = Folder::new("samples");
    let common = ["sweep", "pendulum", "--end", "0.1", "--steps", "2", "--samples", "16"];
    let strata = |rows: &[Vec<String>], column: usize, share: fn(f64) -> f64| {
        rows.iter().map(|row| (16.0 * share(number(&row[column]))).floor() as usize).collect::<BTreeSet<_>>().len()
    };
    for (sampling, seed) in [("latin-hypercube", "1"), ("latin-hypercube", "2"), ("sobol", "1"), ("sobol", "2")] {
        let out = format!("{sampling}-{seed}");
        folder.run(0, &[&common[..], &["--sampling", sampling, "--seed", seed, "--set", "mass=3", "--out", &out]].concat());
        let (header, rows) = table(&folder.read(&format!("{out}/sweep.csv")));
        assert_eq!((rows.len(), &header[1..3]), (16, &["design length [m]".into(), "design gravity [m/s2]".into()][..]));
        assert_eq!(strata(&rows, 1, |x| (x - 0.1) / 9.9), 16, "{out}");
        assert_eq!(strata(&rows, 2, |x| (x - 0.1) / 19.9), 16, "{out}");
    }
    assert_ne!(folder.read("sobol-1/sweep.csv"), folder.read("sobol-2/sweep.csv"));
    assert_ne!(folder.read("latin-hypercube-1/sweep.csv"), folder.read("latin-hypercube-2/sweep.csv"));
    folder.run(0, &[&common[..], &["--sampling", "sobol", "--vary", "length=0.1:10:log"]].concat());
    let (_, rows) = table(&folder.read("out/pendulum/sweep.csv"));
    assert_eq!(number(&rows[0][1]), 0.1, "without a seed it begins at the lower end");
    assert!((number(&rows[1][1]) - 1.0).abs() < 1e-15, "half of the logarithm");
    assert_eq!(strata(&rows, 1, |x| 0.5 * (x.log10() + 1.0) + 1e-12), 16);
}

#[cfg(unix)]
#[test]
fn a_sweep_that_is_stopped_or_killed_loses_no_finished_row() {
    use std::process::Stdio;
    let folder = Folder::new("stopped");
    let arguments = ["sweep", "pendulum", "--steps", "3000", "--vary", "length=0.5:2:60", "--threads", "2"];
    let file = folder.0.join(FILES[0]);
    let rows = || fs::read_to_string(&file).map_or(0, |text| text.lines().count().saturating_sub(1));
    let outdated = ["sweep.arrow", "sweep.json", "scatter-1.svg", "scatter-2.svg", "sensitivity.svg"];
    let outdated = outdated.map(|name| format!("out/pendulum/{name}"));
    for (signal, code) in [("-INT", Some(130)), ("-KILL", None), ("-TERM", Some(130))] {
        fs::create_dir_all(folder.0.join("out/pendulum")).expect("a folder");
        outdated.iter().for_each(|name| folder.write(name, "earlier"));
        let before = rows();
        let resume = (before > 0).then_some("--resume");
        let mut command = folder.command(&[&arguments[..], resume.as_slice()].concat());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
        while rows() < before + 3 {
            assert!(child.try_wait().expect("a state").is_none(), "it ended before it was stopped");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill").success());
        let output = child.wait_with_output().expect("it ends");
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), code, "{message}");
        // one that was stopped has written those of its own rows
        let left: Vec<_> =
            outdated.iter().filter(|name| fs::read(folder.0.join(name)).is_ok_and(|own| own == b"earlier")).collect();
        assert!(left.is_empty(), "{left:?}");
        let (header, rows) = table(&folder.read(FILES[0]));
        assert!(rows.len() >= before + 3 && rows.iter().all(|row| row.len() + 2 == header.len()), "{rows:?}");
        if code.is_some() {
            let numbers: Vec<usize> = rows.iter().map(|row| row[0].parse().expect("a number")).collect();
            assert!(numbers.is_sorted(), "{numbers:?}");
            assert!(message.contains(" of 60 designs: sweep.csv has their rows, and --resume goes on"), "{message}");
        }
        // as if the machine had stopped within a line
        let whole = folder.read(FILES[0]);
        folder.write(FILES[0], &format!("{whole}60,1.5e0,2"));
    }
}

#[test]
fn wrong_input_is_refused_with_what_is_allowed() {
    let folder = Folder::new("wrong");
    let cases: &[(&[&str], &[&str])] = &[
        (&[], &["nothing varies", "--vary mass=FROM:TO:COUNT", "--samples N"]),
        (&["--vary", "lenght=1:2:3"], &["--vary lenght=1:2:3", "\"length\"?"]),
        (&["--vary", "length"], &["--vary length", "NAME=FROM:TO:COUNT"]),
        (&["--vary", "length=1:2:0"], &["count \"0\"", "whole number from 2 to 1000000", "NAME=VALUE"]),
        (&["--vary", "length=1:2:1"], &["count \"1\""]),
        (&["--vary", "length=1:2:x"], &["count \"x\""]),
        (&["--vary", "length=1:2:lin"], &["count \"lin\""]),
        (&["--vary", "length=2:1:5"], &["from a number to a larger one, not from 2 to 1"]),
        (&["--vary", "length=1:1:5"], &["not from 1 to 1"]),
        (&["--vary", "length=1:two:5"], &["\"two\" is not a number"]),
        (&["--vary", "length=1:inf:5"], &["\"inf\" is not a number"]),
        (&["--vary", "length=1,,2"], &["\"\" is not a number"]),
        (&["--vary", "length=0:2:5:log"], &["lies above 0", "begins at 0"]),
        (&["--vary", "length=1:2:3:4:5"], &["FROM:TO:COUNT:log"]),
        (&["--vary", "length=log"], &["FROM:TO:COUNT:log"]),
        (&["--vary", "length=1:2"], &["a grid needs a count", "--samples N"]),
        (&["--vary", "length=1:20:5"], &["\"length\" is 20 m", "between 0.1 and 10 m"]),
        (&["--vary", "length=5,0"], &["\"length\" is 0 m"]),
        (&["--vary", "length=1:2:5", "--vary", "length=3"], &["--vary length=3", "varies already"]),
        (&["--vary", "length=1:2:5", "--set", "length=3"], &["--set gives it one value"]),
        (&["--vary", "length=1:2:2000", "--vary", "mass=1:2:2000"], &["--vary mass=1:2:2000", "more than 1000000 designs"]),
        (&["--vary", "length=1:2:5", "--samples", "8"], &["without a count", "NAME=FROM:TO"]),
        (&["--vary", "length=1,2", "--samples", "8"], &["without a count"]),
        (&["--samples", "0"], &["--samples", "'0'", "whole number from 1 to 1000000"]),
        (&["--samples", "8", "--sampling", "halton"], &["'halton'", "latin-hypercube, sobol"]),
        (
            &["--samples", "8", "--set", "mass=1", "--set", "length=1", "--set", "gravity=9"],
            &["no variable", "left to vary"],
        ),
        (&["--vary", "length=1:2:5", "--seed", "3"], &["--samples"]),
        (&["--vary", "length=1:2:5", "--sampling", "sobol"], &["--samples"]),
        (&["--vary", "length=1:2:5", "--threads", "0"], &["--threads", "'0'", "whole number from 1 to"]),
        (&["--vary", "length=1:2:5", "--output-step", "0.1"], &["--output-step", "a sweep writes no histories"]),
        (&["--vary", "length=1:2:5", "--vtk"], &["--vtk", "leave it out"]),
        (&["--vary", "length=1:2:5", "--method", "esdrik3"], &["did you mean \"esdirk3\"?"]),
    ];
    for (arguments, expected) in cases {
        let output = folder.run(2, &[&["sweep", "pendulum"], *arguments].concat());
        let message = text(&output.stderr);
        assert_eq!(message.matches("error:").count(), 1, "{arguments:?}: {message}");
        for part in *expected {
            assert!(message.contains(part), "{arguments:?}: {part} is not in {message}");
        }
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
    }
    assert_eq!(fs::read_dir(&folder.0).expect("a folder").count(), 0);
    // more variables than Sobol's sequence has dimensions
    let names: Vec<String> = (0..22).map(|k| format!("v{k}")).collect();
    let variables: String = names.iter().map(|name| format!("{name} = {{ initial = 1, bounds = [1, 2] }}\n")).collect();
    let many = STONE
        .replace("[variable]\n", &format!("[variable]\n{variables}"))
        .replace("2 - load", &format!("5 - load + {}", names.join(" + ")));
    folder.write("many.toml", &many);
    let said = text(&folder.run(2, &["sweep", "many.toml", "--samples", "4", "--sampling", "sobol"]).stderr);
    assert!(said.contains("at most 2^32 points in 21 dimensions") && said.contains("latin-hypercube"), "{said}");
}

/// A damped oscillator on a slide, and two numbers of its mode.
const OSCILLATOR: &str = r#"version = 1
settings = { end = 0.1, steps = 5 }
variable.c = { initial = 8, bounds = [0.1, 100], unit = "N s/m" }
variable.k = { initial = 200, bounds = [1, 1000], unit = "N/m" }
body = [{ name = "mass", mass = 2, inertia = [1, 1, 1] }]
joint = [{ name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] }]
mode = [
    { name = "omega", number = 1, damped = true },
    { name = "growth", number = 1, measure = "growth", damped = true },
]
[[spring]]
name = "spring"
type = "slide"
between = ["ground", "mass"]
axis = [1, 0, 0]
stiffness = "k"
damping = "c"
"#;

#[test]
fn modes_are_measured_by_runs_gradients_and_sweeps() {
    let folder = Folder::new("modes");
    folder.write("oscillator.toml", OSCILLATOR);
    // omega^2 = k / m - growth^2, growth = -c / 2m
    let exact = |c: f64, k: f64| {
        let omega = (k / 2.0 - (c / 4.0).powi(2)).sqrt();
        ([omega, -c / 4.0], [[-c / (16.0 * omega), 1.0 / (4.0 * omega)], [-0.25, 0.0]])
    };
    let near =
        |own: f64, expected: f64| assert!((own - expected).abs() < 1e-12 * expected.abs().max(1.0), "{own} {expected}");
    let (wanted, slopes) = exact(8.0, 200.0);
    let ran = folder.run(0, &["run", "oscillator.toml", "--json", "--out", "ran"]);
    values(&ran).into_iter().zip(wanted).for_each(|(own, expected)| near(own, expected));
    assert_eq!(json(&ran)["modes"][1]["unit"], "1/s");
    assert!(folder.read("ran/report.html").contains("growth"));
    let differentiated = folder.run(0, &["gradient", "oscillator.toml", "--json", "--out", "differentiated"]);
    let modes = &json(&differentiated)["modes"];
    for (place, row) in slopes.iter().enumerate() {
        for (name, expected) in ["c", "k"].iter().zip(row) {
            near(modes[place]["gradient"][name].as_f64().expect("a number"), *expected);
        }
    }
    let page = folder.read("differentiated/report.html");
    assert!(page.contains("Gradient of omega [rad/s / unit of the variable]") && page.contains("What changes growth"));
    folder.run(0, &["sweep", "oscillator.toml", "--vary", "c=4,8", "--vary", "k=100:200:2", "--gradient", "--out", "swept"]);
    let (names, rows) = table(&folder.read("swept/sweep.csv"));
    assert_eq!(names[3..6].join(";"), "functional omega [rad/s];functional growth [1/s];d omega / d c [rad/s / (N s/m)]");
    for row in rows {
        let numbers: Vec<f64> = row[1..9].iter().map(|word| number(word)).collect();
        let (values, slopes) = exact(numbers[0], numbers[1]);
        let expected = values.into_iter().chain(slopes.into_iter().flatten());
        numbers[2..].iter().zip(expected).for_each(|(&own, expected)| near(own, expected));
    }
    // a name that a functional has
    let functional = "[[functional]]\nname = \"omega\"\ntype = \"mass\"\nover = \"initial\"\n";
    folder.write("taken.toml", &format!("{OSCILLATOR}{functional}"));
    let told = folder.run(2, &["check", "taken.toml"]);
    assert!(text(&told.stderr).contains("the name \"omega\" is taken: there is a mode with this name"));
}
