//! Optimizations from drawn starts: what is claimed to be an optimum, and what neighbouring designs say to that.

use crate::{Noise, Report};
use costate::optimize::{
    ConstraintKind, DesignPoint, Gradients, NoValue, NonlinearProgram, Optimization, Sqp, Stopping, Values, minimize,
};
use costate::scenes::{Prepared, built_in};

/// Bars of drawn laws.
const BARS: usize = 2000;
/// Drawn designs of a slider-crank.
const STARTS: usize = 6;
/// Neighbours of a claimed optimum, and how far they are, as a share of the ranges.
const NEIGHBOURS: usize = 10;
const NEAR: f64 = 1e-2;
/// By how much of its scale a feasible neighbour may be better: what the tolerances of the conditions of optimality leave.
const BETTER: f64 = 1e-4;

/// Counts of ends.
#[derive(Default)]
struct Ends {
    optima: usize,
    otherwise: usize,
    wrong: usize,
}

impl Ends {
    /// An end that claims to be an optimum or not; a claim is refuted by the best of its feasible neighbours, relative to its scale.
    fn judge(&mut self, claimed: bool, gain: impl FnOnce() -> f64) {
        match claimed {
            false => self.otherwise += 1,
            true if gain() <= BETTER => self.optima += 1,
            true => self.wrong += 1,
        }
    }
    fn report(&self, report: &mut Report, name: &str) {
        report.inform(format!("optima/{name}/verified"), self.optima as f64);
        report.inform(format!("optima/{name}/said otherwise"), self.otherwise as f64);
    }
}

/// The lightest bar, of a thickness between 0 and 1, whose stress falls with the square of its thickness but for waves, as resonances
/// make them; too thin ones cannot be simulated.
struct Bar {
    enough: f64,
    waves: [f64; 2],
    thinnest: f64,
}

impl Bar {
    fn drawn(noise: &mut Noise) -> Self {
        let mut number = |from: f64, to: f64| from + 0.5 * (to - from) * (noise.next() + 1.0);
        let enough = number(0.1, 0.6);
        Bar { enough, waves: [number(0.0, 0.4), number(5.0, 50.0)], thinnest: number(-1.0, 1.0) * 0.5 * enough }
    }
    fn stress(&self, y: f64) -> f64 {
        (self.enough / (0.02 + y)).powi(2) * (1.0 + self.waves[0] * (self.waves[1] * y).sin()) - 1.0
    }
}

impl NonlinearProgram for Bar {
    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(0.0, 1.0)]
    }
    fn constraints(&self) -> Vec<ConstraintKind> {
        vec![ConstraintKind::AtMostZero]
    }
    fn values(&mut self, y: &[f64]) -> Result<Values, NoValue> {
        if y[0] < self.thinnest {
            return Err(NoValue::Failed);
        }
        Ok(Values { objective: 1.0 + y[0], constraints: vec![self.stress(y[0])] })
    }
    fn gradients(&mut self, y: &[f64]) -> Result<Gradients, NoValue> {
        let [height, wave] = self.waves;
        let (thickness, phase) = (0.02 + y[0], wave * y[0]);
        let square = (self.enough / thickness).powi(2);
        let slope = square * (height * wave * phase.cos() - 2.0 * (1.0 + height * phase.sin()) / thickness);
        Ok(Gradients { objective: vec![1.0], constraints: vec![vec![slope]] })
    }
}

/// Bars of drawn laws from drawn starts.
fn bars(report: &mut Report) {
    let mut noise = Noise::new(7);
    let mut ends = Ends::default();
    for _ in 0..BARS {
        let mut bar = Bar::drawn(&mut noise);
        let start = bar.thinnest.max(0.0) + (1.0 - bar.thinnest.max(0.0)) * 0.5 * (noise.next() + 1.0);
        let Ok(ended) = minimize(&Sqp, &mut bar, &[start], Stopping::default()) else {
            ends.otherwise += 1;
            continue;
        };
        let Some(best) = ended.best else { continue };
        ends.judge(ended.reason.is_optimum(), || {
            if best.violation > 1e-6 {
                return f64::INFINITY;
            }
            // thinner bars nearby that keep the limit all the way: behind a bump there is another optimum
            let thinner = (1..=200).map(|k| best.x[0] - NEAR * f64::from(k) / 200.0);
            let allowed = thinner.take_while(|&y| y >= bar.thinnest.max(0.0) && bar.stress(y) <= 0.0);
            allowed.map(|y| best.x[0] - y).fold(0.0, f64::max)
        });
    }
    ends.report(report, "bars");
    report.at_most("optima/bars/wrong claims", ends.wrong as f64, 0.0);
}

/// A slider-crank from drawn designs.
fn slider_crank(report: &mut Report) -> Result<(), String> {
    let mut optimization = Optimization::of(built_in::named("slider-crank")?).map_err(|error| error.to_string())?;
    (optimization.cases[0].settings.end, optimization.cases[0].settings.steps) = (2.5, 100);
    let mut noise = Noise::new(11);
    let (mut ends, mut unseen) = (Ends::default(), 0);
    for _ in 0..STARTS {
        let mut start = optimization.initial();
        for place in optimization.varying() {
            let variable = &optimization.variables()[place];
            let range = (variable.upper - variable.lower).min(4.0 * start[place].abs());
            start[place] = (start[place] + 0.2 * range * noise.next()).clamp(variable.lower, variable.upper);
        }
        let Ok(optimized) = optimization.run(&Sqp, &start, &mut ()) else {
            ends.otherwise += 1;
            continue;
        };
        let Some(best) = optimized.history.best() else { continue };
        let claimed = optimized.ended.reason.is_optimum();
        let mut gain_beside = |own: &DesignPoint| {
            let mut neighbour = || {
                let mut design = own.design.clone();
                for place in optimization.varying() {
                    let variable = &optimization.variables()[place];
                    let range = (variable.upper - variable.lower).min(design[place].abs());
                    design[place] = (design[place] + NEAR * range * noise.next()).clamp(variable.lower, variable.upper);
                }
                if optimization.linear_values(&design)[0] > 1.0 {
                    return 0.0;
                }
                let (method, settings) = (optimization.cases[0].method.clone(), optimization.cases[0].settings.clone());
                let prepared = Prepared::with(optimization.scene, &design, method, settings);
                let Ok(prepared) = prepared else { return 0.0 };
                // by name: an optimization has functionals of its own, those that are named in its problem
                let place = |name: &str| prepared.functionals().iter().position(|functional| functional.name == name);
                let (objective, limit) = (&optimization.problem.objective[0].0, &optimization.problem.constraints[0]);
                match (prepared.analysis().values(&design), place(objective), place(&limit.functional)) {
                    (Ok(values), Some(moment), Some(way)) if values[way] >= limit.limit.value() => {
                        (own.objective - values[moment]) / own.objective.abs()
                    }
                    _ => 0.0,
                }
            };
            (0..NEIGHBOURS).map(|_| neighbour()).fold(0.0, f64::max)
        };
        ends.judge(claimed, || gain_beside(best));
        let first = optimized.history.points.first().filter(|first| first.violation <= 0.0);
        unseen += first.map_or(0, |first| u32::from(gain_beside(first) <= BETTER));
    }
    ends.report(report, "slider-crank");
    report.at_most("optima/slider-crank/claims that a neighbour refutes", ends.wrong as f64, 0.0);
    // the check sees designs that are no optima
    report.at_most("optima/slider-crank/feasible starts that no neighbour refutes", f64::from(unseen), 0.0);
    Ok(())
}

/// All of them.
pub fn count(report: &mut Report) -> Result<(), String> {
    bars(report);
    slider_crank(report)
}
