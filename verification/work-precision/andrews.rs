//! Andrews' squeezer: largest relative error of the seven angles against time, in these angles and of rigid bodies.

use super::comparison::{Aim, cheapest};
use super::runs::{Ladder, Motion, Reference};
use super::{REFERENCE, chart, report_times, times_table};
use crate::Report;
use crate::andrews::{self, PUBLISHED};
use crate::rigid_benchmarks::{angles_of_turns, body_angles, places_of_bodies};
use costate::integrators::{ConstraintLevel, NewtonTolerance, tables};
use costate::scenes::{Prepared, built_in};
use costate_cli::Chart;
use std::f64::consts::TAU;

/// Accuracies for which others' times are known.
const AIMS: [Aim; 3] = [
    Aim { name: "angles 1e-4", error: |run| run.error, limit: 1e-4 },
    Aim { name: "angles 1e-6", error: |run| run.error, limit: 1e-6 },
    Aim { name: "angles 1e-9", error: |run| run.error, limit: 1e-9 },
];

const PLANAR: Motion = Motion {
    name: "andrews",
    scene: &andrews::Andrews,
    end: 0.03,
    coarsest: 50,
    reference_steps: 8_000,
    most_systems: 40_000,
    member: None,
    compared: Some(|_, q| q.to_vec()),
    fine: 1e-10,
};
fn motions() -> Result<[Motion; 3], String> {
    Ok([
        PLANAR,
        Motion { name: "andrews, energies", scene: &andrews::Andrews, most_systems: 20_000, ..PLANAR },
        Motion {
            name: "andrews, rigid bodies",
            scene: built_in::named("andrews")?,
            most_systems: 20_000,
            compared: Some(angles),
            ..PLANAR
        },
    ])
}

/// The seven angles from the coordinates of rigid bodies: turns are whole ones from where the published angles are.
fn angles(prepared: &Prepared, q: &[f64]) -> Vec<f64> {
    let start = &prepared.mechanism.numbers.q;
    let Ok(places) = places_of_bodies(prepared) else { return vec![f64::NAN; 7] };
    let (first, last) = (body_angles(start, places), body_angles(q, places));
    let angles = angles_of_turns(std::array::from_fn(|i| last[i] - first[i]));
    let near = |(angle, published): (f64, f64)| angle + TAU * ((published - angle) / TAU).round();
    angles.into_iter().zip(PUBLISHED).map(near).collect()
}

/// All tables at acceleration level, the planar angles at the other level too, and chosen steps, with both rules for Newton's method; a chart
/// for each model.
pub fn report_andrews(report: &mut Report) -> Result<Vec<Chart>, String> {
    let mut charts = Vec::new();
    for motion in &motions()? {
        eprintln!("{}", motion.name);
        let reference = motion.reference()?;
        let ladders = ladders(motion, &reference)?;
        report.at_most(format!("{}/error of the reference, estimated", motion.name), reference.error, REFERENCE);
        // gradients need round-off: what motions alone cost is said beside it
        let (exact, scaled): (Vec<_>, Vec<_>) =
            ladders.into_iter().partition(|ladder| ladder.newton == NewtonTolerance::RoundOff);
        report_times(report, motion, &exact, &AIMS);
        for aim in &AIMS {
            if let Some((ladder, time)) = cheapest(&scaled, aim) {
                report.inform(format!("{}/{}/least time [ms]: {}", motion.name, aim.name, ladder.name), 1e3 * time);
            }
        }
        let ladders: Vec<Ladder> = exact.into_iter().chain(scaled).collect();
        report.note(times_table(motion, &ladders, &reference, &AIMS).trim_end());
        charts.push(chart(motion, &ladders, "angle", |run| run.error, reference.error, false));
    }
    Ok(charts)
}

fn ladders(motion: &Motion, reference: &Reference) -> Result<Vec<Ladder>, String> {
    let levels: &[ConstraintLevel] =
        if motion.name == PLANAR.name { &ConstraintLevel::ALL } else { &[ConstraintLevel::Acceleration] };
    let mut ladders = Vec::new();
    for table in tables() {
        for &level in levels {
            ladders.push(motion.ladder(&table, level, NewtonTolerance::RoundOff, reference)?);
        }
        ladders.push(motion.ladder(&table, ConstraintLevel::Acceleration, NewtonTolerance::Scaled, reference)?);
        if table.embedded.is_some() && table.starter.is_none() {
            for newton in [NewtonTolerance::RoundOff, NewtonTolerance::Scaled] {
                ladders.push(motion.chosen(&table, newton, reference)?);
            }
        }
    }
    Ok(ladders)
}
