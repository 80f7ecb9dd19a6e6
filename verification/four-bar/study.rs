use crate::{Clock, Form, Report, Study, on_one_thread, on_threads};
use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, DEFAULT_TABLE, Method, RunError, StepRecord, table_by_name};
use costate::internals::march_dividing;
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene, built_in};
use costate_cli::{Chart, Series, Style};
use std::time::Instant;

/// The flexible four-bar mechanism with every method: forces, time, gradients.
pub struct FourBar;

impl Study for FourBar {
    fn name(&self) -> &'static str {
        "four-bar"
    }
    fn summary(&self) -> &'static str {
        "flexible four-bar mechanism: which methods run, error of its forces against time, gradients"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        if !Clock::counts_computing() {
            report.note("This system does not count the time of a thread: other work on the machine is in these figures.");
        }
        on_one_thread(|| {
            if report.is_short() {
                compare_published(report, &run(DEFAULT_TABLE, [4, 8, 4], 1200).map_err(|error| error.to_string())?);
                return gradients(report);
            }
            let reference = reference(report)?;
            every_method(report, &reference)?;
            gradients(report)
        })
    }
}

/// Methods of the table.
const METHODS: [&str; 12] = [
    "midpoint",
    "dirk2",
    "dirk3",
    "sdirk2",
    "sdirk3",
    "sdirk4",
    "esdirk3",
    "esdirk4",
    "esdirk5",
    "bdf2",
    "generalized-alpha",
    "newmark",
];

/// When all bars lie in one line [s], and how long the bars ring after that, faster than steps of 10 ms resolve.
const SNAPS: [f64; 2] = [2.6, 7.8];
const RINGING: f64 = 0.6;
/// Methods that damp nothing: the ringing of each snap stays, and whether halved steps get through the next one is a matter of round-off.
const UNDAMPED: [&str; 2] = ["midpoint", "newmark"];
/// Duration [s].
const END: f64 = 12.0;
/// Gradients of which the fastest counts.
const REPETITIONS: usize = 3;
/// Moments at which courses are compared: every 10 ms.
const MOMENTS: usize = 1200;

/// What is followed, by the names of the scene's functionals.
const COURSES: [&str; 5] = [
    "axial force at mid-span of AB",
    "torsion at mid-span of AB",
    "largest moment at mid-span of AB",
    "moment about the hinges at mid-span of AB",
    "angle at D",
];
const AXIAL: usize = 0;
const TORSION: usize = 1;
const MOMENT: usize = 2;
const ABOUT_HINGES: usize = 3;
const ANGLE: usize = 4;

/// One run: courses every 10 ms, place of C at 3 s, work.
struct Course {
    /// One row for each of [`COURSES`].
    values: Vec<Vec<f64>>,
    /// Largest and smallest over all steps, one pair for each of them.
    extremes: Vec<[f64; 2]>,
    place_of_c: [f64; 3],
    seconds: f64,
    iterations: usize,
    divided: usize,
}

fn method(name: &str) -> Result<Method, String> {
    let table = table_by_name(name).ok_or_else(|| format!("no integrator is named \"{name}\""))?;
    Ok(Method::new(table, ConstraintLevel::Acceleration))
}

fn prepare<'s>(scene: &'s dyn AnyScene, name: &str) -> Result<Prepared<'s>, RunError> {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = method(name).map_err(RunError::Input)?;
    Prepared::with(scene, &x, method, scene.settings().without_method())
}

/// The scene with changes over some time in some steps.
fn changed(changes: &str, (end, steps): (f64, usize)) -> Result<FileScene, String> {
    built_in::changed("flexible-four-bar", &format!("{changes}\nsettings = {{ end = {end:e}, steps = {steps} }}"))
}

fn run(name: &str, elements: [usize; 3], steps: usize) -> Result<Course, RunError> {
    let [ab, bc, cd] = elements;
    let scene = changed(&format!("beam = {{ AB.elements = {ab}, BC.elements = {bc}, CD.elements = {cd} }}"), (END, steps))?;
    let prepared = prepare(&scene, name)?;
    let model = prepared.model();
    let p = &prepared.mechanism.numbers.p;
    let find = |name: &&str| prepared.functionals().iter().find(|functional| functional.name == *name);
    let functionals: Vec<_> = COURSES.iter().filter_map(find).collect();
    let c = model.nodes.iter().find(|node| node.name == "CD[0]").map_or(0, |node| node.dofs.start);
    let mut course = Course {
        values: vec![Vec::new(); COURSES.len()],
        extremes: vec![[f64::INFINITY, f64::NEG_INFINITY]; COURSES.len()],
        place_of_c: [f64::NAN; 3],
        seconds: 0.0,
        iterations: 0,
        divided: 0,
    };
    let (mut moment, mut sample) = (0, Sample::empty());
    let mut measuring = 0.0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let clock = Clock::start();
        sample.set_terminal(step);
        // steps may have been divided: moments are told by their time
        let at_moment = step.t + step.h >= (moment + 1) as f64 * END / MOMENTS as f64 - 1e-9;
        moment += usize::from(at_moment);
        for (k, functional) in functionals.iter().enumerate() {
            let value = functional.measured.value(model, &sample, p);
            let [least, most] = course.extremes[k];
            course.extremes[k] = [least.min(value), most.max(value)];
            if at_moment {
                course.values[k].push(value);
            }
        }
        if at_moment && moment == MOMENTS / 4 {
            // published are displacements
            (0..3).for_each(|i| course.place_of_c[i] = step.q[c + i] - prepared.mechanism.numbers.q[c + i]);
        }
        measuring += clock.seconds();
        true
    });
    let clock = Clock::start();
    let (_, run) = march_dividing(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch);
    let run = run?;
    course.seconds = clock.seconds() - measuring;
    (course.iterations, course.divided) = (run.counters.iterations, run.rejected);
    Ok(course)
}

/// Largest difference of two courses.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The best that we can do: a finer mesh and shorter steps; how far the usual ones are from it, and all from the published figures.
fn reference(report: &mut Report) -> Result<Course, String> {
    let own = |name, elements, steps| run(name, elements, steps).map_err(|error| format!("reference: {error}"));
    eprintln!("[1/3] default method and references");
    let usual = own(DEFAULT_TABLE, [4, 8, 4], 1200)?;
    let fine_steps = own(DEFAULT_TABLE, [4, 8, 4], 4800)?;
    let finest = own(DEFAULT_TABLE, [8, 16, 8], 4800)?;
    let peak = finest.extremes[AXIAL][0].abs();
    compare_published(report, &usual);
    for (name, course) in [("10 ms, 4/8/4", &usual), ("2.5 ms, 4/8/4", &fine_steps)] {
        let (own, fine) = (&course.values[AXIAL], &finest.values[AXIAL]);
        let quiet = |i: &usize| {
            let t = 0.01 * (i + 1) as f64;
            SNAPS.iter().all(|snap| !(*snap..snap + RINGING).contains(&t))
        };
        let away = (0..own.len()).filter(quiet).map(|i| (own[i] - fine[i]).abs()).fold(0.0, f64::max) / peak;
        let label = format!("axial force against 2.5 ms, 8/16/8/{name}, largest difference by the peak");
        report.at_most(format!("{label}, but for 0.6 s after each snap"), away, 0.01);
        report.inform(format!("{label}, everywhere"), difference(own, fine) / peak);
        let lowest = course.extremes[AXIAL][0] / finest.extremes[AXIAL][0] - 1.0;
        report.at_most(format!("lowest axial force against 2.5 ms, 8/16/8/{name}, relative"), lowest.abs(), 0.01);
    }
    report.inform("2.5 ms, 8/16/8/lowest axial force [N]", finest.extremes[AXIAL][0]);
    report.at_most("default at 10 ms/largest tension by the peak: none spurious", usual.extremes[AXIAL][1] / peak, 0.01);
    let chart = |course: usize, y_label: &str| {
        let moment = |(i, &value): (usize, &f64)| (0.01 * (i + 1) as f64, value);
        let series = [("10 ms, 4/8/4", &usual), ("2.5 ms, 8/16/8", &finest)].map(|(name, own)| Series {
            name: name.into(),
            points: own.values[course].iter().enumerate().map(moment).collect(),
            style: Style::Line,
        });
        Chart { x_label: "time [s]".into(), y_label: y_label.into(), series: series.into(), ..Chart::default() }
    };
    let charts = vec![
        chart(AXIAL, "axial force, middle of AB [N]"),
        chart(TORSION, "torsion [N m]"),
        chart(MOMENT, "moment out of the plane [N m]"),
        chart(ABOUT_HINGES, "moment about the hinges [N m]"),
    ];
    report.picture("four-bar", charts);
    Ok(fine_steps)
}

/// A run with 10 ms against the published figures.
fn compare_published(report: &mut Report, usual: &Course) {
    // Bauchau et al. (2016) and other codes: converged within 0.5 %
    let published = [
        ("lowest axial force [N]", usual.extremes[AXIAL][0], -5960.0),
        ("lowest torsion [N m]", usual.extremes[TORSION][0], -52.8),
        ("largest torsion [N m]", usual.extremes[TORSION][1], 66.0),
        ("largest moment [N m]", usual.extremes[MOMENT][1], 123.5),
        ("lowest angle at D [rad]", usual.extremes[ANGLE][0], -1.582),
        ("largest angle at D [rad]", usual.extremes[ANGLE][1], 1.576),
        ("torsion at 3 s [N m]", usual.values[TORSION][299], -13.75),
        ("moment at 3 s [N m]", usual.values[MOMENT][299], 119.3),
    ];
    for (name, value, expected) in published {
        report.compare(format!("default at 10 ms/{name}"), value, expected, 0.01 * f64::abs(expected));
    }
    // signs of moments depend on section axes: 2.66 N m is a size, given with three digits
    let at_3 = usual.values[ABOUT_HINGES][299].abs();
    report.compare("default at 10 ms/moment about the hinges at 3 s [N m]", at_3, 2.66, 0.01 * 2.66);
    for (i, (name, expected)) in [("x", 0.09453), ("y", -0.04626), ("z", -0.00406)].into_iter().enumerate() {
        // the last published digit, and 1 % of the motion out of the plane
        report.compare(format!("default at 10 ms/displacement {name} of C at 3 s [m]"), usual.place_of_c[i], expected, 4e-5);
    }
}

fn every_method(report: &mut Report, reference: &Course) -> Result<(), String> {
    eprintln!("[2/3] every method");
    let peak = reference.extremes[AXIAL][0].abs();
    for name in METHODS {
        for steps in [1200, 2400] {
            let label = format!("{name}/{} ms", 1e3 * END / steps as f64);
            match run(name, [4, 8, 4], steps) {
                Ok(course) => {
                    report.compare(format!("{label}/steps finished"), steps as f64, steps as f64, 0.0);
                    let error = difference(&course.values[AXIAL], &reference.values[AXIAL]) / peak;
                    report.inform(format!("{label}/largest error of the axial force by its peak"), error);
                    report.inform(format!("{label}/largest tension [N]"), course.extremes[AXIAL][1]);
                    report.inform(format!("{label}/lowest axial force [N]"), course.extremes[AXIAL][0]);
                    report.inform(format!("{label}/steps divided"), course.divided as f64);
                    report.inform(format!("{label}/Newton iterations a step"), course.iterations as f64 / steps as f64);
                    report.inform(format!("{label}/time [s]"), course.seconds);
                    let aim = match (name, steps) {
                        ("bdf2", 1200) => 0.9,
                        (DEFAULT_TABLE, 1200) => 2.0,
                        _ => continue,
                    };
                    report.inform(format!("{label}/time by the aim of {aim} s"), course.seconds / aim);
                }
                Err(error) => {
                    if UNDAMPED.contains(&name) {
                        report.inform(format!("{label}/steps finished"), 0.0);
                    } else {
                        report.compare(format!("{label}/steps finished"), 0.0, steps as f64, 0.0);
                    }
                    report.note(format!("{label}: {error}"));
                }
            }
        }
    }
    Ok(())
}

/// Adjoint against complex step, and their cost.
fn gradients(report: &mut Report) -> Result<(), String> {
    eprintln!("[3/3] gradients");
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    for name in [DEFAULT_TABLE, "bdf2"].into_iter().take(if report.is_short() { 1 } else { 2 }) {
        let run = if report.is_short() { (0.1 * END, MOMENTS / 10) } else { (END, MOMENTS) };
        let scene = changed("", run)?;
        let prepared = prepare(&scene, name).map_err(|error| error.to_string())?;
        let first: Vec<_> = prepared.functionals().iter().take(1).map(|functional| functional.name.clone()).collect();
        let mut analysis = prepared.analysis();
        analysis.functionals = &prepared.functionals()[..1];
        let clock = Clock::start();
        let forward = analysis.forward(&prepared.x).map_err(|error| error.to_string())?;
        let of_forward = clock.seconds();
        let clock = Clock::start();
        let adjoint = analysis.adjoint(&prepared.x, &forward).map_err(|error| error.to_string())?;
        let of_adjoint = clock.seconds();
        let complex_step = analysis.complex_step(&prepared.x, &forward).map_err(|error| error.to_string())?;
        let difference = largest_difference(&adjoint.rows[0], &complex_step.rows[0]);
        report.at_most(format!("{name}/gradient of the {}, adjoint - complex step", first[0]), difference, 1e-10);
        for (run, counters) in [("simulation", &forward.counters), ("adjoint", &adjoint.counters)] {
            let share = counters.factorizations as f64 / counters.systems as f64;
            report.inform(format!("{name}/factorizations of the {run} by its systems"), share);
        }
        if report.is_short() {
            return Ok(());
        }
        report.inform(format!("{name}/time of the simulation [s]"), of_forward);
        report.inform(format!("{name}/time of the adjoint by that of the simulation"), of_adjoint / of_forward);
        for threads in [1, 2, 4, 8, 16] {
            if threads <= available {
                on_threads(threads, || ratio_of_day(report, name, &prepared, threads))?;
            }
        }
    }
    Ok(())
}

/// Time of day of adjoint and simulation, which is that of one thread, and what the adjoint gains by several.
fn ratio_of_day(report: &mut Report, name: &str, prepared: &Prepared, threads: usize) -> Result<(), String> {
    let mut analysis = prepared.analysis();
    analysis.functionals = &prepared.functionals()[..1];
    let (mut of_forward, mut of_adjoint) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..REPETITIONS {
        let begun = Instant::now();
        let forward = analysis.forward(&prepared.x).map_err(|error| error.to_string())?;
        of_forward = of_forward.min(begun.elapsed().as_secs_f64());
        let begun = Instant::now();
        analysis.adjoint(&prepared.x, &forward).map_err(|error| error.to_string())?;
        of_adjoint = of_adjoint.min(begun.elapsed().as_secs_f64());
    }
    let figure = |what: &str| format!("{name}/{what}, {threads} thread{}", if threads > 1 { "s" } else { "" });
    report.inform(figure("time of day of the adjoint [s]"), of_adjoint);
    report.inform(figure("the same by that of the simulation"), of_adjoint / of_forward);
    Ok(())
}
