//! Power and work of loads, dampers, actuators and drivers: closed forms, and the balance of energies.

use super::parsed;
use costate::scenes::{AnyScene, FileScene, Prepared};

fn values(text: &str) -> Vec<f64> {
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).unwrap_or_else(|why| panic!("{why}"));
    let gradient = analysis.adjoint(&x, &forward).unwrap_or_else(|why| panic!("{why}"));
    let complex = analysis.complex_step(&x, &forward).unwrap();
    for (k, (own, complex)) in gradient.rows.iter().zip(&complex.rows).enumerate() {
        let size = complex.iter().fold(1e-6, |size: f64, entry| size.max(entry.abs()));
        assert!(
            own.iter().zip(complex).all(|(own, complex)| (own - complex).abs() < 1e-11 * size),
            "{k}: {own:?} {complex:?}"
        );
    }
    forward.values
}

/// A mass that slides against a damper under a force, between a spring, and a drive that turns a bar beside it.
const SCENE: &str = r#"
version = 1
settings = { end = 2, steps = 400 }
variable.c = { initial = 3, bounds = [0, 100], unit = "N s/m" }
variable.push = { initial = 5, bounds = [0, 100], unit = "N" }
variable.inertia = { initial = 0.5, bounds = [0, 100], unit = "kg m2" }
body = [
    { name = "mass", mass = 2, inertia = [1, 1, 1] },
    { name = "bar", mass = 1, inertia = [1, "inertia", 1], angular_velocity = [0, 0.3, 0] },
]
joint = [
    { name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] },
    { name = "hinge", type = "revolute", between = ["ground", "bar"], axis = [0, 1, 0] },
]
driver = [{ name = "motor", type = "rotation", between = ["ground", "bar"], axis = [0, 1, 0], angle = { type = "formula", value = "0.3 * t + 0.7 * t^2" } }]
spring = [{ name = "spring", type = "slide", between = ["ground", "mass"], axis = [1, 0, 0], stiffness = 8, damping = "c" }]
force = [{ name = "push", on = "mass", direction = [1, 0, 0], size = { type = "formula", value = "push * cos(t)" } }]
functional = [
    { name = "lost", type = "power", of = ["spring"], over = "integral" },
    { name = "worked", type = "power", of = ["push"], over = "integral" },
    { name = "both", type = "power", over = "integral" },
    { name = "driven", type = "joint_power", joint = "motor", over = "integral" },
    { name = "on the bar", type = "joint_power", joint = "motor", on = "bar", over = "terminal" },
    { name = "held", type = "joint_power", joint = "slide", over = "integral" },
    { name = "energy", type = "energy", over = "terminal" },
    { name = "first", type = "energy", over = "initial" },
    { name = "speed", type = "velocity", on = "mass", direction = [1, 0, 0], over = "terminal" },
]
"#;

#[test]
fn works_are_those_of_closed_forms_and_balance_the_energy() {
    let [lost, worked, both, driven, at_end, held, energy, first, _] = values(SCENE)[..] else { panic!("nine") };
    assert!((lost + worked - both).abs() < 1e-12, "{lost} {worked} {both}");
    // I (w1^2 - w0^2) / 2 with w = 0.3 + 1.4 t, and I w' w
    let (before, after) = (0.3_f64, 0.3 + 1.4 * 2.0);
    assert!((driven - 0.25 * (after * after - before * before)).abs() < 1e-6, "{driven}");
    assert!((at_end - 0.5 * 1.4 * after).abs() < 1e-9, "{at_end}");
    assert!(held.abs() < 1e-12 && lost < -0.1, "{held} {lost}");
    assert!((energy - first - both - driven).abs() < 1e-5, "{} {}", energy - first, both + driven);
}

#[test]
fn what_the_steps_leave_of_the_balance_falls_with_their_order() {
    let left = |steps: usize| {
        let [_, _, both, driven, _, _, energy, first, _] =
            values(&SCENE.replace("steps = 400", &format!("steps = {steps}")))[..]
        else {
            panic!("nine")
        };
        (energy - first - both - driven).abs()
    };
    let (coarse, fine) = (left(25), left(50));
    assert!(fine < 0.3 * coarse && coarse < 1e-2, "{coarse:e} {fine:e}");
}

/// A damped beam on a hinge that a force sets off: all of its own losses are in its power.
const BEAM: &str = r#"
version = 1
settings = { end = 0.05, steps = 100 }
gravity = [0, 0, -9.81]
variable.h = { initial = 0.01, bounds = [0.001, 1], unit = "m" }
material.aluminium = { density = 2700, young = 7e10, poisson = 0.3 }
section.bar = { type = "rectangle", width = 0.02, height = "h", material = "aluminium", damping = 1e-4 }
beam = [{ name = "bar", elements = 3, from = [0, 0, 0], to = [0.5, 0, 0], section = "bar", second_axis = [0, 1, 0], clamped = ["start"] }]
force = [{ name = "push", on = "bar[3]", direction = [0, 0, 1], size = { type = "formula", value = "40 * sin(100 * t)" } }]
functional = [
    { name = "lost", type = "power", of = ["bar"], over = "integral" },
    { name = "worked", type = "power", of = ["push"], over = "integral" },
    { name = "energy", type = "energy", over = "terminal" },
    { name = "first", type = "energy", over = "initial" },
]
"#;

#[test]
fn losses_of_members_are_in_their_power() {
    let [lost, worked, energy, first] = values(BEAM)[..] else { panic!("four") };
    assert!(lost < -1e-3 * worked && worked > 0.0, "{lost} {worked}");
    assert!((energy - first - lost - worked).abs() < 1e-3 * worked, "{} {}", energy - first, lost + worked);
}

#[test]
fn what_puts_no_energy_in_is_refused() {
    let text = SCENE.replace("of = [\"push\"]", "of = [\"mass\"]");
    let scene = FileScene::parse("power.toml", &text).unwrap();
    let why = Prepared::new(&scene).err().map(|why| why.to_string()).unwrap_or_default();
    assert!(why.contains("none of the") && why.contains("power"), "{why}");
}
