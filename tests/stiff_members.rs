//! Steps far above the period of a stiff member find their solution, and the member's force is right where the method damps it.

#[path = "../verification/robustness/cantilever.rs"]
mod cantilever;
#[path = "../verification/robustness/elastica.rs"]
mod elastica;
#[path = "../verification/work-precision/scenes.rs"]
mod scenes;

use cantilever::{Line, SlenderCantilever};
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepRecord, table_by_name};
use costate::internals::march;
use costate::scenes::{Prepared, Settings};
use scenes::StiffChain;

/// Peak of the bar's force at the ends of steps [N].
fn peak(table: &str, level: ConstraintLevel, steps: usize) -> f64 {
    let method = Method::new(table_by_name(table).expect("listed"), level);
    let prepared = Prepared::with(&StiffChain, &[1.0], method, Settings::new(1.0, steps)).expect("a sound scene");
    let mut peak: f64 = 0.0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        peak = peak.max(StiffChain::axial_force(&prepared, &step.q).abs());
        true
    });
    let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch);
    if let Err(error) = run {
        panic!("{table} at {} level, {steps} steps: {error}", level.name());
    }
    peak
}

/// 51.2 N is right.
#[test]
fn damped_methods_of_stage_order_two_find_the_force() {
    for table in ["esdirk3", "esdirk4"] {
        for level in ConstraintLevel::ALL {
            for steps in [100, 400] {
                let peak = peak(table, level, steps);
                assert!((peak - 51.2).abs() < 0.5, "{table} at {} level, {steps} steps: {peak} N", level.name());
            }
        }
    }
}

/// The bar rings with 14,000 N between the steps; an old matrix leads such corrections astray.
#[test]
fn ringing_steps_are_solved() {
    for table in ["dirk2", "dirk3"] {
        for level in ConstraintLevel::ALL {
            let peak = peak(table, level, 100);
            assert!((13_000.0..18_000.0).contains(&peak), "{table} at {} level: {peak} N", level.name());
        }
    }
}

/// Corrections stall at the round-off of the bar's force, wherever the bar points; it is right, or rings less with shorter steps.
#[test]
fn projections_end_at_the_round_off_of_a_stiff_force() {
    for table in ["esdirk3", "esdirk4", "esdirk5"] {
        for steps in [400, 900, 1600] {
            let peak = peak(table, ConstraintLevel::Acceleration, steps);
            assert!((peak - 51.21).abs() < 0.06, "{table}, {steps} steps: {peak} N");
        }
    }
    for table in ["sdirk4", "dirk3"] {
        let [long, _, short] = [400, 900, 1600].map(|steps| peak(table, ConstraintLevel::Acceleration, steps) - 51.21);
        assert!(short > 0.0 && long > 10.0 * short, "{table}: {long} and {short} N too much");
    }
}

/// EA L2/EI = 1e10: a correction that bends the beam or cable stretches it by a force that would keep the next one from bending it.
#[test]
fn equilibria_of_very_slender_members_are_found_with_their_gradients() {
    let beams = [(1.0, 5, false), (10.0, 5, false), (10.0, 20, true)].map(|own| (Line::Beam, 3e-4, own));
    // eight cubics bend less exactly
    let cables = [Line::Cable, Line::SmallStrainCable].map(|line| (line, 8e-3, (4.0, 20, false)));
    for (line, limit, (load, steps, settings)) in beams.into_iter().chain(cables) {
        let settings = if settings { Settings::statics(steps).dividing_steps() } else { Settings::statics(steps) };
        let scene = SlenderCantilever { line, axial: 1e10, load, elements: 8, settings, sudden: false };
        let prepared = Prepared::new(&scene).expect("sound");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&[load]).expect("runs");
        let expected = elastica::tip(load);
        // of the curve, and of its difference under a change of the load
        let [more, less] = [1e-4, -1e-4].map(|change| elastica::tip(load + change));
        let adjoint = analysis.adjoint(&[load], &forward).expect("adjoint");
        for i in 0..2 {
            let slope = (more[i] - less[i]) / 2e-4;
            assert!(
                (forward.values[i] - expected[i]).abs() < limit,
                "{line:?}, load {load}: {} for {}",
                forward.values[i],
                expected[i]
            );
            let own = adjoint.rows[i][0];
            assert!((own - slope).abs() < limit, "{line:?}, load {load}: {own} for {slope}");
        }
    }
}

/// A load of 4 EI / L2 throws the beam beyond a right angle; axial waves are 1e5 times as fast as it bends.
#[test]
fn motions_of_very_slender_beams_need_no_steps_shorter_than_the_motion() {
    let tip = |axial: f64, steps: usize| {
        let settings = Settings::new(1.0, steps);
        let scene = SlenderCantilever { line: Line::Beam, axial, load: 4.0, elements: 8, settings, sudden: true };
        Prepared::new(&scene).expect("sound").analysis().forward(&[4.0]).expect("runs").values
    };
    let (coarse, fine) = (tip(1e10, 100), tip(1e6, 1000));
    assert!(coarse.iter().zip(&fine).all(|(a, b)| (a - b).abs() < 1e-3), "{coarse:?} against {fine:?}");
}
