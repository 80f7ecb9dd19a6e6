//! Cost of a step on chains of 10 to 10,000 rigid bodies, one thread.

use crate::allocations;
use crate::{Clock, Form, PHASES, Report, Study, on_one_thread, with_phases};
use costate::history::Keep;
use costate::integrators::{ConstraintLevel, Counters, Method, NewtonTolerance, table_by_name};
use costate::scenes::{AnyScene, FileScene, Prepared, Settings, built_in};
use costate::sensitivity::Analysis;
use std::time::Instant;

/// The study.
pub struct ChainCost;

/// Numbers of bodies, with the steps that are taken.
const SIZES: [(usize, usize); 3] = [(10, 200), (100, 100), (1000, 60)];
/// The longest one, with its steps.
const LONG: (usize, usize) = (10_000, 24);
/// Size of a step [s].
const STEP: f64 = 1e-3;
/// Runs of each chain; the fastest counts, since anything else on the machine only adds time. Of short ones, which take less time than what
/// disturbs them, there are more.
const REPEATS: usize = 3;
const REPEATS_OF_SHORT: usize = 15;
/// Exudyn 1.13 (generalized-alpha, sparse, one thread of a like machine) on the same kind of chain [us per step].
const EXUDYN: [f64; 3] = [141.0, 1321.0, 70_131.0];
/// The methods that are measured, with the level of their constraints.
const METHODS: [(&str, ConstraintLevel); 4] = [
    ("esdirk4", ConstraintLevel::Acceleration),
    ("sdirk2", ConstraintLevel::Acceleration),
    ("generalized-alpha", ConstraintLevel::Acceleration),
    ("generalized-alpha", ConstraintLevel::Position),
];
/// Most memory of a body of the longest one [KB], and the steps in which it is found: first guesses look back as many.
const MEMORY: f64 = 22.0;
const FEW: usize = 9;
/// Numbers that are added up to see how fast memory is read.
const NUMBERS: usize = 1 << 27;
/// Steps of 0.5 s in the comparison of errors, and the bars of its chain.
const LADDER: [usize; 3] = [250, 500, 1000];
const LADDER_BODIES: usize = 10;
/// Steps of the solution that they are compared with.
const REFERENCE_STEPS: usize = 8000;

/// What one chain showed.
struct Cost {
    forward_us: f64,
    adjoint_us: f64,
    prepare_s: f64,
    /// Shares of a step's time.
    shares: [f64; 4],
    counters: Counters,
    /// Entries of L and U.
    fill: f64,
    allocations: u64,
    value: f64,
}

impl Cost {
    /// Time of one of each part of a step \[us\], in the order of [`PHASES`].
    fn of_one(&self, steps: usize) -> [f64; 4] {
        let Counters { residuals, factorizations, solves, .. } = self.counters;
        let counts = [residuals, factorizations, factorizations, solves].map(|count| count as f64 / steps as f64);
        std::array::from_fn(|phase| self.shares[phase] * self.forward_us / counts[phase])
    }
    /// What solutions read of the factors in a second \[GB\].
    fn read_by_solutions(&self, steps: usize) -> f64 {
        8e-3 * self.fill / self.of_one(steps)[3]
    }
}

impl Study for ChainCost {
    fn name(&self) -> &'static str {
        "chain"
    }
    fn summary(&self) -> &'static str {
        "microseconds, Newton iterations, factorizations and allocations of a step on chains of 10 to 10,000 bodies"
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
    for (name, level) in METHODS {
        let table = table_by_name(name).ok_or("a method is not listed")?;
        if short && (name, level) != METHODS[0] {
            continue;
        }
        for tolerance in NewtonTolerance::ALL {
            let method = Method { tolerance, ..Method::new(table.clone(), level) };
            let mut costs = Vec::new();
            for size in SIZES {
                let repeats = if size.0 < SIZES[2].0 { REPEATS_OF_SHORT } else { REPEATS };
                costs.push(measure(&method, size, if short { 1 } else { repeats })?);
            }
            let label = format!("{name}/{}/{}", level.name(), tolerance.name());
            write(report, &label, tolerance, &costs);
            if tolerance == NewtonTolerance::RoundOff && !short {
                let long = measure(&method, LONG, REPEATS)?;
                write_one(report, &label, LONG, &long);
                report.inform(format!("{label}/{} bodies/preparation [s]", LONG.0), long.prepare_s);
                let bytes = bytes_of_a_body(&method, LONG.0)?;
                report.at_most(format!("{label}/{} bodies/heap at its peak by a body [KB]", LONG.0), 1e-3 * bytes, MEMORY);
                let per_body = |cost: &Cost, (bodies, _): (usize, usize)| cost.forward_us / bodies as f64;
                let growth = per_body(&long, LONG) / per_body(&costs[1], SIZES[1]);
                report.inform(format!("{label}/time per body at 10,000 bodies against 100"), growth);
                let corrections = |cost: &Cost, (_, steps): (usize, usize)| cost.counters.iterations as f64 / steps as f64;
                let more = corrections(&long, LONG) / corrections(&costs[1], SIZES[1]);
                report.inform(format!("{label}/the same by correction"), growth / more);
                // first guesses of both are as good
                let few = (SIZES[1].0, LONG.1);
                let same = measure(&method, few, REPEATS_OF_SHORT)?;
                write_one(report, &format!("{label}/in {} steps", few.1), few, &same);
                let growth = per_body(&long, LONG) / per_body(&same, few);
                report.inform(format!("{label}/time per body at 10,000 bodies against 100 in as many steps"), growth);
                let [long_each, same_each] = [(&long, LONG), (&same, few)].map(|(cost, size)| cost.of_one(size.1));
                for (phase, what) in PHASES.into_iter().enumerate() {
                    let growth = long_each[phase] / LONG.0 as f64 / (same_each[phase] / few.0 as f64);
                    report.inform(format!("{label}/the same, {what} alone, of one"), growth);
                }
                for (cost, size) in [(&same, few), (&long, LONG)] {
                    let read = cost.read_by_solutions(size.1);
                    report.inform(format!("{label}/{} bodies/factors that solutions read [GB/s]", size.0), read);
                }
            }
        }
    }
    if short {
        return Ok(());
    }
    report.inform("1 GB of numbers that a thread adds up [GB/s]", numbers_in_turn());
    compare_errors(report)
}

/// What one thread reads at most in a second where numbers lie one after the other \[GB\].
fn numbers_in_turn() -> f64 {
    let numbers = vec![1.0f64; NUMBERS];
    let seconds = (0..REPEATS).map(|_| {
        let clock = Clock::start();
        // sums side by side, so that none waits for the one before
        let mut sums = [0.0; 64];
        numbers.chunks_exact(64).for_each(|own| sums.iter_mut().zip(own).for_each(|(sum, number)| *sum += number));
        std::hint::black_box(sums);
        clock.seconds()
    });
    8e-9 * NUMBERS as f64 / seconds.fold(f64::INFINITY, f64::min)
}

/// A chain of so many bars.
fn chain(bars: usize) -> Result<FileScene, String> {
    built_in::changed("chain-common", &format!("define.bars = {bars}"))
}

/// Error of the tip against the time that it takes, for all methods.
fn compare_errors(report: &mut Report) -> Result<(), String> {
    let scene = chain(LADDER_BODIES)?;
    let tip = |name: &str, level: ConstraintLevel, tolerance, steps: usize| -> Result<([f64; 3], f64), String> {
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let table = table_by_name(name).ok_or("a method is not listed")?;
        let method = Method { tolerance, ..Method::new(table, level) };
        let settings = Settings { steps, ..scene.settings().without_method() };
        let prepared = Prepared::with(&scene, &x, method, settings).map_err(|error| error.to_string())?;
        let (analysis, start) = (prepared.analysis(), Clock::start());
        let forward = analysis.forward(&x).map_err(|error| error.to_string())?;
        let seconds = start.seconds();
        let end = analysis.motion(&forward, &[prepared.grid.times[steps]]).map_err(|error| error.to_string())?;
        let last = end.first().ok_or("no state at the end")?;
        let place = last.q.len() - 7;
        Ok(([last.q[place], last.q[place + 1], last.q[place + 2]], 1e6 * seconds / (1e3 * prepared.grid.times[steps])))
    };
    let (exact, _) = tip("esdirk5", ConstraintLevel::Acceleration, NewtonTolerance::RoundOff, REFERENCE_STEPS)?;
    let mut all = METHODS.to_vec();
    all.push(("esdirk5", ConstraintLevel::Acceleration));
    all.push(("bdf2", ConstraintLevel::Acceleration));
    for (name, level) in all {
        let tolerances = [NewtonTolerance::RoundOff, NewtonTolerance::Scaled];
        for (steps, tolerance) in LADDER.into_iter().flat_map(|steps| tolerances.map(|tolerance| (steps, tolerance))) {
            let (found, us) = tip(name, level, tolerance, steps)?;
            let error = found.iter().zip(exact).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            let rule = tolerance.name();
            let label = format!("{name}/{}/{rule}/{LADDER_BODIES} bodies, {steps} steps of 0.5 s", level.name());
            report.inform(format!("{label}/error of the last bar's middle [m]"), error);
            report.inform(format!("{label}/[us per ms]"), us);
        }
    }
    Ok(())
}

fn write(report: &mut Report, method: &str, tolerance: NewtonTolerance, costs: &[Cost]) {
    for ((size, cost), exudyn) in SIZES.into_iter().zip(costs).zip(EXUDYN) {
        write_one(report, method, size, cost);
        let figure = |what: &str| format!("{method}/{} bodies/{what}", size.0);
        report.inform(figure("share of Exudyn's time"), cost.forward_us / exudyn);
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
        report.inform(format!("{method}/time per body at 1000 bodies against 100"), us(2) / us(1));
    }
}

/// What a step of one chain costs.
fn write_one(report: &mut Report, method: &str, (bodies, steps): (usize, usize), cost: &Cost) {
    let per_step = |count: usize| count as f64 / steps as f64;
    let figure = |what: &str| format!("{method}/{bodies} bodies/{what}");
    let Counters { iterations, projecting: [of_coordinates, of_velocities], factorizations, .. } = cost.counters;
    report.inform(figure("forward [us/step]"), cost.forward_us);
    report.inform(figure("Newton iterations/step"), per_step(iterations));
    report.inform(figure("those of stages"), per_step(iterations - of_coordinates - of_velocities));
    report.inform(figure("those of projections of coordinates"), per_step(of_coordinates));
    report.inform(figure("those of projections of velocities"), per_step(of_velocities));
    report.inform(figure("factorizations/step"), per_step(factorizations));
    report.inform(figure("allocations/step"), cost.allocations as f64 / steps as f64);
    for (phase, share) in PHASES.into_iter().zip(cost.shares) {
        report.inform(figure(&format!("share of {phase}")), share);
    }
    report.inform(figure("share of the rest"), 1.0 - cost.shares.iter().sum::<f64>());
}

/// Bytes of the heap that building, preparing and running a chain take at most, by a body.
fn bytes_of_a_body(method: &Method, bodies: usize) -> Result<f64, String> {
    let scene = chain(bodies)?;
    let (run, bytes) = allocations::most_bytes(|| -> Result<(), String> {
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let settings = Settings { end: STEP * FEW as f64, steps: FEW, ..scene.settings().without_method() };
        let prepared = Prepared::with(&scene, &x, method.clone(), settings).map_err(|error| error.to_string())?;
        prepared.analysis().values(&x).map(|_| ()).map_err(|error| error.to_string())
    });
    run?;
    Ok(bytes as f64 / bodies as f64)
}

/// Steps of one chain without a history, and with one the adjoint of its two functionals.
fn measure(method: &Method, (bodies, steps): (usize, usize), repeats: usize) -> Result<Cost, String> {
    let scene = chain(bodies)?;
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepare = |steps: usize| {
        let settings = Settings { end: STEP * steps as f64, steps, ..scene.settings().without_method() };
        Prepared::with(&scene, &x, method.clone(), settings).map_err(|error| error.to_string())
    };
    // a first step alone costs what is set up once: it is subtracted
    let one = prepare(1)?;
    let begun = Clock::start();
    let all = prepare(steps + 1)?;
    let mut cost = Cost {
        forward_us: 0.0,
        adjoint_us: f64::INFINITY,
        prepare_s: begun.seconds(),
        shares: [0.0; 4],
        counters: Counters::default(),
        fill: all.linear_solver().map_err(|error| error.to_string())?.work.map_or(f64::NAN, |work| work.fill as f64),
        allocations: 0,
        value: 0.0,
    };
    // the fastest of each: a first step that was disturbed would shorten the others
    let mut fastest = [f64::INFINITY; 2];
    for _ in 0..repeats {
        let mut timed = |prepared: &Prepared| -> Result<(f64, u64), String> {
            let (before, start) = (allocations::count(), Clock::start());
            let values = prepared.analysis().values(&x).map_err(|error| error.to_string())?;
            cost.value = values[0];
            Ok((start.seconds() * 1e6, allocations::count() - before))
        };
        let (first, all) = (timed(&one)?, timed(&all)?);
        fastest = [fastest[0].min(first.0), fastest[1].min(all.0)];
        cost.allocations = all.1 - first.1;
    }
    cost.forward_us = (fastest[1] - fastest[0]) / steps as f64;
    let analysis = all.analysis();
    let forward = analysis.forward(&x).map_err(|error| error.to_string())?;
    cost.counters = forward.counters;
    // runs of their own, since looking at the clock takes its time; without what is set up before the first step
    let phases = |prepared: &Prepared| -> Result<([f64; 4], f64), String> {
        let begun = Instant::now();
        // no history is kept, as in the other times
        let run = with_phases(Analysis { keep: &Keep::Nothing, ..prepared.analysis() }, |analysis| analysis.forward(&x));
        let total = begun.elapsed().as_secs_f64();
        let counters = run.map_err(|error| error.to_string())?.counters;
        Ok((counters.nanoseconds.unwrap_or_default().map(|own| 1e-9 * own as f64), total))
    };
    let fastest = |prepared: &Prepared| -> Result<([f64; 4], f64), String> {
        let mut least = phases(prepared)?;
        for _ in 1..REPEATS {
            let next = phases(prepared)?;
            least = if next.1 < least.1 { next } else { least };
        }
        Ok(least)
    };
    let ((first, first_total), (whole, total)) = (fastest(&one)?, fastest(&all)?);
    cost.shares = std::array::from_fn(|phase| (whole[phase] - first[phase]) / (total - first_total));
    if method.tolerance == NewtonTolerance::RoundOff && bodies < LONG.0 {
        let start = Clock::start();
        analysis.adjoint(&x, &forward).map_err(|error| error.to_string())?;
        cost.adjoint_us = start.seconds() * 1e6 / (steps + 1) as f64;
    }
    Ok(cost)
}
