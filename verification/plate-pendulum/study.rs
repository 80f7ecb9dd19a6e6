//! Time and memory of a plate of shells, phase by phase, on one thread and two.

use crate::verification::memory::{forget_peak, memory_of_now, peak_memory};
use crate::verification::{Clock, Form, Report, Study, median, on_one_thread, on_threads};
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, RunError, SolveRecord, StepRecord, table_by_name};
use costate::internals::{Factorization, Jacobian, Residual, StageSystem, Systems, TransposedSolution};
use costate::linalg::Backend;
use costate::scenes::built_in::{BoxTubePendulum, PlatePendulum, Thicknesses};
use costate::scenes::{AnyScene, Prepared, Settings};
use costate::sensitivity::largest_difference;
use std::time::Instant;

/// The study.
pub struct PlatePendulumStudy;

/// Meshes of the source, and one of 192,000 unknowns as it counts them: eight a node.
const MESHES: [[usize; 2]; 4] = [[25, 5], [55, 11], [100, 20], [150, 39]];
/// Elements along the box tube of the source, and across each of its four walls.
const TUBE: [usize; 2] = [100, 5];
/// A mesh of 10,000 nodes, each with a thickness of its own.
const OF_NODES: [usize; 2] = [112, 22];
/// Largest difference of adjoint and complex step.
const EXACT: f64 = 1e-11;
/// Gradients of which the fastest counts.
const REPEATS: usize = 7;
/// Pairs of gradients by one thickness and by many.
const PAIRS: usize = 10;
/// Integrator of the source: two stages, diagonally implicit.
const METHOD: &str = "dirk2";
/// Steps of a run.
const STEPS: usize = 3;

impl Study for PlatePendulumStudy {
    fn name(&self) -> &'static str {
        "plate-pendulum"
    }
    fn summary(&self) -> &'static str {
        "falling plate and box tube of up to 5,850 shell elements: time of each phase, of steps and gradients, and memory"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let words = |error: RunError| error.to_string();
        gradient(report, &PlatePendulum::default()).map_err(words)?;
        gradient(report, &BoxTubePendulum::default()).map_err(words)?;
        if report.is_short() {
            return Ok(());
        }
        let of_mesh = |elements: [usize; 2]| {
            let name = format!("{} x {}", elements[0], elements[1]);
            let plate = PlatePendulum { elements, thicknesses: Thicknesses::Strips(1), milliseconds: STEPS };
            Subject { name, elements: elements[0] * elements[1], scene: Box::new(plate) }
        };
        let tube = Subject {
            name: format!("box tube {} x 4 x {}", TUBE[0], TUBE[1]),
            elements: 4 * TUBE[0] * TUBE[1],
            scene: Box::new(BoxTubePendulum { elements: TUBE, milliseconds: STEPS }),
        };
        let subjects: Vec<Subject> = MESHES.into_iter().map(of_mesh).chain([tube]).collect();
        for (index, subject) in subjects.iter().enumerate() {
            eprintln!("[{}/{}] {}", index + 1, subjects.len() + 1, subject.name);
            for threads in [1, 2] {
                on_threads(threads, || phases(report, subject, threads).map_err(words))?;
            }
        }
        eprintln!("[{0}/{0}] thicknesses", subjects.len() + 1);
        on_one_thread(|| thicknesses(report).map_err(words))
    }
}

/// A scene whose phases are measured.
struct Subject {
    name: String,
    /// Number of shell elements.
    elements: usize,
    scene: Box<dyn AnyScene>,
}

fn prepare(scene: &dyn AnyScene, steps: usize) -> Result<Prepared<'_>, RunError> {
    let table = table_by_name(METHOD).ok_or_else(|| RunError::Input(format!("no method {METHOD}")))?;
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let settings = Settings::new(1e-3 * steps as f64, steps);
    let mut prepared = Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings)?;
    prepared.mechanism.functionals.truncate(1);
    Ok(prepared)
}

/// What some work gives, and the seconds that it takes: of the processor where there is one thread.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let (begun, clock) = (Instant::now(), Clock::start());
    let done = work();
    (done, if rayon::current_num_threads() == 1 { clock.seconds() } else { begun.elapsed().as_secs_f64() })
}

/// Seconds of the fastest of some repetitions.
fn fastest(mut work: impl FnMut()) -> f64 {
    (0..REPEATS).map(|_| timed(&mut work).1).fold(f64::INFINITY, f64::min)
}

/// The solved equations of a run's last stage.
fn last_stage(prepared: &Prepared) -> Result<SolveRecord<f64>, RunError> {
    let mut last = None;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        last = step.stages.last().map(|stage| stage.solve.clone());
        true
    });
    prepared.analysis().observed(&prepared.x, &mut watch)?;
    last.ok_or_else(|| RunError::Input("no stage was solved".into()))
}

/// Gradients of a coarse mesh against complex step.
fn gradient(report: &mut Report, scene: &dyn AnyScene) -> Result<(), RunError> {
    let prepared = Prepared::new(scene)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x)?;
    let (adjoint, stepped) = (analysis.adjoint(&prepared.x, &forward)?, analysis.complex_step(&prepared.x, &forward)?);
    for ((functional, own), other) in prepared.functionals().iter().zip(&adjoint.rows).zip(&stepped.rows) {
        report.at_most(
            format!("gradient/{}/{}, adjoint - complex step", scene.name(), functional.name),
            largest_difference(own, other),
            EXACT,
        );
    }
    Ok(())
}

/// A gradient by one thickness, and by that of each of 10,000 nodes.
fn thicknesses(report: &mut Report) -> Result<(), RunError> {
    let scenes = [Thicknesses::Strips(1), Thicknesses::Nodes].map(|thicknesses| PlatePendulum {
        elements: OF_NODES,
        thicknesses,
        milliseconds: 1,
    });
    let mut all = Vec::new();
    for scene in &scenes {
        let prepared = prepare(scene, 1)?;
        let forward = prepared.analysis().forward(&prepared.x)?;
        all.push((prepared, forward, Vec::new()));
    }
    // in turn, so that what disturbs one disturbs both, and each as often first
    for round in 0..PAIRS {
        for place in 0..all.len() {
            let (prepared, forward, times) = &mut all[(place + round) % 2];
            let (gradient, seconds) = timed(|| prepared.analysis().adjoint(&prepared.x, forward));
            gradient?;
            times.push(seconds);
        }
    }
    for (prepared, _, times) in &all {
        report.inform(format!("thicknesses/gradient by {} [s]", prepared.x.len()), median(times.clone()));
    }
    let ratios = all[1].2.iter().zip(&all[0].2).map(|(many, one)| many / one).collect();
    report.compare("thicknesses/time with many by that with one, median", median(ratios), 1.0, 0.05);
    Ok(())
}

/// Phases of one step, whole steps, and their gradient.
fn phases(report: &mut Report, subject: &Subject, threads: usize) -> Result<(), RunError> {
    let name = |what: &str| format!("{}, {threads} thread{}/{what}", subject.name, if threads > 1 { "s" } else { "" });
    let [one, all] = [1, 1 + STEPS].map(|steps| prepare(&*subject.scene, steps));
    let (one, all) = (one?, all?);
    let solve = last_stage(&one)?;
    let problem = one.problem();
    let systems = Systems::new(problem.model, &one.method, &[]);
    let system = &systems.stage;
    report.inform(name("unknowns"), system.size() as f64);

    let at = StageSystem { equations: &solve.equations, base: &solve.base, p: &problem.p, t: solve.t };
    let (mut residual, mut unknowns) = (Residual::default(), solve.unknowns.clone());
    residual.start(system, at);
    let of_residual = fastest(|| residual.evaluate(system, at, &mut unknowns));
    let mut jacobian = Jacobian::default();
    let of_matrix = fastest(|| jacobian.assemble(system, &solve.equations, &residual, &unknowns, &problem.p, solve.t));
    let singular = |_| RunError::Input("a singular matrix".into());
    let mut factorization = Factorization::new(&system.pattern, Backend::Multifrontal).map_err(singular)?;
    let mut factored = Ok(());
    let of_factor = fastest(|| factored = factorization.factor(&jacobian.values));
    factored.map_err(singular)?;
    let mut rhs = vec![0.0; system.size()];
    jacobian.reduce(system, &residual, None, &mut rhs);
    let of_solution = fastest(|| factorization.solve(&mut rhs.clone()));
    let mut refined = Ok(TransposedSolution::NeedsFactors);
    let of_transposed = fastest(|| refined = factorization.solve_transposed(&mut rhs.clone()));
    if refined.map_err(singular)? != TransposedSolution::Found {
        return Err(RunError::Input("its own factors do not serve a matrix".into()));
    }
    for (what, seconds) in [
        ("residual", of_residual),
        ("matrix", of_matrix),
        ("factorization", of_factor),
        ("solution", of_solution),
        ("transposed solution", of_transposed),
    ] {
        report.inform(name(&format!("{what} [s]")), seconds);
    }
    report.inform(name("residual and matrix of an element [us]"), 1e6 * (of_residual + of_matrix) / subject.elements as f64);
    drop((residual, jacobian, factorization));

    // what is set up once is in both
    let both = |prepared: &Prepared| -> Result<_, RunError> {
        let analysis = prepared.analysis();
        let (forward, of_forward) = timed(|| analysis.forward(&prepared.x));
        let forward = forward?;
        let (adjoint, of_adjoint) = timed(|| analysis.adjoint(&prepared.x, &forward));
        adjoint?;
        Ok(([of_forward, of_adjoint], forward.counters))
    };
    let before = memory_of_now();
    forget_peak();
    let (first, counted) = both(&one)?;
    let peak = peak_memory();
    let (whole, counters) = both(&all)?;
    let a_step = |number: f64| number / STEPS as f64;
    report.inform(name("one forward step [s]"), a_step(whole[0] - first[0]));
    report.inform(name("its adjoint and gradient [s]"), a_step(whole[1] - first[1]));
    for (what, own, first) in [
        ("Newton iterations", counters.iterations, counted.iterations),
        ("factorizations", counters.factorizations, counted.factorizations),
    ] {
        report.inform(name(&format!("{what} of a step")), a_step((own - first) as f64));
    }
    if let (Some(before), Some(peak)) = (before, peak) {
        report.inform(name("memory at its peak, simulation of one step and gradient [MB]"), (peak - before) / 1e6);
    }
    Ok(())
}
