//! Bodies without inertia that joints and drivers hold, and reactions that a model does not determine.

use super::parsed;
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::FileScene;
use costate::sensitivity::largest_difference;

const HAND: &str = include_str!("massless/hand.toml");
const CRANK: &str = include_str!("massless/crank.toml");
const PULLEYS: &str = include_str!("massless/pulleys.toml");
/// The same frame in two units of length.
const FRAMES: [&str; 2] = [include_str!("massless/h_frame_metres.toml"), include_str!("massless/h_frame_millimetres.toml")];
/// One-step, multistep and variational methods, with stages inside the step and at its end.
const METHODS: [&str; 7] = ["esdirk4", "sdirk4", "midpoint", "bdf1", "bdf2", "generalized-alpha", "variational"];

/// The functionals with a method at a level, or why there are none.
fn values(text: &str, method: &str, level: ConstraintLevel) -> Result<Vec<f64>, String> {
    let scene = FileScene::parse("text", text)?;
    let settings = scene.settings().with_method(method);
    let own = Prepared::method_of(&settings).unwrap();
    let own = if method == "variational" { own } else { Method { level, ..own } };
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepared = Prepared::with(&scene, &x, own, settings).map_err(|why| why.to_string())?;
    Ok(prepared.analysis().forward(&x).map_err(|why| why.to_string())?.values)
}

/// Functionals against what they are, with all methods at all levels.
fn assert_values(text: &str, expected: &[f64], tolerance: f64) {
    for method in METHODS {
        for level in ConstraintLevel::ALL {
            let values = values(text, method, level).unwrap_or_else(|why| panic!("{method}, {}: {why}", level.name()));
            for (value, expected) in values.iter().zip(expected) {
                let off = (value - expected).abs();
                assert!(off <= tolerance * expected.abs().max(1.0), "{method}, {}: {values:?}", level.name());
            }
        }
    }
}

#[test]
fn a_hand_without_mass_follows_its_driver() {
    assert_values(HAND, &[2.0_f64.cos()], 1e-5);
}

#[test]
fn a_crank_and_a_rod_without_mass_drive_a_piston() {
    let crank = 0.1 * 2.0_f64.cos();
    let wrist = crank + (0.04 - (0.1 * 2.0_f64.sin()).powi(2)).sqrt();
    assert_values(CRANK, &[wrist, 0.0], 2e-3);
    let [position, _] = values(CRANK, "esdirk4", ConstraintLevel::Acceleration).unwrap()[..] else { panic!("two values") };
    assert!((position - wrist).abs() < 1e-11, "{position} for {wrist}");
}

#[test]
fn pulleys_without_mass_carry_three_weights() {
    // a_1 = -0.2 g, a_2 = 0.6 g, a_3 = -0.2 g, for 0.4 s; ropes 3.2 g and 1.6 g
    let g = 9.81;
    let speeds = [-0.08, 0.24, -0.08, 0.08].map(|share| share * g);
    assert_values(PULLEYS, &[&speeds[..], &[-3.2 * g, -1.6 * g]].concat(), 1e-7);
}

/// A pendulum that hangs on a massless hook, which a motor turns: its design enters masses and places.
const HOOK: &str = r#"
version = 1
gravity = [0, -9.81, 0]
[variable]
mass = { initial = 2, bounds = [1, 3], unit = "kg" }
reach = { initial = 0.4, bounds = [0.2, 0.6], unit = "m" }
[settings]
end = 0.5
steps = 50
[[body]]
name = "hook"
position = ["reach / 2", 0, 0]
[[joint]]
name = "main"
type = "revolute"
between = ["ground", "hook"]
point = [0, 0, 0]
axis = [0, 0, 1]
[[driver]]
name = "motor"
type = "rotation"
between = ["ground", "hook"]
axis = [0, 0, 1]
angle = { type = "smooth_ramp", to = 2, duration = 0.5 }
[[body]]
name = "bob"
position = ["reach", -0.3, 0.1]
mass = "mass"
inertia = [0.02, 0.03, 0.025]
[[joint]]
name = "eye"
type = "spherical"
between = ["hook", "bob"]
point = ["reach", 0, 0]
[[functional]]
name = "x"
type = "position"
on = "bob"
direction = [1, 0, 0]
over = "terminal"
[[functional]]
name = "force"
type = "reaction_norm"
joint = "main"
over = "integral"
"#;

#[test]
fn gradients_go_through_bodies_without_mass() {
    for (method, level) in [
        ("esdirk4", ConstraintLevel::Acceleration),
        ("bdf2", ConstraintLevel::Acceleration),
        ("generalized-alpha", ConstraintLevel::Acceleration),
    ] {
        let scene = parsed(HOOK);
        let settings = scene.settings().with_method(method);
        let own = Method { level, ..Prepared::method_of(&settings).unwrap() };
        let prepared = Prepared::with(&scene, &[2.0, 0.4], own, settings).unwrap();
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
        let stepped = analysis.complex_step(&prepared.x, &forward).unwrap();
        let rows = adjoint.rows.iter().zip(&stepped.rows);
        let off = rows.map(|(own, other)| largest_difference(own, other)).fold(0.0, f64::max);
        assert!(off < 1e-12, "{method}: {off:e}");
        let direction = [1.0, 0.3];
        let quotients = analysis.central_difference(&prepared.x, &direction, 1e-5).unwrap();
        for (row, quotient) in adjoint.rows.iter().zip(quotients) {
            let own = row[0] * direction[0] + row[1] * direction[1];
            assert!((own - quotient).abs() < 1e-6 * own.abs().max(0.1), "{method}: {own} for {quotient}");
        }
    }
}

#[test]
fn a_carried_hook_moves_its_bob_as_a_moved_pivot_does() {
    // a body of next to no mass is what has none
    let light = HOOK.replace(
        "position = [\"reach / 2\", 0, 0]",
        "position = [\"reach / 2\", 0, 0]\nmass = 1e-9\ninertia = [1e-11, 1e-11, 1e-11]",
    );
    assert_ne!(light, HOOK);
    let [own, light] = [HOOK, &light].map(|text| values(text, "esdirk4", ConstraintLevel::Acceleration).unwrap());
    for (own, light) in own.iter().zip(&light) {
        assert!((own - light).abs() < 1e-7 * own.abs().max(1.0), "{own} {light}");
    }
}

/// A weight on massless links from the ground, each with a joint of a kind at its beginning.
fn links(joints: &[&str]) -> String {
    let mut text = "version = 1\ngravity = [0, -9.81, 0]\n[settings]\nend = 0.1\nsteps = 10\n".to_string();
    let mut before = "ground".to_string();
    for (i, joint) in joints.iter().enumerate() {
        let own = if i + 1 == joints.len() { "weight".to_string() } else { format!("link {i}") };
        let mass = if own == "weight" { "mass = 1\ninertia = [1, 1, 1]\n" } else { "" };
        text += &format!("[[body]]\nname = \"{own}\"\nposition = [{i}.5, 0, 0]\n{mass}");
        let axis = if *joint == "revolute" { "axis = [0, 0, 1]\n" } else { "" };
        text += &format!(
            "[[joint]]\nname = \"joint {i}\"\ntype = \"{joint}\"\nbetween = [\"{before}\", \"{own}\"]\npoint = [{i}, 0, 0]\n{axis}"
        );
        before = own;
    }
    text
}

#[test]
fn what_nothing_determines_is_refused_by_name_at_the_start() {
    let cases: [(&[&str], &[&str]); 3] = [
        // it turns about its own axis
        (&["spherical", "spherical"], &["link 0"]),
        (&["revolute", "revolute", "revolute"], &["link 0", "link 1"]),
        (&["fixed", "spherical", "spherical"], &["link 1"]),
    ];
    for (joints, named) in cases {
        for method in ["esdirk4", "bdf2", "variational"] {
            let why = values(&links(joints), method, ConstraintLevel::Acceleration).expect_err("not determined");
            assert!(why.contains("start (t = 0 s)") && why.contains("do not determine"), "{joints:?}, {method}: {why}");
            assert!(named.iter().any(|name| why.contains(&format!("\"{name}\""))), "{joints:?}, {method}: {why}");
        }
        let why = values(&links(joints), "static", ConstraintLevel::Acceleration).expect_err("not determined");
        assert!(why.contains("step 1, ") && why.contains("nothing holds it in equilibrium"), "{why}");
    }
}

#[test]
fn redundant_hinges_share_their_loads_alike_in_all_units() {
    let [metres, millimetres] = FRAMES.map(|text| {
        let scene = parsed(text);
        let prepared = Prepared::new(&scene).unwrap();
        let values = prepared.analysis().forward(&[]).unwrap().values;
        let names: Vec<String> = prepared.functionals().iter().map(|own| own.name.clone()).collect();
        let [joints, undetermined] = prepared.undetermined();
        assert_eq!(joints, ["hinge left", "hinge right"]);
        // nothing pulls along the axis or across it, but hinges may pull at each other
        for name in &undetermined {
            assert!(!name.contains("moment x"), "{name}");
        }
        assert!(undetermined.contains(&"left force z") && undetermined.contains(&"right moment y"), "{undetermined:?}");
        (names, values)
    });
    for ((name, metres), millimetres) in metres.0.iter().zip(&metres.1).zip(&millimetres.1) {
        let millimetres = if name.contains("moment") { millimetres * 1e-3 } else { *millimetres };
        assert!((metres - millimetres).abs() < 1e-9, "{name}: {metres} and {millimetres}");
    }
    // both weights are carried, and their couple about the middle
    let of = |name: &str| metres.1[metres.0.iter().position(|own| own == name).unwrap()];
    // the hinges' axis is turned about by alpha = 3.8 kg m g / 1.75 kg m2
    let (g, lift) = (9.81, of("left force z") + of("right force z"));
    let alpha = 3.8 * g / 1.75;
    let couple = 0.4 * (of("left force z") - of("right force z")) + of("left moment y") + of("right moment y");
    assert!((lift - (10.0 * g - 3.8 * alpha)).abs() < 1e-9, "{lift}");
    assert!((couple - 0.35 * 4.0 * (0.5 * alpha - g)).abs() < 1e-9, "{couple}");
}

#[test]
fn the_size_of_a_reaction_is_of_forces_alone() {
    // a plate of 2 kg off the middle of a planar joint, whose normal is up: one force and two moments
    let text = r#"
version = 1
gravity = [0, 0, -9.81]
[settings]
end = 0.1
steps = 10
[[body]]
name = "plate"
position = [0.5, 0, 0]
mass = 2
inertia = [1, 1, 1]
[[joint]]
name = "table"
type = "planar"
between = ["ground", "plate"]
normal = [0, 0, 1]
[[functional]]
name = "force"
type = "reaction_norm"
joint = "table"
over = "terminal"
"#;
    let found = values(text, "esdirk4", ConstraintLevel::Acceleration).unwrap();
    assert!((found[0] - 19.62).abs() < 1e-9, "{found:?}");
}
