//! Modes in optimizations: optima with closed forms.

use super::parsed;
use costate::optimize::{Optimization, Optimized, Sqp};
use costate::scenes::{AnyScene, FileScene, Prepared};

fn optimized(text: &str) -> (FileScene, Optimized) {
    let scene = parsed(text);
    let optimization = Optimization::of(&scene).unwrap();
    let optimized = optimization.run(&Sqp, &optimization.initial(), &mut ()).unwrap();
    assert!(optimized.ended.reason.is_optimum(), "{:?}", optimized.ended);
    (scene, optimized)
}

fn slider(limit: &str) -> String {
    format!(
        r#"
version = 1
settings = {{ end = 1, steps = 10 }}
variable.c = {{ initial = 8, bounds = [0.1, 100], unit = "N s/m" }}
body = [{{ name = "mass", mass = 2, inertia = [1, 1, 1] }}]
joint = [{{ name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] }}]
[[spring]]
name = "spring"
type = "slide"
between = ["ground", "mass"]
axis = [1, 0, 0]
stiffness = 200
damping = "c"
[[mode]]
name = "omega"
number = 1
damped = true
[[mode]]
name = "growth"
number = 1
measure = "growth"
damped = true
[optimization]
maximize = "omega"
{limit}
"#
    )
}

#[test]
fn the_fastest_oscillator_that_fades_fast_enough_needs_no_simulation() {
    let (_, optimized) = optimized(&slider("constraint = [{ functional = \"growth\", at_most = -3 }]"));
    let best = optimized.history.best().unwrap();
    // growth -c/2m, omega^2 = k/m - growth^2
    assert!((best.design[0] - 12.0).abs() < 1e-6, "{}", best.design[0]);
    assert!((best.objective - 91_f64.sqrt()).abs() < 1e-6, "{}", best.objective);
    assert_eq!(optimized.history.points.iter().map(|point| point.work.simulation.systems).sum::<usize>(), 0);
    // of another unit than functionals
    let units: Vec<&str> = optimized.history.functionals.iter().map(|own| own.1.as_str()).collect();
    assert_eq!(units, ["rad/s", "1/s"]);
}

/// A square bar, whose bending modes are two by two.
fn bar(more: &str) -> String {
    format!(
        r#"
version = 1
settings = {{ end = 1e-4, steps = 1 }}
variable.h = {{ initial = 0.02, bounds = [0.001, 0.1], unit = "m" }}
section.bar = {{ type = "rectangle", width = "h", height = "h", material = "steel" }}
material.steel = {{ density = 7800, young = 210e9, poisson = 0.3 }}
beam = [{{ name = "bar", from = [0, 0, 0], to = [1, 0, 0], elements = 8, section = "bar", second_axis = [0, 0, 1], clamped = "start" }}]
functional = [{{ name = "weight", type = "mass", of = "bar", over = "initial" }}]
mode = [{{ name = "bending", number = {more} }}]
[optimization]
minimize = "weight"
constraint = [{{ functional = "bending", at_least = 100 }}]
"#
    )
}

#[test]
fn the_lightest_bar_keeps_its_frequency() {
    // omega = beta^2 sqrt(E h^2 / (12 rho)) / L^2, beta of modes 1 and 2 in each plane
    for (number, beta) in [(1, 1.875_104_07_f64), (2, 1.875_104_07), (3, 4.694_091_13)] {
        let (scene, optimized) = optimized(&bar(&number.to_string()));
        let best = optimized.history.best().unwrap();
        let height = 100.0 / beta.powi(2) * (12.0 * 7800.0 / 210e9_f64).sqrt();
        assert!((best.design[0] / height - 1.0).abs() < 2e-3, "mode {number}: {} {height}", best.design[0]);
        let settings = scene.settings();
        let prepared = Prepared::with(&scene, &best.design, Prepared::method_of(&settings).unwrap(), settings).unwrap();
        let omega = prepared.modes(4).unwrap()[number - 1].frequency;
        assert!((omega / 100.0 - 1.0).abs() < 1e-6, "mode {number}: {omega}");
    }
}

#[test]
fn a_mode_that_is_not_there_is_told() {
    let text = slider("").replace("number = 1\ndamped", "number = 2\ndamped");
    let scene = parsed(&text);
    let optimization = Optimization::of(&scene).unwrap();
    let failure = optimization.run(&Sqp, &optimization.initial(), &mut ()).expect_err("one mode").to_string();
    assert!(failure.contains("\"omega\" is of mode 2; there are only 1"), "{failure}");
    for (wrong, message) in [
        (
            slider("").replace("name = \"growth\"", "name = \"omega\""),
            "the name \"omega\" is taken: there is a mode with this name",
        ),
        (slider("").replace("maximize = \"omega\"", "maximize = \"omegas\""), "omegas"),
    ] {
        let why = FileScene::parse("modes.toml", &wrong).expect_err("refused").to_string();
        assert!(why.contains(message), "{why}");
    }
}

/// A bar of m g l = 4.905 N m that stands on a hinge by a torsion spring, beside a point on a spring that vibrates at 30 rad/s.
fn standing(limit: &str, more: &str) -> String {
    format!(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = 0.1, steps = 5 }}
variable.k = {{ initial = 4, bounds = [1, 1000] }}
body = [{{ name = "bar", position = [0, 0, 0.5], mass = 1, inertia = [0.1, 0.1, 0.1] }}]
point = [{{ name = "point", position = [1, 0, 0], mass = 1 }}]
joint = [
    {{ name = "hinge", type = "revolute", between = ["ground", "bar"], point = [0, 0, 0], axis = [0, 1, 0] }},
    {{ name = "line", type = "point_on_line", between = ["ground", "point"], axis = [0, 0, 1] }},
]
spring = [
    {{ name = "turn", type = "torsion", between = ["ground", "bar"], axis = [0, 1, 0], stiffness = "k" }},
    {{ name = "slide", type = "slide", between = ["ground", "point"], axis = [0, 0, 1], stiffness = 900, point = [1, 0, 0], origin = [1, 0, 0], rest_displacement = 0.0109 }},
]
functional = [{{ name = "price", type = "formula", nodes = {{ p = "point" }}, value = "k + 0 * p.position.x", over = "initial" }}]
mode = [{{ name = "first", number = 1{more} }}]
[optimization]
minimize = "price"
constraint = [{{ functional = "first", {limit} }}]
"#
    )
}

#[test]
fn a_limit_on_the_first_frequency_is_not_met_by_the_second() {
    // omega^2 = (k - m g l) / (I + m l^2), less than zero at the beginning
    let (weight, inertia) = (4.905, 0.35);
    for damped in ["", ", damped = true"] {
        let (_, optimized) = optimized(&standing("at_least = 20", damped));
        let best = optimized.history.best().unwrap();
        assert!((best.design[0] - (weight + inertia * 400.0)).abs() < 1e-4, "{damped}: {}", best.design[0]);
        let (_, optimized) = self::optimized(&standing("at_most = 1", &format!(", measure = \"growth\"{damped}")));
        let best = optimized.history.best().unwrap();
        assert!((best.design[0] - (weight - inertia)).abs() < 1e-5, "growth{damped}: {}", best.design[0]);
    }
}
