//! Loops: through dead points, with redundant equations over many steps, and driven away from poses near a singular one.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::bent_shafts::BentShafts;
use super::four_bar::{Drive, FourBar};
use super::{WRONG, drift, initial, prepare};
use crate::Report;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepControl, StepRecord, table_by_name};
use costate::internals::{march, march_adaptive};
use costate::scalar::Quaternion;
use costate::scenes::{AnyScene, Prepared, Settings, Violation, built_in};
use std::f64::consts::TAU;

/// Turns of the crank through its dead points.
const TURNS: f64 = 100.0;
/// Steps over which a redundant loop runs.
const MANY: usize = 100_000;
/// Integrators whose equal steps are watched near a dead point.
const METHODS: [&str; 5] = ["esdirk4", "bdf2", "generalized-alpha", "newmark", "midpoint"];
/// Angle off its closed form that is none of the method's error [rad].
const LEAP: f64 = 0.05;
/// Largest gap of a joint, dropped equations included.
const GAP: f64 = 1e-14;

/// Runs, and gives `each` the time and the coordinates after every step.
fn follow(prepared: &Prepared, mut each: impl FnMut(f64, &[f64])) -> Result<Violation, String> {
    let mut worst = Violation::default();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let end = step.t + step.h;
        worst = worst.worse(prepared.violation(end, &step.q, &step.v));
        each(end, &step.q);
        true
    });
    let Prepared { method, grid, plan, .. } = prepared;
    let end = match &prepared.control {
        Some(control) => march_adaptive(&prepared.problem(), method, control, grid, plan, &mut watch).1,
        None => march(&prepared.problem(), method, grid, plan, &mut watch),
    };
    end.map_err(|error| error.to_string())?;
    Ok(worst)
}

/// Angle by which a body has turned since the start about an axis of its frame, x, y or z [rad], in (-pi, pi].
fn turned_about(prepared: &Prepared, q: &[f64], body: &str, axis: usize) -> f64 {
    let node = prepared.model().nodes.iter().find(|node| node.name == body).expect("a body of this scene");
    let of = |q: &[f64]| Quaternion::from_slice(&q[node.dofs.start + 3..]);
    let relative = of(&prepared.mechanism.numbers.q).conjugate().times(of(q)).0;
    let angle = 2.0 * relative[1 + axis].atan2(relative[0]);
    angle - TAU * (angle / TAU).round()
}

/// About z.
fn turned(prepared: &Prepared, q: &[f64], body: &str) -> f64 {
    turned_about(prepared, q, body, 2)
}

/// The end of a motion against its closed form, or an error that names one of the joints.
fn right_or_refused(
    report: &mut Report,
    figure: impl Fn(&str) -> String,
    found: Result<(f64, f64), String>,
    (exact, allowed): (f64, f64),
    joints: &[&str],
) {
    match found {
        Ok((end, gap)) => {
            report.at_most(figure("angle against closed form [rad]"), (end - exact).abs(), allowed);
            report.at_most(figure("joint gap [m]"), gap, 1e-13);
        }
        Err(error) => {
            report.inform(figure("refused"), 1.0);
            let named = joints.iter().any(|joint| error.contains(joint));
            report.at_most(figure("refused without a word of a joint"), f64::from(u8::from(!named)), 0.0);
            report.note(format!("{}: {error}", figure("refused")));
        }
    }
}

/// The crank driven through 100 turns, the rocker held against its closed form; then a flywheel that carries the linkage through
/// the dead points while a spring acts on the rocker, whose force has no moment on the crank there.
pub fn dead_points(report: &mut Report) -> Result<(), String> {
    let rate = 10.0;
    let end = TURNS * TAU / rate;
    let scene = FourBar { crank: 0.3, drive: Drive::Crank(rate) };
    let prepared = prepare(&scene, Prepared::default_method(), end, 40 * TURNS as usize)?;
    let start = FourBar::rocker_of_crank(scene.crank);
    let mut apart = 0.0_f64;
    let worst = follow(&prepared, |t, q| {
        let exact = FourBar::rocker_of_crank(scene.crank + rate * t) - start;
        let error = (turned(&prepared, q, "rocker") - exact).abs();
        apart = if error <= apart { apart } else { error };
    })?;
    report.at_most("four-bar, driven crank, 100 turns/rocker against closed form [rad]", apart, 1e-11);
    // the drive compares an angle of 628 rad, of which the last bit is 1.1e-13
    let last_bit = TURNS * TAU * f64::EPSILON;
    report.at_most(
        "four-bar, driven crank, 100 turns/joint gap [m], angle of the drive [rad]",
        worst.position,
        GAP + last_bit,
    );

    let scene = FourBar { crank: FourBar::dead_point(), drive: Drive::Flywheel(rate) };
    let prepared = prepare(&scene, Prepared::default_method(), end, 400 * TURNS as usize)?;
    let (mut turns, mut last) = (0.0, 0.0);
    follow(&prepared, |_, q| {
        let now = turned(&prepared, q, "crank");
        turns += (now - last - TAU * ((now - last) / TAU).round()) / TAU;
        last = now;
    })?;
    report.inform("four-bar, flywheel/turns through the dead points", turns);
    let (energy, worst) = drift(&prepared)?;
    report.at_most("four-bar, flywheel/largest change of energy, relative", energy, 1e-7);
    report.at_most("four-bar, flywheel/joint gap [m]", worst.position, GAP);
    Ok(())
}

/// Bricard's mechanism over 100,000 steps of 5 ms: one of its thirty equations is left out.
pub fn redundant_loop(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("bricard")?, Prepared::default_method(), 5e-3 * MANY as f64, MANY)?;
    let (energy, worst) = drift(&prepared)?;
    let figure = |what: &str| format!("{MANY:e} steps/bricard/{what}");
    report.compare(figure("equations left out"), prepared.plan.dropped.len() as f64, 1.0, 0.0);
    report.at_most(figure("largest change of energy, relative"), energy, 1e-9);
    report.at_most(figure("joint gap, the equation left out included [m]"), worst.position, GAP);
    report.at_most(figure("Euler norm"), worst.norm, GAP);
    Ok(())
}

/// The rocker driven by 0.3 rad, the crank 1e-1 to 1e-8 rad beyond the dead point at the start: with chosen steps the right motion, on
/// the right side, or an error that names a joint. The crank turns at a rate that grows with the inverse of that angle: equal steps of
/// 2.5 ms may leap over the dead point to the other branch, which the sign of the determinant of the constraints' rows tells, whatever the method.
pub fn near_dead_point(report: &mut Report) -> Result<(), String> {
    const SWING: f64 = 0.3;
    for digit in 1..=8 {
        let figure = |what: &str| format!("rocker driven, crank 1e-{digit} rad beyond the dead point/{what}");
        let scene = FourBar { crank: FourBar::dead_point() + f64::powi(10.0, -digit), drive: Drive::Rocker(SWING, 1.0) };
        let exact = FourBar::crank_of_rocker(FourBar::rocker_of_crank(scene.crank) + SWING) - scene.crank;
        let end = |control: Option<StepControl>| -> Result<(f64, f64), String> {
            let settings = Settings { end: 1.0, steps: 400, control, ..scene.settings().without_method() };
            let prepared = Prepared::with(&scene, &initial(&scene), Prepared::default_method(), settings);
            let prepared = prepared.map_err(|error| error.to_string())?;
            let mut end = 0.0;
            let worst = follow(&prepared, |_, q| end = turned(&prepared, q, "crank"))?;
            Ok((end, worst.position))
        };
        let chosen = end(Some(StepControl::new(1e-6)));
        right_or_refused(report, figure, chosen, (exact, WRONG), &["drive", "pin", "bearing"]);
        for name in METHODS {
            let method = Method::new(table_by_name(name).expect("listed"), ConstraintLevel::default());
            let prepared = Prepared { method, ..prepare(&scene, Prepared::default_method(), 1.0, 400)? };
            let mut end = 0.0;
            let mut watch = Watch(|step: &StepRecord<f64>| {
                end = turned(&prepared, &step.q, "crank");
                true
            });
            let Prepared { method, grid, plan, .. } = &prepared;
            let equal = |what: &str| figure(&format!("equal steps, {name}/{what}"));
            match march(&prepared.problem(), method, grid, plan, &mut watch) {
                Ok(run) => {
                    let (off, estimated) = ((end - exact).abs(), run.error.map_or(0.0, |error| error.share));
                    report.inform(equal("angle against closed form [rad]"), off);
                    report.inform(equal("largest estimated error of a step"), estimated);
                    let untold = !(off <= LEAP) && run.leap.is_none();
                    // one that leaps and leaps back ends on the right branch
                    report.inform(equal("said to leap"), f64::from(u8::from(run.leap.is_some())));
                    report.at_most(equal("on the other branch without a word"), f64::from(u8::from(untold)), 0.0);
                }
                Err(error) => report.note(format!("{}: {error}", equal("refused"))),
            }
        }
    }
    Ok(())
}

/// Two shafts at 90 degrees less 1e-1 to 1e-8 rad, driven from the output until the input has turned by 1 rad: what the last bit of
/// the output's angle does grows with the inverse of what the angle lacks.
pub fn bent_shafts(report: &mut Report) -> Result<(), String> {
    for digit in 1..=8 {
        let figure = |what: &str| format!("universal joint, 1e-{digit} rad short of 90 degrees/{what}");
        let short = f64::powi(10.0, -digit);
        let scene = BentShafts { short };
        let found = prepare(&scene, Prepared::default_method(), 1.0, 200).and_then(|prepared| {
            let mut end = 0.0;
            let worst = follow(&prepared, |_, q| end = turned_about(&prepared, q, "input", 0))?;
            Ok((end, worst.position))
        });
        right_or_refused(report, figure, found, (BentShafts::INPUT, 1e-14 / short), &["drive", "universal", "bearing"]);
    }
    Ok(())
}
