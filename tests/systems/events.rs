//! Events, stops, latches and joints that come and go, against closed forms, quotients of whole runs, and each other.

use super::parsed;
use costate::history::Keep;
use costate::integrators::{Table, tables};
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use costate::sensitivity::{Analysis, Forward};

const SCENES: [(&str, &str); 10] = [
    ("ball", include_str!("events/ball.toml")),
    ("table", include_str!("events/table.toml")),
    ("leaves", include_str!("events/leaves.toml")),
    ("latch", include_str!("events/latch.toml")),
    ("release", include_str!("events/release.toml")),
    ("clegg", include_str!("events/clegg.toml")),
    ("rest", include_str!("events/rest.toml")),
    ("knee", include_str!("events/knee.toml")),
    ("breaks", include_str!("events/breaks.toml")),
    ("torn", include_str!("events/torn.toml")),
];

fn scene(name: &str) -> FileScene {
    parsed(SCENES.iter().find(|own| own.0 == name).expect("listed").1)
}

fn x_of(scene: &FileScene) -> Vec<f64> {
    AnyScene::variables(scene).iter().map(|variable| variable.initial).collect()
}

fn assert_near(own: f64, exact: f64, limit: f64, what: &str) {
    assert!((own - exact).abs() <= limit, "{what}: {own} for {exact}, {limit:e}");
}

/// Values and rows of all functionals.
fn ran(scene: &FileScene, table: &Table, steps: usize) -> (Forward, Vec<Vec<f64>>) {
    let mut settings = AnyScene::settings(scene).without_method();
    settings.steps = steps;
    let x = x_of(scene);
    let method = Method::new(table.clone(), settings.level);
    let prepared = Prepared::with(scene, &x, method, settings).expect("it is sound");
    let forward = prepared.analysis().forward(&x).unwrap_or_else(|why| panic!("{}: {why}", table.name));
    let rows = prepared.analysis().adjoint(&x, &forward).unwrap_or_else(|why| panic!("{}: {why}", table.name)).rows;
    (forward, rows)
}

fn table(name: &str) -> Table {
    tables().into_iter().find(|table| table.name == name).expect("listed")
}

fn moving_tables() -> impl Iterator<Item = Table> {
    tables().into_iter().filter(|own| !own.is_static() && own.variational.is_none())
}

/// Closed forms: z(T), time of bounce 4, of bounce 1, integral of z, with derivatives by h0, vx, e, g.
#[test]
fn a_bouncing_ball_is_exact() {
    let exact = [
        (0.11795005964214797, [1.353813629821074, 0.0, 6.627596568900959, -0.12597997657277533]),
        (2.2142719353940244, [1.1071359676970122, 0.0, 4.081773714511007, -0.11285789680907362]),
        (0.4515236409857309, [0.22576182049286545, 0.0, 0.0, -0.02301343735910963]),
        (0.8837987889165236, [1.1782606088221004, 0.0, 3.137435677156658, -0.03001649540321884]),
    ];
    for steps in [7, 100] {
        let (forward, rows) = ran(&scene("ball"), &table("esdirk4"), steps);
        for ((value, gradient), (own, row)) in exact.iter().zip(forward.values.iter().zip(&rows)) {
            assert_near(*own, *value, 1e-13, "value");
            row.iter().zip(gradient).for_each(|(own, exact)| assert_near(*own, *exact, 2e-12, "derivative"));
        }
    }
}

#[test]
fn adjoint_tangent_complex_step_and_quotients_agree() {
    let everywhere = moving_tables().flat_map(|own| ["ball", "leaves", "release"].map(|name| (name, own.clone())));
    let everywhere = everywhere.filter(|(name, own)| *name != "leaves" || own.stiffly_accurate);
    // its discrete bounces die out within the run
    let everywhere = everywhere.filter(|(name, own)| *name != "ball" || own.name != "bdf1");
    let others = ["table", "latch", "clegg", "rest", "knee", "breaks", "torn"].map(|name| (name, table("esdirk4")));
    for (name, table) in everywhere.chain(others) {
        let place = format!("{name} by {}", table.name);
        let scene = scene(name);
        let settings = AnyScene::settings(&scene).without_method();
        let x = x_of(&scene);
        let method = Method::new(table, settings.level);
        let prepared = Prepared::with(&scene, &x, method, settings).expect("it is sound");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&x).unwrap_or_else(|why| panic!("{place}: {why}"));
        assert!(!analysis.events(&forward).is_empty(), "{place}");
        let [adjoint, tangent, complex] = [Analysis::adjoint, Analysis::tangent, Analysis::complex_step]
            .map(|by| by(&analysis, &x, &forward).unwrap_or_else(|why| panic!("{place}: {why}")).rows);
        let on_steps = analysis.on_steps_of(&forward);
        for (k, row) in adjoint.iter().enumerate() {
            let size = row.iter().fold(0.0, |size: f64, own| size.max(own.abs())).max(1e-2).max(forward.values[k].abs());
            for i in 0..x.len() {
                let mut along = vec![0.0; x.len()];
                along[i] = 1.0;
                let by = 1e-4 * x[i].abs().max(0.1);
                let quotient = on_steps.central_difference(&x, &along, by).unwrap_or_else(|why| panic!("{place}: {why}"))[k];
                assert_near(row[i], complex[k][i], 1e-11 * size, &place);
                assert_near(row[i], tangent[k][i], 1e-11 * size, &place);
                assert_near(row[i], quotient, 3e-8 * size, &place);
            }
        }
    }
}

/// A moving table that is hit, and a mass that is held at a stop until its force would pull: values and derivatives with the order of the method.
#[test]
fn stops_keep_the_order_of_every_method() {
    // of x(T) by m, k, x0, xs, F0, rate; and x(T)
    let [m, k, xs, force, rate, end] = [1.5, 200.0, -0.03, 40.0, 10.0, 4.0];
    let x = |m: f64, k: f64, xs: f64, force: f64, rate: f64| {
        let (s, w) = (end - (force + k * xs) / rate, (k / m).sqrt());
        xs + rate / k * (s - (w * s).sin() / w)
    };
    let central = |of: &dyn Fn(f64) -> f64, at: f64| {
        let h = 1e-4 * at.abs();
        (8.0 * (of(at + h) - of(at - h)) - of(at + 2.0 * h) + of(at - 2.0 * h)) / (12.0 * h)
    };
    let exact = [
        x(m, k, xs, force, rate),
        central(&|m| x(m, k, xs, force, rate), m),
        central(&|k| x(m, k, xs, force, rate), k),
        0.0,
        central(&|xs| x(m, k, xs, force, rate), xs),
        central(&|force| x(m, k, xs, force, rate), force),
        central(&|rate| x(m, k, xs, force, rate), rate),
    ];
    let sizes = [0.01, 0.01, 1e-3, 1.0, 1.0, 1e-3, 1e-2];
    for own in moving_tables().filter(|own| own.stiffly_accurate) {
        let errors = [390, 780].map(|steps| {
            let (forward, rows) = ran(&scene("leaves"), &own, steps);
            let all = [&forward.values[..1], &rows[0]].concat();
            let errors = all.iter().zip(exact).zip(sizes).map(|((own, exact), size)| (own - exact).abs() / size);
            errors.fold(0.0, f64::max)
        });
        println!("{} of order {}: {errors:?}, {}", own.name, own.order, errors[0] / errors[1]);
        assert!(errors[1] < 1.6 * errors[0] / 2f64.powi(own.order as i32), "{}: {errors:?}", own.name);
    }
}

#[test]
fn steps_kept_elsewhere_give_the_same_bits() {
    let folder = std::env::temp_dir().join(format!("costate-events-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, text) in SCENES {
        let scene = parsed(text);
        let prepared = Prepared::new(&scene).expect("it is sound");
        let x = x_of(&scene);
        let keeps = [Keep::Memory, Keep::File(folder.join(name)), Keep::Checkpoints(100_000), Keep::Nothing];
        let rows = keeps.map(|keep| {
            let analysis = Analysis { keep: &keep, ..prepared.analysis() };
            let forward = analysis.forward(&x).unwrap_or_else(|why| panic!("{name}, {keep:?}: {why}"));
            if keep == Keep::Nothing {
                return (forward.values, Vec::new());
            }
            let rows = analysis.adjoint(&x, &forward).unwrap_or_else(|why| panic!("{name}, {keep:?}: {why}")).rows;
            (forward.values, rows)
        });
        for other in &rows[1..] {
            assert_eq!(rows[0].0, other.0, "{name}");
            assert!(other.1.is_empty() || rows[0].1 == other.1, "{name}");
        }
    }
    std::fs::remove_dir_all(&folder).expect("it is there");
}

/// A file of one ball, with more lines.
fn ball_with(more: &str) -> String {
    format!(
        "version = 1\ngravity = [0, 0, -10]\nsettings = {{ end = 1, steps = 50 }}\n\
         point = [{{ name = \"ball\", position = [0, 0, 1], mass = 1 }}]\n\
         functional = [{{ name = \"z\", type = \"position\", on = \"ball\", direction = [0, 0, 1], over = \"terminal\" }}]\n{more}"
    )
}

#[test]
fn what_cannot_be_is_told() {
    let node = "nodes = { ball = \"ball\" }";
    for (more, words) in [
        (
            format!("stop = [{{ name = \"s\", {node}, value = \"ball.position.z\", least = 1.5 }}]"),
            "beyond the limit of the stop \"s\", by 5.000e-1",
        ),
        (
            format!(
                "joint = [{{ name = \"j\", type = \"formula\", {node}, equations = [\"ball.position.x - 0.1\"], present = false }}]\n\
                 event = [{{ name = \"e\", at = 0.5, lock = \"j\" }}]"
            ),
            "\"j\" cannot be locked at t = 0.5 s",
        ),
        (
            format!(
                "joint = [{{ name = \"j\", type = \"formula\", {node}, equations = [\"ball.position.x\"] }}]\n\
                 event = [{{ name = \"e\", {node}, at = 0.5, set = {{ \"ball.velocity\" = [1, 0, 0] }} }}]"
            ),
            "violates joint \"j\"",
        ),
        (
            format!(
                "event = [{{ name = \"e\", {node}, at = 0.5, set = {{ \"ball.velocity\" = \"[0, 0, log(ball.position.z)]\" }} }}]"
            ),
            "is not a number there",
        ),
    ] {
        let scene = FileScene::parse("ball", &ball_with(&more)).unwrap_or_else(|why| panic!("{more}: {why}"));
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{more}: {why}"));
        let error = prepared.analysis().forward(&[]).expect_err(&more).to_string();
        assert!(error.contains(words), "{more}: {error}");
    }
    for (more, words) in [
        ("stop = [{ name = \"s\", on = \"ball\", least = 0 }]".to_string(), "has no value: give nodes and value"),
        (format!("stop = [{{ name = \"s\", {node}, value = \"ball.position.z\" }}]"), "needs least, most, or both"),
        (
            format!("stop = [{{ name = \"s\", {node}, value = \"ball.position.z\", least = 2, most = 1 }}]"),
            "least must be below most",
        ),
        (
            format!("stop = [{{ name = \"s\", {node}, value = \"ball.position.z\", least = 0, restitution = 1.5 }}]"),
            "from 0 to 1",
        ),
        ("event = [{ name = \"e\", end = true }]".to_string(), "needs one of when and at"),
        (format!("event = [{{ name = \"e\", {node}, when = 3 }}]"), "passes zero never"),
        (format!("stop = [{{ name = \"s\", {node}, value = \"1\", least = 0 }}]"), "never reaches a limit"),
        (
            format!(
                "joint = [{{ name = \"j\", type = \"formula\", {node}, equations = [\"ball.position.x\"] }}]\n\
                 event = [{{ name = \"e\", at = 0.5, lock = \"j\" }}]"
            ),
            "which is there from the start",
        ),
        (
            format!("event = [{{ name = \"e\", {node}, at = 1, set = {{ \"ball.place\" = 3 }} }}]"),
            "position and velocity can be set",
        ),
        (
            format!("event = [{{ name = \"e\", {node}, at = 1, set = {{ \"other.velocity\" = [1, 2, 3] }} }}]"),
            "there is no \"other\" among the nodes",
        ),
        (format!("event = [{{ name = \"e\", {node}, at = 1, set = {{ \"ball.velocity\" = 3 }} }}]"), "takes a vector"),
    ] {
        let text = ball_with(&more);
        let error = match FileScene::parse("ball", &text) {
            Err(why) => why.to_string(),
            Ok(scene) => Prepared::new(&scene).err().unwrap_or_else(|| panic!("{more}: no error")).to_string(),
        };
        assert!(error.contains(words), "{more}: {error}");
    }
}

/// The time of an event that does not happen is no number.
#[test]
fn an_event_that_does_not_happen_has_no_time() {
    let event = "event = [{ name = \"e\", nodes = { ball = \"ball\" }, when = \"ball.position.z + 100\" }]";
    let time = "functional = [{ name = \"time\", type = \"event_time\", event = \"e\", over = \"terminal\" }, { name";
    let scene = parsed(&ball_with(event).replace("functional = [{ name", time));
    let prepared = Prepared::new(&scene).expect("it is sound");
    let error = prepared.analysis().forward(&[]).expect_err("it is no number").to_string();
    assert!(error.contains("did not happen so often"), "{error}");
}

/// A pendulum that starts level breaks where its force 3 m g cos(theta) reaches its strength, and flies on with its horizontal velocity, sqrt(2 g L c) c,
/// c = F / (3 m g).
#[test]
fn a_joint_opens_beyond_its_strength() {
    let (forward, rows) = ran(&scene("breaks"), &table("esdirk4"), 300);
    let [length, m, strength, g] = [1.5, 2.0, 40.0, 9.81];
    let c: f64 = strength / (3.0 * m * g);
    let vx = (2.0 * g * length * c).sqrt() * c;
    assert_near(forward.values[0], vx, 1e-7, "velocity");
    for (own, exact) in rows[0].iter().zip([0.5 * vx / length, -1.5 * vx / m, 1.5 * vx / strength]) {
        assert_near(*own, exact, 1e-6, "derivative");
    }
    // the force is that of the state, whatever stages a method has
    for name in ["midpoint", "newmark", "bdf2", "sdirk3"] {
        let (forward, _) = ran(&scene("breaks"), &table(name), 1200);
        assert_near(forward.values[0], vx, 5e-5, name);
    }
    let own = include_str!("events/breaks.toml")
        .replace("[\"-L\", 0, 0]", "[0, 0, \"-L\"]")
        .replace("initial = 40", "initial = 10");
    let own = parsed(&own);
    let prepared = Prepared::new(&own).expect("it is sound");
    let error = prepared.analysis().forward(&prepared.x).expect_err("it is due").to_string();
    assert!(error.contains("the release of rod is due at the start"), "{error}");
}

/// A ball that falls from 0.1 m bounces infinitely often: the integral of its height is v^3 / (3 g^2) (1 + 2 e^3 / (1 - e^3)), v^2 = 2 g 0.1 m.
#[test]
fn what_bounces_ever_faster_comes_to_rest() {
    for e in [0.1_f64, 0.5, 0.8] {
        let text = format!(
            r#"
version = 1
gravity = [0, 0, -10]
settings = {{ end = 3, steps = 150 }}
variable.e = {{ initial = {e}, bounds = [0, 1] }}
point = [{{ name = "ball", position = [0, 0, 0.1], mass = 1 }}]
stop = [{{ name = "floor", nodes = {{ ball = "ball" }}, value = "ball.position.z", least = 0, restitution = "e" }}]
functional = [{{ name = "height", type = "position", on = "ball", direction = [0, 0, 1], over = "integral" }}]
"#
        );
        let ball = parsed(&text);
        let (forward, rows) = ran(&ball, &table("esdirk4"), 150);
        let unit = 2.0_f64.powf(1.5) / 300.0;
        assert_near(forward.values[0], unit * (1.0 + 2.0 * e.powi(3) / (1.0 - e.powi(3))), 1e-10, "height");
        assert_near(rows[0][0], unit * 6.0 * e * e / (1.0 - e.powi(3)).powi(2), 1e-8, "by the restitution");
    }
}

/// What would jump behind the event that ends a run is not in it, so that a variable may move it: T = 0.5 / v.
#[test]
fn a_jump_behind_the_end_of_a_run_may_move() {
    let scene = parsed(
        r#"
        version = 1
        settings = { end = 2, steps = 20 }
        variable.late = { initial = 1.5, bounds = [0.5, 2], unit = "s" }
        variable.speed = { initial = 0.8, bounds = [0.5, 2], unit = "m/s" }
        coordinate = [{ name = "x", rate = "speed" }]
        element = [
            { name = "mass", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2", force = { x = "if_less(t, late, 0, 1)" } },
        ]
        event = [{ name = "there", nodes = { x = "x" }, when = "x.value - 0.5", end = true }]
        functional = [{ name = "time", type = "event_time", event = "there", over = "terminal" }]
        "#,
    );
    let (forward, rows) = ran(&scene, &table("esdirk4"), 20);
    assert_near(forward.values[0], 0.5 / 0.8, 1e-14, "time");
    // steps before the event are laid up to the jump, and exact whatever they are
    assert_near(rows[0][0], 0.0, 1e-15, "by the time of the jump");
    assert_near(rows[0][1], -0.5 / 0.64, 1e-13, "by the speed");
}

/// Steps before an event that ends a run are laid up to a breakpoint behind it, and move with that: what coarse steps make of it is in the gradient.
#[test]
fn steps_move_with_a_breakpoint_that_is_not_reached() {
    let scene = parsed(
        r#"
        version = 1
        settings = { end = 2, steps = 8 }
        variable.late = { initial = 1.45, bounds = [0.5, 2], unit = "s" }
        coordinate = [{ name = "x", rate = 1 }]
        element = [
            { name = "mass", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2", force = { x = "-9 * sin(3 * x.value) - if_less(t, late, 0, 1)" } },
        ]
        event = [{ name = "there", nodes = { x = "x" }, when = "x.rate + 0.5", direction = "falling", end = true }]
        functional = [{ name = "x", type = "coordinate", on = "x", over = "terminal" }]
        "#,
    );
    let at = |late: f64| {
        let settings = AnyScene::settings(&scene).without_method();
        let method = Method::new(table("esdirk4"), settings.level);
        let prepared = Prepared::with(&scene, &[late], method, settings).expect("it is sound");
        let forward = prepared.analysis().forward(&[late]).expect("it ends");
        let rows = prepared.analysis().adjoint(&[late], &forward).expect("it has a gradient").rows;
        let complex = prepared.analysis().complex_step(&[late], &forward).expect("it has one").rows;
        (forward.values[0], rows[0][0], complex[0][0])
    };
    let (_, own, complex) = at(1.45);
    let h = 1e-5;
    let quotient = (at(1.45 + h).0 - at(1.45 - h).0) / (2.0 * h);
    assert!(quotient.abs() > 1e-6, "the steps are fine: {quotient}");
    assert_near(own, quotient, 1e-4 * quotient.abs(), "quotient of whole runs");
    assert_near(own, complex, 1e-12, "complex step");
}

/// A run that an event ends, made again on its steps at designs beside: the same values, and quotients as the adjoint.
#[test]
fn a_run_that_ended_at_an_event_is_made_again_on_its_steps() {
    let scene = parsed(
        r#"
        version = 1
        settings = { end = 20, steps = 400 }
        variable.speed = { initial = 1, bounds = [0.5, 2], unit = "m/s" }
        coordinate = [{ name = "x", rate = "speed" }]
        element = [{ name = "mass", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2", potential = "4 * x.value^4" }]
        event = [{ name = "back", nodes = { x = "x" }, when = "x.value + 0.3", end = true }]
        functional = [
            { name = "time", type = "event_time", event = "back", over = "terminal" },
            { name = "rate", type = "formula", nodes = { x = "x" }, value = "x.rate", over = "terminal" },
        ]
        "#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("it runs");
    let on_steps = analysis.on_steps_of(&forward);
    assert_eq!(on_steps.values(&prepared.x).expect("it runs"), forward.values);
    let rows = analysis.adjoint(&prepared.x, &forward).expect("it is smooth").rows;
    let quotients = on_steps.central_difference(&prepared.x, &[1.0], 1e-3).expect("it runs");
    for (row, quotient) in rows.iter().zip(quotients) {
        assert_near(row[0], quotient, 1e-9 * quotient.abs(), "by the speed");
    }
}

/// On the steps of a run that chose them neighbouring designs are run with steps behind an event that move with it.
#[test]
fn chosen_steps_behind_an_event_move_with_it() {
    for end in ["3", "0.59"] {
        chosen_steps_move(end);
    }
}

fn chosen_steps_move(end: &str) {
    let scene = parsed(
        &r#"
        version = 1
        settings = { end = END, tolerance = 1e-4 }
        variable.stiffness = { initial = 3, bounds = [1, 10], unit = "N/m" }
        variable.speed = { initial = 1, bounds = [0.5, 2], unit = "m/s" }
        coordinate = [{ name = "x", rate = "speed" }]
        number = [{ name = "mode" }]
        element = [{ name = "mass", nodes = { x = "x", mode = "mode" }, kinetic = "0.5 * x.rate^2", potential = "0.25 * stiffness * x.value^4", force = { x = "-mode.value * x.rate^3" } }]
        event = [{ name = "damped", nodes = { x = "x", mode = "mode" }, when = "x.value - 0.5", set = { mode = 1 }, once = true }]
        functional = [{ name = "x", type = "formula", nodes = { x = "x" }, value = "x.value", over = "terminal" }]
        "#
        .replace("END", end),
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    let on_steps = analysis.on_steps_of(&forward);
    assert_near(on_steps.values(x).expect("it runs")[0], forward.values[0], 1e-14, "the same steps");
    let row = &analysis.adjoint(x, &forward).expect("it is smooth").rows[0];
    for i in 0..2 {
        let mut along = [0.0; 2];
        along[i] = 1.0;
        let quotient = on_steps.central_difference(x, &along, 1e-4).expect("it runs")[0];
        assert_near(row[i], quotient, 1e-9, "derivative");
    }
}

/// Equal steps are laid anew behind an event, in the size that the ends of its stretch give them, which move.
#[test]
fn steps_behind_an_event_move_with_breakpoints() {
    let scene = parsed(
        r#"
        version = 1
        variable.late = { initial = 1.0, bounds = [0.5, 2] }
        settings = { end = 2, steps = 17 }
        coordinate = [{ name = "x", rate = 1 }]
        element = [
            { name = "m", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2", potential = "3 * x.value^4" },
            { name = "pushed", nodes = { x = "x" }, force = { x = "if_less(t, 1.2 * late, 0, 1)" } },
        ]
        event = [{ name = "e", nodes = { x = "x" }, when = "x.value - 0.43", once = true }]
        functional = [
            { name = "f", type = "coordinate", on = "x", over = "terminal" },
            { name = "g", type = "formula", nodes = { x = "x" }, value = "x.rate^2", over = "integral" },
        ]
        "#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    let [adjoint, tangent, complex] = [Analysis::adjoint, Analysis::tangent, Analysis::complex_step]
        .map(|by| by(&analysis, x, &forward).expect("it is smooth").rows);
    let quotients = analysis.central_difference(x, &[1.0], 1e-4).expect("it runs");
    for k in 0..2 {
        assert_near(adjoint[k][0], complex[k][0], 1e-12, "complex step");
        assert_near(adjoint[k][0], tangent[k][0], 1e-12, "tangent");
        assert_near(adjoint[k][0], quotients[k], 1e-9, "quotient");
    }
}

/// A ball gives the floor m (1 + e) e^(k - 1) sqrt(2 g h) in its k-th bounce.
#[test]
fn impulses_are_those_of_the_hits() {
    let scene = parsed(
        r#"
        version = 1
        gravity = [0, 0, -9.81]
        settings = { end = 2.5, steps = 40 }
        variable.h = { initial = 1, bounds = [0.1, 10], unit = "m" }
        variable.e = { initial = 0.8, bounds = [0.1, 1], unit = "-" }
        variable.m = { initial = 0.1, bounds = [0.1, 1], unit = "kg" }
        point = [{ name = "ball", position = [0, 0, "h"], mass = "m" }]
        stop = [{ name = "floor", nodes = { ball = "ball" }, value = "ball.position.z", least = 0, restitution = "e" }]
        functional = [{ name = "blows", type = "impulse", event = "floor", over = "terminal" }]
        "#,
    );
    let (forward, rows) = ran(&scene, &table("esdirk4"), 40);
    let [h, e, m] = [1.0, 0.8, 0.1];
    let speed = (2.0f64 * 9.81 * h).sqrt();
    let [sum, slope] = [(1.0 + e) * (1.0 + e + e * e + e * e * e), 2.0 + 4.0 * e + 6.0 * e * e + 4.0 * e * e * e];
    assert_near(forward.values[0], m * speed * sum, 1e-13, "impulses");
    for (own, exact) in rows[0].iter().zip([0.5 * m * speed * sum / h, m * speed * slope, speed * sum]) {
        assert_near(*own, exact, 1e-12, "derivative");
    }
}

/// The last two steps before the end of a run are halves of what is left, also where another event cuts the second of them.
#[test]
fn halves_that_events_cut_move_as_halves() {
    let scene = parsed(
        r#"
        version = 1
        variable.speed = { initial = 1, bounds = [0.5, 2], unit = "m/s" }
        settings = { end = 1, steps = 5 }
        coordinate = [{ name = "x", rate = "speed" }]
        element = [{ name = "m", nodes = { x = "x" }, kinetic = "0.5 * x.rate^2", potential = "3 * x.value^4 + cos(5 * x.value)" }]
        number = [{ name = "a" }, { name = "b" }]
        event = [
            { name = "first", nodes = { x = "x", a = "a" }, when = "x.value - 0.5", set = { a = 1 }, once = true },
            { name = "second", nodes = { x = "x", b = "b" }, when = "x.value - 0.62", direction = "falling", set = { b = 1 }, once = true },
        ]
        functional = [{ name = "x", type = "coordinate", on = "x", over = "terminal" }]
        "#,
    );
    let prepared = Prepared::new(&scene).expect("it is sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("it runs");
    let row = &analysis.adjoint(x, &forward).expect("it is smooth").rows[0];
    let quotient = analysis.central_difference(x, &[1.0], 1e-4).expect("it runs");
    assert_eq!(analysis.events(&forward).len(), 2);
    assert_near(row[0], quotient[0], 1e-9, "quotient");
}

/// The end of a ramp is a breakpoint that both of its sides round in their own way: adjoint and complex step take the same one.
#[test]
fn breakpoints_are_told_apart_beyond_their_rounding() {
    for duration in ["0.18", "0.194006", "0.21", "0.3"] {
        let scene = parsed(
            &r#"
            version = 1
            variable.late = { initial = 1.0, bounds = [0.5, 2] }
            settings = { end = 0.963824, steps = 20 }
            body = [
                { name = "a", mass = 2, inertia = [0.1, 0.2, 0.25] },
                { name = "b", mass = 3, inertia = [0.3, 0.2, 0.4], mass_centre = [-0.01, -0.02, -0.03] },
            ]
            driver = [{ name = "turn", type = "rotation", between = ["a", "b"], axis = [0.4, -0.9, 0.2], angle = { type = "smooth_ramp", to = -0.7, duration = "DURATION * late" } }]
            functional = [{ name = "distance", type = "distance", between = ["ground", "b"], points = [[1, 0, 0], [0, 1, 0]], over = "integral" }]
            "#
            .replace("DURATION", duration),
        );
        let prepared = Prepared::new(&scene).expect("it is sound");
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("it runs");
        let [adjoint, complex] = [Analysis::adjoint, Analysis::complex_step]
            .map(|by| by(&analysis, x, &forward).expect("it is smooth").rows[0][0]);
        assert!(adjoint.abs() > 1e-3, "{duration}: {adjoint}");
        assert_near(adjoint, complex, 1e-12, duration);
    }
}

/// A ball falls past a floor that is taken away, is thrown up, and lands on the floor that was brought back.
#[test]
fn stops_and_contacts_that_are_removed_are_hit_no_more_until_they_come_back() {
    let floors = [
        "stop = [{ name = \"floor\", nodes = { b = \"ball\" }, value = \"b.position.z\", least = 0 }]\n",
        "shape = [{ name = \"plane\", on = \"ground\", type = \"plane\", normal = [0, 0, 1] }, { name = \"point\", on = \"ball\", type = \"point\" }]\n\
         contact = [{ name = \"floor\", between = [\"plane\", \"point\"] }]\n",
    ];
    for floor in floors {
        let run = |back: f64, end: f64| {
            let text = format!(
                "version = 1\ngravity = [0, 0, -10]\nsettings = {{ end = {end}, steps = 40 }}\nvariable.h = {{ initial = 1, bounds = [0, 2] }}\n\
                 point = [{{ name = \"ball\", position = [0, 0, \"h\"], mass = 1 }}]\n{floor}\
                 event = [\n\
                 {{ name = \"gone\", at = 0.25, remove = \"floor\" }},\n\
                 {{ name = \"thrown\", at = 1, nodes = {{ ball = \"ball\" }}, set = {{ \"ball.velocity\" = \"[0, 0, 20]\" }} }},\n\
                 {{ name = \"back\", at = {back}, lock = \"floor\" }},\n]\n\
                 functional = [{{ name = \"z\", type = \"position\", on = \"ball\", direction = [0, 0, 1], over = \"terminal\" }}]\n"
            );
            let scene = parsed(&text);
            let prepared = Prepared::new(&scene).unwrap();
            prepared.analysis().forward(&prepared.x).map(|forward| forward.values[0])
        };
        let near = |own: Result<f64, _>, exact: f64| assert!((own.unwrap() - exact).abs() < 1e-11, "{floor}");
        near(run(8.0, 1.0), -4.0);
        near(run(1.5, 3.0), -4.0 + 40.0 - 20.0);
        // it lies on the floor
        near(run(1.5, 8.0), 0.0);
        let why = run(1.1, 3.0).unwrap_err().to_string();
        assert!(why.contains("\"floor\" cannot be locked at t = 1.1 s: the motion is beyond it by"), "{why}");
    }
}

#[test]
fn what_rolls_goes_with_its_contact() {
    let text = "version = 1\ngravity = [0, 0, -10]\nsettings = { end = 1, steps = 20 }\nvariable.speed = { initial = 1, bounds = [0, 2] }\n\
                body = [{ name = \"ball\", position = [0, 0, 0.1], velocity = [\"speed\", 0, 0], angular_velocity = [0, \"speed / 0.1\", 0], mass = 1, \
                inertia = [0.004, 0.004, 0.004] }]\n\
                joint = [{ name = \"roll\", type = \"rolling_sphere\", between = [\"ground\", \"ball\"], normal = [0, 0, 1], radius = 0.1 }]\n\
                event = [{ name = \"edge\", at = 0.5, remove = \"roll\" }]\n\
                functional = [{ name = \"z\", type = \"position\", on = \"ball\", direction = [0, 0, 1], over = \"terminal\" }]\n";
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).unwrap();
    let z = prepared.analysis().forward(&prepared.x).unwrap().values[0];
    assert!((z - (0.1 - 1.25)).abs() < 1e-9, "{z}");
}

/// Two balls that are let go at one height hit the floor at one time, each after a fall of its own: t = sqrt(2 h / g), z = e v (T - t) - g (T - t)^2 / 2,
/// v = g t. Derivatives by the height of the other one are zero, also of integrals, and of a third one that stays where it falls.
#[test]
fn hits_at_once_move_apart_by_their_own_heights() {
    let text = r#"
version = 1
gravity = [0, 0, -10]
settings = { end = 0.6, steps = 30 }
variable.a = { initial = 0.8, bounds = [0.1, 2], unit = "m" }
variable.b = { initial = 0.8, bounds = [0.1, 2], unit = "m" }
variable.c = { initial = 0.8, bounds = [0.1, 2], unit = "m" }
variable.e = { initial = 0.7, bounds = [0, 1] }
point = [{ name = "a", position = [0, 0, "a"], mass = 1 }, { name = "b", position = [1, 0, "b"], mass = 2 }, { name = "c", position = [2, 0, "c"], mass = 3 }]
stop = [
    { name = "of a", nodes = { a = "a" }, value = "a.position.z", least = 0, restitution = 0.5 },
    { name = "of b", nodes = { b = "b" }, value = "b.position.z", least = 0, restitution = "e" },
    { name = "of c", nodes = { c = "c" }, value = "c.position.z", least = 0 },
]
functional = [
    { name = "height", type = "formula", nodes = { b = "b" }, value = "b.position.z", over = "terminal" },
    { name = "mean", type = "formula", nodes = { b = "b" }, value = "b.position.z * t + b.velocity.z", over = "integral" },
    { name = "hit", type = "event_time", event = "of b", over = "terminal" },
    { name = "rest", type = "formula", nodes = { c = "c" }, value = "c.position.z", over = "integral" },
]
"#;
    let [g, h, e, end] = [10.0_f64, 0.8, 0.7, 0.6];
    let (fall, speed) = ((2.0 * h / g).sqrt(), (2.0 * g * h).sqrt());
    let behind = end - fall;
    let by_fall = -e * speed + g * behind + e * g * behind;
    let scene = parsed(text);
    for table in moving_tables() {
        let (forward, rows) = ran(&scene, &table, 30);
        // steps are laid from the last event on, and see it by their error
        for (k, row) in rows.iter().enumerate().filter(|_| table.order >= 4) {
            let others = if k < 3 { [0, 2] } else { [0, 1] };
            others.iter().for_each(|&other| assert_near(row[other], 0.0, 1e-9, &format!("{}, {k} by {other}", table.name)));
        }
        let settings = AnyScene::settings(&scene).without_method();
        let method = Method::new(table.clone(), settings.level);
        let prepared = Prepared::with(&scene, &x_of(&scene), method, settings).expect("it is sound");
        let by_steps = prepared.analysis().complex_step(&prepared.x, &forward).expect("it has one").rows;
        for (own, other) in rows.iter().flatten().zip(by_steps.iter().flatten()) {
            assert_near(*own, *other, 1e-10, &table.name);
        }
        if table.name == "esdirk4" {
            assert_near(forward.values[0], e * speed * behind - 0.5 * g * behind * behind, 1e-13, "height");
            assert_near(rows[0][1], by_fall / (g * fall), 1e-12, "height by b");
            assert_near(rows[0][3], speed * behind, 1e-12, "height by e");
            assert_near(forward.values[2], fall, 1e-14, "hit");
            assert_near(rows[2][1], 1.0 / (g * fall), 1e-12, "hit by b");
            // the integral of h - g t^2 / 2 up to the hit
            assert_near(forward.values[3], h * fall - g * fall.powi(3) / 6.0, 1e-13, "rest");
            assert_near(rows[3][2], fall, 1e-12, "rest by c");
        }
    }
}

/// Two masses of 1 kg reach bumpers with a force F at one time: behind it x = v t - F (t - gap / v)^2 / 2, each with its own gap. Where one formula has both
/// bumpers, what moves them apart has no derivative.
#[test]
fn elements_that_switch_at_once_do_so_at_their_own_times() {
    let [force, gap, v, end] = [3.0_f64, 0.5, 2.0, 0.6];
    let of_each = r#"
    { name = "of a", nodes = { a = "a" }, potential = "if_less(first, a.position.x, 3 * (a.position.x - first), 0)" },
    { name = "of b", nodes = { b = "b" }, potential = "if_less(second, b.position.x, 3 * (b.position.x - second), 0)" },
"#;
    let of_both = r#"
    { name = "pads", nodes = { a = "a", b = "b" }, potential = "if_less(first, a.position.x, 3 * (a.position.x - first), 0) + if_less(second, b.position.x, 3 * (b.position.x - second), 0)" },
"#;
    for pads in [of_each, of_both] {
        let text = format!(
            r#"
version = 1
settings = {{ end = {end}, steps = 30 }}
variable.first = {{ initial = {gap}, bounds = [0.1, 2], unit = "m" }}
variable.second = {{ initial = {gap}, bounds = [0.1, 2], unit = "m" }}
point = [{{ name = "a", position = [0, 0, 0], velocity = [{v}, 0, 0], mass = 1 }}, {{ name = "b", position = [0, 1, 0], velocity = [{v}, 0, 0], mass = 1 }}]
element = [{pads}]
functional = [
    {{ name = "of a", type = "position", on = "a", direction = [1, 0, 0], over = "terminal" }},
    {{ name = "of b", type = "position", on = "b", direction = [1, 0, 0], over = "terminal" }},
]
"#
        );
        let scene = parsed(&text);
        if pads == of_both {
            let prepared = Prepared::new(&scene).expect("it is sound");
            let forward = prepared.analysis().forward(&prepared.x).expect("it runs");
            let error = prepared.analysis().adjoint(&prepared.x, &forward).expect_err("bumpers come apart").to_string();
            assert!(error.contains("parts of \"pads\" pass at once"), "{error}");
            continue;
        }
        let (forward, rows) = ran(&scene, &table("esdirk4"), 30);
        let behind = end - gap / v;
        let (value, rate) = (v * end - 0.5 * force * behind * behind, force * behind / v);
        for (row, own) in rows.iter().enumerate() {
            assert_near(forward.values[row], value, 1e-14, "value");
            assert_near(own[row], rate, 1e-12, "by its own gap");
            assert_near(own[1 - row], 0.0, 1e-12, "by the gap of the other one");
        }
    }
}

/// A force that begins where a mass has come a way, and another where it has reached a speed, at the same time: the first changes when the second begins.
#[test]
fn elements_that_switch_at_once_and_act_on_each_other_have_no_derivative() {
    let text = |speed: &str| {
        format!(
            r#"
version = 1
settings = {{ end = 2, steps = 30 }}
variable.way = {{ initial = 0.5, bounds = [0.1, 2], unit = "m" }}
point = [{{ name = "a", position = [0, 0, 0], mass = 1 }}]
element = [
    {{ name = "push", nodes = {{ a = "a" }}, force = {{ a = "[1, 0, 0]" }} }},
    {{ name = "at a place", nodes = {{ a = "a" }}, force = {{ a = "[if_less(way, a.position.x, 0.5, 0), 0, 0]" }} }},
    {{ name = "at a speed", nodes = {{ a = "a" }}, force = {{ a = "[if_less({speed}, a.velocity.x, 0.25, 0), 0, 0]" }} }},
]
functional = [{{ name = "x", type = "position", on = "a", direction = [1, 0, 0], over = "terminal" }}]
"#
        )
    };
    for (speed, is_known) in [("1", false), ("1.2", true)] {
        let scene = parsed(&text(speed));
        let prepared = Prepared::new(&scene).expect("it is sound");
        let forward = prepared.analysis().forward(&prepared.x).expect("it runs");
        for made in
            [prepared.analysis().adjoint(&prepared.x, &forward), prepared.analysis().complex_step(&prepared.x, &forward)]
        {
            match made {
                Ok(_) => assert!(is_known),
                Err(error) => assert!(!is_known && error.to_string().contains("the design moves them apart"), "{error}"),
            }
        }
    }
}

/// A rod falls on both of its ends at once, and leaves with the speeds e1 v and e2 v there: its rate is v (e1 + e2) / 2 - g (T - t), its turn v (e1 - e2)
/// by its length. A design that moves the ends apart has no derivative.
#[test]
fn hits_at_once_that_act_on_each_other_have_one_impact() {
    let text = |more: &str, up: &str| {
        format!(
            r#"
version = 1
gravity = [0, 0, -10]
settings = {{ end = 0.6, steps = 30 }}
variable.h = {{ initial = 0.9, bounds = [0.1, 2], unit = "m" }}
variable.first = {{ initial = 0.6, bounds = [0, 1] }}
variable.second = {{ initial = 0.3, bounds = [0, 1] }}
{more}
body = [{{ name = "rod", position = [0, 0, "h"], mass = 1.5, inertia = [0.2, 0.2, 0.2] }}]
shape = [
    {{ name = "left", on = "rod", type = "sphere", centre = [-0.5, 0, "h"], radius = 0.1 }},
    {{ name = "right", on = "rod", type = "sphere", centre = [0.5, 0, "{up}"], radius = 0.1 }},
    {{ name = "floor", on = "ground", type = "plane", normal = [0, 0, 1] }},
]
contact = [
    {{ name = "of left", between = ["left", "floor"], restitution = "first" }},
    {{ name = "of right", between = ["right", "floor"], restitution = "second" }},
]
functional = [
    {{ name = "rate", type = "formula", nodes = {{ rod = "rod" }}, value = "rod.velocity.z", over = "terminal" }},
    {{ name = "turn", type = "formula", nodes = {{ rod = "rod" }}, value = "rod.angular_velocity.y", over = "terminal" }},
]
"#
        )
    };
    let [g, h, first, second, end] = [10.0_f64, 0.8, 0.6, 0.3, 0.6];
    let (fall, speed) = ((2.0 * h / g).sqrt(), (2.0 * g * h).sqrt());
    let (forward, rows) = ran(&parsed(&text("", "h")), &table("esdirk4"), 30);
    let (e, by_h) = (0.5 * (first + second), g / speed);
    let exact = [
        (e * speed - g * (end - fall), [e * by_h + by_h, 0.5 * speed, 0.5 * speed]),
        ((first - second) * speed, [(first - second) * by_h, speed, -speed]),
    ];
    for ((value, rates), (own, row)) in exact.iter().zip(forward.values.iter().zip(&rows)) {
        assert_near(*own, *value, 1e-12, "value");
        rates.iter().zip(row).for_each(|(rate, own)| assert_near(*own, *rate, 1e-11, "derivative"));
    }
    let apart = parsed(&text("variable.up = { initial = 0, bounds = [-0.1, 0.1], unit = \"m\" }", "h + up"));
    let prepared = Prepared::new(&apart).expect("it is sound");
    let forward = prepared.analysis().forward(&prepared.x).expect("it runs");
    for made in [prepared.analysis().adjoint(&prepared.x, &forward), prepared.analysis().complex_step(&prepared.x, &forward)]
    {
        let error = made.expect_err("ends come apart").to_string();
        assert!(error.contains("the design moves them apart"), "{error}");
    }
}
