//! The variational integrator: orders, what it conserves over a million steps, and its discrete adjoint.

mod scenes;

use crate::{Report, Study};
use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, RunError, StepRecord, discrete_momentum};
use costate::internals::{Measured, Problem, march, table_named};
use costate::scenes::{AnyScene, Prepared, built_in};
use costate::sensitivity::largest_difference;
use scenes::{Swinging, moment_of_momentum};

/// Places of the quadrature point.
const ALPHAS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Steps of the long runs.
const MANY: usize = 1_000_000;
/// A million roundings of the same sign.
const ROUND_OFF: f64 = 1e-10;
/// A drift would make the change of energy in the last fifth of a run five to nine times that in the first.
const BOUNDED: f64 = 2.0;
/// Largest difference of the exact gradients, relative to the largest entry of each row.
const EXACT: f64 = 1e-12;

/// The study.
pub struct Variational;

impl Study for Variational {
    fn name(&self) -> &'static str {
        "variational"
    }
    fn summary(&self) -> &'static str {
        "the variational integrator: orders, momenta and energy over a million steps, its discrete adjoint"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        orders(report).map_err(|error| error.to_string())?;
        gradients(report).map_err(|error| error.to_string())?;
        conservation(report).map_err(|error| error.to_string())
    }
}

fn prepare<'s>(scene: &'s dyn AnyScene, method: &str, end: f64, steps: usize) -> Result<Prepared<'s>, RunError> {
    let mut settings = scene.settings().without_method();
    (settings.end, settings.steps, settings.divide) = (end, steps, false);
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let table = table_named(method).map_err(RunError::Input)?;
    let table = table.ok_or_else(|| RunError::Input(format!("no method {method}")))?;
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings)
}

/// Hands every step to an observer.
fn watch(prepared: &Prepared, mut see: impl FnMut(&Problem<f64>, &StepRecord<f64>)) -> Result<(), RunError> {
    let problem = prepared.problem();
    let mut observer = Watch(|step: &StepRecord<f64>| {
        see(&problem, step);
        true
    });
    march(&problem, &prepared.method, &prepared.grid, &prepared.plan, &mut observer).map(|_| ())
}

/// Coordinates and velocities at the end.
fn end_of(prepared: &Prepared) -> Result<[Vec<f64>; 2], RunError> {
    let mut last = [Vec::new(), Vec::new()];
    watch(prepared, |_, step| last = [step.q.clone(), step.v.clone()])?;
    Ok(last)
}

fn orders(report: &mut Report) -> Result<(), RunError> {
    eprintln!("[1/3] orders");
    let scenes: [(&dyn AnyScene, f64, usize); 3] = [
        (built_in::named("double-pendulum")?, 0.5, 200),
        (built_in::named("heavy-top")?, 0.1, 200),
        (&Swinging::Cable { elements: 2 }, 0.2, 400),
    ];
    for (scene, end, coarsest) in scenes {
        let exact = end_of(&prepare(scene, "esdirk5", end, 16 * coarsest)?)?;
        for alpha in ALPHAS {
            let mut errors = Vec::new();
            for refinement in 0..4 {
                let own = end_of(&prepare(scene, &format!("variational:{alpha}"), end, coarsest << refinement)?)?;
                let error = |i: usize| own[i].iter().zip(&exact[i]).fold(0.0, |e: f64, (a, b)| e.max((a - b).abs()));
                errors.push(error(0));
            }
            let observed = (errors[2] / errors[3]).log2();
            let expected = if alpha == 0.5 { 2.0 } else { 1.0 };
            report.compare(format!("{}/alpha {alpha}/order of q", scene.name()), observed, expected, 0.1);
        }
    }
    Ok(())
}

fn gradients(report: &mut Report) -> Result<(), RunError> {
    eprintln!("[2/3] gradients");
    // beside the middle, stiff members need steps below their period: forces are explicit at the ends, where round-off grows with the step
    let scenes: [(&str, f64, &[f64]); 8] = [
        ("double-pendulum", 0.4, &ALPHAS),
        ("free-body", 0.4, &ALPHAS),
        ("heavy-top", 0.2, &ALPHAS),
        ("five-bar", 0.4, &ALPHAS),
        ("slider-crank", 0.4, &ALPHAS),
        ("flying-rod", 0.02, &[0.25, 0.5, 0.75]),
        ("flying-rod", 0.002, &[0.0, 1.0]),
        ("flexible-pendulum", 0.05, &[0.5]),
    ];
    for (name, end, alphas) in scenes {
        let scene = built_in::named(name)?;
        for &alpha in alphas {
            let prepared = prepare(scene, &format!("variational:{alpha}"), end, 20)?;
            let (analysis, x) = (prepared.analysis(), &prepared.x);
            let forward = analysis.forward(x)?;
            let (adjoint, tangent) = (analysis.adjoint(x, &forward)?, analysis.tangent(x, &forward)?);
            let complex_step = analysis.complex_step(x, &forward)?;
            for (name, own) in [("adjoint", &adjoint), ("direct differentiation", &tangent)] {
                let rows = own.rows.iter().zip(&complex_step.rows);
                let worst = rows.fold(0.0, |worst: f64, (own, exact)| worst.max(largest_difference(own, exact)));
                report.at_most(format!("{}/alpha {alpha}/{name} - complex step", scene.name()), worst, EXACT);
            }
        }
    }
    Ok(())
}

/// Kinetic and potential energy at a step's quadrature point.
fn energy(measured: &Measured, problem: &Problem<f64>, step: &StepRecord<f64>) -> f64 {
    let mut sample = Sample::empty();
    sample.set_stage(step, 0);
    measured.value(problem.model, &sample, &problem.p)
}

fn conservation(report: &mut Report) -> Result<(), RunError> {
    eprintln!("[3/3] {MANY} steps");
    let scenes: [(&dyn AnyScene, f64, &[usize]); 3] = [
        (&Swinging::Mass, 1e-3, &[1]),
        (built_in::named("free-body")?, 1e-2, &[0, 1, 2]),
        (&Swinging::Cable { elements: 2 }, 5e-4, &[1]),
    ];
    for (scene, h, axes) in scenes {
        let name = scene.name();
        let prepared = prepare(scene, "variational", h * MANY as f64, MANY)?;
        let (mut first, mut worst, mut size) = (None, 0.0_f64, 0.0_f64);
        let (mut energies, measured) = (Vec::with_capacity(MANY), Measured::energy());
        watch(&prepared, |problem, step| {
            let moment = moment_of_momentum(problem.model, &step.q, &discrete_momentum(problem, step));
            let reference: [f64; 3] = *first.get_or_insert(moment);
            for &axis in axes {
                worst = worst.max((moment[axis] - reference[axis]).abs());
                size = size.max(reference[axis].abs());
            }
            energies.push(energy(&measured, problem, step));
        })?;
        let change = |part: &[f64]| part.iter().fold(0.0, |most: f64, energy| most.max((energy - energies[0]).abs()));
        let (first, last) = energies.split_at(MANY / 5);
        let last = &last[last.len() - first.len()..];
        report.at_most(format!("{name}/change of the moment of momentum, relative"), worst / size, ROUND_OFF);
        report.inform(format!("{name}/energy at the start [J]"), energies[0]);
        report.inform(format!("{name}/largest change of energy in the first fifth [J]"), change(first));
        report.inform(format!("{name}/largest change of energy in the last fifth [J]"), change(last));
        if change(last) <= ROUND_OFF * energies[0].abs() {
            report.at_most(
                format!("{name}/change of energy in the last fifth, relative"),
                change(last) / energies[0].abs(),
                ROUND_OFF,
            );
        } else {
            let growth = change(last) / change(first);
            report.at_most(format!("{name}/growth of that change"), growth, BOUNDED);
        }
    }
    Ok(())
}
