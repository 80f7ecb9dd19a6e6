//! A driven mechanism that leaps over a dead point, and one that does not.

// its closed forms are for the study
#[allow(dead_code)]
#[path = "../../verification/stability/four_bar.rs"]
mod four_bar;

use costate::history::Observer;
use costate::integrators::{ConstraintLevel, Method, RunError, StepRecord, table_by_name};
use costate::internals::{Run, march};
use costate::scenes::{Prepared, Scene, Settings};
use four_bar::{Drive, FourBar};

struct Nothing;

impl Observer for Nothing {
    fn step(&mut self, _: &StepRecord<f64>) -> Result<bool, RunError> {
        Ok(true)
    }
}

/// 400 equal steps of 2.5 ms.
fn run(scene: &FourBar, method: &str) -> Run<f64> {
    let method = Method::new(table_by_name(method).expect("listed"), ConstraintLevel::default());
    let x: Vec<f64> = Scene::variables(scene).iter().map(|variable| variable.initial).collect();
    let settings = Settings { end: 1.0, steps: 400, ..Scene::settings(scene).without_method() };
    let prepared = Prepared::with(scene, &x, method, settings).expect("a sound scene");
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut Nothing).expect("runs")
}

#[test]
fn a_step_over_a_dead_point_is_told() {
    for beyond in [1e-4, 1e-5] {
        let scene = FourBar { crank: FourBar::dead_point() + beyond, drive: Drive::Rocker(0.3, 1.0) };
        let run = run(&scene, "midpoint");
        let (t, step) = run.leap.unwrap_or_else(|| panic!("{beyond:e}: {} determinants and no leap", run.determinants));
        assert!(step <= 10 && t < 0.025, "{beyond:e}: step {step}, t = {t}");
    }
    let scene = FourBar { crank: FourBar::dead_point() + 0.1, drive: Drive::Rocker(0.3, 1.0) };
    assert_eq!(run(&scene, "midpoint").leap, None);
}

#[test]
fn no_determinant_is_taken_where_coordinates_change_as_their_rates_say() {
    let scene = FourBar { crank: 1.0, drive: Drive::Crank(3.0) };
    let run = run(&scene, "esdirk4");
    // that of the start
    assert_eq!((run.determinants, run.leap), (1, None));
}
