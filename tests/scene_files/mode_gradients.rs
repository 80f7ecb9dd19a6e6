//! Derivatives of frequencies and growth: closed forms, and quotients of whole solutions.

use super::parsed;
use costate::integrators::{Mode, STATIC_TABLE};
use costate::scenes::{AnyScene, DifferentiatedModes, Prepared, built_in};
use num_complex::Complex64;

fn prepared<'s>(scene: &'s dyn AnyScene, x: &[f64], statics: bool) -> Prepared<'s> {
    let settings = scene.settings();
    let settings = if statics { settings.with_method(STATIC_TABLE) } else { settings };
    let method = Prepared::method_of(&settings).unwrap();
    Prepared::with(scene, x, method, settings).unwrap_or_else(|why| panic!("{why}"))
}

fn gradients(text: &str, count: usize, damped: bool) -> DifferentiatedModes {
    let scene = parsed(text);
    Prepared::new(&scene).unwrap().modes_with_gradients(count, damped).unwrap_or_else(|why| panic!("{why}"))
}

fn rate(own: &DifferentiatedModes, mode: usize, variable: usize) -> Complex64 {
    let own = own.gradients[mode].as_ref().unwrap();
    Complex64::new(own.growth[variable], own.frequency[variable])
}

fn near(own: Complex64, expected: Complex64, share: f64, what: &str) {
    assert!((own - expected).norm() <= share * expected.norm().max(1e-6), "{what}: {own} {expected}");
}

const SLIDER: &str = r#"
version = 1
settings = { end = 1, steps = 10 }
variable.m = { initial = 2, bounds = [0, 100], unit = "kg" }
variable.c = { initial = 8, bounds = [0, 100], unit = "N s/m" }
variable.k = { initial = 200, bounds = [0, 1000], unit = "N/m" }
body = [{ name = "mass", mass = "m", inertia = [1, 1, 1] }]
joint = [{ name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] }]
spring = [{ name = "spring", type = "slide", between = ["ground", "mass"], axis = [1, 0, 0], stiffness = "k", damping = "c" }]
functional = [{ name = "x", type = "position", on = "mass", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn a_damped_mass_has_the_derivatives_of_its_roots() {
    let (m, k) = (2.0, 200.0);
    for c in [0.0, 8.0, 39.0, 50.0] {
        let own = gradients(&SLIDER.replace("initial = 8", &format!("initial = {c}")), 2, true);
        for (place, mode) in own.modes.iter().enumerate() {
            let x = Complex64::new(mode.growth, mode.frequency);
            let slope = x * (2.0 * m) + c;
            for (variable, change) in [x * x, x, 1.0.into()].into_iter().enumerate() {
                near(rate(&own, place, variable), -change / slope, 1e-11, &format!("{c} {x} {variable}"));
            }
        }
    }
    let own = gradients(SLIDER, 1, false);
    let omega: f64 = (k / m).sqrt();
    let expected = [-0.5 * omega / m, 0.0, 0.5 * omega / k];
    (0..3).for_each(|variable| near(rate(&own, 0, variable), Complex64::new(0.0, expected[variable]), 1e-13, "undamped"));
}

/// A bob of a pendulum on a bar, which hangs.
const PENDULUM: &str = r#"
version = 1
gravity = [0, 0, "-g"]
settings = { end = 1, steps = 10 }
variable.g = { initial = 9.81, bounds = [0, 100], unit = "m/s2" }
variable.l = { initial = 0.7, bounds = [0, 10], unit = "m" }
variable.m = { initial = 3, bounds = [0, 10], unit = "kg" }
body = [{ name = "bob", position = [0, 0, "-l"], mass = "m", inertia = [0.02, 0.02, 0.02] }]
joint = [{ name = "hinge", type = "revolute", between = ["ground", "bob"], point = [0, 0, 0], axis = [0, 1, 0] }]
functional = [{ name = "x", type = "position", on = "bob", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn a_pendulum_has_those_of_its_closed_form_through_its_reactions() {
    // omega^2 = m g l / (I + m l^2): all of the stiffness is that of the reaction
    let (g, l, m, inertia) = (9.81_f64, 0.7, 3.0, 0.02);
    let whole = inertia + m * l * l;
    let omega = (m * g * l / whole).sqrt();
    let relative = [0.5 / g, 0.5 / l - m * l / whole, 0.5 / m - 0.5 * l * l / whole];
    for damped in [false, true] {
        let own = gradients(PENDULUM, 1, damped);
        assert!((own.modes[0].frequency - omega).abs() < 1e-12 * omega);
        for (variable, share) in relative.into_iter().enumerate() {
            near(rate(&own, 0, variable), Complex64::new(0.0, share * omega), 1e-12, &format!("{variable}"));
        }
    }
}

/// A mass in a plane between springs that are as stiff along x and y, and one of no stiffness yet at 30 degrees.
const EQUAL: &str = r#"
version = 1
settings = { end = 1, steps = 10 }
variable.along = { initial = 300, bounds = [0, 1000], unit = "N/m" }
variable.both = { initial = 0, bounds = [-100, 1000], unit = "N/m" }
variable.oblique = { initial = 0, bounds = [-100, 1000], unit = "N/m" }
body = [{ name = "mass", mass = 3, inertia = [1, 1, 1] }]
joint = [{ name = "plane", type = "planar", between = ["ground", "mass"], normal = [0, 0, 1] }]
spring = [
    { name = "one", type = "bushing", between = ["ground", "mass"], stiffness = ["along + both", "300 + both", 0, 0, 0, 0] },
    { name = "two", type = "line", between = ["ground", "mass"], points = [["cos(pi / 6)", "sin(pi / 6)", 0], [0, 0, 0]], stiffness = "oblique" },
]
functional = [{ name = "x", type = "position", on = "mass", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn equal_frequencies_part_as_their_subspace_says() {
    // a turn about z is free
    for count in [2, 3] {
        let own = gradients(EQUAL, count, false);
        let moving: Vec<usize> = (0..own.modes.len()).filter(|&place| own.modes[place].frequency > 0.0).collect();
        assert_eq!(moving.len(), count - 1, "{:?}", own.modes);
        // d omega = dk / (2 m omega) along a spring, 0 across
        let step = 0.5 / (3.0 * 10.0);
        for (order, &place) in moving.iter().enumerate() {
            assert_eq!(own.gradients[place].as_ref().unwrap().equal, 2);
            for (variable, expected) in [order as f64 * step, step, order as f64 * step].into_iter().enumerate() {
                let found = rate(&own, place, variable);
                assert!(
                    (found - Complex64::new(0.0, expected)).norm() < 1e-12 * step,
                    "{order} {variable}: {found} {expected}"
                );
            }
        }
        assert!(own.gradients.iter().filter(|own| own.is_none()).count() == 1, "a rigid motion has none");
    }
}

fn values(prepared: &Prepared, count: usize, damped: bool) -> Vec<Complex64> {
    let modes: Vec<Mode> = match damped {
        true => prepared.complex_modes_with_state(count).unwrap().1,
        false => prepared.modes(count).unwrap(),
    };
    modes.iter().map(|mode| Complex64::new(mode.growth, mode.frequency)).collect()
}

/// Derivatives beside quotients of whole solutions along each variable, extrapolated.
fn against_quotients(scene: &dyn AnyScene, (count, damped, statics): (usize, bool, bool), limit: f64) {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let own = prepared(scene, &x, statics)
        .modes_with_gradients(count, damped)
        .unwrap_or_else(|why| panic!("{}: {why}", scene.name()));
    for (variable, named) in scene.variables().iter().enumerate() {
        let quotient = |share: f64| -> Vec<Complex64> {
            let step = share * if x[variable] == 0.0 { 1.0 } else { x[variable].abs() };
            let at = |sign: f64| {
                let mut moved = x.clone();
                moved[variable] += sign * step;
                let mut values = values(&prepared(scene, &moved, statics), count + 7, damped);
                values.retain(|value| *value != Complex64::ZERO);
                values
            };
            at(1.0).iter().zip(at(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect()
        };
        let (coarse, fine) = (quotient(4e-3), quotient(2e-3));
        let moving = own.modes.iter().zip(&own.gradients).filter_map(|(mode, own)| Some((mode, own.as_ref()?)));
        for (place, (mode, gradient)) in moving.take(fine.len()).enumerate() {
            let size = mode.frequency.hypot(mode.growth) / x[variable].abs().max(1e-3);
            let expected = (fine[place] * 4.0 - coarse[place]) / 3.0;
            let found = Complex64::new(gradient.growth[variable], gradient.frequency[variable]);
            let what = format!("{}: mode {place} by {}: {found} {expected}, size {size}", scene.name(), named.name);
            assert!((found - expected).norm() <= limit * expected.norm().max(size), "{what}");
        }
    }
}

#[test]
fn loaded_structures_agree_with_quotients() {
    for name in ["right-angle-cantilever", "von-mises-truss"] {
        against_quotients(built_in::named(name).unwrap(), (3, false, true), 1e-6);
    }
}

/// A beam whose clamped end the design puts somewhere, its tip tied to the ground and pushed by a controller that integrates: the equilibrium
/// moves with the clamp, and not all else with it.
const CLAMPED: &str = r#"
version = 1
gravity = [0, 0, -9.81]
settings = { end = 0.01, steps = 2, start = "equilibrium" }
variable.x = { initial = 0.5, bounds = [0, 1], unit = "m" }
variable.y = { initial = 0.2, bounds = [0, 1], unit = "m" }
variable.h = { initial = 0.01, bounds = [0.001, 1], unit = "m" }
material.rubber = { density = 1200, young = 5e7, poisson = 0.4 }
section.bar = { type = "rectangle", width = 0.03, height = "h", material = "rubber" }
beam = [{ name = "bar", elements = 2, from = ["x", "y", 0], to = [1.5, 0, 0], section = "bar", second_axis = [0, 0, 1], clamped = ["start"] }]
spring = [{ name = "tie", type = "line", between = ["ground", "bar.end"], points = [[2, 0.3, 0.1], [1.5, 0, 0]], stiffness = 20, rest_length = 0.3 }]
functional = [{ name = "z", type = "position", on = "bar.end", direction = [0, 0, 1], over = "terminal" }]
"#;

#[test]
fn what_is_clamped_where_the_design_says_agrees_with_quotients() {
    against_quotients(&parsed(CLAMPED), (3, false, false), 1e-6);
    let controlled = r#"
[[state]]
name = "controller"
type = "pid"
nodes = { p = "bar.end" }
measured = "p.position.z"
set_point = 0.01
integral = 2
[[element]]
name = "acts"
nodes = { p = "bar.end", s = "controller" }
force = { p = "[0, 0, s.output]" }
"#;
    against_quotients(&parsed(&format!("{CLAMPED}{controlled}")), (3, true, false), 1e-6);
}

/// A beam that flies, a pendulum of two bars that hangs in its equilibrium from redundant hinges, and a damped one beside it.
const FREE: &str = r#"
version = 1
settings = { end = 0.01, steps = 2 }
variable.h = { initial = 0.02, bounds = [0.001, 1], unit = "m" }
variable.tip = { initial = 0.5, bounds = [0, 10], unit = "kg" }
variable.l = { initial = 1, bounds = [0.1, 10], unit = "m" }
material.aluminium = { density = 2700, young = 7e10, poisson = 0.3 }
section.bar = { type = "rectangle", width = 0.03, height = "h", material = "aluminium" }
beam = [{ name = "bar", elements = 4, from = [0, 0, 0], to = ["l", 0, 0], section = "bar", second_axis = [0, 1, 0] }]
body = [{ name = "tip", position = ["l", 0, 0], mass = "tip", inertia = [0.001, 0.001, 0.001] }]
joint = [{ name = "weld", type = "fixed", between = ["bar[4]", "tip"] }]
functional = [{ name = "x", type = "position", on = "tip", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn what_flies_agrees_with_quotients() {
    against_quotients(&parsed(FREE), (9, false, false), 1e-6);
    against_quotients(&parsed(FREE), (8, true, false), 1e-6);
}

/// A disc on a bushing with damping, whose shaft turns at a rate that is a variable; it hangs out of the axis.
const ROTOR: &str = r#"
version = 1
settings = { start = "steady", end = 0.01, steps = 2 }
variable.rate = { initial = 12, bounds = [-500, 500], unit = "rad/s" }
variable.out = { initial = 0.1, bounds = [0, 1], unit = "m" }
variable.mass = { initial = 2, bounds = [0, 10], unit = "kg" }
variable.k = { initial = 800, bounds = [0, 1e4], unit = "N/m" }
variable.c = { initial = 3, bounds = [0, 1e4], unit = "N s/m" }
body = [{ name = "hub", mass = 1, inertia = [1, 1, 1] }, { name = "disc", position = ["out", 0, 0], mass = "mass", inertia = [0.03, 0.02, 0.05] }]
joint = [{ name = "shaft", type = "revolute", between = ["ground", "hub"], axis = [0, 0, 1] }]
driver = [{ name = "motor", type = "rotation", between = ["ground", "hub"], axis = [0, 0, 1], angle = { type = "formula", value = "rate * t" } }]
spring = [{ name = "arm", type = "bushing", between = ["hub", "disc"], point = ["out", 0, 0], stiffness = ["k", 900, 5000, 30, 35, 70], damping = ["c", 1, 0, 0.2, 0.1, 0] }]
spin = [{ parts = ["hub", "disc"], axis = [0, 0, 1], rate = "rate" }]
functional = [{ name = "x", type = "position", on = "disc", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn what_turns_agrees_with_quotients() {
    against_quotients(&parsed(ROTOR), (6, true, false), 1e-6);
    // without the motor the shaft is free
    let free = ROTOR
        .replace("settings =", "hold = [{ nodes = [\"hub\"], directions = [\"rotation_z\"] }]\nsettings =")
        .replace("driver = [{ name = \"motor\"", "state = []\n# [{ name = \"motor\"");
    against_quotients(&parsed(&free), (7, true, false), 1e-6);
}

/// A closed loop of bars on more hinges than it needs, which hangs under gravity from two flexible cables' end and finds its equilibrium.
const LOOP: &str = r#"
version = 1
gravity = [0, 0, "-g"]
settings = { start = "equilibrium", drop_redundant = true, end = 0.01, steps = 2 }
variable.g = { initial = 9.81, bounds = [0, 100], unit = "m/s2" }
variable.m = { initial = 2, bounds = [0, 100], unit = "kg" }
variable.k = { initial = 40, bounds = [0, 1e4], unit = "N m/rad" }
variable.l = { initial = 0.5, bounds = [0.1, 10], unit = "m" }
body = [
    { name = "left", position = [0, 0, "-l / 2"], mass = "m", inertia = [0.02, 0.02, 0.02] },
    { name = "right", position = [1, 0, "-l / 2"], mass = 1.5, inertia = [0.02, 0.02, 0.02] },
    { name = "floor", position = [0.5, 0, "-l"], mass = 1, inertia = [0.02, 0.02, 0.02], coordinates = "natural" },
]
joint = [
    { name = "a", type = "revolute", between = ["ground", "left"], point = [0, 0, 0], axis = [0, 1, 0] },
    { name = "b", type = "revolute", between = ["ground", "right"], point = [1, 0, 0], axis = [0, 1, 0] },
    { name = "c", type = "revolute", between = ["left", "floor"], point = [0, 0, "-l"], axis = [0, 1, 0] },
    { name = "d", type = "revolute", between = ["right", "floor"], point = [1, 0, "-l"], axis = [0, 1, 0] },
]
spring = [{ name = "turn", type = "torsion", between = ["ground", "left"], axis = [0, 1, 0], stiffness = "k", damping = 0.3, rest_angle = 0.2 }]
functional = [{ name = "x", type = "position", on = "floor", direction = [1, 0, 0], over = "terminal" }]
"#;

#[test]
fn a_redundant_loop_agrees_with_quotients() {
    for damped in [false, true] {
        against_quotients(&parsed(LOOP), (1, damped, false), 1e-6);
    }
}

#[test]
fn slender_beams_have_the_frequencies_of_theory_and_their_derivatives() {
    let text = |height: f64| {
        format!(
            r#"
version = 1
settings = {{ end = 1e-4, steps = 1 }}
variable.h = {{ initial = {height}, bounds = [1e-7, 0.1], unit = "m" }}
section.bar = {{ type = "rectangle", width = "1.5 * h", height = "h", material = "steel" }}
material.steel = {{ density = 7800, young = 210e9, poisson = 0.3 }}
beam = [{{ name = "bar", from = [0, 0, 0], to = [1, 0, 0], elements = 8, section = "bar", second_axis = [0, 0, 1], clamped = "start" }}]
"#
        )
    };
    // radius of gyration h / sqrt(12): down to 6e-5 of the length
    for height in [0.02, 7e-4, 2e-4] {
        for damped in [false, true] {
            let own = gradients(&text(height), 2, damped);
            let omega = 1.875_104_07_f64.powi(2) * (210e9 * height * height / 12.0 / 7800.0_f64).sqrt();
            for (place, expected) in [omega, 1.5 * omega].into_iter().enumerate() {
                let found = own.modes[place].frequency;
                assert!((found / expected - 1.0).abs() < 3e-3, "{height} {damped}: {found} {expected}");
                near(rate(&own, place, 0) * height, Complex64::new(0.0, found), 5e-3, &format!("{height} {damped}"));
            }
        }
    }
}

/// Numbers from 0 to 1 (SplitMix64).
struct Drawn(u64);

impl Drawn {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    fn list(&mut self, count: usize, from: f64, to: f64) -> Vec<f64> {
        (0..count).map(|_| from + (to - from) * self.number()).collect()
    }
}

/// Up to three bodies on joints and bushings, free or held, damped or not.
fn drawn(seed: u64) -> (String, bool) {
    let mut own = Drawn(seed);
    let [is_held, is_damped] = [(); 2].map(|()| own.number() < 0.5);
    let mut text = "version = 1\nsettings = { end = 0.01, steps = 1 }\n".to_string();
    text += "variable.mass = { initial = 2, bounds = [0.1, 10] }\nvariable.k = { initial = 700, bounds = [1, 1e4] }\n";
    text += "variable.c = { initial = 1.5, bounds = [0, 1e3] }\n";
    for body in 0..1 + (3.0 * own.number()) as usize + usize::from(!is_held) {
        let mass = if body == 0 { "\"mass\"".to_string() } else { format!("{}", 1.0 + own.number()) };
        let (at, inertia) = (own.list(3, -1.0, 1.0), own.list(3, 0.3, 0.5));
        text += &format!("[[body]]\nname = \"{body}\"\nposition = {at:?}\nmass = {mass}\ninertia = {inertia:?}\n");
        if body == 0 && !is_held {
            continue;
        }
        let between = if body == 0 { "ground".into() } else { format!("{}", body - 1) };
        let joint = match (6.0 * own.number()) as usize {
            0 => "type = \"revolute\"\naxis = [0.6, 0, 0.8]\n",
            1 => "type = \"spherical\"\n",
            2 => "type = \"prismatic\"\naxis = [0, 0.6, 0.8]\n",
            _ => "",
        };
        let (point, mut stiffness) = (own.list(3, -1.0, 1.0), own.list(3, 100.0, 3000.0));
        stiffness.extend(own.list(3, 20.0, 300.0));
        let mut damping = own.list(6, 0.0, 3.0);
        damping.iter_mut().for_each(|own| *own *= f64::from(u8::from(is_damped)));
        let point = if joint.contains("prismatic") { String::new() } else { format!("point = {point:?}\n") };
        if !joint.is_empty() {
            text += &format!("[[joint]]\nname = \"joint {body}\"\nbetween = [\"{between}\", \"{body}\"]\n{joint}{point}");
        }
        text += &format!(
            "[[spring]]\nname = \"bushing {body}\"\ntype = \"bushing\"\nbetween = [\"{between}\", \"{body}\"]\n{point}\
             stiffness = [\"k\", {:?}, {:?}, {:?}, {:?}, {:?}]\ndamping = [\"{}c\", {:?}, {:?}, {:?}, {:?}, {:?}]\n",
            stiffness[1],
            stiffness[2],
            stiffness[3],
            stiffness[4],
            stiffness[5],
            if is_damped { "" } else { "0 * " },
            damping[1],
            damping[2],
            damping[3],
            0.1 * damping[4],
            0.1 * damping[5]
        );
    }
    (text, is_damped)
}

#[test]
fn drawn_mechanisms_agree_with_quotients() {
    for seed in 0..30 {
        let (text, is_damped) = drawn(1000 + seed);
        let scene = parsed(&text);
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let own = prepared(&scene, &x, false);
        let found = own.modes_with_gradients(60, is_damped).unwrap_or_else(|why| panic!("{seed}: {why}\n{text}"));
        assert!(found.proved, "{seed}");
        let all: Vec<Complex64> = found.modes.iter().map(|mode| Complex64::new(mode.growth, mode.frequency)).collect();
        for (variable, own_x) in x.iter().enumerate() {
            // the value nearest to each
            let quotient = |share: f64| -> Vec<Complex64> {
                let at = |sign: f64| {
                    let mut moved = x.clone();
                    moved[variable] += sign * share * own_x;
                    let near = values(&prepared(&scene, &moved, false), 60, is_damped);
                    let nearest = |own: &Complex64| {
                        near.iter().copied().min_by(|a, b| (a - own).norm().total_cmp(&(b - own).norm())).unwrap()
                    };
                    all.iter().map(nearest).collect::<Vec<_>>()
                };
                at(1.0).iter().zip(at(-1.0)).map(|(up, down)| (up - down) / (2.0 * share * own_x)).collect()
            };
            let (coarse, fine) = (quotient(4e-4), quotient(2e-4));
            for (place, gradient) in found.gradients.iter().enumerate() {
                let value = all[place];
                let Some(gradient) = gradient else {
                    assert!(value == Complex64::ZERO, "{seed}: mode {place}, {value}");
                    continue;
                };
                // values that nearly meet move by more than a quotient sees
                let apart = all.iter().enumerate().filter(|own| own.0 != place).map(|own| (own.1 - value).norm());
                let apart = apart.fold(if value.im == 0.0 { f64::INFINITY } else { 2.0 * value.im }, f64::min);
                if apart < 0.02 * value.norm() {
                    continue;
                }
                let (own, expected) = (
                    Complex64::new(gradient.growth[variable], gradient.frequency[variable]),
                    (fine[place] * 4.0 - coarse[place]) / 3.0,
                );
                let size = expected.norm().max(value.norm() / own_x);
                assert!(
                    (own - expected).norm() < 1e-6 * size,
                    "{seed}: mode {place}, {value} by {variable}: {own} {expected}\n{text}"
                );
            }
        }
    }
}
