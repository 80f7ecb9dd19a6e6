//! Breakpoints: one at which nothing happens does no harm, wherever it lies; reactions stand at the times they are given for.

use costate::integrators::{Table, tables};
use costate::prelude::*;
use costate::scenes::FileScene;

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
    FileScene::parse("falling_beam.toml", &format!("{text}{more}")).expect("sound")
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
    let settings = Scene::settings(scene).without_method();
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
    let scene = FileScene::parse("pendulum.toml", text).expect("sound");
    for table in tables().into_iter().filter(|table| !table.is_static() && table.order >= 2) {
        for level in ConstraintLevel::ALL {
            let method = Method::new(table.clone(), level);
            let prepared = Prepared::with(&scene, &[], method, Scene::settings(&scene).without_method()).expect("sound");
            let run = prepared.run().expect("runs");
            let (joint, bob) = (run.joint("rod").expect("a joint"), run.node("bob").expect("a node"));
            for ((&t, force), place) in joint.times.iter().zip(&joint.forces).zip(&bob.positions) {
                let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
                let right = -3.0 * 9.81 * place[1];
                assert!((size - right).abs() < 1e-2, "{}, {level:?}, t = {t}: {size} N, not {right} N", table.name);
            }
        }
    }
}
