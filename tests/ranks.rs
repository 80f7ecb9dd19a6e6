//! Ranks under `mpirun`: the numbers of one process, and an error on all of them where one fails.

use serde_json::Value;
use std::fs;
use std::fs::File;
use std::path::PathBuf;
use std::process::{Child, Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Within which all ranks end with an error, and within which a run makes its first step; both take long where nothing is optimized.
const SOON: Duration = Duration::from_secs(if cfg!(debug_assertions) { 100 } else { 10 });
const FIRST_STEP: Duration = Duration::from_secs(if cfg!(debug_assertions) { 400 } else { 60 });
/// The longest wait for another rank, where one sleeps \[s\].
const LONGEST_WAIT: &str = if cfg!(debug_assertions) { "60" } else { "4" };

const MPIRUN: &str = "mpirun is installed where the feature mpi is tested";
const PROGRAM: &str = env!("CARGO_BIN_EXE_costate");
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenes/");

/// A scene of the examples in which each of some lines is another one.
fn edited(scene: &str, edits: &[(&str, &str)]) -> String {
    let mut text = fs::read_to_string(format!("{SCENES}{scene}.toml")).unwrap();
    for (old, new) in edits {
        assert!(text.contains(old), "{scene}: {old}");
        text = text.replace(old, new);
    }
    text
}

/// A plate that is large enough to be shared.
fn plate(steps: usize) -> String {
    edited(
        "plate-pendulum",
        &[
            ("along = 5\nacross = 1", "along = 30\nacross = 12"),
            ("1e-3 * 20", &format!("{steps} / 1024")),
            ("steps = 20", &format!("steps = {steps}")),
        ],
    )
}

/// Ranks that wait look at their messages again and again: those of two tests at once would leave no core to those that work.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// An empty folder with a plate, removed when dropped; only one at a time.
struct Folder(PathBuf, #[expect(dead_code, reason = "held while the folder is there")] MutexGuard<'static, ()>);

impl Folder {
    fn new(name: &str, steps: usize) -> Self {
        let only = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let path = std::env::temp_dir().join(format!("costate-ranks-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("small.toml"), edited("plate-pendulum", &[])).unwrap();
        fs::write(path.join("plate.toml"), plate(steps)).unwrap();
        Folder(path, only)
    }

    /// The program, once or as several ranks.
    fn command(&self, ranks: usize, arguments: &[&str]) -> Command {
        let mut command = if ranks == 1 { Command::new(PROGRAM) } else { mpirun() };
        if ranks > 1 {
            command.args(["-n", &ranks.to_string(), PROGRAM]);
        }
        self.here(&mut command).args(arguments);
        command
    }

    /// The program as ranks that a line of the shell starts: the arguments follow it.
    fn by_shell(&self, ranks: &[(usize, &str)], arguments: &[&str]) -> Command {
        let mut command = mpirun();
        for (some, line) in ranks {
            command.args(["-n", &some.to_string(), "sh", "-c", line, PROGRAM]).args(arguments).arg(":");
        }
        self.here(&mut command);
        command
    }

    fn here<'c>(&self, command: &'c mut Command) -> &'c mut Command {
        // by which its ranks are told from those of other tests
        command.env("COSTATE_TEST", &self.0).env("COSTATE_LONGEST_WAIT", "100").current_dir(&self.0)
    }

    /// What a command has said on stderr so far.
    fn said(&self) -> String {
        text(&fs::read(self.0.join("stderr")).unwrap_or_default())
    }

    fn run(&self, ranks: usize, arguments: &[&str]) -> Output {
        self.command(ranks, arguments).output().expect(MPIRUN)
    }

    /// The gradient of a scene by ranks of some threads, which share its systems where there are several: what is printed, the functionals, and
    /// the states.
    fn gradient(&self, [ranks, threads]: [usize; 2], scene: &str, options: &[&str]) -> (Output, Value, Vec<u8>) {
        let usual = ["gradient", scene, "--json", "--no-report", "--out", "results"];
        let mut command = self.command(ranks, &[&usual, options].concat());
        let output = command.env("RAYON_NUM_THREADS", threads.to_string()).output().expect(MPIRUN);
        let words = text(&output.stdout);
        assert_eq!(words.contains(&format!("shared by {ranks} ranks")), ranks > 1, "{scene}: {words}");
        let functionals = json(&output)["functionals"].clone();
        (output, functionals, fs::read(self.0.join("results/histories.csv")).unwrap())
    }

    /// All processes of its commands that run, with their environment.
    fn processes(&self) -> Vec<(String, String)> {
        let own = format!("COSTATE_TEST={}\0", self.0.display());
        let all = fs::read_dir("/proc").unwrap().flatten().map(|entry| {
            let environment = fs::read(entry.path().join("environ")).unwrap_or_default();
            let text = String::from_utf8_lossy(&environment).into_owned() + "\0";
            (entry.file_name().to_string_lossy().into_owned(), text)
        });
        all.filter(|(_, text)| text.contains(&own)).collect()
    }

    /// The process of a rank, as soon as all of them run: an mpirun whose first rank ends while it starts the second may wait for ever.
    fn process_of(&self, rank: usize, ranks: usize) -> String {
        let begun = Instant::now();
        loop {
            let processes = self.processes();
            let of_rank = |rank: usize| {
                let own = format!("OMPI_COMM_WORLD_RANK={rank}\0");
                processes.iter().find(|(_, text)| text.contains(&own))
            };
            if let (Some((number, _)), true) = (of_rank(rank), (0..ranks).all(|rank| of_rank(rank).is_some())) {
                return number.clone();
            }
            assert!(begun.elapsed() < FIRST_STEP, "the {ranks} ranks do not start");
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
        let (output, functionals, states) = folder.gradient([ranks, 1], "plate.toml", &["--check"]);
        let apart = &json(&output)["largest_relative_difference"];
        assert!(apart.as_f64().is_some_and(|apart| apart < 1e-11), "complex step of {ranks} ranks: {apart}");
        (functionals, states)
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

/// What MUMPS solves on any number of ranks is what the own solver does, to round-off.
#[cfg(feature = "mumps")]
#[test]
fn mumps_solves_the_same_on_any_number_of_ranks() {
    let folder = Folder::new("mumps", 2);
    let gradient = |ranks: usize, solver: &str| {
        let (output, functionals, _) = folder.gradient([ranks, 1], "plate.toml", &["--solver", solver]);
        let words = text(&output.stdout);
        assert!(words.contains(&format!("{solver} LU")), "{words}");
        assert_eq!(words.contains("ordered by"), solver == "mumps", "{words}");
        let numbers = |own: &Value| {
            let gradient = own["gradient"].as_object().unwrap().values().chain([&own["value"]]);
            gradient.map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>()
        };
        functionals.as_array().unwrap().iter().map(numbers).collect::<Vec<_>>()
    };
    let own = gradient(1, "multifrontal");
    for ranks in 1..=3 {
        for (own, other) in own.iter().zip(gradient(ranks, "mumps")) {
            let size = own.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            for (own, other) in own.iter().zip(other) {
                assert!((own - other).abs() < 1e-9 * size, "{ranks} ranks: {own:e} {other:e}");
            }
        }
    }
    fs::write(folder.0.join("singular.toml"), plate(4) + SINGULAR).unwrap();
    for ranks in 1..=2 {
        let output = folder.run(ranks, &["run", "singular.toml", "--no-report", "--solver", "mumps"]);
        let error = error_of(&output);
        assert!(
            error.contains("error: step 2, stage 2") && error.contains("do not determine \"c"),
            "{ranks} ranks: {error}"
        );
    }
}

/// A second hinge in line with that of the tube, and the force that it bears along it: all of what both bear together is not determined.
const SECOND_HINGE: &str = r#"
[[joint]]
name = "second hinge"
type = "revolute"
between = ["ground", "tube.start[0]"]
point = [0, 0.02, 0]
axis = [0, 1, 0]

[[functional]]
name = "force of the second hinge along z"
type = "reaction"
joint = "second hinge"
weights = [0, 0, 1, 0, 0]
over = "terminal"
"#;

/// Mechanisms of the examples with finer elements, so that they are large enough to be shared.
#[test]
fn mechanisms_have_the_bits_of_one_process() {
    let tube = edited(
        "box-tube-pendulum",
        &[
            ("elements = 5\n", "elements = 16\n"),
            ("across = [1, 1]", "across = [6, 6]"),
            ("[settings]", "[settings]\ndrop_redundant = true"),
        ],
    ) + SECOND_HINGE;
    let four_bar = [("elements = 4\n", "elements = 1000\n"), ("elements = 8\n", "elements = 1000\n")];
    // where the largest of so many stresses is takes longer to follow than all else: the height of the cables' ends instead
    let suspension = [
        ("elements = 2\n", "elements = 400\n"),
        (
            "type = \"largest_cable_stress\"\ncable = \"beam {i}\"\nyoung = 2e11\ndistance = \"0.03 * 0.5\"\n",
            "type = \"position\"\non = \"beam {i}.end\"\ndirection = [0, 0, 1]\n",
        ),
        ("over = { aggregate = \"smooth_maximum\", sharpness = \"1 / 2e6\" }", "over = \"terminal\""),
    ];
    let hub = [("along = 12 ", "along = 36 "), ("across = 1\n", "across = 3\n")];
    for (name, scene, options) in [
        ("tube", tube, &["--end", "0.003", "--steps", "2"][..]),
        ("four-bar", edited("flexible-four-bar", &four_bar), &["--end", "0.002", "--steps", "2"]),
        ("suspension", edited("suspension", &suspension), &["--end", "4e-6", "--steps", "2"]),
        ("hub", edited("rotor-hub", &hub), &["--end", "3.2e-4", "--steps", "2", "--scenario", "lateral"]),
    ] {
        let folder = Folder::new(name, 1);
        fs::write(folder.0.join("mechanism.toml"), scene).unwrap();
        let gradient = |layout: [usize; 2]| {
            let (output, functionals, states) = folder.gradient(layout, "mechanism.toml", options);
            let words = text(&output.stdout);
            assert_eq!(words.contains("redundant and left out"), name == "tube", "{words}");
            (functionals, states)
        };
        let (values, states) = gradient([1, 1]);
        let gradients = values.as_array().into_iter().flatten().filter_map(|own| own["gradient"].as_object());
        let moved = gradients.flat_map(|own| own.values()).filter(|x| x.as_f64().is_some_and(|x| x != 0.0)).count();
        assert!(moved > 3, "{name}: {values}");
        for [ranks, threads] in [[1, 2], [2, 2], [3, 1], [4, 1]] {
            let (others, other_states) = gradient([ranks, threads]);
            assert_eq!(values, others, "{name}: {ranks} ranks, {threads} threads");
            assert!(states == other_states, "{name}: states of {ranks} ranks, {threads} threads");
        }
    }
}

#[test]
fn steps_are_kept_in_slices_and_files_and_gone_on_with_on_any_number_of_ranks() {
    let folder = Folder::new("history", 14);
    let gradient = |ranks: usize, keep: &[&str]| {
        let usual = ["gradient", "plate.toml", "--json", "--no-report", "--out", "results", "--history"];
        let all = json(&folder.run(ranks, &[&usual, keep].concat()));
        (all["functionals"].clone(), all)
    };
    let (values, work) = gradient(1, &["memory"]);
    assert!(values[0]["gradient"]["thickness 1"].is_number() && work["steps_in_memory"] == 14, "{values} {work}");
    // too little for a step and a checkpoint of one process
    const LITTLE: &str = "checkpoints:5.2";
    let refused = folder.run(1, &["gradient", "plate.toml", "--no-report", "--out", "results", "--history", LITTLE]);
    assert!(error_of(&refused).contains("one step and one checkpoint"), "{}", text(&refused.stderr));
    for (ranks, keep, recomputed) in [(2, LITTLE, 14 * 13 / 2), (3, LITTLE, 0), (2, "file:kept", 0)] {
        let (others, work) = gradient(ranks, &[keep]);
        assert_eq!(values, others, "{keep}: {ranks} ranks");
        assert_eq!(work["adjoint_recomputed_steps"], recomputed, "{work}");
    }
    let kept = fs::read(folder.0.join("kept")).unwrap();
    for ranks in [1, 3] {
        // as a process leaves it that is killed
        fs::remove_file(folder.0.join("kept")).unwrap();
        fs::write(folder.0.join("kept.part"), &kept[..kept.len() * 3 / 5]).unwrap();
        let (others, work) = gradient(ranks, &["file:kept", "--resume"]);
        assert_eq!(values, others, "gone on with by {ranks} ranks");
        let taken_over = work["steps_taken_over"].as_u64();
        assert!(taken_over.is_some_and(|steps| (1..14).contains(&steps)), "{work}");
    }
    // one that is complete
    let (others, work) = gradient(2, &["file:kept", "--resume"]);
    assert!(values == others && work["steps_taken_over"] == 14, "{work}");
}

/// A plate that is held along its edge: it bends under its weight step by step, or is released from its equilibrium.
fn shelf(settings: &str) -> String {
    let hinge = "type = \"revolute\"\nbetween = [\"ground\", \"plate[0, {i}]\"]\naxis = [0, 1, 0]";
    let held = "type = \"fixed\"\nbetween = [\"ground\", \"plate[0, {i}]\"]";
    let text = plate(2);
    assert!(text.contains(hinge), "{text}");
    text.replace(hinge, held).replace("[settings]", &format!("[settings]\n{settings}"))
}

#[test]
fn equilibria_and_their_stability_have_the_bits_of_one_process() {
    for (name, settings, words) in
        [("loaded", "method = \"static\"", "stable"), ("released", "start = \"equilibrium\"", "equilibrium")]
    {
        let folder = Folder::new(name, 2);
        fs::write(folder.0.join("shelf.toml"), shelf(settings)).unwrap();
        let gradient = |ranks: usize| {
            let (output, functionals, states) = folder.gradient([ranks, 1], "shelf.toml", &[]);
            let said = text(&output.stdout);
            assert!(said.contains(words), "{said}");
            (functionals, states)
        };
        let one = gradient(1);
        for ranks in 2..=3 {
            assert!(gradient(ranks) == one, "{name}: {ranks} ranks");
        }
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
        (&["run", "plate.toml", "--history", "auto", "--resume"][..], 2, "run in a file"),
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

/// Scenarios of a plate, one of them with more steps than the others.
const FALLS: &str = r#"
[[scenario]]
name = "short"
settings.steps = 1
[[scenario]]
name = "long"
settings.steps = 4
[[scenario]]
name = "upwards"
gravity = [0, 0, 9.81]
[optimization]
minimize = "mass [short]"
constraint = [{ functional = "strain energy, integral", at_most = 1e-9 }]
"#;

#[test]
fn scenarios_and_starts_that_groups_of_ranks_share_have_the_bits_of_one_process() {
    let folder = Folder::new("groups", 2);
    // a comma would part the columns of the table
    let scene = (plate(1) + FALLS).replace("strain energy, integral", "strain energy");
    fs::write(folder.0.join("falls.toml"), scene).unwrap();
    let optimize = |ranks: usize, further: &[&str]| {
        let out = format!("of-{ranks}-{}", further.len());
        let common = ["optimize", "falls.toml", "--no-report", "--json", "--out", &out];
        let mut command = folder.command(ranks, &[&common[..], further].concat());
        let output = command.env("RAYON_NUM_THREADS", "1").output().unwrap();
        let object: Value = serde_json::from_str(text(&output.stdout).lines().last().unwrap_or_default())
            .unwrap_or_else(|_| panic!("{}{}", text(&output.stdout), text(&output.stderr)));
        let table = fs::read_to_string(folder.0.join(out).join("optimization.csv")).unwrap();
        let table: Vec<String> = untimed(&table).iter().map(|row| row.join(",")).collect();
        ((output.status.code(), object["design"].clone(), error_of(&output)), table)
    };
    // groups of two, two and one; later the long one has more
    let iterations = ["--iterations", "1"];
    let one = optimize(1, &iterations);
    assert!(one.1.len() > 2, "{:?}", one.1);
    for ranks in 4..=5 {
        assert_eq!(optimize(ranks, &iterations), one, "{ranks} ranks");
    }
    // starts of two ranks each, which deal scenarios among them, and of four, some of which share them
    let starts = ["--starts", "2", "--iterations", "1"];
    let one = optimize(1, &starts);
    for ranks in [4, 8] {
        assert_eq!(optimize(ranks, &starts), one, "{ranks} ranks");
    }
}

#[test]
fn a_scenario_that_fails_on_some_ranks_is_told_by_all() {
    let folder = Folder::new("failing", 1);
    let bad = BRACKET.replace("define.push = 30\n", "settings.steps = 1\ndefine.push = 1e12\n");
    fs::write(folder.0.join("bracket.toml"), bad).unwrap();
    let run = |ranks: usize| folder.run(ranks, &["optimize", "bracket.toml", "--no-report", "--out", "failed"]);
    let one = run(1);
    assert!(text(&one.stderr).contains("scenario \"little\""), "{}", text(&one.stderr));
    // three, and a group that others wait for
    for ranks in [3, 4] {
        let several = run(ranks);
        assert_eq!((error_of(&one), one.status.code()), (error_of(&several), several.status.code()), "{ranks} ranks");
    }
}

/// Brings a fault about as often as `COSTATE_FAULTS` says, each time otherwise, and says how long its ranks took at most to end.
fn each_time(name: &str, fault: impl Fn(usize) -> Duration) {
    let times = std::env::var("COSTATE_FAULTS").map_or(1, |times| times.parse().expect("a number"));
    let slowest = (0..times).map(fault).max().unwrap_or_default();
    println!("{name:40} {times:3} times, at most {:5.2} s", slowest.as_secs_f64());
}

/// What is left of a command that failed: its exit code, what it said on stderr, and how long it took to end.
struct End {
    code: Option<i32>,
    said: String,
    took: Duration,
}

/// Waits until a command has begun its work, which a file shows, or starts if there is no name, lets something happen to it, and sees that it ends soon afterwards.
fn end_of(folder: &Folder, mut command: Command, begun: &str, happens: impl FnOnce()) -> End {
    let streams = ["stdout", "stderr"].map(|name| File::create(folder.0.join(name)).unwrap());
    let [stdout, stderr] = streams;
    let mut running = Running(command.stdout(stdout).stderr(stderr).spawn().expect("mpirun is installed"));
    let start = Instant::now();
    while !folder.0.join(begun).exists() {
        let is_running = running.0.try_wait().unwrap().is_none();
        assert!(start.elapsed() < FIRST_STEP && is_running, "no work is begun: {}", folder.said());
        std::thread::sleep(Duration::from_millis(20));
    }
    happens();
    let start = Instant::now();
    let status = running.0.wait().unwrap();
    while !folder.processes().is_empty() && start.elapsed() < SOON {
        std::thread::sleep(Duration::from_millis(20));
    }
    let (took, said) = (start.elapsed(), folder.said());
    assert!(took < SOON && folder.processes().is_empty(), "after {took:?}: {said}");
    assert!(!status.success() && !said.is_empty(), "{said}");
    End { code: status.code(), said, took }
}

const RUN: &[&str] = &["run", "plate.toml", "--no-report", "--out", "results"];
const KEPT: &[&str] = &["run", "plate.toml", "--no-report", "--out", "results", "--history", "file:kept"];
const OPTIMIZE: &[&str] = &["optimize", "short.toml", "--no-report", "--out", "results"];
const GROUPS: &[&str] = &["optimize", "falls.toml", "--no-report", "--out", "results"];
const SWEEP: &[&str] = &["sweep", "stone.toml", "--vary", "load=0:1:300", "--vary", "lift=1:8:300", "--out", "results"];
const STEPS: &str = "results/histories.unfinished.csv";

/// What is done to the process of a rank.
const KILLED: &[&str] = &["kill", "-KILL"];
const ASLEEP: &[&str] = &["kill", "-STOP"];
const NO_MEMORY: &[&str] = &["prlimit", "--data=1", "--pid"];
const NO_ROOM: &[&str] = &["prlimit", "--fsize=1", "--pid"];

/// Of forty designs, forward and back.
const OPTIMIZATION: &str = r#"
[optimization]
minimize = "mass"
constraint = [{ functional = "strain energy, integral", at_most = 1e-9 }]
"#;

#[test]
fn all_ranks_end_where_one_fails_at_work() {
    let faults = [
        ("killed at the start", RUN, "", KILLED, "process"),
        ("killed", RUN, STEPS, KILLED, "signal 9"),
        ("killed, forward or back", OPTIMIZE, "results/optimization.csv", KILLED, "signal 9"),
        ("killed in a group", GROUPS, "results/optimization.csv", KILLED, "signal 9"),
        ("killed in a sweep", SWEEP, "results/sweep.csv", KILLED, "signal 9"),
        ("asleep at the start", SWEEP, "", ASLEEP, "within"),
        ("asleep", RUN, STEPS, ASLEEP, "within"),
        ("asleep in a sweep", SWEEP, "results/sweep.csv", ASLEEP, "within"),
        ("asleep in a group", GROUPS, "results/optimization.csv", ASLEEP, "within"),
        ("asleep, forward or back", OPTIMIZE, "results/optimization.csv", ASLEEP, "within"),
        ("no memory", RUN, STEPS, NO_MEMORY, "memory allocation of"),
        ("no memory, forward or back", OPTIMIZE, "results/optimization.csv", NO_MEMORY, "memory allocation of"),
        ("no room for the file of steps", KEPT, STEPS, NO_ROOM, "File too large"),
        ("no room for a table of designs", OPTIMIZE, "results/optimization.csv", NO_ROOM, "File too large"),
        ("no room for rows of a sweep", SWEEP, "results/sweep.csv", NO_ROOM, "File too large"),
    ];
    for (place, (name, arguments, begun, happens, words)) in faults.into_iter().enumerate() {
        each_time(name, |time| {
            let folder = Folder::new("at-work", 10_000);
            fs::write(folder.0.join("stone.toml"), STONE).unwrap();
            fs::write(folder.0.join("short.toml"), plate(4) + OPTIMIZATION).unwrap();
            fs::write(folder.0.join("falls.toml"), plate(4) + FALLS).unwrap();
            let ranks = match begun {
                "" => 2 + time % 2,
                _ if arguments == GROUPS => 4 + time % 2,
                _ => 2 + time % 3,
            };
            // a file that is too large is an error, and no signal
            let mut command = folder.by_shell(&[(ranks, "trap '' XFSZ; exec \"$0\" \"$@\"")], arguments);
            command.env("COSTATE_LONGEST_WAIT", if happens == ASLEEP { LONGEST_WAIT } else { "100" });
            // memory that is freed goes back: each matrix asks for some
            command.env("MALLOC_MMAP_THRESHOLD_", "65536");
            let rank = if happens == NO_ROOM { 0 } else { (place + time) % ranks };
            let end = end_of(&folder, command, begun, || {
                std::thread::sleep(Duration::from_millis(time as u64 * 977 % if begun.is_empty() { 1000 } else { 2500 }));
                let process = folder.process_of(rank, ranks);
                assert!(Command::new(happens[0]).args(&happens[1..]).arg(process).status().unwrap().success());
            });
            assert!(end.said.contains(words), "{name}, rank {rank} of {ranks}: {}", end.said);
            assert!(happens != ASLEEP || end.code == Some(70), "{:?}: {}", end.code, end.said);
            // what was finished before can be read
            let tables = [begun, "results/histories.csv"].map(|file| fs::read_to_string(folder.0.join(file)));
            let rows = tables.into_iter().find_map(Result::ok);
            assert!(begun.is_empty() || happens == NO_ROOM || rows.is_some(), "{name}: {}", end.said);
            let rows = rows.unwrap_or_default();
            let columns: Vec<usize> = rows.lines().skip(1).map(|row| row.split(',').count()).collect();
            assert!(columns.iter().all(|&count| count == columns[0]), "{rows}");
            end.took
        });
    }
}

#[test]
fn all_ranks_end_where_one_has_no_memory_from_the_start() {
    // where MPI begins, it may wait for what does not come
    each_time("no memory from the start", |time| {
        let folder = Folder::new("no-memory", 10_000);
        let limited = format!("ulimit -v {}; exec \"$0\" \"$@\"", 205_000 - 9_900 * time);
        let mut command = folder.by_shell(&[(1 + time % 3, "exec \"$0\" \"$@\""), (1, &limited)], RUN);
        command.env("COSTATE_LONGEST_WAIT", LONGEST_WAIT);
        end_of(&folder, command, "", || {}).took
    });
}

/// A number whose equation vanishes in the second step.
const SINGULAR: &str = r#"
[[coordinate]]
name = "c{i}"
for = { i = { from = 1, to = 3 } }
rate = 1
[[element]]
name = "mass {i}"
for = { i = { from = 1, to = 3 } }
nodes = { x = "c{i}" }
kinetic = "0.5 * x.rate^2"
force = { x = "2^23 * (1 + tanh(1e9 * (t - 1.1 / 1024))) * x.value" }
"#;

#[test]
fn all_ranks_tell_a_singular_system_as_one_process_does() {
    each_time("singular", |time| {
        let folder = Folder::new("singular", 10_000);
        let scene = plate(4) + &SINGULAR.replace("to = 3", &format!("to = {}", 1 + time % 7));
        fs::write(folder.0.join("plate.toml"), scene).unwrap();
        let expected = error_of(&folder.run(1, &["run", "plate.toml", "--no-report", "--out", "expected"]));
        assert!(expected.contains("error: step 2, stage 2") && expected.contains("do not determine \"c"), "{expected}");
        let end = end_of(&folder, folder.command(2 + time % 3, RUN), "", || {});
        assert!(end.said.contains(&expected) && end.code == Some(1), "{expected}\n{}", end.said);
        end.took
    });
}

#[test]
fn ranks_with_other_numbers_are_told() {
    each_time("other numbers", |time| {
        let folder = Folder::new("others", 2);
        let other = format!("exec \"$0\" \"$@\" --set 'thickness 3={}'", 0.01 + 1e-15 * 4_f64.powi(time as i32));
        let command = folder.by_shell(&[(1 + time % 3, "exec \"$0\" \"$@\""), (1, &other)], RUN);
        let End { code, said, took } = end_of(&folder, command, "", || {});
        assert_eq!(code, Some(70), "{said}");
        assert!(said.contains("different matrices") || said.contains("other numbers"), "{said}");
        took
    });
}

/// Stacks of a GiB: the system has room for as many threads as it is to start.
#[test]
fn with_fewer_threads_than_asked_for_bits_are_the_same_or_an_error_says_so() {
    let folder = Folder::new("threads", 2);
    fs::write(folder.0.join("stone.toml"), STONE).unwrap();
    let sweep =
        ["sweep", "stone.toml", "--vary", "lift=2:5:4", "--no-report", "--json", "--out", "results", "--threads", "3"];
    for arguments in [&["gradient", "plate.toml", "--no-report", "--json"], &sweep[..]] {
        let run = |threads: usize| {
            let kilobytes = (threads << 20) + 800_000;
            let mut command = Command::new("sh");
            command.args(["-c", &format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\""), PROGRAM]).args(arguments);
            let command = folder.here(&mut command).env("RAYON_NUM_THREADS", "2").env("RUST_MIN_STACK", "1073741824");
            command.output().unwrap()
        };
        let found = |output: &Output| {
            let rows = fs::read(folder.0.join("results/sweep.csv")).unwrap_or_default();
            (json(output)["functionals"].clone(), rows)
        };
        let expected = found(&run(20));
        let mut finished = 0;
        for threads in 0..8 {
            let output = run(threads);
            match error_of(&output).is_empty() {
                true => {
                    assert!(found(&output) == expected, "{threads} threads");
                    finished += 1;
                }
                false => assert_eq!(output.status.code(), Some(1), "{threads} threads: {}", text(&output.stderr)),
            }
        }
        assert!((3..8).contains(&finished), "{finished} of 8");
    }
}
