//! The lightest blades of a rotor hub whose stress stays below a limit in three flights under air loads.

use crate::optimized::{by_iteration, optimize_from, seconds};
use crate::rotor_hub::told;
use crate::{Form, Report, Study};
use costate::optimize::{GradientBy, Optimization, Optimized};
use costate::prelude::DesignVariable;
use costate::scenes::{AnyScene, FileScene, built_in};
use costate_cli::{Chart, Series, Style};

/// By how much optima from two starts differ, as a share of the mass.
const OPTIMA: f64 = 1e-3;
/// Largest violation of a limit at an optimum.
const VIOLATION: f64 = 1e-6;
/// Most iterations.
const ITERATIONS: usize = 60;

/// The study.
pub struct LightestBlades;

impl Study for LightestBlades {
    fn name(&self) -> &'static str {
        "lightest-blades"
    }
    fn summary(&self) -> &'static str {
        "the lightest blades of a rotor hub for three flights under air loads, from two starts"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Long]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        optimum_of(report, 12)?;
        if report.is_long() { optimum_of(report, 48) } else { Ok(()) }
    }
}

fn optimum_of(report: &mut Report, panels: usize) -> Result<(), String> {
    let scene = built_in::changed("rotor-hub-flight", &format!("define.along = {panels}"))?;
    let problem = Optimization::of(&scene).map_err(told)?.problem;
    let mut masses = Vec::new();
    let (mut thicknesses, mut courses) = (Vec::new(), Vec::new());
    for start in [0.02, 0.015] {
        let optimized = optimized(&scene, start)?;
        let name = |what: &str| format!("{panels} panels/from {} mm/{what}", 1e3 * start);
        let ends = optimized.history.points.first().zip(optimized.history.best());
        let (first, best) = ends.ok_or("nothing was simulated")?;
        report.inform(name("mass of a blade at the start [kg]"), first.objective);
        report.inform(name("mass of a blade [kg]"), best.objective);
        report.inform(name("iterations"), optimized.ended.iterations as f64);
        report.inform(name("simulations and gradients [s]"), seconds(&optimized.history));
        report.compare(name("ended at an optimum"), f64::from(optimized.ended.reason.is_optimum()), 1.0, 0.0);
        report.at_most(name("largest violation of a limit"), best.violation, VIOLATION);
        let conditions = optimized.ended.conditions.as_ref().ok_or("no conditions of optimality")?;
        report.at_most(
            name("slope of the Lagrangian where no bound holds it, scaled"),
            conditions.stationarity,
            conditions.tolerance,
        );
        let (limits, rows) = conditions.multipliers.split_at(problem.constraints.len());
        for (limit, multiplier) in problem.constraints.iter().zip(limits) {
            let place = optimized.history.functionals.iter().position(|own| own.0 == limit.functional).ok_or("no stress")?;
            report.inform(name(&format!("{} by the yield stress", limit.functional)), best.functionals[place]);
            report.inform(name(&format!("{}, multiplier of its limit, scaled", limit.functional)), *multiplier);
        }
        report.inform(
            name("active limits of the change from panel to panel"),
            rows.iter().filter(|own| **own != 0.0).count() as f64,
        );
        for (own, variable) in best.design.iter().zip(scene.variables()).filter(|own| own.1.name.starts_with("thickness")) {
            if start == 0.02 {
                report.inform(name(&format!("{} [mm]", variable.name)), 1e3 * own);
            }
        }
        let along = |(i, own): (usize, &f64)| {
            let edge = |i: usize| 0.44 + 1.56 * i as f64 / panels as f64;
            [(edge(i), 1e3 * own), (edge(i + 1), 1e3 * own)]
        };
        let panel = best.design[best.design.len() - panels..].iter().enumerate();
        let named = format!("from {} mm", 1e3 * start);
        thicknesses.push(Series { name: named.clone(), points: panel.flat_map(along).collect(), ..Series::default() });
        courses.push(by_iteration(&named, &optimized.history, |_, objective| objective));
        masses.push(best.objective);
    }
    report.at_most(
        format!("{panels} panels/difference of both optima, share of the mass"),
        (masses[0] / masses[1] - 1.0).abs(),
        OPTIMA,
    );
    courses.iter_mut().for_each(|own| own.style = Style::Both);
    let chart = |x_label: &str, y_label: &str, series| Chart {
        x_label: x_label.into(),
        y_label: y_label.into(),
        series,
        ..Chart::default()
    };
    report.picture(format!("thickness-{panels}"), vec![chart("radius [m]", "thickness [mm]", thicknesses)]);
    report.picture(format!("mass-{panels}"), vec![chart("iteration", "mass of a blade [kg]", courses)]);
    Ok(())
}

/// From blades of one thickness.
fn optimized(scene: &FileScene, start: f64) -> Result<Optimized, String> {
    let of = |own: DesignVariable| if own.name.starts_with("thickness") { start } else { own.initial };
    let design: Vec<f64> = scene.variables().into_iter().map(of).collect();
    optimize_from(&design, scene, scene.settings().steps, GradientBy::Adjoint, ITERATIONS).map_err(told)
}
