//! The program as its users meet it: exit codes, messages, files, JSON.

use costate::integrators::{STATIC_TABLE, table_names};
use costate::scenes::file::OwnParts;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// An empty folder of its own for one test, removed when dropped; the program runs inside it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("costate-command-line-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
        command.args(arguments).current_dir(&self.0);
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    fn files(&self, inside: &str) -> Vec<String> {
        names(&self.0.join(inside))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(output: &Output) -> Value {
    let text = text(&output.stdout);
    let objects = text.lines().filter(|line| line.starts_with('{')).count();
    assert_eq!(objects, 1, "{text}");
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

/// Numbers of a CSV file, row by row, behind its header.
fn csv(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().split(',').map(String::from).collect();
    (header, lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect())
}

const FILES: [&str; 3] = ["histories.csv", "report.html", "summary.json"];

/// The files of a run.
fn results() -> Vec<&'static str> {
    let arrow = cfg!(feature = "arrow").then_some("histories.arrow");
    arrow.into_iter().chain(FILES).collect()
}

#[test]
fn bad_input_ends_with_code_2_and_one_message_that_says_what_is_allowed() {
    let folder = Folder::new("input");
    let cases: &[(&[&str], &[&str])] = &[
        (&["run", "five-bra"], &["scene \"five-bra\"", "did you mean \"five-bar\"?", "pendulum"]),
        (&["gradient", "crane"], &["scene \"crane\"", "pendulum", "five-bar"]),
        (&["run", "pendulum", "--stpes", "3"], &["--stpes", "--steps"]),
        (&["run", "pendulum", "--steps", "0"], &["--steps", "'0'", "whole number from 1 to"]),
        (&["run", "pendulum", "--steps", "-5"], &["--steps", "'-5'", "whole number from 1 to"]),
        (&["run", "pendulum", "--end", "-1"], &["--end", "'-1'", "above 0"]),
        (&["run", "pendulum", "--end", "inf"], &["--end", "'inf'", "above 0"]),
        (&["run", "pendulum", "--method", "esdrik3"], &["--method \"esdrik3\"", "\"esdirk3\"?", "midpoint"]),
        (&["run", "pendulum", "--method", "typo"], &["--method \"typo\"", "bdf3, variational, static"]),
        (&["run", "pendulum", "--method", "generalized-alpha:2"], &["--method", "generalized-alpha:2", "from 0 to 1"]),
        (
            &["run", "pendulum", "--method", "bdf2", "--tolerance", "1e-6"],
            &["\"bdf2\"", "sdirk4, esdirk3, esdirk4, esdirk5"],
        ),
        (&["run", "pendulum", "--tolerance", "0"], &["--tolerance", "'0'", "above 0"]),
        (&["run", "pendulum", "--tolerance", "1e-6", "--steps", "5"], &["--tolerance", "--steps"]),
        (&["run", "pendulum", "--longest-step", "0.1"], &["--tolerance"]),
        (&["run", "pendulum", "--output-step", "-1"], &["--output-step", "'-1'", "above 0"]),
        (&["run", "pendulum", "--output-step", "1e-9"], &["--output-step", "10000000"]),
        (&["run", "pendulum", "--constraint-level", "index3"], &["--constraint-level \"index3\"", "acceleration"]),
        (&["run", "pendulum", "--constraint-level", "velocity"], &["not known any more", "\"acceleration\" has"]),
        (&["run", "pendulum", "--film"], &["--film", "report.html"]),
        (&["run", "pendulum", "--set", "lenght=2"], &["--set lenght=2", "\"length\"?", "mass, length, gravity"]),
        (&["run", "pendulum", "--set", "length"], &["--set \"length\"", "NAME=VALUE"]),
        (&["run", "pendulum", "--set", "length=long"], &["\"long\" is not a number", "between 0.1 and 10 m"]),
        (&["run", "pendulum", "--set", "length=11"], &["length=11", "between 0.1 and 10 m"]),
        (&["run", "pendulum", "--set", "length=1e300"], &["\"length\" is 1e300 m", "between 0.1 and 10 m"]),
        (&["run", "pendulum", "--set", "length=nan"], &["length=nan", "between 0.1 and 10 m"]),
        (&["run", "pendulum", "--set", "mass=1", "--set", "mass=2"], &["mass=2", "already set"]),
        (&["gradient", "pendulum", "--history", "disk"], &["--history", "'disk'", "file:PATH", "checkpoints:MEGABYTES"]),
        (&["gradient", "pendulum", "--history", "checkpoints:-1"], &["--history", "'checkpoints:-1'", "above 0"]),
        (&["modes", "pendulum"], &["pendulum.toml", "equilibrium", "--static"]),
        (&["modes", "von-mises-truss", "--count", "0"], &["--count", "'0'", "whole number from 1 to"]),
        (&["modes", "von-mises-trust"], &["scene \"von-mises-trust\"", "did you mean \"von-mises-truss\"?"]),
        (&["run", "double-pendulum", "--method", "statics"], &["--method \"statics\"", "\"static\"?"]),
        (&["run", "free-body", "--method", "static"], &["initial velocity", "in statics nothing moves"]),
        (&["optimize", "pendulum"], &["\"pendulum\" states no optimization problem", "five-bar", "slider-crank"]),
        (&["fit", "pendulum"], &["\"pendulum\" has no measurements", "damped-oscillator"]),
        (&["fit", "damped-oscillator", "--end", "1"], &["\"place of the mass\" has a value at 3 s", "from 0 to 1 s"]),
        (&["fit", "damped-oscillator", "--restart", "no.csv"], &["--restart no.csv", "cannot read no.csv"]),
        (&["optimize", "five-bar", "--optimizer", "spq"], &["--optimizer \"spq\"", "did you mean \"sqp\"?"]),
        (&["optimize", "five-bar", "--gradient", "difference:2"], &["--gradient", "'difference:2'", "between 0 and 1"]),
        (&["optimize", "five-bar", "--iterations", "0"], &["--iterations", "'0'", "whole number from 1 to"]),
        (&["optimize", "five-bar", "--starts", "0"], &["--starts", "'0'", "whole number from 1 to"]),
        (&["optimize", "five-bar", "--change", "-1"], &["--change", "'-1'", "between 0 and 1"]),
        (&["optimize", "five-bar", "--restart", "no.csv"], &["--restart no.csv", "cannot read no.csv"]),
        (&["optimize", "five-bar", "--restart", "no.csv", "--set", "c=1"], &["--restart no.csv", "leave --set out"]),
        (&["optimize", "five-bar", "--output-step", "0.1"], &["--output-step", "leave it out"]),
        (&["optimize", "five-bar", "--set", "L01=9"], &["L01=9", "between 0.5 and 4 m"]),
        (&["verify", "--record"], &["--record", "<NAME>"]),
        (&["run"], &["<SCENE>"]),
    ];
    for (arguments, expected) in cases {
        let output = folder.run(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert_eq!(message.matches("error:").count(), 1, "{arguments:?}: {message}");
        for part in *expected {
            assert!(message.contains(part), "{arguments:?}: {part} is not in {message}");
        }
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
    }
    assert!(folder.files("").is_empty(), "bad input left {:?}", folder.files(""));
}

#[test]
fn a_run_writes_its_files_and_the_json_repeats_the_table() {
    let folder = Folder::new("run");
    let output = folder.run(&["run", "pendulum", "--end", "0.5", "--steps", "20", "--set", "length=2", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "", "a pipe gets no progress bar");
    assert!(!text(&output.stdout).contains(['\r', '\u{1b}']));
    assert_eq!(folder.files("out/pendulum"), results());

    let (header, rows) = csv(&folder.0.join("out/pendulum/histories.csv"));
    let expected = ["t [s]", "bob.x [m]", "bob.y [m]", "bob.z [m]", "bob.dx/dt [m/s]", "bob.dy/dt [m/s]", "bob.dz/dt [m/s]"];
    assert_eq!(header[..7], expected);
    let others = ["bob.d2x/dt2 [m/s2]", "bob.d2y/dt2 [m/s2]", "bob.d2z/dt2 [m/s2]", "energy [J]", "rod.mu1"];
    assert_eq!(header[7..12], others);
    assert_eq!(header[12..15], ["rod.force_x [N]", "rod.force_y [N]", "rod.force_z [N]"]);
    // what functionals measure: height, x, rod force
    assert!(header.join(",").ends_with("\"measured for rod force, integral [N]\""), "{header:?}");
    assert!(rows.iter().all(|row| row[15..] == [row[2], row[1], row[11]]), "{:?}", rows[3]);
    assert_eq!(rows.len(), 21);
    assert_eq!([rows[0][0], rows[20][0]], [0.0, 0.5]);
    // tension of a rod released from rest: m (g sin + v^2 / l) with v^2 = 2 g l sin; mu pulls at the bob
    let last = &rows[20];
    let tension = 3.0 * 9.81 * (-last[2] / 2.0);
    assert!((last[11] - tension).abs() < 1e-4 * tension, "{} {tension}", last[11]);
    // Newton's law for a mass of 1 kg: its acceleration is the force of the rod and its weight, but for the direction of the rod, which the
    // projection turns by the error of a step after the stage that both belong to
    for row in &rows {
        assert!((0..3).all(|k| (row[7 + k] - row[12 + k] - [0.0, -9.81, 0.0][k]).abs() < 1e-6), "{row:?}");
    }
    let drift = rows.iter().map(|row| (row[10] - rows[0][10]).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-4 * 9.81, "energy drifts by {drift} J");

    let object = json(&output);
    assert_eq!([&object["scene"], &object["method"]], ["pendulum", "esdirk4"]);
    assert_eq!(object["design"]["length"], 2.0);
    assert_eq!(object["files"].as_array().unwrap().len(), results().len());
    let table = text(&output.stdout);
    for functional in object["functionals"].as_array().unwrap() {
        let name = functional["name"].as_str().unwrap();
        let line = table.lines().find(|line| line.starts_with(name)).unwrap();
        let shown: f64 = line[name.len()..].split_whitespace().next().unwrap().parse().unwrap();
        let value = functional["value"].as_f64().unwrap();
        assert!((shown - value).abs() <= 1e-12 * value.abs(), "{line}: {value}");
    }
    let x = object["functionals"][1]["value"].as_f64().unwrap();
    assert!((x - last[1]).abs() < 1e-14, "{x} {}", last[1]);
    for (words, name) in [
        ("steps", "steps"),
        ("systems", "systems"),
        ("Newton iterations", "newton_iterations"),
        ("factorizations", "factorizations"),
        ("solves", "solves"),
        ("residual evaluations", "residual_evaluations"),
    ] {
        let line = table.lines().find(|line| line.starts_with(words)).unwrap();
        let shown: u64 = line[words.len()..].trim().parse().unwrap();
        assert_eq!(object[name], shown);
    }
}

#[test]
fn histories_have_angular_velocities_and_loads_of_joints_that_obey_the_laws_of_newton_and_euler() {
    let folder = Folder::new("laws");
    let output = folder.run(&["run", "heavy-top", "--end", "1", "--steps", "100"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let (header, rows) = csv(&folder.0.join("out/heavy-top/histories.csv"));
    let vector = |row: &[f64], names: [&str; 3]| {
        names.map(|name| row[header.iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}: {header:?}"))])
    };
    let three = |before: &str, after: &str| ["x", "y", "z"].map(|k| format!("{before}{k}{after}"));
    let read = |row: &[f64], names: [String; 3]| vector(row, [&names[0], &names[1], &names[2]]);
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    // of a top of 1 kg with inertia 0.75 across and 0.5 along its axis, whose tip is at the origin: place, angular velocity, moment of momentum
    let momentum = |row: &[f64]| {
        let (place, omega) = (read(row, three("top.", " [m]")), read(row, three("top.omega_", " [rad/s]")));
        let spin: f64 = (0..3).map(|k| place[k] * omega[k] / 0.5).sum();
        (spin, [0, 1, 2].map(|k| 0.75 * omega[k] + (0.5 - 0.75) * spin * place[k] / 0.5))
    };
    for (i, row) in rows.iter().enumerate() {
        let force = read(row, three("tip.force_", " [N]"));
        let acceleration = ["x", "y", "z"].map(|k| format!("top.d2{k}/dt2 [m/s2]"));
        let acceleration = read(row, acceleration);
        assert!((0..3).all(|k| (acceleration[k] - force[k] - [0.0, 0.0, -2.0][k]).abs() < 1e-8), "row {i}");
        assert!(read(row, three("tip.moment_", " [N m]")).iter().all(|moment| moment.abs() < 1e-9), "a spherical joint");
        assert!((momentum(row).0 - 10.0).abs() < 1e-6, "its spin stays: {}", momentum(row).0);
    }
    // d(moment of momentum)/dt = moment of the tip's force about the mass centre, by central differences
    for rows in rows.windows(3) {
        let h = rows[1][0] - rows[0][0];
        let place = read(&rows[1], three("top.", " [m]"));
        let moment = cross(place.map(|x| -x), read(&rows[1], three("tip.force_", " [N]")));
        let (before, after) = (momentum(&rows[0]).1, momentum(&rows[2]).1);
        assert!((0..3).all(|k| ((after[k] - before[k]) / (2.0 * h) - moment[k]).abs() < 5e-3), "{moment:?}");
    }
}

#[test]
fn histories_have_what_springs_elements_and_states_tell_and_warn_of_tables_that_are_left() {
    let folder = Folder::new("outputs");
    let scene = r#"
        version = 1
        settings = { end = 0.5, steps = 100 }
        [table.drag]
        points = [-0.5, 0, 0.5]
        values = [-1, 0, 1]
        [[point]]
        name = "mass"
        position = [1.2, 0, 0]
        mass = 2
        [[joint]]
        name = "rail"
        type = "point_on_line"
        between = ["ground", "mass"]
        axis = [1, 0, 0]
        [[spring]]
        name = "spring"
        type = "line"
        between = ["ground", "mass"]
        stiffness = 50
        rest_length = 1
        [[damper]]
        name = "damper"
        type = "line"
        between = ["ground", "mass"]
        damping = 0.5
        [[element]]
        name = "brake"
        nodes = { m = "mass", c = "control" }
        force = { m = "[-drag(m.velocity.x) + c.output, 0, 0]" }
        [[state]]
        name = "control"
        type = "pid"
        nodes = { m = "mass" }
        measured = "m.position.x"
        set_point = 1
        proportional = 3
        integral = 2
        [[functional]]
        name = "x"
        type = "position"
        on = "mass"
        direction = [1, 0, 0]
        over = "terminal"
    "#;
    fs::write(folder.0.join("held.toml"), scene).unwrap();
    let output = folder.run(&["run", "held.toml", "--out", "out"]);
    let warnings = text(&output.stderr);
    assert!(output.status.success(), "{warnings}");
    assert!(
        warnings.contains("\"brake\" reads a table beyond its points") && warnings.contains("from -0.5 to 0.5"),
        "{warnings}"
    );
    let (header, rows) = csv(&folder.0.join("out/histories.csv"));
    let column = |name: &str| header.iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}: {header:?}"));
    assert!(!header.iter().any(|name| name.starts_with("control.q0")), "{header:?}");
    for row in &rows {
        let at = |name: &str| row[column(name)];
        let (x, v) = (at("mass.x [m]"), at("mass.dx/dt [m/s]"));
        let error = 1.0 - x;
        for (name, expected) in [
            ("spring.length [m]", x),
            ("spring.rate [m/s]", v),
            ("spring.force [N]", 50.0 * (x - 1.0)),
            ("damper.force [N]", 0.5 * v),
            ("control.error", error),
            ("control.dintegral_term/dt", 2.0 * error),
            ("control.output", 3.0 * error + at("control.integral_term")),
            ("brake.m.force_x [N]", -2.0 * v + at("control.output")),
        ] {
            assert!((at(name) - expected).abs() < 1e-11, "{name}: {} {expected}", at(name));
        }
        // Newton's law, by what the columns say
        let forces = at("brake.m.force_x [N]") - at("spring.force [N]") - at("damper.force [N]");
        assert!((2.0 * at("mass.d2x/dt2 [m/s2]") - forces).abs() < 1e-9, "{row:?}");
    }
    assert!(
        fs::read_to_string(folder.0.join("out/report.html"))
            .unwrap()
            .contains("forces of springs, dampers and elements [N]")
    );
    let output = folder.run(&["run", "held.toml", "--out", "few", "--end", "0.01", "--steps", "2", "--json"]);
    assert_eq!(json(&output)["scene"], "held");
    fs::write(folder.0.join("few.toml"), format!("{scene}\n[output]\nhistories = [\"spring\", \"control\"]\n")).unwrap();
    folder.run(&["run", "few.toml", "--out", "few"]);
    assert_eq!(csv(&folder.0.join("few/histories.csv")).0.len(), 1 + 3 + 4);
}

#[test]
fn what_a_projection_of_the_start_changed_is_told() {
    let folder = Folder::new("projected");
    let scene = |velocity: &str| {
        format!(
            "version = 1\nsettings = {{ end = 0.1, steps = 10, project_start = true }}\n\
             [[point]]\nname = \"bob\"\nposition = [1, 0, 0]\nvelocity = {velocity}\nmass = 1\n\
             [[point]]\nname = \"other\"\nposition = [0, 2, 0]\nvelocity = [0, 7, 0]\nmass = 1\n\
             [[joint]]\nname = \"rod\"\ntype = \"distance\"\nbetween = [\"ground\", \"bob\"]\n"
        )
    };
    fs::write(folder.0.join("off.toml"), scene("[3, 4, 0]")).unwrap();
    fs::write(folder.0.join("right.toml"), scene("[0, 4, 0]")).unwrap();
    let output = folder.run(&["run", "off.toml", "--out", "off", "--json"]);
    let told = text(&output.stdout);
    assert!(
        told.contains("(3, 4, 0)")
            && told.contains("(0, 4, 0)")
            && told.contains("rates that stay as they are given: other"),
        "{told}"
    );
    let start = &json(&output)["projected_start"];
    assert_eq!((start["changes"].as_array().unwrap().len(), &start["rates_kept"][0]), (1, &Value::from("other")), "{start}");
    assert_eq!((&start["changes"][0]["part"], &start["changes"][0]["quantity"]), (&"bob".into(), &"velocity".into()));
    let output = folder.run(&["run", "right.toml", "--out", "right"]);
    assert!(
        text(&output.stdout).contains("project_start: the start fits the constraints as it is given"),
        "{}",
        text(&output.stdout)
    );
}

#[test]
fn the_summary_is_the_json_object_and_the_report_is_one_file() {
    let folder = Folder::new("summary");
    let output = folder.run(&["gradient", "five-bar", "--end", "0.3", "--steps", "15", "--check", "--json"]);
    let summary: Value = serde_json::from_slice(&fs::read(folder.0.join("out/five-bar/summary.json")).unwrap()).unwrap();
    assert_eq!(summary, json(&output));
    let report = fs::read_to_string(folder.0.join("out/five-bar/report.html")).unwrap();
    assert!(report.len() < 10_000_000 && !report.contains("{{"), "{} bytes", report.len());
    for part in ["three.js authors", "Leon Sorokin", "\"title\":\"five-bar\"", "Gradient of psi"] {
        assert!(report.contains(part), "{part}");
    }
}

#[test]
fn without_a_report_the_gradient_is_the_same_and_what_only_its_colours_show_is_not_computed() {
    let folder = Folder::new("no-report");
    let arguments = ["gradient", "plate-pendulum", "--end", "0.03", "--steps", "3", "--json", "--out"];
    let full = folder.run(&[&arguments[..], &["full"]].concat());
    let brief = folder.run(&[&arguments[..], &["brief", "--no-report"]].concat());
    let wanted = ["report.html"];
    assert_eq!(
        folder.files("full").into_iter().filter(|own| !wanted.contains(&own.as_str())).collect::<Vec<_>>(),
        folder.files("brief")
    );
    let gradient = |output: &Output| {
        json(output)["functionals"].as_array().unwrap().iter().map(|own| own["gradient"].clone()).collect::<Vec<_>>()
    };
    for (a, b) in gradient(&full).iter().zip(gradient(&brief)) {
        for (name, value) in a.as_object().unwrap() {
            let (own, other) = (value.as_f64().unwrap(), b[name].as_f64().unwrap());
            assert!((own - other).abs() <= 1e-12 * own.abs(), "{name}: {own} {other}");
        }
    }
    let report = |name: &str| fs::read_to_string(folder.0.join(name).join("report.html"));
    assert!(report("full").unwrap().contains("by a relative change of thickness") && report("brief").is_err());
}

#[test]
fn a_checked_gradient_shows_adjoint_and_complex_step_side_by_side() {
    let folder = Folder::new("gradient");
    let arguments = ["gradient", "five-bar", "--end", "0.3", "--steps", "15", "--check", "--json", "--out", "here/there"];
    let output = folder.run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(folder.files("here/there"), results());
    let object = json(&output);
    assert_eq!(object["pass"], true);
    assert!(object["largest_relative_difference"].as_f64().unwrap() <= 1e-10);
    let psi = &object["functionals"][0];
    assert_eq!(psi["name"], "psi");
    let table = text(&output.stdout);
    for (variable, gradient) in psi["gradient"].as_object().unwrap() {
        let line = table.lines().find(|line| line.starts_with(&format!("{variable} "))).unwrap();
        let shown: Vec<f64> =
            line.split_whitespace().filter(|word| word.contains("e")).map(|word| word.parse().unwrap()).collect();
        let (adjoint, complex_step) = (gradient.as_f64().unwrap(), psi["complex_step"][variable].as_f64().unwrap());
        assert!(adjoint != 0.0 && (adjoint - complex_step).abs() <= 1e-9 * adjoint.abs(), "{line}");
        assert!((shown[0] - adjoint).abs() <= 1e-12 * adjoint.abs(), "{line}");
        assert!((shown[1] - complex_step).abs() <= 1e-12 * complex_step.abs(), "{line}");
    }
    for name in ["forward_s", "adjoint_s", "complex_step_s", "adjoint_per_forward"] {
        assert!(object[name].as_f64().unwrap() > 0.0, "{name}");
    }
    for name in ["newton_iterations", "factorizations", "solves", "adjoint_factorizations", "adjoint_solves"] {
        assert!(object[name].as_u64().unwrap() > 0, "{name}");
    }
    assert!(object["adjoint_element_products"].as_u64().unwrap() > 0);
}

#[test]
fn a_gradient_is_the_same_wherever_its_steps_are_kept() {
    let folder = Folder::new("histories");
    let gradient = |history: &str| {
        let arguments = ["gradient", "pendulum", "--end", "0.5", "--steps", "60", "--history", history, "--json"];
        let output = folder.run(&arguments);
        assert_eq!(output.status.code(), Some(0), "{history}: {}", text(&output.stderr));
        json(&output)
    };
    let (memory, file, checkpoints) = (gradient("memory"), gradient("file:kept/run.bin"), gradient("checkpoints:0.05"));
    for other in [&file, &checkpoints] {
        assert_eq!(memory["functionals"], other["functionals"]);
    }
    assert_eq!([&memory["steps_in_memory"], &memory["adjoint_recomputed_steps"]], [60, 0]);
    assert_eq!(file["steps_in_memory"], 0);
    let written = fs::metadata(folder.0.join("kept/run.bin")).unwrap().len();
    assert_eq!(file["history_bytes_written"], written);
    assert_eq!(checkpoints["steps_in_memory"], 1);
    assert!(checkpoints["adjoint_recomputed_steps"].as_u64().unwrap() >= 59);
    assert!(checkpoints["checkpoints"].as_u64().unwrap() > 1);

    let run = folder.run(&["run", "pendulum", "--end", "0.5", "--steps", "60", "--json"]);
    assert_eq!(json(&run)["steps_in_memory"], 0, "a run without a gradient keeps no steps");

    let output = folder.run(&["gradient", "pendulum", "--history", "file:kept"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("history file kept cannot be created") && message.contains("not of a folder"), "{message}");
}

#[test]
fn chosen_steps_are_counted_and_histories_written_at_the_times_asked_for() {
    let folder = Folder::new("chosen");
    let arguments = ["--method", "esdirk4", "--tolerance", "1e-6", "--velocity-tolerance", "1e-5", "--longest-step", "0.3"];
    let output =
        folder.run(&[&["gradient", "five-bar", "--check", "--output-step", "0.4", "--json"], &arguments[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let (object, table) = (json(&output), text(&output.stdout));
    assert_eq!(object["tolerance"]["coordinates"], 1e-6);
    assert_eq!(object["tolerance"]["velocities"], 1e-5);
    assert_eq!(object["pass"], true);
    for (words, name) in [("steps", "steps"), ("rejected steps", "rejected_steps")] {
        let line = table.lines().find(|line| line.starts_with(&format!("{words} "))).unwrap();
        let shown: u64 = line[words.len()..].split_whitespace().next().unwrap().parse().unwrap();
        assert!(object[name] == shown && shown > 0, "{line}");
    }
    let (_, rows) = csv(&folder.0.join("out/five-bar/histories.csv"));
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let expected: Vec<f64> = (0..=12).map(|i| f64::from(i) * 0.4).chain([5.0]).collect();
    assert_eq!(times, expected);
}

#[test]
fn a_run_that_fails_keeps_its_finished_steps() {
    let folder = Folder::new("failed");
    // steps of half a second: the mechanism is thrown too far for Newton's method
    let output = folder.run(&["run", "five-bar", "--steps", "10", "--json"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("step ") && message.contains("try a smaller step"), "{message}");
    assert!(message.contains("--steps above 10"), "{message}");
    let steps = json(&output)["steps"].as_u64().unwrap();
    assert!(text(&output.stdout).contains(&format!("stopped after {steps} of 10 steps")));
    assert_eq!(json(&output)["error"].as_str().unwrap(), message.trim_start_matches("error: ").trim_end());
    if steps > 0 {
        assert_eq!(csv(&folder.0.join("out/five-bar/histories.csv")).1.len() as u64, steps + 1);
    }
}

#[test]
fn a_folder_that_cannot_be_written_to_is_refused_before_the_run() {
    let folder = Folder::new("blocked");
    fs::write(folder.0.join("block"), "a file where a folder is needed").unwrap();
    for arguments in [&["run", "pendulum", "--out", "block"], &["gradient", "pendulum", "--out", "block/inside"]] {
        let output = folder.run(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("--out {}", arguments[3])) && message.contains("folder"), "{message}");
        assert_eq!(text(&output.stdout), "", "the run had started");
    }
    assert_eq!(folder.files(""), ["block"]);
    assert_eq!(fs::read_to_string(folder.0.join("block")).unwrap(), "a file where a folder is needed");
}

#[test]
fn the_program_with_the_studies_is_asked_for_where_it_is_not_beside() {
    let folder = Folder::new("verify");
    let alone = folder.0.join("costate");
    fs::copy(env!("CARGO_BIN_EXE_costate"), &alone).unwrap();
    let output = Command::new(alone).args(["verify", "orders"]).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for part in ["the studies are the program costate-verify", "cargo build --release -p costate-verification"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn the_list_has_every_scene() {
    let folder = Folder::new("lists");
    let scenes = json(&folder.run(&["list", "--json"]));
    let names: Vec<&str> = scenes["scenes"].as_array().unwrap().iter().map(|s| s["scene"].as_str().unwrap()).collect();
    assert!(names.contains(&"pendulum") && names.contains(&"five-bar"), "{names:?}");
}

#[test]
fn a_list_has_a_line_for_each_scene_and_of_one_scene_all_it_needs() {
    let folder = Folder::new("list");
    let all = text(&folder.run(&["list"]).stdout);
    let lines: Vec<&str> = all.lines().collect();
    let scenes = lines.iter().skip(2).take_while(|line| !line.is_empty()).count();
    assert_eq!(scenes, costate::scenes::built_in::names().count(), "{all}");
    let output = folder.run(&["list", "five-bar", "--json"]);
    let said = text(&output.stdout);
    for part in ["five-bar: ", "to optimize: minimize psi", "variable", "L01", "functional", "psi"] {
        assert!(said.contains(part), "{part} is not in {said}");
    }
    let object = json(&output);
    assert_eq!([&object["scene"], &object["functionals"][0]["name"]], ["five-bar", "psi"]);
    let output = folder.run(&["list", "five-bra"]);
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("\"five-bar\"?"));
}

#[test]
fn the_list_of_parts_has_all_types_of_the_sections_that_it_names() {
    let folder = Folder::new("parts");
    let parts = json(&folder.run(&["list", "--parts", "--json"]));
    let schema = costate::scenes::file::schema(&OwnParts::default());
    for section in ["joint", "driver", "spring", "damper"] {
        let of = |part: &&serde_json::Value| part["section"] == section;
        let listed: Vec<&str> =
            parts["parts"].as_array().unwrap().iter().filter(of).map(|part| part["name"].as_str().unwrap()).collect();
        let forms = schema["oneOf"][0]["properties"][section]["items"]["oneOf"].as_array().unwrap();
        let known: Vec<&str> = forms.iter().map(|form| form["properties"]["type"]["const"].as_str().unwrap()).collect();
        assert_eq!(listed, known, "{section}");
    }
    let said = text(&folder.run(&["list", "--parts"]).stdout);
    assert!(said.contains("between [point] pin_a pin_b"), "{said}");
}

#[test]
fn a_new_file_runs_and_its_gradient_is_right() {
    let folder = Folder::new("new");
    let output = folder.run(&["new", "here/arm.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = fs::read_to_string(folder.0.join("here/arm.toml")).unwrap();
    assert!(written.contains("costate run here/arm.toml  ") && !written.contains("NAME"), "{written}");
    let check = folder.run(&["check", "here/arm.toml"]);
    assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
    let gradient = json(&folder.run(&["gradient", "here/arm.toml", "--check", "--steps", "40", "--json"]));
    assert_eq!(gradient["pass"], true);
    let better = folder.run(&["optimize", "here/arm.toml", "--steps", "40", "--json"]);
    assert_eq!(better.status.code(), Some(0), "{}", text(&better.stderr));
    assert_eq!(json(&better)["optimum"], true);
    for (arguments, said) in [
        (["new", "here/arm.toml"], "exists already"),
        (["new", "arm"], "a scene file is named with .toml"),
        (["new", "here/arm.toml/x.toml"], "cannot create the folder"),
    ] {
        let output = folder.run(&arguments);
        let message = text(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(said), "{message}");
    }
    assert_eq!(fs::read_to_string(folder.0.join("here/arm.toml")).unwrap(), written);
    assert_eq!(folder.files("here"), ["arm.toml"]);
}

#[test]
fn the_help_of_every_command_has_examples() {
    let folder = Folder::new("help");
    for command in [
        "run",
        "gradient",
        "optimize",
        "fit",
        "sweep",
        "modes",
        "verify",
        "check",
        "new",
        "schema",
        "list",
        "completions",
        "man",
    ] {
        let help = text(&folder.run(&[command, "--help"]).stdout);
        // the parser of the command line adds its lists of values behind the last line of a description
        let own = |line: &&str| !["Usage", "[default: ", "[possible values: "].iter().any(|added| line.contains(added));
        let described = help.split("Examples:\n").next().unwrap().lines().filter(own);
        assert!(described.clone().all(|line| line.chars().count() <= 80), "{help}");
        let (_, examples) = help.split_once("Examples:\n").unwrap_or_else(|| panic!("{help}"));
        assert!(examples.lines().all(|line| line.starts_with(&format!("  costate {command}"))), "{examples}");
    }
}

#[test]
fn shells_complete_every_command_and_each_has_a_page_of_the_manual() {
    let folder = Folder::new("manual");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&folder.run(&["completions", shell]).stdout);
        assert!(["gradient", "resume", "constraint-level"].iter().all(|word| script.contains(word)), "{shell}: {script}");
    }
    assert_eq!(folder.run(&["completions", "dos"]).status.code(), Some(2));
    assert_eq!(folder.run(&["man", "pages"]).status.code(), Some(0));
    let pages = folder.files("pages");
    assert!(["costate.1", "costate-gradient.1"].iter().all(|page| pages.iter().any(|own| own == page)), "{pages:?}");
    let page = fs::read_to_string(folder.0.join("pages/costate-gradient.1")).unwrap();
    assert!(page.contains("complex\\-step") || page.contains("complex-step"), "{page}");
    fs::write(folder.0.join("taken"), "").unwrap();
    let output = folder.run(&["man", "taken"]);
    assert!(output.status.code() == Some(1) && text(&output.stderr).contains("man taken"), "{}", text(&output.stderr));
}

#[test]
fn output_that_nobody_reads_is_no_error() {
    let folder = Folder::new("pipe");
    let mut child = folder.command(&["list"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
}

#[cfg(unix)]
#[test]
fn ctrl_c_and_what_ends_batch_jobs_keep_the_finished_steps() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        finished_steps_survive(signal);
    }
}

fn finished_steps_survive(signal: &str) {
    let folder = Folder::new(&format!("interrupt{signal}"));
    let arguments = ["run", "five-bar", "--steps", "1000000"];
    let child = folder.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    // the folder appears just before the first step
    while !folder.0.join("out/five-bar").is_dir() {
        assert!(begun.elapsed() < Duration::from_secs(20), "the run does not start");
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(500));
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    let (_, rows) = csv(&folder.0.join("out/five-bar/histories.csv"));
    assert!(rows.len() > 1 && rows.len() < 1_000_001, "{} rows", rows.len());
    assert!(message.contains(&format!("interrupted after {} finished steps", rows.len() - 1)), "{message}");
    assert_eq!(folder.files("out/five-bar"), results());
}

#[test]
fn a_run_that_is_killed_leaves_its_rows_under_a_name_that_says_so() {
    let folder = Folder::new("killed");
    let mut child = folder.command(&["run", "five-bar", "--steps", "1000000"]).stdout(Stdio::null()).spawn().unwrap();
    let left = folder.0.join("out/five-bar/histories.unfinished.csv");
    let begun = Instant::now();
    while left.metadata().map_or(0, |file| file.len()) < 100_000 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no rows are written");
        std::thread::sleep(Duration::from_millis(10));
    }
    let second = folder.run(&["run", "five-bar", "--end", "0.1", "--steps", "10"]);
    let message = text(&second.stderr);
    assert!(second.status.code() == Some(1) && message.contains("histories.unfinished.csv is being written"), "{message}");
    child.kill().unwrap();
    child.wait().unwrap();
    let (header, rows) = csv(&left);
    assert!(rows.len() > 10 && rows.iter().all(|row| row.len() == header.len()), "{} rows", rows.len());
    assert!(!folder.0.join("out/five-bar/histories.csv").exists());
    assert_eq!(folder.run(&["run", "five-bar", "--end", "0.1", "--steps", "10"]).status.code(), Some(0));
    assert_eq!(folder.files("out/five-bar"), results());
}

#[test]
fn numbers_are_printed_where_a_file_cannot_be_written() {
    let folder = Folder::new("blocked-file");
    std::fs::create_dir_all(folder.0.join("out/pendulum/report.html")).unwrap();
    for command in ["run", "gradient"] {
        let output = folder.run(&[command, "pendulum", "--end", "0.1", "--steps", "10"]);
        let (said, message) = (text(&output.stdout), text(&output.stderr));
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("report.html") && message.contains("a folder of this name exists"), "{message}");
        assert!(said.contains("functional") && said.contains("histories.csv") && !said.contains("report.html"), "{said}");
        assert_eq!(said.contains("adjoint time / forward time"), command == "gradient", "{said}");
    }
}

#[test]
fn steps_that_do_not_resolve_the_motion_are_said() {
    let folder = Folder::new("coarse");
    let error_of = |steps: &str| {
        let output = folder.run(&["run", "five-bar", "--end", "2", "--steps", steps, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("largest estimated error of a step: "));
        (json(&output)["largest_step_error"]["share"].as_f64().unwrap(), text(&output.stderr))
    };
    let (fine, nothing) = error_of("200");
    assert!(fine < 1e-4 && !nothing.contains("warning"), "{fine:e} {nothing}");
    let (coarse, warning) = error_of("40");
    assert!(coarse > 2e-3 && warning.contains("warning: a step has an estimated error of"), "{coarse:e} {warning}");
    assert!(warning.contains("\"bar 3\", e3, velocity") && warning.contains("--steps above 40"), "{warning}");
}

#[test]
fn energy_that_grows_where_it_is_constant_is_said() {
    let folder = Folder::new("energy");
    let growth_of = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').chain(["--json"]).collect();
        let output = folder.run(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        (json(&output)["energy_growth"]["share_of_kinetic"].as_f64(), text(&output.stderr))
    };
    let (fine, nothing) = growth_of("run free-body --method newmark --steps 2000");
    assert!(fine.is_some_and(|share| share < 1e-4) && !nothing.contains("warning"), "{fine:?} {nothing}");
    let (coarse, warning) = growth_of("run free-body --method newmark --steps 20");
    assert!(coarse.is_some_and(|share| share > 2e-3), "{coarse:?}");
    assert!(warning.contains("warning: the energy of this scene is constant in an exact motion, but grows by"), "{warning}");
    // dampers and drives
    for other in ["run five-bar --end 0.1 --steps 20", "run slider-crank --end 0.1 --steps 20"] {
        assert_eq!(growth_of(other).0, None, "{other}");
    }
}

#[test]
fn a_run_goes_on_with_the_file_of_one_that_stopped() {
    let folder = Folder::new("resume");
    let arguments = ["gradient", "pendulum", "--end", "0.5", "--steps", "600", "--history", "file:run.history", "--json"];
    let whole = json(&folder.run(&arguments));
    let file = fs::read(folder.0.join("run.history")).unwrap();
    fs::remove_file(folder.0.join("run.history")).unwrap();
    fs::write(folder.0.join("run.history.part"), &file[..file.len() / 2]).unwrap();
    let resume: Vec<&str> = arguments.into_iter().chain(["--resume"]).collect();
    let resumed = json(&folder.run(&resume));
    assert_eq!(whole["functionals"], resumed["functionals"]);
    assert_eq!(whole["newton_iterations"], resumed["newton_iterations"]);
    let taken_over = resumed["steps_taken_over"].as_u64().unwrap();
    // half of the file: steps, and checkpoints, each as long as eight steps, that take a tenth of it
    assert!((150..=300).contains(&taken_over), "{taken_over}");
    for (arguments, said) in [
        (vec!["run", "pendulum", "--resume"], "name it, as in --history file:run.history"),
        (vec!["run", "andrews", "--resume", "--history", "file:run.history"], "another scene, design, method"),
        (vec!["run", "pendulum", "--history", "file:out/pendulum/histories.csv"], "results are written there"),
    ] {
        let output = folder.run(&arguments);
        assert!(output.status.code() == Some(2) && text(&output.stderr).contains(said), "{}", text(&output.stderr));
    }
}

#[test]
fn a_history_where_results_are_written_is_refused() {
    let folder = Folder::new("history-on-results");
    let output = folder.run(&["gradient", "pendulum", "--history", "file:out/pendulum/histories.csv"]);
    let message = text(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("results are written there"), "{message}");
}

#[test]
fn a_run_says_whether_its_energy_is_balanced_by_works() {
    let folder = Folder::new("balance");
    let run = folder.run(&["run", "universal-shaft", "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let balance = json(&run)["energy_balance_J"].clone();
    let [change, forces, drivers, left] =
        ["change", "forces", "drivers", "left"].map(|key| balance[key].as_f64().expect("a number"));
    assert!(forces < -1.0 && drivers > 1.0 && (change - forces - drivers - left).abs() < 1e-12, "{balance}");
    assert!(left.abs() < 1e-9 && text(&run.stdout).contains("loads and losses work -7.5"), "{balance}");
    // steps that hardly resolve the motion leave more, which is said
    let coarse = folder.run(&["run", "five-bar", "--method", "bdf1", "--steps", "400", "--json"]);
    assert!(text(&coarse.stderr).contains("loads and losses work"), "{}", text(&coarse.stderr));
    assert!(json(&folder.run(&["run", "pendulum", "--json"])).get("energy_balance_J").is_none(), "a conservative scene");
}

#[test]
fn a_run_tells_its_events() {
    let folder = Folder::new("events");
    let run = folder.run(&["run", "bouncing-ball", "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told = json(&run)["events"][0].clone();
    assert_eq!((told["name"].as_str(), told["count"].as_u64()), (Some("table"), Some(4)), "{told}");
    let exact = (2.0 / 9.81f64).sqrt();
    assert!((told["first_s"].as_f64().expect("a time") - exact).abs() < 1e-13, "{told}");
    let report = fs::read_to_string(folder.0.join("out/bouncing-ball/report.html")).unwrap();
    assert!(report.contains(r#""events":[{"name":"table","t":0.4515"#), "{}", report.len());
}

#[test]
fn a_scene_of_equilibria_runs_is_differentiated_and_vibrates() {
    let folder = Folder::new("statics");
    let run = folder.run(&["run", "von-mises-truss", "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let said = text(&run.stdout);
    assert!(said.contains("static, equilibria, 10 load steps up to the load factor 1"), "{said}");
    assert_eq!(folder.files("out/von-mises-truss"), results());
    let (header, rows) = csv(&folder.0.join("out/von-mises-truss/histories.csv"));
    let end = rows.last().expect("rows");
    let rates: Vec<f64> = header.iter().zip(end).filter(|(name, _)| name.contains("/dt")).map(|(_, v)| *v).collect();
    assert!(rates.len() == 6 && rates.iter().all(|&rate| rate == 0.0), "in statics nothing moves: {rates:?}");
    let z = json(&run)["functionals"][0]["value"].as_f64().expect("a height");
    // F = 2 k z (l / L - 1) is the load
    let (rest, length) = (1f64.hypot(0.2), 1f64.hypot(z));
    assert!((2000.0 * z * (rest / length - 1.0) - 2.5).abs() < 1e-11, "{z}");

    let modes = folder.run(&["modes", "von-mises-truss", "--json"]);
    assert_eq!(modes.status.code(), Some(0), "{}", text(&modes.stderr));
    let found = json(&modes);
    assert_eq!(found["about"], "equilibrium");
    assert_eq!(found["modes"].as_array().expect("modes").len(), 1);
    // m omega^2 = -dF/dz
    let expected = (2000.0 * (1.0 - rest / length.powi(3)) / 0.1).sqrt();
    let omega = found["modes"][0]["omega_rad_s"].as_f64().expect("a frequency");
    assert!((omega / expected - 1.0).abs() < 1e-11, "{omega} against {expected}");
    assert!(text(&modes.stdout).contains("there is only 1 mode"), "{}", text(&modes.stdout));
    let none = folder.run(&["modes", "princeton-beam"]);
    assert!(text(&none.stdout).contains("nothing that could move has inertia"), "{}", text(&none.stdout));
    let drawn = folder.run(&["modes", "von-mises-truss", "--out", "drawn"]);
    assert_eq!(drawn.status.code(), Some(0), "{}", text(&drawn.stderr));
    assert_eq!(folder.files("drawn"), ["modes.html", "modes.json"]);
    assert!(fs::read_to_string(folder.0.join("drawn/modes.html")).unwrap().contains("mode 1: "));

    let gradient = folder.run(&["gradient", "von-mises-truss", "--check", "--tolerance", "1e-6"]);
    assert_eq!(gradient.status.code(), Some(0), "{}", text(&gradient.stderr));
    // beyond the limit of the load: a jump or a message, no panic
    let beyond = folder.run(&["run", "von-mises-truss", "--set", "load=4", "--tolerance", "1"]);
    assert!(matches!(beyond.status.code(), Some(0 | 1)), "{}", text(&beyond.stderr));
}

const OPTIMIZED: [&str; 3] = ["optimization.csv", "optimization.html", "optimization.json"];

/// A column under twice its critical load with a thousandth of it across, in five equal load steps.
const COLUMN: &str = r#"
version = 1
variable.load = { initial = 4.9348, bounds = [0.1, 10] }
settings = { method = "static", steps = 5 }
section.s = { type = "beam", axial = 1e6, shear = [1e6, 1e6], torsion = 1, bending = [1, 1], mass = 1, inertia = [1e-6, 1e-6] }
[[beam]]
name = "beam"
from = [0, 0, 0]
to = [1, 0, 0]
elements = 8
section = "s"
second_axis = [0, 1, 0]
clamped = "start"
[[force]]
name = "load"
on = "beam.end"
direction = [-1, 0.001, 0]
size = { type = "constant_rate", rate = "load" }
[[functional]]
name = "y"
type = "position"
on = "beam.end"
direction = [0, 1, 0]
over = "terminal"
"#;

/// A cable that hardly stretches, pulled aside: in tension everywhere.
const CABLE: &str = r#"
version = 1
settings = { method = "static", steps = 20, divide_steps = true }
section.s = { type = "cable", axial = 1e10, bending = 1, mass = 1 }
[[cable]]
name = "cable"
from = [0, 0, 0]
to = [1, 0, 0]
elements = 8
section = "s"
clamped = "start"
[[force]]
name = "load"
on = "cable.end"
direction = [0, 1, 0]
size = { type = "constant_rate", rate = 5 }
"#;

#[test]
fn a_mesh_of_a_cable_that_is_unstable_itself_is_said_to_be_and_a_finer_one_stands() {
    let folder = Folder::new("cable");
    let finer = CABLE.replace("elements = 8", "elements = 24");
    let small = CABLE.replace("clamped", "strains = \"small\"\nclamped");
    for (text_of, stands) in [(CABLE, false), (&finer, true), (&small, true)] {
        fs::write(folder.0.join("cable.toml"), text_of).unwrap();
        let output = folder.run(&["run", "cable.toml"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let said = text(&output.stderr) + &text(&output.stdout);
        assert_eq!(said.contains("the equilibrium at the load factor 1 is stable"), stands, "{said}");
        assert_eq!(said.contains("UNSTABLE (3 negative eigenvalues"), !stands, "{said}");
        assert_eq!(said.contains("lose their stability by their mesh alone"), !stands, "{said}");
    }
}

#[test]
fn an_unstable_equilibrium_is_a_warning_and_an_error_where_it_has_to_be_stable() {
    let folder = Folder::new("unstable");
    fs::write(folder.0.join("column.toml"), COLUMN).unwrap();
    for command in ["run", "gradient"] {
        let output = folder.run(&[command, "column.toml", "--json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let said = text(&output.stderr);
        assert!(said.contains("warning") && said.contains("UNSTABLE (2 negative eigenvalues"), "{said}");
        assert!(said.contains("lost its stability between the load factors 0.4 and 0.6 (step 3)"), "{said}");
        assert!(said.contains("gradients") && said.contains("--tolerance 1e-6") && !said.contains("cables"), "{said}");
        let stability = &json(&output)["stability"];
        assert_eq!((&stability["verdict"], &stability["negative_eigenvalues"]), (&"unstable".into(), &2.into()));
        assert!(fs::read_to_string(folder.0.join("out/column/report.html")).unwrap().contains("UNSTABLE"));
        let refused = folder.run(&[command, "column.toml", "--stable", "--json"]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(text(&refused.stderr).contains("error: the equilibrium at the load factor 1 is UNSTABLE"));
        // the way that the message tells
        let output = folder.run(&[command, "column.toml", "--stable", "--tolerance", "1e-6", "--json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("the equilibrium at the load factor 1 is stable"));
        let object = json(&output);
        assert_eq!(object["stability"]["verdict"], "stable");
        let y = object["functionals"][0]["value"].as_f64().unwrap();
        assert!((y - 0.797).abs() < 1e-3, "{y}");
    }
}

#[test]
fn an_optimization_shows_before_and_after_and_is_taken_up_from_its_history() {
    let folder = Folder::new("optimize");
    let common = ["optimize", "five-bar", "--end", "1", "--steps", "50", "--json"];
    let output = folder.run(&[&common[..], &["--iterations", "3"]].concat());
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("no optimum: the limit of 3 iterations"), "{}", text(&output.stderr));
    assert_eq!(folder.files("out/five-bar"), OPTIMIZED);
    let (header, rows) = csv(&folder.0.join("out/five-bar/optimization.csv"));
    assert_eq!(header[..6], ["evaluation", "iteration", "objective", "violation", "failed", "design L01 [m]"]);
    let object = json(&output);
    assert_eq!((&object["reason"], &object["iterations"]), (&"iterations".into(), &3.into()));
    assert_eq!(object["simulations"], rows.len());
    let number = |value: &Value| value.as_f64().unwrap();
    let (before, after) = (number(&object["objective"]["before"]), number(&object["objective"]["after"]));
    assert!(after < before, "{before} -> {after}");
    let best = object["best_evaluation"].as_u64().unwrap() as usize;
    assert_eq!([rows[0][2], rows[best][2]], [before, after]);
    let table = text(&output.stdout);
    for part in ["minimize  psi", "adjoint sweeps", "3 iterations: the limit of iterations", "--set L01="] {
        assert!(table.contains(part), "{part} is not in {table}");
    }

    let file = "out/five-bar/optimization.csv";
    let first = fs::read(folder.0.join(file)).unwrap();
    let output = folder.run(&[&common[..], &["--restart", file, "--gradient", "difference"]].concat());
    assert!(text(&output.stdout).contains("kept the earlier table as out/five-bar/optimization.1.csv"));
    assert_eq!(fs::read(folder.0.join("out/five-bar/optimization.1.csv")).unwrap(), first, "no point is lost");
    // gradients by differences may not be good enough to verify an optimum
    let is_short = text(&output.stderr).contains("the accuracy of values or gradients is used up");
    assert_eq!(output.status.code(), Some(i32::from(is_short)), "{}", text(&output.stderr));
    let object = json(&output);
    assert_eq!(number(&object["objective"]["before"]), after, "the same design gives the same bits");
    assert!(number(&object["objective"]["after"]) < after, "{object}");
    let sweeps = object["gradient_sweeps"].as_u64().unwrap();
    assert_eq!(sweeps % 4, 0, "one simulation for each of four variables");
}

#[test]
fn a_fit_says_how_exactly_variables_are_known_and_is_taken_up_from_its_history() {
    let folder = Folder::new("fit");
    let common = ["fit", "damped-oscillator", "--json"];
    let output = folder.run(&[&common[..], &["--iterations", "2"]].concat());
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("the limit of 2 iterations is reached"), "{}", text(&output.stderr));
    let first = json(&output);
    let output = folder.run(&[&common[..], &["--restart", "out/damped-oscillator/fit.csv", "--out", "again"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let object = json(&output);
    assert_eq!(object["variables"][0]["before"], first["variables"][0]["estimate"], "the same bits");
    // by these the table was made
    for (variable, truth) in object["variables"].as_array().unwrap().iter().zip([80.0, 1.6, 0.1]) {
        let [estimate, deviation] = ["estimate", "deviation"].map(|key| variable[key].as_f64().unwrap());
        assert!((estimate - truth).abs() < 3.0 * deviation && deviation < 0.03 * truth, "{variable}");
    }
    assert_eq!(object["degrees_of_freedom"], 57);
    let (header, rows) = csv(&folder.0.join("again/residuals.csv"));
    assert_eq!((header.len(), rows.len()), (6, 60));
    let sum: f64 = rows.iter().map(|row| row[5] * row[5]).sum();
    assert!((sum / object["sum"].as_f64().unwrap() - 1.0).abs() < 1e-12);
    assert!(folder.0.join("again/fit.html").is_file() && text(&output.stdout).contains("least known: 0.92 damping"));
}

/// Thrown upwards: sharp or not, what is limited is a smooth maximum, and the stone itself goes higher.
#[test]
fn a_limit_that_is_kept_in_the_smooth_sense_only_is_said_with_the_largest_value() {
    let folder = Folder::new("smooth");
    let scene = r#"
version = 1
gravity = [0, 0, -10]
[variable]
w = { initial = 3, bounds = [1, 8], unit = "m/s" }
[settings]
end = 0.6
steps = 300
[[point]]
name = "stone"
mass = 1
position = [0, 0, 0]
velocity = [0, 0, "w"]
[[functional]]
name = "height"
type = "position"
on = "stone"
direction = [0, 0, 1]
over = { aggregate = "smooth_maximum", sharpness = 5 }
[[functional]]
name = "end"
type = "position"
on = "stone"
direction = [0, 0, 1]
over = "terminal"
[optimization]
maximize = "end"
[[optimization.constraint]]
functional = "height"
at_most = 1.0
"#;
    fs::write(folder.0.join("stone.toml"), scene).unwrap();
    let output = folder.run(&["optimize", "stone.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let object = json(&output);
    let w = object["design"]["w"].as_f64().unwrap();
    // closed form of the flight: w^2 / 2 g, after w / g
    let largest = &object["largest_values"][0]["largest"];
    let [value, t] = ["value", "t"].map(|key| largest[key].as_f64().unwrap());
    assert!((value - w * w / 20.0).abs() < 1e-4 && (t - w / 10.0).abs() < 2e-3, "{w}: {value} at {t}");
    assert!(value > 1.1, "{value}");
    let said = object["kept_in_the_smooth_sense_only"][0].as_str().unwrap();
    assert!(said.contains("\"height\" keeps its limit of 1 m in the smooth sense only"), "{said}");
    assert!(text(&output.stderr).contains("smooth sense only"), "{}", text(&output.stderr));
    assert_eq!(object["conditions"]["hold"], true);
    assert!(object["conditions"]["multipliers"][0]["multiplier"].as_f64().unwrap() > 0.0);
    // a run prints them too
    let run = folder.run(&["run", "stone.toml", "--no-report", "--json"]);
    let height = &json(&run)["functionals"][0];
    assert!((height["largest"]["value"].as_f64().unwrap() - 0.45).abs() < 1e-4, "{height}");
    assert!(text(&run.stdout).contains("true largest"), "{}", text(&run.stdout));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_an_optimization_with_its_best_design() {
    let folder = Folder::new("interrupted-optimization");
    let mut command = folder.command(&["optimize", "five-bar", "--steps", "2000", "--json"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let file = folder.0.join("out/five-bar/optimization.csv");
    let begun = Instant::now();
    while !file.exists() && begun.elapsed() < Duration::from_secs(120) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it wrote a point");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("best design") && message.contains("--restart"), "{message}");
    assert_eq!(json(&output)["reason"], "stopped");
    assert_eq!(csv(&file).1[0][1], 0.0, "the start");
    assert_eq!(folder.files("out/five-bar"), OPTIMIZED);
}

#[test]
fn the_scaled_rule_is_named_in_results_and_refused_for_gradients() {
    let folder = Folder::new("scaled");
    let run = folder.run(&["run", "pendulum", "--newton", "scaled", "--steps", "50", "--no-report", "--json"]);
    assert_eq!(run.status.code(), Some(0));
    assert!(text(&run.stdout).contains(", Newton's method by the rule \"scaled\""), "{}", text(&run.stdout));
    assert_eq!(json(&run)["newton"], "scaled");
    for command in ["gradient", "optimize"] {
        let refused = folder.run(&[command, "slider-crank", "--newton", "scaled"]);
        assert_eq!(refused.status.code(), Some(2));
        let message = text(&refused.stderr);
        assert!(message.contains("--newton scaled") && message.contains("no exact derivative"), "{message}");
    }
}

/// A wheel that turns through pi against a spring of torsion, whose moment jumps there.
const THROUGH_PI: &str = r#"
version = 1
[settings]
locate = false
end = 1
steps = 200
[variable]
speed = { initial = 12, bounds = [0, 20], unit = "rad/s" }
[[body]]
name = "wheel"
mass = 1
inertia = [1, 1, 1]
angular_velocity = [0, 0, "speed"]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "wheel"]
point = [0, 0, 0]
axis = [0, 0, 1]
[[spring]]
name = "clock"
type = "torsion"
between = ["ground", "wheel"]
axis = [0, 0, 1]
stiffness = 9
[[functional]]
name = "rate"
type = "joint_rate"
between = ["ground", "wheel"]
axis = [0, 0, 1]
over = "terminal"
"#;

#[test]
fn a_gradient_behind_a_jump_is_told_and_its_check_does_not_pass() {
    let folder = Folder::new("jump");
    // where steps end at it nothing is wrong
    fs::write(folder.0.join("located.toml"), THROUGH_PI.replace("locate = false", "locate = true")).unwrap();
    let output = folder.run(&["gradient", "located.toml", "--check=independent"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    fs::write(folder.0.join("wheel.toml"), THROUGH_PI).unwrap();
    let output = folder.run(&["gradient", "wheel.toml", "--check", "--json"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("the formula of \"clock\" jumps within the step")
            && said.contains("the gradient of \"rate\" is wrong"),
        "{said}"
    );
    let crossing = json(&output)["crossings"][0].clone();
    // (w0 / w) sin(w t) = pi with w = 3
    let exact = (std::f64::consts::PI * 3.0 / 12.0_f64).asin() / 3.0;
    assert!((crossing["t"].as_f64().unwrap() - exact).abs() <= 0.006, "{crossing}");
    assert_eq!((crossing["part"].as_str(), crossing["kind"].as_str()), (Some("clock"), Some("jump")));
    assert_eq!(json(&output)["pass"], false);
    // nor do runs of their own: the rate is one of pieces
    let output = folder.run(&["gradient", "wheel.toml", "--check=independent", "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert_eq!(json(&output)["pass"], false);
    // in a sweep it is told of that design
    let swept = folder.run(&["sweep", "wheel.toml", "--vary", "speed=9,12", "--gradient", "--out", "swept"]);
    assert_eq!(swept.status.code(), Some(0), "{}", text(&swept.stderr));
    let rows = fs::read_to_string(folder.0.join("swept/sweep.csv")).unwrap();
    let told: Vec<bool> = rows.lines().skip(1).map(|row| row.contains("\"\"clock\"\" jumps within the step")).collect();
    assert_eq!(told, [false, true], "{rows}");
    // slower, it turns back before
    for check in ["--check", "--check=independent"] {
        let output = folder.run(&["gradient", "wheel.toml", "--set", "speed=9", check, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(json(&output).get("crossings").is_none());
        assert_eq!(json(&output)["pass"], true);
    }
}

/// A bar on a hinge, heavy or not, that hangs at rest or is brought to rest by a motor at 0.4 s.
fn bar_on_a_hinge(coordinates: &str, gravity: f64, has_motor: bool) -> String {
    let motor = r#"
        [[driver]]
        name = "motor"
        type = "rotation"
        between = ["ground", "bar"]
        axis = [0, 1, 0]
        angle = { type = "smooth_ramp", to = "turn", duration = 0.4 }
    "#;
    let motor = if has_motor { motor } else { "" };
    format!(
        r#"
        version = 1
        gravity = [0, 0, "-g"]
        [variable]
        g = {{ initial = {gravity}, bounds = [0, 20], unit = "m/s2" }}
        size = {{ initial = 0.7, bounds = [0.1, 10], unit = "m" }}
        mass = {{ initial = 1.3, bounds = [0.1, 10], unit = "kg" }}
        turn = {{ initial = 0.5, bounds = [-10, 10], unit = "rad" }}
        [settings]
        end = 1.0
        steps = 200
        [[body]]
        name = "bar"
        coordinates = "{coordinates}"
        position = [0, 0, "-size / 2"]
        mass = "mass"
        inertia = [0.11, 0.12, 0.13]
        [[joint]]
        name = "hinge"
        type = "revolute"
        between = ["ground", "bar"]
        point = [0, 0, 0]
        axis = [0, 1, 0]
        {motor}
        [[functional]]
        name = "way"
        type = "position"
        on = "bar"
        point = [0, 0, "-size"]
        direction = [1, 0, 0]
        over = "integral"
        [[functional]]
        name = "energy"
        type = "energy"
        over = "terminal"
        "#
    )
}

/// Nothing that moves is no size to divide by: no alarm, no error of derivative parts, a gradient that is checked.
#[test]
fn bodies_at_rest_or_brought_to_rest_raise_no_alarm() {
    let folder = Folder::new("rest");
    for coordinates in ["euler_parameters", "natural"] {
        for (gravity, has_motor) in [(9.81, false), (0.0, false), (0.0, true), (9.81, true)] {
            fs::write(folder.0.join("rest.toml"), bar_on_a_hinge(coordinates, gravity, has_motor)).unwrap();
            for method in ["esdirk3", "esdirk4", "esdirk5", "bdf1", "bdf2", "generalized-alpha", "midpoint", "sdirk2"] {
                for level in ["position", "acceleration"] {
                    let arguments = ["gradient", "rest.toml", "--check", "--no-report", "--json"];
                    let method = ["--method", method, "--constraint-level", level];
                    let output = folder.run(&[&arguments[..], &method[..]].concat());
                    let said = text(&output.stderr);
                    let case = format!("{coordinates}, g = {gravity}, motor {has_motor}, {method:?}");
                    assert!(output.status.code() == Some(0), "{case}: {said}");
                    assert!(has_motor || said.is_empty(), "{case}: {said}");
                }
            }
        }
    }
}

/// A method of first order takes the energy of a pendulum in many small steps: each is told as large as it is, and their sum is.
#[test]
fn energy_that_a_method_loses_is_said() {
    let folder = Folder::new("loss");
    let run = |method: &str| {
        let output = folder.run(&["run", "pendulum", "--end", "10", "--steps", "1000", "--method", method, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let (object, said) = (json(&output), text(&output.stderr));
        (
            object["largest_step_error"]["share"].as_f64().unwrap(),
            object["energy_loss"]["share_of_kinetic"].as_f64().unwrap(),
            said,
        )
    };
    let (share, loss, said) = run("bdf1");
    // h/2 of the rate by which velocities change: about half a step of g over the largest velocity
    assert!((2e-4..1e-2).contains(&share), "{share:e}");
    assert!(loss > 0.2 && said.contains("but falls by"), "{loss} {said}");
    let (fine, loss, said) = run("esdirk4");
    assert!(fine < 1e-5 && loss < 2e-3 && said.is_empty(), "{fine:e} {loss:e} {said}");
}

/// A mass of 1 kg goes round at 1 m/s on a circle of 1 m: no velocity along the radius, and a force of 1 N.
const ROUND: &str = r#"
version = 1
settings = { end = 1, steps = 100, constraint_level = "position" }
point = [{ name = "p", position = [1, 0, 0], velocity = [0, 1, 0], mass = 1 }]
joint = [{ name = "rod", type = "distance", between = ["ground", "p"], points = [[0, 0, 0], [1, 0, 0]] }]
functional = [
    { name = "radial", type = "formula", nodes = { p = "p" }, value = "dot(p.velocity, p.position)", unit = "m2/s", over = "terminal" },
    { name = "force", type = "reaction_norm", joint = "rod", over = "terminal" },
]
"#;

/// Several stages that keep constraints on coordinates have velocities of first order, which runs say, and reactions of none.
#[test]
fn what_stages_at_position_level_lose_is_said() {
    let folder = Folder::new("position-level");
    fs::write(folder.0.join("round.toml"), ROUND).unwrap();
    let run = |method: &str| {
        let output = folder.run(&["run", "round.toml", "--no-report", "--json", "--method", method]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let (object, said) = (json(&output), text(&output.stderr));
        let [radial, force] = [0, 1].map(|k| object["functionals"][k]["value"].as_f64().unwrap().abs());
        let share = object["largest_step_error"]["share"].as_f64().unwrap();
        (share, radial, force, said.contains("\"force\": with") && said.contains("off by as much as they are themselves"))
    };
    for method in ["dirk2", "dirk3", "sdirk2", "sdirk3", "sdirk4"] {
        let (share, radial, force, is_told) = run(method);
        assert!(radial > 5e-4 && (force - 1.0).abs() > 0.1, "{method}: {radial} {force}");
        assert!(share > 0.9 * radial && share < 1e-1 && is_told, "{method}: {share} for {radial}");
    }
    for method in ["bdf2", "generalized-alpha", "esdirk3", "esdirk5"] {
        let (share, radial, force, is_told) = run(method);
        assert!(
            share < 1e-3 && radial < 1e-4 && (force - 1.0).abs() < 0.01 && !is_told,
            "{method}: {share} {radial} {force}"
        );
    }
}

/// A crank that is turned by 1 rad within a time `T`, and stands until the end: the integral of its angle is 1 - T/2.
const DWELL: &str = r#"
version = 1
settings = { end = 1, steps = 100 }
variable.T = { initial = 0.3, bounds = [0.01, 1], unit = "s" }
body = [{ name = "b", mass = 1, mass_centre = [0.3, 0, 0], inertia = [0.01, 0.01, 0.01] }]
joint = [{ name = "hinge", type = "revolute", between = ["ground", "b"], axis = [0, 0, 1] }]
functional = [{ name = "angle", type = "joint_angle", between = ["ground", "b"], axis = [0, 0, 1], over = "integral" }]
[[driver]]
name = "motor"
type = "rotation"
between = ["ground", "b"]
axis = [0, 0, 1]
angle = { type = "smooth_ramp", to = 1, duration = "T" }
"#;

/// A body on an oblique slide that a driver brings to rest, amid whose ramp the acceleration is zero.
const SLIDE: &str = r#"
version = 1
settings = { end = 0.2, steps = 10 }
variable.v = { initial = 0.1, bounds = [-1, 1] }
body = [{ name = "b", mass = 2, inertia = [0.1, 0.1, 0.1] }]
joint = [{ name = "j", type = "prismatic", between = ["ground", "b"], axis = [1, 0.3, 0.3] }]
[[driver]]
name = "d"
type = "translation"
between = ["ground", "b"]
axis = [1, 0.3, 0.3]
displacement = { type = "smooth_ramp", to = "v", duration = 0.1 }
[[functional]]
name = "x"
type = "position"
on = "b"
direction = [1, 0, 0]
over = "terminal"
"#;

/// A push of 1 N on a mass of 1 kg that fades from a time `te` on within 0.2 s: dv/dte = 1.
const FADING_PUSH: &str = r#"
version = 1
settings = { end = 2, steps = 200 }
variable.te = { initial = 0.98, bounds = [0.1, 1.9], unit = "s" }
point = [{ name = "m", position = [0, 0, 0], mass = 1 }]
functional = [{ name = "v", type = "velocity", on = "m", direction = [1, 0, 0], over = "terminal" }]
[[force]]
name = "push"
on = "m"
direction = [1, 0, 0]
size = { type = "smooth_ramp", from = 1, to = 0, start = "te", duration = 0.2 }
"#;

/// What comes to rest, and derivatives that fade there, are measured by what has moved before: by every method, at every level, with few steps
/// and many.
#[test]
fn motions_that_end_at_rest_have_gradients_that_are_checked() {
    let folder = Folder::new("dwell");
    let direction = 1.0 / 1.18_f64.sqrt();
    for (name, scene, exact, steps) in [
        ("dwell.toml", DWELL, -0.5, ["10", "400"]),
        ("slide.toml", SLIDE, direction, ["10", "40"]),
        ("push.toml", FADING_PUSH, 1.0, ["20", "200"]),
    ] {
        fs::write(folder.0.join(name), scene).unwrap();
        for method in table_names().iter().filter(|name| **name != STATIC_TABLE) {
            for (level, steps) in ["position", "acceleration"].into_iter().zip(steps) {
                let arguments = ["gradient", name, "--check", "--no-report", "--json", "--method", method];
                let output = folder.run(&[&arguments[..], &["--constraint-level", level, "--steps", steps]].concat());
                let case = format!("{name}, {method}, {level} level, {steps} steps");
                assert_eq!(output.status.code(), Some(0), "{case}: {}", text(&output.stderr));
                let gradient = json(&output)["functionals"][0]["gradient"].as_object().unwrap().clone();
                let own = gradient.values().next().and_then(|own| own.as_f64()).unwrap();
                // a rule of first order is off by half a step of the ramp
                assert!((own - exact).abs() < 2.0 / steps.parse::<f64>().unwrap(), "{case}: {own} for {exact}");
            }
        }
    }
}

/// An angle that a slide holds at zero is round-off, and so are its derivatives by a variable that is zero, which pass as what they are.
#[test]
fn derivatives_of_a_functional_that_is_round_off_are_no_difference() {
    let folder = Folder::new("nothing");
    let turn = r#"
        [[functional]]
        name = "turn"
        type = "joint_angle"
        between = ["ground", "b"]
        axis = [0.4, -0.8, "v - 0.3"]
        over = { aggregate = "squared_exponential", sharpness = 1, times = "end" }
    "#;
    let slide = SLIDE.replace("initial = 0.1", "initial = 0").replace("to = \"v\"", "to = \"0.1 + v\"");
    for coordinates in ["euler_parameters", "natural"] {
        let turned = "orientation = { type = \"angle\", axis = [0.2, 0.5, 0.3], angle = 0.7 }";
        let body = format!("coordinates = \"{coordinates}\", {turned}, inertia");
        fs::write(folder.0.join("slide.toml"), slide.replace("inertia", &body) + turn).unwrap();
        for method in ["esdirk4", "dirk3", "bdf2", "newmark"] {
            let arguments = ["gradient", "slide.toml", "--check", "--no-report", "--json", "--method", method];
            let output = folder.run(&[&arguments[..], &["--constraint-level", "position"]].concat());
            assert_eq!(output.status.code(), Some(0), "{coordinates}, {method}: {}", text(&output.stderr));
        }
    }
}

/// The energy of a rotor against a spring goes to and fro: what its steps lose is small beside that, and beside no work at all.
#[test]
fn energy_that_is_exchanged_without_work_counts_in_its_balance() {
    let folder = Folder::new("exchange");
    let rotor = r#"
        version = 1
        settings = { end = 1, steps = 1000 }
        body = [{ name = "b", angular_velocity = [0, 0, 8], mass = 1, inertia = [1, 1, 1] }]
        joint = [{ name = "j", type = "revolute", between = ["ground", "b"], axis = [0, 0, 1] }]
        spring = [{ name = "t", type = "torsion", between = ["ground", "b"], axis = [0, 0, 1], stiffness = 9000 }]
        functional = [{ name = "rate", type = "joint_rate", between = ["ground", "b"], axis = [0, 0, 1], over = "terminal" }]
    "#;
    fs::write(folder.0.join("rotor.toml"), rotor).unwrap();
    for (method, is_said) in [("esdirk4", false), ("esdirk5", false), ("sdirk4", false), ("bdf1", true), ("bdf2", true)] {
        let output = folder.run(&["run", "rotor.toml", "--no-report", "--json", "--method", method]);
        assert_eq!(output.status.code(), Some(0), "{method}: {}", text(&output.stderr));
        assert_eq!(text(&output.stderr).contains("energy changes by"), is_said, "{method}: {}", text(&output.stderr));
    }
}

/// Friction that is stiff at rest, and lets go: the explicit first stage makes the box faster than it is, and the estimate says by how much.
#[test]
fn a_force_that_is_stiff_at_rest_alone_is_covered_by_the_estimate() {
    let folder = Folder::new("friction");
    let pushed = r#"
        version = 1
        settings = { end = 2.0, steps = 200 }
        point = [{ name = "box", position = [0, 0, 0], mass = 1 }]
        joint = [{ name = "plane", type = "point_on_line", between = ["ground", "box"], axis = [1, 0, 0] }]
        element = [{ name = "friction", nodes = { box = "box" }, force = { box = "[-4.905 * tanh(box.velocity.x / 1e-4), 0, 0]" } }]
        force = [{ name = "push", on = "box", direction = [1, 0, 0], size = 4.95 }]
        functional = [{ name = "v", type = "velocity", on = "box", direction = [1, 0, 0], over = "terminal" }]
    "#;
    fs::write(folder.0.join("box.toml"), pushed).unwrap();
    let exact = 0.0902685;
    for method in ["esdirk3", "esdirk4"] {
        let output = folder.run(&["run", "box.toml", "--no-report", "--json", "--method", method]);
        let object = json(&output);
        let share = object["largest_step_error"]["share"].as_f64().unwrap();
        let v = object["functionals"][0]["value"].as_f64().unwrap();
        assert!(share >= 0.9 * (v - exact).abs() / v && share < 0.2, "{method}: {share} for {v}");
        assert!(text(&output.stderr).contains("estimated error"), "{method}: {}", text(&output.stderr));
    }
    for tolerance in ["1e-3", "1e-6"] {
        let output = folder.run(&["run", "box.toml", "--no-report", "--json", "--tolerance", tolerance]);
        let v = json(&output)["functionals"][0]["value"].as_f64().unwrap();
        assert!((v - exact).abs() < 1e-5, "{tolerance}: {v}");
    }
}

/// Each functional has the limit of its own noise.
#[test]
fn a_check_gives_each_functional_its_own_limit() {
    let folder = Folder::new("limits");
    fs::write(folder.0.join("rest.toml"), bar_on_a_hinge("euler_parameters", 9.81, true)).unwrap();
    let output = folder.run(&["gradient", "rest.toml", "--check", "--no-report", "--json"]);
    let object = json(&output);
    for functional in object["functionals"].as_array().unwrap() {
        assert!(functional["limit"].as_f64().is_some_and(|limit| limit <= 1e-9), "{functional}");
        let name = functional["name"].as_str().unwrap();
        assert!(text(&output.stdout).contains(&format!("{name}: largest relative difference to complex step")), "{name}");
    }
}

/// A door on thirty hinges.
const DOOR: &str = r#"
version = 1
[settings]
end = 0.1
steps = 10
[[body]]
name = "door"
position = [0.5, 0, 0]
mass = 1
inertia = [1, 1, 1]
[[joint]]
name = "hinge {i}"
for = { i = { from = 1, to = 30 } }
type = "revolute"
between = ["ground", "door"]
point = [0, 0, "0.1 * {i}"]
axis = [0, 0, 1]
[[functional]]
name = "load"
type = "reaction_norm"
joint = "hinge 3"
over = "terminal"
"#;

#[test]
fn many_redundant_equations_are_told_in_few_words_and_what_is_not_determined_is_said() {
    let folder = Folder::new("door");
    fs::write(folder.0.join("door.toml"), DOOR).unwrap();
    let output = folder.run(&["run", "door.toml"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("145 of 150 equations") && message.contains("and 139 more"), "{message}");
    assert!(message.lines().all(|line| line.len() < 1000), "{message}");
    fs::write(folder.0.join("door.toml"), DOOR.replace("steps = 10", "steps = 10\ndrop_redundant = true")).unwrap();
    let output = folder.run(&["run", "door.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("not determined by the model: how the joints \"hinge 1\""));
    let said = &json(&output)["not_determined"];
    assert_eq!((said["joints"].as_array().unwrap().len(), &said["functionals"][0]), (30, &"load".into()), "{said}");
}

/// Forces along a chain of 3,000 bars are told to no more than seven digits by all its equations together.
#[test]
fn a_joint_that_is_there_twice_in_a_long_chain_bears_half_of_its_load() {
    let folder = Folder::new("long-chain");
    let scene = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenes/chain-common.toml")).unwrap();
    let scene = scene.replace("bars = 100", "bars = 3000").replace("[settings]", "[settings]\ndrop_redundant = true");
    let load = "[[functional]]\nname = \"load\"\ntype = \"reaction\"\njoint = \"joint 1501\"\nweights = [1, 0, 0]\nover = \"terminal\"\n";
    let again =
        "[[joint]]\nname = \"again\"\ntype = \"spherical\"\nbetween = [\"bar 1500\", \"bar 1501\"]\npoint = [150, 0, 0]\n";
    let [once, twice] = ["", again].map(|joint| {
        fs::write(folder.0.join("chain.toml"), format!("{scene}\n{joint}\n{load}")).unwrap();
        let output = folder.run(&["gradient", "chain.toml", "--end", "1e-3", "--steps", "1", "--json", "--no-report"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        json(&output)
    });
    assert_eq!(twice["not_determined"]["joints"], serde_json::json!(["joint 1501", "again"]));
    for key in ["/value", "/gradient/radius"] {
        let [once, twice] = [&once, &twice].map(|own| {
            let load = own["functionals"].as_array().unwrap().iter().find(|own| own["name"] == "load").unwrap();
            load.pointer(key).and_then(Value::as_f64).unwrap()
        });
        assert!((twice - 0.5 * once).abs() < 1e-9 * once.abs(), "{key}: {once:e} {twice:e}");
    }
}

#[test]
fn files_that_are_no_scenes_are_told_by_what_they_are() {
    let folder = Folder::new("formats");
    for (name, content, says) in [
        ("plate.msh", "$MeshFormat\n4.1 0 8\n", "a mesh of Gmsh"),
        ("arm.urdf", "<robot name=\"arm\"/>", "a file in XML, as URDF"),
        ("arm.json", "{\"bodies\": 1}", "JSON"),
    ] {
        fs::write(folder.0.join(name), content).unwrap();
        for name in [name.to_string(), format!("./{name}")] {
            let output = folder.run(&["run", &name]);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains(says) && message.contains("scene file"), "{message}");
        }
    }
}

#[test]
fn numbers_without_end_are_printed_in_few_digits() {
    let folder = Folder::new("digits");
    let output = folder.run(&["run", "pendulum", "--end", "1e308"]);
    assert_eq!(output.status.code(), Some(1));
    let said = [text(&output.stdout), text(&output.stderr)].concat();
    assert!(!said.contains(&"0".repeat(30)), "{said}");
}

#[cfg(unix)]
#[test]
fn a_full_disk_for_the_histories_does_not_end_the_simulation() {
    let folder = Folder::new("full-disk");
    // files of at most 8 KiB
    let line = format!(
        "trap '' XFSZ; ulimit -f 8; {} run pendulum --steps 4000 --no-report --json --out out",
        env!("CARGO_BIN_EXE_costate")
    );
    let output = Command::new("bash").args(["-c", &line]).current_dir(&folder.0).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("histories.csv") && message.contains("the files end there"), "{message}");
    let whole = folder.run(&["run", "pendulum", "--steps", "4000", "--json", "--out", "whole"]);
    assert_eq!(json(&output)["functionals"], json(&whole)["functionals"]);
}
