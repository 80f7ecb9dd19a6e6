//! Friction: closed forms, a friction of one's own, quotients of whole runs, and what Coulomb's law has no solution for.

use super::parsed;
use costate::elements::{Friction, Parameter};
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use costate::sensitivity::Analysis;

pub fn assert_near(own: f64, exact: f64, limit: f64, what: &str) {
    assert!((own - exact).abs() <= limit, "{what}: {own} for {exact}, {limit:e}");
}

/// A mass with its weight, in a plane.
#[derive(Hash)]
struct Weight;

impl Element for Weight {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg"), Parameter::new("gravity", "m/s2")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(2)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        (r[0], r[1]) = (p[0] * s.a[0], p[0] * (s.a[1] + p[1]));
    }
}

/// A circle about the origin.
#[derive(Hash)]
struct Circle;

impl Constraint for Circle {
    const EQUATIONS: usize = 1;
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("radius", "m")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(2)]
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g[0] = (q[0] * q[0] + q[1] * q[1] - p[0] * p[0]) / (p[0] * 2.0);
    }
}

/// What slides along it is pressed by its force.
#[derive(Hash)]
struct AlongCircle;

impl Friction for AlongCircle {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("coefficient", "-"), Parameter::positive("radius", "m")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(2)]
    }
    fn slip<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, s: &mut [S]) {
        s[0] = (q[0] * v[1] - q[1] * v[0]) / p[1];
    }
    fn load<S: Scalar>(&self, mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
        mu[0].abs()
    }
    fn limits<S: Scalar>(&self, load: S, _state: State<S>, p: &[S], _t: S) -> [S; 2] {
        [p[0] * load; 2]
    }
}

/// A bead that slides from rest down a quarter of a pipe and up on the other side, where it stops and slides back.
struct Bead;

impl Scene for Bead {
    fn name(&self) -> String {
        "bead".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let variables = [("R", 1.2, "m"), ("mu", 0.2, "-"), ("g", 9.81, "m/s2"), ("m", 0.5, "kg")];
        variables.map(|(name, value, unit)| DesignVariable::new(name, value, (0.0, 10.0), unit)).to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.4, 1600)
    }
    fn build<S: Scalar>(&self, x: &[S], mechanism: &mut MechanismBuilder<S>) -> Result<(), String> {
        let bead = mechanism.coordinates("bead", &[-x[0], S::zero()], &[S::zero(); 2]);
        mechanism.element("weight", &[bead], Weight, &[x[3], x[2]]);
        let pipe = mechanism.constraint("pipe", &[bead], Circle, &x[..1]);
        let [stick, _] = mechanism.friction(pipe, AlongCircle, &[x[1], x[0]]).ok_or("it has friction")?;
        mechanism.event_time_functional("time of stop", stick, 1);
        mechanism.coordinate_functional("height", Over::Terminal, bead, 1);
        Ok(())
    }
}

/// v^2 = 2 g R / (1 + 4 mu^2) ((1 - 2 mu^2) sin th + 3 mu (cos th - exp(-2 mu th))): its time of stop and the derivatives of that, with 18 digits.
#[test]
fn a_friction_of_ones_own_follows_the_reaction_of_its_joint() {
    let prepared = Prepared::new(&Bead).expect("it is sound");
    let run = prepared.run().expect("it slides");
    let row = &run.gradient().expect("it has one").rows[0];
    assert_near(run.value("time of stop").expect("it stops"), 1.206_275_350_631_748, 1e-10, "time of stop");
    let exact = [0.502_614_729_429_895, -0.282_504_099_068_168_9, -0.061_481_924_089_283_79, 0.0];
    row.iter().zip(exact).for_each(|(own, exact)| assert_near(*own, exact, 1e-9, "derivative"));
    let analysis = prepared.analysis();
    let names: Vec<String> = analysis.events(&run.forward).into_iter().map(|own| own.name).collect();
    assert_eq!(names, ["stick of pipe", "slip of pipe"], "it turns back at once");
    let complex = analysis.complex_step(&prepared.x, &run.forward).expect("it has one");
    for (own, complex) in run.gradient().expect("it has one").rows.iter().zip(&complex.rows) {
        own.iter().zip(complex).for_each(|(own, complex)| assert_near(*own, *complex, 1e-11, "complex step"));
    }
}

const BALL: &str = r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 1.5, steps = 300 }
variable.spin = { initial = 30, bounds = [-100, 100] }
variable.sideways = { initial = 1, bounds = [-10, 10] }
variable.mu = { initial = 0.2, bounds = [0.01, 3] }
variable.e = { initial = 0.6, bounds = [0, 0.9] }
body = [{ name = "ball", position = [0, 0, 0.61], velocity = [3, "sideways", 0], angular_velocity = ["spin", 10, 20], mass = 6, inertia = [0.029, 0.029, 0.029] }]
shape = [{ name = "ball", on = "ball", type = "sphere", radius = 0.11 }, { name = "lane", on = "ground", type = "plane", normal = [0, 0, 1] }]
contact = [{ name = "lane", between = ["ball", "lane"], sliding = "mu", restitution = "e", rest_speed = 0.5 }]
functional = [
  { name = "x", type = "formula", nodes = { b = "ball" }, value = "b.position.x", unit = "m", over = "terminal" },
  { name = "y", type = "formula", nodes = { b = "ball" }, value = "b.position.y", unit = "m", over = "terminal" },
]
"#;

/// Adjoint, tangent and complex step against each other, and against quotients of whole runs.
fn has_the_derivatives_of_quotients(text: &str) {
    let scene: FileScene = parsed(text);
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    let rows = [Analysis::adjoint, Analysis::tangent, Analysis::complex_step]
        .map(|by| by(&analysis, x, &forward).expect("it has derivatives").rows);
    let on_steps = analysis.on_steps_of(&forward);
    for (k, row) in rows[0].iter().enumerate() {
        for i in 0..x.len() {
            let mut along = vec![0.0; x.len()];
            along[i] = 1.0;
            let quotient = on_steps.central_difference(x, &along, 1e-5 * x[i]).expect("it runs beside")[k];
            let size = row.iter().fold(0.0, |size: f64, own| size.max(own.abs()));
            assert_near(row[i], rows[1][k][i], 1e-10 * size, "tangent");
            assert_near(row[i], rows[2][k][i], 1e-10 * size, "complex step");
            assert_near(row[i], quotient, 1e-8 * size, "quotient");
        }
    }
}

#[test]
fn a_ball_that_bounces_slides_and_rolls_has_the_derivatives_of_quotients() {
    has_the_derivatives_of_quotients(BALL);
}

/// A rod whose tip slides on a floor: p = 1 + 3 cos^2 - 3 mu sin cos < 0 has no solution or two (Painleve).
#[test]
fn what_coulombs_law_does_not_determine_is_told() {
    let text = |mu: f64, theta: f64, rate: f64| {
        let (x, z) = (0.5 * theta.cos(), 0.5 * theta.sin());
        format!(
            r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = 0.01, steps = 2 }}
body = [{{ name = "rod", position = [{x}, 0, {z}], velocity = [-5, 0, {}], angular_velocity = [0, {}, 0], mass = 1, inertia = [1, "1 / 12", 1] }}]
shape = [{{ name = "tip", on = "rod", type = "point", centre = [0, 0, 0] }}, {{ name = "floor", on = "ground", type = "plane", point = [0, 0, 0], normal = [0, 0, 1] }}]
contact = [{{ name = "tip", between = ["tip", "floor"], sliding = {mu} }}]
functional = [{{ name = "N", type = "reaction_norm", joint = "tip", over = "initial" }}]
"#,
            rate * x,
            -rate
        )
    };
    let run = |mu: f64, theta: f64, rate: f64| {
        let scene: FileScene = parsed(&text(mu, theta, rate));
        let x: Vec<f64> = AnyScene::variables(&scene).iter().map(|own| own.initial).collect();
        let prepared = Prepared::new(&scene).expect("it is sound");
        prepared.analysis().forward(&x).map(|forward| forward.values[0]).map_err(|why| why.to_string())
    };
    assert_near(run(0.3, 0.8, 2.0).expect("it slides"), 4.174_301_598_961_059, 1e-13, "force");
    let why = run(1.6, 1.1, 2.0).expect_err("there is no solution");
    assert!(why.contains("\"tip\"") && why.contains("has no solution by Coulomb's law"), "{why}");
    let why = run(1.6, 1.1, 9.0).expect_err("there are two");
    assert!(why.contains("more than one solution by Coulomb's law"), "{why}");
}

/// A block with velocity v, pressed by a preload, and what is said beside it and in the settings: x at the end.
fn sliding(settings: &str, beside: &str) -> Result<f64, String> {
    let text = format!(
        r#"
version = 1
settings = {{ end = 2, steps = 200{settings} }}
variable.v = {{ initial = 3, bounds = [0, 10] }}
point = [{{ name = "b", mass = 2, velocity = ["v", 0, 0], position = [0, 0, 0] }}]
joint = [{{ name = "rail", type = "point_on_line", between = ["ground", "b"], axis = [1, 0, 0] }}]
friction = [{{ name = "f", joint = "rail", sliding = 0.2, preload = 5 }}]
functional = [{{ name = "x", type = "position", on = "b", direction = [1, 0, 0], over = "terminal" }}]
{beside}
"#
    );
    let scene = FileScene::parse("scene.toml", &text)?;
    let prepared = Prepared::new(&scene).map_err(|why| why.to_string())?;
    let forward = prepared.analysis().forward(&prepared.x).map_err(|why| why.to_string())?;
    Ok(forward.values[0])
}

/// Deceleration mu F / m = 0.5 m/s2, whichever way it goes.
#[test]
fn slip_that_is_turned_round_goes_on_the_other_way() {
    let kick = r#"event = [{ name = "kick", at = 0.5, nodes = { b = "b" }, set = { "b.velocity" = "-b.velocity" } }]"#;
    let x = 3.0 * 0.5 - 0.25 * 0.25;
    let left = x - (2.75 * 1.5 - 0.25 * 1.5 * 1.5);
    assert_near(sliding("", kick).expect("it runs"), left, 1e-12, "turned by an event");
    let wall = r#"stop = [{ name = "wall", nodes = { b = "b" }, value = "b.position.x", most = 1, restitution = 0.8 }]"#;
    let hit = 6.0 - 32f64.sqrt();
    let (speed, rest) = (0.8 * (3.0 - 0.5 * hit), 2.0 - hit);
    let back = 1.0 - (speed * rest - 0.25 * rest * rest);
    assert_near(sliding("", wall).expect("it runs"), back, 1e-12, "turned by a hit");
}

/// What would be a number without a word, each told by what it is.
#[test]
fn what_friction_cannot_do_is_told() {
    let refused = |settings: &str, beside: &str, words: &str| {
        let why = sliding(settings, beside).expect_err(words);
        assert!(why.contains(words), "{why}");
    };
    refused(", constraint_level = \"position\"", "", "takes constraints at acceleration level");
    let again = r#"driver = [{ name = "again", type = "translation", between = ["ground", "b"], axis = [0, 1, 0], displacement = { type = "constant", value = 0 } }]"#;
    refused(", drop_redundant = true", again, "is not determined where joints are redundant");
    let disc = |capacity: &str| {
        format!(
            r#"
coordinate = [{{ name = "disc", rate = 1 }}]
element = [{{ name = "disc", nodes = {{ x = "disc" }}, kinetic = "x.rate^2" }}]
clutch = [{{ name = "brake", between = ["disc"], nodes = {{ x = "disc" }}, capacity = "{capacity}" }}]
"#
        )
    };
    assert!(sliding("", &disc("1 + t")).is_ok());
    refused("", &disc("t - 1"), "is below zero at t = 0 s");
    refused("", &disc("if_less(x.value, 1, 1, 2)"), "its limits compare what moves");
}

/// The same brake by the time and by a number that stands still: its capacity is that of the time, whatever the coordinate is.
#[test]
fn the_capacity_of_a_brake_follows_the_time() {
    let scene = parsed(
        r#"
version = 1
settings = { end = 1, steps = 50 }
variable.c = { initial = 2, bounds = [1, 10] }
coordinate = [{ name = "disc", initial = 7, rate = 30 }]
element = [{ name = "disc", nodes = { x = "disc" }, kinetic = "0.5 * x.rate^2" }]
clutch = [{ name = "brake", between = ["disc"], nodes = { x = "disc" }, capacity = "c + t" }]
functional = [{ name = "rate", type = "formula", nodes = { x = "disc" }, value = "x.rate", unit = "rad/s", over = "terminal" }]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let run = prepared.run().expect("it slows down");
    assert_near(run.value("rate").expect("there"), 30.0 - 2.0 - 0.5, 1e-12, "rate");
    assert_near(run.gradient().expect("there").rows[0][0], -1.0, 1e-12, "by the capacity");
}

/// A stone on a floor that a push, which turns, breaks away from standstill, and what is said of the push.
fn pushed(force: &str) -> String {
    format!(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = 1, steps = 100 }}
variable.push = {{ initial = 9, bounds = [0, 50] }}
variable.sliding = {{ initial = 0.3, bounds = [0, 1] }}
point = [{{ name = "stone", position = [0, 0, 0], mass = 2 }}]
element = [{{ name = "push", nodes = {{ b = "stone" }}, force = {{ b = "{force}" }} }}]
shape = [{{ name = "stone", on = "stone", type = "point" }}, {{ name = "floor", on = "ground", type = "plane", normal = [0, 0, 1] }}]
contact = [{{ name = "floor", between = ["stone", "floor"], sliding = "sliding", static = "1.1 * sliding" }}]
functional = [
  {{ name = "x", type = "position", on = "stone", direction = [1, 0, 0], over = "terminal" }},
  {{ name = "y", type = "position", on = "stone", direction = [0, 1, 0], over = "terminal" }},
]
"#
    )
}

#[test]
fn a_stone_that_is_pushed_away_from_standstill_has_the_derivatives_of_quotients() {
    has_the_derivatives_of_quotients(&pushed("[3 * t * push, push * t^2, 0]"));
}

#[test]
fn the_direction_of_a_push_that_jumps_is_told_to_have_no_derivative() {
    let scene = parsed(&pushed("if_less(t, 0.2, 0, 1) * [3 * push, push, 0]"));
    let prepared = Prepared::new(&scene).expect("it is sound");
    let run = prepared.run().expect("it is pushed away");
    assert!(run.value("x").expect("there") > 0.1);
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let over_time = analysis.tangent_over_time(x, &run.forward).map(|_| ()).err();
    for why in [run.gradient().err(), analysis.complex_step(x, &run.forward).err(), over_time] {
        let why = why.expect("it is refused").to_string();
        assert!(why.contains("begin to slip from standstill"), "{why}");
    }
}

/// Values of a scene with their derivatives by its variables, and that adjoint and complex step agree.
pub fn values_of(text: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).expect("it is sound");
    let run = prepared.run().expect("it moves");
    let rows = run.gradient().expect("it has one").rows.clone();
    let complex = prepared.analysis().complex_step(&prepared.x, &run.forward).expect("it has one").rows;
    for (own, complex) in rows.iter().flatten().zip(complex.iter().flatten()) {
        assert_near(*own, *complex, 1e-11 * own.abs().max(1.0), "complex step");
    }
    (run.forward.values.clone(), rows)
}

/// A force that jumps beyond what friction holds at t1: x = a (T - t1)^2 / 2, a = F / m - mu g.
#[test]
fn a_force_that_jumps_breaks_loose_at_its_time() {
    let (values, rows) = values_of(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 3, steps = 60 }
variable.late = { initial = 1.05, bounds = [0.5, 2] }
variable.m = { initial = 2, bounds = [0.5, 20] }
point = [{ name = "block", position = [0, 0, 0], mass = "m" }]
joint = [{ name = "surface", type = "point_on_line", between = ["ground", "block"], axis = [1, 0, 0] }]
friction = [{ name = "grip", joint = "surface", sliding = 0.3, static = 0.5 }]
force = [{ name = "push", on = "block", direction = [1, 0, 0], size = { type = "formula", value = "if_less(t, late, 2, 15)" } }]
functional = [
  { name = "loose", type = "event_time", event = "grip", which = "slip", over = "terminal" },
  { name = "x", type = "position", on = "block", direction = [1, 0, 0], over = "terminal" },
]
"#,
    );
    let (a, t) = (15.0 / 2.0 - 0.3 * 9.81, 3.0 - 1.05);
    assert_near(values[0], 1.05, 1e-14, "time");
    assert_near(values[1], 0.5 * a * t * t, 1e-12, "place");
    assert_eq!(rows[0], [1.0, 0.0]);
    assert_near(rows[1][0], -a * t, 1e-12, "by the time");
    assert_near(rows[1][1], -15.0 / 4.0 * 0.5 * t * t, 1e-12, "by the mass");
}

/// Two brakes hold one disc together: a moment c t turns it from t0 = (C1 + C2) / c on, with the rate c (t - t0)^2 / 2.
#[test]
fn two_brakes_on_one_disc_hold_together() {
    let (values, rows) = values_of(
        r#"
version = 1
settings = { end = 4, steps = 80 }
variable.first = { initial = 3, bounds = [1, 10] }
variable.second = { initial = 2, bounds = [1, 10] }
coordinate = [{ name = "disc" }]
element = [{ name = "disc", nodes = { x = "disc" }, kinetic = "0.5 * x.rate^2", force = { x = "2.3 * t" } }]
clutch = [
  { name = "a", between = ["disc"], capacity = "first" },
  { name = "b", between = ["disc"], capacity = "second" },
]
functional = [{ name = "rate", type = "formula", nodes = { x = "disc" }, value = "x.rate", unit = "rad/s", over = "terminal" }]
"#,
    );
    let t = 4.0 - 5.0 / 2.3;
    assert_near(values[0], 0.5 * 2.3 * t * t, 1e-12, "rate");
    rows[0].iter().for_each(|own| assert_near(*own, -t, 1e-12, "by a capacity"));
}

/// The first of two brakes to yield holds on at its limit, one way; where the moment C (0.9 - t), C = C1 + C2, has turned round it yields to, and both
/// hold until t = 1.9.
#[test]
fn brakes_that_yielded_hold_the_other_way() {
    let (values, rows) = values_of(
        r#"
version = 1
settings = { end = 2.2, steps = 88 }
variable.first = { initial = 3, bounds = [1, 10] }
variable.second = { initial = 2, bounds = [1, 10] }
variable.inertia = { initial = 1.5, bounds = [1, 10] }
coordinate = [{ name = "disc" }]
element = [{ name = "disc", nodes = { x = "disc" }, kinetic = "0.5 * inertia * x.rate^2", force = { x = "5 * (0.9 - t)" } }]
clutch = [
  { name = "a", between = ["disc"], capacity = "first" },
  { name = "b", between = ["disc"], capacity = "second" },
]
functional = [{ name = "rate", type = "formula", nodes = { x = "disc" }, value = "x.rate", unit = "rad/s", over = "terminal" }]
"#,
    );
    assert_near(values[0], -0.5 * 5.0 * 0.09 / 1.5, 1e-12, "rate");
    let exact = [0.3 / 1.5, 0.3 / 1.5, 0.5 * 5.0 * 0.09 / 2.25];
    rows[0].iter().zip(exact).for_each(|(own, exact)| assert_near(*own, exact, 1e-12, "derivative"));
}

/// A stone hits a cart with restitution, m u (1 + e) across its rail: the rail takes mu times that of the cart's momentum, at most all.
#[test]
fn a_rail_brakes_or_stops_a_cart_by_a_hit() {
    for (mu, stops) in [(0.2, false), (2.0, true)] {
        let (values, rows) = values_of(&format!(
            r#"
version = 1
settings = {{ end = 1, steps = 20 }}
variable.e = {{ initial = 0.4, bounds = [0, 1] }}
variable.mu = {{ initial = {mu}, bounds = [0, 3] }}
body = [{{ name = "cart", position = [0, 0, 0], velocity = [2, 0, 0], mass = 3, inertia = [1, 1, 1] }}]
point = [{{ name = "stone", position = [0, 0, 1], velocity = [2, 0, -5], mass = 0.7 }}]
joint = [{{ name = "rail", type = "prismatic", between = ["ground", "cart"], point = [0, 0, 0], axis = [1, 0, 0] }}]
friction = [{{ name = "rub", joint = "rail", sliding = "mu" }}]
shape = [{{ name = "top", on = "cart", type = "plane", point = [0, 0, 0], normal = [0, 0, 1] }}, {{ name = "tip", on = "stone", type = "point" }}]
contact = [{{ name = "hit", between = ["tip", "top"], restitution = "e" }}]
functional = [{{ name = "speed", type = "formula", nodes = {{ c = "cart" }}, value = "c.velocity.x", unit = "m/s", over = "terminal" }}]
"#
        ));
        let of_impulse = 0.7 * 5.0 / 3.0;
        let [speed, by_e, by_mu] =
            if stops { [0.0; 3] } else { [2.0 - mu * 1.4 * of_impulse, -mu * of_impulse, -1.4 * of_impulse] };
        assert_near(values[0], speed, 1e-12, "speed");
        assert_near(rows[0][0], by_e, 1e-12, "by the restitution");
        assert_near(rows[0][1], by_mu, 1e-12, "by the friction");
    }
}

/// A disc with an own law of friction comes to rest by a brake: the law, of a velocity that is zero but for round-off then, does not change any more.
#[test]
fn a_law_of_what_a_brake_holds_does_not_change() {
    let (values, rows) = values_of(
        r#"
version = 1
settings = { end = 4, steps = 1600 }
variable.brake = { initial = 3, bounds = [1, 10] }
variable.c = { initial = 0.8, bounds = [0, 10] }
body = [{ name = "disc", position = [0, 0, 0], angular_velocity = [0, 0, 8], mass = 2, inertia = [1, 1, 1.7] }]
joint = [{ name = "hinge", type = "revolute", between = ["ground", "disc"], point = [0, 0, 0], axis = [0, 0, 1] }]
joint_angle = [{ name = "angle", between = ["ground", "disc"], axis = [0, 0, 1] }]
spring = [{ name = "law", type = "angle_law", on = "angle", moment = "c * if_less(v, 0, -1, 1)" }]
friction = [{ name = "brake", joint = "hinge", sliding = 0.1, radius = 1, preload = "10 * brake" }]
point = [{ name = "other", position = [1, 0, 0], velocity = [1, 2, 3], mass = 1 }]
functional = [
  { name = "time", type = "event_time", event = "brake", which = "stick", over = "terminal" },
  { name = "rate", type = "formula", nodes = { x = "angle" }, value = "x.rate", unit = "rad/s", over = "terminal" },
]
"#,
    );
    assert_near(values[0], 8.0 * 1.7 / 3.8, 1e-9, "time");
    rows[0].iter().for_each(|own| assert_near(*own, -8.0 * 1.7 / (3.8 * 3.8), 1e-8, "of time"));
    assert_near(values[1], 0.0, 1e-10, "rate");
}

/// What a driver moves to and fro slips with it and sticks nowhere: over n periods it takes the work 4 n A mu m g of the driver.
#[test]
fn friction_of_what_a_driver_moves_takes_its_work() {
    let (values, rows) = values_of(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 2, steps = 400 }
variable.amplitude = { initial = 0.3, bounds = [0.1, 1] }
variable.mu = { initial = 0.2, bounds = [0.1, 1] }
point = [{ name = "block", position = [0, 0, 0], mass = 2, velocity = ["pi * amplitude", 0, 0] }]
joint = [{ name = "surface", type = "point_on_line", between = ["ground", "block"], axis = [1, 0, 0] }]
friction = [{ name = "grip", joint = "surface", sliding = "mu" }]
driver = [{ name = "drive", type = "translation", between = ["ground", "block"], axis = [1, 0, 0], displacement = { type = "sine", amplitude = "amplitude", angular_frequency = "pi" } }]
functional = [{ name = "work", type = "joint_power", joint = "drive", over = "integral" }]
"#,
    );
    let work = 4.0 * 0.3 * 0.2 * 2.0 * 9.81;
    assert_near(values[0].abs(), work, 1e-7, "work");
    assert_near(rows[0][1].abs(), work / 0.2, 1e-6, "by the coefficient");
    assert_near(rows[0][0].abs(), work / 0.3, 1e-6, "by the amplitude");
}

/// A point on a floor that a wall guides along a line: friction holds the force along it, mu m g at t = mu m g / k, wherever the line points.
#[test]
fn a_contact_that_is_guided_along_a_line_sticks_by_the_force_along_it() {
    for angle in [0.0, 0.3, 0.9, 1.4] {
        let (values, rows) = values_of(&format!(
            r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = 2, steps = 40 }}
variable.mu = {{ initial = 0.4, bounds = [0.1, 1] }}
point = [{{ name = "stone", position = [0.4, 0.2, 0], mass = 2 }}]
joint = [{{ name = "wall", type = "point_in_plane", between = ["ground", "stone"], point = [0.4, 0.2, 0], normal = ["-sin({angle})", "cos({angle})", 0] }}]
element = [{{ name = "push", nodes = {{ b = "stone" }}, force = {{ b = "7 * t * [cos({angle}), sin({angle}), 0] + 3 * t * [-sin({angle}), cos({angle}), 0]" }} }}]
shape = [{{ name = "stone", on = "stone", type = "point" }}, {{ name = "floor", on = "ground", type = "plane", normal = [0, 0, 1] }}]
contact = [{{ name = "floor", between = ["stone", "floor"], sliding = "mu" }}]
functional = [{{ name = "loose", type = "event_time", event = "floor", which = "slip", over = "terminal" }}]
"#
        ));
        assert_near(values[0], 0.4 * 2.0 * 9.81 / 7.0, 1e-11, "time");
        assert_near(rows[0][0], 2.0 * 9.81 / 7.0, 1e-10, "by the coefficient");
    }
}

/// A stone between a floor and a wall that leans over it lets go where 7 t cos a = mu (m g - 7 t sin a tan b): the wall takes what pushes across it, and
/// bears on the floor with it. The line along which it sticks is another one in each design.
#[test]
fn the_line_along_which_a_contact_sticks_has_derivatives() {
    let (values, rows) = values_of(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 2, steps = 40 }
variable.mu = { initial = 0.4, bounds = [0.1, 1] }
variable.a = { initial = 0.7, bounds = [0, 1] }
variable.b = { initial = 0.3, bounds = [0, 1] }
point = [{ name = "stone", position = [0, 0, 0], mass = 2 }]
joint = [{ name = "wall", type = "point_in_plane", between = ["ground", "stone"], point = [0, 0, 0], normal = ["-sin(a) * cos(b)", "cos(a) * cos(b)", "sin(b)"] }]
element = [{ name = "push", nodes = { b = "stone" }, force = { b = "[7 * t, 0, 0]" } }]
shape = [{ name = "stone", on = "stone", type = "point" }, { name = "floor", on = "ground", type = "plane", normal = [0, 0, 1] }]
contact = [{ name = "floor", between = ["stone", "floor"], sliding = "mu" }]
functional = [{ name = "loose", type = "event_time", event = "floor", which = "slip", over = "terminal" }]
"#,
    );
    let (mu, a, b, weight) = (0.4, 0.7_f64, 0.3_f64, 2.0 * 9.81 / 7.0);
    let below = a.cos() + mu * a.sin() * b.tan();
    assert_near(values[0], mu * weight / below, 1e-11, "time");
    let by =
        [weight * a.cos(), mu * weight * (a.sin() - mu * a.cos() * b.tan()), -mu * mu * weight * a.sin() / b.cos().powi(2)];
    for (own, by) in rows[0].iter().zip(by) {
        assert_near(*own, by / (below * below), 1e-10, "derivative");
    }
}

/// A weight on a universal joint hits an oblique plane, on which its joint lets it slip along a line that turns as it moves.
#[test]
fn hits_along_a_line_that_joints_leave_have_the_derivatives_of_quotients() {
    has_the_derivatives_of_quotients(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 1.2, steps = 120 }
variable.rate = { initial = 1.5, bounds = [-9, 9] }
variable.length = { initial = 1, bounds = [0.5, 2] }
variable.mu = { initial = 0.5, bounds = [0, 3] }
variable.e = { initial = 0.4, bounds = [0, 0.9] }
body = [{ name = "arm", position = [0, 0, "-length"], velocity = [0, "length * rate", 0], angular_velocity = ["rate", 0, 0], mass = 2, inertia = [0.3, 0.4, 0.2] }]
joint = [{ name = "top", type = "universal", between = ["ground", "arm"], point = [0, 0, 0], pin_a = [1, 0, 0], pin_b = [0, 1, 0] }]
shape = [{ name = "end", on = "arm", type = "sphere", radius = 0.1 }, { name = "wall", on = "ground", type = "plane", point = [0, 0.35, 0], normal = [0.4, -0.9, 0.2] }]
contact = [{ name = "wall", between = ["end", "wall"], sliding = "mu", restitution = "e", rest_speed = 0.05 }]
functional = [
  { name = "x", type = "position", on = "arm", direction = [1, 0, 0], over = "terminal" },
  { name = "energy", type = "energy", over = "integral" },
]
"#,
    );
}

/// A ball hits another one at rest, of the same kind, off its centre. With the normal impulse J = (1 + e) m v_n / 2 and the slip s between the surfaces, friction
/// changes tangential velocities by min(mu J / m, s / 7), where I = 2/5 m r^2.
#[test]
fn two_balls_throw_each_other_by_friction() {
    for mu in [0.03, 0.5] {
        let (values, rows) = values_of(&format!(
            r#"
version = 1
settings = {{ end = 0.8, steps = 200 }}
variable.mu = {{ initial = {mu}, bounds = [0, 1] }}
variable.e = {{ initial = 0.9, bounds = [0, 1] }}
variable.spin = {{ initial = 5, bounds = [-50, 50] }}
body = [
  {{ name = "cue", position = [-1, 0, 0], velocity = [2, 0, 0], angular_velocity = [0, 0, "spin"], mass = 0.2, inertia = [0.0002, 0.0002, 0.0002] }},
  {{ name = "object", position = [0, 0.06, 0], mass = 0.2, inertia = [0.0002, 0.0002, 0.0002] }},
]
shape = [
  {{ name = "cue", on = "cue", type = "sphere", radius = 0.05 }},
  {{ name = "object", on = "object", type = "sphere", radius = 0.05 }},
]
contact = [{{ name = "hit", between = ["cue", "object"], sliding = "mu", restitution = "e" }}]
functional = [
  {{ name = "x", type = "formula", nodes = {{ b = "object" }}, value = "b.velocity.x", unit = "m/s", over = "terminal" }},
  {{ name = "y", type = "formula", nodes = {{ b = "object" }}, value = "b.velocity.y", unit = "m/s", over = "terminal" }},
]
"#
        ));
        // the line between the centres is that of sides 0.08 and 0.06
        let (e, [n, t], speed, spin) = (0.9, [[0.8, 0.6], [-0.6, 0.8]], 2.0, 5.0);
        let (normal, slip) = (speed * n[0], speed * t[0] + spin * 0.05);
        let [along, across] =
            [(1.0 + e) * normal / 2.0, (slip / 7.0).abs().min(mu * (1.0 + e) * normal / 2.0) * slip.signum()];
        let sticks = across.abs() < mu * along;
        let by_mu = if sticks { 0.0 } else { along * slip.signum() };
        let by_e = if sticks { 0.0 } else { mu * normal / 2.0 * slip.signum() };
        let by_spin = if sticks { 0.05 / 7.0 } else { 0.0 };
        for k in 0..2 {
            assert_near(values[k], along * n[k] + across * t[k], 1e-12, "velocity");
            assert_near(rows[k][0], by_mu * t[k], 1e-11, "by the coefficient");
            assert_near(rows[k][1], normal / 2.0 * n[k] + by_e * t[k], 1e-11, "by the restitution");
            assert_near(rows[k][2], by_spin * t[k], 1e-11, "by the spin");
        }
    }
}

/// A ball that slides without friction from a larger one leaves it where cos th = 2/3 cos th_0, and flies on with sqrt(g R) (2/3 cos th_0)^1.5, R = r_1 + r_2.
#[test]
fn a_ball_leaves_the_ball_on_which_it_slides() {
    let (values, rows) = values_of(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 1.5, steps = 300 }
variable.r = { initial = 0.8, bounds = [0.1, 2] }
variable.start = { initial = 0.3, bounds = [0, 1] }
point = [{ name = "ball", position = ["(r + 0.2) * sin(start)", 0, "(r + 0.2) * cos(start)"], mass = 2 }]
shape = [
  { name = "ball", on = "ball", type = "sphere", radius = 0.2 },
  { name = "hill", on = "ground", type = "sphere", centre = [0, 0, 0], radius = "r" },
]
contact = [{ name = "hill", between = ["hill", "ball"] }]
functional = [{ name = "x", type = "formula", nodes = { b = "ball" }, value = "b.velocity.x", unit = "m/s", over = "terminal" }]
"#,
    );
    let (radius, start) = (1.0_f64, 0.3_f64);
    let own = (9.81 * radius).sqrt() * (2.0 / 3.0 * start.cos()).powf(1.5);
    assert_near(values[0], own, 1e-8, "velocity");
    assert_near(rows[0][0], 0.5 * own / radius, 1e-7, "by the radius");
    assert_near(rows[0][1], -1.5 * own * start.tan(), 1e-7, "by the start");
}

/// A ball is thrown onto a larger one, bounces, slides, rolls, and falls from it.
#[test]
fn a_ball_that_rolls_on_a_ball_has_the_derivatives_of_quotients() {
    has_the_derivatives_of_quotients(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 1.2, steps = 240 }
variable.speed = { initial = 0.3, bounds = [-3, 3] }
variable.spin = { initial = 8, bounds = [-50, 50] }
variable.mu = { initial = 0.6, bounds = [0, 1] }
variable.e = { initial = 0.3, bounds = [0, 1] }
variable.r = { initial = 0.9, bounds = [0.5, 2] }
body = [{ name = "ball", position = [0.01, 0.02, "r + 0.12"], velocity = ["speed", 0.1, 0], angular_velocity = [2, "spin", 0], mass = 2, inertia = [0.008, 0.008, 0.008] }]
shape = [
  { name = "ball", on = "ball", type = "sphere", radius = 0.1 },
  { name = "hill", on = "ground", type = "sphere", centre = [0, 0, 0], radius = "r" },
]
contact = [{ name = "hill", between = ["hill", "ball"], sliding = "mu", restitution = "e", rest_speed = 0.05 }]
functional = [
  { name = "x", type = "position", on = "ball", direction = [1, 0, 0], over = "terminal" },
  { name = "y", type = "position", on = "ball", direction = [0, 1, 0], over = "terminal" },
]
"#,
    );
}

/// A lever on a hinge with friction hits a stop: the hinge slips the other way behind it, with e times the rate.
#[test]
fn an_impact_turns_the_slip_of_a_hinge_round() {
    let (values, rows) = values_of(
        r#"
version = 1
settings = { end = 1, steps = 20 }
variable.e = { initial = 0.4, bounds = [0, 1] }
body = [{ name = "lever", position = [0, 0, 0], angular_velocity = [0, 0, 2], mass = 3, inertia = [1, 1, 0.7] }]
joint = [{ name = "hinge", type = "revolute", between = ["ground", "lever"], point = [0, 0, 0], axis = [0, 0, 1] }]
friction = [{ name = "bearing", joint = "hinge", sliding = 0.3, radius = 0.1 }]
shape = [{ name = "tip", on = "lever", type = "point", centre = [1, 0, 0] }, { name = "stop", on = "ground", type = "plane", point = [0, "sin(0.5)", 0], normal = [0, -1, 0] }]
contact = [{ name = "hit", between = ["tip", "stop"], restitution = "e" }]
functional = [{ name = "rate", type = "joint_rate", between = ["ground", "lever"], axis = [0, 0, 1], over = "terminal" }]
"#,
    );
    assert_near(values[0], -0.8, 1e-10, "rate");
    assert_near(rows[0][0], -2.0, 1e-9, "by the restitution");
}

/// A load that is no force, and limits that bend, have no impacts.
#[test]
fn a_friction_that_impacts_cannot_use_is_told() {
    #[derive(Hash)]
    struct Odd(bool);
    impl Friction for Odd {
        fn nodes(&self) -> Vec<NodeKind> {
            vec![NodeKind::Coordinates(2)]
        }
        fn slip<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, s: &mut [S]) {
            s[0] = v[0];
        }
        fn load<S: Scalar>(&self, mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
            if self.0 { mu[0] * mu[0] } else { mu[0].abs() }
        }
        fn limits<S: Scalar>(&self, load: S, _state: State<S>, _p: &[S], _t: S) -> [S; 2] {
            if self.0 { [load; 2] } else { [load, load * load] }
        }
    }
    for (is_load, words) in [(true, "not of the first degree"), (false, "not linear in the load")] {
        let mut mechanism = MechanismBuilder::<f64>::default();
        let bead = mechanism.coordinates("bead", &[1.0, 0.0], &[0.0; 2]);
        let pipe = mechanism.constraint("pipe", &[bead], Circle, &[1.0]);
        assert!(mechanism.friction(pipe, Odd(is_load), &[]).is_none());
        let why = mechanism.finish().err().expect("it is told");
        assert!(why.contains(words), "{why}");
    }
}

/// A motor turns an arm to either side, from the start or later, and holds it then: its work is the friction mu r N of the bearing times the angle.
#[test]
fn a_motor_turns_a_bearing_to_either_side() {
    for (to, start) in [(1, 0.0), (1, 0.5), (-1, 0.0), (-1, 0.5)] {
        let (values, rows) = values_of(&format!(
            r#"
version = 1
settings = {{ end = 2, steps = 100 }}
variable.mu = {{ initial = 0.3, bounds = [0, 2] }}
body = [{{ name = "arm", position = [0, 0, 0], mass = 2, inertia = [0.1, 0.2, 0.3] }}]
joint = [{{ name = "hinge", type = "revolute", between = ["ground", "arm"], point = [0, 0, 0], axis = [0, 0, 1] }}]
friction = [{{ name = "bearing", joint = "hinge", sliding = "mu", radius = 0.1, preload = 50 }}]
driver = [{{ name = "motor", type = "rotation", between = ["ground", "arm"], axis = [0, 0, 1], angle = {{ type = "smooth_ramp", to = {to}, start = {start}, duration = 1 }} }}]
functional = [{{ name = "work", type = "joint_power", joint = "motor", over = "integral" }}]
"#
        ));
        assert_near(values[0], 0.3 * 0.1 * 50.0, 1e-6, "work");
        assert_near(rows[0][0], 0.1 * 50.0, 1e-6, "by the friction");
    }
}

/// What breaks away in an impact, and hardly slips there, has friction against the slip that it has then: by quotients of whole runs.
#[test]
fn what_hardly_slips_in_an_impact_has_the_direction_of_its_slip() {
    let scene = parsed(
        r#"
version = 1
gravity = [1454.88, -562.541, 8810.38]
settings = { end = 0.018, steps = 60 }
variable.length = { initial = 1, bounds = [0.5, 2] }
variable.mass = { initial = 1, bounds = [0.5, 2] }
variable.restitution = { initial = 0.721535, bounds = [0.1, 0.9] }
variable.sliding = { initial = 0.505909, bounds = [0.1, 0.9] }
body = [{ name = "body", position = ["-2.68776 * length", "0.819576 * length", "-16.9417 * length"], mass = "0.00887455 * mass", inertia = ["0.335434 * length^2", "0.406024 * length^2", "0.263783 * length^2"], orientation = { type = "angle", axis = [0.007287366202302721, 0.8302853305386315, 0.5572909152195009], angle = 0.7 } }]
joint = [{ name = "guide", type = "point_in_plane", between = ["ground", "body"], point = ["-1.34388 * length", "0.409788 * length", "-8.47086 * length"], normal = [0.45536405990085393, 0.28239107975828653, -0.8443333767082529] }]
spring = [{ name = "bushing", type = "bushing", between = ["ground", "body"], point = [0, 0, 0], stiffness = [19.2225, 0.713955, 0.391231, 483.773, 126.112, 80.6852], damping = [0.0410361, 0.00207361, 0.0102663, 1.34946, 2.51519, 1.88716] }]
shape = [
    { name = "sphere", type = "sphere", on = "body", radius = "4.35329 * length" },
    { name = "plane", type = "plane", on = "ground", point = ["-4.55166 * length", "-1.4755 * length", "-2.7764 * length"], normal = [-0.822786411613561, -0.266720714701588, -0.5018790503828128] },
]
contact = [{ name = "hit", between = ["sphere", "plane"], restitution = "restitution", sliding = "sliding", static = 0.644114 }]
functional = [
    { name = "turn", type = "velocity", on = "body", point = ["-7.06427 * length", "-5.55747 * length", "-18.3089 * length"], direction = [0.984516958936481, -0.138510946381139, -0.10742939681048556], over = "terminal" },
    { name = "reaction", type = "reaction_norm", joint = "guide", over = "terminal" },
]
"#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    assert_eq!(analysis.events(&forward).len(), 1);
    let rows = analysis.adjoint(x, &forward).expect("it has derivatives").rows;
    for (place, unit) in
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]].iter().enumerate()
    {
        let quotients = analysis.central_difference(x, unit, 1e-4).expect("it runs");
        for (row, quotient) in rows.iter().zip(quotients) {
            let size = row.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
            assert_near(row[place] / size, quotient / size, 1e-7, &format!("derivative {place}"));
        }
    }
}

/// A block that is thrown across an incline: its slip u, at an angle f from the line of fall, follows u' = G cos f - F and u f' = -G sin f, so that
/// u (F + G cos f) falls evenly by F^2 - G^2.
#[test]
fn slip_in_two_directions_is_followed_to_its_end() {
    for ([vx, vy], mu, alpha, limit) in [
        ([0.3_f64, 2.0_f64], 0.8, 0.4, 1e-10),
        // turns to its very end, the last of which is a line
        ([0.3, 2.0], 0.8, 0.05, 1e-8),
        // hardly steep enough to go on, and up the line of fall and round
        ([0.3, 2.0], 0.45, 0.4, 1e-9),
        ([-2.0, 0.1], 0.8, 0.4, 2e-8),
        ([2.0, 0.0], 0.8, 0.4, 1e-12),
    ] {
        let (along, against) = (9.81 * f64::sin(alpha), mu * 9.81 * f64::cos(alpha));
        let time = |vy: f64| (vx.hypot(vy) * against + along * vx) / (against * against - along * along);
        let text = format!(
            "version = 1\ngravity = [0, 0, -9.81]\nsettings = {{ end = {}, tolerance = 1e-11 }}\nvariable.vy = {{ initial = {vy}, bounds = [-9, 9] }}\n\
             define = {{ vx = {vx}, c = \"cos({alpha})\", s = \"sin({alpha})\" }}\n\
             point = [{{ name = \"block\", position = [0, 0, 0], velocity = [\"vx * c\", \"vy\", \"-vx * s\"], mass = 2 }}]\n\
             shape = [{{ name = \"block\", on = \"block\", type = \"point\" }}, {{ name = \"incline\", on = \"ground\", type = \"plane\", normal = [\"s\", 0, \"c\"] }}]\n\
             contact = [{{ name = \"incline\", between = [\"block\", \"incline\"], sliding = {mu} }}]\n\
             functional = [{{ name = \"stop\", type = \"event_time\", event = \"incline\", which = \"stick\", over = \"terminal\" }}]\n",
            1.2 * time(vy)
        );
        let scene = parsed(&text);
        let prepared = Prepared::new(&scene).unwrap();
        let (analysis, x) = (prepared.analysis(), prepared.x.clone());
        let forward = analysis.forward(&x).unwrap();
        let what = format!("{vx} {vy} {mu} {alpha}");
        assert_near(forward.values[0] / time(vy), 1.0, limit, &what);
        let sticks = analysis.events(&forward).iter().filter(|own| own.name.starts_with("stick")).count();
        assert_eq!(sticks, 1, "{what}: turns of the direction are none");
        if vy > 1.0 {
            let rate = against * vy / vx.hypot(vy) / (against * against - along * along);
            assert_near(analysis.adjoint(&x, &forward).unwrap().rows[0][0] / rate, 1.0, 10.0 * limit, &what);
        }
    }
}

/// The rod of Painleve slides until no force keeps Coulomb's law: by a run of another program at 1.2752 ms, at 1.29 m/s.
#[test]
fn a_contact_that_comes_to_where_it_has_no_solution_is_told() {
    let text = include_str!("../../verification/contact/painleve-reached.toml");
    for settings in ["end = 0.01, steps = 200", "end = 0.01, tolerance = 1e-8"] {
        let scene = parsed(&text.replace("end = 0.01, steps = 200", settings));
        let prepared = Prepared::new(&scene).unwrap();
        let why = prepared.analysis().forward(&prepared.x).map(|_| ()).unwrap_err().to_string();
        assert!(why.contains("the contact \"tip\"") && why.contains("solution by Coulomb's law at t = 0.001"), "{why}");
    }
    let early = text.replace("end = 0.01", "end = 0.0012");
    let scene = parsed(&early);
    let prepared = Prepared::new(&scene).unwrap();
    prepared.analysis().forward(&prepared.x).unwrap();
}
