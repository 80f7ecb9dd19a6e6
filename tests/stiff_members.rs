//! Steps far above the period of a stiff member find their solution, and the member's force is right where the method damps it.

#[path = "../verification/work-precision/scenes.rs"]
mod scenes;

use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepRecord, march, table_by_name};
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

/// Corrections stall at the round-off of the bar's force, wherever the bar points.
#[test]
fn projections_end_at_the_round_off_of_a_stiff_force() {
    for table in ["sdirk4", "esdirk3", "esdirk4", "esdirk5", "dirk3"] {
        for steps in [400, 900, 1600] {
            peak(table, ConstraintLevel::Acceleration, steps);
        }
    }
}
