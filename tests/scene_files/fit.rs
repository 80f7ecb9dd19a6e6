//! Fits to measurements: what is wrong with them is told where it is, several runs are fitted together, and sensors of acceleration show what they should.

use super::{from_root, parsed, refused};
use costate::optimize::Fit;
use costate::scenes::{AnyScene, FileScene, Prepared, built_in};
use std::path::PathBuf;

/// A file of this process with a text.
fn file(name: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("costate-fit-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

const SCENE: &str = r#"version = 1
settings = { end = 1, steps = 50 }
variable.k = { initial = 30, bounds = [1, 100], unit = "N/m" }
variable.lag = { initial = 0, bounds = [0, 0.1], unit = "s" }
[[point]]
name = "block"
position = [0.1, 0, 0]
mass = 1
[[spring]]
name = "spring"
type = "line"
between = ["ground", "block"]
points = [[-1, 0, 0], [0.1, 0, 0]]
stiffness = "k"
rest_length = 1
[[functional]]
name = "x"
type = "position"
on = "block"
direction = [1, 0, 0]
over = "terminal"
[[measurement]]
name = "place of the block"
functional = "x"
file = "FILE"
deviation = 0.01
"#;

const TABLE: &str = "t [s],x [m]\n0.2,0.05\n0.4,-0.06\n0.9,0.02\n";

/// What is said of the scene with a table and changes.
fn told(case: usize, table: &str, changes: &[(&str, &str)]) -> String {
    let path = file(&format!("wrong-{case}.csv"), table);
    let text = changes.iter().fold(SCENE.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let text = text.replace("FILE", path.to_str().unwrap());
    match FileScene::parse("scene.toml", &text) {
        Err(why) => why,
        Ok(scene) => Fit::of(&scene).err().unwrap_or_else(|| panic!("case {case} is taken")).to_string(),
    }
}

/// A table, what is replaced by what in the scene, and parts of what is said.
type Case<'c> = (&'c str, Vec<(&'c str, String)>, &'c [&'c str]);

#[test]
fn what_is_wrong_with_measurements_is_told() {
    from_root();
    let row = |row: &str| format!("{TABLE}{row}\n");
    let fit = |keys: &str| ("deviation = 0.01\n", format!("deviation = 0.01\n[fit]\n{keys}\n"));
    let cases: [Case; 18] = [
        ("", vec![], &["scene.toml:25:8: file", "no lines with numbers"]),
        ("t,x\n", vec![], &["0 lines of numbers"]),
        (
            &TABLE.replace("[m]", "[mm]"),
            vec![],
            &["\"place of the block\" is in mm", "\"x\" is in m", "write the column in m"],
        ),
        (&TABLE.replace("[s]", "[ms]"), vec![], &["scene.toml:25:8", "are in ms: write them in s"]),
        (&row("0.95,nan"), vec![], &["scene.toml:25:8", "line 5, column \"x [m]\": \"nan\""]),
        (&row("0.95"), vec![], &["line 5 ends before column \"x [m]\""]),
        (&row("0.5,1"), vec![], &["line 5", "0.5 does not increase after 0.9"]),
        (&row("1.5,0"), vec![], &["has a value at 1.5 s", "from 0 to 1 s: cut the table"]),
        ("t,x\n-0.1,0\n0.1,0\n", vec![], &["has a value at -0.1 s"]),
        (
            TABLE,
            vec![("deviation = 0.01", "delay = \"lag\"\ncolumns = [\"t\", \"y\"]".into())],
            &["names no column \"y\"; there are t [s], x [m]"],
        ),
        (
            "t,x\n0.05,0\n0.3,0\n",
            vec![("deviation = 0.01", "delay = \"lag\"".into())],
            &["has a value at 0.05 s, less a delay of 0.1 s"],
        ),
        (TABLE, vec![("deviation = 0.01", "deviation = 0".into())], &["scene.toml:26:13", "greater than 0"]),
        (
            "t,x,e\n0.1,0,1\n0.3,0,-1\n",
            vec![("deviation = 0.01", "deviations = \"e\"".into())],
            &["scene.toml:26:14: the deviation at t = 0.3 s is -1"],
        ),
        (
            "t,x,e\n0.1,0,1\n0.3,0,1\n",
            vec![("deviation = 0.01", "deviation = 1\ndeviations = \"e\"".into())],
            &["deviation or deviations"],
        ),
        (
            TABLE,
            vec![("functional = \"x\"", "functional = \"y\"".into())],
            &["scene.toml:24:14: functional \"y\" is not known"],
        ),
        (TABLE, vec![fit("varying = [\"mass\"]")], &["design variable \"mass\" is not known"]),
        (
            TABLE,
            vec![("deviation = 0.01", "".into()), ("[[point]]", "[fit]\nloss = \"cauchy\"\n[[point]]".into())],
            &["needs a deviation, as the loss"],
        ),
        (
            TABLE,
            vec![("variable.lag", "variable.more = { count = 4, initial = 0, bounds = [0, 0.1] }\nvariable.lag".into())],
            &["the 3 numbers of measurement \"place of the block\" cannot tell 6 design variables"],
        ),
    ];
    for (case, (table, changes, parts)) in cases.iter().enumerate() {
        let changes: Vec<(&str, &str)> = changes.iter().map(|(from, to)| (*from, to.as_str())).collect();
        let why = told(case, table, &changes);
        assert!(parts.iter().all(|part| why.contains(part)), "case {case}: {why}");
    }
    let alone = refused(
        "version = 1\nsettings = { end = 1, steps = 2 }\nfit.loss = \"huber\"\npoint = [{ name = \"p\", position = [0, 0, 0], mass = 1 }]\n",
    );
    assert!(alone.contains("scene.toml:3") && alone.contains("[fit] needs a [[measurement]]"), "{alone}");
}

#[test]
fn runs_of_several_scenarios_are_fitted_together() {
    from_root();
    // the same block let go at 0.1 m and at 0.2 m, each with a variable of its own beside the common one
    let omega = 20.0_f64.sqrt();
    let rows = |release: f64| {
        let row = |k: i32| format!("{},{}\n", f64::from(k) / 10.0, release * (omega * f64::from(k) / 10.0).cos());
        (1..=10).map(row).collect::<String>()
    };
    let [near, far] = [("near", 0.1), ("far", 0.2)].map(|(name, release)| file(&format!("{name}.csv"), &rows(release)));
    let (before, _) = SCENE.split_once("[[measurement]]").unwrap();
    let of_all = r#"version = 1
define.release = "near"
fit.varying = ["k", "near", "far"]
variable.near = { initial = 0.15, bounds = [0.01, 1], unit = "m" }
variable.far = { initial = 0.15, bounds = [0.01, 1], unit = "m" }
"#;
    let before = before.replace("version = 1\n", of_all).replace("[0.1, 0, 0]", "[\"release\", 0, 0]");
    let measurement = |name: &str, path: &PathBuf| {
        format!("[[measurement]]\nname = \"{name}\"\nfunctional = \"x [{name}]\"\nfile = {path:?}\n")
    };
    let text = format!(
        "{before}[[scenario]]\nname = \"near\"\n[[scenario]]\nname = \"far\"\ndefine.release = \"far\"\n{}{}",
        measurement("near", &near),
        measurement("far", &far)
    );
    let scene = parsed(&text);
    let fit = Fit::of(&scene).unwrap_or_else(|why| panic!("{why}"));
    let fitted = fit.run(&fit.initial(), &mut ()).unwrap_or_else(|why| panic!("{why}"));
    let place = |name: &str| AnyScene::variables(&scene).iter().position(|own| own.name == name).unwrap();
    for (name, value) in [("k", 20.0), ("near", 0.1), ("far", 0.2)] {
        // as exact as the steps
        assert!((fitted.design[place(name)] / value - 1.0).abs() < 1e-5, "{name}: {:?}", fitted.design);
    }
    assert!(fitted.is_optimum && fitted.confidence.estimated.len() == 3);
    // without the name of a scenario it is not said whose it is
    let unclear = Fit::of(&parsed(&text.replace("\"x [far]\"", "\"x\""))).err().unwrap().to_string();
    assert!(unclear.contains("\"x [near]\""), "{unclear}");
}

#[test]
fn a_fit_has_the_same_bits_again_and_from_its_end_takes_no_step() {
    let fit = Fit::of(built_in::named("damped-oscillator").unwrap()).unwrap();
    let [one, other] = [(); 2].map(|()| fit.run(&fit.initial(), &mut ()).unwrap());
    assert_eq!((&one.design, &one.curves), (&other.design, &other.curves));
    let again = fit.run(&one.design, &mut ()).unwrap();
    assert!(again.is_optimum && again.iterations <= 1, "{} iterations", again.iterations);
    // a design at a bound is held there
    let mut scene = built_in::named("damped-oscillator").unwrap().fit_problem().unwrap();
    scene.measurements[0].values.iter_mut().for_each(|own| *own *= 10.0);
    let cases = costate::scenes::Scenario::all_of(fit.scene).into_iter().map(costate::optimize::Case::of);
    let bounded = Fit::new(fit.scene, scene, cases.collect::<Result<_, _>>().unwrap()).unwrap();
    let held = bounded.run(&bounded.initial(), &mut ()).unwrap();
    assert!(held.design[2] == 0.5 && held.confidence.estimated == [0, 1], "{:?}", held.design);
}

#[test]
fn a_sensor_on_an_arm_shows_its_turn_and_gravity_in_its_own_directions() {
    let sensor = |name: &str, direction: &str| {
        format!(
            "[[functional]]\nname = \"{name}\"\ntype = \"acceleration\"\non = \"arm\"\npoint = [0.5, 0, 0]\ndirection = {direction}\n\
             gravity = [0, -9.81, 0]\nover = \"terminal\"\n"
        )
    };
    let arm = r#"version = 1
settings = { end = 1.3, steps = 400 }
variable.rate = { initial = 2, bounds = [0.1, 10], unit = "rad/s" }
[[body]]
name = "arm"
position = [0, 0, 0]
angular_velocity = [0, 0, "rate"]
mass = 1
inertia = [1, 1, 1]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "arm"]
axis = [0, 0, 1]
"#;
    let scene = parsed(&format!("{arm}{}{}", sensor("along", "[1, 0, 0]"), sensor("across", "[0, 1, 0]")));
    let prepared = Prepared::new(&scene).unwrap();
    let values = prepared.analysis().forward(&prepared.x).unwrap().values;
    // towards the axis by rate^2 r, and against gravity
    let angle: f64 = 2.0 * 1.3;
    for (value, expected) in values.iter().zip([-4.0 * 0.5 + 9.81 * angle.sin(), 9.81 * angle.cos()]) {
        assert!((value - expected).abs() < 1e-7, "{values:?}");
    }
}
