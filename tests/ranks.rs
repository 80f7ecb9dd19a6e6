//! Ranks under `mpirun`: the numbers of one process, and an error on all of them where one fails.

use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Within which all ranks end with an error, and within which a run makes its first step; both take long where nothing is optimized.
const SOON: Duration = Duration::from_secs(if cfg!(debug_assertions) { 100 } else { 10 });
const FIRST_STEP: Duration = Duration::from_secs(if cfg!(debug_assertions) { 400 } else { 60 });
/// The longest wait for another rank, where one sleeps \[s\].
const LONGEST_WAIT: &str = if cfg!(debug_assertions) { "60" } else { "4" };

/// An empty folder with a plate that is large enough to be shared, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, steps: usize) -> Self {
        let path = std::env::temp_dir().join(format!("costate-ranks-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes/plate-pendulum.toml");
        let mut text = fs::read_to_string(scene).unwrap();
        fs::write(path.join("small.toml"), &text).unwrap();
        let steps = steps.to_string();
        for (old, new) in [
            ("elements = [5, 1]", "elements = [30, 12]"),
            ("to = 2 }", "to = 24 }"),
            ("plate[10, 1]", "plate[60, 12]"),
            ("1e-3 * 20", &format!("1e-3 * {steps}")),
            ("steps = 20", &format!("steps = {steps}")),
        ] {
            assert_eq!(text.matches(old).count(), 1, "{old}");
            text = text.replace(old, new);
        }
        fs::write(path.join("plate.toml"), text).unwrap();
        Folder(path)
    }

    /// The program, once or as several ranks.
    fn command(&self, ranks: usize, arguments: &[&str]) -> Command {
        let program = env!("CARGO_BIN_EXE_costate");
        let mut command = if ranks == 1 { Command::new(program) } else { mpirun() };
        if ranks > 1 {
            command.args(["-n", &ranks.to_string(), program]);
        }
        // by which its ranks are told from those of other tests
        command.env("COSTATE_TEST", &self.0).env("COSTATE_LONGEST_WAIT", "100");
        command.args(arguments).current_dir(&self.0);
        command
    }

    fn run(&self, ranks: usize, arguments: &[&str]) -> Output {
        self.command(ranks, arguments).output().expect("mpirun is installed where the feature mpi is tested")
    }

    /// The process of a rank, as soon as it runs.
    fn process_of(&self, rank: usize) -> u32 {
        let own = format!("COSTATE_TEST={}\0", self.0.display());
        let of_rank = format!("OMPI_COMM_WORLD_RANK={rank}\0");
        let begun = Instant::now();
        loop {
            for entry in fs::read_dir("/proc").unwrap().flatten() {
                let Ok(number) = entry.file_name().to_string_lossy().parse() else { continue };
                let environment = fs::read(entry.path().join("environ")).unwrap_or_default();
                let environment = String::from_utf8_lossy(&environment) + "\0";
                if environment.contains(&own) && environment.contains(&of_rank) {
                    return number;
                }
            }
            assert!(begun.elapsed() < FIRST_STEP, "rank {rank} does not start");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A run that ends with a test that fails.
struct Running(Child);

impl Running {
    fn output(&mut self) -> Output {
        let status = self.0.wait().unwrap();
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        // a few lines, for which pipes have room
        self.0.stdout.take().unwrap().read_to_end(&mut stdout).unwrap();
        self.0.stderr.take().unwrap().read_to_end(&mut stderr).unwrap();
        Output { status, stdout, stderr }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn mpirun() -> Command {
    let mut command = Command::new("mpirun");
    command.arg("--oversubscribe");
    // containers have no other user
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The one JSON object of a run.
fn json(output: &Output) -> Value {
    let words = text(&output.stdout);
    assert!(output.status.success(), "{words}{}", text(&output.stderr));
    let objects: Vec<&str> = words.lines().filter(|line| line.starts_with('{')).collect();
    let [object] = objects[..] else { panic!("{} objects: {words}", objects.len()) };
    serde_json::from_str(object).unwrap()
}

/// The line of stderr that tells what went wrong; `mpirun` has more to say.
fn error_of(output: &Output) -> String {
    text(&output.stderr).lines().find(|line| line.starts_with("error: ")).unwrap_or_default().into()
}

#[test]
fn states_values_and_gradients_have_the_bits_of_one_process() {
    let folder = Folder::new("bits", 2);
    let gradient = |ranks: usize| {
        let out = format!("of-{ranks}");
        let output = folder.run(ranks, &["gradient", "plate.toml", "--json", "--no-report", "--out", &out]);
        let words = text(&output.stdout);
        assert_eq!(words.contains(&format!("shared by {ranks} ranks")), ranks > 1, "{words}");
        (json(&output)["functionals"].clone(), fs::read(folder.0.join(out).join("histories.csv")).unwrap())
    };
    let (values, states) = gradient(1);
    assert!(
        values.as_array().is_some_and(|all| all.len() == 5 && all[0]["gradient"]["thickness 1"].is_number()),
        "{values}"
    );
    for ranks in 2..=4 {
        let (other_values, other_states) = gradient(ranks);
        assert_eq!(values, other_values, "{ranks} ranks");
        assert!(states == other_states, "states of {ranks} ranks");
    }
}

#[test]
fn systems_that_are_too_small_are_solved_by_each_rank() {
    let folder = Folder::new("small", 1);
    let arguments = ["gradient", "small.toml", "--json", "--no-report"];
    let (one, two) = (folder.run(1, &arguments), folder.run(2, &arguments));
    assert_eq!(json(&one)["functionals"], json(&two)["functionals"]);
    assert_eq!(text(&two.stdout).matches("too small to be shared").count(), 1, "{}", text(&two.stdout));
    assert!(!text(&one.stdout).contains("shared"), "{}", text(&one.stdout));
}

#[test]
fn one_rank_says_what_is_wrong_with_the_input() {
    let folder = Folder::new("input", 1);
    for (arguments, code, words) in [
        (&["run", "plate.toml", "--set", "width=1"][..], 2, "width"),
        (&["run", "plate.toml", "--no-such-option"][..], 2, "unexpected argument"),
        (&["modes", "plate.toml"][..], 2, "start this without mpirun"),
        (&["run", "plate.toml", "--history", "file:kept", "--resume"][..], 2, "start it without mpirun"),
    ] {
        let output = folder.run(2, arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert_eq!(said.matches("error: ").count(), 1, "{said}");
        assert!(said.contains(words), "{said}");
    }
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
fn a_sweep_has_the_rows_of_one_process_failed_ones_named_and_is_resumed() {
    let folder = Folder::new("sweep", 1);
    fs::write(folder.0.join("stone.toml"), STONE).unwrap();
    let sweep = |ranks: usize, code: i32, out: &str, resume: &[&str]| {
        let designs = ["--vary", "load=0.5:2.5:3", "--vary", "lift=2:5:4", "--gradient", "--no-report", "--json"];
        let arguments = [&["sweep", "stone.toml", "--out", out, "--threads", "1"], &designs[..], resume].concat();
        let output = folder.run(ranks, &arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert_eq!(said.matches("error: ").count(), 1, "{said}");
        (output, fs::read_to_string(folder.0.join(out).join("sweep.csv")).unwrap())
    };
    let (one, rows) = sweep(1, 1, "of-1", &[]);
    assert!(text(&one.stderr).contains("4 of 12 designs failed"), "{}", text(&one.stderr));
    for ranks in 2..=4 {
        let out = format!("of-{ranks}");
        let (several, other) = sweep(ranks, 1, &out, &[]);
        assert_eq!(other, rows, "{ranks} ranks");
        assert_eq!(error_of(&several), error_of(&one));
        assert!(text(&several.stdout).contains(&format!("1 thread of each of {ranks} ranks")), "{}", text(&several.stdout));
        // a sweep that ended early leaves rows in any order, and the last one in pieces
        let lines: Vec<&str> = rows.split_inclusive('\n').collect();
        let left = [lines[0], lines[9], lines[2], lines[5], &lines[3][..20]].concat();
        fs::write(folder.0.join(&out).join("sweep.csv"), left).unwrap();
        let (output, resumed) = sweep(ranks, 1, &out, &["--resume"]);
        assert_eq!(resumed, rows, "{ranks} ranks go on");
        assert!(text(&output.stdout).contains("of which 3 are finished"), "{}", text(&output.stdout));
    }
    let (output, _) = sweep(2, 2, "of-2", &["--resume", "--set", "lift=3"]);
    assert!(text(&output.stderr).contains("lift"), "{}", text(&output.stderr));
}

/// A cantilever whose width and height carry three loads.
const BRACKET: &str = r#"
version = 1
name = "bracket"
[variable]
width = { initial = 0.03, bounds = [0.005, 0.1], unit = "m" }
height = { initial = 0.03, bounds = [0.005, 0.1], unit = "m" }
[define]
push = 100
[material]
steel = { young = 2e11, poisson = 0.3, density = 7800 }
[section]
bar = { type = "rectangle", width = "width", height = "height", material = "steel" }
[[beam]]
name = "beam"
from = [0, 0, 0]
to = [1, 0, 0]
second_axis = [0, 1, 0]
elements = 3
section = "bar"
clamped = ["start"]
[[force]]
name = "load"
on = "beam.end"
direction = [0, 0, -1]
size = { type = "constant_rate", offset = 0, rate = "push" }
[[functional]]
name = "mass"
type = "mass"
over = "initial"
[[functional]]
name = "way"
type = "target"
on = "beam.end"
target = [1, 0, 0]
over = "terminal"
[settings]
method = "static"
steps = 1
[[scenario]]
name = "down"
define.push = 300
[[scenario]]
name = "aside"
force.load = { direction = [0, 1, 0], size = { type = "smooth_ramp", to = "2 * push", duration = 1 } }
settings.steps = 2
[[scenario]]
name = "little"
define.push = 30
[optimization]
minimize = "mass [down]"
constraint = [{ functional = "way", at_most = 1e-4 }]
"#;

/// A table without its times.
fn untimed(table: &str) -> Vec<Vec<&str>> {
    let timed: Vec<bool> = table.lines().next().unwrap().split(',').map(|name| name.ends_with("time [s]")).collect();
    table.lines().map(|line| line.split(',').zip(&timed).filter(|own| !own.1).map(|own| own.0).collect()).collect()
}

#[test]
fn scenarios_and_starts_that_are_dealt_have_the_bits_of_one_process() {
    let folder = Folder::new("dealt", 1);
    fs::write(folder.0.join("bracket.toml"), BRACKET).unwrap();
    let table = |out: &str, file: &str| fs::read_to_string(folder.0.join(out).join(file)).unwrap();
    let optimize = |ranks: usize, out: &str, threads: &str, further: &[&str]| {
        let common = ["optimize", "bracket.toml", "--iterations", "4", "--no-report", "--json", "--out", out];
        let mut command = folder.command(ranks, &[&common[..], further].concat());
        let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
        let words = text(&output.stdout);
        let object: Value = serde_json::from_str(words.lines().last().unwrap()).unwrap();
        (output.status.code(), object["design"].clone(), error_of(&output))
    };
    let one = optimize(1, "of-1", "1", &[]);
    let expected = table("of-1", "optimization.csv");
    for (ranks, threads) in [(1, "3"), (2, "1"), (3, "2"), (4, "1")] {
        let out = format!("of-{ranks}-{threads}");
        assert_eq!(optimize(ranks, &out, threads, &[]), one, "{ranks} ranks");
        assert_eq!(untimed(&table(&out, "optimization.csv")), untimed(&expected), "{ranks} ranks");
    }
    let starts = ["--starts", "3"];
    let one = optimize(1, "starts-1", "1", &starts);
    for ranks in [2, 4] {
        let out = format!("starts-{ranks}");
        assert_eq!(optimize(ranks, &out, "1", &starts), one, "{ranks} ranks");
        for file in ["optimization", "optimization.start-1", "optimization.start-2", "optimization.start-3"] {
            let file = format!("{file}.csv");
            assert_eq!(untimed(&table(&out, &file)), untimed(&table("starts-1", &file)), "{file} of {ranks} ranks");
        }
    }
}

#[test]
fn a_scenario_that_fails_on_one_rank_is_told_by_all() {
    let folder = Folder::new("failing", 1);
    let bad = BRACKET.replace("define.push = 30\n", "settings.steps = 1\ndefine.push = 1e12\n");
    fs::write(folder.0.join("bracket.toml"), bad).unwrap();
    let run = |ranks: usize| folder.run(ranks, &["optimize", "bracket.toml", "--no-report", "--out", "failed"]);
    let (one, three) = (run(1), run(3));
    assert!(text(&one.stderr).contains("scenario \"little\""), "{}", text(&one.stderr));
    assert_eq!((error_of(&one), one.status.code()), (error_of(&three), three.status.code()));
}

/// Starts a long run, does something to its second rank, and returns how it ended, which it must soon.
fn fault(name: &str, (ranks, longest_wait): (usize, &str), signal: &str, later: Duration) -> Output {
    let run = ["run", "plate.toml", "--no-report", "--out", "results"];
    fault_of((&run, "results/histories.unfinished.csv"), name, (ranks, longest_wait), signal, later)
}

/// The same of a command that has begun its work when there is a file.
fn fault_of(
    (arguments, file): (&[&str], &str),
    name: &str,
    (ranks, longest_wait): (usize, &str),
    signal: &str,
    later: Duration,
) -> Output {
    let folder = Folder::new(name, 10_000);
    fs::write(folder.0.join("stone.toml"), STONE).unwrap();
    let mut command = folder.command(ranks, arguments);
    command.env("COSTATE_LONGEST_WAIT", longest_wait).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("mpirun is installed where the feature mpi is tested");
    let mut running = Running(child);
    let process = folder.process_of(1).to_string();
    let table = folder.0.join(file);
    let begun = Instant::now();
    while !table.exists() {
        assert!(begun.elapsed() < FIRST_STEP && running.0.try_wait().unwrap().is_none(), "no step is made");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(later);
    let begun = Instant::now();
    assert!(Command::new("kill").args([signal, &process]).status().unwrap().success());
    let output = running.output();
    assert!(begun.elapsed() < SOON, "{name}: after {:?}", begun.elapsed());
    assert!(!output.status.success(), "{name}: {}", text(&output.stdout));
    output
}

#[test]
fn all_ranks_end_where_one_is_killed() {
    for (ranks, later) in [(2, 0), (2, 700), (3, 300)] {
        fault(&format!("killed-{later}"), (ranks, "100"), "-KILL", Duration::from_millis(later));
    }
}

#[test]
fn all_ranks_end_where_one_sleeps() {
    for (ranks, later) in [(2, 0), (3, 500)] {
        let output = fault(&format!("asleep-{later}"), (ranks, LONGEST_WAIT), "-STOP", Duration::from_millis(later));
        let said = text(&output.stderr);
        assert!(said.contains("error: rank") && said.contains(&format!("within {LONGEST_WAIT} s")), "{said}");
        assert_eq!(output.status.code(), Some(70), "{said}");
    }
}

#[test]
fn a_sweep_ends_where_a_rank_sleeps_or_is_killed() {
    let sweep = ["sweep", "stone.toml", "--vary", "load=0:1:300", "--vary", "lift=1:8:300", "--out", "results"];
    for signal in ["-STOP", "-KILL"] {
        let name = format!("sweep{signal}");
        let begun = (&sweep[..], "results/sweep.csv");
        let output = fault_of(begun, &name, (2, LONGEST_WAIT), signal, Duration::from_secs(1));
        let said = text(&output.stderr);
        assert_eq!(said.contains("no sign of rank 1 within"), signal == "-STOP", "{said}");
    }
}

#[test]
fn ranks_with_other_numbers_are_told() {
    let folder = Folder::new("others", 2);
    let program = env!("CARGO_BIN_EXE_costate");
    let run = |thickness: &'static str| ["-n", "1", program, "run", "plate.toml", "--no-report", "--set", thickness];
    let mut command = mpirun();
    command.args(run("thickness 3=0.01")).arg(":").args(run("thickness 3=0.0100001")).current_dir(&folder.0);
    let output = command.env("COSTATE_LONGEST_WAIT", LONGEST_WAIT).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(70), "{said}");
    assert!(said.contains("different matrices") || said.contains("other numbers"), "{said}");
}
