//! Functions of time that files give as formulas.

use super::{parsed, refused};
use costate::scenes::Prepared;
use costate::sensitivity::largest_difference;

/// A motor on a welded base turns an arm (report 2966 of Bullet): the weld has the moment of the motor, the hinge none about its axis.
const MOTOR: &str = r#"version = 1
gravity = [0, -9.81, 0]
settings = { end = 1.0, steps = 500 }
variable.acceleration = { initial = 3, bounds = [0, 10], unit = "rad/s2" }

[[body]]
name = "base"
mass = 3
inertia = [0.1, 0.1, 0.1]

[[body]]
name = "arm"
position = [0.5, 0, 0]
mass = 2
inertia = [0.01, 0.2, 0.2]

[[joint]]
name = "weld"
type = "fixed"
between = ["ground", "base"]

[[joint]]
name = "hinge"
type = "revolute"
between = ["base", "arm"]
point = [0, 0, 0]
axis = [0, 0, 1]

[[driver]]
name = "motor"
type = "rotation"
between = ["base", "arm"]
axis = [0, 0, 1]
angle = { type = "formula", value = "0.5 * acceleration * t^2", end = 1.0, intervals = 200 }

[[functional]]
name = "moment of the weld"
type = "joint_load"
joint = "weld"
on = "base"
load = "moment"
direction = [0, 0, 1]
over = "terminal"

[[functional]]
name = "moment of the hinge about its axis"
type = "joint_load"
joint = "hinge"
on = "arm"
point = [0, 0, 0]
load = "moment"
direction = [0, 0, 1]
over = "terminal"
"#;

#[test]
fn a_formula_of_time_is_exact_with_its_rates() {
    let scene = parsed(MOTOR);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    // about the hinge: the arm's inertia by its acceleration, and its weight at the angle of 1.5 rad
    let inertia = 0.2 + 2.0 * 0.5 * 0.5;
    let moment = inertia * 3.0 + 2.0 * 9.81 * 0.5 * 1.5_f64.cos();
    let [weld, hinge] = [0, 1].map(|k| forward.values[k]);
    assert!((weld.abs() - moment).abs() < 1e-11 && hinge.abs() < 1e-11, "{weld} {moment} {hinge}");
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap();
    let by_acceleration = inertia - 2.0 * 9.81 * 0.5 * 0.5 * 1.5_f64.sin();
    assert!((gradient.rows[0][0].abs() - by_acceleration.abs()).abs() < 1e-10, "{:?} {by_acceleration}", gradient.rows);
    let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
    assert!(largest_difference(&reference.rows[0], &gradient.rows[0]) < 1e-12);
}

#[test]
fn a_formula_of_time_uses_any_names_and_may_choose() {
    let stop = |value: &str| {
        MOTOR.replace("\"0.5 * acceleration * t^2\"", value).replace("end = 1.0, intervals = 200", "breakpoints = [0.5]")
    };
    let vectors = stop("\"dot(half, [acceleration, 1, 0]) * t^2\"");
    let vectors = vectors.replacen("variable.", "define.half = [0.5, 0, 0]\nvariable.", 1);
    let blend = stop("\"if_less(t, 0.5, 0.5 * acceleration * t^2, 0.125 * acceleration + 0.5 * acceleration * (t - 0.5))\"");
    for (text, angle) in [(vectors, 1.5_f64), (blend, 1.125)] {
        let scene = parsed(&text);
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        let forward = prepared.analysis().forward(&prepared.x).unwrap();
        let rate = if angle > 1.2 { 3.0 } else { 0.0 };
        let moment = 0.7 * rate + 9.81 * angle.cos();
        assert!((forward.values[0].abs() - moment).abs() < 1e-10, "{} {moment}", forward.values[0]);
    }
}

#[test]
fn motions_that_jump_and_formulas_that_end_too_early_are_refused() {
    let formula = "value = \"0.5 * acceleration * t^2\", end = 1.0, intervals = 200";
    for (by, parts) in [
        ("value = \"abs(t - 0.5) - 0.5\"", ["motor", "0.5 s"]),
        ("value = \"max(t, 0.5) - 0.5\", breakpoints = []", ["motor", "0.5 s"]),
        ("value = \"atan(tan(9 * t^2))\"", ["motor", "0.41777"]),
        ("value = \"t^2\", end = 0.5", ["end lies within the run", "if_less"]),
        ("value = \"t^2\", start = 0.1", ["start lies within the run", "if_less"]),
        ("value = \"acceleration / t\"", ["at t = 0 s the value is not finite", ""]),
        ("value = \"t\"", ["start violates its constraints", "motor"]),
        ("value = \"t\", breakpoints = 0.5", ["breakpoints of", "a list of numbers"]),
    ] {
        let message = refused(&MOTOR.replace(formula, by));
        assert!(parts.iter().all(|part| message.contains(part)), "{by}: {message}");
    }
}
