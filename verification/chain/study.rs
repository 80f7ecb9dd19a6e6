//! Cost of a step on chains of 10, 100 and 1000 rigid bodies, one thread.

use crate::allocations;
use crate::verification::{Clock, Form, Report, Study, on_one_thread};
use costate::integrators::{ConstraintLevel, Counters, Method, NewtonTolerance, Table, tables};
use costate::scenes::built_in::{Chain, ChainVariables};
use costate::scenes::{AnyScene, Prepared, Settings};

/// The study.
pub struct ChainCost;

/// Numbers of bodies, with the steps that are taken.
const SIZES: [(usize, usize); 3] = [(10, 200), (100, 100), (1000, 20)];
/// Size of a step [s].
const STEP: f64 = 1e-3;
/// Runs of each chain; the fastest counts, since anything else on the machine only adds time.
const REPEATS: usize = 3;
/// Exudyn 1.13 (generalized-alpha, sparse, one thread of a like machine) on the same kind of chain [us per step].
const EXUDYN: [f64; 3] = [141.0, 1321.0, 70_131.0];
/// The methods that are measured, at acceleration level.
const METHODS: [&str; 3] = ["esdirk4", "sdirk2", "generalized-alpha"];

/// What one chain showed.
struct Cost {
    forward_us: f64,
    adjoint_us: f64,
    counters: Counters,
    allocations: u64,
    value: f64,
}

impl Study for ChainCost {
    fn name(&self) -> &'static str {
        "chain"
    }
    fn summary(&self) -> &'static str {
        "microseconds, Newton iterations, factorizations and allocations of a step on chains of 10, 100 and 1000 bodies"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_one_thread(|| measure_all(report))
    }
}

fn measure_all(report: &mut Report) -> Result<(), String> {
    let short = report.is_short();
    for table in tables().into_iter().filter(|table| METHODS.contains(&table.name.as_str())) {
        if short && table.name != METHODS[0] {
            continue;
        }
        for tolerance in NewtonTolerance::ALL {
            let mut costs = Vec::new();
            for (bodies, steps) in SIZES {
                costs.push(measure(&table, tolerance, (bodies, steps), if short { 1 } else { REPEATS })?);
            }
            write(report, &format!("{}/{}", table.name, tolerance.name()), tolerance, &costs);
        }
    }
    Ok(())
}

fn write(report: &mut Report, method: &str, tolerance: NewtonTolerance, costs: &[Cost]) {
    for (((bodies, steps), cost), exudyn) in SIZES.into_iter().zip(costs).zip(EXUDYN) {
        let per_step = |count: usize| count as f64 / steps as f64;
        let figure = |what: &str| format!("{method}/{bodies} bodies/{what}");
        report.inform(figure("forward [us/step]"), cost.forward_us);
        report.inform(figure("share of Exudyn's time"), cost.forward_us / exudyn);
        report.inform(figure("Newton iterations/step"), per_step(cost.counters.iterations));
        report.inform(figure("factorizations/step"), per_step(cost.counters.factorizations));
        report.inform(figure("allocations/step"), cost.allocations as f64 / steps as f64);
        if tolerance == NewtonTolerance::RoundOff {
            report.inform(figure("adjoint [us/step]"), cost.adjoint_us);
            report.inform(figure("adjoint / forward"), cost.adjoint_us / cost.forward_us);
        }
        report.inform(figure("functional"), cost.value);
    }
    // linear in the number of bodies: the work of a step does not grow beyond it
    let iterations = |at: usize| costs[at].counters.iterations as f64 / SIZES[at].1 as f64;
    report.at_most(format!("{method}/iterations at 1000 bodies against 10"), iterations(2) / iterations(0), 2.0);
    if !report.is_short() {
        let us = |at: usize| costs[at].forward_us / SIZES[at].0 as f64;
        report.at_most(format!("{method}/time per body at 1000 bodies against 100"), us(2) / us(1), 2.0);
    }
}

/// Steps of one chain without a history, and with one the adjoint of its two functionals.
fn measure(
    table: &Table,
    tolerance: NewtonTolerance,
    (bodies, steps): (usize, usize),
    repeats: usize,
) -> Result<Cost, String> {
    let scene = Chain { bodies, variables: ChainVariables::Common };
    let scene: &dyn AnyScene = scene.as_ref();
    let x: Vec<f64> = scene.design_variables().iter().map(|variable| variable.initial).collect();
    let method = Method { tolerance, ..Method::new(table.clone(), ConstraintLevel::Acceleration) };
    let prepare = |steps: usize| {
        let settings = Settings { end: STEP * steps as f64, steps, ..scene.default_settings().without_method() };
        Prepared::with(scene, &x, method.clone(), settings).map_err(|error| error.to_string())
    };
    // a first step alone costs what is set up once: it is subtracted
    let (one, all) = (prepare(1)?, prepare(steps + 1)?);
    let mut cost = Cost {
        forward_us: f64::INFINITY,
        adjoint_us: f64::INFINITY,
        counters: Counters::default(),
        allocations: 0,
        value: 0.0,
    };
    for _ in 0..repeats {
        let mut timed = |prepared: &Prepared| -> Result<(f64, u64), String> {
            let (before, start) = (allocations::count(), Clock::start());
            let values = prepared.analysis().values(&x).map_err(|error| error.to_string())?;
            cost.value = values[0];
            Ok((start.seconds() * 1e6, allocations::count() - before))
        };
        let (first, all) = (timed(&one)?, timed(&all)?);
        cost.forward_us = cost.forward_us.min((all.0 - first.0) / steps as f64);
        cost.allocations = all.1 - first.1;
    }
    let analysis = all.analysis();
    let forward = analysis.forward(&x).map_err(|error| error.to_string())?;
    cost.counters = forward.counters;
    if tolerance == NewtonTolerance::RoundOff {
        let start = Clock::start();
        analysis.adjoint(&x, &forward).map_err(|error| error.to_string())?;
        cost.adjoint_us = start.seconds() * 1e6 / (steps + 1) as f64;
    }
    Ok(cost)
}
