//! The two masses on a stiff bar at two steps: position error, peak of the bar's force and error of the link's multiplier.

use super::course::{Forces, run};
use super::runs::{Motion, Reference, Steps, difference};
use crate::Report;
use costate::integrators::{ConstraintLevel, DEFAULT_TABLE, Method, tables};
use std::fmt::Write as _;

/// Steps over one second: h = 10 ms and 2.5 ms.
const STEPS: [usize; 2] = [100, 400];
/// Share by which a peak may differ from the one that the independent program printed with two or three digits.
const PEAK_DIGITS: f64 = 0.04;
/// Decades by which a position error may differ from the one printed with one digit.
const ERROR_DIGITS: f64 = 0.2;

/// At acceleration level, found with a program that shares nothing with this one: position error at h = 10 ms [m], and peaks of the
/// bar's force at the ends of steps at 10 ms and 2.5 ms [N].
const INDEPENDENT: [(&str, f64, [f64; 2]); 9] = [
    ("midpoint", 1e-3, [25_000.0, 1600.0]),
    ("dirk2", 5e-4, [17_000.0, 1100.0]),
    ("dirk3", 4e-4, [14_000.0, 900.0]),
    ("sdirk2", 5e-2, [200.0, 165.0]),
    ("sdirk3", 4e-2, [127.0, 117.0]),
    ("sdirk4", 2e-2, [90.0, 220.0]),
    ("bdf2", 5e-3, [51.0, 51.0]),
    ("generalized-alpha", 1.4e-3, [51.0, 51.0]),
    ("esdirk3", 9e-5, [51.0, 51.0]),
];

/// What one run of the chain shows.
struct Measured {
    /// Largest error of a coordinate at the end [m].
    error: f64,
    /// Peak of the bar's force at the ends of steps [N].
    peak: f64,
    /// Largest error of the link's multiplier at the last stages, by the largest multiplier.
    multiplier: f64,
}

fn measure(chain: &Motion, method: Method, steps: usize, reference: &Reference) -> Result<Measured, String> {
    let prepared = chain.prepared(method, Steps::Equal(steps))?;
    let mut forces = Forces::default();
    let (end, _) = run(&prepared, chain.member, Some(&mut forces)).map_err(|error| error.to_string())?;
    Ok(Measured {
        error: difference(&chain.moving(&prepared, &end.q), &reference.end),
        peak: forces.member.largest(),
        multiplier: forces.multipliers.error(&reference.forces.multipliers),
    })
}

/// Measures all tables at all levels with both steps, and holds those at acceleration level to the independent ones.
pub fn report_chain(report: &mut Report, chain: &Motion, reference: &Reference) -> Result<(), String> {
    let right = reference.forces.member.largest();
    report.compare("stiff-chain/peak force of the reference [N]", right, 51.0, 0.5);
    let mut text = format!("Two masses on a stiff bar, h = 10 ms and 2.5 ms; the right peak is {right:.2} N.\n\n");
    text += "| integrator | level | 10 ms: position [m] | peak force [N] | multiplier | 2.5 ms: position [m] | peak force [N] | multiplier |\n";
    text += "|---|---|---:|---:|---:|---:|---:|---:|\n";
    let mut unsolved = 0;
    for table in tables() {
        for level in ConstraintLevel::ALL {
            let _ = write!(text, "| {} | {} |", table.name, level.name());
            for (place, steps) in STEPS.into_iter().enumerate() {
                let figure = |what: &str| format!("stiff-chain/{}/h = {} ms/{what}", table.name, 1e3 / steps as f64);
                let measured = match measure(chain, Method::new(table.clone(), level), steps, reference) {
                    Ok(measured) => measured,
                    Err(message) => {
                        unsolved += 1;
                        report.note(format!("{} at {} level: {message}", figure("no solution"), level.name()));
                        Measured { error: f64::NAN, peak: f64::NAN, multiplier: f64::NAN }
                    }
                };
                let Measured { error, peak, multiplier } = measured;
                let _ = write!(text, " {error:.1e} | {peak:.1} | {multiplier:.1e} |");
                if level != ConstraintLevel::Acceleration {
                    continue;
                }
                if let Some((_, position, peaks)) = INDEPENDENT.iter().find(|(name, ..)| *name == table.name) {
                    let found = peaks[place];
                    report.compare(figure("peak force [N]"), peak, found, PEAK_DIGITS * found);
                    if place == 0 {
                        report.compare(figure("log10 of the position error"), error.log10(), position.log10(), ERROR_DIGITS);
                    }
                }
                if table.name == DEFAULT_TABLE {
                    report.compare(figure("peak force against the reference [N]"), peak, right, 1.0);
                }
            }
            text += "\n";
        }
    }
    report.at_most("stiff-chain/runs without a solution", f64::from(unsolved), 0.0);
    report.note(text.trim_end());
    Ok(())
}
