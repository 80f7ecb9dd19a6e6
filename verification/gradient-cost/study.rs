//! A gradient costs the same for 1 and for 1000 design variables: a chain of 100 bodies, both choices of variables side by side.

use crate::verification::{Clock, Form, Report, Study, median, on_one_thread};
use costate::integrators::Counters;
use costate::scenes::{Prepared, Settings, built_in};

pub struct GradientCost;

/// Runs of each chain, in turn: times and their ratios are medians of these.
const REPEATS: usize = 9;

struct Cost {
    variables: usize,
    nonzero: usize,
    forward: Counters,
    adjoint: Counters,
    forward_s: Vec<f64>,
    adjoint_s: Vec<f64>,
}

impl Study for GradientCost {
    fn name(&self) -> &'static str {
        "gradient-cost"
    }
    fn summary(&self) -> &'static str {
        "work and time of an adjoint gradient for 1 and for 1000 design variables, on a chain of 100 bodies"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_one_thread(|| measure_both(report))
    }
}

fn measure_both(report: &mut Report) -> Result<(), String> {
    let scenes = built_in::all();
    let chains: Vec<_> = scenes.iter().filter(|scene| scene.scene_name().starts_with("chain-")).collect();
    let mut prepared = Vec::new();
    for scene in &chains {
        let x: Vec<f64> = scene.design_variables().iter().map(|variable| variable.initial).collect();
        let settings = Settings { end: 0.1, steps: 20, ..scene.default_settings().without_method() };
        let built = Prepared::with(&***scene, &x, Prepared::default_method(), settings);
        prepared.push(built.map_err(|error| error.to_string())?);
    }
    let mut costs: Vec<Option<Cost>> = prepared.iter().map(|_| None).collect();
    // alternating, so that both see the same machine
    for _ in 0..if report.is_short() { 1 } else { REPEATS } {
        for (scene, all) in prepared.iter().zip(&mut costs) {
            let mut cost = measure(scene)?;
            if let Some(before) = all.take() {
                cost.forward_s.extend(before.forward_s);
                cost.adjoint_s.extend(before.adjoint_s);
            }
            *all = Some(cost);
        }
    }
    for (scene, cost) in chains.iter().zip(costs.iter().flatten()) {
        let figure = |what: &str| format!("{}/{what}", scene.scene_name());
        report.inform(figure("design variables"), cost.variables as f64);
        report.compare(figure("variables with an effect"), cost.nonzero as f64, cost.variables as f64, 0.0);
        report.inform(figure("forward [s]"), median(cost.forward_s.clone()));
        report.inform(figure("adjoint [s]"), median(cost.adjoint_s.clone()));
        report.inform(figure("adjoint / forward"), ratio(&cost.adjoint_s, &cost.forward_s));
    }
    let [Some(common), Some(separate)] = &costs[..] else { return Err("two chains are expected".into()) };
    let same = |report: &mut Report, what: &str, one: usize, many: usize| {
        report.compare(format!("1000 variables against 1/{what}"), many as f64, one as f64, 0.0);
    };
    same(report, "forward factorizations", common.forward.factorizations, separate.forward.factorizations);
    same(report, "forward solves", common.forward.solves, separate.forward.solves);
    same(report, "adjoint factorizations", common.adjoint.factorizations, separate.adjoint.factorizations);
    same(report, "adjoint solves", common.adjoint.solves, separate.adjoint.solves);
    same(report, "element products", common.adjoint.products, separate.adjoint.products);
    if report.is_short() {
        return Ok(());
    }
    let figure = |what: &str| format!("1000 variables against 1/{what} time ratio");
    report.compare(figure("forward"), ratio(&separate.forward_s, &common.forward_s), 1.0, 0.05);
    report.compare(figure("adjoint"), ratio(&separate.adjoint_s, &common.adjoint_s), 1.0, 0.05);
    Ok(())
}

/// Median of the ratios of runs that were made one after the other.
fn ratio(times: &[f64], others: &[f64]) -> f64 {
    median(times.iter().zip(others).map(|(time, other)| time / other).collect())
}

fn measure(scene: &Prepared) -> Result<Cost, String> {
    let analysis = scene.analysis();
    let start = Clock::start();
    let forward = analysis.forward(&scene.x).map_err(|error| error.to_string())?;
    let forward_s = vec![start.seconds()];
    let start = Clock::start();
    let gradient = analysis.adjoint(&scene.x, &forward).map_err(|error| error.to_string())?;
    let adjoint_s = vec![start.seconds()];
    let variables = scene.x.len();
    let nonzero = (0..variables).filter(|&i| gradient.rows.iter().any(|row| row[i] != 0.0)).count();
    Ok(Cost { variables, nonzero, forward: forward.counters, adjoint: gradient.counters, forward_s, adjoint_s })
}
