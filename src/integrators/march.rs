use super::newton::{Counters, Newton, NewtonTolerance};
use super::record::{Guide, Recorder, SolveRecord, StageRecord, StartRecord, StepRecord};
use super::{Combination, ConstraintLevel, InitialState, RunError, StartPlan, Table, TimeGrid};
use crate::assembly::{Equations, Level, Model, Residual, Shift, System, SystemOptions, Unknowns, VectorsAvq};
use crate::elements::RunScalar;
use crate::linalg::Backend;

/// What is simulated: topology, parameters, start.
#[derive(Clone, Debug)]
pub struct Problem<'m, S> {
    /// Topology.
    pub model: &'m Model,
    /// Parameters.
    pub p: Vec<S>,
    /// Start.
    pub start: InitialState<S>,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "Model of {} nodes, {} elements, {} constraints",
            self.nodes.len(),
            self.elements.len(),
            self.constraints.len()
        )
    }
}

/// How it is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// The integrator.
    pub table: Table,
    /// The constraint level.
    pub level: ConstraintLevel,
    /// When Newton's method stops.
    pub tolerance: NewtonTolerance,
    /// Which solver factors.
    pub backend: Backend,
    /// Keep node-local constraints in the matrix: for tests.
    pub unreduced: bool,
}

impl Method {
    /// A table and a level, with round-off tolerance.
    pub fn new(table: Table, level: ConstraintLevel) -> Self {
        Method { table, level, tolerance: NewtonTolerance::default(), backend: Backend::default(), unreduced: false }
    }

    /// The equations of the steps' systems: the same unknowns for all, or with rate corrections for the stages.
    pub(crate) fn system_options(&self, dropped: &[usize], stabilized: bool) -> SystemOptions {
        SystemOptions { dropped: dropped.to_vec(), unreduced: self.unreduced, stabilized }
    }

    /// The equations of stage `index`.
    pub(crate) fn stage_equations(&self, index: usize, h: f64, constrained: bool) -> Equations {
        let stage = &self.table.stages[index];
        let shift = Shift::new(stage.a.stages[index], h * stage.v.stages[index], h * h * stage.q.stages[index]);
        let level = match self.level {
            ConstraintLevel::Position if constrained => Level::Position,
            ConstraintLevel::Velocity if constrained => Level::Stabilized,
            _ => Level::Acceleration,
        };
        Equations::stage(shift, level)
    }
}

/// The end of a run.
#[derive(Clone, Debug)]
pub struct Run<S> {
    /// Coordinates at the end.
    pub q: Vec<S>,
    /// Velocities at the end.
    pub v: Vec<S>,
    /// Work done.
    pub counters: Counters,
}

/// sum of carried vectors and stage unknowns with the powers of h that belong to a vector of `order` time derivatives.
pub(crate) fn combine<S: RunScalar>(
    table: &Table,
    order: i32,
    combination: &Combination,
    h: f64,
    carried: &[Vec<S>],
    stages: &[&[S]],
) -> Vec<S> {
    let mut sum = vec![S::zero(); carried[0].len()];
    let mut add = |factor: f64, values: &[S]| {
        if factor == 1.0 {
            sum.iter_mut().zip(values).for_each(|(sum, &value)| *sum += value);
        } else if factor != 0.0 {
            sum.iter_mut().zip(values).for_each(|(sum, &value)| *sum += value * factor);
        }
    };
    for ((values, kind), coefficient) in carried.iter().zip(&table.carried).zip(&combination.carried) {
        add(coefficient * h.powi(kind.order() - order), values);
    }
    for (values, coefficient) in stages.iter().zip(&combination.stages) {
        add(coefficient * h.powi(2 - order), values);
    }
    sum
}

/// Runs a problem over a grid and hands every step to the recorder.
///
/// # Errors
/// [`RunError`] with step and time; steps before it have reached the recorder.
pub fn march<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    grid: &TimeGrid,
    plan: &StartPlan,
    recorder: &mut dyn Recorder<S>,
) -> Result<Run<S>, RunError> {
    march_along(problem, method, grid, plan, None, recorder)
}

/// As [`march`], with the values of a finished real run of the same problem where a guide is given: only derivative parts are
/// solved for, so that they belong to exactly the states of that run.
///
/// # Errors
/// As for [`march`]; also a guide that does not solve the problem.
pub fn march_along<S: RunScalar>(
    problem: &Problem<S>,
    method: &Method,
    grid: &TimeGrid,
    plan: &StartPlan,
    guide: Option<Guide>,
    recorder: &mut dyn Recorder<S>,
) -> Result<Run<S>, RunError> {
    let plain = System::new(problem.model, method.system_options(&plan.dropped, false));
    let constrained = plain.is_constrained();
    let stabilized = method.level == ConstraintLevel::Velocity && constrained;
    let with_rates = stabilized.then(|| System::new(problem.model, method.system_options(&plan.dropped, true)));
    let newton = |system| {
        Newton::new(system, method.tolerance, method.backend).map_err(|singular| RunError::Singular {
            place: "start".into(),
            unknown: format!("unknown {}", singular.unknown),
            hint: "the pattern of the equations is singular: a coordinate has no equation".into(),
        })
    };
    let mut marcher = Marcher {
        problem,
        method,
        constrained,
        acceleration: newton(&plain)?,
        stage: newton(with_rates.as_ref().unwrap_or(&plain))?,
        position: newton(&plain)?,
        velocity: newton(&plain)?,
        guess: Unknowns::default(),
        increments: vec![None; method.table.stages.len()],
    };
    marcher.run(grid, plan, guide, recorder)
}

struct Marcher<'m, S> {
    problem: &'m Problem<'m, S>,
    method: &'m Method,
    constrained: bool,
    acceleration: Newton<'m, S>,
    stage: Newton<'m, S>,
    position: Newton<'m, S>,
    velocity: Newton<'m, S>,
    /// Solution of the last stage.
    guess: Unknowns<S>,
    /// How the solution changed from stage to stage in the last step: added to the last solution it is the first guess.
    increments: Vec<Option<Unknowns<S>>>,
}

/// Where the search for a solution starts.
enum First<'g, S> {
    /// From zero.
    Zero,
    /// From a guess.
    Guess(&'g Unknowns<S>),
    /// At the solution of a real run.
    Solved(&'g Unknowns<f64>),
}

impl<'g, S> First<'g, S> {
    fn guided(record: Option<&'g SolveRecord<f64>>) -> Self {
        record.map_or(First::Zero, |record| First::Solved(&record.unknowns))
    }
}

/// Solves one system and keeps what the adjoint needs.
fn solve<S: RunScalar>(
    newton: &mut Newton<S>,
    equations: Equations,
    base: VectorsAvq<S>,
    first: First<S>,
    p: &[S],
    t: f64,
    place: &dyn Fn() -> String,
) -> Result<SolveRecord<S>, RunError> {
    let mut unknowns = match &first {
        First::Zero => Residual::unknowns(newton.system),
        First::Guess(guess) => (*guess).clone(),
        First::Solved(real) => lifted(real),
    };
    let solved = match first {
        First::Solved(_) => newton.solve_guided(&equations, &base, &mut unknowns, p, t),
        _ => newton.solve(&equations, &base, &mut unknowns, p, t),
    };
    solved.map_err(|failure| newton.describe(&failure, &place()))?;
    Ok(SolveRecord { t, equations, base, unknowns })
}

/// Real unknowns without derivative parts.
fn lifted<S: RunScalar>(real: &Unknowns<f64>) -> Unknowns<S> {
    let lift = |values: &[f64]| values.iter().map(|&value| S::from(value)).collect();
    Unknowns {
        x: lift(&real.x),
        y: lift(&real.y),
        mu: lift(&real.mu),
        eta: lift(&real.eta),
        local_mu: lift(&real.local_mu),
        local_eta: lift(&real.local_eta),
    }
}

impl<S: RunScalar> Marcher<'_, S> {
    fn run(
        &mut self,
        grid: &TimeGrid,
        plan: &StartPlan,
        guide: Option<Guide>,
        recorder: &mut dyn Recorder<S>,
    ) -> Result<Run<S>, RunError> {
        let start_of = |pick: fn(&StartRecord<f64>) -> Option<&SolveRecord<f64>>| {
            First::guided(guide.and_then(|guide| pick(guide.start)))
        };
        let model = self.problem.model;
        let table = &self.method.table;
        let InitialState { mut q, mut v } = self.problem.start.clone();
        let mut start_projections = [None, None];
        if plan.project && self.constrained {
            let place = || "projection of the start (t = 0 s)".to_string();
            let zeros = || vec![S::zero(); model.dofs];
            let p = &self.problem.p;
            let base = VectorsAvq { a: zeros(), v: zeros(), q: q.clone() };
            let first = start_of(|start| start.position_projection.as_ref());
            let equations = Equations::initial_position_projection();
            let solved = solve(&mut self.position, equations, base, first, p, 0.0, &place)?;
            add_scaled(&mut q, &solved.unknowns.x, 1.0);
            let base = VectorsAvq { a: zeros(), v: v.clone(), q: q.clone() };
            let first = start_of(|start| start.velocity_projection.as_ref());
            let equations = Equations::initial_velocity_projection();
            let second = solve(&mut self.velocity, equations, base, first, p, 0.0, &place)?;
            add_scaled(&mut v, &second.unknowns.x, 1.0);
            start_projections = [Some(solved), Some(second)];
        }
        let t0 = grid.times[0];
        let guided = start_of(|start| Some(&start.acceleration));
        let first = self.solve_acceleration(&q, &v, t0, 0, guided)?;
        let mut a = first.unknowns.x.clone();
        self.guess = Residual::unknowns(self.stage.system);
        self.set_guess(&first);
        let [position_projection, velocity_projection] = start_projections;
        recorder.start(StartRecord { position_projection, velocity_projection, acceleration: first });

        let mut rate = vec![S::zero(); if self.stage.system.options.stabilized { model.dofs } else { 0 }];
        for index in 0..grid.steps() {
            let (t, end) = grid.span(index);
            let guided = guide.and_then(|guide| guide.steps.get(index));
            let h = end - t;
            let restart = if grid.kinks.contains(&index) {
                let first = First::guided(guided.and_then(|step| step.restart.as_ref()));
                let solved = self.solve_acceleration(&q, &v, t, index, first)?;
                a.clone_from(&solved.unknowns.x);
                self.set_guess(&solved);
                Some(solved)
            } else {
                None
            };
            let mut carried = vec![q, v];
            if table.carried.len() > 2 {
                carried.push(a);
            }
            let stages = self.solve_stages(&carried, &rate, (t, end), index, guided)?;
            let accelerations: Vec<&[S]> = stages.iter().map(|stage| stage.solve.unknowns.x.as_slice()).collect();
            let updated: Vec<Vec<S>> = table
                .update
                .iter()
                .zip(&table.carried)
                .map(|(update, kind)| combine(table, kind.order(), update, h, &carried, &accelerations))
                .collect();
            let mut updated = updated.into_iter();
            q = updated.next().unwrap_or_default();
            v = updated.next().unwrap_or_default();
            a = accelerations[accelerations.len() - 1].to_vec();
            for (stage, weight) in stages.iter().zip(&table.rates[stages.len()]) {
                add_scaled(&mut q, &stage.rate, h * weight);
            }
            if let Some(last) = stages.last().filter(|stage| !stage.rate.is_empty()) {
                rate.clone_from(&last.rate);
            }
            let (position_projection, velocity_projection) = self.project(&mut q, &mut v, &a, (end, h), index, guided)?;
            let (q_end, v_end) = (q.clone(), v.clone());
            let step = StepRecord { t, h, restart, stages, position_projection, velocity_projection, q: q_end, v: v_end };
            if !recorder.step(step) {
                return Err(RunError::Interrupted { steps: index + 1 });
            }
        }
        let mut counters = Counters::default();
        for newton in [&self.acceleration, &self.stage, &self.position, &self.velocity] {
            counters += newton.counters;
        }
        Ok(Run { q, v, counters })
    }

    /// The acceleration for given (q, v), at acceleration level whatever the level of the run.
    fn solve_acceleration(
        &mut self,
        q: &[S],
        v: &[S],
        t: f64,
        step: usize,
        first: First<S>,
    ) -> Result<SolveRecord<S>, RunError> {
        let base = VectorsAvq { a: vec![S::zero(); q.len()], v: v.to_vec(), q: q.to_vec() };
        let place = || format!("acceleration before step {} (t = {t} s)", step + 1);
        solve(&mut self.acceleration, Equations::acceleration(), base, first, &self.problem.p, t, &place)
    }

    fn set_guess(&mut self, solved: &SolveRecord<S>) {
        self.guess.x.clone_from(&solved.unknowns.x);
        self.guess.mu.clone_from(&solved.unknowns.mu);
        self.increments.fill(None);
        self.guess.y.fill(S::zero());
        self.guess.eta.fill(S::zero());
    }

    fn solve_stages(
        &mut self,
        carried: &[Vec<S>],
        rate: &[S],
        (t, end): (f64, f64),
        step: usize,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<Vec<StageRecord<S>>, RunError> {
        let h = end - t;
        let table = &self.method.table;
        let mut stages: Vec<StageRecord<S>> = Vec::with_capacity(table.stages.len());
        for (index, stage) in table.stages.iter().enumerate() {
            let solved: Vec<&[S]> = stages.iter().map(|stage| stage.solve.unknowns.x.as_slice()).collect();
            let base_of = |order, combination| combine(table, order, combination, h, carried, &solved);
            let mut base = VectorsAvq { a: base_of(2, &stage.a), v: base_of(1, &stage.v), q: base_of(0, &stage.q) };
            for (earlier, weight) in stages.iter().zip(&table.rates[index]) {
                add_scaled(&mut base.q, &earlier.rate, h * weight);
            }
            let equations = self.method.stage_equations(index, h, self.constrained);
            // a stage at the end of the step lies before the kink that may be there, whatever t + h rounds to
            let time = if stage.c <= 1.0 + 1e-12 { (t + stage.c * h).min(end) } else { t + stage.c * h };
            let record = if let Some(place) = stage.known {
                let unknowns = Unknowns { x: carried[place].clone(), mu: self.guess.mu.clone(), ..Unknowns::default() };
                let solve = SolveRecord { t: time, equations, base, unknowns };
                StageRecord { solve, known: Some(place), rate: rate.to_vec() }
            } else {
                let place = || format!("step {}, stage {} (t = {time} s)", step + 1, index + 1);
                let mut guess = self.guess.clone();
                if let Some(increment) = &self.increments[index] {
                    guess.add_scaled(increment, 1.0);
                }
                let first = match guided {
                    Some(step) => First::Solved(&step.stages[index].solve.unknowns),
                    None => First::Guess(&guess),
                };
                let solve = solve(&mut self.stage, equations, base, first, &self.problem.p, time, &place)?;
                let mut increment = solve.unknowns.clone();
                increment.add_scaled(&self.guess, -1.0);
                self.increments[index] = Some(increment);
                self.guess.clone_from(&solve.unknowns);
                let beta = equations.residual.beta;
                let rate = solve.unknowns.y.iter().map(|&y| y * beta).collect();
                StageRecord { solve, known: None, rate }
            };
            stages.push(record);
        }
        Ok(stages)
    }

    /// At acceleration level: (q, v) back onto g = 0 and dg/dt = 0, each as one more system.
    #[allow(clippy::type_complexity)]
    fn project(
        &mut self,
        q: &mut [S],
        v: &mut [S],
        a: &[S],
        (t, h): (f64, f64),
        step: usize,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<(Option<SolveRecord<S>>, Option<SolveRecord<S>>), RunError> {
        if !self.constrained || self.method.level != ConstraintLevel::Acceleration {
            return Ok((None, None));
        }
        let scale = self.method.table.projection_step(h);
        let p = &self.problem.p;
        let place = || format!("step {}, projection (t = {t} s)", step + 1);
        let base = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let first = First::guided(guided.and_then(|step| step.position_projection.as_ref()));
        let position = solve(&mut self.position, Equations::position_projection(scale), base, first, p, t, &place)?;
        add_scaled(q, &position.unknowns.x, scale * scale);
        let base = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let first = First::guided(guided.and_then(|step| step.velocity_projection.as_ref()));
        let velocity = solve(&mut self.velocity, Equations::velocity_projection(scale), base, first, p, t, &place)?;
        add_scaled(v, &velocity.unknowns.x, scale);
        Ok((Some(position), Some(velocity)))
    }
}

/// target += factor values.
pub(crate) fn add_scaled<S: RunScalar>(target: &mut [S], values: &[S], factor: f64) {
    for (target, &value) in target.iter_mut().zip(values) {
        *target += value * factor;
    }
}
