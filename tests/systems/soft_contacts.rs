//! Contacts that give way, against closed forms.

use super::friction::{assert_near, values_of};
use super::parsed;
use costate::prelude::*;

/// A ball, and a floor, with what is different.
fn ball(settings: &str, beside: &str) -> String {
    format!(
        r#"
version = 1
settings = {{ {settings} }}
shape = [
  {{ name = "ball", on = "ball", type = "sphere", radius = 0.3 }},
  {{ name = "floor", on = "ground", type = "plane", point = [0, 0, 0], normal = [0, 0, 1] }},
]
{beside}
"#
    )
}

/// A hit on a linear floor takes half a period, pi / w with w = sqrt(k / m), and loses nothing.
#[test]
fn a_hit_on_a_linear_floor_takes_half_a_period() {
    let (values, rows) = values_of(&ball(
        "end = 1, tolerance = 1e-10",
        r#"
variable.k = { initial = 3000, bounds = [1, 1e5] }
variable.m = { initial = 2, bounds = [1, 10] }
variable.v = { initial = 3, bounds = [1, 10] }
point = [{ name = "ball", position = [0, 0, 1.5], velocity = [0, 0, "-v"], mass = "m" }]
contact = [{ name = "hit", between = ["ball", "floor"], stiffness = "k" }]
functional = [{ name = "z", type = "position", on = "ball", direction = [0, 0, 1], over = "terminal" }]
"#,
    ));
    let (k, m, v) = (3000.0, 2.0, 3.0);
    let half = std::f64::consts::PI * f64::sqrt(m / k);
    assert_near(values[0], 0.3 + v * (1.0 - half) - 1.2, 1e-9, "place");
    let exact = [0.5 * v * half / k, -0.5 * v * half / m, 1.0 - half];
    rows[0].iter().zip(exact).for_each(|(own, exact)| assert_near(*own, exact, 1e-8, "derivative"));
}

/// Hertz: balls touch for 2.943 D / v with the depth D = (5 m v^2 / 4 k)^(2/5), m that of both in turn; Johnson (1985), section 11.4.
#[test]
fn balls_touch_as_long_as_hertz_says() {
    let (values, rows) = values_of(
        r#"
version = 1
settings = { end = 1, tolerance = 1e-12 }
variable.E = { initial = 2e6, bounds = [1, 1e9] }
body = [
  { name = "a", position = [0, 0, 0], mass = 2, inertia = [1, 1, 1] },
  { name = "b", position = [0.7, 0, 0], velocity = [-3, 0, 0], mass = 3, inertia = [1, 1, 1] },
]
shape = [{ name = "a", on = "a", type = "sphere", radius = 0.3 }, { name = "b", on = "b", type = "sphere", radius = 0.2 }]
contact = [{ name = "hit", between = ["a", "b"], modulus = "E" }]
functional = [{ name = "x", type = "position", on = "b", direction = [1, 0, 0], over = "terminal" }]
"#,
    );
    let k = 4.0 / 3.0 * 2e6 * f64::sqrt(1.0 / (1.0 / 0.3 + 1.0 / 0.2));
    // 4/5 of sqrt(pi) Gamma(2/5) / Gamma(9/10)
    let time = 2.943_275_184_324_704 * f64::powf(1.25 * 1.2 * 9.0 / k, 0.4) / 3.0;
    // both exchange their velocities against the centre of mass, which moves at -1.8 m/s
    let (middle, apart) = (0.42 - 1.8 * (0.2 / 3.0 + time), 0.5 * 0.4);
    assert_near(values[0], middle + apart + (1.0 - 0.2 / 3.0 - time) * (-1.8 + 1.2), 1e-9, "place");
    assert_near(rows[0][0] * 2e6, 0.4 * time * (1.8 - 0.6), 1e-7, "by the modulus");
}

/// Hunt and Crossley: behind a hit of speed v, u with ln((1 + c v) / (1 - c u)) = c (v + u).
#[test]
fn damping_takes_what_hunt_and_crossley_say() {
    let (values, rows) = values_of(&ball(
        "end = 1, tolerance = 1e-10",
        r#"
variable.c = { initial = 0.2, bounds = [0, 1] }
point = [{ name = "ball", position = [0, 0, 1.5], velocity = [0, 0, -3], mass = 2 }]
contact = [{ name = "hit", between = ["ball", "floor"], modulus = 2e5, damping = "c" }]
functional = [{ name = "u", type = "formula", nodes = { b = "ball" }, value = "b.velocity.z", unit = "m/s", over = "terminal" }]
"#,
    ));
    let (c, v, u) = (0.2, 3.0, values[0]);
    assert_near(f64::ln((1.0 + c * v) / (1.0 - c * u)), c * (v + u), 1e-8, "speed behind the hit");
    // of both sides by c
    let by_c = v / (1.0 + c * v) + u / (1.0 - c * u) - v - u;
    let by_u = c / (1.0 - c * u) - c;
    assert_near(rows[0][0], -by_c / by_u, 1e-6, "by the damping");
}

/// A ball that slides with mu m g rolls from t = 2 v / (7 mu g) on, with 5/7 v.
#[test]
fn a_ball_slides_on_a_soft_floor_until_it_rolls() {
    let (values, rows) = values_of(&ball(
        "end = 0.8, tolerance = 1e-10",
        r#"
gravity = [0, 0, -9.81]
variable.mu = { initial = 0.25, bounds = [0, 1] }
variable.k = { initial = 5e4, bounds = [0, 1e6] }
body = [{ name = "ball", position = [0, 0, "0.3 - 2 * 9.81 / k"], velocity = [3, 0, 0], mass = 2, inertia = [0.072, 0.072, 0.072] }]
contact = [{ name = "hit", between = ["ball", "floor"], stiffness = "k", sliding = "mu", slip_speed = 1e-5 }]
functional = [
  { name = "x", type = "position", on = "ball", direction = [1, 0, 0], over = "terminal" },
  { name = "v", type = "formula", nodes = { b = "ball" }, value = "b.velocity.x", unit = "m/s", over = "terminal" },
]
"#,
    ));
    let (a, v) = (0.25 * 9.81, 3.0);
    let time = 2.0 * v / (7.0 * a);
    assert_near(values[0], v * time - 0.5 * a * time * time + 5.0 / 7.0 * v * (0.8 - time), 1e-7, "place");
    assert_near(values[1], 5.0 / 7.0 * v, 1e-7, "speed");
    // x = 5/7 v T + 2/49 v^2 / a
    assert_near(rows[0][0], -(v * v / (a * a)) * 2.0 / 49.0 * 9.81, 1e-6, "by the friction");
}

/// A ball that lies there is pressed in by (m g / k)^(2/3), and vibrates with the slope of the law there.
#[test]
fn a_ball_lies_and_vibrates_on_a_soft_floor() {
    let text = ball(
        "end = 0.1, steps = 4, start = \"equilibrium\"",
        r#"
gravity = [0, 0, -9.81]
variable.E = { initial = 2e5, bounds = [0, 1e6] }
body = [{ name = "ball", position = [0, 0, 0.299], mass = 2, inertia = [0.072, 0.072, 0.072] }]
joint = [{ name = "guide", type = "prismatic", between = ["ground", "ball"], point = [0, 0, 0], axis = [0, 0, 1] }]
contact = [{ name = "hit", between = ["ball", "floor"], modulus = "E" }]
functional = [{ name = "z", type = "position", on = "ball", direction = [0, 0, 1], over = "terminal" }]
"#,
    );
    let (values, rows) = values_of(&text);
    let k = 4.0 / 3.0 * 2e5 * f64::sqrt(0.3);
    let depth = f64::powf(2.0 * 9.81 / k, 2.0 / 3.0);
    assert_near(values[0], 0.3 - depth, 1e-12, "place");
    assert_near(rows[0][0] * 2e5, 2.0 / 3.0 * depth, 1e-12, "by the modulus");
    let scene = parsed(&text);
    let prepared = Prepared::new(&scene).expect("it is sound");
    let modes = prepared.modes(3).expect("it vibrates");
    assert_near(modes[0].frequency, f64::sqrt(1.5 * k * depth.sqrt() / 2.0), 1e-8, "vibration");
}

/// A box lies on its corners, and a capsule on its ends: each carries a quarter, or a half, of the weight.
#[test]
fn boxes_and_capsules_lie_on_their_corners_and_ends() {
    let text = |shape: &str| {
        ball(
            "end = 0.1, steps = 4, start = \"equilibrium\"",
            r#"
gravity = [0, 0, -9.81]
variable.k = { initial = 5e3, bounds = [0, 1e6] }
body = [{ name = "ball", position = [0, 0, 0.099], mass = 2, inertia = [0.05, 0.06, 0.07] }]
joint = [{ name = "guide", type = "prismatic", between = ["ground", "ball"], point = [0, 0, 0], axis = [0, 0, 1] }]
contact = [{ name = "hit", between = ["thing", "floor"], stiffness = "k" }]
functional = [{ name = "z", type = "position", on = "ball", direction = [0, 0, 1], over = "terminal" }]
"#,
        )
        .replacen("shape = [", &format!("shape = [\n  {{ name = \"thing\", on = \"ball\", {shape} }},"), 1)
    };
    let turned = r#"type = "box", size = [0.4, 0.2, 0.3], axis = [3, 4, 0], second_axis = [0, 0, 1]"#;
    let capsule = r#"type = "capsule", from = [-0.2, 0, 0.099], to = [0.3, 0, 0.099], radius = 0.1"#;
    for (shape, count) in [(turned, 4.0), (capsule, 2.0)] {
        let (values, rows) = values_of(&text(shape));
        let depth = 2.0 * 9.81 / (count * 5e3);
        assert_near(values[0], 0.1 - depth, 1e-12, "place");
        assert_near(rows[0][0], depth / 5e3, 1e-15, "by the stiffness");
    }
}

/// What falls without turning hits for half a period, whatever round or flat places touch: on a capsule, on a box, on end and side of a cylinder, capsules
/// across and along each other, and a wheel on its two rims.
#[test]
fn every_pair_of_shapes_bounces_as_its_springs_say() {
    let (on, above) = ("on = \"ground\"", "on = \"ball\"");
    let ball = "type = \"sphere\", radius = 0.3, centre = [0.4, 0.1, 1.5]";
    let lying = |radius: f64| format!("from = [-1, 0.1, -{radius}], to = [1, 0.1, -{radius}], radius = {radius}");
    let across = "type = \"capsule\", from = [0.3, -0.8, 1.5], to = [0.3, 1, 1.5], radius = 0.3";
    let along = "type = \"capsule\", from = [-0.9, 0.1, 1.5], to = [1.3, 0.1, 1.5], radius = 0.3";
    let turned = "type = \"box\", centre = [0, 0, -0.5], size = [1, 2, 3], axis = [0, 0, 1], second_axis = [3, 4, 0]";
    let standing = "type = \"cylinder\", from = [0, 0, -1], to = [0, 0, 0], radius = 0.8";
    let wheel = "type = \"cylinder\", from = [0.1, 0.2, 1.5], to = [0.4, 0.6, 1.5], radius = 0.3";
    let plane = "type = \"plane\", point = [0, 0, 0], normal = [0, 0, 3]";
    let (capsule, roll) = (format!("type = \"capsule\", {}", lying(0.2)), format!("type = \"cylinder\", {}", lying(0.4)));
    let pairs = [
        (&*capsule, ball, 1.0),
        (turned, ball, 1.0),
        (standing, ball, 1.0),
        (&roll, ball, 1.0),
        (&capsule, across, 1.0),
        (&capsule, along, 1.0),
        (plane, wheel, 2.0),
    ];
    for (below, thing, springs) in pairs {
        for between in [r#"["below", "thing"]"#, r#"["thing", "below"]"#] {
            let (values, rows) = values_of(&format!(
                r#"
version = 1
settings = {{ end = 1, tolerance = 1e-10 }}
variable.k = {{ initial = 3000, bounds = [1, 1e5] }}
variable.v = {{ initial = 3, bounds = [1, 10] }}
body = [{{ name = "ball", position = [0, 0, 1.5], velocity = [0, 0, "-v"], mass = 2, inertia = [0.3, 0.4, 0.5] }}]
joint = [{{ name = "guide", type = "prismatic", between = ["ground", "ball"], point = [0, 0, 0], axis = [0, 0, 1] }}]
shape = [{{ name = "below", {on}, {below} }}, {{ name = "thing", {above}, {thing} }}]
contact = [{{ name = "hit", between = {between}, stiffness = "k" }}]
functional = [{{ name = "z", type = "position", on = "ball", direction = [0, 0, 1], over = "terminal" }}]
"#
            ));
            let (k, v) = (3000.0 * springs, 3.0);
            let half = std::f64::consts::PI * f64::sqrt(2.0 / k);
            let place = format!("{below}, {thing}");
            assert_near(values[0], 0.3 + v * (1.0 - half) - 1.2, 1e-9, &place);
            assert_near(rows[0][0], 0.5 * v * half / 3000.0, 1e-8, &place);
            assert_near(rows[0][1], 1.0 - half, 1e-8, &place);
        }
    }
}

/// Three balls and a wall, paired by a loop whose range begins behind the number of the one around it: each pair once.
#[test]
fn loops_pair_what_they_number() {
    let scene = parsed(
        r#"
version = 1
settings = { end = 0.1, steps = 4 }
define.n = 3
body = [{ for = { i = { from = 1, to = "n" } }, name = "ball {i}", position = ["{i}", 0, 0], mass = 1, inertia = [1, 1, 1] }]
shape = [{ for = { i = { from = 1, to = "n" } }, name = "ball {i}", on = "ball {i}", type = "sphere", radius = 0.3 }]
contact = [{ for = { i = { from = 1, to = "n" }, j = { from = "i + 1", to = "n" } }, name = "{i} and {j}", between = ["ball {i}", "ball {j}"], stiffness = 1 }]
functional = [{ name = "z", type = "position", on = "ball 1", direction = [0, 0, 1], over = "terminal" }]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let names: Vec<&str> =
        prepared.model().elements.iter().map(|own| &*own.name).filter(|own| own.contains("and")).collect();
    assert_eq!(names, ["1 and 2", "1 and 3", "2 and 3"]);
}

/// The gripper's box creeps as m z'' = -m g + 2 mu G s / sqrt(s^2 + s_0^2) and the table's force say, with s = h' - z' of the hand's height h.
#[test]
fn the_box_of_the_gripper_creeps_as_its_equation_says() {
    let text = include_str!("../../examples/scenes/gripper.toml").replacen("tolerance = 1e-6", "tolerance = 1e-9", 1);
    let (values, _) = values_of(&text);
    let (m, mu, grip, still, k) = (0.4, 0.6, 12.0, 1e-3, 8e4);
    let ramp = |t: f64, start: f64, duration: f64| {
        let s = ((t - start) / duration).clamp(0.0, 1.0);
        (s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * (s * (1.0 - s)).powi(2) / duration)
    };
    let rate = |t: f64, [z, v]: [f64; 2]| {
        let slip = 0.2 * ramp(t, 0.3, 0.4).1 - v;
        let table = k * f64::max(0.0, m * 9.81 / k - z) * f64::max(0.0, 1.0 - v);
        [v, -9.81 + (table + 2.0 * mu * grip * ramp(t, 0.0, 0.2).0 * slip / slip.hypot(still)) / m]
    };
    let (steps, mut y) = (400_000, [0.0, 0.0]);
    let h = 0.8 / f64::from(steps);
    for step in 0..steps {
        let t = h * f64::from(step);
        let ahead = |share: f64, by: [f64; 2]| [y[0] + share * h * by[0], y[1] + share * h * by[1]];
        let a = rate(t, y);
        let b = rate(t + 0.5 * h, ahead(0.5, a));
        let c = rate(t + 0.5 * h, ahead(0.5, b));
        let d = rate(t + h, ahead(1.0, c));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    assert_near(values[0], 0.2 - y[0], 1e-9, "creep");
}
