//! Mechanisms drawn by lot: what becomes of each.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::dense_count::{Told, compare};
use super::random_mechanism::RandomMechanism;
use crate::verification::{Clock, Report};
use costate::history::Watch;
use costate::integrators::{StepError, StepRecord};
use costate::internals::{Factorization, Jacobian, Rerun, Residual, StageSystem, Systems};
use costate::linalg::Backend;
use costate::prelude::*;
use costate::sensitivity::{Analysis, Forward};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Seconds of the processor beyond which a mechanism is said to hang.
const HANGS: f64 = 60.0;
/// Largest gap of a joint at the end of a step, as a share of the coordinates.
const GAP: f64 = 1e-9;
/// The same of an equation that is left out as redundant: the bound of the watch over these.
const LEFT_OUT: f64 = 1e-8;
/// Largest displacement that Newton's method would still correct in a stage, as a share of the coordinates.
const LEFT: f64 = 1e-10;
/// Steps beyond which a run is ended: chosen ones can be as short as a mechanism is stiff.
const MOST_STEPS: usize = 1000;
/// Steps of difference quotients, as relative changes of the variables.
const QUOTIENTS: [f64; 3] = [2e-5, 1.5e-5, 1e-5];
/// Difference between a gradient and its quotients, in differences between the quotients, that is none of the quotients' own.
const DEVIATIONS: f64 = 10.0;
/// The same as a share of the gradient: what quotients that happen to agree may be off.
const SHARE: f64 = 1e-6;
/// Round-off of a functional, as a share of it: a quotient has so much by its step.
const ROUND_OFF: f64 = 1e-11;
/// Derivatives that are zero but for round-off \[m, J, N s\], of values that a drawn mechanism has from 1e-4 on: a reaction that is zero is
/// what round-off leaves of the forces beside it.
const NOTHING: f64 = 1e-15;
/// The same of the derivative of a functional that is nothing itself, here and beside: the norm of a reaction that round-off leaves has the
/// derivatives of its components for slope, whose terms are of the size of the forces and cancel.
const SLOPE_OF_NOTHING: f64 = 1e-12;
/// Curvature of a functional over its values, in squares of the relative change of the variables, beyond which it jumps.
const JUMP: f64 = 1e4;
/// Largest share of mechanisms whose steps may be so long.
const TORN: f64 = 0.01;
/// Share of a gradient by which quotients may differ and still tell whether it is right.
const ROUGH: f64 = 0.1;
/// Tables whose last stage is not the end of the step: constraints that are kept in the stages alone have gaps there, of the method's order.
const OPEN: [&str; 3] = ["midpoint", "dirk2", "dirk3"];

/// What became of a mechanism, with the reason where there is one.
enum Outcome {
    /// Simulated; its gradient agrees with difference quotients.
    Right,
    /// Not built.
    Refused,
    /// Not simulated, or no gradient found.
    Error,
    /// Simulated; quotients do not exist or scatter as much as they are large.
    Unchecked,
    /// Simulated with steps so long that their equations have several solutions: another one is taken by a design beside. The run has said
    /// so if the estimated error of its steps asks for a warning.
    Torn { said: bool },
    /// A result that is wrong without a word.
    Wrong(String),
    /// A panic.
    Panic(String),
}

/// Mechanisms that ended wrong once: they are drawn in any case, as they were then.
const ONCE_WRONG: [RandomMechanism; 1] = [RandomMechanism { seed: 846, has_more: false }];

/// Draws mechanisms and counts what becomes of them.
pub fn count(report: &mut Report, mechanisms: u64) {
    let drawn = (1..=mechanisms).map(|seed| RandomMechanism { seed, has_more: true });
    let seeds: Vec<RandomMechanism> = drawn.chain(ONCE_WRONG).collect();
    let (next, outcomes) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    let draw = || {
        while let Some(&seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed)) {
            let mut seconds = 0.0;
            let run = AssertUnwindSafe(|| simulate(seed, &mut seconds));
            let outcome = catch_unwind(run).unwrap_or_else(|panic| {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                Outcome::Panic(text.or(panic.downcast_ref::<&str>().copied()).unwrap_or_default().into())
            });
            outcomes.lock().unwrap_or_else(PoisonError::into_inner).insert(seed, (outcome, seconds));
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get());
        (0..threads).for_each(|_| _ = scope.spawn(draw));
    });
    let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut counts = [0.0; 8];
    for (RandomMechanism { seed, .. }, (outcome, seconds)) in &outcomes {
        if *seconds > HANGS {
            report.note(format!("mechanism {seed} takes {seconds:.0} s"));
        }
        let place = match outcome {
            Outcome::Right => 0,
            Outcome::Unchecked => 1,
            Outcome::Error => 2,
            Outcome::Refused => 3,
            Outcome::Torn { said: true } => 4,
            Outcome::Torn { said: false } => {
                report.note(format!("mechanism {seed} is torn without a word"));
                7
            }
            Outcome::Wrong(why) => {
                report.note(format!("mechanism {seed} is wrong: {why}"));
                5
            }
            Outcome::Panic(why) => {
                report.note(format!("mechanism {seed} panics: {why}"));
                6
            }
        };
        counts[place] += 1.0;
    }
    let [right, unchecked, errors, refused, torn, wrong, panics, unsaid] = counts;
    report.inform("mechanisms/drawn", seeds.len() as f64);
    report.inform("mechanisms/right, with a right gradient", right);
    report.inform("mechanisms/right, with difference quotients too rough to tell", unchecked);
    report.inform("mechanisms/ended by an error", errors);
    report.inform("mechanisms/refused before the start", refused);
    report.at_most(
        "mechanisms/torn: steps so long that designs beside take other solutions, share",
        (torn + unsaid) / seeds.len() as f64,
        TORN,
    );
    report.at_most("mechanisms/torn, and the estimated error of the steps asks for no warning", unsaid, 0.0);
    report.at_most("mechanisms/wrong", wrong, 0.0);
    report.at_most("mechanisms/panics", panics, 0.0);
    let longest = outcomes.values().fold(0.0, |longest: f64, (_, seconds)| longest.max(*seconds));
    report.at_most("mechanisms/longest run of one with its gradient [s]", longest, HANGS);
}

/// One of them, and the time of its run and its gradient: checks of every stage by dense factors, and quotients of many runs, take longer.
fn simulate(scene: RandomMechanism, seconds: &mut f64) -> Outcome {
    let begun = Clock::start();
    let method = match scene.method() {
        Ok(method) => method,
        Err(error) => return Outcome::Wrong(error.to_string()),
    };
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepared = match Prepared::with(&scene, &x, method, scene.settings()) {
        Ok(prepared) => prepared,
        Err(_) => return Outcome::Refused,
    };
    let analysis = prepared.analysis();
    let mut steps = 0;
    let mut observer = Watch(|_: &StepRecord<f64>| {
        steps += 1;
        steps <= MOST_STEPS
    });
    let run = analysis.observed(&x, &mut observer);
    *seconds = begun.seconds();
    let forward = match run {
        Ok((forward, None)) => forward,
        Ok((_, Some(_))) | Err(_) => return Outcome::Error,
    };
    if analysis.check_values(&forward).is_err() {
        return Outcome::Error;
    }
    if let Err(why) = check_steps(&prepared, &forward) {
        return Outcome::Wrong(why);
    }
    match compare(&prepared, &forward) {
        Err(why) => return Outcome::Wrong(why),
        Ok(Told::Wrong([negative, neutral, counted])) => {
            return Outcome::Wrong(format!(
                "{negative} negative eigenvalues of the stiffness and {neutral} not known, by a dense solver {counted}"
            ));
        }
        Ok(_) => {}
    }
    let begun = Clock::start();
    let gradient = analysis.adjoint(&x, &forward);
    *seconds += begun.seconds();
    let Ok(gradient) = gradient else { return Outcome::Error };
    if let Some(value) = gradient.rows.iter().flatten().find(|value| !value.is_finite()) {
        return Outcome::Wrong(format!("a gradient of {value}"));
    }
    check_gradient(&prepared, &analysis.on_steps_of(&forward), &forward, &gradient.rows)
}

/// Every step against its own equations: gaps of the constraints at its end, and the forces that are left in each of its stages.
fn check_steps(prepared: &Prepared, forward: &Forward) -> Result<(), String> {
    let problem = prepared.problem();
    let rerun = Rerun::new(&problem, &prepared.method, &forward.grid, &prepared.plan);
    let mut steps = forward.history.forward(&rerun).map_err(|error| error.to_string())?;
    let method = &prepared.method;
    let ends_closed = method.level == ConstraintLevel::Acceleration || !OPEN.contains(&method.table.name.as_str());
    while let Some(step) = steps.next().map_err(|error| error.to_string())? {
        let (end, model) = (step.t + step.h, problem.model);
        let size = step.q.iter().fold(1.0, |size: f64, q| size.max(q.abs()));
        if step.q.iter().chain(&step.v).any(|x| !x.is_finite()) {
            return Err(format!("a state at t = {end} s that is not finite"));
        }
        let holonomic = model.constraints.iter().filter(|joint| !joint.physics.is_nonholonomic());
        for joint in holonomic.filter(|_| ends_closed) {
            let dofs = joint.nodes.iter().flat_map(|node| model.node(*node).dofs.clone());
            let q: Vec<f64> = dofs.map(|dof| step.q[dof]).collect();
            let gaps = joint.physics.value(&q, &problem.p[joint.parameters.clone()], end);
            for (row, gap) in joint.equations.clone().zip(gaps) {
                let limit = if step.dropped.contains(&row) { LEFT_OUT } else { GAP };
                if !(gap.abs() <= limit * size) {
                    let left_out = if step.dropped.contains(&row) { ", which is left out" } else { "" };
                    return Err(format!(
                        "equation {row} of \"{}\"{left_out}: a gap of {gap:.1e} at t = {end} s",
                        joint.name
                    ));
                }
            }
        }
        let systems = Systems::new(model, &prepared.method, &step.dropped);
        for stage in step.stages.iter().filter(|stage| stage.known.is_none()) {
            let solve = &stage.solve;
            let system = &systems.stage;
            let mut residual = Residual::default();
            let at = StageSystem { equations: &solve.equations, base: &solve.base, p: &problem.p, t: solve.t };
            let mut unknowns = solve.unknowns.clone();
            residual.start(system, at);
            residual.evaluate(system, at, &mut unknowns);
            let mut jacobian = Jacobian::default();
            jacobian.assemble(system, &solve.equations, &residual, &unknowns, &problem.p, solve.t);
            let mut correction = vec![0.0; system.size()];
            jacobian.reduce(system, &residual, None, &mut correction);
            let singular = |_| format!("a singular matrix at t = {} s", solve.t);
            let mut factorization = Factorization::new(&system.pattern, Backend::Dense).map_err(singular)?;
            factorization.factor(&jacobian.values).map_err(singular)?;
            factorization.solve(&mut correction);
            let scales = vec![1.0; model.dofs];
            let left = jacobian.add_step(system, &correction, None, &mut unknowns, &scales);
            let left = left * solve.equations.residual.alpha.abs() / size;
            if !(left <= LEFT) {
                return Err(format!("a stage at t = {} s is {left:.1e} of the coordinates off", solve.t));
            }
        }
    }
    Ok(())
}

/// The gradient along one direction against difference quotients with several steps, whose differences bound their errors.
fn check_gradient(prepared: &Prepared, analysis: &Analysis, forward: &Forward, gradient: &[Vec<f64>]) -> Outcome {
    let direction: Vec<f64> = (0..prepared.x.len()).map(|i| 1.0 - 0.3 * i as f64).collect();
    let mut quotients = Vec::new();
    for step in QUOTIENTS {
        match analysis.central_difference(&prepared.x, &direction, step) {
            Ok(quotient) => quotients.push(quotient),
            Err(_) => return Outcome::Unchecked,
        }
    }
    let mut rough = false;
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let own: f64 = gradient[k].iter().zip(&direction).map(|(g, d)| g * d).sum();
        let all: Vec<f64> = quotients.iter().map(|quotient| quotient[k]).collect();
        let spread = all.iter().fold(0.0, |spread: f64, a| all.iter().fold(spread, |s, b| s.max((a - b).abs())));
        let size = own.abs().max(gradient[k].iter().fold(0.0, |size: f64, g| size.max(g.abs())));
        let bound = DEVIATIONS * spread + SHARE * size + ROUND_OFF * forward.values[k].abs() / QUOTIENTS[2];
        let off = all.iter().fold(f64::INFINITY, |off: f64, quotient| off.min((quotient - own).abs()));
        let is_nothing = |x: f64| x.abs() <= NOTHING;
        let vanishes = is_nothing(forward.values[k]) && all.iter().all(|&quotient| is_nothing(quotient));
        if !(off <= bound + if vanishes { SLOPE_OF_NOTHING } else { NOTHING }) {
            // a reaction that is zero may be round-off or not: that is no jump
            if off <= bound + DEVIATIONS * noise(prepared, analysis, forward, &direction, k) / QUOTIENTS[2] {
                rough = true;
                continue;
            }
            if is_torn(prepared, analysis, forward, &direction) {
                return Outcome::Torn { said: forward.error.is_some_and(|error| error.share > StepError::COARSE) };
            }
            let name = &functional.name;
            return Outcome::Wrong(format!("the derivative of \"{name}\" is {own:e}, by difference quotients {all:?}"));
        }
        rough |= spread > ROUGH * size.max(ROUND_OFF * forward.values[k].abs() / QUOTIENTS[2]);
    }
    if rough { Outcome::Unchecked } else { Outcome::Right }
}

/// Whether a functional jumps between a design and those beside it: its mean there is far from its value.
fn is_torn(prepared: &Prepared, analysis: &Analysis, forward: &Forward, direction: &[f64]) -> bool {
    let step = QUOTIENTS[0];
    let beside = |sign: f64| {
        let x: Vec<f64> = prepared.x.iter().zip(direction).map(|(x, d)| x + sign * step * d).collect();
        analysis.values_nearby(&x)
    };
    let (Ok(above), Ok(below)) = (beside(1.0), beside(-1.0)) else { return false };
    let jumps = |((above, below), value): ((&f64, &f64), &f64)| {
        let size = value.abs().max(above.abs()).max(below.abs());
        (0.5 * (above + below) - value).abs() > JUMP * step * step * size
    };
    above.iter().zip(&below).zip(&forward.values).any(jumps)
}

/// What round-off alone changes in a functional: designs that are the same but for that.
fn noise(prepared: &Prepared, analysis: &Analysis, forward: &Forward, direction: &[f64], functional: usize) -> f64 {
    let changed = (-3..=3).filter_map(|k| {
        let x: Vec<f64> = prepared.x.iter().zip(direction).map(|(x, d)| x + 1e-14 * f64::from(k) * d).collect();
        Some((analysis.values_nearby(&x).ok()?[functional] - forward.values[functional]).abs())
    });
    changed.fold(0.0, f64::max)
}
