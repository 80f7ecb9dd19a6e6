//! States of first order: controllers, actuators, what lags behind.

use super::runge_kutta;
use costate::prelude::*;
use costate::scenes::FileScene;

/// A mass on a rail that a controller with an integral and a lagging actuator brings to a target.
const CONTROLLED: &str = r#"
version = 1
[variable]
kp = { initial = 40, bounds = [1, 100], unit = "N/m" }
ki = { initial = 25, bounds = [0, 100], unit = "N/(m s)" }
kd = { initial = 12, bounds = [0, 100], unit = "N s/m" }
lag = { initial = 0.05, bounds = [0.01, 1], unit = "s" }
target = { initial = 0.3, bounds = [0, 1], unit = "m" }
[[point]]
name = "block"
position = [0, 0, 0]
mass = 2
[[joint]]
name = "rail"
type = "point_on_line"
between = ["ground", "block"]
axis = [1, 0, 0]
[[state]]
name = "control"
nodes = { block = "block" }
initial = { sum = 0, thrust = "0.1 * kp" }
rate = { thrust = "(kp * (target - block.position.x) + ki * sum - kd * block.velocity.x - thrust) / lag", sum = "target - block.position.x" }
[[element]]
name = "actuator"
nodes = { block = "block", c = "control" }
force = { block = "[c.thrust - 3 - 4 * block.velocity.x, 0, 0]" }
[[functional]]
name = "x"
type = "position"
on = "block"
direction = [1, 0, 0]
over = "terminal"
[[functional]]
name = "thrust"
type = "formula"
nodes = { c = "control" }
value = "c.thrust"
unit = "N"
over = "terminal"
[[functional]]
name = "work"
type = "formula"
nodes = { block = "block", c = "control" }
value = "c.thrust * block.velocity.x"
unit = "W"
over = "integral"
[settings]
end = 1.5
steps = 600
"#;

/// x, velocity, sum, thrust and work at the end: a linear system y' = A y + b, by the exponential of [A, b; 0, 0] t, halved and squared; the work by
/// Simpson's rule.
fn exact(x: &[f64]) -> [f64; 3] {
    let &[kp, ki, kd, lag, target] = x else { panic!("5 variables") };
    let rows = [
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, -2.0, 0.0, 0.5, -1.5],
        [-1.0, 0.0, 0.0, 0.0, target],
        [-kp / lag, -kd / lag, ki / lag, -1.0 / lag, kp * target / lag],
        [0.0; 5],
    ];
    const PARTS: usize = 4096;
    let step = exponential(rows.map(|row| row.map(|entry| entry * 1.5 / PARTS as f64)));
    let (mut y, mut work) = ([0.0, 0.0, 0.0, 0.1 * kp, 1.0], 0.0);
    for part in 0..=PARTS {
        let weight = if part == 0 || part == PARTS { 1.0 } else { 2.0 + 2.0 * (part % 2) as f64 };
        work += weight * y[3] * y[1] * 1.5 / PARTS as f64 / 3.0;
        if part < PARTS {
            y = step.map(|row| row.iter().zip(&y).map(|(a, y)| a * y).sum());
        }
    }
    [y[0], y[3], work]
}

fn exponential(a: [[f64; 5]; 5]) -> [[f64; 5]; 5] {
    let product = |a: &[[f64; 5]; 5], b: &[[f64; 5]; 5]| -> [[f64; 5]; 5] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..5).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let mut term: [[f64; 5]; 5] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut sum = term;
    for n in 1..20 {
        term = product(&term, &a).map(|row| row.map(|entry| entry / n as f64));
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    sum
}

fn run(scene: &dyn costate::scenes::AnyScene) -> (Vec<f64>, Vec<Vec<f64>>) {
    let prepared = Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"));
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap().rows;
    let other = analysis.complex_step(&prepared.x, &forward).unwrap().rows;
    for (own, other) in gradient.iter().zip(&other) {
        let apart = largest_difference(other, own);
        assert!(apart < 1e-12, "{apart:e}");
    }
    (forward.values, gradient)
}

fn parsed(text: &str) -> FileScene {
    FileScene::parse("states.toml", text).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn a_controlled_mass_moves_as_the_exponential_of_its_matrix_says() {
    let scene = parsed(CONTROLLED);
    let (values, gradient) = run(&scene);
    let x = [40.0, 25.0, 12.0, 0.05, 0.3];
    let own = exact(&x);
    for (k, value) in values.iter().enumerate() {
        assert!((value - own[k]).abs() < 1e-8 * own[k].abs().max(0.1), "{values:?} for {own:?}");
        for variable in 0..5 {
            let at = |factor: f64| {
                let mut x = x;
                x[variable] *= factor;
                exact(&x)[k]
            };
            let slope = (8.0 * (at(1.001) - at(0.999)) - (at(1.002) - at(0.998))) / (0.012 * x[variable]);
            let entry = gradient[k][variable];
            assert!((entry - slope).abs() < 1e-6 * slope.abs().max(1e-3), "{k} {variable}: {entry} for {slope}");
        }
    }
}

#[test]
fn other_methods_take_it_too() {
    let own = exact(&[40.0, 25.0, 12.0, 0.05, 0.3]);
    for (method, limit) in [("variational", 1e-4), ("generalized-alpha:0.8", 1e-4), ("bdf2", 1e-3)] {
        let (values, _) = run(&parsed(&CONTROLLED.replace("steps = 600", &format!("steps = 600\nmethod = \"{method}\""))));
        for k in 0..3 {
            assert!((values[k] - own[k]).abs() < limit * own[k].abs().max(0.1), "{method}: {values:?} for {own:?}");
        }
    }
}

/// The same in Rust.
struct Twin;

struct Control;
impl Element for Control {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::Coordinates(2)]
    }
    fn parameters(&self) -> Vec<Parameter> {
        ["kp", "ki", "kd", "lag", "target"].map(|name| Parameter::new(name, "-")).to_vec()
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let [kp, ki, kd, lag, target] = p else { unreachable!() };
        r[3] += s.a[3] - (*target - s.q[0]);
        r[4] += s.a[4] - (*kp * (*target - s.q[0]) + *ki * s.v[3] - *kd * s.v[0] - s.v[4]) / *lag;
    }
}

struct Actuator;
impl Element for Actuator {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::Coordinates(2)]
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, force: &mut [S]) {
        force[0] += v[4] - 3.0 - v[0] * 4.0;
    }
}

struct Thrust;
impl Quantity for Thrust {
    fn dofs(&self) -> usize {
        2
    }
    fn unit(&self) -> &'static str {
        "N"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.v[1]
    }
}

impl Scene for Twin {
    fn name(&self) -> String {
        "twin".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("kp", 40.0), ("ki", 25.0), ("kd", 12.0), ("lag", 0.05), ("target", 0.3)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.0, 100.0), "-"))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.5, 600)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (ground, block) = (m.ground(), m.point("block", Vector3::zeros()));
        m.point_mass("block", block, S::from(2.0));
        m.point_on_line("rail", [ground, block], Vector3::zeros(), Vector3::from_f64([1.0, 0.0, 0.0]));
        let control = m.states("control", &[S::zero(), x[0] * 0.1]);
        m.element("rates", &[block, control], Control, x);
        m.element("actuator", &[block, control], Actuator, &[]);
        m.position_functional("x", Over::Terminal, block, Vector3::zeros(), Vector3::from_f64([1.0, 0.0, 0.0]));
        m.functional("thrust", Over::Terminal, (&[control], &[]), Thrust, &[]);
        Ok(())
    }
}

#[test]
fn it_is_what_a_program_makes_of_the_same_equations() {
    let ((own, rows), (twin, twin_rows)) = (run(&parsed(CONTROLLED)), run(&Twin));
    for k in 0..2 {
        assert!((own[k] - twin[k]).abs() <= 1e-14 * twin[k].abs(), "{own:?} {twin:?}");
        assert!(largest_difference(&rows[k], &twin_rows[k]) < 1e-12, "{rows:?} {twin_rows:?}");
    }
}

#[test]
fn a_motion_from_equilibrium_leaves_states_as_they_are_given() {
    // the thrust of the start holds the block against the spring that pulls it back
    let text = CONTROLLED
        .replace("[settings]", "[[spring]]\nname = \"back\"\ntype = \"line\"\nbetween = [\"ground\", \"block\"]\npoints = [[-1, 0, 0], [0, 0, 0]]\nstiffness = 10\nrest_length = 1\n[settings]\nstart = \"equilibrium\"")
        .replace("over = \"terminal\"", "over = \"initial\"");
    let (values, gradient) = run(&parsed(&text));
    assert!((values[0] - 0.1).abs() < 1e-12 && (values[1] - 4.0).abs() < 1e-14, "{values:?}");
    assert!((gradient[0][0] - 0.01).abs() < 1e-14, "{gradient:?}");
}

#[test]
fn what_is_wrong_with_a_state_is_told() {
    for (from, to, part) in [
        ("initial = { sum = 0,", "initial = { sum = 0, more = 1,", "more has a start, but no rate"),
        ("sum = \"target - block.position.x\" }", "sum = 1, less = 2 }", "less has a rate, but no start"),
        (
            "thrust = \"0.1 * kp\"",
            "thrust = \"0.1 * block.position.x\"",
            "the start of thrust must be a number of the design alone",
        ),
        ("sum = 0", "sum = [0, 0, 0]", "the start of sum must be a number"),
        ("initial = { sum", "initial = { kp", "\"kp\" is a name of this file, too"),
        ("initial = { sum", "initial = { sin", "\"sin\" means a function"),
        ("c.thrust - 3", "c.trust - 3", "c.sum, c.thrust"),
        ("force = { block", "force = { c", "\"c\" is a state: its own section says how it changes"),
        ("sum = \"target - block.position.x\" }", "sum = \"abs(sin(t))\" }", "give breakpoints"),
    ] {
        assert!(CONTROLLED.contains(from), "{from}");
        let text = CONTROLLED.replace(from, to);
        let told = match FileScene::parse("states.toml", &text) {
            Ok(scene) => Prepared::new(&scene).map(drop).expect_err(to).to_string(),
            Err(why) => why,
        };
        assert!(told.contains(part), "{to}: {told}");
    }
}

#[test]
fn the_controlled_arm_moves_as_its_equations_say() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes/controlled-arm.toml");
    let scene = FileScene::read(&path).unwrap_or_else(|why| panic!("{why}"));
    let (values, _) = run(&scene);
    let (kp, ki, kd, target, rise, lag) = (60.0, 80.0, 8.0, std::f64::consts::FRAC_PI_3, 0.3, 0.02);
    let (inertia, weight) = ((1.2 / 3.0 + 0.5) * 0.64, (1.2 * 0.4 + 0.5 * 0.8) * 9.81);
    let slope = |_: f64, [angle, rate, command, sum, torque, _]: [f64; 6]| {
        let of_command = (target - command) / rise;
        let wanted = kp * (command - angle) + ki * sum + kd * (of_command - rate);
        let turning = (torque - weight * angle.sin()) / inertia;
        [rate, turning, of_command, command - angle, (wanted - torque) / lag, (angle - target).powi(2)]
    };
    let end = runge_kutta::integrated([0.0; 6], (25_000, 1e-4), slope);
    assert!((values[2] - end[0]).abs() < 1e-7 && (values[0] - end[5]).abs() < 1e-7, "{values:?} {end:?}");
}
