//! Equilibria that stand: counts of negative eigenvalues, the branch that load steps find, and modes of which none is missing.

use super::parsed;
use costate::integrators::{ArcLength, StabilityCourse, StepControl, Verdict};
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::{FileScene, Settings, built_in};
use std::f64::consts::PI;

/// A column along x with EI = L = 1 under P along it and a share of P across it.
fn column(load: f64, side: f64) -> FileScene {
    let text = include_str!("../../verification/robustness/column.toml");
    parsed(&text.replace("LOAD", &format!("{load}")).replace("SIDE", &format!("{}", load * side)))
}

/// The tip, and what is said of its equilibrium.
fn tip(scene: &FileScene, settings: Settings) -> ([f64; 2], StabilityCourse) {
    let prepared = Prepared::with(scene, &[], Prepared::method_of(&settings).unwrap(), settings).unwrap();
    let forward = prepared.analysis().forward(&[]).unwrap();
    ([forward.values[0], forward.values[1]], forward.stability.expect("of equilibria"))
}

#[test]
fn a_column_is_found_where_it_stands_by_equal_chosen_and_divided_steps() {
    let near = |[x, y]: [f64; 2], [a, b]: [f64; 2]| (x - a).hypot(y - b) < 1e-3;
    // P L2/EI = 3 with 1 % across: the elastica ends at (.643, .671)
    let scene = column(3.0, 0.01);
    let stands = [
        ("10 steps", Settings::statics(10)),
        ("20 steps", Settings::statics(20)),
        ("100 steps", Settings::statics(100)),
        ("5 steps, divided", Settings::statics(5).dividing_steps()),
        ("chosen", Settings::statics(5).choosing_steps(StepControl::new(1e-6))),
    ];
    for (way, settings) in stands {
        let (at, StabilityCourse { end, lost }) = tip(&scene, settings.clone());
        assert!(near(at, [0.6428, 0.6709]), "{way}: {at:?}");
        assert!(end.verdict() == Verdict::Stable && end.negative == 0 && lost.is_none(), "{way}: {end:?} {lost:?}");
        // twice the critical load with a tenth of that across: 0.80
        let (at, StabilityCourse { end, .. }) = tip(&column(0.5 * PI * PI, 0.001), settings);
        assert!((at[1] - 0.797).abs() < 1e-3 && end.verdict() == Verdict::Stable, "{way}: {at:?}, {end:?}");
    }
    let (at, course) = tip(&column(0.5 * PI * PI, 0.001), Settings::statics(5));
    let stands = (at[1] - 0.797).abs() < 1e-3;
    assert_eq!(course.end.verdict(), if stands { Verdict::Stable } else { Verdict::Unstable }, "{at:?} {course:?}");
}

#[test]
fn a_straight_path_loses_its_stability_at_the_load_of_euler() {
    let load = 5.1;
    let euler = 0.25 * PI * PI / load;
    let (at, StabilityCourse { end, lost }) =
        tip(&column(load, 0.0), Settings::statics(5).choosing_steps(StepControl::new(1e-6)));
    assert!(at[1].abs() < 1e-9 && end.verdict() == Verdict::Unstable && end.negative == 2, "{at:?} {end:?}");
    let ([from, to], _) = lost.expect("a step in which it is lost");
    assert!(from <= euler && euler <= to && to - from <= 1e-3, "{from} {euler} {to}");
    // the same along the arc, whose points tell it one by one
    let scene = column(load, 0.0);
    let prepared = Prepared::new(&scene).unwrap();
    let path = prepared.path(&ArcLength::new(0.1).up_to_load(1.0)).unwrap();
    for point in &path.points {
        let expected = if point.load < euler { Verdict::Stable } else { Verdict::Unstable };
        assert_eq!(point.stability.verdict(), expected, "{}", point.load);
    }
    assert!(path.points.iter().any(|point| point.load > euler));
}

#[test]
fn a_truss_on_joints_has_a_symmetric_stiffness_at_every_number_of_load_steps() {
    let scene = built_in::named("von-mises-truss").expect("built in");
    for steps in [1, 3, 4, 10] {
        let settings = Settings { steps, ..scene.settings() };
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let prepared = Prepared::with(scene, &x, Prepared::method_of(&settings).unwrap(), settings).unwrap();
        let end = prepared.analysis().forward(&x).unwrap().stability.expect("of equilibria").end;
        assert!(end.determinant.is_none() && end.verdict() == Verdict::Stable, "{steps} steps: {end:?}");
    }
}

/// A bar that stands on a hinge, held by a torsion spring: K = k - m g l.
fn standing(stiffness: f64, following: bool) -> FileScene {
    let load = if following { 20.0 } else { 0.0 };
    parsed(&format!(
        r#"
        version = 1
        gravity = [0, -9.81, 0]
        settings = {{ method = "static", steps = 1 }}
        [[body]]
        name = "bar"
        position = [0, 1, 0]
        mass = 2
        inertia = [1, 1, 1]
        [[joint]]
        name = "hinge"
        type = "revolute"
        between = ["ground", "bar"]
        point = [0, 0, 0]
        axis = [0, 0, 1]
        [[spring]]
        name = "spring"
        type = "torsion"
        between = ["ground", "bar"]
        axis = [0, 0, 1]
        stiffness = {stiffness}
        [[force]]
        name = "thrust"
        on = "bar"
        frame = "body"
        direction = [0, -1, 0]
        size = {load}
        "#
    ))
}

#[test]
fn a_bar_stands_on_its_hinge_by_a_spring_above_its_weight_times_its_lever() {
    let verdict = |stiffness: f64, following: bool| {
        let scene = standing(stiffness, following);
        let equilibrium = Prepared::new(&scene).unwrap().equilibrium().unwrap();
        equilibrium.stability.unwrap().end
    };
    let limit = 2.0 * 9.81;
    for (share, expected) in
        [(0.5, Verdict::Unstable), (0.999, Verdict::Unstable), (1.001, Verdict::Stable), (2.0, Verdict::Stable)]
    {
        for following in [false, true] {
            // a thrust along the bar has no moment about the hinge, however it turns
            let stability = verdict(share * limit, following);
            assert_eq!(stability.verdict(), expected, "{share}, {following}: {stability:?}");
        }
    }
}

/// Four arms on a hub, at right angles to each other, each with a cap welded to it and a torsion spring about its axis, which its weight
/// turns: what an axis turned by a right angle has for a cosine was taken for a tie between a cap and its weld.
#[test]
fn caps_welded_to_arms_at_right_angles_are_determined() {
    let text = |k: usize| {
        let (c, s) = (format!("cos({k} * pi / 2)"), format!("sin({k} * pi / 2)"));
        format!(
            r#"
            [[body]]
            name = "arm {k}"
            position = ["0.2 * {c}", "0.2 * {s}", 0.9]
            orientation = {{ type = "angle", axis = [0, 0, 1], angle = "{k} * pi / 2" }}
            mass = 3
            mass_centre = [0.1, 0.03, 0]
            inertia = [0.1, 0.1, 0.1]
            [[body]]
            name = "cap {k}"
            position = ["0.44 * {c}", "0.44 * {s}", 0.9]
            orientation = {{ type = "angle", axis = [0, 0, 1], angle = "{k} * pi / 2" }}
            mass = 2
            mass_centre = [-0.011, 0, 0]
            inertia = [0.01, 0.01, 0.01]
            [[joint]]
            name = "bearing {k}"
            type = "revolute"
            between = ["hub", "arm {k}"]
            axis = ["{c}", "{s}", 0]
            [[joint]]
            name = "weld {k}"
            type = "fixed"
            between = ["arm {k}", "cap {k}"]
            [[spring]]
            name = "spring {k}"
            type = "torsion"
            between = ["hub", "arm {k}"]
            axis = ["{c}", "{s}", 0]
            stiffness = 100
            [[functional]]
            name = "cap {k}"
            type = "position"
            on = "cap {k}"
            point = ["0.44 * {c} - 0.1 * {s}", "0.44 * {s} + 0.1 * {c}", 0.9]
            direction = [0, 0, 1]
            over = "terminal"
            "#
        )
    };
    let hub = r#"
        version = 1
        gravity = [0, 0, -9.81]
        settings = { method = "static", steps = 1 }
        [[body]]
        name = "hub"
        position = [0, 0, 0]
        mass = 10
        inertia = [1, 1, 1]
        [[joint]]
        name = "shaft"
        type = "revolute"
        between = ["ground", "hub"]
        point = [0, 0, 0]
        axis = [0, 0, 1]
        [[driver]]
        name = "motor"
        type = "rotation"
        between = ["ground", "hub"]
        axis = [0, 0, 1]
        angle = 0
        "#;
    let scene = parsed(&(0..4).fold(hub.to_string(), |all, k| all + &text(k)));
    // k angle = m g d cos(angle), and the point sinks by 0.1 sin(angle)
    let angle = (0..50).fold(0.0_f64, |angle, _| 3.0 * 9.81 * 0.03 * angle.cos() / 100.0);
    for solver in [costate::linalg::Backend::Dense, costate::linalg::Backend::Multifrontal] {
        let mut prepared = Prepared::new(&scene).unwrap();
        prepared.method.backend = solver;
        let forward = prepared.analysis().forward(&[]).unwrap();
        for z in &forward.values {
            assert!((z - (0.9 - 0.1 * angle.sin())).abs() < 1e-12, "{solver:?}: {z}");
        }
        assert_eq!(forward.stability.unwrap().end.verdict(), Verdict::Stable);
    }
}

/// A strip of plates beyond its critical load (from a public report: thickness 0.0006 m, length 0.02 m, 1.005 of Euler's load).
#[test]
fn an_unstable_mode_does_not_hide_the_vibrations_beside_it() {
    let scene = parsed(
        r#"
        version = 1
        settings = { method = "static", steps = 4 }
        material.steel = { young = 2e11, poisson = 0, density = 7800 }
        [[shell]]
        name = "strip"
        type = "plate"
        first = [0.02, 0, 0]
        second = [0, 0.005, 0]
        elements = [8, 2]
        material = "steel"
        thickness = 0.0006
        clamped = ["first_start"]
        [[force]]
        name = "tip"
        on = "strip.first_end"
        direction = [-1, 0, 0]
        size = { type = "constant_rate", rate = "1.005 * pi^2 * 2e11 * 0.005 * 0.0006^3 / 12 / (4 * 0.02^2)" }
        "#,
    );
    let modes = Prepared::new(&scene).unwrap().modes(4).unwrap();
    assert!(modes[0].is_unstable() && (modes[0].growth - 607.19).abs() < 0.1, "{:?}", modes[0].growth);
    // the third bends in the plane: on 24 x 6 elements it is 6.13678e4
    for (mode, omega) in modes[1..].iter().zip([4.39288e4, 6.13874e4, 6.88389e4]) {
        assert!(!mode.is_unstable() && (mode.frequency / omega - 1.0).abs() < 1e-5, "{} {omega}", mode.frequency);
    }
    assert_eq!(modes.len(), 4);
}

/// A square column just below its critical load (from a public report, in millimetres and tonnes): each bending mode is there twice.
#[test]
fn equal_modes_near_a_critical_load_are_two() {
    let scene = parsed(
        r#"
        version = 1
        settings = { method = "static", steps = 2 }
        material.steel = { young = 210000, poisson = 0.28, density = 7.85e-9 }
        section.s = { type = "rectangle", material = "steel", width = 100, height = 100 }
        [[beam]]
        name = "beam"
        from = [0, 0, 0]
        to = [0, 0, 3000]
        elements = 8
        section = "s"
        second_axis = [0, 1, 0]
        clamped = "start"
        [[force]]
        name = "load"
        on = "beam.end"
        direction = [0, 0, -1]
        size = { type = "constant_rate", rate = "1.018 * 470437.10" }
        "#,
    );
    let prepared = Prepared::new(&scene).unwrap();
    for count in 1..=6 {
        let modes = prepared.modes(count).unwrap();
        let expected = [2.2343, 2.2343, 332.008, 332.008, 985.330, 985.330];
        assert_eq!(modes.len(), count);
        for (mode, omega) in modes.iter().zip(expected) {
            assert!((mode.frequency / omega - 1.0).abs() < 1e-5, "{count}: {} {omega}", mode.frequency);
        }
    }
}

/// A plate with a tied stiffener: its multipliers are pivots of fronts far above those that they come from.
#[test]
fn what_ties_delay_in_several_fronts_has_its_signs() {
    let scene = built_in::named("stiffened-plate").unwrap();
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    for solver in [costate::linalg::Backend::Dense, costate::linalg::Backend::Multifrontal] {
        let mut prepared = Prepared::new(scene).unwrap();
        prepared.method.backend = solver;
        let end = prepared.analysis().forward(&x).unwrap().stability.expect("of equilibria").end;
        assert!(end.negative == 0 && end.verdict() == Verdict::Stable, "{solver:?}: {end:?}");
    }
}
