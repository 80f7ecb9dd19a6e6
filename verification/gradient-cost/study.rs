//! What a gradient costs: one sweep by its simulation, a further functional by the sweep, 10,000 design variables by one.

use crate::{Clock, Form, Report, Study, median, on_threads, with_phases};
use costate::integrators::{Counters, RunError};
use costate::scenes::{AnyScene, Prepared, Settings, built_in};
use std::time::Instant;

pub struct GradientCost;

/// Runs in turn: times and their ratios are medians of these.
const REPEATS: usize = 9;
/// Bars of the chain whose every number is a design variable: ten each.
const BARS: usize = 1000;
/// Ratio of times by many variables and by one, less one.
const SAME_TIME: f64 = 0.03;

/// Built-in scenes, with end \[s\] and steps of the measured part.
const SCENES: [(&str, f64, usize); 9] = [
    ("chain-common", 0.1, 20),
    ("five-bar", 1.0, 100),
    ("slider-crank", 0.5, 100),
    ("screw", 0.5, 100),
    ("andrews", 0.01, 100),
    ("flexible-four-bar", 1.0, 100),
    ("suspension", 0.5, 500),
    ("flexible-pendulum", 0.2, 200),
    ("plate-pendulum", 0.01, 10),
];

impl Study for GradientCost {
    fn name(&self) -> &'static str {
        "gradient-cost"
    }
    fn summary(&self) -> &'static str {
        "time of an adjoint gradient by that of its simulation, of a further functional, and for 1 and 10,000 design variables"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_threads(1, || numbers_of_variables(report))?;
        for threads in [1, 2] {
            on_threads(threads, || all_scenes(report, threads))?;
        }
        Ok(())
    }
}

/// Times of the same work, once for each repetition.
#[derive(Default)]
struct Times {
    forward: Vec<f64>,
    /// Of a sweep for the first functional.
    one: Vec<f64>,
    /// Of a sweep for all.
    all: Vec<f64>,
}

fn all_scenes(report: &mut Report, threads: usize) -> Result<(), String> {
    let repeats = if report.is_short() { 1 } else { REPEATS };
    for (name, end, steps) in SCENES {
        let scene = built_in::named(name)?;
        let settings = Settings { end, steps, control: None, ..scene.settings() };
        let prepared = prepare(scene, settings)?;
        let functionals = prepared.functionals().len();
        let mut times = Times::default();
        for _ in 0..repeats {
            measure(&prepared, threads, &mut times)?;
        }
        let figure = |what: &str| format!("{name}, {threads} thread{}/{what}", if threads > 1 { "s" } else { "" });
        report.inform(figure("forward [s]"), median(times.forward.clone()));
        report.inform(figure("adjoint / forward"), ratio(&times.one, &times.forward));
        if functionals > 1 {
            report.inform(figure("functionals"), functionals as f64);
            let further = (ratio(&times.all, &times.one) - 1.0) / (functionals - 1) as f64;
            report.inform(figure("further functional / adjoint"), further);
        }
        if threads == 1 {
            let forward = median(times.forward);
            for (part, seconds) in PARTS.into_iter().zip(parts_of_a_sweep(&prepared, repeats)?) {
                report.inform(figure(&format!("adjoint, {part} / forward")), seconds / forward);
            }
        }
    }
    Ok(())
}

/// What a sweep consists of.
const PARTS: [&str; 5] = ["evaluations", "matrices", "their factorizations", "solutions", "products and all else"];

/// Medians of the time that each part of a sweep for one functional takes [s].
fn parts_of_a_sweep(scene: &Prepared, repeats: usize) -> Result<[f64; 5], String> {
    let words = |error: RunError| error.to_string();
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x).map_err(words)?;
    let asked: Vec<bool> = (0..scene.functionals().len()).map(|functional| functional == 0).collect();
    let mut parts = [const { Vec::new() }; 5];
    for _ in 0..repeats {
        let clock = Clock::start();
        let gradient = with_phases(analysis, |analysis| analysis.adjoint_of(&scene.x, &forward, &asked)).map_err(words)?;
        let all = clock.seconds();
        let known = gradient.counters.nanoseconds.unwrap_or_default().map(|time| 1e-9 * time as f64);
        let others = all - known.iter().sum::<f64>();
        parts.iter_mut().zip(known.into_iter().chain([others])).for_each(|(part, time)| part.push(time));
    }
    Ok(parts.map(median))
}

fn prepare(scene: &dyn AnyScene, settings: Settings) -> Result<Prepared<'_>, String> {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Prepared::method_of(&settings).map_err(|error| error.to_string())?;
    Prepared::with(scene, &x, method, settings).map_err(|error| error.to_string())
}

/// Simulates, and goes back for one functional and for all of them.
fn measure(scene: &Prepared, threads: usize, times: &mut Times) -> Result<(), String> {
    let analysis = scene.analysis();
    let count = scene.functionals().len();
    let (seconds, forward) = timed(threads, || analysis.forward(&scene.x).map_err(|error| error.to_string()))?;
    times.forward.push(seconds);
    for (wanted, times) in [(1, &mut times.one), (count, &mut times.all)] {
        let asked: Vec<bool> = (0..count).map(|functional| functional < wanted).collect();
        let sweep = || analysis.adjoint_of(&scene.x, &forward, &asked).map_err(|error| error.to_string());
        times.push(timed(threads, sweep)?.0);
    }
    Ok(())
}

/// The time of this thread on the processor, or of the day where others help it.
fn timed<T>(threads: usize, work: impl FnOnce() -> Result<T, String>) -> Result<(f64, T), String> {
    let (clock, day) = (Clock::start(), Instant::now());
    let done = work()?;
    Ok((if threads == 1 { clock.seconds() } else { day.elapsed().as_secs_f64() }, done))
}

/// Median of the ratios of runs that were made one after the other.
fn ratio(times: &[f64], others: &[f64]) -> f64 {
    median(times.iter().zip(others).map(|(time, other)| time / other).collect())
}

/// A chain with one design variable that touches every bar, and one in which every number of every bar is one.
fn numbers_of_variables(report: &mut Report) -> Result<(), String> {
    let bars = format!("define.bars = {BARS}");
    let chains = [built_in::changed("chain-common", &bars)?, built_in::changed("chain-separate", &bars)?];
    let mut prepared = Vec::new();
    for chain in &chains {
        prepared.push(prepare(chain, Settings { end: 0.01, steps: 2, ..chain.settings() })?);
    }
    let mut costs: Vec<Cost> = prepared.iter().map(|_| Cost::default()).collect();
    // alternating, so that both see the same machine
    for _ in 0..if report.is_short() { 1 } else { REPEATS } {
        for (scene, cost) in prepared.iter().zip(&mut costs) {
            cost.measure(scene)?;
        }
    }
    let [one, many] = &costs[..] else { return Err("two chains are expected".into()) };
    for cost in [one, many] {
        let figure = |what: &str| format!("chain of {BARS} with {} variables/{what}", cost.variables);
        report.compare(figure("variables with an effect"), cost.nonzero as f64, cost.variables as f64, 0.0);
        report.inform(figure("forward [s]"), median(cost.forward_s.clone()));
        report.inform(figure("adjoint [s]"), median(cost.adjoint_s.clone()));
    }
    let figure = |what: &str| format!("{} variables against 1/{what}", many.variables);
    let counts = |cost: &Cost| [cost.forward.factorizations, cost.forward.solves, cost.adjoint.factorizations];
    let further = |cost: &Cost| [cost.adjoint.solves, cost.adjoint.products];
    let names = ["forward factorizations", "forward solves", "adjoint factorizations", "adjoint solves", "element products"];
    let [of_one, of_many] = [one, many].map(|cost| counts(cost).into_iter().chain(further(cost)));
    for (name, (one, many)) in names.iter().zip(of_one.zip(of_many)) {
        report.compare(figure(name), many as f64, one as f64, 0.0);
    }
    if !report.is_short() {
        report.compare(figure("forward time ratio"), ratio(&many.forward_s, &one.forward_s), 1.0, SAME_TIME);
        report.compare(figure("adjoint time ratio"), ratio(&many.adjoint_s, &one.adjoint_s), 1.0, SAME_TIME);
    }
    Ok(())
}

#[derive(Default)]
struct Cost {
    variables: usize,
    nonzero: usize,
    forward: Counters,
    adjoint: Counters,
    forward_s: Vec<f64>,
    adjoint_s: Vec<f64>,
}

impl Cost {
    fn measure(&mut self, scene: &Prepared) -> Result<(), String> {
        let analysis = scene.analysis();
        let (seconds, forward) = timed(1, || analysis.forward(&scene.x).map_err(|error| error.to_string()))?;
        self.forward_s.push(seconds);
        let sweep = || analysis.adjoint(&scene.x, &forward).map_err(|error| error.to_string());
        let (seconds, gradient) = timed(1, sweep)?;
        self.adjoint_s.push(seconds);
        self.variables = scene.x.len();
        self.nonzero = (0..self.variables).filter(|&i| gradient.rows.iter().any(|row| row[i] != 0.0)).count();
        (self.forward, self.adjoint) = (forward.counters, gradient.counters);
        Ok(())
    }
}
