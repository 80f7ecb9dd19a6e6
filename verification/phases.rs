//! What the parts of steps of a falling shell take, on the threads and ranks that there are.

use super::Clock;
use super::memory::{forget_peak, memory_of_now, peak_memory};
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, RunError, SolveRecord, StepRecord, table_by_name};
use costate::internals::{Factorization, Jacobian, Residual, StageSystem, TransposedSolution, of_all_ranks, traffic};
use costate::linalg::Backend;
use costate::scenes::{AnyScene, Prepared, Settings};
use std::time::Instant;

/// Integrator of Boopathy & Kennedy: two stages, diagonally implicit.
const METHOD: &str = "dirk2";
/// How often phases are repeated, of which the fastest counts, and how many steps are measured behind the first; of none the first one is.
#[derive(Clone, Copy)]
pub struct Effort {
    pub repeats: usize,
    pub steps: usize,
    /// Whether MUMPS solves the same system, of a program that has it.
    pub with_mumps: bool,
}

/// That of a record.
pub const USUAL: Effort = Effort { repeats: 7, steps: 3, with_mumps: false };

/// What some work takes \[s\]: by the clock, or on the processor where there is one thread of one process; and, of ranks with one thread each, along
/// the longest path of what they do and send.
pub type Times = [f64; 2];
/// Parts of the work on one system, and their times.
type Parts = [(&'static str, Times); 5];
/// Factorization, solution, and transposed solution.
type OfASolver = [(&'static str, Times); 3];

/// What MUMPS takes, with the order of elimination that it takes.
pub struct OfMumps {
    pub ordering: &'static str,
    pub parts: OfASolver,
}

/// Times \[s\], counts of a step, and what the first step and its gradient give.
pub struct Phases {
    pub system: OneSystem,
    pub step: Times,
    /// For the first functional, and for two.
    pub adjoint: [Times; 2],
    pub iterations: f64,
    pub factorizations: f64,
    /// At its peak, of the simulation of one step and its gradients, beside what was there before \[bytes\]; where the system tells.
    pub memory: Option<f64>,
    /// Value of the first functional, and then its gradient.
    pub results: Vec<f64>,
}

/// A scene with so many steps and its first functionals.
pub fn prepare(scene: &dyn AnyScene, steps: usize, functionals: usize) -> Result<Prepared<'_>, RunError> {
    let table = table_by_name(METHOD).ok_or_else(|| RunError::Input(format!("no method {METHOD}")))?;
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let settings = Settings::new(1e-3 * steps as f64, steps);
    let mut prepared = Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings)?;
    prepared.mechanism.functionals.truncate(functionals);
    Ok(prepared)
}

/// What some work gives, and what it takes. Ranks begin it together, and it lasts, by the clock and along the longest path, until all of them have ended it.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Times) {
    let ranks = of_all_ranks(&[]).len();
    let (begun, clock, before) = (Instant::now(), Clock::start(), traffic().path);
    let done = work();
    let is_alone = ranks == 1 && rayon::current_num_threads() == 1;
    of_all_ranks(&[]);
    let seconds = if is_alone { clock.seconds() } else { begun.elapsed().as_secs_f64() };
    (done, [seconds, if is_alone { seconds } else { traffic().path - before }])
}

/// The least of each that some repetitions take.
fn fastest(repeats: usize, mut work: impl FnMut()) -> Times {
    (0..repeats).map(|_| timed(&mut work).1).fold([f64::INFINITY; 2], |least, own| [0, 1].map(|k| least[k].min(own[k])))
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

impl Phases {
    /// Of a scene with two functionals.
    pub fn measure(scene: &dyn AnyScene, effort: Effort) -> Result<Self, RunError> {
        let system = OneSystem::measure(&prepare(scene, 1, 1)?, effort)?;
        let before = memory_of_now();
        forget_peak();
        let first = Run::of(&prepare(scene, 1, 2)?)?;
        let memory = before.zip(peak_memory()).map(|(before, peak)| peak - before);
        let mut numbers = first.numbers;
        if effort.steps > 0 {
            let whole = Run::of(&prepare(scene, 1 + effort.steps, 2)?)?;
            let of_step = |k: usize, time: usize| (whole.numbers[k][time] - first.numbers[k][time]) / effort.steps as f64;
            numbers = std::array::from_fn(|k| [0, 1].map(|time| of_step(k, time)));
        }
        let ([step, one, two, [iterations, factorizations]], results) = (numbers, first.results);
        let adjoint = [one, two];
        Ok(Phases { system, step, adjoint, iterations, factorizations, memory, results })
    }
}

/// A system of the last stage.
pub struct OneSystem {
    pub unknowns: f64,
    /// Residual, matrix, factorization, solution, and transposed solution.
    pub parts: Parts,
    /// Elements that this rank evaluates for its part of a matrix, where ranks share it.
    pub own_elements: Option<usize>,
    pub of_mumps: Option<OfMumps>,
}

impl OneSystem {
    fn measure(one: &Prepared, Effort { repeats, with_mumps, .. }: Effort) -> Result<Self, RunError> {
        let solve = last_stage(one)?;
        let problem = one.problem();
        let system = &*one.method.system(problem.model, &[]);
        let at = StageSystem { equations: &solve.equations, base: &solve.base, p: &problem.p, t: solve.t };
        let (mut residual, mut unknowns) = (Residual::shared(), solve.unknowns.clone());
        residual.start(system, at);
        let of_residual = fastest(repeats, || residual.evaluate(system, at, &mut unknowns));
        let by = |backend: Backend| -> Result<_, RunError> {
            let singular = |_| RunError::Input("a singular matrix".into());
            let mut factorization = Factorization::new(&system.pattern, backend).map_err(singular)?;
            let mut jacobian = Jacobian::default();
            jacobian.divide(factorization.own_unknowns());
            jacobian.divide_by_threads(factorization.thread_owners());
            let of_matrix =
                fastest(repeats, || jacobian.assemble(system, &solve.equations, &residual, &unknowns, &problem.p, solve.t));
            let mut factored = Ok(());
            let of_factor = fastest(repeats, || factored = jacobian.factor_in(&mut factorization));
            factored.map_err(singular)?;
            let mut rhs = vec![0.0; system.size()];
            jacobian.reduce(system, &residual, None, &mut rhs);
            let of_solution = fastest(repeats, || factorization.solve(&mut rhs.clone()));
            let mut refined = Ok(TransposedSolution::NeedsFactors);
            let of_transposed = fastest(repeats, || refined = factorization.solve_transposed(&mut rhs.clone()));
            if refined.map_err(singular)? != TransposedSolution::Found {
                return Err(RunError::Input("its own factors do not serve a matrix".into()));
            }
            let of_solver: OfASolver =
                [("factorization", of_factor), ("solution", of_solution), ("transposed solution", of_transposed)];
            Ok((of_matrix, of_solver, jacobian.own_elements(), factorization.plan().ordering))
        };
        let (of_matrix, [factor, solution, transposed], own_elements, _) = by(Backend::Multifrontal)?;
        let mumps = Backend::ALL.into_iter().find(|backend| with_mumps && backend.name() == "mumps");
        let of_mumps = match mumps.map(by).transpose()? {
            Some((_, parts, _, Some(ordering))) => Some(OfMumps { ordering, parts }),
            _ => None,
        };
        let parts = [("residual", of_residual), ("matrix", of_matrix), factor, solution, transposed];
        Ok(OneSystem { unknowns: system.size() as f64, parts, own_elements, of_mumps })
    }
}

/// A simulation with its gradients.
struct Run {
    /// Times of the simulation, of the gradient of the first functional, and of two; Newton iterations and factorizations.
    numbers: [Times; 4],
    results: Vec<f64>,
}

impl Run {
    fn of(prepared: &Prepared) -> Result<Self, RunError> {
        let analysis = prepared.analysis();
        let (forward, of_forward) = timed(|| analysis.forward(&prepared.x));
        let forward = forward?;
        let (one, of_one) = timed(|| analysis.adjoint_of(&prepared.x, &forward, &[true, false]));
        let (two, of_two) = timed(|| analysis.adjoint(&prepared.x, &forward));
        two?;
        let results = [&forward.values[..1], &one?.rows[0]].concat();
        let counters = &forward.counters;
        let counts = [counters.iterations, counters.factorizations].map(|count| count as f64);
        let numbers = [of_forward, of_one, of_two, counts];
        Ok(Run { numbers, results })
    }
}
