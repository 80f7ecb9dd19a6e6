//! The two masses on a stiff bar: position error and peak axial force at two steps, as in the design.

use super::runs::{Motion, Reference, relative_error};
use super::scenes::StiffChain;
use crate::verification::Report;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, DEFAULT_TABLE, Method, StepRecord, march, table_by_name};
use costate::scenes::{Prepared, Settings};

/// Steps over one second: h = 10 ms and 2.5 ms.
const STEPS: [usize; 2] = [100, 400];

/// What the design found at h = 10 ms: position error [m], and whether the bar's force is far off, at least this much [N].
const DESIGN: [(&str, f64); 9] = [
    ("midpoint", 1e-3),
    ("dirk2", 5e-4),
    ("dirk3", 4e-4),
    ("sdirk2", 5e-2),
    ("sdirk3", 4e-2),
    ("sdirk4", 2e-2),
    ("bdf2", 5e-3),
    ("generalized-alpha", 1.4e-3),
    ("esdirk3", 9e-5),
];
/// Methods of Boopathy & Kennedy: A-stable only, the bar rings.
const RINGING: [&str; 3] = ["midpoint", "dirk2", "dirk3"];
/// Force that they exceed at h = 10 ms [N].
const RINGS_ABOVE: f64 = 1000.0;

/// Relative error of the coordinates at the end and peak axial force [N] at the ends of steps.
fn measure(method: Method, steps: usize, exact: &[f64]) -> Result<[f64; 2], String> {
    let (q, peak) = run(method, steps)?;
    Ok([relative_error(&q, exact), peak])
}

/// Coordinates of both masses at the end, and the peak axial force at the ends of steps.
fn run(method: Method, steps: usize) -> Result<(Vec<f64>, f64), String> {
    let prepared =
        Prepared::with(&StiffChain, &[1.0], method, Settings::new(1.0, steps)).map_err(|error| error.to_string())?;
    let nodes = &prepared.model().nodes;
    let [first, second] = ["first", "second"].map(|name| nodes.iter().find(|node| node.name == name));
    let (Some(first), Some(second)) = (first, second) else { return Err("the masses are not found".into()) };
    let mut peak: f64 = 0.0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let force = StiffChain::axial_force(&step.q[first.dofs.clone()], &step.q[second.dofs.clone()]).abs();
        // a NaN wins
        peak = if force <= peak { peak } else { force };
        true
    });
    let end = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch);
    let q = end.map_err(|error| error.to_string())?.q;
    Ok(([first, second].into_iter().flat_map(|node| q[node.dofs.clone()].to_vec()).collect(), peak))
}

/// Measures all listed tables of the design at acceleration level, and holds them to what it says.
pub fn report_chain(report: &mut Report, chain: &Motion, reference: &Reference) -> Result<(), String> {
    let (_, right) = run(chain.reference_method(), reference.steps)?;
    report.compare("stiff-chain/peak force of the reference [N]", right, 51.0, 0.5);
    for (name, designed) in DESIGN {
        let Some(table) = table_by_name(name) else { continue };
        for (place, steps) in STEPS.into_iter().enumerate() {
            let milliseconds = 1e3 / steps as f64;
            let figure = |what: &str| format!("stiff-chain/{name}/h = {milliseconds} ms/{what}");
            let method = Method::new(table.clone(), ConstraintLevel::Acceleration);
            let [error, peak] = measure(method, steps, &reference.end).unwrap_or_else(|message| {
                report.note(format!("{}: {message}", figure("no solution")));
                [f64::NAN; 2]
            });
            report.inform(figure("relative error"), error);
            report.inform(figure("peak force [N]"), peak);
            if place > 0 {
                continue;
            }
            // the chain is 2 m long: the largest coordinate is of that size
            report.compare(figure("log10 of the error"), error.log10(), designed.log10(), 0.7);
            if RINGING.contains(&name) {
                report.at_most(figure("1000 N by the peak force"), RINGS_ABOVE / peak, 1.0);
            }
            if name == DEFAULT_TABLE {
                report.compare(figure("peak force against the reference [N]"), peak, right, 1.0);
            }
        }
    }
    Ok(())
}
