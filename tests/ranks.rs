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

/// Starts a long run, does something to its second rank, and returns how it ended, which it must soon.
fn fault(name: &str, (ranks, longest_wait): (usize, &str), signal: &str, later: Duration) -> Output {
    let folder = Folder::new(name, 10_000);
    let mut command = folder.command(ranks, &["run", "plate.toml", "--no-report", "--out", "results"]);
    command.env("COSTATE_LONGEST_WAIT", longest_wait).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("mpirun is installed where the feature mpi is tested");
    let mut running = Running(child);
    let process = folder.process_of(1).to_string();
    let table = folder.0.join("results/histories.unfinished.csv");
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
