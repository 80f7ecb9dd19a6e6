//! What each integrator costs against the cheapest, over all motions.

use super::runs::{Ladder, Run, Steps};
use crate::Report;
use costate::integrators::{ConstraintLevel, DEFAULT_TABLE};
use std::fmt::Write as _;

/// An accuracy for which times are compared.
pub struct Aim {
    /// As in the head of a table.
    pub name: &'static str,
    pub error: fn(&Run) -> f64,
    pub limit: f64,
}

/// Accuracies in coordinates and in forces.
pub const AIMS: [Aim; 5] = [
    Aim { name: "position 1e-4", error: |run| run.error, limit: 1e-4 },
    Aim { name: "position 1e-6", error: |run| run.error, limit: 1e-6 },
    Aim { name: "position 1e-8", error: |run| run.error, limit: 1e-8 },
    Aim { name: "forces 1e-2", error: |run| run.force_error, limit: 1e-2 },
    Aim { name: "forces 1e-4", error: |run| run.force_error, limit: 1e-4 },
];

/// A motion with all its ladders.
pub struct Measured {
    pub name: &'static str,
    pub ladders: Vec<Ladder>,
}

/// The ladder that reaches an aim first, with its time [s].
pub fn cheapest<'l>(ladders: impl IntoIterator<Item = &'l Ladder>, aim: &Aim) -> Option<(&'l Ladder, f64)> {
    let times = ladders.into_iter().filter_map(|ladder| Some((ladder, ladder.time_for(aim.error, aim.limit)?)));
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// For each aim a table: times of the integrators at acceleration level by the least time of all integrators and levels.
pub fn report_comparison(report: &mut Report, motions: &[Measured]) {
    let Some(first) = motions.first() else { return };
    let shown = |ladder: &&Ladder| ladder.level == ConstraintLevel::Acceleration;
    for aim in &AIMS {
        let mut text =
            format!("Times for {} at acceleration level by the least time of all integrators and levels.\n\n", aim.name);
        let names: Vec<&str> = motions.iter().map(|motion| motion.name).collect();
        let _ = writeln!(text, "| integrator | {} | worst |", names.join(" | "));
        let _ = writeln!(text, "|---|{}---:|", "---:|".repeat(names.len()));
        for own in first.ladders.iter().filter(shown) {
            let mut worst: f64 = 0.0;
            let _ = write!(text, "| {} |", own.name);
            for motion in motions {
                let least = cheapest(&motion.ladders, aim).map(|(_, time)| time);
                let same = motion.ladders.iter().filter(shown).find(|ladder| ladder.name == own.name);
                let time = same.and_then(|ladder| ladder.time_for(aim.error, aim.limit));
                match time.zip(least) {
                    Some((time, least)) => {
                        worst = worst.max(time / least);
                        let _ = write!(text, " {:.1} |", time / least);
                    }
                    None => {
                        worst = f64::INFINITY;
                        text += " - |";
                    }
                }
            }
            if own.name == DEFAULT_TABLE {
                report.inform(format!("default ({DEFAULT_TABLE})/{}/times the least time, worst motion", aim.name), worst);
            }
            let _ = if worst.is_finite() { writeln!(text, " {worst:.1} |") } else { writeln!(text, " - |") };
        }
        report.note(text.trim_end());
    }
}

/// What a tolerance of chosen steps leads to: errors of the coordinates at the end of each motion.
pub fn report_tolerances(report: &mut Report, motions: &[Measured]) {
    let Some(first) = motions.first() else { return };
    let names: Vec<&str> = motions.iter().map(|motion| motion.name).collect();
    let mut text = "Relative position errors where steps are chosen, and steps taken.\n\n".to_string();
    let _ = writeln!(text, "| integrator | tolerance | {} |", names.join(" | "));
    let _ = writeln!(text, "|---|---:|{}", "---:|".repeat(names.len()));
    for name in first.ladders.iter().map(|ladder| &ladder.name) {
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let run = |motion: &Measured| -> Option<Run> {
                let ladder = motion.ladders.iter().find(|ladder| ladder.name == *name)?;
                ladder.runs.iter().find(|run| run.laid == Steps::Chosen(tolerance)).copied()
            };
            let cells: Vec<Option<Run>> = motions.iter().map(run).collect();
            if cells.iter().all(Option::is_none) {
                continue;
            }
            let _ = write!(text, "| {name} | {tolerance:e} |");
            for cell in cells {
                let _ = match cell {
                    Some(run) => write!(text, " {:.0e}, {} |", run.error, run.steps),
                    None => write!(text, " - |"),
                };
            }
            text += "\n";
        }
    }
    report.note(text.trim_end());
}
