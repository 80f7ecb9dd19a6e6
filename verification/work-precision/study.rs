//! Error against time for every integrator at every constraint level.

mod andrews;
mod chain;
mod comparison;
mod course;
mod runs;
mod scenes;

use crate::{Clock, Form, Report, Study, on_one_thread};
use andrews::report_andrews;
use chain::report_chain;
use comparison::{AIMS, Aim, Measured, cheapest, report_comparison, report_tolerances};
use costate::integrators::{ConstraintLevel, NewtonTolerance, tables};
use costate::scenes::{AnyScene, built_in};
use costate_cli::{Chart, Series, Style};
use runs::{FINE, Ladder, Motion, Reference, Run};
use scenes::StiffChain;
use std::fmt::Write as _;

/// Tables of the picture, at acceleration level: one of each kind, as many as there are colours.
const DRAWN: [&str; 7] = ["midpoint", "dirk3", "sdirk4", "esdirk3", "esdirk4", "esdirk5", "generalized-alpha"];

/// The motion of the short form.
const SHORT: &str = "pendulum";

/// Largest error of a reference: a hundredth of the smallest error that is read off.
const REFERENCE: f64 = 0.01 * FINE;
/// Errors below this many times that of the reference are not shown.
const SHOWN: f64 = 10.0;

/// A motion without a stiff member.
fn rigid(name: &'static str, scene: &'static dyn AnyScene, end: f64, [coarsest, reference_steps]: [usize; 2]) -> Motion {
    Motion { name, scene, end, coarsest, reference_steps, most_systems: 40_000, member: None, compared: None, fine: FINE }
}

fn motions() -> Result<[Motion; 6], String> {
    let pendulum = built_in::named("pendulum")?;
    Ok([
        rigid("pendulum", pendulum, 2.0, [20, 8_000]),
        Motion { most_systems: 160_000, ..rigid("pendulum-long", pendulum, 40.0, [800, 80_000]) },
        rigid("heavy-top", built_in::named("heavy-top")?, 2.0, [20, 8_000]),
        rigid("car-axis", built_in::named("car-axis")?, 3.0, [100, 24_000]),
        rigid("double-pendulum", built_in::named("double-pendulum")?, 2.0, [40, 8_000]),
        Motion { member: Some(StiffChain::axial_force), ..rigid("stiff-chain", &StiffChain, 1.0, [50, 20_000]) },
    ])
}

/// The study.
pub struct WorkPrecision;

impl Study for WorkPrecision {
    fn name(&self) -> &'static str {
        "work-precision"
    }
    fn summary(&self) -> &'static str {
        "error against time for every integrator at every constraint level, and the force in a stiff member"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_one_thread(|| measure(report))
    }
}

fn measure(report: &mut Report) -> Result<(), String> {
    if !Clock::counts_computing() {
        report.note("This system does not tell how long a thread computes: times are those of the clock.");
    }
    let mut asked = Vec::from(motions()?);
    if report.is_short() {
        asked.retain(|motion| motion.name == SHORT);
    }
    let mut motions = Vec::new();
    let mut charts = Vec::new();
    let mut tables_by_motion = Vec::new();
    for (index, motion) in asked.iter().enumerate() {
        eprintln!("[{}/{}] {}", index + 1, asked.len(), motion.name);
        let reference = match motion.reference() {
            Ok(reference) => reference,
            Err(error) => {
                report.at_most(format!("{}/error of the reference, estimated", motion.name), f64::NAN, REFERENCE);
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
        let ladders = ladders(motion, &reference)?;
        report_reference(report, motion, &reference);
        report_times(report, motion, &ladders, &AIMS);
        tables_by_motion.push(times_table(motion, &ladders, &reference, &AIMS));
        charts.push(chart(motion, &ladders, "position", |run| run.error, reference.error, charts.is_empty()));
        if motion.member.is_some() {
            charts.push(chart(motion, &ladders, "force", |run| run.force_error, reference.force_error, false));
        }
        motions.push(Measured { name: motion.name, ladders });
    }
    if report.is_short() {
        return Ok(());
    }
    charts.extend(report_andrews(report)?);
    report_comparison(report, &motions);
    report_tolerances(report, &motions);
    tables_by_motion.into_iter().for_each(|table| report.note(table.trim_end()));
    if let Some(last) = charts.last_mut() {
        last.x_label = "time [ms]".into();
    }
    report.picture("work-precision", charts);
    Ok(())
}

/// All tables at all levels, and those that measure their error with chosen steps too.
fn ladders(motion: &Motion, reference: &Reference) -> Result<Vec<Ladder>, String> {
    let mut ladders = Vec::new();
    for table in tables() {
        for level in ConstraintLevel::ALL {
            ladders.push(motion.ladder(&table, level, NewtonTolerance::RoundOff, reference)?);
        }
        if table.embedded.is_some() && table.starter.is_none() {
            ladders.push(motion.chosen(&table, NewtonTolerance::RoundOff, reference)?);
        }
    }
    Ok(ladders)
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

/// How good the reference is against what is read off with it.
fn report_reference(report: &mut Report, motion: &Motion, reference: &Reference) {
    let name = |what: &str| format!("{}/{what}", motion.name);
    report.inform(name("steps of the reference"), reference.steps as f64);
    report.at_most(name("error of the reference, estimated"), reference.error, REFERENCE);
    let forces = AIMS.iter().filter(|aim| aim.name.starts_with("forces")).map(|aim| aim.limit);
    report.at_most(
        name("error of the reference's forces, estimated"),
        reference.force_error,
        0.01 * forces.fold(1.0, f64::min),
    );
}

/// The fastest for each aim, as figures.
fn report_times(report: &mut Report, motion: &Motion, ladders: &[Ladder], aims: &[Aim]) {
    for aim in aims {
        let name = |what: &str| format!("{}/{}/{what}", motion.name, aim.name);
        if let Some((ladder, time)) = cheapest(ladders, aim) {
            report.inform(name(&format!("least time [ms]: {} at {} level", ladder.name, ladder.level.name())), 1e3 * time);
        }
        let reached = ladders.iter().filter(|ladder| ladder.time_for(aim.error, aim.limit).is_some()).count();
        report.inform(name(&format!("combinations of {} that reach it", ladders.len())), reached as f64);
    }
}

/// Time for each aim by table and level, the fastest in bold; work of the finest run; steps without a solution.
fn times_table(motion: &Motion, ladders: &[Ladder], reference: &Reference, aims: &[Aim]) -> String {
    let mut text = format!("Times [ms] for {} over {} s.\n\n", motion.name, motion.end);
    let names: Vec<&str> = aims.iter().map(|aim| aim.name).collect();
    let _ = writeln!(
        text,
        "| integrator | level | {} | finest: steps | error | error of forces | us per step | iterations per step | no solution with steps |",
        names.join(" | ")
    );
    let _ = writeln!(text, "|---|---|{}---:|---:|---:|---:|---:|---|", "---:|".repeat(aims.len()));
    for ladder in ladders {
        let _ = write!(text, "| {} | {} |", ladder.name, ladder.level.name());
        for aim in aims {
            let fastest = cheapest(ladders, aim).is_some_and(|(best, _)| std::ptr::eq(best, ladder));
            let bold = if fastest { "**" } else { "" };
            let _ = match ladder.time_for(aim.error, aim.limit) {
                Some(time) => write!(text, " {bold}{:.2}{bold} |", 1e3 * time),
                None => write!(text, " - |"),
            };
        }
        let _ = match ladder.runs.last() {
            Some(run) => {
                let least = SHOWN * reference.error;
                let error = if run.error < least { format!("below {least:.0e}") } else { format!("{:.1e}", run.error) };
                let by_step = |number: f64| number / run.steps as f64;
                let (time, iterations) = (by_step(1e6 * run.seconds), by_step(run.counters.iterations as f64));
                write!(text, " {} | {error} | {:.1e} | {time:.0} | {iterations:.1} |", run.steps, run.force_error)
            }
            None => write!(text, " - | - | - | - | - |"),
        };
        let failed: Vec<String> = ladder.failed.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, " {} |", failed.join(", "));
    }
    text
}

fn chart(motion: &Motion, ladders: &[Ladder], what: &str, error: fn(&Run) -> f64, of_reference: f64, named: bool) -> Chart {
    let drawn = |name: &str| ladders.iter().find(|l| l.level == ConstraintLevel::Acceleration && l.name == name);
    let shown = SHOWN * of_reference..1.0;
    let series = |ladder: &Ladder| Series {
        // the same colours everywhere: one legend is enough
        name: if named { ladder.name.clone() } else { String::new() },
        // a run that is wrong altogether would only stretch the axis
        points: ladder
            .runs
            .iter()
            .filter(|run| shown.contains(&error(run)))
            .map(|run| (1e3 * run.seconds, error(run)))
            .collect(),
        style: Style::Both,
    };
    Chart {
        title: format!("{}, {} s, acceleration level", motion.name, motion.end),
        y_label: format!("{what} error"),
        series: DRAWN.iter().filter_map(|name| drawn(name)).map(series).collect(),
        log_x: true,
        log_y: true,
        ..Chart::default()
    }
}
