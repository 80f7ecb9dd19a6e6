//! Breakpoints: one at which nothing happens does no harm, wherever it lies; reactions stand at the times they are given for.

use super::parsed;
use costate::integrators::{Table, tables};
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::FileScene;
use costate::sensitivity::Analysis;

/// An aluminium beam of 1 m x 20 mm x 10 mm that falls about a hinge, and what else it says.
fn falling_beam(more: &str) -> FileScene {
    let text = r#"
version = 1
name = "falling beam"
summary = "a beam about a hinge"
gravity = [0, -9.81, 0]
settings = { end = 0.4, steps = 80 }
section.bar = { type = "beam", axial = 14e6, shear = [4.4e6, 4.4e6], torsion = 300, bending = [467, 117], mass = 0.54, inertia = [6.5e-6, 1.8e-6] }
[[beam]]
name = "bar"
from = [0, 0, 0]
to = [1, 0, 0]
elements = 4
section = "bar"
second_axis = [0, 1, 0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "bar.start"]
point = [0, 0, 0]
axis = [0, 0, 1]
[[functional]]
name = "height"
type = "position"
on = "bar.end"
direction = [0, 1, 0]
over = "terminal"
"#;
    parsed(&format!("{text}{more}"))
}

/// A force of 0 N that becomes one of 0 N.
fn nothing_at(t: f64) -> String {
    format!(
        "[[force]]\nname = \"nothing\"\non = \"bar.end\"\ndirection = [0, 1, 0]\n\
         size = {{ type = \"step\", before = 0, after = 0, at = {t:?} }}\n"
    )
}

/// Height at the end, and the largest force in the hinge.
fn heights_and_forces(scene: &FileScene, table: &Table, level: ConstraintLevel) -> (f64, f64) {
    let place = format!("{}, {level:?}", table.name);
    let settings = AnyScene::settings(scene).without_method();
    let prepared = Prepared::with(scene, &[], Method::new(table.clone(), level), settings).expect(&place);
    let run = prepared.run().unwrap_or_else(|error| panic!("{place}: {error}"));
    let forces = run.joint("hinge").expect("a joint").forces;
    let size = |force: &[f64; 3]| force.iter().map(|f| f * f).sum::<f64>().sqrt();
    (run.value("height").expect("listed"), forces.iter().map(size).fold(0.0, f64::max))
}

/// Where they fall within steps, before and beside ends of steps: all methods have steps of nearly the size they have without.
#[test]
fn a_breakpoint_at_which_nothing_happens_does_no_harm() {
    let without = falling_beam("");
    for t in [0.2, 0.20001, 0.200_000_01, 0.19999, 0.2023] {
        let with = falling_beam(&nothing_at(t));
        for table in tables().into_iter().filter(|table| !table.is_static() && !table.name.starts_with("bdf1")) {
            for level in ConstraintLevel::ALL {
                let (height, force) = heights_and_forces(&without, &table, level);
                let (own_height, own_force) = heights_and_forces(&with, &table, level);
                let what = format!("{}, {level:?}, at {t} s", table.name);
                assert!((own_height - height).abs() < 3e-3, "{what}: height {own_height}, without {height}");
                assert!((own_force - force).abs() < 0.1 * force, "{what}: force {own_force}, without {force}");
            }
        }
    }
}

/// A pendulum of 1 kg from rest at the horizontal: its rod carries 3 g sin of its angle, which energy gives. Half a step beside, it is 0.04 N off.
#[test]
fn reactions_stand_at_the_times_they_are_given_for() {
    let text = r#"
version = 1
name = "pendulum"
summary = "a point on a rod"
gravity = [0, -9.81, 0]
settings = { end = 0.6, steps = 600 }
[[point]]
name = "bob"
position = [1, 0, 0]
mass = 1
[[joint]]
name = "rod"
type = "distance"
between = ["ground", "bob"]
[[functional]]
name = "height"
type = "position"
on = "bob"
direction = [0, 1, 0]
over = "terminal"
"#;
    let scene = parsed(text);
    for table in tables().into_iter().filter(|table| !table.is_static() && table.order >= 2) {
        // at the other levels multipliers of many tables have errors of order 1 or 0 of their own
        for level in ConstraintLevel::ALL.into_iter().filter(|level| *level == ConstraintLevel::Acceleration) {
            let method = Method::new(table.clone(), level);
            let prepared = Prepared::with(&scene, &[], method, AnyScene::settings(&scene).without_method()).expect("sound");
            let run = prepared.run().expect("runs");
            let (joint, bob) = (run.joint("rod").expect("a joint"), run.node("bob").expect("a node"));
            for ((&t, force), place) in joint.times.iter().zip(&joint.forces).zip(&bob.positions) {
                let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
                let right = -3.0 * 9.81 * place[1];
                // half a step changes it by 0.04 N
                assert!((size - right).abs() < 2e-2, "{}, {level:?}, t = {t}: {size} N, not {right} N", table.name);
            }
        }
    }
}

/// A bar of 1 kg and 1 m that a motor turns up within `duration`, while a force on its tip begins to swing within `beginning`, and another one
/// jumps at 0.31 s.
const LIFTED: &str = r#"
version = 1
name = "lifted bar"
summary = "a bar that a motor turns up"
gravity = [0, -9.81, 0]
settings = { end = 1.0, steps = 60 }
variable.duration = { initial = 0.43, bounds = [0.1, 0.9], unit = "s" }
variable.beginning = { initial = 0.27, bounds = [0.1, 0.9], unit = "s" }
variable.length = { initial = 1.0, bounds = [0.1, 2], unit = "m" }
[[body]]
name = "bar"
position = ["length / 2", 0, 0]
mass = 1
inertia = [0.001, 0.083, 0.083]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "bar"]
point = [0, 0, 0]
axis = [0, 0, 1]
[[driver]]
name = "motor"
type = "rotation"
between = ["ground", "bar"]
axis = [0, 0, 1]
angle = { type = "smooth_ramp", to = 1.2, duration = "duration" }
[[point]]
name = "bob"
position = ["length", 0.5, 0]
mass = 0.3
[[joint]]
name = "rod"
type = "distance"
between = ["ground", "bob"]
[[spring]]
name = "spring"
type = "line"
between = ["bar", "bob"]
stiffness = 40
rest_length = 0.4
[[force]]
name = "swing"
on = "bob"
direction = [0, 0, 1]
size = { type = "sine", amplitude = 3, angular_frequency = 9, phase = 0.7, smooth_start = "beginning" }
[[force]]
name = "push"
on = "bob"
direction = [1, 0, 0]
size = { type = "step", before = 0, after = 2, at = 0.31 }
[[functional]]
name = "moment, integral"
type = "reaction"
joint = "motor"
weights = [1]
over = "integral"
[[functional]]
name = "largest force"
type = "joint_load"
joint = "rod"
on = "bob"
load = "force_norm"
over = { aggregate = "smooth_maximum", sharpness = 2 }
[[functional]]
name = "x at the end"
type = "position"
on = "bob"
direction = [1, 0, 0]
over = "terminal"
[[functional]]
name = "speed"
type = "velocity"
on = "bob"
direction = [0, 0, 1]
over = "terminal"
[[functional]]
name = "energy at the end"
type = "energy"
over = "terminal"
"#;

/// By how much a derivative of a functional differs between designs a rounding apart.
fn scatter(analysis: &Analysis, x: &[f64], functional: usize, variable: usize) -> f64 {
    let at = |rounded: fn(f64) -> f64| {
        let x: Vec<f64> = x.iter().map(|&x| rounded(x)).collect();
        let forward = analysis.forward(&x).expect("runs");
        analysis.tangent(&x, &forward).expect("runs").rows[functional][variable]
    };
    let [up, here, down] = [at(f64::next_up), at(|x| x), at(f64::next_down)];
    (up - here).abs().max((down - here).abs()).max((up - down).abs())
}

#[test]
fn steps_move_with_breakpoints_in_adjoint_tangents_and_complex_step_as_in_runs_of_other_designs() {
    let scene = parsed(LIFTED);
    let x = [0.43, 0.27, 1.0];
    let mut failures = Vec::new();
    for table in tables().into_iter().filter(|table| !table.is_static()) {
        for level in ConstraintLevel::ALL {
            let method = Method::new(table.clone(), level);
            let prepared = Prepared::with(&scene, &x, method, AnyScene::settings(&scene).without_method()).expect("sound");
            let analysis = prepared.analysis();
            let forward = analysis.forward(&x).expect("runs");
            let adjoint = analysis.adjoint(&x, &forward).expect("has a gradient").rows;
            let complex = analysis.complex_step(&x, &forward).expect("runs").rows;
            let tangent = analysis.tangent(&x, &forward).expect("runs").rows;
            let mut quotients = vec![Vec::new(); adjoint.len()];
            for variable in 0..x.len() {
                let mut direction = [0.0; 3];
                direction[variable] = 1.0;
                let own = analysis.central_difference(&x, &direction, 1e-3).expect("runs");
                quotients.iter_mut().zip(own).for_each(|(row, own)| row.push(own));
            }
            for (k, functional) in prepared.functionals().iter().enumerate() {
                let size = complex[k].iter().fold(0.0, |size: f64, d| size.max(d.abs()));
                for i in 0..x.len() {
                    let what = format!("{}, {level:?}, {}, variable {i}", table.name, functional.name);
                    let exact = complex[k][i];
                    // the condition of systems at position level grows with 1/h2
                    let conditioned = if level == ConstraintLevel::Position { 10.0 } else { 1.0 };
                    for (name, own, limit) in [
                        ("adjoint", adjoint[k][i], 1e-11 * conditioned),
                        ("tangent", tangent[k][i], 1e-12 * conditioned),
                        ("quotient", quotients[k][i], 1e-5),
                    ] {
                        // a last digit of the variables may move a gradient by more: the force at position level by up to 1.5e-11
                        if (own - exact).abs() > limit * size && (own - exact).abs() > 4.0 * scatter(&analysis, &x, k, i) {
                            failures
                                .push(format!("{what}: {name} {own}, complex step {exact}, {:.1e}", (own - exact) / size));
                        }
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} differ:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn breakpoints_that_pass_each_other_lay_steps_anew_and_those_that_coincide_have_no_derivative() {
    let scene = parsed(LIFTED);
    let at = |x: &[f64]| {
        Prepared::with(&scene, x, Prepared::default_method(), AnyScene::settings(&scene).without_method()).expect("sound")
    };
    let (prepared, other) = (at(&[0.43, 0.27, 1.0]), [0.2, 0.27, 1.0]);
    let values = prepared.analysis().values(&other).expect("runs");
    assert_eq!(values, at(&other).analysis().values(&other).expect("runs"));
    let both = [0.4, 0.4, 1.0];
    let prepared = at(&both);
    let analysis = prepared.analysis();
    let forward = analysis.forward(&both).expect("runs");
    for refused in [analysis.adjoint(&both, &forward), analysis.complex_step(&both, &forward)] {
        let why = refused.expect_err("no derivative").to_string();
        assert!(why.contains("t = 0.4 s") && why.contains("coincide"), "{why}");
    }
}

/// A law of u = t - tau, the same as a formula of a file, and its integral from 0 on.
type Law = (&'static str, fn(f64) -> f64, fn(f64) -> f64);

/// What jumps or bends at a time that a variable moves, said in every way and place: nobody says when.
const LAWS: [Law; 7] = [
    ("if_less(U, 0, 1, 0)", |u| f64::from(u8::from(u < 0.0)), |u| u.min(0.0)),
    ("max(U, 0)", |u| u.max(0.0), |u| 0.5 * u.max(0.0).powi(2)),
    ("abs(U)", f64::abs, |u| 0.5 * u * u.abs()),
    ("sqrt(U^2)", f64::abs, |u| 0.5 * u * u.abs()),
    ("(U^2)^0.75", |u| u.abs().powf(1.5), |u| 0.4 * u.abs().powf(2.5).copysign(u)),
    (
        "atan(tan(U + pi / 2))",
        |u| (u + 0.5 * std::f64::consts::PI).tan().atan(),
        |u| 0.5 * u * u - 0.5 * std::f64::consts::PI * u.abs(),
    ),
    // thinner than a step, which ends at both sides of it
    ("if_less(abs(U), 0.001, 500, 0)", |u| if u.abs() < 1e-3 { 500.0 } else { 0.0 }, |u| 500.0 * u.clamp(-1e-3, 1e-3)),
];

#[test]
fn jumps_and_bends_of_time_are_found_and_move_with_the_design() {
    let places = [
        "[[force]]\nname = \"f\"\non = \"p\"\ndirection = [1, 0, 0]\nsize = { type = \"formula\", value = \"LAW\" }\n",
        "[[element]]\nname = \"f\"\nnodes = { p = \"p\" }\nforce = { p = \"[LAW, 0, 0]\" }\n",
        "[[spring]]\nname = \"f\"\ntype = \"slide_law\"\nbetween = [\"ground\", \"p\"]\naxis = [1, 0, 0]\nforce = \"-(LAW)\"\n",
        "[[state]]\nname = \"z\"\ntype = \"formula\"\ninitial = { z = 0 }\nrate = { z = \"LAW\" }\n",
        "[[functional]]\nname = \"own\"\ntype = \"formula\"\nnodes = { p = \"p\" }\nvalue = \"0 * p.position.x + LAW\"\nover = \"integral\"\n",
    ];
    for (law, value, integral) in LAWS {
        for (place, text) in places.iter().enumerate() {
            let measured = match place {
                3 => "type = \"formula\"\nnodes = { z = \"z\" }\nvalue = \"z.z\"\nover = \"terminal\"\n",
                _ => "type = \"velocity\"\non = \"p\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n",
            };
            let scene = format!(
                "version = 1\nvariable.tau = {{ initial = 0.437, bounds = [0, 1], unit = \"s\" }}\n\
                 settings = {{ end = 1, steps = 100 }}\n[[point]]\nname = \"p\"\nposition = [0, 0, 0]\nmass = 1\n{}\
                 [[functional]]\nname = \"speed\"\n{measured}",
                text.replace("LAW", law).replace('U', "(t - tau)")
            );
            let what = format!("{law}, place {place}");
            let scene = FileScene::parse("jumps.toml", &scene).unwrap_or_else(|why| panic!("{what}: {why}"));
            let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{what}: {why}"));
            let run = prepared.run().unwrap_or_else(|why| panic!("{what}: {why}"));
            assert!(run.forward.crossings.is_empty(), "{what}: {:?}", run.forward.crossings);
            let gradient = run.gradient().unwrap_or_else(|why| panic!("{what}: {why}"));
            let complex = prepared.analysis().complex_step(&prepared.x, &run.forward).expect("runs");
            let (first, last) = (-0.437, 1.0 - 0.437);
            let exact = [integral(last) - integral(first), value(first) - value(last)];
            let own = [run.forward.values[0], gradient.rows[0][0]];
            // roots have no higher derivative at their zero
            let limit = if law.contains('^') { 1e-6 } else { 1e-9 };
            for (own, exact) in own.iter().zip(exact) {
                assert!((own - exact).abs() < limit * exact.abs().max(1.0), "{what}: {own} for {exact}");
            }
            let apart = (complex.rows[0][0] - gradient.rows[0][0]).abs();
            assert!(apart < 1e-12 * exact[1].abs().max(1.0), "{what}: complex step {apart:e} apart");
        }
    }
}

#[test]
fn a_jump_at_the_start_or_end_of_a_run_that_a_variable_moves_has_no_derivative() {
    for (tau, end) in [(0.0, "start"), (1.0, "end")] {
        let text = format!(
            "version = 1\nvariable.tau = {{ initial = {tau:?}, bounds = [0, 1], unit = \"s\" }}\nsettings = {{ end = 1, steps = 100 }}\n\
             [[point]]\nname = \"p\"\nposition = [0, 0, 0]\nmass = 1\n[[force]]\nname = \"push\"\non = \"p\"\ndirection = [1, 0, 0]\n\
             size = {{ type = \"formula\", value = \"if_less(t, tau, 1, 0)\" }}\n\
             [[functional]]\nname = \"speed\"\ntype = \"velocity\"\non = \"p\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n"
        );
        let scene = parsed(&text);
        let prepared = Prepared::new(&scene).expect("sound");
        let why = prepared.run().expect("runs").gradient().expect_err("no derivative").to_string();
        assert!(why.contains("push") && why.contains(end), "{why}");
    }
}
