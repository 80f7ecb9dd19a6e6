use crate::optimized::{DIFFERENCES, by_iteration, optimize, over_time, prepare, seconds, seconds_a_gradient};
use crate::{Form, Report, Study, on_one_thread};
use costate::elements::flexible::CableStrain;
use costate::functionals::{Functional, Over};
use costate::integrators::RunError;
use costate::internals::{CableLargestStress, Measured, MeasuredQuantity};
use costate::optimize::{GradientBy, Optimized};
use costate::scenes::{AnyScene, Prepared, Settings, built_in};
use costate::sensitivity::largest_difference;
use costate_cli::{Chart, Series};
use std::mem::take;

/// The suspension of a car with 60 variables, optimized by adjoint and by finite differences.
pub struct SuspensionStudy;

const STEPS: usize = 3000;
/// Elements of each tube.
const ELEMENTS: usize = 2;
const ITERATIONS: usize = 60;
/// Iterations by finite differences: each takes 61 simulations or more.
const DIFFERENCE_ITERATIONS: usize = 2;
/// Limit of the stresses [N/m2].
const STRESS: f64 = 4e8;
/// 1 / rho of stresses that are read, not optimized [N/m2]: the maximum but for 2e3.
const READING: f64 = 1e3;

impl Study for SuspensionStudy {
    fn name(&self) -> &'static str {
        "suspension"
    }
    fn summary(&self) -> &'static str {
        "double-wishbone suspension: 60 variables, 16 stress limits, optimum by adjoint and by finite differences"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_one_thread(|| study(report).map_err(|error| error.to_string()))
    }
}

fn study(report: &mut Report) -> Result<(), RunError> {
    let scene = built_in::named("suspension")?;
    let initial: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    gradient(report, scene, &initial)?;
    if report.is_short() {
        return Ok(());
    }

    eprintln!("[2/4] adjoint");
    let optimized = optimize(scene, STEPS, GradientBy::Adjoint, ITERATIONS)?;
    let history = &optimized.history;
    let Some((first, best)) = history.points.first().zip(history.best()) else {
        return Err(RunError::Input("nothing was simulated".into()));
    };
    report.inform("objective/initial [m2 s]", first.objective);
    report.inform("objective/optimum [m2 s]", best.objective);
    report.at_most("objective/optimum by initial", best.objective / first.objective, 0.5);
    report.inform("adjoint/iterations", optimized.ended.iterations as f64);
    report.inform("adjoint/simulations", history.work().simulations as f64);
    report.inform("adjoint/sweeps", history.work().sweeps as f64);
    report.at_most("adjoint/violation of limits", best.violation, 1e-6);
    report.note(format!("The optimization by adjoint ended because {}.", optimized.ended.reason));
    let mean = symmetry(report, scene, &best.design);
    let prepared = prepare(scene, &mean, STEPS)?;
    let change = prepared.analysis().values(&mean)?[0] / best.objective - 1.0;
    report.at_most("optimum/relative change of the objective by making the design symmetric", change.abs(), 1e-3);

    eprintln!("[3/4] finite differences");
    let differences = optimize(scene, STEPS, DIFFERENCES, DIFFERENCE_ITERATIONS)?;
    let reached = |optimized: &Optimized| {
        let at = optimized.history.points.iter().find(|point| point.iteration == Some(DIFFERENCE_ITERATIONS));
        at.map_or(f64::NAN, |point| point.objective)
    };
    report.inform(format!("adjoint/objective after {DIFFERENCE_ITERATIONS} iterations [m2 s]"), reached(&optimized));
    report.inform(
        format!("finite differences/objective after {DIFFERENCE_ITERATIONS} iterations [m2 s]"),
        reached(&differences),
    );
    report.inform("time/adjoint, whole optimization [s]", seconds(history));
    let times = [&optimized, &differences].map(seconds_a_gradient);
    report.inform("time/adjoint, a gradient with its line search [s]", times[0]);
    report.inform("time/finite differences, a gradient with its line search [s]", times[1]);
    report.inform("time/finite differences by adjoint", times[1] / times[0]);

    eprintln!("[4/4] courses");
    courses(report, scene, &initial, &best.design)?;
    let objective = [("adjoint", &optimized), ("finite differences", &differences)];
    let series = objective.map(|(name, optimized)| by_iteration(name, &optimized.history, |_, objective| objective));
    let (x_label, y_label) = ("iteration".into(), "objective [m2 s]".into());
    report.picture("objective", vec![Chart { x_label, y_label, series: series.into(), ..Chart::default() }]);
    refinements(report, &best.design, best.objective)
}

/// The objective's gradient by all variables: the adjoint against complex step, and its symmetry, over a tenth of the time.
fn gradient(report: &mut Report, scene: &dyn AnyScene, x: &[f64]) -> Result<(), RunError> {
    eprintln!("[1/4] gradient");
    let settings = scene.settings();
    let settings = Settings { end: 0.1 * settings.end, steps: STEPS / 10, ..settings };
    let mut prepared = Prepared::with(scene, x, Prepared::method_of(&settings)?, settings)?;
    prepared.mechanism.functionals.retain(|functional| functional.over == Over::Integral);
    let analysis = prepared.analysis();
    let forward = analysis.forward(x)?;
    let stepped = analysis.complex_step(x, &forward)?;
    let adjoint = analysis.adjoint(x, &forward)?;
    // position level: round-off of stiff members is divided by the step
    report.at_most("gradient/adjoint - complex step", largest_difference(&stepped.rows[0], &adjoint.rows[0]), 1e-9);
    let mirrored: Vec<f64> = (0..x.len())
        .map(|index| {
            let (other, sign) = mirrored(index);
            sign * adjoint.rows[0][other]
        })
        .collect();
    report.at_most("gradient/difference of the sides", largest_difference(&adjoint.rows[0], &mirrored), 1e-8);
    Ok(())
}

/// The variable that mirrors variable `index` on the other side, and its sign.
fn mirrored(index: usize) -> (usize, f64) {
    match index {
        // joints at the chassis, four of each wheel
        0..48 => {
            let (corner, place, axis) = (index / 12, index / 3 % 4, index % 3);
            ((3 - corner) * 12 + place * 3 + axis, if axis == 1 { -1.0 } else { 1.0 })
        }
        _ => (index / 4 * 4 + 3 - index % 4, 1.0),
    }
}

/// The design, how far it is from its mirror image by the ranges of the variables, and the mean of both.
///
/// Nothing asks for symmetry: what round-off leaves of it grows from iteration to iteration in directions that no step has explored yet.
fn symmetry(report: &mut Report, scene: &dyn AnyScene, design: &[f64]) -> Vec<f64> {
    let (mut largest, mut mean): (f64, _) = (0.0, Vec::new());
    for (index, variable) in scene.variables().iter().enumerate() {
        let (other, sign) = mirrored(index);
        let mirrored = sign * design[other];
        largest = largest.max((design[index] - mirrored).abs() / (variable.upper - variable.lower));
        mean.push(0.5 * (design[index] + mirrored));
        report.inform(format!("optimum/{} [{}]", variable.name, variable.unit), design[index]);
    }
    report.at_most("optimum/difference of the sides by the range of the variables", largest, 0.05);
    mean
}

/// The stress functionals of a design, read sharply.
fn sharpened(functionals: Vec<Functional>) -> Vec<Measured> {
    let sharp = |functional: Functional| match functional.measured {
        Measured::Local { nodes, constraints, parameters, .. } => {
            let quantity = CableLargestStress { strain: CableStrain::Exact, elements: ELEMENTS, sharpness: 1.0 / READING };
            let quantity = MeasuredQuantity::new(Box::new(quantity), 0);
            Measured::Local { nodes, constraints, parameters, quantity }
        }
        other => other,
    };
    let stresses = functionals.into_iter().filter(|functional| functional.unit == "N/m2");
    stresses.map(sharp).collect()
}

/// Displacement of the chassis in both designs and the stresses of the optimum.
fn courses(report: &mut Report, scene: &dyn AnyScene, initial: &[f64], optimum: &[f64]) -> Result<(), RunError> {
    let mut displacements = Vec::new();
    let mut stresses = Vec::new();
    for (name, design) in [("initial", initial), ("optimum", optimum)] {
        let mut prepared = prepare(scene, design, STEPS)?;
        let all = take(&mut prepared.mechanism.functionals);
        let (objective, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|f| f.over == Over::Integral);
        let sharp = sharpened(others);
        let measured: Vec<&Measured> = objective.iter().map(|f| &f.measured).chain(&sharp).collect();
        let mut courses = over_time(&prepared, &measured)?;
        let points: Vec<(f64, f64)> = courses.remove(0).into_iter().map(|(t, square)| (t, square.sqrt())).collect();
        let largest = points.iter().fold(0.0, |largest: f64, point| largest.max(point.1));
        report.inform(format!("{name}/largest displacement of the chassis [m]"), largest);
        displacements.push(Series { name: name.into(), points, ..Series::default() });
        let peak = |course: &Vec<(f64, f64)>| course.iter().fold(0.0, |largest: f64, point| largest.max(point.1));
        let peaks: Vec<f64> = courses.iter().map(peak).collect();
        for (beam, peak) in (1..).zip(&peaks) {
            report.at_most(format!("{name}/largest stress in beam {beam} [N/m2]"), *peak, STRESS);
        }
        stresses = courses;
    }
    let (x_label, y_label) = ("time [s]".into(), "displacement of the chassis [m]".into());
    report.picture("displacement", vec![Chart { x_label, y_label, series: displacements, ..Chart::default() }]);
    let chart = |title: &str, beams: [usize; 4], x_label: &str| {
        let series = beams.map(|beam| {
            let points = stresses[beam - 1].iter().map(|&(t, stress)| (t, 1e-6 * stress)).collect();
            Series { name: format!("beam {beam}"), points, ..Series::default() }
        });
        let (title, x_label, y_label) = (title.into(), x_label.into(), "largest stress [MPa]".into());
        Chart { title, x_label, y_label, series: series.into(), ..Chart::default() }
    };
    let panels = vec![chart("front", [1, 2, 3, 4], ""), chart("rear", [5, 6, 7, 8], "time [s]")];
    report.picture("stress", panels);
    Ok(())
}

/// The objective of the optimum with twice the elements and with half the steps.
fn refinements(report: &mut Report, design: &[f64], objective: f64) -> Result<(), RunError> {
    for (name, elements, steps) in [("twice the elements", 2 * ELEMENTS, STEPS), ("half the step", ELEMENTS, 2 * STEPS)] {
        let scene = built_in::changed("suspension", &format!("define.elements = {elements}"))?;
        let mut prepared = prepare(&scene, design, steps)?;
        prepared.mechanism.functionals.retain(|functional| functional.over == Over::Integral);
        let value = prepared.analysis().values(design)?[0];
        report.at_most(
            format!("optimum/relative change of the objective with {name}"),
            (value / objective - 1.0).abs(),
            0.01,
        );
    }
    Ok(())
}
