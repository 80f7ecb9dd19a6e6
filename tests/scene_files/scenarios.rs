//! Scenarios: one mechanism in several circumstances, alone and together.

use super::parsed;
use costate::optimize::{Case, Optimization, Sqp};
use costate::scenes::{AnyScene, FileScene, Prepared, Scenario};
use costate::sensitivity::largest_difference;
use std::process::Command;

/// A cantilever whose width and height carry two loads.
const BEAM: &str = r#"
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
elements = 4
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
functional = [{ name = "tip", type = "position", on = "beam.end", direction = [0, 1, 0], over = "terminal" }]
settings.steps = 2

[optimization]
minimize = "mass [down]"
constraint = [{ functional = "way", at_most = 1e-4 }]
"#;

fn values(scene: &dyn AnyScene) -> Vec<f64> {
    let prepared = Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"));
    prepared.analysis().forward(&prepared.x).unwrap_or_else(|why| panic!("{why}")).values
}

/// The file with the changes of a scenario made by hand.
fn by_hand(changes: &[(&str, &str)]) -> FileScene {
    let (before, _) = BEAM.split_once("[[scenario]]").unwrap();
    parsed(&changes.iter().fold(before.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    }))
}

const ASIDE: [(&str, &str); 4] = [
    ("direction = [0, 0, -1]", "direction = [0, 1, 0]"),
    (
        "size = { type = \"constant_rate\", offset = 0, rate = \"push\" }",
        "size = { type = \"smooth_ramp\", to = \"2 * push\", duration = 1 }",
    ),
    ("steps = 1", "steps = 2"),
    (
        "[settings]",
        "[[functional]]\nname = \"tip\"\ntype = \"position\"\non = \"beam.end\"\ndirection = [0, 1, 0]\nover = \"terminal\"\n[settings]",
    ),
];

#[test]
fn a_scenario_is_the_file_with_its_changes() {
    let whole = parsed(BEAM);
    let scenarios = AnyScene::scenarios(&whole);
    let names: Vec<String> = scenarios.iter().map(|own| format!("{} of {}", own.name, own.scene.name())).collect();
    assert_eq!(names, ["down of bracket, down", "aside of bracket, aside"]);
    for (scenario, hand) in scenarios.iter().zip([by_hand(&[("push = 100", "push = 300")]), by_hand(&ASIDE)]) {
        assert_eq!(values(scenario.scene), values(&hand), "{}", scenario.name);
        assert_eq!(scenario.scene.settings(), AnyScene::settings(&hand), "{}", scenario.name);
    }
    // by itself it is what it says without them
    assert_eq!(values(&whole), values(&by_hand(&[])));
}

#[test]
fn an_optimum_holds_its_limits_in_all_scenarios() {
    let whole = parsed(BEAM);
    let optimization = Optimization::of(&whole).unwrap();
    let names: Vec<&str> = optimization.functionals().iter().map(|own| own.0.as_str()).collect();
    assert_eq!(names, ["mass [down]", "way [down]", "way [aside]"]);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| optimization.run(&Sqp, &optimization.initial(), &mut ()).unwrap())
    };
    let (alone, together) = (run(1), run(2));
    let points = |optimized: &costate::optimize::Optimized| {
        optimized
            .history
            .points
            .iter()
            .map(|point| (point.design.clone(), point.functionals.clone(), point.gradients.clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(points(&alone), points(&together), "the same bits on one thread and on two");
    assert!(alone.ended.reason.is_optimum(), "{:?}", alone.ended);
    // both deflections F L^3 / (3 E I) are at their limit of 1 cm, but for shear and finite rotations: b h^3 and h b^3 are 4 F L^3 / (E d)
    let [down, aside] = [300.0_f64, 200.0].map(|force| 4.0 * force / (2e11 * 1e-2));
    let height = (down.powi(3) / aside).powf(0.125);
    let best = alone.history.best().unwrap();
    assert!((best.design[1] / height - 1.0).abs() < 3e-3, "{:?} for {height}", best.design);
    assert!((best.design[0] / (down / height.powi(3)) - 1.0).abs() < 3e-3, "{:?}", best.design);
    assert!(best.violation < 1e-6, "{best:?}");
    for (k, (case, local)) in [("down", "way"), ("aside", "way")].into_iter().enumerate() {
        let scenario = AnyScene::scenarios(&whole).into_iter().find(|own| own.name == case).unwrap();
        let prepared = Prepared::with(
            scenario.scene,
            &best.design,
            Prepared::method_of(&scenario.scene.settings()).unwrap(),
            scenario.scene.settings(),
        )
        .unwrap();
        let (forward, place) = (prepared.analysis().forward(&best.design).unwrap(), prepared.functional(local).unwrap());
        assert_eq!(forward.values[place], best.functionals[k + 1], "{case}");
        let rows = prepared.analysis().adjoint(&best.design, &forward).unwrap().rows;
        let known = best.gradients.as_ref().expect("the best point has gradients");
        assert!(largest_difference(&rows[place], &known[k + 1]) < 1e-14, "{case}: {rows:?} {known:?}");
    }
}

#[test]
fn a_case_with_other_variables_is_refused() {
    let (whole, other) = (
        parsed(BEAM),
        parsed(&BEAM.replace("height = {", "depth = {").replace("height = \"height\"", "height = \"depth\"")),
    );
    let case = Case::of(Scenario { name: "other".into(), scene: &other }).unwrap();
    let problem = AnyScene::optimization_problem(&whole).unwrap();
    let told = Optimization::new(&whole, problem, vec![case]).err().unwrap().to_string();
    assert!(told.contains("scenario \"other\": its design variables are not those of the scene"), "{told}");
}

#[test]
fn what_a_scenario_cannot_say_is_told() {
    for (from, to, part) in [
        ("define.push = 300", "define.pull = 3\nforce.lode.size = 3", "did you mean \"load\""),
        ("define.push = 300", "variable.width.initial = 0.02", "variable is the same in all scenarios"),
        ("name = \"down\"", "name = \"aside\"", "scenario: two are named \"aside\""),
        ("name = \"down\"", "name = \"Aside\"", "differ in capitals alone"),
        ("name = \"down\"", "name = \"..\"", "begin with a dot"),
        ("name = \"down\"", "name = \"\"", "it is empty"),
        ("name = \"down\"", "name = \"scenarios.json\"", "the comparison of scenarios is written there"),
        ("name = \"down\"", "name = \"nul\"", "belongs to a device"),
        ("name = \"down\"\n", "", "[[scenario]] needs the key name"),
        ("name = \"down\"", "name = \"a/b\"", "none of / \\"),
        ("name = \"down\"", "name = \"a [b]\"", "cannot have [ ]"),
        ("settings.steps = 2", "settings.stepz = 2", "scenario \"aside\""),
        ("force.load = { direction", "force.load = { dir", "scenario \"aside\""),
        (
            "[[scenario]]\nname = \"down\"\ndefine.push = 300",
            "",
            "\"mass [down]\" is not known; known: mass, way, mass [aside], way [aside]",
        ),
    ] {
        assert!(BEAM.contains(from), "{from}");
        match FileScene::parse("bracket.toml", &BEAM.replace(from, to)) {
            Ok(_) => assert!(part.is_empty(), "{to} was taken"),
            Err(told) => assert!(!part.is_empty() && told.contains(part), "{to}: {told}"),
        }
    }
    let ambiguous = parsed(&BEAM.replace("mass [down]", "mass"));
    let told = Optimization::of(&ambiguous).err().unwrap().to_string();
    assert!(told.contains("names the functional \"mass\"") && told.contains("mass [down], way [down]"), "{told}");
}

#[test]
fn the_command_line_runs_one_or_all() {
    let folder = std::env::temp_dir().join(format!("costate-scenarios-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("bracket.toml"), BEAM).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
        let output = command.current_dir(&folder).args(arguments).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        (output.status.code().unwrap(), text)
    };
    let (code, text) = run(&["check", "bracket.toml"]);
    assert!(
        code == 0 && text.contains("scenario \"down\": in order") && text.contains("scenario \"aside\": in order"),
        "{text}"
    );
    let (code, text) = run(&["run", "bracket.toml", "--no-report"]);
    assert!(code == 0 && text.contains("bracket, down:") && text.contains("bracket, aside:"), "{text}");
    assert!(
        folder.join("out/bracket, down/summary.json").is_file() && folder.join("out/bracket, aside/summary.json").is_file()
    );
    let (code, text) = run(&["gradient", "bracket.toml", "--scenario", "aside", "--check", "--out", "one"]);
    assert!(code == 0 && !text.contains("bracket, down:") && folder.join("one/summary.json").is_file(), "{text}");
    let (code, text) = run(&["run", "bracket.toml", "--out", "all", "--no-report"]);
    assert!(
        code == 0 && folder.join("all/down/summary.json").is_file() && folder.join("all/aside/summary.json").is_file(),
        "{text}"
    );
    // side by side, as each gives alone
    let read = |file: String| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(folder.join(file)).unwrap()).unwrap()
    };
    let both = read("all/scenarios.json".into());
    assert_eq!(both["scenarios"], serde_json::json!(["down", "aside"]));
    for (place, name) in ["down", "aside"].iter().enumerate() {
        let alone = read(format!("all/{name}/summary.json"));
        for own in both["functionals"].as_array().unwrap() {
            let named = |other: &&serde_json::Value| other["name"] == own["name"];
            // one of a scenario alone has no value in the others
            let value = alone["functionals"].as_array().unwrap().iter().find(named).map(|other| &other["value"]);
            assert_eq!(&own["values"][place], value.unwrap_or(&serde_json::Value::Null), "{name}");
        }
    }
    assert!(folder.join("out/bracket/scenarios.json").is_file() && !folder.join("one/scenarios.json").exists());
    let (code, text) = run(&["optimize", "bracket.toml", "--iterations", "40"]);
    assert!(code == 0 && text.contains("scenario \"down\": static") && text.contains("way [aside]"), "{code} {text}");
    let (code, text) = run(&["run", "bracket.toml", "--scenario", "side"]);
    assert!(code == 2 && text.contains("did you mean \"aside\""), "{text}");
    let (code, text) = run(&["sweep", "bracket.toml", "--vary", "width=0.01,0.02"]);
    assert!(code == 2 && text.contains("scenarios down, aside: choose one with --scenario"), "{text}");
    let (code, text) = run(&["run", "bracket.toml", "--history", "file:run.history"]);
    assert!(code == 2 && text.contains("each of 2 scenarios wants a file of its own"), "{text}");
    std::fs::remove_dir_all(&folder).unwrap();
}
