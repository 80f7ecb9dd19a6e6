//! One step of any table at any constraint level: stages, update, projections.

use super::checkpoint::{Between, Checkpoint};
use super::march::{Method, Problem, Run, add_scaled, combine};
use super::newton::{Counters, Newton};
use super::record::{SolveRecord, StageRecord, StartRecord, StepRecord};
use super::{ConstraintLevel, InitialState, RunError, Scheme, StartPlan, Systems, Table, TimeGrid};
use crate::assembly::{Equations, Residual, Unknowns, VectorsAvq};
use crate::elements::RunScalar;

/// A run that is taken step by step, and can go on from a [`Checkpoint`].
pub struct Marcher<'m, S> {
    pub(super) problem: &'m Problem<'m, S>,
    pub(super) method: &'m Method,
    constrained: bool,
    acceleration: Newton<'m, S>,
    stage: Newton<'m, S>,
    position: Newton<'m, S>,
    velocity: Newton<'m, S>,
    pub(super) between: Between<S>,
}

/// Where the search for a solution starts.
pub(super) enum First<'g, S> {
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

impl<'m, S: RunScalar> Marcher<'m, S> {
    /// Workspace for a run.
    ///
    /// # Errors
    /// [`RunError::Singular`] if no numbers could make the equations regular.
    pub fn new(problem: &'m Problem<'m, S>, method: &'m Method, systems: &'m Systems<'m>) -> Result<Self, RunError> {
        let newton = |system| {
            Newton::new(system, method.tolerance, method.backend).map_err(|singular| RunError::Singular {
                place: "start".into(),
                unknown: format!("unknown {}", singular.unknown),
                hint: "the pattern of the equations is singular: a coordinate has no equation".into(),
            })
        };
        Ok(Marcher {
            problem,
            method,
            constrained: systems.plain.is_constrained(),
            acceleration: newton(&systems.plain)?,
            stage: newton(systems.stage())?,
            position: newton(&systems.plain)?,
            velocity: newton(&systems.plain)?,
            between: Between::default(),
        })
    }

    /// Work done.
    pub fn counters(&self) -> Counters {
        let mut counters = Counters::default();
        for newton in [&self.acceleration, &self.stage, &self.position, &self.velocity] {
            counters += newton.counters;
        }
        counters
    }

    /// Number of the next step.
    pub fn next_step(&self) -> usize {
        self.between.step
    }

    /// All that later steps depend on.
    pub fn checkpoint(&self) -> Checkpoint<S> {
        let newtons = [&self.acceleration, &self.stage, &self.position, &self.velocity];
        Checkpoint { between: self.between.clone(), kept: newtons.map(Newton::kept) }
    }

    /// Goes on from a checkpoint: the steps that follow are those of the run that left it, bit by bit.
    ///
    /// # Errors
    /// [`RunError::Singular`] if a matrix that was factored then is singular now: the checkpoint belongs to another problem.
    pub fn resume(&mut self, checkpoint: &Checkpoint<S>) -> Result<(), RunError> {
        self.between.clone_from(&checkpoint.between);
        let newtons = [&mut self.acceleration, &mut self.stage, &mut self.position, &mut self.velocity];
        for (newton, kept) in newtons.into_iter().zip(&checkpoint.kept) {
            newton.resume(kept, &self.problem.p).map_err(|singular| RunError::Singular {
                place: format!("checkpoint before step {}", checkpoint.between.step + 1),
                unknown: newton.system.unknown_name(singular.unknown, &newton.jacobian),
                hint: "the checkpoint belongs to another problem".into(),
            })?;
        }
        Ok(())
    }

    /// Projects the start if the plan says so and solves for the first acceleration.
    ///
    /// # Errors
    /// [`RunError`] with what could not be solved.
    pub fn start(&mut self, t: f64, plan: &StartPlan, guide: Option<&StartRecord<f64>>) -> Result<StartRecord<S>, RunError> {
        let start_of = |pick: fn(&StartRecord<f64>) -> Option<&SolveRecord<f64>>| First::guided(guide.and_then(pick));
        let model = self.problem.model;
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
        let guided = start_of(|start| Some(&start.acceleration));
        let first = self.solve_acceleration(&q, &v, t, 0, guided)?;
        let kinds = &self.method.table.carried;
        let rates = if self.stage.system.options.stabilized { model.dofs } else { 0 };
        // older vectors are read only after as many steps have written them
        let mut carried = vec![q, v];
        carried.resize_with(kinds.len(), || vec![S::zero(); model.dofs]);
        self.between = Between {
            step: 0,
            scheme: Scheme::Main,
            carried,
            rate: vec![S::zero(); rates],
            guess: Residual::unknowns(self.stage.system),
            increments: Vec::new(),
        };
        self.between.set_acceleration(kinds, &first);
        let [position_projection, velocity_projection] = start_projections;
        Ok(StartRecord { position_projection, velocity_projection, acceleration: first })
    }

    /// The end of a run.
    pub(super) fn end(self, rejected: usize) -> Run<S> {
        let counters = self.counters();
        let mut carried = self.between.carried.into_iter();
        let (q, v) = (carried.next().unwrap_or_default(), carried.next().unwrap_or_default());
        Run { q, v, rejected, counters }
    }

    /// Takes the next step of a grid.
    ///
    /// # Errors
    /// [`RunError`] with step and time.
    pub fn step(&mut self, grid: &TimeGrid, guided: Option<&StepRecord<f64>>) -> Result<StepRecord<S>, RunError> {
        let index = self.between.step;
        let (scheme, kink) = (self.method.table.scheme_at(grid, index), grid.kinks.contains(&index));
        self.step_over(scheme, grid.span(index), kink, guided)
    }

    /// Makes the next step from the first to the second time; at a kink the acceleration is solved anew before it.
    ///
    /// After an error only [`Marcher::resume`] is of use.
    pub(super) fn step_over(
        &mut self,
        scheme: Scheme,
        (t, end): (f64, f64),
        kink: bool,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<StepRecord<S>, RunError> {
        let method = self.method;
        let mut state = std::mem::take(&mut self.between);
        let index = state.step;
        let table = method.table.scheme(scheme);
        let h = end - t;
        let restart = if kink {
            let first = First::guided(guided.and_then(|step| step.restart.as_ref()));
            let solved = self.solve_acceleration(&state.carried[0], &state.carried[1], t, index, first)?;
            state.set_acceleration(&table.carried, &solved);
            Some(solved)
        } else {
            None
        };
        state.prepare_guesses(scheme, table.stages.len());
        let stages = self.solve_stages(&mut state, table, (t, end), guided)?;
        let accelerations: Vec<&[S]> = stages.iter().map(|stage| stage.solve.unknowns.x.as_slice()).collect();
        let kinds = table.update.iter().zip(&table.carried);
        state.carried =
            kinds.map(|(update, kind)| combine(table, kind.order(), update, h, &state.carried, &accelerations)).collect();
        let [q, v, ..] = &mut state.carried[..] else { unreachable!("q and v are carried first") };
        for (stage, weight) in stages.iter().zip(&table.rates[stages.len()]) {
            add_scaled(q, &stage.rate, h * weight);
        }
        if let Some(last) = stages.last().filter(|stage| !stage.rate.is_empty()) {
            state.rate.clone_from(&last.rate);
        }
        let a = accelerations[accelerations.len() - 1];
        let scale = table.projection_step(h);
        let (position_projection, velocity_projection) = self.project(q, v, a, (end, scale), index, guided)?;
        let (q, v) = (q.clone(), v.clone());
        state.step += 1;
        self.between = state;
        Ok(StepRecord { t, h, scheme, restart, stages, position_projection, velocity_projection, q, v })
    }

    /// The acceleration for given (q, v), at acceleration level whatever the level of the run.
    pub(super) fn solve_acceleration(
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

    fn solve_stages(
        &mut self,
        state: &mut Between<S>,
        table: &Table,
        (t, end): (f64, f64),
        guided: Option<&StepRecord<f64>>,
    ) -> Result<Vec<StageRecord<S>>, RunError> {
        let (h, step) = (end - t, state.step);
        let mut stages: Vec<StageRecord<S>> = Vec::with_capacity(table.stages.len());
        for (index, stage) in table.stages.iter().enumerate() {
            let solved: Vec<&[S]> = stages.iter().map(|stage| stage.solve.unknowns.x.as_slice()).collect();
            let base_of = |order, combination| combine(table, order, combination, h, &state.carried, &solved);
            let mut base = VectorsAvq { a: base_of(2, &stage.a), v: base_of(1, &stage.v), q: base_of(0, &stage.q) };
            for (earlier, weight) in stages.iter().zip(&table.rates[index]) {
                add_scaled(&mut base.q, &earlier.rate, h * weight);
            }
            let equations = self.method.stage_equations(table, index, h, self.constrained);
            // a stage at the end of the step lies before the kink that may be there, whatever t + h rounds to
            let time = if stage.c <= 1.0 + 1e-12 { (t + stage.c * h).min(end) } else { t + stage.c * h };
            let record = if let Some(place) = stage.known {
                let unknowns =
                    Unknowns { x: state.carried[place].clone(), mu: state.guess.mu.clone(), ..Unknowns::default() };
                let solve = SolveRecord { t: time, equations, base, unknowns };
                StageRecord { solve, known: Some(place), rate: state.rate.clone() }
            } else {
                let place = || format!("step {}, stage {} (t = {time} s)", step + 1, index + 1);
                let mut guess = state.guess.clone();
                if let Some(increment) = &state.increments[index] {
                    guess.add_scaled(increment, 1.0);
                }
                let first = match guided {
                    Some(step) => First::Solved(&step.stages[index].solve.unknowns),
                    None => First::Guess(&guess),
                };
                let solve = solve(&mut self.stage, equations, base, first, &self.problem.p, time, &place)?;
                let mut increment = solve.unknowns.clone();
                increment.add_scaled(&state.guess, -1.0);
                state.increments[index] = Some(increment);
                state.guess.clone_from(&solve.unknowns);
                let factor = table.rate_factor(index, h);
                let rate = solve.unknowns.y.iter().map(|&y| y * factor).collect();
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
        (t, scale): (f64, f64),
        step: usize,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<(Option<SolveRecord<S>>, Option<SolveRecord<S>>), RunError> {
        if !self.constrained || self.method.level != ConstraintLevel::Acceleration {
            return Ok((None, None));
        }
        let p = &self.problem.p;
        let place = || format!("step {}, projection (t = {t} s)", step + 1);
        let base = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let first = First::guided(guided.and_then(|step| step.position_projection.as_ref()));
        let position = solve(&mut self.position, Equations::position_projection(scale), base, first, p, t, &place)?;
        add_scaled(q, &position.unknowns.x, scale * scale);
        let base = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let first = First::guided(guided.and_then(|step| step.velocity_projection.as_ref()));
        // with the matrix of the coordinates' projection
        let velocity = solve(&mut self.position, Equations::velocity_projection(scale), base, first, p, t, &place)?;
        add_scaled(v, &velocity.unknowns.x, scale);
        Ok((Some(position), Some(velocity)))
    }
}
