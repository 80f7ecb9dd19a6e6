//! Events, stops and latches, and formulas with pieces: values and gradients against closed forms and runs of another program.

mod bar;
mod cases;

use crate::compared::{Check, References, compare, measure, told};
use crate::{Clock, Form, Report, Study, median, on_one_thread};
use cases::CASES;
use costate::scenes::{FileScene, Prepared, Settings};
use costate_cli::{Chart, Series, Style};

/// Adjoint against complex step, by the largest derivative of a row.
const EXACT: f64 = 1e-11;
/// Cases whose errors are measured with these numbers of steps, with the place of a functional.
const ORDERS: [(&str, usize); 3] = [("wall", 0), ("clegg", 1), ("leaves", 0)];
const STEPS: [usize; 4] = [100, 200, 400, 800];
/// Numbers of events, and of variables, of a gradient whose time is measured.
const EVENTS: [usize; 3] = [5, 50, 500];
const VARIABLES: [usize; 3] = [1, 10, 50];
/// Runs and gradients of which the median counts.
const REPEATS: usize = 5;
/// Share of the rate that a bounce leaves, of many.
const RESTITUTION: f64 = 0.999;
/// Gravity of the scene of many events [m/s2].
const GRAVITY: f64 = 9.81;

/// The study.
pub struct Events;

impl Study for Events {
    fn name(&self) -> &'static str {
        "events"
    }
    fn summary(&self) -> &'static str {
        "events, stops, latches, one-sided forces: values and gradients against closed forms, order, cost of many events"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let references = References::read(include_str!("references.csv"))?;
        eprintln!("[1/5] cases");
        for case in &CASES {
            told(report, case.name, |report| compare(report, case, &references));
        }
        eprintln!("[2/5] limit cycle of a walker");
        told(report, "walker", |report| walker(report, &references));
        eprintln!("[3/5] bar against a wall");
        told(report, "bar", |report| bar::against_a_wall(report, references.value("E17", "time_of_contact")?));
        if report.is_short() {
            return Ok(());
        }
        eprintln!("[4/5] order");
        orders(report, &references)?;
        eprintln!("[5/5] many events");
        on_one_thread(|| many(report))
    }
}

/// One step of the walker leads back to its start; with the derivatives of the state behind it by the state before, F_x, and by the slope, F_s, the
/// start of the limit cycle changes by dx/ds = (1 - F_x)^-1 F_s.
fn walker(report: &mut Report, references: &References) -> Result<(), String> {
    let own = measure(cases::WALKER, |settings| settings, Check::ComplexStep)?;
    report.at_most("walker/adjoint against complex step", own.apart, EXACT);
    let names = ["theta", "rate", "phi_rate", "period"];
    let place = |name: &str| own.functionals.iter().position(|functional| functional == name);
    let places: Option<Vec<usize>> = names.iter().map(|name| place(name)).collect();
    let (Some(places), Some(phi)) = (places, place("phi")) else { return Err("a functional is not there".into()) };
    // variables: theta, rate, slope
    let rows: Vec<&Vec<f64>> = places.iter().map(|&k| &own.rows[k]).collect();
    let [a, b, c, d] = [1.0 - rows[0][0], -rows[0][1], -rows[1][0], 1.0 - rows[1][1]];
    let (f, g) = (rows[0][2], rows[1][2]);
    let determinant = a * d - b * c;
    let start = [(d * f - b * g) / determinant, (a * g - c * f) / determinant];
    for (name, (&k, row)) in names.iter().zip(places.iter().zip(&rows)) {
        let value = references.value("E05a", name)?;
        report.compare(format!("walker/{name} behind a step"), own.values[k], value, 1e-9 * value.abs());
        let slope = references.derivative("E05a", name, "gamma").ok_or("no derivative by the slope")?;
        let rate = row[2] + row[0] * start[0] + row[1] * start[1];
        report.compare(format!("walker/d {name} / d slope of the limit cycle"), rate, slope, 1e-8 * slope.abs());
    }
    report.compare("walker/angle between the legs behind a step", own.values[phi], 2.0 * own.x[0], 1e-9);
    Ok(())
}

/// Errors of values and derivatives with halved steps.
fn orders(report: &mut Report, references: &References) -> Result<(), String> {
    let mut charts = Vec::new();
    for (name, k) in ORDERS {
        let case = CASES.iter().find(|case| case.name == name).ok_or_else(|| format!("no case is named {name}"))?;
        let mut errors = Vec::new();
        for steps in STEPS {
            let own = measure(case.text, |settings| Settings { steps, ..settings }, Check::Gradient)?;
            errors.push(own.errors(k, case.reference, references)?);
        }
        let mut series = Vec::new();
        for (which, what) in ["value", "derivative"].into_iter().enumerate() {
            let [first, last] = [errors[0][which], errors[STEPS.len() - 1][which]];
            report.inform(format!("{name}/relative error of the {what} with {} steps", STEPS[0]), first);
            report.inform(format!("{name}/relative error of the {what} with {} steps", STEPS[STEPS.len() - 1]), last);
            // from the first to the last: errors of single halvings scatter with the places of events in their steps
            let order = (first / last).log2() / ((STEPS[STEPS.len() - 1] / STEPS[0]) as f64).log2();
            report.compare(format!("{name}/order of the {what}"), order, 4.0, 0.3);
            let points = STEPS.iter().zip(&errors).map(|(&steps, errors)| (steps as f64, errors[which])).collect();
            series.push(Series { name: what.into(), points, style: Style::Line });
        }
        let labels = ("steps".to_string(), "relative error".to_string());
        charts.push(Chart { title: name.into(), x_label: labels.0, y_label: labels.1, series, log_x: true, log_y: true });
    }
    report.picture("orders", charts);
    Ok(())
}

/// A ball that bounces so many times, whose height at the start is a sum of so many variables.
fn bouncing([events, variables]: [usize; 2]) -> (String, f64) {
    let first = (2.0 / GRAVITY).sqrt();
    let flights: f64 = (1..events).map(|k| 2.0 * RESTITUTION.powi(k as i32)).sum();
    let last = first * (1.0 + flights);
    // half of the flight behind the last bounce
    let (end, steps) = (last + first * RESTITUTION.powi(events as i32), 20 * events);
    let mut text = format!("version = 1\ngravity = [0, 0, -{GRAVITY}]\nsettings = {{ end = {end:e}, steps = {steps} }}\n");
    let mut height = "h".to_string();
    text += "variable.h = { initial = 1, bounds = [0.1, 10], unit = \"m\" }\n";
    for k in 1..variables {
        text += &format!("variable.c{k} = {{ initial = 0, bounds = [-1, 1], unit = \"m\" }}\n");
        height += &format!(" + c{k} / {k}");
    }
    text += &format!(
        "point = [{{ name = \"ball\", position = [0, 0, \"{height}\"], mass = 1 }}]\n\
         stop = [{{ name = \"floor\", nodes = {{ b = \"ball\" }}, value = \"b.position.z\", least = 0, restitution = {RESTITUTION} }}]\n\
         functional = [{{ name = \"time\", type = \"event_time\", event = \"floor\", number = {events}, over = \"terminal\" }}]\n"
    );
    (text, last)
}

/// Time of a gradient by that of its run, and the time of the last bounce with its derivative by the height h = 1 m, t / 2 h.
fn many(report: &mut Report) -> Result<(), String> {
    for events in EVENTS {
        for variables in VARIABLES {
            let (text, last) = bouncing([events, variables]);
            let scene = FileScene::parse("bouncing.toml", &text)?;
            let prepared = Prepared::new(&scene).map_err(|why| why.to_string())?;
            let (analysis, x) = (prepared.analysis(), &prepared.x);
            let mut seconds = [Vec::new(), Vec::new()];
            let mut errors = [0.0; 2];
            for _ in 0..REPEATS {
                let clock = Clock::start();
                let forward = analysis.forward(x).map_err(|why| why.to_string())?;
                seconds[0].push(clock.seconds());
                let clock = Clock::start();
                let gradient = analysis.adjoint(x, &forward).map_err(|why| why.to_string())?;
                seconds[1].push(clock.seconds());
                errors = [forward.values[0] / last - 1.0, 2.0 * gradient.rows[0][0] / last - 1.0].map(f64::abs);
            }
            let [run, gradient] = seconds.map(median);
            let name = format!("{events} bounces, {variables} variables");
            report.at_most(format!("{name}/relative error of the time of the last"), errors[0], 1e-11);
            report.at_most(format!("{name}/relative error of its derivative"), errors[1], 1e-11);
            report.inform(format!("{name}/time of the gradient by that of the run"), gradient / run);
        }
    }
    Ok(())
}
