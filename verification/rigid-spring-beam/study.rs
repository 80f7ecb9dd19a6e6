use crate::optimized::{DIFFERENCES, by_iteration, optimize, optimize_from, over_time, prepare, seconds};
use crate::{Report, Study, on_one_thread};
use costate::functionals::Over;
use costate::integrators::RunError;
use costate::internals::Measured;
use costate::optimize::{GradientBy, Optimized};
use costate::scenes::{AnyScene, FileScene, Prepared, Settings, built_in};
use costate::sensitivity::largest_difference;
use costate_cli::{Chart, Series};

/// A rigid bar held by a spring and a turning beam: where the beam's hinge must be so that the bar moves least.
pub struct RigidSpringBeamStudy;

/// Steps of 1 ms and of 0.5 ms, as in the source.
const STEPS: [usize; 2] = [1000, 2000];
const ITERATIONS: usize = 60;
/// The variables that vary.
const PLACE: [(usize, &str); 2] = [(0, "x of D"), (1, "y of D")];

impl Study for RigidSpringBeamStudy {
    fn name(&self) -> &'static str {
        "rigid-spring-beam"
    }
    fn summary(&self) -> &'static str {
        "rigid bar, spring and beam: optimum of a hinge's place, by adjoint and by finite differences"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        on_one_thread(|| study(report).map_err(|error| error.to_string()))
    }
}

fn study(report: &mut Report) -> Result<(), RunError> {
    gradient(report)?;
    let [coarse, fine] = [optimize_with(STEPS[0], report)?, optimize_with(STEPS[1], report)?];
    let best = |optimized: &Optimized| {
        optimized.history.best().map_or((f64::NAN, Vec::new()), |point| (point.objective, point.design.clone()))
    };
    // there are several optima, and both ways may lead to others: the steps are compared at one of them
    let (value, design) = best(&coarse);
    let same = optimize_from(&design, scene()?, STEPS[1], GradientBy::Adjoint, ITERATIONS)?;
    let (fine_value, fine_design) = best(&same);
    report.inform("optimum/objective of the one found with 0.5 ms, by that found with 1 ms", best(&fine).0 / value);
    let shift = PLACE.map(|(k, _)| (design[k] - fine_design[k]).abs());
    report.at_most("optimum/place of D, difference of the two steps [m]", shift[0].max(shift[1]), 0.02);
    report.at_most("optimum/objective, relative difference of the two steps", (value / fine_value - 1.0).abs(), 0.01);
    let independent = with_method("esdirk4", &design, 8000)?;
    report.at_most("optimum/objective, relative difference to esdirk4", (value / independent - 1.0).abs(), 0.01);

    eprintln!("[3/3] finite differences");
    let differences = optimize(scene()?, STEPS[0], DIFFERENCES, ITERATIONS)?;
    let (other, other_design) = best(&differences);
    report.inform("finite differences/objective [m2 s]", other);
    for (k, name) in PLACE {
        report.inform(format!("finite differences/{name} [m]"), other_design[k]);
    }
    report.inform("finite differences/iterations", differences.ended.iterations as f64);
    report.inform("finite differences/simulations", simulations(&differences));
    let times = [&coarse, &differences].map(|optimized| seconds(&optimized.history));
    report.inform("time/adjoint [s]", times[0]);
    report.inform("time/finite differences [s]", times[1]);
    report.inform("time/finite differences by adjoint", times[1] / times[0]);
    report.compare(
        "finite differences/not better than the adjoint's optimum",
        f64::from(other >= value * (1.0 - 1e-6)),
        1.0,
        0.0,
    );
    pictures(report, [&coarse, &fine, &differences])
}

fn simulations(optimized: &Optimized) -> f64 {
    let work = optimized.history.work();
    (work.simulations + work.sweeps) as f64
}

/// At the first design: the adjoint against complex step, for the place of the hinge in space, the stiffness and the mass.
fn gradient(report: &mut Report) -> Result<(), RunError> {
    eprintln!("[1/3] gradient");
    let prepared = prepare(scene()?, &initial()?, STEPS[0])?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x)?;
    let stepped = analysis.complex_step(&prepared.x, &forward)?;
    let adjoint = analysis.adjoint(&prepared.x, &forward)?;
    let limits = prepared.gradient_limits(GRADIENT_LIMIT)?;
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let difference = largest_difference(&stepped.rows[k], &adjoint.rows[k]);
        report.at_most(format!("gradient/{}, adjoint - complex step", functional.name), difference, limits[k]);
    }
    Ok(())
}

/// Position level, 1000 steps: round-off of the beam's axial force, 7e6 N for a strain of 1, is divided by the step in velocities. Where a
/// rounding of the variables does more, four times that is the limit.
const GRADIENT_LIMIT: f64 = 1e-10;

fn scene() -> Result<&'static FileScene, String> {
    built_in::named("rigid-spring-beam")
}

fn initial() -> Result<Vec<f64>, String> {
    Ok(scene()?.variables().iter().map(|variable| variable.initial).collect())
}

fn optimize_with(steps: usize, report: &mut Report) -> Result<Optimized, RunError> {
    let step = format!("{} ms", 1e3 / steps as f64);
    eprintln!("[2/3] steps of {step}");
    let optimized = optimize(scene()?, steps, GradientBy::Adjoint, ITERATIONS)?;
    let history = &optimized.history;
    let ends = history.points.first().zip(history.best());
    let Some((first, best)) = ends else { return Err(RunError::Input("nothing was simulated".into())) };
    report.inform(format!("{step}/objective, initial [m2 s]"), first.objective);
    report.inform(format!("{step}/objective, optimum [m2 s]"), best.objective);
    report.at_most(format!("{step}/optimum by initial"), best.objective / first.objective, 0.1);
    for (k, name) in PLACE {
        report.inform(format!("{step}/{name} [m]"), best.design[k]);
    }
    report.inform(format!("{step}/iterations"), optimized.ended.iterations as f64);
    report.inform(format!("{step}/simulations and sweeps"), simulations(&optimized));
    report.compare(format!("{step}/ended at an optimum"), f64::from(optimized.ended.reason.is_optimum()), 1.0, 0.0);
    report.at_most(format!("{step}/violation of the length"), best.violation, 1e-6);
    Ok(optimized)
}

/// The objective of a design with another integrator.
fn with_method(name: &'static str, design: &[f64], steps: usize) -> Result<f64, RunError> {
    let settings = Settings { method: Some(name.into()), steps, ..scene()?.settings() };
    let prepared = Prepared::with(scene()?, design, Prepared::method_of(&settings)?, settings)?;
    Ok(prepared.analysis().values(&prepared.x)?[0])
}

/// The figures of the source: displacement of B, objective and place of D by iteration.
fn pictures(report: &mut Report, [coarse, fine, differences]: [&Optimized; 3]) -> Result<(), RunError> {
    let initial = initial()?;
    let optimum = coarse.history.best().map_or_else(|| initial.clone(), |point| point.design.clone());
    let mut displacements = Vec::new();
    for (name, design, steps) in [
        ("initial, 1 ms", &initial, STEPS[0]),
        ("initial, 0.5 ms", &initial, STEPS[1]),
        ("optimum, 1 ms", &optimum, STEPS[0]),
        ("optimum, 0.5 ms", &optimum, STEPS[1]),
    ] {
        let prepared = prepare(scene()?, design, steps)?;
        let objective = prepared.functionals().iter().find(|functional| functional.over == Over::Integral);
        let measured: Vec<&Measured> = objective.iter().map(|functional| &functional.measured).collect();
        let courses = over_time(&prepared, &measured)?;
        let points: Vec<(f64, f64)> = courses.concat().into_iter().map(|(t, square)| (t, square.sqrt())).collect();
        let largest = points.iter().fold(0.0, |largest: f64, point| largest.max(point.1));
        report.inform(format!("largest displacement of B/{name} [m]"), largest);
        displacements.push(Series { name: name.into(), points, ..Series::default() });
    }
    let chart = |x_label: &str, y_label: &str, series: Vec<Series>| Chart {
        x_label: x_label.into(),
        y_label: y_label.into(),
        series,
        ..Chart::default()
    };
    report.picture("displacement", vec![chart("time [s]", "displacement of B [m]", displacements)]);
    let runs = [("adjoint, 1 ms", coarse), ("adjoint, 0.5 ms", fine), ("finite differences, 1 ms", differences)];
    let all = |value: &dyn Fn(&[f64], f64) -> f64| {
        runs.iter().map(|(name, optimized)| by_iteration(name, &optimized.history, value)).collect::<Vec<_>>()
    };
    let mut objective = chart("", "objective [m2 s]", all(&|_, objective| objective));
    objective.log_y = true;
    let panels = vec![
        objective,
        chart("", "x of D [m]", all(&|design, _| design[0])),
        chart("iteration", "y of D [m]", all(&|design, _| design[1])),
    ];
    report.picture("iterations", panels);
    Ok(())
}
