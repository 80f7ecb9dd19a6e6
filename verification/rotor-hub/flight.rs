//! The hub under air loads: hover against blade elements and momentum, and the lightest blades that bear three flights.

use super::blade_element::{Blade, Strip, power, strips};
use super::swash_plate::pitch;
use super::{FLIGHTS, HUB, controls, told};
use crate::verification::Report;
use crate::verification::optimized::{by_iteration, optimize_from, seconds};
use costate::cli::{Chart, Series, Style};
use costate::optimize::{GradientBy, Optimization, Optimized};
use costate::prelude::DesignVariable;
use costate::scenes::{AnyScene, FileScene, Prepared};
use std::f64::consts::TAU;
use std::path::PathBuf;

const FLIGHT: &str = include_str!("../../examples/scenes/rotor-hub-flight.toml");

/// Inflow of strips of rigid blades.
const INFLOW: f64 = 1e-3;
/// Power that blades give to the air.
const POWER: f64 = 1e-4;
/// Height of the tip of an elastic blade at all times as a share of the largest, under a share of the controls: the theory leaves out lag, by which
/// larger flapping changes the tension of the blade twice in a turn.
const TIP: f64 = 0.01;
const SLIGHT: f64 = 0.25;
/// By how much optima from two starts differ, as a share of the mass.
const OPTIMA: f64 = 1e-3;
/// Largest violation of a limit at an optimum.
const VIOLATION: f64 = 1e-6;
/// Most iterations.
const ITERATIONS: usize = 60;
/// Turns until the inflow has settled, and turns of elastic blades.
const HOVER: usize = 6;
const FLAPPING: usize = 4;
/// Steps of a turn of theirs.
const STEPS: usize = 72;
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

/// A flight of some turns with so many steps in each.
fn flight(name: &str, lifts: [f64; 3], young: f64, [turns, steps]: [usize; 2]) -> Result<FileScene, String> {
    let [one, two, three] = lifts;
    extended(
        name,
        &format!(
            "define = {{ young = {young:e}, u1 = {one}, u2 = {two}, u3 = {three} }}\n\
             settings = {{ end = \"{turns} * 2 * pi / omega\", steps = {} }}\n\
             functional = [{{ name = \"power\", type = \"power\", over = \"terminal\" }}]\n",
            turns * steps
        ),
    )
}

pub fn air_loads(report: &mut Report) -> Result<(), String> {
    eprintln!("[7/8] flights under air loads");
    hover(report)?;
    let mut charts = Vec::new();
    for (name, lifts) in FLIGHTS.into_iter().skip(if report.is_short() { 2 } else { 0 }) {
        let [own, theory] = tip(name, lifts.map(|lift| SLIGHT * lift))?;
        charts.push(compare_tips(report, &format!("{name}, a quarter of the controls"), [&own, &theory], Some(TIP)));
        if !report.is_short() {
            let [own, theory] = tip(name, lifts)?;
            charts.push(compare_tips(report, name, [&own, &theory], None));
        }
    }
    report.picture("flapping", charts);
    Ok(())
}

/// Rigid blades until the inflow has settled.
fn hover(report: &mut Report) -> Result<(), String> {
    let scene = flight("rigid", [COLLECTIVE; 3], 70e12, [HOVER, 60])?;
    let prepared = Prepared::new(&scene).map_err(told)?;
    let model = prepared.model();
    let inflow = |i: usize| model.nodes.iter().find(|node| node.name == format!("inflow 0 {i}")).map(|node| node.dofs.start);
    let inflow: Vec<usize> = (0..).map_while(inflow).collect();
    let expected = strips(inflow.len(), pitch([COLLECTIVE; 3], 0.0, 0));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).map_err(told)?;
    let mut last = Vec::new();
    analysis.for_each_sample(&forward, |sample| last.clone_from(&sample.at.v)).map_err(told)?;
    let off = |(own, expected): (&usize, &Strip)| (last[*own] / expected.inflow - 1.0).abs();
    let off = inflow.iter().zip(&expected).map(off).fold(0.0, f64::max);
    report.inform("hover/inflow near the tip [m/s]", expected.last().map_or(f64::NAN, |own| own.inflow));
    report.at_most("hover/inflow of all strips against rings of momentum, share", off, INFLOW);
    let width = 1.56 / expected.len() as f64;
    report.inform("hover/thrust of a blade [N]", expected.iter().map(|own| own.thrust * width).sum());
    report.inform("hover/power of a blade [W]", power(&expected));
    let driven = prepared.functionals().iter().position(|own| own.name == "power").ok_or("no power")?;
    // what the air takes
    let own = -forward.values[driven] / 4.0;
    report.compare("hover/power of the strips by theirs", own / power(&expected), 1.0, POWER);
    Ok(())
}

/// How the tip of an elastic blade rises and flaps from the steady start on, and how by theory \[m\].
fn tip(name: &str, lifts: [f64; 3]) -> Result<[Vec<f64>; 2], String> {
    let scene = flight(name, lifts, 70e9, [FLAPPING, STEPS])?;
    let prepared = Prepared::new(&scene).map_err(told)?;
    let tip = prepared.model().nodes.iter().find(|node| node.name == "blade 0[24,1]").ok_or("no tip")?.dofs.start;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).map_err(told)?;
    let mut heights = Vec::new();
    analysis.for_each_sample(&forward, |sample| heights.push(sample.at.q[tip + 2] - 0.9)).map_err(told)?;
    let settings = scene.settings();
    let turn = settings.end / FLAPPING as f64;
    let angle = |t: f64| pitch(lifts.map(|lift| lift * controls(t / turn)), TAU * t / turn, 0);
    let blade = Blade::new(70e9, 70e9 / 2.6, 2500.0, 0.02);
    Ok([heights.split_off(1), blade.tip(12, angle, turn / STEPS as f64, settings.steps)])
}

/// Both courses of the tip, and the last turn of each.
fn compare_tips(report: &mut Report, name: &str, [own, theory]: [&[f64]; 2], tolerance: Option<f64>) -> Chart {
    let mean = |values: &[f64]| values[values.len() - STEPS..].iter().sum::<f64>() / STEPS as f64;
    let swing = |values: &[f64]| {
        let last = values[values.len() - STEPS..].iter().copied();
        0.5 * (last.clone().fold(f64::MIN, f64::max) - last.fold(f64::MAX, f64::min))
    };
    let name = |what: &str| format!("flapping/{name}/{what}");
    report.inform(name("coning in the last turn [mm]"), 1e3 * mean(own));
    report.inform(name("coning by that of blade elements"), mean(own) / mean(theory));
    report.inform(name("flapping in the last turn [mm]"), 1e3 * swing(own));
    report.inform(name("flapping by that of blade elements"), swing(own) / swing(theory));
    let most = theory.iter().copied().fold(0.0, f64::max);
    let off = own.iter().zip(theory).map(|(own, theory)| (own - theory).abs()).fold(0.0, f64::max) / most;
    let what = name("tip against blade elements at all times, share of the largest");
    match tolerance {
        Some(tolerance) => report.at_most(what, off, tolerance),
        None => report.inform(what, off),
    }
    let course = |what: &str, values: &[f64]| {
        let points = values.iter().enumerate().map(|(k, own)| ((k + 1) as f64 / STEPS as f64, 1e3 * own));
        Series { name: what.into(), points: points.collect(), ..Series::default() }
    };
    Chart {
        title: name("").trim_matches('/').into(),
        x_label: "turns".into(),
        y_label: "tip rises [mm]".into(),
        series: vec![course("costate", own), course("blade elements", theory)],
        ..Chart::default()
    }
}

pub fn optimum(report: &mut Report) -> Result<(), String> {
    eprintln!("[8/8] the lightest blades for three flights");
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
