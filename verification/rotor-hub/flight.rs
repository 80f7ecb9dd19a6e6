//! The hub under air loads: hover against blade elements and momentum, and the lightest blades that bear three flights.

use super::blade_element::{coning, power, strips};
use super::swash_plate::pitch;
use super::{HUB, told};
use crate::verification::Report;
use crate::verification::optimized::{by_iteration, optimize_from, seconds};
use costate::cli::{Chart, Series, Style};
use costate::functionals::Sample;
use costate::optimize::{GradientBy, Optimization, Optimized};
use costate::prelude::DesignVariable;
use costate::scenes::{AnyScene, FileScene, Prepared};
use std::path::PathBuf;

const FLIGHT: &str = include_str!("../../examples/scenes/rotor-hub-flight.toml");

/// Inflow of strips of rigid blades.
const INFLOW: f64 = 1e-3;
/// Power that blades give to the air.
const POWER: f64 = 1e-4;
/// Coning of elastic blades, whose twist, some hundredths of their pitch, the theory leaves out.
const CONING: f64 = 0.03;
/// By how much optima from two starts differ, as a share of the mass.
const OPTIMA: f64 = 1e-3;
/// Largest violation of a limit at an optimum.
const VIOLATION: f64 = 1e-6;
/// Most iterations.
const ITERATIONS: usize = 60;
/// Turns until the inflow has settled; over the last ones the mean is taken of what still swings.
const TURNS: usize = 6;
const LAST: f64 = 2.0;
/// Of all three rods.
const COLLECTIVE: f64 = 0.05;

/// A scene that extends the flights, read from a folder of its own.
fn extended(name: &str, text: &str) -> Result<FileScene, String> {
    let folder: PathBuf = std::env::temp_dir().join(format!("costate-rotor-hub-{}", std::process::id()));
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(&folder).map_err(wrong)?;
    let own = format!("{name}.toml");
    let text = format!("version = 1\nextends = \"rotor-hub-flight.toml\"\n{text}");
    for (file, text) in [("rotor-hub.toml", HUB), ("rotor-hub-flight.toml", FLIGHT), (&own, &text)] {
        std::fs::write(folder.join(file), text).map_err(wrong)?;
    }
    let scene = FileScene::read(&folder.join(own));
    std::fs::remove_dir_all(&folder).map_err(wrong)?;
    scene
}

/// Rods at their collective lift until the inflow has settled.
fn hover(name: &str, young: f64) -> Result<FileScene, String> {
    extended(
        name,
        &format!(
            "define.young = {young:e}\nsettings = {{ end = \"{TURNS} * 2 * pi / omega\", steps = {} }}\n\
             functional = [{{ name = \"power\", type = \"power\", over = \"terminal\" }}]\n",
            60 * TURNS
        ),
    )
}

pub fn air_loads(report: &mut Report) -> Result<(), String> {
    eprintln!("[6/7] hover under air loads");
    let angle = pitch([COLLECTIVE; 3], 0.0, 0);
    for (name, young) in [("rigid", 70e12), ("elastic", 70e9)] {
        let scene = hover(name, young)?;
        let prepared = Prepared::new(&scene).map_err(told)?;
        let model = prepared.model();
        let inflow =
            |i: usize| model.nodes.iter().find(|node| node.name == format!("inflow 0 {i}")).map(|node| node.dofs.start);
        let inflow: Vec<usize> = (0..).map_while(inflow).collect();
        let expected = strips(inflow.len(), angle);
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).map_err(told)?;
        let tip = model.nodes.iter().find(|node| node.name == format!("blade 0[{},1]", 2 * inflow.len()));
        let tip = tip.ok_or("no tip")?.dofs.start;
        let settled = (1.0 - LAST / TURNS as f64) * scene.settings().end;
        let (mut last, mut heights) = (Vec::new(), Vec::new());
        let see = |sample: &Sample<f64>| {
            last.clone_from(&sample.at.v);
            if sample.t >= settled {
                heights.push(sample.at.q[tip + 2] - 0.9);
            }
        };
        analysis.for_each_sample(&forward, see).map_err(told)?;
        if name == "elastic" {
            // EI and mass of a blade of 0.121 x 0.02 m
            let (bending, mass) = (young * 0.121 * 0.02_f64.powi(3) / 12.0, 2500.0 * 0.121 * 0.02);
            let theory = coning(&expected, angle, bending, mass);
            report.inform("hover/elastic/the tip rises by [mm]", 1e3 * theory);
            let own = heights.iter().sum::<f64>() / heights.len() as f64;
            report.compare("hover/elastic/coning by that of a blade under blade elements", own / theory, 1.0, CONING);
            break;
        }
        let off = |(own, expected): (&usize, &super::blade_element::Strip)| (last[*own] / expected.inflow - 1.0).abs();
        let off = inflow.iter().zip(&expected).map(off).fold(0.0, f64::max);
        report.inform("hover/rigid/inflow near the tip [m/s]", expected.last().map_or(f64::NAN, |own| own.inflow));
        report.at_most("hover/rigid/inflow of all strips against rings of momentum, share", off, INFLOW);
        let width = 1.56 / expected.len() as f64;
        report.inform("hover/rigid/thrust of a blade [N]", expected.iter().map(|own| own.thrust * width).sum());
        report.inform("hover/rigid/power of a blade [W]", power(&expected));
        let driven = prepared.functionals().iter().position(|own| own.name == "power").ok_or("no power")?;
        // what the air takes
        let own = -forward.values[driven] / 4.0;
        report.compare("hover/rigid/power of the strips by theirs", own / power(&expected), 1.0, POWER);
    }
    Ok(())
}

pub fn optimum(report: &mut Report) -> Result<(), String> {
    eprintln!("[7/7] the lightest blades for three flights");
    optimum_of(report, 12)?;
    if report.is_long() { optimum_of(report, 48) } else { Ok(()) }
}

fn optimum_of(report: &mut Report, panels: usize) -> Result<(), String> {
    let scene = extended(&format!("panels {panels}"), &format!("define.along = {panels}\n"))?;
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
