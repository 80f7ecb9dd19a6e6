//! The hub under air loads: hover against blade elements and momentum, flapping against blade elements.

use super::blade_element::{Blade, Strip, power, strips};
use super::swash_plate::pitch;
use super::{FLIGHTS, controls, told};
use crate::{Report, largest};
use costate::scenes::{AnyScene, FileScene, Prepared, built_in};
use costate_cli::{Chart, Series};
use std::f64::consts::TAU;

/// Inflow of strips of rigid blades.
const INFLOW: f64 = 1e-3;
/// Power that blades give to the air.
const POWER: f64 = 1e-4;
/// Height of the tip of an elastic blade at all times as a share of the largest, under a share of the controls: the theory leaves out lag, and
/// what grows with the square of flapping.
const TIP: f64 = 0.01;
const SLIGHT: f64 = 0.25;
/// Turns until the inflow has settled, and turns of elastic blades.
const HOVER: usize = 6;
const FLAPPING: usize = 4;
/// Steps of a turn of theirs.
const STEPS: usize = 72;
/// Of all three rods.
const COLLECTIVE: f64 = 0.05;

/// A flight of some turns with so many steps in each.
fn flight(lifts: [f64; 3], young: f64, [turns, steps]: [usize; 2]) -> Result<FileScene, String> {
    let [one, two, three] = lifts;
    built_in::changed(
        "rotor-hub-flight",
        &format!(
            "define = {{ young = {young:e}, u1 = {one}, u2 = {two}, u3 = {three} }}\n\
             settings = {{ end = \"{turns} * 2 * pi / omega\", steps = {} }}\n\
             functional = [{{ name = \"power\", type = \"power\", over = \"terminal\" }}]\n",
            turns * steps
        ),
    )
}

pub fn air_loads(report: &mut Report) -> Result<(), String> {
    eprintln!("[7/7] flights under air loads");
    hover(report)?;
    let mut charts = Vec::new();
    for (name, lifts) in FLIGHTS.into_iter().skip(if report.is_short() { 2 } else { 0 }) {
        let [own, theory] = tip(lifts.map(|lift| SLIGHT * lift))?;
        charts.push(compare_tips(report, &format!("{name}, a quarter of the controls"), [&own, &theory], Some(TIP)));
        if !report.is_short() {
            let [own, theory] = tip(lifts)?;
            charts.push(compare_tips(report, name, [&own, &theory], None));
        }
    }
    report.picture("flapping", charts);
    Ok(())
}

/// Rigid blades until the inflow has settled.
fn hover(report: &mut Report) -> Result<(), String> {
    let scene = flight([COLLECTIVE; 3], 70e12, [HOVER, 60])?;
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
    let off = largest(inflow.iter().zip(&expected).map(off));
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
fn tip(lifts: [f64; 3]) -> Result<[Vec<f64>; 2], String> {
    let scene = flight(lifts, 70e9, [FLAPPING, STEPS])?;
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
    let off = largest(own.iter().zip(theory).map(|(own, theory)| (own - theory).abs())) / most;
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
