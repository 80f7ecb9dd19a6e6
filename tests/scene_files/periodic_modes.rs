//! Modes about motions that repeat themselves: closed forms, and the published case of ground resonance.

use super::parsed;
use costate::integrators::Mode;
use costate::scenes::{AnyScene, FileScene, PeriodicModes, Prepared, built_in};
use std::f64::consts::TAU;

fn periodic(scene: &FileScene, count: usize) -> Result<PeriodicModes, String> {
    let prepared = Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"));
    prepared.periodic_modes(count).map_err(|why| why.to_string())
}

/// What stands still repeats itself after any time: the modes are those of a damped mass and of a first-order lag.
const STILL: &str = r#"
version = 1
settings = { end = 0.3, steps = 150, method = "esdirk5" }
body = [{ name = "mass", mass = 2, inertia = [1, 1, 1] }]
joint = [{ name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] }]
spring = [{ name = "spring", type = "slide", between = ["ground", "mass"], axis = [1, 0, 0], stiffness = 200, damping = 8 }]
state = [{ name = "lag", type = "formula", initial = { z = 0 }, rate = { z = "-z / 0.05" }, nodes = { mass = "mass" } }]
"#;

#[test]
fn what_stands_still_has_the_modes_of_its_closed_form() {
    let PeriodicModes { period, gap, modes, faded, .. } = periodic(&parsed(STILL), 5).unwrap();
    assert!((period, gap, faded, modes.len()) == (0.3, 0.0, 0, 2), "{period} {gap} {faded} {modes:?}");
    let expected = [(-2.0, (100.0_f64 - 4.0).sqrt()), (-20.0, 0.0)];
    for (Mode { growth, frequency, .. }, (own_growth, own_frequency)) in modes.iter().zip(expected) {
        assert!((growth - own_growth).abs() < 1e-9 && (frequency - own_frequency).abs() < 1e-9, "{growth} {frequency}");
    }
}

/// Beside it, what a damper takes to e^-1000 within the period: derivatives that underflow are zero.
#[test]
fn what_fades_to_nothing_within_a_period_is_counted() {
    let text = r#"
        version = 1
        settings = { end = 2, steps = 400, method = "esdirk5" }
        body = [{ name = "a", mass = 1, inertia = [1, 1, 1] },
                { name = "b", mass = 1, inertia = [1, 1, 1], position = [0, 1, 0] }]
        joint = [{ name = "ja", type = "prismatic", between = ["ground", "a"], axis = [1, 0, 0] },
                 { name = "jb", type = "prismatic", between = ["ground", "b"], axis = [1, 0, 0] }]
        [[spring]]
        name = "sa"
        type = "slide"
        between = ["ground", "a"]
        axis = [1, 0, 0]
        stiffness = 1e6
        damping = 1000
        [[spring]]
        name = "sb"
        type = "slide"
        between = ["ground", "b"]
        axis = [1, 0, 0]
        stiffness = 5
        damping = 0.1
    "#;
    let PeriodicModes { modes, faded, .. } = periodic(&parsed(text), 5).unwrap();
    let [Mode { growth, frequency, .. }] = modes[..] else { panic!("{modes:?}") };
    assert_eq!(faded, 2);
    // omega is known up to multiples of 2 pi by the period, and its sign
    let folded = std::f64::consts::PI - (5.0_f64 - 0.0025).sqrt();
    assert!((growth + 0.05).abs() < 1e-8 && (frequency - folded).abs() < 1e-8, "{growth} {frequency}");
}

#[test]
fn a_motion_that_does_not_return_is_refused_with_the_coordinate() {
    let text = STILL.replace(r#"name = "mass", "#, r#"name = "mass", velocity = [1, 0, 0], "#);
    let text = text.split("state =").next().unwrap();
    let why = periodic(&parsed(text), 2).unwrap_err();
    assert!(why.contains("does not repeat itself") && why.contains("\"mass\", x"), "{why}");
    let why = periodic(&parsed(&text.replace("esdirk5", "static").replace(", velocity = [1, 0, 0]", "")), 2).unwrap_err();
    assert!(why.contains("equilibria have no period"), "{why}");
}

/// Before the first step there is no state from which anything could change.
#[test]
fn a_start_that_is_not_found_is_told() {
    let text = STILL.replace("settings = {", "gravity = [9.81, 0, 0]\nsettings = { start = \"equilibrium\",");
    let why = periodic(&parsed(&text.replace("stiffness = 200", "stiffness = 0")), 2).unwrap_err();
    assert!(why.contains("mass"), "{why}");
}

/// Hammond (1974), four blades at 29 rad/s, dampers at a tenth; the figures by an integration of the linear equations of hub and lag angles
/// (Floquet), kept apart.
#[test]
fn ground_resonance_grows_as_fast_as_hammonds_equations() {
    let scene = built_in::named("ground-resonance").unwrap();
    let PeriodicModes { period, gap, modes, faded, .. } = periodic(scene, 20).unwrap();
    assert!(gap < 1e-11 && faded == 0, "{gap:e} {faded}");
    // twelve states: six pairs, or real ones
    assert!((6..=12).contains(&modes.len()), "{}", modes.len());
    let first = &modes[0];
    let regressing = TAU / period - first.frequency;
    assert!((first.growth - 0.8361868786).abs() < 2e-9, "{}", first.growth);
    assert!((regressing - 19.9367071).abs() < 1e-7, "{regressing}");
    assert!(modes[1..].iter().all(|mode| mode.growth < 0.0));
    // with the whole dampers it is stable
    let mut settings = scene.settings();
    settings.steps = 90;
    let method = Prepared::method_of(&settings).unwrap();
    let prepared = Prepared::with(scene, &[4067.5], method, settings).unwrap();
    let modes = prepared.periodic_modes(1).unwrap().modes;
    assert!(modes[0].growth < -0.4, "{}", modes[0].growth);
}

/// A mass that swings to and fro within a period of its own, through a law that jumps or has a kink in the middle.
#[test]
fn formulas_that_jump_on_the_way_are_refused_and_kinks_are_told() {
    let swing = |force: &str, locate: bool| {
        let text = STILL
            .split("spring =")
            .next()
            .unwrap()
            .replace(r#"name = "mass", "#, r#"name = "mass", velocity = [1, 0, 0], "#);
        let law = format!("force = \"{force}\"");
        let spring = r#"spring = [{ name = "law", type = "slide_law", between = ["ground", "mass"], axis = [1, 0, 0], "#;
        // 110 and 90 N/m by 2 kg in the two halves of the period of the kink
        let period = 0.5 * TAU * (55_f64.sqrt().recip() + 45_f64.sqrt().recip());
        let text = text.replace("end = 0.3, steps = 150", &format!("end = {period}, steps = 400, locate = {locate}"));
        periodic(&parsed(&format!("{text}{spring}{law} }}]\n")), 2)
    };
    let kinked = swing("100 * s + 10 * abs(s)", false).unwrap();
    assert!(kinked.kinks.iter().any(|kink| kink.part == "law"), "{:?}", kinked.kinks);
    // where steps end at it nothing grows or fades, to the error of the steps
    let located = swing("100 * s + 10 * abs(s)", true).unwrap();
    assert!(located.kinks.is_empty() && located.modes.iter().all(|mode| mode.growth.abs() < 1e-5), "{:?}", located.modes);
    let why = swing("100 * s + 10 * if_less(s, 0, -1, 1)", false).unwrap_err();
    assert!(why.contains("\"law\" jumps"), "{why}");
}

/// A pendulum that stands on a pivot that shakes (Kapitza): neither grows nor fades. Beside it a mass that nothing holds, whose two equal values
/// round-off parts by its root.
#[test]
fn round_off_makes_nothing_unstable() {
    let text = |more: &str, shake: f64| {
        format!(
            r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = "2 * pi / 60", steps = 400 }}
point = [{{ name = "pivot", position = [0, 0, 0] }}, {{ name = "bob", position = [0, 0, 1], mass = 1 }}{more}]
driver = [{{ name = "shaker", type = "translation", between = ["ground", "pivot"], axis = [0, 0, 1], displacement = {{ type = "formula", value = "{shake} * (cos(60 * t) - 1)" }} }}]
joint = [
    {{ name = "slide", type = "point_on_line", between = ["ground", "pivot"], axis = [0, 0, 1] }},
    {{ name = "rod", type = "distance", between = ["pivot", "bob"] }},
    {{ name = "plane", type = "point_in_plane", between = ["ground", "bob"], normal = [0, 1, 0] }},
    {{ name = "table", type = "point_in_plane", between = ["ground", "{}"], normal = [0, 0, 1] }},
]
"#,
            if more.is_empty() { "pivot" } else { "free" }
        )
    };
    let free = ", { name = \"free\", position = [1, 0, 0], mass = 1 }";
    let joints =
        |text: String| if text.contains("free") { text } else { text.replace("{ name = \"table\"", "# { name = \"table\"") };
    for more in ["", free] {
        let found = periodic(&parsed(&joints(text(more, 0.1))), 9).unwrap();
        assert!(!found.modes.is_empty() && found.modes.iter().all(|mode| mode.growth == 0.0), "{more}: {:?}", found.modes);
        // shaken less it falls: 0.02 m at 60 rad/s is less than the root of 2 g l
        let found = periodic(&parsed(&joints(text(more, 0.02))), 9).unwrap();
        assert!(found.modes[0].growth > 1.0 && found.modes[1..].iter().all(|mode| !mode.is_unstable()), "{:?}", found.modes);
    }
}
