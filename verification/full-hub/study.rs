//! The rotor hub of Boopathy & Kennedy with blades of 48 panels: twelve functionals by all thicknesses and two lengths, and what simulation and
//! gradients take on the mesh of the source.

use crate::memory::{forget_peak, peak_memory};
use crate::whole_runs::{compare_with_whole_runs, inside};
use crate::{Form, PHASES, Report, Study, largest, on_threads, with_phases};
use costate::integrators::{Counters, DEFAULT_TABLE, RunError};
use costate::scenes::{AnyScene, FileScene, Prepared, built_in};
use costate_cli::{Chart, Series, Style};
use std::fmt::Write;
use std::time::Instant;

/// Adjoint against complex steps, as a share of the largest derivative of a functional.
const EXACT: f64 = 1e-10;

/// Functionals of the scene that belong to Table 6, and those that it has not.
const OWN: [&str; 2] = ["mass", "stress"];
const AGGREGATES: [(&str, &str); 4] = [
    ("exponential", "exponential"),
    ("exponential squared", "squared_exponential"),
    ("power", "power"),
    ("power squared", "squared_power"),
];

/// The study.
pub struct FullHub;

impl Study for FullHub {
    fn name(&self) -> &'static str {
        "full-hub"
    }
    fn summary(&self) -> &'static str {
        "rotor hub with blades of 48 panels: twelve functionals by 50 variables, times and memory of simulation and gradients"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short, Form::Long]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let (panels, steps) = if report.is_short() { (4, 3) } else { (48, 6) };
        eprintln!("[1/3] twelve functionals by {panels} thicknesses and two lengths");
        complex_steps(report, &hub(panels, 1)?, steps)?;
        eprintln!("[2/3] the mesh of the source along a direction");
        let across = if report.is_short() { 1 } else { 4 };
        whole_runs(report, &hub(panels, across)?, steps)?;
        eprintln!("[3/3] times and memory");
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let most = cores.min(2);
        let (scene, with_all) = (hub(panels, across)?, report.is_long());
        if most > 1 {
            on_threads(1, || times(report, &scene, (DEFAULT_TABLE, 1), false))?;
        }
        on_threads(most, || times(report, &scene, (DEFAULT_TABLE, most), with_all))?;
        on_threads(most, || times(report, &scene, ("dirk2", most), false))
    }
}

fn told(error: RunError) -> String {
    error.to_string()
}

/// The scene with so many panels, each of one element along the blade and some across it, and the functionals of Table 6.
fn hub(panels: usize, across: usize) -> Result<FileScene, String> {
    let mut text = format!("define = {{ along = {panels}, across = {across} }}\nvariable.panel.count = {panels}\n");
    let over = |kind: &str, more: &str| format!("{{ aggregate = \"{kind}\", sharpness = 50{more} }}");
    let stress = |text: &mut String, name: &str, over: String| {
        writeln!(
            text,
            "[[functional]]\nname = \"{name}\"\ntype = \"von_mises\"\nof = \"blade 0\"\nyield_stress = \"yield\"\nover = {over}"
        )
    };
    let mut add = || -> std::fmt::Result {
        writeln!(
            text,
            "\n[[functional]]\nname = \"compliance\"\ntype = \"strain_energy\"\nof = \"blade 0\"\nover = \"integral\""
        )?;
        stress(&mut text, "KS (continuous)", over("smooth_maximum", ", continuous = true"))?;
        for (name, kind) in AGGREGATES {
            stress(&mut text, &format!("induced ({name})"), over(kind, ", continuous = true"))?;
            stress(&mut text, &format!("induced (discrete {name})"), over(kind, ""))?;
        }
        Ok(())
    };
    add().map_err(|error| error.to_string())?;
    built_in::changed("rotor-hub", &text)
}

/// The scene in so many steps or the whole turn, at a design away from bounds.
fn prepared<'s>(scene: &'s FileScene, steps: Option<usize>, method: &str) -> Result<Prepared<'s>, String> {
    let mut settings = scene.settings().with_method(method);
    if let Some(steps) = steps {
        (settings.end, settings.steps) = (settings.end * steps as f64 / settings.steps as f64, steps);
    }
    Prepared::with(scene, &inside(scene), Prepared::method_of(&settings).map_err(told)?, settings).map_err(told)
}

/// Which functionals are among the first of Table 6, or all of its.
fn of_the_table(prepared: &Prepared, all: bool) -> Vec<bool> {
    let first = [OWN[0], OWN[1], "compliance"];
    let is_one = |name: &str| first.contains(&name) || all && (name.starts_with("KS") || name.starts_with("induced"));
    prepared.functionals().iter().map(|own| is_one(&own.name)).collect()
}

/// For methods of second to fourth order, as in the source's Figure 11.
fn complex_steps(report: &mut Report, scene: &FileScene, steps: usize) -> Result<(), String> {
    let mut series = Vec::new();
    for method in ["dirk2", "dirk3", DEFAULT_TABLE] {
        let prepared = prepared(scene, Some(steps), method)?;
        let (analysis, wanted) = (prepared.analysis(), of_the_table(&prepared, true));
        let forward = analysis.forward(&prepared.x).map_err(told)?;
        let adjoint = analysis.adjoint_of(&prepared.x, &forward, &wanted).map_err(told)?;
        let complex = analysis.complex_step(&prepared.x, &forward).map_err(told)?;
        let name = |what: &str| format!("complex step/{method}/{what}");
        report.inform(name("variables"), prepared.x.len() as f64);
        report.inform(name("functionals"), wanted.iter().filter(|own| **own).count() as f64);
        let rows = adjoint.rows.iter().zip(&complex.rows).zip(prepared.functionals()).zip(wanted);
        let mut points = Vec::new();
        for ((rows, functional), _) in rows.filter(|own| own.1) {
            let (own, exact) = rows;
            let size = largest(exact.iter().map(|exact| exact.abs()));
            let off = largest(own.iter().zip(exact).map(|(own, exact)| (own - exact).abs()));
            let functional = &functional.name;
            report.inform(name(&format!("{functional}/largest derivative")), size);
            report.at_most(name(&format!("{functional}/adjoint against it, share of the largest")), off / size, EXACT);
            points.push(((points.len() + 1) as f64, off / size));
        }
        series.push(Series { name: method.into(), points, style: Style::Both });
    }
    let chart = Chart {
        x_label: "functional, in the order of the table".into(),
        y_label: "adjoint against complex step, share of the largest".into(),
        log_y: true,
        series,
        ..Chart::default()
    };
    report.picture("complex-step", vec![chart]);
    Ok(())
}

fn whole_runs(report: &mut Report, scene: &FileScene, steps: usize) -> Result<(), String> {
    let prepared = prepared(scene, Some(steps), DEFAULT_TABLE)?;
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).map_err(told)?;
    let wanted = of_the_table(&prepared, true);
    let gradient = analysis.adjoint_of(x, &forward, &wanted).map_err(told)?;
    compare_with_whole_runs(report, "whole runs", &prepared, (&forward, &gradient), |k| wanted[k]).map_err(told)
}

/// What the time of a simulation or of gradients is spent on.
fn tell_shares(report: &mut Report, name: impl Fn(&str) -> String, counters: &Counters, seconds: f64) {
    let shares = counters.nanoseconds.unwrap_or_default().map(|own| 1e-9 * own as f64 / seconds);
    for (phase, share) in PHASES.into_iter().zip(shares) {
        report.inform(name(&format!("share of {phase}")), share);
    }
    report.inform(name("factorizations"), counters.factorizations as f64);
    report.inform(name("solutions"), counters.solves as f64);
}

/// Of a turn.
fn times(report: &mut Report, scene: &FileScene, (method, threads): (&str, usize), with_all: bool) -> Result<(), String> {
    let steps = report.is_short().then_some(3);
    let prepared = prepared(scene, steps, method)?;
    let x = &prepared.x;
    with_phases(prepared.analysis(), |analysis| {
        let name = |what: &str| format!("times/{method}/{threads} thread{}/{what}", if threads == 1 { "" } else { "s" });
        report.inform(name("unknowns"), prepared.linear_solver().map_err(told)?.unknowns as f64);
        forget_peak();
        let clock = Instant::now();
        let forward = analysis.forward(x).map_err(told)?;
        let seconds = clock.elapsed().as_secs_f64();
        report.inform(name("simulation [s]"), seconds);
        tell_shares(report, |what| name(&format!("simulation, {what}")), &forward.counters, seconds);
        let gradients = |all: bool| -> Result<(f64, Counters), String> {
            let clock = Instant::now();
            let gradient = analysis.adjoint_of(x, &forward, &of_the_table(&prepared, all)).map_err(told)?;
            Ok((clock.elapsed().as_secs_f64(), gradient.counters))
        };
        let (first, counters) = gradients(false)?;
        report.inform(name("gradients of mass, compliance and KS [s]"), first);
        tell_shares(report, |what| name(&format!("gradients, {what}")), &counters, first);
        report.inform(name("most memory of the process [MB]"), peak_memory().unwrap_or(f64::NAN) / 1e6);
        if with_all {
            let (all, _) = gradients(true)?;
            report.inform(name("gradients of all twelve [s]"), all);
            report.inform(name("each further functional, share of the first gradients"), (all / first - 1.0) / 9.0);
        }
        let stress = prepared.functional(OWN[1]).map_err(told)?;
        report.inform(name("KS of the von Mises stress by the yield stress"), forward.values[stress]);
        Ok(())
    })
}
