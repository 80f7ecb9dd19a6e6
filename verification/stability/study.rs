//! Long runs, small steps, unequal masses, other units, and poses near a singular one.

mod bent_shafts;
mod condition;
mod four_bar;
mod loops;
mod scenes;

use crate::{Form, Report, Study};
use condition::condition;
use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepRecord, table_by_name, tables};
use costate::internals::{Measured, VectorsAvq, march};
use costate::scenes::{AnyScene, Prepared, Settings, Violation, built_in};
use costate::sensitivity::largest_difference;
use rayon::prelude::*;
use scenes::{Arm, NearlyParallelRods, UnequalMasses, Units};

/// Steps of the long runs.
const LONG: usize = 1_000_000;
/// The same in the short form.
const SHORTENED: usize = 100_000;
/// Their size [s].
const LONG_STEP: f64 = 1e-2;
/// Unstable along the imaginary axis: the energy of what swings without damping grows, until there is no solution.
const GROWING: &str = "bdf3";
/// Steps from which gradients at small h are taken.
const FEW: usize = 3;
/// Largest difference of adjoint and complex step at acceleration level, relative to the largest entry.
const EXACT: f64 = 1e-12;
/// Largest relative difference between units.
const UNITS: f64 = 1e-10;
/// An answer that is further off than this is wrong.
const WRONG: f64 = 1e-6;

/// The study.
pub struct Stability;

impl Study for Stability {
    fn name(&self) -> &'static str {
        "stability"
    }
    fn summary(&self) -> &'static str {
        "a million steps, steps down to 1e-8 s, mass ratios to 1e8, other units, nearly singular poses, loops and dead points"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        small_steps(report)?;
        mass_ratios(report)?;
        units(report)?;
        near_singular(report)?;
        loops::dead_points(report)?;
        loops::near_dead_point(report)?;
        loops::bent_shafts(report)?;
        loops::redundant_loop(report)?;
        long_runs(report)
    }
}

fn initial(scene: &dyn AnyScene) -> Vec<f64> {
    scene.variables().iter().map(|variable| variable.initial).collect()
}

fn prepare(scene: &dyn AnyScene, method: Method, end: f64, steps: usize) -> Result<Prepared<'_>, String> {
    let settings = Settings { end, steps, ..scene.settings().without_method() };
    Prepared::with(scene, &initial(scene), method, settings).map_err(|error| error.to_string())
}

fn default_at(level: ConstraintLevel) -> Method {
    Method { level, ..Prepared::default_method() }
}

/// Energy and constraints over many steps, for every table.
fn long_runs(report: &mut Report) -> Result<(), String> {
    let scenes = ["free-body", "pendulum"];
    let runs: Vec<_> = scenes.iter().flat_map(|scene| tables().into_iter().map(move |table| (scene, table))).collect();
    let steps = if report.is_short() { SHORTENED } else { LONG };
    let drifts: Vec<Result<(f64, Violation), String>> = runs
        .par_iter()
        .map(|(scene, table)| {
            let method = Method::new(table.clone(), ConstraintLevel::Acceleration);
            drift(&prepare(built_in::named(scene)?, method, steps as f64 * LONG_STEP, steps)?)
        })
        .collect();
    for ((name, table), outcome) in runs.iter().zip(drifts) {
        let figure = |what: &str| format!("{steps:e} steps/{name}/{}/{what}", table.name);
        let (energy, worst) = match outcome {
            Ok(drift) => drift,
            Err(error) if table.name == GROWING => {
                report.inform(figure("ends without a solution"), 1.0);
                report.note(format!("{}: {error}", figure("run")));
                continue;
            }
            Err(error) => return Err(format!("{}: {error}", figure("run"))),
        };
        report.inform(figure("largest change of energy, relative"), energy);
        report.at_most(figure("joint gap [m]"), worst.position, 1e-14);
        report.at_most(figure("joint rate [m/s]"), worst.velocity, 1e-13);
        report.at_most(figure("Euler norm"), worst.norm, 1e-14);
    }
    Ok(())
}

/// Largest change of the energy, relative to the largest kinetic energy, and the largest violation of the constraints.
fn drift(prepared: &Prepared) -> Result<(f64, Violation), String> {
    let (model, p) = (prepared.model(), &prepared.mechanism.numbers.p);
    let measured = Measured::energy();
    let energy = |q: &[f64], v: &[f64]| {
        let at = VectorsAvq { a: Vec::new(), v: v.to_vec(), q: q.to_vec() };
        measured.value(model, &Sample { at, ..Sample::empty() }, p)
    };
    let start = energy(&prepared.mechanism.numbers.q, &prepared.mechanism.numbers.v);
    let (mut worst, mut change, mut kinetic) = (Violation::default(), 0.0_f64, start.abs());
    let mut index = 0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        index += 1;
        // a sample is enough for a drift
        if index % 10 == 0 {
            worst = worst.worse(prepared.violation(step.t + step.h, &step.q, &step.v));
            let (now, rest) = (energy(&step.q, &step.v), energy(&step.q, &vec![0.0; step.v.len()]));
            change = change.max((now - start).abs());
            kinetic = kinetic.max((now - rest).abs());
        }
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).map_err(|e| e.to_string())?;
    Ok((change / kinetic, worst))
}

/// Gradients of a few steps of shrinking size, at every level, beside the condition of the stage matrix.
fn small_steps(report: &mut Report) -> Result<(), String> {
    let scene = Arm(Units::SI);
    let x = initial(&scene);
    for digit in 1..=8 {
        let h = f64::powi(10.0, -digit);
        for level in ConstraintLevel::ALL {
            let figure = |what: &str| format!("h = 1e-{digit}/{}/{what}", level.name());
            let prepared = prepare(&scene, default_at(level), FEW as f64 * h, FEW)?;
            report.inform(figure("condition of the stage matrix"), condition(&prepared)?);
            let analysis = prepared.analysis();
            let compared = analysis.forward(&x).and_then(|forward| {
                let (adjoint, check) = (analysis.adjoint(&x, &forward)?, analysis.complex_step(&x, &forward)?);
                let rows = adjoint.rows.iter().zip(&check.rows);
                Ok(rows.map(|(a, c)| largest_difference(c, a)).fold(0.0, |most: f64, d| if d <= most { most } else { d }))
            });
            match (compared, level) {
                (Ok(difference), ConstraintLevel::Acceleration) => {
                    report.at_most(figure("adjoint - complex step"), difference, EXACT);
                }
                (Ok(difference), _) => report.inform(figure("adjoint - complex step"), difference),
                (Err(error), level) => {
                    if level == ConstraintLevel::Acceleration {
                        report.at_most(figure("adjoint - complex step"), f64::NAN, EXACT);
                    }
                    report.note(format!("{}: {error}", figure("run")));
                }
            }
        }
    }
    Ok(())
}

/// Two masses of 1 kg and 1e-8 to 1e8 kg. Before a heavy mass the light one swings at a rate that grows with the root of the ratio:
/// the run covers as many of its swings.
fn mass_ratios(report: &mut Report) -> Result<(), String> {
    for digit in (-8..=8).step_by(2) {
        let ratio = f64::powi(10.0, digit);
        let figure = |what: &str| format!("mass ratio 1e{digit}/{what}");
        let scene = UnequalMasses { ratio };
        let x = initial(&scene);
        let table = table_by_name("sdirk4").ok_or("sdirk4 is not listed")?;
        let prepared = prepare(&scene, Method::new(table, ConstraintLevel::Acceleration), 1.0 / ratio.max(1.0).sqrt(), 500)?;
        let (energy, worst) = drift(&prepared)?;
        report.inform(figure("largest change of energy, relative"), energy);
        report.at_most(figure("joint gap [m]"), worst.position, 1e-14);
        let analysis = prepared.analysis();
        let words = |error: costate::integrators::RunError| format!("{}: {error}", figure("run"));
        let forward = analysis.forward(&x).map_err(words)?;
        let adjoint = analysis.adjoint(&x, &forward).map_err(words)?;
        let check = analysis.complex_step(&x, &forward).map_err(words)?;
        let scaled = |row: &[f64]| row.iter().zip(&x).map(|(g, x)| g * x).collect::<Vec<_>>();
        for ((functional, a), c) in prepared.functionals().iter().zip(&adjoint.rows).zip(&check.rows) {
            let difference = largest_difference(&scaled(c), &scaled(a));
            report.at_most(figure(&format!("{}/adjoint - complex step", functional.name)), difference, EXACT);
        }
    }
    Ok(())
}

/// The same arm in metre, kilogram, second and in millimetre, tonne, second.
fn units(report: &mut Report) -> Result<(), String> {
    let solved = |scene: &Arm| -> Result<(Vec<f64>, Vec<Vec<f64>>), String> {
        let words = |error: costate::integrators::RunError| error.to_string();
        let prepared = prepare(scene, Prepared::default_method(), 1.0, 100)?;
        let forward = prepared.analysis().forward(&prepared.x).map_err(words)?;
        let gradient = prepared.analysis().adjoint(&prepared.x, &forward).map_err(words)?;
        let (of_values, of_variables) = (scene.functional_units(), scene.variable_units());
        let values = forward.values.iter().zip(of_values).map(|(value, unit)| value / unit).collect();
        let row = |(row, unit): (&Vec<f64>, f64)| row.iter().zip(of_variables).map(|(g, x)| g * x / unit).collect();
        Ok((values, gradient.rows.iter().zip(of_values).map(row).collect()))
    };
    let (values, rows) = solved(&Arm(Units::SI))?;
    let (other_values, other_rows) = solved(&Arm(Units::MILLIMETRE_TONNE))?;
    let (same_values, same_rows) = solved(&Arm(Units::POWERS_OF_TWO))?;
    let scene = Arm(Units::SI);
    let prepared = prepare(&scene, Prepared::default_method(), 1.0, 100)?;
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let figure = |what: &str| format!("m-kg-s against mm-t-s/{}/{what}", functional.name);
        report.at_most(figure("value"), (other_values[k] - values[k]).abs() / values[k].abs(), UNITS);
        report.at_most(figure("gradient"), largest_difference(&rows[k], &other_rows[k]), UNITS);
        let figure = |what: &str| format!("units of 1/1024 m and 1024 kg/{}/{what}", functional.name);
        report.at_most(figure("value"), (same_values[k] - values[k]).abs(), 0.0);
        report.at_most(figure("gradient"), largest_difference(&rows[k], &same_rows[k]), 0.0);
    }
    Ok(())
}

/// A pendulum whose second rod is nearly parallel to the first: an error, or the motion of the pendulum with one rod.
fn near_singular(report: &mut Report) -> Result<(), String> {
    let answer = |gap: f64| -> Result<[f64; 3], String> {
        let words = |error: costate::integrators::RunError| error.to_string();
        let scene = NearlyParallelRods { gap };
        let prepared = prepare(&scene, Prepared::default_method(), 1.0, 200)?;
        let forward = prepared.analysis().forward(&prepared.x).map_err(words)?;
        let gradient = prepared.analysis().adjoint(&prepared.x, &forward).map_err(words)?;
        Ok([forward.values[0], forward.values[1], gradient.rows[0][0]])
    };
    let right = answer(0.0)?;
    for digit in (0..=16).step_by(2) {
        let figure = |what: &str| format!("rods 1e-{digit} m apart/{what}");
        match answer(f64::powi(10.0, -digit)) {
            Ok(found) => {
                let apart = |k: usize| (found[k] - right[k]).abs();
                report.at_most(figure("position [m]"), apart(0).max(apart(1)), WRONG);
                report.at_most(figure("gradient, relative"), apart(2) / right[2].abs(), WRONG);
            }
            Err(error) => {
                report.inform(figure("refused"), 1.0);
                report.note(format!("{}: {error}", figure("refused")));
            }
        }
    }
    Ok(())
}
