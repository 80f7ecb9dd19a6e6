//! States of first order: controllers, actuators, what lags behind.

use super::{parsed, refused, runge_kutta};
use costate::integrators::Mode;
use costate::prelude::*;
use costate::scalar::Complex64;
use costate::scenes::{AnyScene, built_in};

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
type = "formula"
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

fn exponential<const N: usize>(a: [[f64; N]; N]) -> [[f64; N]; N] {
    let product = |a: &[[f64; N]; N], b: &[[f64; N]; N]| -> [[f64; N]; N] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let mut term: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
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

#[derive(Hash)]
struct Control;
impl Element for Control {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::States(2)]
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

#[derive(Hash)]
struct Actuator;
impl Element for Actuator {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::States(2)]
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, force: &mut [S]) {
        force[0] += v[4] - 3.0 - v[0] * 4.0;
    }
}

#[derive(Hash)]
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

/// With a spring that pulls the block back to where it starts, a motion from equilibrium, of which place and thrust are measured.
fn from_rest() -> String {
    let spring = "[[spring]]\nname = \"back\"\ntype = \"line\"\nbetween = [\"ground\", \"block\"]\npoints = [[-1, 0, 0], [0, 0, 0]]\n\
                  stiffness = 10\nrest_length = 1\n[settings]\nstart = \"equilibrium\"";
    let [measured, settings] = ["[[functional]]\nname = \"work\"", "[settings]"].map(|part| CONTROLLED.find(part).unwrap());
    [&CONTROLLED[..measured], spring, &CONTROLLED[settings + "[settings]".len()..]].concat()
}

#[test]
fn an_equilibrium_at_the_start_is_one_of_states_too() {
    // the integral brings the block to its target, by a thrust against spring and constant load
    let text = from_rest().replace("over = \"terminal\"", "over = \"initial\"");
    let (values, gradient) = run(&parsed(&text));
    assert!((values[0] - 0.3).abs() < 1e-12 && (values[1] - 6.0).abs() < 1e-11, "{values:?}");
    let exact = [[0.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0, 10.0]];
    assert!((0..2).all(|k| largest_difference(&exact[k], &gradient[k]) < 1e-12), "{gradient:?}");
    // held, or with a rate that nothing at rest changes, they stay as they are given: the thrust of the start
    let held = text.replacen("[[functional]]", "[[hold]]\nnodes = [\"control\"]\n[[functional]]", 1);
    let by_rates = text.replace("target - block.position.x\" }", "block.velocity.x\" }").replace(
        "(kp * (target - block.position.x) + ki * sum - kd * block.velocity.x - thrust) / lag",
        "-kd * block.velocity.x",
    );
    for text in [held, by_rates] {
        let (values, gradient) = run(&parsed(&text));
        assert!((values[0] - 0.1).abs() < 1e-12 && (values[1] - 4.0).abs() < 1e-14, "{values:?}");
        assert!((gradient[0][0] - 0.01).abs() < 1e-14, "{gradient:?}");
    }
    // what nothing reads is measured alone, and goes on from there
    let counted = text
        .replace("initial = { sum = 0,", "initial = { sum = 0, counted = 7,")
        .replace("rate = {", "rate = { counted = 1,");
    assert!((run(&parsed(&counted)).0[1] - 6.0).abs() < 1e-11);
    // what is read must rest
    let clock = counted.replace("c.thrust - 3", "c.thrust - 3 - 0.1 * c.counted");
    let scene = parsed(&clock);
    let told = Prepared::new(&scene).and_then(|own| own.analysis().forward(&own.x).map(drop)).expect_err("a clock rests");
    assert!(told.to_string().contains("never rests: its rate there is 1"), "{told}");
}

#[test]
fn statics_find_states_with_places() {
    let text = from_rest().replace("start = \"equilibrium\"\nend = 1.5\nsteps = 600", "method = \"static\"\nsteps = 4");
    let (values, gradient) = run(&parsed(&text));
    assert!((values[0] - 0.3).abs() < 1e-12 && (values[1] - 6.0).abs() < 1e-11, "{values:?}");
    assert!(largest_difference(&[0.0, 0.0, 0.0, 0.0, 10.0], &gradient[1]) < 1e-12, "{gradient:?}");
}

/// A mass m on a spring k with a damper c, and a state a' = (30 x' + push - a) / T that brakes it.
fn braked(push: &str, more: &str) -> String {
    format!(
        r#"
version = 1
[variable]
k = {{ initial = 100, bounds = [1, 1000], unit = "N/m" }}
push = {{ initial = 3, bounds = [0, 10], unit = "N" }}
[settings]
end = 0.1
steps = 10
[[point]]
name = "p"
position = [0, 0, 0]
mass = 2
[[joint]]
name = "rail"
type = "point_on_line"
between = ["ground", "p"]
axis = [1, 0, 0]
[[spring]]
name = "s"
type = "slide"
between = ["ground", "p"]
axis = [1, 0, 0]
stiffness = "k"
damping = 1
[[state]]
name = "a"
type = "lag"
nodes = {{ p = "p" }}
input = "30 * p.velocity.x + {push}"
time_constant = 0.05
initial = "{push}"
[[element]]
name = "e"
nodes = {{ p = "p", a = "a" }}
force = {{ p = "[{push} - a.value, 0, 0]" }}
[[functional]]
name = "a"
type = "formula"
nodes = {{ a = "a" }}
value = "a.value"
unit = "N"
over = "terminal"
{more}"#
    )
}

#[test]
fn modes_beside_states_have_the_derivatives_of_the_roots() {
    for push in ["0", "3", "push"] {
        let scene = parsed(&braked(push, ""));
        let prepared = Prepared::new(&scene).unwrap();
        let own = prepared.modes_with_gradients(4, true).unwrap_or_else(|why| panic!("{push}: {why}"));
        assert_eq!(own.modes.len(), 2, "{push}: of three roots one is real: {:?}", own.modes);
        for (mode, gradient) in own.modes.iter().zip(&own.gradients) {
            // (2 x^2 + x + k) (0.05 x + 1) + 30 x = 0
            let x = Complex64::new(mode.growth, mode.frequency);
            let left = (x * x * 2.0 + x + 100.0) * (x * 0.05 + 1.0) + x * 30.0;
            assert!(left.norm() < 1e-9 * 100.0, "{push}: {x}: {left}");
            let slope = (x * 4.0 + 1.0) * (x * 0.05 + 1.0) + (x * x * 2.0 + x + 100.0) * 0.05 + 30.0;
            let (expected, gradient) = (-(x * 0.05 + 1.0) / slope, gradient.as_ref().unwrap());
            let rates = [0, 1].map(|variable| Complex64::new(gradient.growth[variable], gradient.frequency[variable]));
            assert!((rates[0] - expected).norm() < 1e-11 * expected.norm(), "{push}: {rates:?} {expected}");
            assert!(rates[1].norm() < 1e-12, "{push}: {rates:?}");
        }
        // states stay where they are in a vibration without damping
        let undamped = prepared.modes_with_gradients(4, false).unwrap();
        let omega = 50_f64.sqrt();
        assert_eq!(undamped.modes.len(), 1, "{push}");
        assert!((undamped.modes[0].frequency - omega).abs() < 1e-12 * omega, "{push}: {:?}", undamped.modes);
        let rate = undamped.gradients[0].as_ref().unwrap().frequency[0];
        assert!((rate - 0.25 / omega).abs() < 1e-12, "{push}: {rate}");
    }
}

#[test]
fn modes_about_an_equilibrium_follow_its_states() {
    // a pendulum between springs whose rest angle a state is: omega^2 depends on the angle, and the angle on the gain
    let text = |statics: bool| {
        let settings =
            if statics { "method = \"static\"\nsteps = 3" } else { "start = \"equilibrium\"\nend = 0.1\nsteps = 10" };
        format!(
            r#"
version = 1
gravity = [0, 0, -9.81]
[variable]
gain = {{ initial = 1.5, bounds = [0.1, 5] }}
load = {{ initial = 4, bounds = [0, 10], unit = "N" }}
[settings]
{settings}
[[point]]
name = "bob"
position = [0, 0, -1]
mass = 2
[[joint]]
name = "rod"
type = "distance"
between = ["ground", "bob"]
points = [[0, 0, 0], [0, 0, -1]]
[[spring]]
name = "across"
type = "slide"
between = ["ground", "bob"]
axis = [0, 1, 0]
stiffness = 7
[[state]]
name = "wind"
type = "lag"
nodes = {{ bob = "bob" }}
input = "gain * (load + bob.position.x - 3 * bob.velocity.x)"
time_constant = 0.2
[[element]]
name = "wind"
nodes = {{ bob = "bob", wind = "wind" }}
force = {{ bob = "[wind.value, 0, 0]" }}
[[functional]]
name = "x"
type = "position"
on = "bob"
direction = [1, 0, 0]
over = "terminal"
"#
        )
    };
    for (statics, damped) in [(false, true), (false, false), (true, true), (true, false)] {
        let scene = parsed(&text(statics));
        let modes = |x: &[f64]| {
            let settings = scene.settings();
            let prepared = Prepared::with(&scene, x, Prepared::method_of(&settings).unwrap(), settings).unwrap();
            prepared.modes_with_gradients(4, damped).unwrap_or_else(|why| panic!("{statics} {damped}: {why}"))
        };
        let x = [1.5, 4.0];
        let own = modes(&x);
        for variable in 0..2 {
            let at = |share: f64| {
                let mut moved = x;
                moved[variable] *= 1.0 + share;
                modes(&moved).modes
            };
            let near = [1e-3, -1e-3, 2e-3, -2e-3].map(at);
            for (place, gradient) in own.gradients.iter().enumerate() {
                let gradient = gradient.as_ref().unwrap();
                for (rate, of) in [
                    (gradient.growth[variable], (|mode: &Mode| mode.growth) as fn(&Mode) -> f64),
                    (gradient.frequency[variable], (|mode: &Mode| mode.frequency) as fn(&Mode) -> f64),
                ] {
                    let [a, b, c, d] = near.each_ref().map(|modes| of(&modes[place]));
                    let quotient = (8.0 * (a - b) - (c - d)) / (12e-3 * x[variable]);
                    assert!((rate - quotient).abs() < 1e-8, "{statics} {damped} {place} {variable}: {rate} {quotient}");
                }
            }
        }
    }
}

#[test]
fn responses_beside_states_are_those_of_the_transfer_function() {
    for push in ["push", "(0.5 * push + 1.5)"] {
        let scene = parsed(&braked(push, ""));
        let prepared = Prepared::new(&scene).unwrap();
        let share = if push == "push" { 1.0 } else { 0.5 };
        for omega in [0.0, 1.0, 7.0, 40.0] {
            // m x'' + c x' + k x = share - a, T a' + a = share + 30 x'
            let s = Complex64::new(0.0, omega);
            let (own, lag) = (s * s * 2.0 + s + 100.0, s * 0.05 + 1.0);
            let x = (lag * share - share) / (own * lag + s * 30.0);
            let expected = (s * 30.0 * x + share) / lag;
            let [re, im] = prepared.frequency_response("push", &[omega]).unwrap_or_else(|why| panic!("{why}"))[0][0];
            let found = Complex64::new(re, im);
            assert!((found - expected).norm() < 1e-12, "{push} {omega}: {found} {expected}");
        }
    }
}

#[test]
fn states_have_neither_power_nor_energy() {
    let more = "[[functional]]\nname = \"work\"\ntype = \"power\"\nover = \"integral\"\n\
                [[functional]]\nname = \"energy\"\ntype = \"energy\"\nover = \"terminal\"\n";
    for method in ["variational", "generalized-alpha:0.8", "esdirk4", "bdf2"] {
        // a state that acts on nothing: what is left is a damped mass
        let text = braked("3", more)
            .replace("[3 - a.value, 0, 0]", "[0 * a.value, 0, 0]")
            .replace("position = [0, 0, 0]", "position = [0, 0, 0]\nvelocity = [1, 0, 0]")
            .replace("end = 0.1\nsteps = 10", &format!("end = 1\nsteps = 800\nmethod = \"{method}\""));
        let (values, _) = run(&parsed(&text));
        let (delta, omega) = (0.25_f64, (50.0 - 0.0625_f64).sqrt());
        let (x, v) = ((-delta).exp() * omega.sin() / omega, (-delta).exp() * (omega.cos() - delta / omega * omega.sin()));
        let energy = v * v + 50.0 * x * x;
        assert!(
            (values[2] - energy).abs() < 1e-3 && (values[1] - (energy - 1.0)).abs() < 1e-3,
            "{method}: {values:?} {energy}"
        );
    }
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
        ("initial = { sum", "initial = { block", "\"block\" is a name here already"),
        ("initial = { sum", "initial = { sin", "\"sin\" means a function"),
        ("c.thrust - 3", "c.trust - 3", "c.sum, c.thrust"),
        ("force = { block", "force = { c", "\"c\" is a state: its own section says how it changes"),
        ("initial = { sum", "output = { sum = 1 }\ninitial = { sum", "\"sum\" is a value of this state"),
        ("initial = { sum", "output = { \"2\" = 1 }\ninitial = { sum", "\"2\" cannot be used in formulas"),
        ("initial = { sum", "output = { more = \"block.speed\" }\ninitial = { sum", "of which formulas know block.position"),
    ] {
        assert!(CONTROLLED.contains(from), "{from}");
        let text = CONTROLLED.replace(from, to);
        let told = refused(&text);
        assert!(told.contains(part), "{to}: {told}");
    }
}

#[test]
fn the_controlled_arm_moves_as_its_equations_say() {
    let (values, _) = run(built_in::named("controlled-arm").unwrap());
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

/// A mass on a rail with a spring of 8 N/m, and more.
fn sprung(more: &str) -> String {
    format!(
        r#"
version = 1
[variable]
kp = {{ initial = 40, bounds = [1, 100], unit = "N/m" }}
ki = {{ initial = 25, bounds = [0, 100], unit = "N/(m s)" }}
kd = {{ initial = 12, bounds = [0, 100], unit = "N s/m" }}
lag = {{ initial = 0.05, bounds = [-1, 1], unit = "s" }}
target = {{ initial = 0.3, bounds = [0, 1], unit = "m" }}
[[point]]
name = "block"
position = [0.1, 0, 0]
mass = 2
[[joint]]
name = "rail"
type = "point_on_line"
between = ["ground", "block"]
axis = [1, 0, 0]
[[element]]
name = "spring"
nodes = {{ block = "block" }}
potential = "4 * block.position.x^2"
[[functional]]
name = "x"
type = "position"
on = "block"
direction = [1, 0, 0]
over = "terminal"
[settings]
end = 1.5
steps = 800
{more}"#
    )
}

/// A functional of a state called c at the end.
fn of_state(value: &str) -> String {
    format!(
        "[[functional]]\nname = \"{value}\"\ntype = \"formula\"\nnodes = {{ c = \"control\" }}\nvalue = \"{value}\"\nover = \"terminal\"\n"
    )
}

const PID: &str = r#"
[[state]]
name = "control"
type = "pid"
nodes = { block = "block" }
measured = "block.position.x"
set_point = "target"
proportional = "kp"
integral = "ki"
derivative = "kd"
filter_time = "lag"
initial = "0.1 * kp"
initial_error = "target - 0.1"
"#;
const ACTUATOR: &str = "[[element]]\nname = \"actuator\"\nnodes = { block = \"block\", c = \"control\" }\nforce = { block = \"[c.output, 0, 0]\" }\n";

#[test]
fn a_lag_answers_a_step_by_an_exponential() {
    let lag =
        "[[state]]\nname = \"control\"\ntype = \"lag\"\ninput = \"target\"\ntime_constant = \"4 * lag\"\ngain = \"kp\"\n";
    let text = sprung(&[lag, &of_state("c.value"), &of_state("c.rate")].concat());
    let ((gain, constant, target), end) = ((40.0, 0.2, 0.3), 1.5_f64);
    let left = (-end / constant).exp();
    for (initial, text) in [(0.0, text.clone()), (2.0, text.replace("\ngain", "\ninitial = \"target / 0.15\"\ngain"))] {
        let (values, gradient) = run(&parsed(&text));
        let exact = gain * target * (1.0 - left) + initial * left;
        let [slow, rate] = [values[1], values[2]];
        assert!((slow - exact).abs() < 1e-10 * gain, "{slow} for {exact}");
        assert!((rate - (gain * target - exact) / constant).abs() < 1e-9 * gain, "{rate}");
        // by the gain, and by the time constant
        assert!((gradient[1][0] - target * (1.0 - left)).abs() < 1e-10, "{gradient:?}");
        let slope = (initial - gain * target) * left * end / constant / constant * 4.0;
        assert!((gradient[1][3] - slope).abs() < 1e-7 * gain, "{gradient:?} {slope}");
    }
}

#[test]
fn a_pid_controller_moves_a_mass_as_the_exponential_of_its_matrix_says() {
    let own = [PID, ACTUATOR, &of_state("c.output"), &of_state("c.integral_term")].concat();
    let (values, gradient) = run(&parsed(&sprung(&own)));
    // x, velocity, the integral term, the filtered error, 1
    let exact = |x: &[f64; 5]| {
        let &[kp, ki, kd, lag, target] = x;
        let output = [-kp - kd / lag, 0.0, 1.0, -kd / lag, (kp + kd / lag) * target];
        let rows = [
            [0.0, 1.0, 0.0, 0.0, 0.0],
            [0.5 * output[0] - 4.0, 0.0, 0.5 * output[2], 0.5 * output[3], 0.5 * output[4]],
            [-ki, 0.0, 0.0, 0.0, ki * target],
            [-1.0 / lag, 0.0, 0.0, -1.0 / lag, target / lag],
            [0.0; 5],
        ];
        let mut power = exponential(rows.map(|row| row.map(|entry| entry * 1.5 / 1024.0)));
        for _ in 0..10 {
            power = std::array::from_fn(|i| std::array::from_fn(|j| (0..5).map(|k| power[i][k] * power[k][j]).sum()));
        }
        let start = [0.1, 0.0, 0.1 * kp, target - 0.1, 1.0];
        let end: [f64; 5] = power.map(|row| row.iter().zip(&start).map(|(a, y)| a * y).sum());
        [end[0], output.iter().zip(&end).map(|(a, y)| a * y).sum(), end[2]]
    };
    let x = [40.0, 25.0, 12.0, 0.05, 0.3];
    let wanted = exact(&x);
    for k in 0..3 {
        let apart = (values[k] - wanted[k]).abs() / wanted[k].abs();
        assert!(apart < 1e-9, "{k}: {apart:e}, {values:?} for {wanted:?}");
        for variable in 0..5 {
            let at = |factor: f64| exact(&std::array::from_fn(|i| if i == variable { x[i] * factor } else { x[i] }))[k];
            let slope = (8.0 * (at(1.001) - at(0.999)) - (at(1.002) - at(0.998))) / (0.012 * x[variable]);
            let entry = gradient[k][variable];
            assert!((entry - slope).abs() < 1e-7 * slope.abs().max(1e-2), "{k} {variable}: {entry} for {slope}");
        }
    }
}

#[test]
fn entries_of_states_are_what_a_file_writes_of_them() {
    let error = "(target - block.position.x)";
    let derivative = format!("({error} - slow) / lag");
    let output = format!("kp * {error} + term + kd * ({derivative})");
    let written = format!(
        "[[state]]\nname = \"control\"\ntype = \"formula\"\nnodes = {{ block = \"block\" }}\n\
         initial = {{ term = \"0.1 * kp\", slow = \"target - 0.1\" }}\nrate = {{ term = \"ki * {error}\", slow = \"{derivative}\" }}\n"
    );
    let inline = "[[element]]\nname = \"actuator\"\nnodes = { block = \"block\", c = \"control\" }\nforce = { block = \"[OUTPUT, 0, 0]\" }\n"
        .replace("OUTPUT", &output.replace("term", "c.term").replace("slow", "c.slow"));
    let by_output = format!("{written}output = {{ output = \"{output}\" }}\n");
    let [entry, by_hand, by_output] = [[PID, ACTUATOR], [&written, &inline], [&by_output, ACTUATOR]]
        .map(|own| run(&parsed(&sprung(&own.concat()).replace("steps = 800", "steps = 50"))));
    assert_eq!(entry, by_hand);
    assert_eq!(entry, by_output);
}

#[test]
fn outputs_may_depend_on_outputs_and_on_points_of_nodes() {
    let more = r#"
[[body]]
name = "wheel"
position = [0, 0, 1]
angular_velocity = [0, 2, 0]
mass = 1
inertia = [0.1, 0.1, 0.1]
[[state]]
name = "sensor"
type = "formula"
nodes = { tip = { on = "wheel", point = [0, 0, 1.5] }, block = "block" }
initial = { far = 0 }
rate = { far = "(way.x - far) / lag" }
define = { way = "tip.position - block.position" }
output = { pull = "kp * (way + [far, 0, 0])" }
[[state]]
name = "control"
type = "formula"
nodes = { s = "sensor", block = "block" }
initial = { slow = 0 }
rate = { slow = "s.pull.x - slow" }
output = { force = "0.1 * s.pull - 3 * slow * unit(s.pull) - 2 * block.velocity" }
"#;
    let functional = |nodes: &str, value: &str| {
        format!(
            "[[functional]]\nname = \"{value}\"\ntype = \"formula\"\nnodes = {nodes}\nvalue = \"{value}\"\nover = \"terminal\"\n"
        )
    };
    let by_output =
        "[[element]]\nname = \"act\"\nnodes = { c = \"control\", mass = \"block\" }\nforce = { mass = \"c.force\" }\n";
    let nodes = "{ block = \"block\", tip = { on = \"wheel\", point = [0, 0, 1.5] }, s = \"sensor\", c = \"control\" }";
    let pull = "(kp * (tip.position - block.position + [s.far, 0, 0]))";
    let force = format!("0.1 * {pull} - 3 * c.slow * unit({pull}) - 2 * block.velocity");
    let inline = format!("[[element]]\nname = \"act\"\nnodes = {nodes}\nforce = {{ block = \"{force}\" }}\n");
    let texts = [
        [more, by_output, &functional("{ c = \"control\" }", "norm(c.force)")].concat(),
        [more, &inline, &functional(nodes, &format!("norm({force})"))].concat(),
    ];
    let [own, twin] = texts.map(|text| run(&parsed(&sprung(&text))));
    for k in 0..2 {
        assert!((own.0[k] - twin.0[k]).abs() < 1e-12 * twin.0[k].abs(), "{own:?} {twin:?}");
        assert!(largest_difference(&own.1[k], &twin.1[k]) < 1e-11, "{own:?} {twin:?}");
    }
}

#[test]
fn a_controller_at_its_limits_does_not_wind_up() {
    let limited = format!("{PID}least = -1.5\nmost = \"0.1 * kp\"\ntracking_time = 0.2\n")
        .replace("initial = \"0.1 * kp\"", "initial = 0")
        .replace("\"target\"", "\"3 * target\"")
        .replace("target - 0.1", "3 * target - 0.1");
    let functionals = [of_state("c.output"), of_state("c.integral_term")].concat();
    let motion = |most: f64| {
        let (kp, ki, kd, lag, target) = (40.0, 25.0, 12.0, 0.05, 0.9);
        let free = move |[x, _, term, slow]: [f64; 4]| kp * (target - x) + term + kd * (target - x - slow) / lag;
        let slope = move |_: f64, y: [f64; 4]| {
            let [x, v, term, slow] = y;
            let error = target - x;
            let output = free([x, v, term, slow]).clamp(-1.5, most);
            [v, (output - 8.0 * x) / 2.0, ki * error + (output - free(y)) / 0.2, (error - slow) / lag]
        };
        let end = runge_kutta::integrated([0.1, 0.0, 0.0, target - 0.1], (150_000, 1e-5), slope);
        [end[0], free(end).clamp(-1.5, most), end[2]]
    };
    for (most, text) in [(4.0, limited.clone()), (9.0, limited.replace("0.1 * kp", "9 + 0 * kp"))] {
        let (values, _) = run(&parsed(&sprung(&[&text, ACTUATOR, &functionals].concat())));
        let wanted = motion(most);
        for k in 0..3 {
            // a limit is left within a step, where the method has a lower order
            assert!((values[k] - wanted[k]).abs() < 5e-5 * wanted[k].abs().max(1.0), "{most}: {values:?} for {wanted:?}");
        }
    }
}

#[test]
fn what_is_wrong_with_entries_of_states_is_told() {
    let lag = "[[state]]\nname = \"slow\"\ntype = \"lag\"\nnodes = { block = \"block\" }\ninput = \"block.velocity.x\"\ntime_constant = 0.1\n";
    let fine = [PID, lag, ACTUATOR].concat();
    for (from, to, part) in [
        (
            "time_constant = 0.1",
            "time_constant = -0.1",
            "time_constant of [[state]] \"slow\" is -0.1; it must be greater than 0",
        ),
        (
            "time_constant = 0.1",
            "time_constant = \"-2 * lag\"",
            "time_constant: at this design the value is -0.1; it must be greater than 0",
        ),
        (
            "time_constant = 0.1",
            "time_constant = \"block.position.x\"",
            "time_constant must be a number of the design alone",
        ),
        ("time_constant = 0.1", "", "[[state]] \"slow\" needs the key time_constant: T"),
        ("time_constant = 0.1", "time_constant = 0.1\ngian = 2", "did you mean \"gain\""),
        ("time_constant = 0.1", "time_constant = 0.1\ninitial = \"slow.value\"", "name \"slow\" is not known"),
        ("input = \"block.velocity.x\"", "input = \"block.velocity\"", "must be a number"),
        ("type = \"lag\"", "", "needs the key type: one of formula, lag, pid"),
        ("filter_time = \"lag\"\n", "", "derivative needs one of filter_time and error_rate"),
        ("derivative = \"kd\"\n", "", "derivative needs one of filter_time and error_rate, and these need it"),
        ("filter_time = \"lag\"", "error_rate = 0", "initial_error is a start of the filter"),
        ("filter_time = \"lag\"", "filter_time = \"lag\"\nmost = 3", "limits least and most need tracking_time"),
        (
            "c.output",
            "c.outptu",
            "\"c\" is a node, of which formulas know c.integral_term, c.filtered_error, c.output, c.error",
        ),
        (
            "nodes = { block = \"block\" }\ninput",
            "nodes = { s = \"other\" }\ninput = \"s.out\" #",
            "needs itself to be there: ",
        ),
    ] {
        assert!(fine.contains(from), "{from}");
        let circle = "[[state]]\nname = \"other\"\ntype = \"formula\"\nnodes = { s = \"slow\" }\ninitial = { z = 0 }\nrate = { z = \"s.rate\" }\noutput = { out = \"s.rate\" }\n";
        let text = sprung(&[&fine.replacen(from, to, 1), circle].concat());
        let told = refused(&text);
        assert!(told.contains(part), "{to}: {told}");
    }
}
