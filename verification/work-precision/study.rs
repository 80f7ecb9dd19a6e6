//! Error against time for every integrator at every constraint level.

mod chain;
mod runs;
mod scenes;

use crate::verification::{Report, Study};
use chain::report_chain;
use costate::integrators::{ConstraintLevel, tables};
use costate::io::{Chart, Series, Style};
use costate::scenes::built_in::{CarAxis, DoublePendulum, HeavyTop, Pendulum};
use runs::{LEAST, Ladder, Motion};
use scenes::StiffChain;
use std::fmt::Write as _;

/// Errors for which times are compared.
const ERRORS: [f64; 3] = [1e-4, 1e-6, 1e-8];
/// Tables of the picture, at acceleration level: one of each kind, as many as there are colours.
const DRAWN: [&str; 7] = ["midpoint", "dirk3", "sdirk4", "esdirk3", "esdirk5", "generalized-alpha", "bdf2"];

const MOTIONS: [Motion; 6] = [
    Motion { name: "pendulum", scene: &Pendulum, end: 2.0, coarsest: 20, reference_steps: 8_000 },
    Motion { name: "pendulum-long", scene: &Pendulum, end: 40.0, coarsest: 800, reference_steps: 40_000 },
    Motion { name: "heavy-top", scene: &HeavyTop, end: 2.0, coarsest: 20, reference_steps: 8_000 },
    Motion { name: "car-axis", scene: &CarAxis, end: 3.0, coarsest: 100, reference_steps: 24_000 },
    Motion { name: "double-pendulum", scene: &DoublePendulum, end: 2.0, coarsest: 40, reference_steps: 8_000 },
    Motion { name: "stiff-chain", scene: &StiffChain, end: 1.0, coarsest: 50, reference_steps: 20_000 },
];

/// The study.
pub struct WorkPrecision;

impl Study for WorkPrecision {
    fn name(&self) -> &'static str {
        "work-precision"
    }
    fn summary(&self) -> &'static str {
        "error against time for every integrator at every constraint level, and the force in a stiff member"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| error.to_string())?;
        pool.install(|| measure(report))
    }
}

fn measure(report: &mut Report) -> Result<(), String> {
    let mut charts = Vec::new();
    for (index, motion) in MOTIONS.iter().enumerate() {
        eprintln!("[{}/{}] {}", index + 1, MOTIONS.len(), motion.name);
        let reference = match motion.reference() {
            Ok(reference) => reference,
            Err(error) => {
                report.at_most(format!("{}/error of the reference, estimated", motion.name), f64::NAN, LEAST);
                report.note(error);
                continue;
            }
        };
        if motion.name == "car-axis" {
            compare_car_axis(report, &reference.end)?;
        }
        if motion.name == "stiff-chain" {
            report_chain(report, motion, &reference)?;
        }
        let mut ladders = Vec::new();
        for table in tables() {
            for level in ConstraintLevel::ALL {
                ladders.push(motion.ladder(&table, level, &reference.end)?);
            }
        }
        let smallest = ladders.iter().flat_map(Ladder::shown).map(|run| run.error).fold(f64::INFINITY, f64::min);
        report.inform(format!("{}/smallest error shown", motion.name), smallest);
        report.inform(format!("{}/error of the reference, estimated", motion.name), reference.error);
        report.inform(format!("{}/steps of the reference", motion.name), reference.steps as f64);
        report.at_most(
            format!("{}/100 estimated errors by the smallest shown", motion.name),
            100.0 * reference.error / smallest,
            1.0,
        );
        report_times(report, motion, &ladders);
        report.note(times_table(motion, &ladders));
        charts.push(chart(motion, &ladders));
    }
    if let Some(last) = charts.last_mut() {
        last.x_label = "time [ms]".into();
    }
    report.picture("work-precision", charts);
    Ok(())
}

/// The published test problem's end values, recomputed: its reference solution is good to about ten digits.
fn compare_car_axis(report: &mut Report, ends: &[f64]) -> Result<(), String> {
    // left and right end, x y z each
    for (place, name) in [(0, "xl"), (1, "yl"), (3, "xr"), (4, "yr")] {
        let csv = include_str!("../rigid-benchmarks/car_axis_final.csv");
        let line = csv.lines().find(|line| line.split(',').next() == Some(name));
        let published = line.and_then(|line| line.split(',').nth(2)?.parse().ok()).ok_or(format!("no row {name}"))?;
        report.compare(format!("car-axis/{name} of the reference"), ends[place], published, 1e-9);
    }
    Ok(())
}

/// The fastest for each error, as figures.
fn report_times(report: &mut Report, motion: &Motion, ladders: &[Ladder]) {
    for error in ERRORS {
        let name = |what: &str| format!("{}/{error:e}/{what}", motion.name);
        if let Some((ladder, time)) = cheapest(ladders, error) {
            report.inform(name(&format!("least time [ms]: {} at {} level", ladder.table, ladder.level.name())), 1e3 * time);
        }
        let reached = ladders.iter().filter(|ladder| ladder.time_for(error).is_some()).count();
        report.inform(name(&format!("combinations of {} that reach it", ladders.len())), reached as f64);
    }
}

fn cheapest(ladders: &[Ladder], error: f64) -> Option<(&Ladder, f64)> {
    let times = ladders.iter().filter_map(|ladder| Some((ladder, ladder.time_for(error)?)));
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Time for each error by table and level, the fastest in bold; work of the finest run; steps without a solution.
fn times_table(motion: &Motion, ladders: &[Ladder]) -> String {
    let mut text = format!("Times for {} over {} s.\n\n", motion.name, motion.end);
    text += "| integrator | level | 1e-4 [ms] | 1e-6 [ms] | 1e-8 [ms] | finest: steps | error | Newton iterations | factorizations | no solution with steps |\n";
    text += "|---|---|---:|---:|---:|---:|---:|---:|---:|---|\n";
    for ladder in ladders {
        let _ = write!(text, "| {} | {} |", ladder.table, ladder.level.name());
        for error in ERRORS {
            let fastest = cheapest(ladders, error).is_some_and(|(best, _)| std::ptr::eq(best, ladder));
            let bold = if fastest { "**" } else { "" };
            let _ = match ladder.time_for(error) {
                Some(time) => write!(text, " {bold}{:.2}{bold} |", 1e3 * time),
                None => write!(text, " - |"),
            };
        }
        let _ = match ladder.runs.last() {
            Some(run) => {
                let error = if run.error < LEAST { format!("below {LEAST:e}") } else { format!("{:.1e}", run.error) };
                let counters = run.counters;
                write!(text, " {} | {error} | {} | {} |", run.steps, counters.iterations, counters.factorizations)
            }
            None => write!(text, " - | - | - | - |"),
        };
        let failed: Vec<String> = ladder.failed.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, " {} |", failed.join(", "));
    }
    text
}

fn chart(motion: &Motion, ladders: &[Ladder]) -> Chart {
    let drawn = |ladder: &&Ladder| ladder.level == ConstraintLevel::Acceleration && DRAWN.contains(&ladder.table.as_str());
    let series = |ladder: &Ladder| Series {
        name: ladder.table.clone(),
        // a run that is wrong altogether would only stretch the axis
        points: ladder.shown().filter(|run| run.error < 1.0).map(|run| (1e3 * run.seconds, run.error)).collect(),
        style: Style::Both,
    };
    Chart {
        title: format!("{}, {} s, acceleration level", motion.name, motion.end),
        y_label: "relative error".into(),
        series: ladders.iter().filter(drawn).map(series).collect(),
        log_x: true,
        log_y: true,
        ..Chart::default()
    }
}
