//! Springs and dampers by laws of one's own.

use super::{parsed, refused, runge_kutta};
use costate::scenes::{FileScene, Prepared, built_in};

/// A mass on a line from the origin along x, at 0.5 m, that a spring holds.
fn text(spring: &str) -> String {
    format!(
        "version = 1\n[variable]\nk = {{ initial = 40, bounds = [1, 100], unit = \"N/m\" }}\n\
         [[point]]\nname = \"mass\"\nposition = [0.5, 0, 0]\nmass = 2\n\
         [[joint]]\nname = \"rail\"\ntype = \"point_on_line\"\nbetween = [\"ground\", \"mass\"]\naxis = [1, 0, 0]\n\
         {spring}\n\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"mass\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n\
         [settings]\nend = 0.8\nsteps = 400\n"
    )
}

fn law(keys: &str) -> String {
    text(&format!("[[spring]]\nname = \"spring\"\ntype = \"line_law\"\nbetween = [\"ground\", \"mass\"]\n{keys}"))
}

const ENERGY: &str = "\n[[functional]]\nname = \"energy\"\ntype = \"energy\"\nover = \"terminal\"\n";

/// Values at the end for a stiffness, and derivatives by it.
fn run(text: &str, k: f64) -> [Vec<f64>; 2] {
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&[k]).unwrap_or_else(|why| panic!("{why}"));
    let gradient = analysis.adjoint(&[k], &forward).unwrap_or_else(|why| panic!("{why}"));
    [forward.values, gradient.rows.iter().map(|row| row[0]).collect()]
}

/// x at the end of 2 x'' = -force(x - rest, x', t).
fn integrated(rest: f64, force: impl Fn(f64, f64, f64) -> f64) -> f64 {
    runge_kutta::integrated([0.5, 0.0], (8000, 1e-4), |t, [x, v]| [v, -force(x - rest, v, t) / 2.0])[0]
}

#[test]
fn a_law_gives_what_its_equation_does() {
    let hardening = law("rest_length = 0.3\nforce = \"k * s + 300 * s^3 + 3 * tanh(v / 0.5) + sin(7 * t)\"");
    let exact = |k: f64| integrated(0.3, |s, v, t| k * s + 300.0 * s.powi(3) + 3.0 * (v / 0.5).tanh() + (7.0 * t).sin());
    let [values, gradient] = run(&hardening, 40.0);
    assert!((values[0] - exact(40.0)).abs() < 1e-8, "{} for {}", values[0], exact(40.0));
    let quotient = (exact(40.0 + 1e-3) - exact(40.0 - 1e-3)) / 2e-3;
    assert!((gradient[0] - quotient).abs() < 1e-6 * quotient.abs(), "{} for {quotient}", gradient[0]);
}

#[test]
fn a_linear_law_is_the_linear_spring() {
    let spring = text(
        "[[spring]]\nname = \"spring\"\ntype = \"line\"\nbetween = [\"ground\", \"mass\"]\nstiffness = \"k\"\nrest_length = 0.3\n\
         [[damper]]\nname = \"damper\"\ntype = \"line\"\nbetween = [\"ground\", \"mass\"]\ndamping = 1.5\n[[functional]]\nname = \"energy\"\ntype = \"energy\"\nover = \"terminal\"",
    );
    let [own, by_slopes] = run(&spring, 40.0);
    for keys in ["force = \"1.5 * v\"\nenergy = \"k * s^2 / 2\"", "force = \"k * s + 1.5 * v\""] {
        let [values, gradient] =
            run(&law(&format!("rest_length = 0.3\n{keys}{}", if keys.contains("energy") { ENERGY } else { "" })), 40.0);
        let place = own.len() - 1;
        for (i, own_place) in (0..values.len()).zip(if values.len() == 2 { [0, 1] } else { [place, place] }) {
            assert!((values[i] - own[own_place]).abs() < 1e-12 * own[own_place].abs(), "{keys}: {values:?} for {own:?}");
            assert!(
                (gradient[i] - by_slopes[own_place]).abs() < 1e-10 * by_slopes[own_place].abs(),
                "{keys}: {gradient:?} for {by_slopes:?}"
            );
        }
    }
}

#[test]
fn energy_that_is_stored_is_kept() {
    let [values, gradient] = run(&law(&format!("rest_length = 0.3\nenergy = \"k * s^2 / 2 + 80 * s^4\"{ENERGY}")), 40.0);
    let (at_start, s) = (|k: f64| k * 0.2_f64.powi(2) / 2.0 + 80.0 * 0.2_f64.powi(4), 0.2_f64);
    assert!((values[0] - at_start(40.0)).abs() < 1e-8, "{values:?}");
    assert!((gradient[0] - s * s / 2.0).abs() < 1e-8, "{gradient:?}");
}

#[test]
fn a_table_has_a_stop_at_its_end() {
    let stop = "rest_length = 0.3\nforce = { type = \"lines\", points = [-1, -0.05, 0.1, 1], values = [\"-k\", 0, 0, 45] }";
    let exact = |k: f64| {
        integrated(0.3, |s, _, _| match s {
            s if s < -0.05 => k * (s + 0.05) / 0.95,
            s if s > 0.1 => 50.0 * (s - 0.1),
            _ => 0.0,
        })
    };
    let [values, _] = run(&law(stop), 40.0);
    // kinks that steps pass cost an order
    assert!((values[0] - exact(40.0)).abs() < 1e-5, "{} for {}", values[0], exact(40.0));
}

#[test]
fn what_is_wrong_with_a_law_is_told() {
    for (keys, part) in [
        ("", "\"spring\" needs force or energy, a law of s"),
        ("force = \"k * x\"", "\"x\""),
        ("energy = \"k * s * v\"", "\"v\""),
        ("force = [1, 2]", "force of"),
        ("force = { type = \"lines\", points = [0, 1], values = [0] }", "there are 2 points, but 1 values"),
        ("force = { type = \"lines\", points = [1, 0], values = [0, 1] }", "increase"),
        ("stiffness = 3", "key \"stiffness\" is not known"),
    ] {
        let told = refused(&law(keys));
        assert!(told.contains(part), "{keys}: {told}");
    }
    let hidden = law("force = \"k * s\"").replace("[variable]\n", "[variable]\ns = { initial = 1, bounds = [0, 2] }\n");
    let told = FileScene::parse("laws.toml", &hidden).unwrap_err();
    assert!(told.contains("s is what it depends on, and a name of this file, too"), "{told}");
}

/// The monotone cubics of Steffen (1990) through points: a value between them.
fn monotone(points: &[(f64, f64)], t: f64) -> f64 {
    let piece = points.partition_point(|point| point.0 <= t).clamp(1, points.len() - 1) - 1;
    let secant = |k: usize| (points[k + 1].1 - points[k].1) / (points[k + 1].0 - points[k].0);
    // all pieces are of one length
    let slope = |k: usize| match k {
        // level at both ends
        0 => 0.0,
        k if k + 1 == points.len() => {
            let (near, far) = (secant(k - 1), secant(k - 2));
            let slope = near * 1.5 - far * 0.5;
            if slope * near <= 0.0 { 0.0 } else { near.signum() * slope.abs().min(2.0 * near.abs()) }
        }
        k => {
            let (before, after) = (secant(k - 1), secant(k));
            if before * after <= 0.0 {
                0.0
            } else {
                2.0 * before.signum() * before.abs().min(after.abs()).min((before + after).abs() / 4.0)
            }
        }
    };
    let ((start, y), (end, next)) = (points[piece], points[piece + 1]);
    let (h, s) = (end - start, (t - start) / (end - start));
    let bend = h * s * (1.0 - s) * ((1.0 - s) * slope(piece) - s * slope(piece + 1));
    y + s * s * (3.0 - 2.0 * s) * (next - y) + bend
}

/// Where the body of the quarter of a car among the example scenes ends.
fn height_of_the_car() -> f64 {
    let (rate, force, knee, stop, tyre) = (2.2e4, 900.0, 0.3, 2e5, 1.9e5);
    let (body, wheel, room, g) = (300.0, 40.0, 0.08, 9.81);
    let sag = (body + wheel) * g / tyre;
    let file = include_str!("../../examples/scenes/road.csv");
    let numbers = |line: &str| line.split_once(',').map(|(t, z)| (t.parse().unwrap(), z.parse().unwrap()));
    let road: Vec<(f64, f64)> = file.lines().skip(2).filter_map(numbers).collect();
    let accelerations = |t: f64, [z, top, v, top_v]: [f64; 4]| {
        let (s, rate_s) = (top - z - 0.5, top_v - v);
        let spring = rate * s - g * body + stop * ((s - room).max(0.0) - (-room - s).max(0.0));
        let pull = spring + force * (rate_s / knee).tanh();
        [(pull + tyre * (0.3 - z + monotone(&road, t)).max(0.0)) / wheel - g, -pull / body - g]
    };
    let slope = |t: f64, y: [f64; 4]| {
        let [a, top_a] = accelerations(t, y);
        [y[2], y[3], a, top_a]
    };
    runge_kutta::integrated([0.3 - sag, 0.8 - sag, 0.0, 0.0], (150_000, 1e-5), slope)[1]
}

#[test]
fn the_quarter_of_a_car_moves_as_its_equations_say() {
    let prepared = Prepared::new(built_in::named("quarter-car").unwrap()).unwrap_or_else(|why| panic!("{why}"));
    let values = prepared.analysis().forward(&prepared.x).unwrap().values;
    let exact = height_of_the_car();
    // stops and a tyre that lifts off bend the forces within steps
    assert!((values[1] - exact).abs() < 1e-5, "{} for {exact}", values[1]);
}
