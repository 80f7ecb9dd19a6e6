//! Steps that end where elements pass from one piece of their formulas to another, against closed forms and quotients of whole runs.

use super::parsed;
use costate::history::Keep;
use costate::integrators::{Table, tables};
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use costate::sensitivity::{Analysis, Forward};

const BUFFERS: &str = r#"
version = 1
settings = { end = 1.0, steps = 200 }
variable.m = { initial = 1, bounds = [0.1, 10], unit = "kg" }
variable.k = { initial = 400, bounds = [1, 1e5], unit = "N/m" }
variable.d = { initial = 0.05, bounds = [0, 1], unit = "m" }
variable.v0 = { initial = 1, bounds = [0.1, 10], unit = "m/s" }
coordinate = [{ name = "x", rate = "v0" }]
element = [
    { name = "mass", nodes = { x = "x" }, kinetic = "0.5 * m * x.rate^2" },
    { name = "buffers", nodes = { x = "x" }, force = { x = "k * (max(-d - x.value, 0) - max(x.value - d, 0))" } },
]
functional = [{ name = "x at T", type = "formula", nodes = { x = "x" }, value = "x.value", unit = "m", over = "terminal" }]
"#;

/// The first functional and its gradient.
fn by_adjoint(scene: &FileScene, table: &Table, steps: usize) -> (Vec<f64>, Forward) {
    let place = format!("{}, {steps} steps", table.name);
    let mut settings = AnyScene::settings(scene).without_method();
    settings.steps = steps;
    let x: Vec<f64> = AnyScene::variables(scene).iter().map(|variable| variable.initial).collect();
    let method = Method::new(table.clone(), settings.level);
    let prepared = Prepared::with(scene, &x, method, settings).expect(&place);
    let forward = prepared.analysis().forward(&x).unwrap_or_else(|why| panic!("{place}: {why}"));
    let rows = prepared.analysis().adjoint(&x, &forward).unwrap_or_else(|why| panic!("{place}: {why}")).rows;
    (rows[0].clone(), forward)
}

fn assert_near(own: f64, exact: f64, limit: f64) {
    assert!((own - exact).abs() <= limit, "{own} for {exact}, {limit:e}");
}

fn table(name: &str) -> Table {
    tables().into_iter().find(|table| table.name == name).expect("listed")
}

/// Between the buffers the mass moves evenly, in a buffer it makes half a vibration: one period takes 2 pi sqrt(m / k) + 4 d / v0, and shortly before
/// the end of the second one it is on its way from the left buffer to the middle.
fn between_buffers([m, k, d, v0]: [f64; 4]) -> f64 {
    let period = 2.0 * std::f64::consts::PI * (m / k).sqrt() + 4.0 * d / v0;
    v0 * (1.0 - 2.0 * period)
}

#[test]
fn between_two_buffers_values_and_gradients_keep_the_order_of_the_method() {
    let scene = parsed(BUFFERS);
    let x = [1.0, 400.0, 0.05, 1.0];
    let quotient = |i: usize| {
        let moved = |by: f64| {
            let mut x = x;
            x[i] *= 1.0 + by;
            between_buffers(x)
        };
        let h = 1e-4;
        let [near, far] = [h, 2.0 * h].map(|h| (moved(h) - moved(-h)) / (2.0 * h * x[i]));
        (4.0 * near - far) / 3.0
    };
    let gradient: Vec<f64> = (0..4).map(quotient).collect();
    let errors = [200, 400].map(|steps| {
        let (row, forward) = by_adjoint(&scene, &table("esdirk4"), steps);
        assert!(forward.crossings.is_empty(), "{:?}", forward.crossings);
        assert_eq!(forward.grid.events.len(), 8);
        let of_value = (forward.values[0] - between_buffers(x)).abs();
        let of_row = row.iter().zip(&gradient).map(|(own, exact)| (own - exact).abs() / exact.abs()).fold(0.0, f64::max);
        [of_value, of_row]
    });
    println!("{errors:?}");
    for k in 0..2 {
        assert!(errors[0][k] < 1e-6 && errors[1][k] < errors[0][k] / 10.0, "{errors:?}");
    }
}

#[test]
fn adjoint_tangent_complex_step_and_quotients_agree_by_every_method() {
    let methods = tables().into_iter().filter(|own| !own.is_static() && own.variational.is_none());
    let cases =
        methods.map(|own| (BUFFERS, own)).chain([PENDULUM, RELEASE, TABLES, ANGLES].map(|text| (text, table("esdirk4"))));
    for (text, table) in cases {
        let scene = parsed(text);
        let settings = AnyScene::settings(&scene).without_method();
        let x: Vec<f64> = AnyScene::variables(&scene).iter().map(|variable| variable.initial).collect();
        let method = Method::new(table, settings.level);
        let prepared = Prepared::with(&scene, &x, method, settings).expect("it is sound");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&x).expect("it runs");
        assert!(!forward.grid.events.is_empty());
        let [adjoint, tangent, complex] = [Analysis::adjoint, Analysis::tangent, Analysis::complex_step]
            .map(|by| by(&analysis, &x, &forward).expect("it has a gradient").rows);
        let on_steps = analysis.on_steps_of(&forward);
        for (k, row) in adjoint.iter().enumerate() {
            let size = row.iter().fold(0.0, |size: f64, own| size.max(own.abs()));
            for i in 0..x.len() {
                let mut along = vec![0.0; x.len()];
                along[i] = 1.0;
                let quotient = on_steps.central_difference(&x, &along, 1e-4 * x[i].abs()).expect("it runs")[k];
                assert_near(row[i], complex[k][i], 1e-11 * size);
                assert_near(row[i], tangent[k][i], 1e-11 * size);
                // whose round-off is that of motions of order one
                assert_near(row[i], quotient, 1e-9 * size.max(1.0));
            }
        }
    }
}

/// A pendulum with elastic and damped stops at -1 and 1 rad.
const PENDULUM: &str = r#"
version = 1
gravity = [0, 0, -9.81]
variable.stop = { initial = 500, bounds = [10, 1e5], unit = "N m/rad" }
variable.damper = { initial = 4, bounds = [0, 1e5], unit = "N m s/rad" }
settings = { end = 1.5, steps = 300 }
body = [{ name = "rod", position = [0, 0, -0.5], mass = 2.0, inertia = [0.2, 0.2, 0.002], angular_velocity = [0, 6, 0], velocity = [-3, 0, 0] }]
joint = [{ name = "pin", type = "revolute", between = ["ground", "rod"], point = [0, 0, 0], axis = [0, 1, 0] }]
spring = [{ name = "stops", type = "torsion_law", between = ["ground", "rod"], axis = [0, 1, 0], moment = "if_less(s, -1, stop * (s + 1) + damper * v, if_less(1, s, stop * (s - 1) + damper * v, 0))" }]
functional = [
    { name = "angle", type = "joint_angle", between = ["ground", "rod"], axis = [0, 1, 0], over = "terminal" },
    { name = "mean square", type = "formula", nodes = { rod = "rod" }, value = "rod.velocity.x^2", unit = "m2/s2", over = "integral" },
]
"#;

/// A mass between tables: of lines, with and without variables, and of steps, of the place and of the rate.
const TABLES: &str = r#"
version = 1
variable.k = { initial = 50, bounds = [1, 1e3], unit = "N/m" }
variable.start = { initial = 0.4, bounds = [-3, 3], unit = "m" }
settings = { end = 3, steps = 400 }
coordinate = [{ name = "x", initial = "start", rate = 1.5 }]
[[element]]
name = "mass"
nodes = { x = "x" }
kinetic = "0.5 * x.rate^2"
[[element]]
name = "springs"
nodes = { x = "x" }
table.spring = { points = [-1, 0, 0.2, 1], values = ["-2 * k", "-0.1 * k", "0.1 * k", "k"], interpolation = "lines" }
table.damper = { points = [-10, -0.5, 0.5, 10], values = [-8, -1, 1, 3], interpolation = "lines" }
table.steps = { points = [-1, 0.3, 2], values = [0, 0, 1], interpolation = "steps" }
force = { x = "-spring(x.value) - damper(x.rate) - k * steps(x.value)" }
[[functional]]
name = "x"
type = "formula"
nodes = { x = "x" }
value = "x.value"
unit = "m"
over = "terminal"
[[functional]]
name = "square"
type = "formula"
nodes = { x = "x" }
value = "x.rate^2"
unit = "m2/s2"
over = "integral"
"#;

/// Springs of an angle that leaps at pi, and of an angle to the nearest turn, whose whole turns leap with it.
const ANGLES: &str = r#"
version = 1
variable.k = { initial = 9, bounds = [1, 1e3], unit = "N m/rad" }
variable.start = { initial = -0.5, bounds = [-3, 3], unit = "rad" }
settings = { end = 0.6, steps = 120 }
coordinate = [{ name = "x", initial = "start", rate = 12 }, { name = "y", initial = "start", rate = 9 }]
element = [
    { name = "masses", nodes = { x = "x", y = "y" }, kinetic = "0.5 * x.rate^2 + 0.5 * y.rate^2" },
    { name = "spring", nodes = { x = "x" }, force = { x = "-k * atan2(sin(x.value), cos(x.value))" } },
    { name = "nearest", nodes = { y = "y" }, define = { a = "atan2(sin(y.value), cos(y.value)) - 1" }, force = { y = "-k * (a - floor(a / 6.283185307179586 + 0.5) * 6.283185307179586)" } },
]
functional = [
    { name = "x", type = "formula", nodes = { x = "x" }, value = "x.value", unit = "rad", over = "terminal" },
    { name = "y", type = "formula", nodes = { y = "y" }, value = "y.value", unit = "rad", over = "terminal" },
    { name = "angle", type = "formula", nodes = { y = "y" }, value = "atan2(sin(y.value), cos(y.value))", unit = "rad", over = "integral" },
    { name = "beyond", type = "formula", nodes = { x = "x" }, value = "if_less(x.rate, 11, x.value, 0)", unit = "-", over = "integral" },
]
"#;

/// A pendulum whose rod lets go of the mass at an angle.
const RELEASE: &str = r#"
version = 1
gravity = [0, 0, -9.81]
variable.L = { initial = 1.5, bounds = [0.1, 10], unit = "m" }
variable.start = { initial = -1.2, bounds = [-3, 0], unit = "rad" }
variable.release = { initial = 0.7, bounds = [0, 3], unit = "rad" }
settings = { end = 1.7, steps = 400 }
point = [{ name = "mass", position = ["L * sin(start)", 0, "-L * cos(start)"], mass = 1 }]
[[element]]
name = "rod"
nodes = { m = "mass" }
define = { r = "norm(m.position)" }
force = { m = "if_less(atan2(m.position.x, -m.position.z), release, -2e3 * (r - L) / r, 0) * m.position" }
[[functional]]
name = "x"
type = "formula"
nodes = { m = "mass" }
value = "m.position.x"
unit = "m"
over = "terminal"
"#;

/// It leaves as fast as it came: whatever the mass and the stiffness are. The force is defined on one side alone.
#[test]
fn an_elastic_impact_by_the_law_of_hertz_returns_the_velocity() {
    let scene = parsed(
        r#"
version = 1
settings = { end = 0.02, tolerance = 1e-12 }
variable.m = { initial = 0.5, bounds = [0.1, 10], unit = "kg" }
variable.K = { initial = 1e6, bounds = [1e3, 1e9], unit = "N/m1.5" }
variable.v = { initial = 2, bounds = [0.1, 10], unit = "m/s" }
variable.h = { initial = 0.004, bounds = [0, 1], unit = "m" }
point = [{ name = "ball", position = [0, 0, "h"], velocity = [0, 0, "-v"], mass = "m" }]
element = [{ name = "floor", nodes = { ball = "ball" }, force = { ball = "[0, 0, K * max(-ball.position.z, 0)^1.5]" } }]
functional = [{ name = "velocity", type = "formula", nodes = { ball = "ball" }, value = "ball.velocity.z", unit = "m/s", over = "terminal" }]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let x = [0.5, 1e6, 2.0, 0.004];
    let forward = prepared.analysis().forward(&x).expect("it runs");
    assert_eq!(forward.grid.events.len(), 2);
    let gradient = prepared.analysis().adjoint(&x, &forward).expect("it has one").rows[0].clone();
    println!("{:?} {gradient:?}", forward.values);
    assert_near(forward.values[0], 2.0, 1e-8);
    for (own, (exact, size)) in gradient.iter().zip([(0.0, 4.0), (0.0, 2e-6), (1.0, 1.0), (0.0, 500.0)]) {
        assert_near(*own, exact, 1e-7 * size);
    }
}

/// Two balls that push each other elastically, and all methods and levels.
#[test]
fn two_balls_exchange_their_velocities_by_every_method() {
    let scene = parsed(
        r#"
version = 1
variable.x1 = { initial = 0.0, bounds = [-1, 1], unit = "m" }
variable.x2 = { initial = 0.52, bounds = [0, 2], unit = "m" }
variable.v0 = { initial = 1.0, bounds = [0.1, 10], unit = "m/s" }
variable.u0 = { initial = 0.0, bounds = [-1, 1], unit = "m/s" }
settings = { end = 1.0, steps = 600 }
point = [{ name = "left", position = ["x1", 0, 0], velocity = ["v0", 0, 0], mass = 1 }, { name = "right", position = ["x2", 0, 0], velocity = ["u0", 0, 0], mass = 1 }]
spring = [{ name = "push", type = "line_law", between = ["left", "right"], rest_length = 0.2, energy = "if_less(s, 0, 1e4 * s^2 / 2, 0)" }]
functional = [{ name = "right at the end", type = "position", on = "right", direction = [1, 0, 0], over = "terminal" }]
"#,
    );
    // the duration of the push is half a period of sqrt(m/2 / k)
    let push = std::f64::consts::PI * (0.5f64 / 1e4).sqrt();
    let exact = [0.52 + (1.0 - 0.32 - 0.5 * push), 1.0, 0.0, 1.0 - 0.5 * push, 0.5 * push];
    for own in tables().into_iter().filter(|own| !own.is_static() && own.variational.is_none()) {
        let errors = [600, 1200].map(|steps| {
            let (row, forward) = by_adjoint(&scene, &own, steps);
            let all = [&forward.values[..], &row].concat();
            all.iter().zip(exact).map(|(own, exact)| (own - exact).abs()).fold(0.0, f64::max)
        });
        println!("{} of order {}: {errors:?}, {}", own.name, own.order, errors[0] / errors[1]);
        assert!(errors[1] < 1.5 * errors[0] / 2f64.powi(own.order as i32), "{}: {errors:?}", own.name);
    }
}

#[test]
fn steps_kept_elsewhere_give_the_same_bits() {
    let scene = parsed(PENDULUM);
    let prepared = Prepared::new(&scene).expect("it is sound");
    let x = [500.0, 4.0];
    let folder = std::env::temp_dir().join(format!("costate-located-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let keeps = [Keep::Memory, Keep::File(folder.join("run")), Keep::Checkpoints(20_000)];
    let rows = keeps.map(|keep| {
        let analysis = Analysis { keep: &keep, ..prepared.analysis() };
        let forward = analysis.forward(&x).unwrap_or_else(|why| panic!("{keep:?}: {why}"));
        (forward.values.clone(), analysis.adjoint(&x, &forward).unwrap_or_else(|why| panic!("{keep:?}: {why}")).rows)
    });
    std::fs::remove_dir_all(&folder).expect("it is there");
    assert_eq!(rows[0], rows[1]);
    assert_eq!(rows[0], rows[2]);
}

/// With dry friction written as a sign a body comes to rest and stays: no step ends that.
#[test]
fn a_motion_along_a_switch_is_an_error_that_names_the_part() {
    let scene = parsed(
        r#"
version = 1
settings = { end = 1.0, steps = 100 }
coordinate = [{ name = "x", rate = 1 }]
element = [
    { name = "mass", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2" },
    { name = "dry friction", nodes = { x = "x" }, force = { x = "if_less(x.rate, 0, 4, -4)" } },
]
functional = [{ name = "x", type = "formula", nodes = { x = "x" }, value = "x.value", unit = "m", over = "terminal" }]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let error = prepared.analysis().forward(&[]).expect_err("it rests from 0.25 s on").to_string();
    assert!(error.contains("\"dry friction\" at t = 0.249999999") && error.contains("goes along the switch"), "{error}");
}

/// A thin wall that pushes back, which a step passes twice if its force goes on: the kink of the absolute value lies within the wall.
#[test]
fn a_thin_wall_is_left_on_the_other_side() {
    let scene = parsed(
        r#"
version = 1
variable.push = { initial = 1e3, bounds = [0, 1e4], unit = "N" }
variable.half = { initial = 0.001, bounds = [0, 0.1], unit = "m" }
settings = { end = 2.0, tolerance = 1e-6 }
point = [{ name = "ball", position = [0, 0, 3], velocity = [0, 0, -4], mass = 1 }]
element = [{ name = "wall", nodes = { b = "ball" }, force = { b = "[0, 0, if_less(abs(b.position.z), half, push, 0)]" } }]
functional = [{ name = "height", type = "position", on = "ball", direction = [0, 0, 1], over = "terminal" }]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let height = |push: f64, half: f64| {
        let left = (16.0 - 4.0 * push * half).sqrt();
        -half - left * (2.0 - (3.0 - half) / 4.0 - (4.0 - left) / push)
    };
    let central = |of: &dyn Fn(f64) -> f64| (8.0 * (of(1e-3) - of(-1e-3)) - of(2e-3) + of(-2e-3)) / 12e-3;
    let [push, half] = [1e3, 1e-3];
    let exact =
        [central(&|by| height(push * (1.0 + by), half)) / push, central(&|by| height(push, half * (1.0 + by))) / half];
    let forward = prepared.analysis().forward(&[push, half]).expect("it runs");
    assert_near(forward.values[0], height(push, half), 1e-12);
    let row = &prepared.analysis().adjoint(&[push, half], &forward).expect("it has one").rows[0];
    for (own, exact) in row.iter().zip(exact) {
        assert_near(*own, exact, 1e-9 * exact.abs());
    }
}

/// What functionals measure may leap: time spent below a place, and an angle that passes pi, of x = x_0 + v t.
#[test]
fn functionals_that_leap_are_exact() {
    use std::f64::consts::{PI, TAU};
    let scene = parsed(
        r#"
version = 1
variable.start = { initial = 2.5, bounds = [0, 3], unit = "rad" }
variable.rate = { initial = 3, bounds = [0, 10], unit = "rad/s" }
settings = { end = 1, steps = 7 }
coordinate = [{ name = "x", initial = "start", rate = "rate" }]
element = [{ name = "mass", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2" }]
functional = [
    { name = "time below 4", type = "formula", nodes = { x = "x" }, value = "if_less(x.value, 4, 1, 0)", unit = "-", over = "integral" },
    { name = "angle", type = "formula", nodes = { x = "x" }, value = "atan2(sin(x.value), cos(x.value))", unit = "rad", over = "integral" },
    { name = "size", type = "formula", nodes = { x = "x" }, value = "abs(x.value - 3)", unit = "rad", over = "integral" },
]
"#,
    );
    let [x, v] = [2.5, 3.0];
    let prepared = Prepared::new(&scene).expect("it is sound");
    let forward = prepared.analysis().forward(&[x, v]).expect("it runs");
    assert!(forward.crossings.is_empty(), "{:?}", forward.crossings);
    let rows = prepared.analysis().adjoint(&[x, v], &forward).expect("it has a gradient").rows;
    let half = (PI - x) / v;
    let exact = [
        ((4.0 - x) / v, [-1.0 / v, -(4.0 - x) / (v * v)]),
        (x + 0.5 * v - TAU * (1.0 - half), [1.0 - TAU / v, 0.5 - TAU * half / v]),
        {
            let [before, behind] = [3.0 - x, x + v - 3.0];
            let by_start = [-before / v, behind / v];
            let by_rate = [-0.5 * before * before / (v * v), behind / v - 0.5 * behind * behind / (v * v)];
            (0.5 * (before * before + behind * behind) / v, [by_start[0] + by_start[1], by_rate[0] + by_rate[1]])
        },
    ];
    for ((own, row), (value, by)) in forward.values.iter().zip(&rows).zip(exact) {
        assert_near(*own, value, 1e-13);
        row.iter().zip(by).for_each(|(own, exact)| assert_near(*own, exact, 1e-12));
    }
}

/// What moves off from rest to the other side of a switch than that of zero passes nothing, and its gradients are those of that side from the start on.
#[test]
fn motions_from_rest_have_the_side_to_which_they_go() {
    for method in ["esdirk4", "sdirk4", "newmark", "generalized-alpha", "bdf2", "bdf3"] {
        let scene = parsed(
            &r#"
            version = 1
            variable.load = { initial = 3, bounds = [2, 5], unit = "N" }
            variable.drag = { initial = 1, bounds = [0.1, 2], unit = "N" }
            settings = { end = 1, steps = 10, method = "METHOD" }
            coordinate = [{ name = "x" }]
            element = [{ name = "m", nodes = { x = "x" }, kinetic = "0.5 * 2 * x.rate^2", force = { x = "-load - drag * if_less(x.rate, 0, -1, 1)" } }]
            functional = [{ name = "x", type = "coordinate", on = "x", over = "terminal" }]
            "#
            .replace("METHOD", method),
        );
        let prepared = Prepared::new(&scene).expect("it is sound");
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("it runs");
        let row = &analysis.adjoint(x, &forward).expect("it is smooth").rows[0];
        assert_near(forward.values[0], -0.5, 1e-12);
        // x(1) = (drag - load) / (2 m)
        assert_near(row[0], -0.25, 1e-12);
        assert_near(row[1], 0.25, 1e-12);
    }
}

/// An equilibrium is on the side of zero of a switch of the velocity, also where the motion begins on the other one with a velocity of its own.
#[test]
fn equilibria_have_the_side_of_rest() {
    let scene = parsed(
        r#"
        version = 1
        variable.load = { initial = 3, bounds = [2, 5], unit = "N" }
        variable.push = { initial = 1, bounds = [0.1, 2], unit = "N" }
        settings = { end = 1, tolerance = 1e-10, start = "equilibrium" }
        coordinate = [{ name = "x", rate = -1 }]
        element = [
            { name = "m", nodes = { x = "x" }, kinetic = "0.5 * 2 * x.rate^2", potential = "0.5 * 8 * x.value^2" },
            { name = "f", nodes = { x = "x" }, force = { x = "push * if_less(x.rate, 0, -1, 1) - load - load * t" } },
        ]
        functional = [{ name = "x", type = "coordinate", on = "x", over = "terminal" }]
        "#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    let row = &analysis.adjoint(x, &forward).expect("it is smooth").rows[0];
    // 2 x'' = -8 x - push - load (1 + t), from x0 = (push - load) / 8 with the rate -1
    let (load, push) = (3.0, 1.0);
    let by_push = 1.0 / 8.0 - 2.0 / 8.0 * (1.0 - f64::cos(2.0));
    let by_load = -1.0 / 8.0 - (1.0 - f64::sin(2.0) / 2.0) / 8.0;
    assert_near(forward.values[0], load * by_load + push * by_push - f64::sin(2.0) / 2.0, 1e-8);
    assert_near(row[0], by_load, 1e-8);
    assert_near(row[1], by_push, 1e-8);
}
