//! One sweep back over the tables, for every integrator and every constraint level.
//!
//! Forward, a run is a chain of linear combinations and of systems F(X; base, p) = 0. Backwards, every system with the
//! adjoint X_bar of its solution solves (dF/dX)^T lambda = -X_bar and passes (dF/dbase)^T lambda and (dF/dp)^T lambda on.

use super::solvers::StepSolvers;
use super::transposed::{
    Backward, SolutionSeed, TransposedSolver, add, lengthened, set_zero_vectors, set_zeros, shifting_clock,
};
use crate::assembly::{JointFriction, Model, System, Unknowns, VectorsAvq};
use crate::design::{ModelNumbers, shortest};
use crate::functionals::{
    Functional, FunctionalGradient, QuadratureWeights, Sample, SampleSeeds, StageWeight, Times, Totals,
};
use crate::history::{Direction, History, Rerun};
use crate::integrators::{
    AxisRecord, Carried, Combination, Counters, EndMoves, Events, ImpactRecord, Method, Moment, OtherHit, Place, Problem,
    RestingPlan, RunError, Scheme, SideChange, SlipBefore, SolveRecord, StartRecord, StepRecord, StepRule, Table, TimeGrid,
    along_axis, each_formula, from_axis, moves, speed_of,
};
use crate::program::Formula;
use crate::scalar::Tangents;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Gradients with respect to parameters and initial state, one for each functional, and the work done.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// df/dp, df/dq0, df/dv0 for each functional.
    pub gradients: Vec<ModelNumbers<f64>>,
    /// df/dt of the breakpoints that move, for each functional.
    pub by_breakpoints: Vec<Vec<f64>>,
    /// Whether switches with numbers of their own pass at once somewhere: the gradients are those of designs that do not move them apart.
    pub passes_together: bool,
    pub counters: Counters,
}

/// Transposed linear combination: distributes the adjoint of a vector of `order` time derivatives, for functional `k`.
#[allow(clippy::too_many_arguments)]
fn distribute(
    table: &Table,
    order: i32,
    combination: &Combination,
    h: f64,
    bar: &[f64],
    carried: &mut [Vec<f64>],
    stages: &mut [Vec<SolutionSeed>],
    k: usize,
) {
    for ((target, kind), coefficient) in carried.iter_mut().zip(&table.carried).zip(&combination.carried) {
        add(target, coefficient * h.powi(kind.order() - order), bar);
    }
    for (target, coefficient) in stages.iter_mut().zip(&combination.stages) {
        add(&mut target[k].x, coefficient * h.powi(2 - order), bar);
    }
}

/// Discrete adjoint of a recorded run for several functionals at once; `totals` are their sums in that run, `active` says of which
/// parameters derivatives are asked for (others get what functionals themselves make of them), `moving` are the places of breakpoints that move.
pub fn adjoint(
    rerun: &Rerun,
    history: &dyn History,
    functionals: &[&Functional],
    totals: &[Totals<f64>],
    active: &[bool],
    moving: &[usize],
) -> Result<AdjointRun, RunError> {
    let method = rerun.method;
    let mut sweep = Sweep {
        problem: rerun.problem,
        p: rerun.problem.p.clone(),
        events: Events::new(rerun.problem.model),
        sides: Vec::new(),
        reads_time: reads_time(rerun.problem.model, functionals),
        method,
        functionals: functionals
            .iter()
            .zip(totals)
            .map(|(functional, totals)| FunctionalGradient::new(functional, rerun.problem.model, totals, active))
            .collect(),
        active,
        moving,
        system: rerun.system().clone(),
        counters: Counters::default(),
        stages: Vec::new(),
        projected: Vec::new(),
        measured: Vec::new(),
        updated: Vec::new(),
        sample: Sample::empty(),
        analyses: Vec::new(),
        impacts: Vec::new(),
        ending: Vec::new(),
        forces: Vec::new(),
        of_shares: Vec::new(),
        passes_together: false,
    };
    sweep.run(rerun, history)
}

struct Sweep<'m> {
    problem: &'m Problem<'m, f64>,
    /// Parameters, with the sides of switches in the step that is gone through.
    p: Vec<f64>,
    events: Events,
    sides: Vec<f64>,
    /// Whether forces, joints or functionals depend on the time itself.
    reads_time: bool,
    method: &'m Method,
    functionals: Vec<FunctionalGradient<'m>>,
    active: &'m [bool],
    moving: &'m [usize],
    system: Arc<System<'m>>,
    counters: Counters,
    /// Workspace of a step: adjoints of the solutions of each stage and of a projection, and of what functionals read at a stage, for one
    /// functional after the other; adjoints of what was carried out of the step.
    stages: Vec<Vec<SolutionSeed>>,
    projected: Vec<SolutionSeed>,
    measured: Vec<Measured>,
    updated: Vec<Vec<f64>>,
    sample: Sample<f64>,
    /// Solvers that were not used, without some equations each: of steps, and of impacts.
    analyses: Vec<(Arc<System<'m>>, StepSolvers<'m>)>,
    impacts: Vec<TransposedSolver<'m>>,
    /// What functionals read of the solution of the last stage, where an event ends the run.
    ending: Vec<(usize, SolutionSeed)>,
    /// Adjoints of the forces at an event.
    forces: Vec<(usize, SolutionSeed)>,
    /// Adjoints of the shares of rates that the last impact kept, for each functional.
    of_shares: Vec<Vec<f64>>,
    passes_together: bool,
}

impl<'m> Sweep<'m> {
    fn run(&mut self, rerun: &Rerun, history: &dyn History) -> Result<AdjointRun, RunError> {
        let model = self.problem.model;
        let zeros = || vec![0.0; model.dofs];
        let multipliers = self.system.multipliers();
        let zero = || Backward {
            carried: self.method.table.carried.iter().map(|_| zeros()).collect(),
            mu: vec![0.0; multipliers],
            by_breakpoints: vec![0.0; self.moving.len()],
            ..Backward::of_parameters(model.parameters)
        };
        let mut back: Vec<Backward> = self.functionals.iter().map(|_| zero()).collect();
        if !rerun.grid.events.is_empty() {
            // of the number that is zero at an event
            back.push(zero());
        }
        if let Some(start) = history.start_record().filter(|start| !start.sides.is_empty()) {
            self.sides.clone_from(&start.sides);
            let changes = rerun.grid.changes().flat_map(|(_, changes)| changes);
            changes.for_each(|change| self.sides[change.switch] = change.sides[1]);
            self.change_back(rerun.grid.changes_at(rerun.grid.steps()).map_or(&[][..], Vec::as_slice));
        }
        let mut solvers = StepSolvers::new(&self.system, self.method, self.active)?;
        if solvers.are_apart {
            let ahead = solvers.clone_analysis()?;
            // on a thread that shares its work with the others
            rayon::scope(|_| self.steps_ahead(rerun, history, &mut back, &mut solvers, ahead))?;
        } else {
            self.steps(rerun, history, &mut back, &mut solvers)?;
        }
        back.truncate(self.functionals.len());
        let missing = || RunError::Input("the run has no start: a gradient needs a run".into());
        let start = history.start_record().ok_or_else(missing)?;
        self.select(&start.dropped, &mut solvers, None)?;
        solvers.end_steps(&mut self.counters);
        let seeds = self.start_bars(start, &mut back);
        if !self.method.table.is_static() {
            let record = &start.acceleration;
            let bases = solvers.plain().through(record, &self.p, &seeds, &mut back, &mut self.counters)?;
            carry(bases, &mut back);
        }
        self.axes_back(&start.axes, &mut back)?;
        // numbers decide sides until the motion begins
        self.p.clone_from(&rerun.problem.p);
        for (solve, carried) in [(&start.velocity_projection, 1), (&start.position_projection, 0)] {
            if let Some(record) = solve {
                let seeds: Vec<SolutionSeed> = back
                    .iter()
                    .map(|back| SolutionSeed { x: back.carried[carried].clone(), mu: vec![0.0; multipliers] })
                    .collect();
                let solver = solvers.plain();
                let bases = solver.through(record, &self.p, &seeds, &mut back, &mut self.counters)?;
                carry(bases, &mut back);
            }
        }
        if let (Some(record), Some(plan)) = (&start.equilibrium, &rerun.plan.equilibrium) {
            self.equilibrium(record, plan, &mut back)?;
        }
        let (gradients, by_breakpoints) = back
            .into_iter()
            .map(|mut back| {
                let v = std::mem::take(&mut back.carried[1]);
                (ModelNumbers { p: back.p, q: std::mem::take(&mut back.carried[0]), v }, back.by_breakpoints)
            })
            .unzip();
        Ok(AdjointRun { gradients, by_breakpoints, passes_together: self.passes_together, counters: self.counters })
    }

    /// Back through the equilibrium at which a motion begins.
    fn equilibrium(&mut self, record: &SolveRecord<f64>, plan: &RestingPlan, back: &mut [Backward]) -> Result<(), RunError> {
        let resting = self.problem.model.at_rest(&plan.stays);
        let (model, p, active) = (&resting.model, resting.parameters(&self.p), resting.parameters(self.active));
        let q = record.point().q;
        for Backward { carried, p: p_bar, .. } in &mut *back {
            let [q_bar, v_bar, ..] = &mut carried[..] else { continue };
            self.problem.model.spin_velocities_back((&q, &self.p), [q_bar, v_bar, p_bar]);
        }
        let system = self.method.system(model, &plan.dropped);
        let multipliers = system.multipliers();
        let mut solver = TransposedSolver::new(system, self.method, &active)?;
        let bar = |back: &Backward| {
            let x = resting.coordinates(&back.carried[0], &back.carried[1]);
            SolutionSeed { x, mu: vec![0.0; multipliers] }
        };
        let seeds: Vec<SolutionSeed> = back.iter().map(bar).collect();
        let mut own: Vec<Backward> = back.iter().map(|_| Backward::of_parameters(model.parameters)).collect();
        let bases = solver.through(record, &p, &seeds, &mut own, &mut self.counters)?;
        for ((back, own), base) in back.iter_mut().zip(own).zip(bases) {
            let [q_bar, v_bar, ..] = &mut back.carried[..] else { continue };
            let mut own_bar = resting.coordinates(q_bar, v_bar);
            add(&mut own_bar, 1.0, &base.q);
            add(&mut own_bar, 1.0, &resting.velocities(&base.v));
            resting.set_motion(&own_bar, q_bar, v_bar);
            resting.add_gradient(&own.p, &mut back.p);
        }
        Ok(())
    }

    fn steps(
        &mut self,
        rerun: &Rerun,
        history: &dyn History,
        back: &mut [Backward],
        solvers: &mut StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let mut steps = history.read(rerun, Direction::Backward)?;
        let mut weights = QuadratureWeights::at_end(&rerun.method.table);
        let mut place = StepPlace::last(rerun.grid, self.moving);
        while let Some(step) = steps.next()? {
            self.select(&step.dropped, solvers, None)?;
            self.step(step, &place, &weights.back_through(step), back, solvers)?;
            solvers.settle_care(None);
            place = self.before(step, &place, rerun.grid);
        }
        Ok(())
    }

    /// The same, while the systems of the step before are factored on another thread: all of a sweep's matrices are known from the start.
    fn steps_ahead(
        &mut self,
        rerun: &Rerun,
        history: &dyn History,
        back: &mut [Backward],
        solvers: &mut StepSolvers<'m>,
        mut ahead: StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let mut steps = history.read(rerun, Direction::Backward)?;
        let mut weights = QuadratureWeights::at_end(&rerun.method.table);
        let mut place = StepPlace::last(rerun.grid, self.moving);
        let mut p = self.p.clone();
        // whether this thread factored the systems of a step; it takes the first of two pieces of work
        let mut is_mine = true;
        let (mut step, mut next) = (None, None);
        keep(&mut next, steps.next()?);
        while next.is_some() {
            std::mem::swap(&mut step, &mut next);
            keep(&mut next, steps.next()?);
            let Some(step) = &step else { break };
            self.select(&step.dropped, solvers, Some(&mut ahead))?;
            let weights = weights.back_through(step);
            // with fewer unknowns all stages may share a solver
            let is_alike = |next: &&StepRecord<f64>| next.dropped == step.dropped && step.switched.is_empty();
            let ready = next.as_ref().filter(|next| is_alike(next) && ahead.are_apart);
            let are_shared = solvers.are_shared;
            let mut step_back = || self.step(step, &place, &weights, back, solvers);
            match ready {
                // who is ready first helps with the other systems
                Some(next) if are_shared => rayon::join(step_back, || ahead.factor(next, &p)).0?,
                // who factored the systems of a step goes back through it: their numbers are in its caches
                Some(next) if is_mine => join_awake(step_back, || ahead.factor(next, &p)).0?,
                Some(next) => join_awake(|| ahead.factor(next, &p), step_back).1?,
                None => step_back()?,
            }
            is_mine = ready.is_none() || !is_mine;
            solvers.settle_care(Some(&mut ahead));
            solvers.forget(&mut self.counters);
            // one set alone goes on with what it knows
            if solvers.are_apart {
                std::mem::swap(solvers, &mut ahead);
                solvers.learn_from(&ahead);
            }
            place = self.before(step, &place, rerun.grid);
            if !place.events_end.is_empty() {
                p.clone_from(&self.p);
            }
        }
        Ok(())
    }

    /// The place of the step before one, with the sides that it had.
    fn before(&mut self, step: &StepRecord<f64>, place: &StepPlace, grid: &TimeGrid) -> StepPlace {
        if !step.switched.is_empty() {
            self.change_back(&step.switched);
        }
        StepPlace::of(place.index.saturating_sub(1), step.switched.clone(), (grid, self.moving))
    }

    /// Goes over to the sides before they changed.
    fn change_back(&mut self, changes: &[SideChange]) {
        changes.iter().rev().for_each(|change| self.sides[change.switch] = change.sides[0]);
        self.events.write(&self.sides, &mut self.p);
    }

    fn select(
        &mut self,
        dropped: &[usize],
        solvers: &mut StepSolvers<'m>,
        ahead: Option<&mut StepSolvers<'m>>,
    ) -> Result<(), RunError> {
        if self.system.options.dropped != dropped {
            solvers.forget(&mut self.counters);
            *solvers = match self.analyses.iter().find(|own| own.0.options.dropped == dropped) {
                Some((system, analysis)) => {
                    self.system = system.clone();
                    analysis.clone_analysis()?
                }
                None => {
                    self.system = self.method.system(self.problem.model, dropped);
                    let analysis = StepSolvers::new(&self.system, self.method, self.active)?;
                    let own = analysis.clone_analysis()?;
                    self.analyses.push((self.system.clone(), analysis));
                    own
                }
            };
            if let Some(ahead) = ahead {
                ahead.forget(&mut self.counters);
                *ahead = solvers.clone_analysis()?;
            }
        }
        Ok(())
    }

    /// Sets the adjoints of (a, v, q) and mu to the gradient of functional `k` at a sample with a weight in time; adds that by parameters.
    fn measure(&mut self, k: usize, sample: &Sample<f64>, weight: f64, own: &mut Measured, p_bar: &mut [f64]) {
        let model = self.problem.model;
        let Measured { at, mu } = own;
        set_zero_vectors(at, model.dofs);
        set_zeros(mu, sample.mu.len());
        if weight != 0.0 {
            let mut seeds = SampleSeeds { at, mu, p: p_bar };
            self.functionals[k].add(model, sample, &self.p, weight, &mut seeds);
            sample.share_transposed(model, &self.p, mu, &mut at.q, p_bar);
        }
    }

    fn add_moves(&self, k: usize, sample: &Sample<f64>, weight: f64, back: &mut Backward) {
        if let Some(span) = back.span {
            let is_at_end = back.is_euler && self.times(k) == Times::End;
            let (clock, mut weight) = (if is_at_end { shifting_clock(1) } else { back.clock() }, Tangents::from(weight));
            let over = &self.functionals[k].functional.over;
            if over.times() == Times::Run && !over.counts_samples() {
                weight *= if back.is_euler { lengthened(span) } else { clock.length() };
            }
            let own = self.functionals[k].moves(self.problem.model, sample, &self.p, (weight, clock));
            back.moves.iter_mut().zip(own).for_each(|(moves, own)| *moves += own);
        }
    }

    /// When a functional reads; the number of an event is none.
    fn times(&self, k: usize) -> Times {
        self.functionals.get(k).map_or(Times::Start, |own| own.functional.over.times())
    }

    /// Shares the forces of redundant constraints, if a functional reads them.
    fn share(&self, sample: &mut Sample<f64>) {
        if self.functionals.iter().any(|own| own.functional.reads_multipliers()) {
            sample.share(self.problem.model, &self.p);
        }
    }

    /// Adds what a functional reads of a state between steps, whose acceleration is x times a factor.
    fn read_state(&mut self, k: usize, sample: &Sample<f64>, factor: f64, solved: &mut SolutionSeed, back: &mut Backward) {
        let mut measured = Measured::default();
        self.measure(k, sample, 1.0, &mut measured, &mut back.p);
        let Measured { at, mu } = measured;
        add(&mut back.carried[0], 1.0, &at.q);
        add(&mut back.carried[1], 1.0, &at.v);
        add(&mut solved.x, factor, &at.a);
        add(&mut solved.mu, 1.0, &mu);
    }

    /// Adjoint of the first acceleration: what the first step carried over, and initial functionals.
    fn start_bars(&mut self, start: &StartRecord<f64>, back: &mut [Backward]) -> Vec<SolutionSeed> {
        let mut seeds = take_carried_acceleration(&self.method.table, back);
        let mut sample = Sample::initial(start);
        self.share(&mut sample);
        for (k, (bar, back)) in seeds.iter_mut().zip(back).enumerate() {
            if self.times(k) == Times::Start {
                self.read_state(k, &sample, 1.0, bar, back);
            }
        }
        seeds
    }

    /// Back through one step, whose stages have these weights in an integral. The length of one that starts or ends at an event has derivatives; for
    /// the number g of the event, which is zero at its end, the time t of that follows from those of g.
    fn step(
        &mut self,
        step: &StepRecord<f64>,
        place: &StepPlace,
        weights: &[StageWeight],
        back: &mut [Backward],
        solvers: &mut StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let (ends, moves) = (place.events_end.first().filter(|_| place.is_located), &place.moves);
        // terms of which the rate of the number of an event is the sum
        let mut speed = 0.0;
        let is_moved_alone = place.events_end.is_empty() && moves[0] == moves[1];
        if is_moved_alone && (moves[0].is_zero() || !self.reads_time) {
            back.iter_mut().for_each(|back| back.span = None);
            return self.step_through(step, place, weights, back, solvers);
        }
        for back in &mut *back {
            (back.span, back.moves) = (Some([step.t, step.end]), [0.0; 2]);
            back.is_euler = step.scheme == Scheme::Euler;
            if ends.is_some() {
                // what later steps make of its end
                back.moves[1] = std::mem::take(&mut back.by_event);
            }
        }
        if !place.events_end.is_empty() {
            self.behind_event(step, place, back)?;
        }
        if let Some(change) = ends {
            let own = back.last_mut().unwrap_or_else(|| unreachable!("the number of the event has a place"));
            let mu = step.forces.as_ref().map_or(&[][..], |own| &own.unknowns.mu);
            let moment = Moment { a: &vec![0.0; step.q.len()], v: &step.v, q: &step.q, mu: [mu, &[]], t: step.end };
            let mut of_multipliers = SolutionSeed::zeros(step.q.len(), mu.len());
            let mut accelerations = Vec::new();
            if let Some(last) = step.stages.last() {
                last.solve.write_acceleration(&mut accelerations);
            }
            self.events.number_by_arguments(change.switch, moment, &self.p, |place, rate| match place {
                Place::V(dof) => {
                    own.carried[1][dof] += rate;
                    speed += (rate * accelerations.get(dof).copied().unwrap_or(0.0)).abs();
                }
                Place::Q(dof) => {
                    own.carried[0][dof] += rate;
                    speed += (rate * step.v[dof]).abs();
                }
                Place::P(index) => own.p[index] += rate,
                Place::Time => {
                    own.moves[1] += rate;
                    speed += rate.abs();
                }
                Place::Mu(row) => of_multipliers.mu[row] += rate,
                Place::A(_) => {}
            });
            self.forces.push((self.functionals.len(), of_multipliers));
            let moment = Moment { a: &accelerations, ..moment };
            self.passes_together |=
                !self.events.passing_with_first(&place.events_end, moment, &self.p, &self.sides).is_empty();
        }
        self.forces_back(step, back)?;
        let rule = StepRule { method: self.method, constrained: self.system.is_constrained() };
        if step.scheme == Scheme::Euler {
            back.iter_mut().for_each(|back| back.lengthen(step));
            self.step_through(step, place, weights, back, solvers)?;
        } else {
            self.pace(&step.carried_behind(rule), -1.0, back);
            self.step_through(step, place, weights, back, solvers)?;
            self.pace(&step.carried, 1.0, back);
        }
        if ends.is_some()
            && let Some((event, back)) = back.split_last_mut()
        {
            if event.moves[1].abs() <= GRAZING * speed {
                let (part, t) = (ends.map_or("", |change| self.events.part_of(change.switch)), shortest(step.end));
                return Err(RunError::Input(format!(
                    "\"{part}\" is touched at t = {t} s without being passed: its number has a rate of {:.1e} of the terms of which this is the sum, so \
                     that the time of the event has no derivative; take another design",
                    event.moves[1].abs() / speed
                )));
            }
            for back in back {
                let moved = -back.moves[1] / event.moves[1];
                back.moves[0] += moved * event.moves[0];
                back.moves[1] = 0.0;
                let lists = [&mut back.mu, &mut back.p].into_iter().chain(&mut back.carried);
                let others = [&event.mu, &event.p].into_iter().chain(&event.carried);
                lists.zip(others).for_each(|(own, other)| add(own, moved, other));
            }
            event.moves = [0.0; 2];
            let lists = [&mut event.mu, &mut event.p].into_iter().chain(&mut event.carried);
            lists.for_each(|own| own.fill(0.0));
        }
        back.iter_mut().for_each(|back| back.move_ends(moves));
        Ok(())
    }

    /// Back from behind an event to the end of its step: reads functionals there whose run it ends, and goes back through what events set.
    fn behind_event(&mut self, step: &StepRecord<f64>, place: &StepPlace, back: &mut [Backward]) -> Result<(), RunError> {
        self.ending.clear();
        if !place.is_before_another {
            let mut sample = Sample::empty();
            sample.set_terminal(step);
            sample.follow_events(step, &self.p);
            self.share(&mut sample);
            let gamma = step.stages.last().map_or(0.0, |last| last.solve.equations.residual.gamma);
            let clock = shifting_clock(1);
            for (k, back) in back.iter_mut().enumerate() {
                if self.times(k) != Times::End {
                    continue;
                }
                let mut seed = SolutionSeed::zeros(sample.at.a.len(), sample.mu.len());
                self.read_state(k, &sample, gamma, &mut seed, back);
                back.moves[1] +=
                    self.functionals[k].moves(self.problem.model, &sample, &self.p, (Tangents::from(1.0), clock))[1];
                // an acceleration is carried out of the time of the step, as velocities are
                let along: f64 = sample.at.a.iter().zip(&seed.x).map(|(a, bar)| a * bar).sum();
                if along != 0.0 && step.scheme != Scheme::Euler {
                    let rate = 2.0 * along / (gamma * (step.end - step.t));
                    back.moves[0] += rate;
                    back.moves[1] -= rate;
                }
                self.ending.push((k, seed));
            }
        }
        let happened = self.events.happening(&place.events_end, &self.sides);
        let mut states = vec![[step.v.clone(), step.q.clone()]];
        for (number, &event) in happened.iter().enumerate() {
            let [mut v, mut q] = states[states.len() - 1].clone();
            // it was set when the run was made
            let _ = self.events.reset((event, number), [&mut v, &mut q], step.end, &self.p, &mut Vec::new());
            for own in step.impacts.iter().filter(|own| own.event == number) {
                own.add_to(&mut v, &self.p, 1.0);
            }
            states.push([v, q]);
        }
        let (turned, pulled) = self.directions_back(step, place, &states[states.len() - 1], back);
        self.axes_back(&step.axes, back)?;
        for ((number, &event), [v, q]) in happened.iter().enumerate().zip(&states).rev() {
            for own in step.impacts.iter().rev().filter(|own| own.event == number) {
                self.impact_back(own, back)?;
                self.axes_back(&own.axes, back)?;
            }
            for back in &mut back[..self.functionals.len()] {
                let [q_bar, v_bar, ..] = &mut back.carried[..] else { unreachable!("q and v are carried first") };
                let seeds = [&mut v_bar[..], q_bar, &mut back.p];
                back.moves[1] += self.events.reset_back(event, [v, q], (step.end, &self.p), seeds);
            }
        }
        // impacts have directions of their own
        turned.into_iter().for_each(|place| back.iter_mut().for_each(|back| back.p[place] = 0.0));
        pulled.into_iter().for_each(|(k, place, bar)| back[k].p[place] += bar);
        Ok(())
    }

    /// Back through the directions in which surfaces slip from an event on, d = u / |u|, where u is their slip [v, q] behind it, or the force that
    /// broke them away; returns their places in p, and adjoints, by functionals and places, of the axes along which they stuck before.
    fn directions_back(
        &mut self,
        step: &StepRecord<f64>,
        place: &StepPlace,
        [v, q]: &[Vec<f64>; 2],
        back: &mut [Backward],
    ) -> (Vec<usize>, Vec<(usize, usize, f64)>) {
        let mut after = self.sides.clone();
        place.events_end.iter().for_each(|change| after[change.switch] = change.sides[1]);
        let (mut turned, mut pulled) = (Vec::new(), Vec::new());
        let Some(last) = step.stages.last() else { return (turned, pulled) };
        let x = &last.solve.unknowns.x;
        let mu = &step.forces.as_ref().unwrap_or(&last.solve).unknowns.mu;
        for friction in self.events.turned(&self.sides, &after) {
            let JointFriction { joints, direction, axis: places, .. } = self.events.friction(friction).clone();
            let rows = self.problem.model.constraints[joints[1]].equations.clone();
            let d = self.events.direction(friction, &after).to_vec();
            let slip = self.events.slip(friction, [&v[..], q], step.end, &self.p);
            let is_moving = moves(&slip, speed_of(v, x, step.h));
            let axis = self.events.axis(friction, &self.sides);
            let u = if is_moving { slip } else { from_axis(&mu[rows.clone()], axis) };
            let size = u.iter().map(|own| own * own).sum::<f64>().sqrt();
            turned.extend(direction.iter().flat_map(Clone::clone));
            for (k, back) in back.iter_mut().enumerate() {
                let bar = [0, 1].map(|i| direction.iter().map(|places| back.p[places.start + i]).sum::<f64>());
                direction.iter().for_each(|places| back.p[places.clone()].fill(0.0));
                let along = bar[0] * d[0] + bar[1] * d[1];
                let bar = [0, 1].map(|i| (bar[i] - along * d[i]) / size);
                if is_moving {
                    let [q_bar, v_bar, ..] = &mut back.carried[..] else { unreachable!("q and v are carried first") };
                    let seeds = [&mut v_bar[..], q_bar, &mut back.p];
                    back.moves[1] += self.events.slip_back(friction, [v, q], (step.end, &self.p), &bar, seeds);
                } else {
                    let mut seed = SolutionSeed::zeros(step.q.len(), mu.len());
                    seed.mu[rows.clone()].copy_from_slice(&along_axis(&bar, axis));
                    self.forces.push((k, seed));
                    let of_axis = along_axis(&bar, &mu[rows.clone()]);
                    pulled.extend(places.clone().zip(of_axis).map(|(place, bar)| (k, place, bar)));
                }
            }
        }
        (turned, pulled)
    }

    /// Back through the directions c = u / |u| of what sticks, where u is what slip there is in the second of two impacts less that in the first.
    fn axes_back(&mut self, axes: &[AxisRecord<f64>], back: &mut [Backward]) -> Result<(), RunError> {
        for own in axes {
            let [none, _] = &own.impacts;
            let (t, [v, q]) = (none.solve.t, [&none.solve.base.v[..], &none.solve.base.q]);
            let u = own.slip(&self.events, [v, q], t, &self.p);
            let size = u[0].hypot(u[1]);
            let across = [-u[1] / size, u[0] / size];
            let places = self.events.friction(own.friction).axis.clone();
            let take = |back: &mut Backward| {
                let bars = &mut back.p[places.clone()];
                let bar = (bars[0] * across[0] + bars[1] * across[1]) / size;
                bars.fill(0.0);
                across.map(|own| own * bar)
            };
            let bars: Vec<[f64; 2]> = back.iter_mut().map(take).collect();
            // what is set in both depends on nothing
            let set: Vec<usize> = none.set.iter().map(|own| own.0).collect();
            let of_set: Vec<Vec<f64>> = back.iter().map(|back| set.iter().map(|&place| back.p[place]).collect()).collect();
            for (impact, sign) in own.impacts.iter().zip([-1.0, 1.0]) {
                let SolveRecord { base, unknowns, .. } = &impact.solve;
                let v: Vec<f64> = base.v.iter().zip(&unknowns.x).map(|(v, x)| v + x).collect();
                let mut seeds = Vec::new();
                for (back, bar) in back.iter_mut().zip(&bars) {
                    let mut seed = SolutionSeed::zeros(v.len(), unknowns.mu.len());
                    let [q_bar, v_bar, ..] = &mut back.carried[..] else { unreachable!("q and v are carried first") };
                    let rates = [&mut seed.x[..], q_bar, &mut back.p];
                    let bar = bar.map(|bar| sign * bar);
                    back.moves[1] += self.events.slip_back(own.friction, [&v, q], (t, &self.p), &bar, rates);
                    add(v_bar, 1.0, &seed.x);
                    seeds.push(seed);
                }
                self.through_impact(impact, &seeds, back)?;
            }
            for (back, bars) in back.iter_mut().zip(of_set) {
                set.iter().zip(bars).for_each(|(&place, bar)| back.p[place] = bar);
            }
        }
        Ok(())
    }

    /// Back through the forces at the end of a step, by which events happen there.
    fn forces_back(&mut self, step: &StepRecord<f64>, back: &mut [Backward]) -> Result<(), RunError> {
        let mut all = std::mem::take(&mut self.forces);
        all.retain(|own| !own.1.is_zero());
        if all.is_empty() {
            return Ok(());
        }
        let Some(record) = &step.forces else {
            return Err(RunError::Input(format!(
                "surfaces begin to slip at t = {} s in a direction that neither a slip before it nor a force gives: it has no derivative",
                shortest(step.end)
            )));
        };
        let Unknowns { x, mu, .. } = &record.unknowns;
        let mut seeds: Vec<SolutionSeed> = back.iter().map(|_| SolutionSeed::zeros(x.len(), mu.len())).collect();
        all.into_iter().for_each(|(k, own)| add(&mut seeds[k].mu, 1.0, &own.mu));
        self.through_apart((record, &step.dropped, &[]), &self.p.clone(), &seeds, back)
    }

    /// Back through the equations of an impact.
    fn through_impact(
        &mut self,
        impact: &ImpactRecord<f64>,
        seeds: &[SolutionSeed],
        back: &mut [Backward],
    ) -> Result<(), RunError> {
        let mut p = self.p.clone();
        impact.set_parameters(&self.problem.model.frictions, &mut p);
        let is_there = |own: &(usize, f64)| impact.dropped.binary_search(&own.0).is_err();
        let kept: Vec<(usize, f64)> = impact.shares(&p).into_iter().filter(is_there).collect();
        self.through_apart((&impact.solve, &impact.dropped, &kept), &p, seeds, back)?;
        // of the shares (e - e') / (1 + e)
        let of = |place: Option<usize>| place.map_or(0.0, |place| p[place]);
        let e = of(impact.restitution);
        for OtherHit { row, restitution } in &impact.others {
            let Some(place) = kept.iter().position(|own| own.0 == *row) else { continue };
            for (back, bars) in back.iter_mut().zip(&self.of_shares) {
                if let Some(own) = restitution {
                    back.p[*own] -= bars[place] / (1.0 + e);
                }
                if let Some(first) = impact.restitution {
                    back.p[first] += bars[place] * (1.0 + of(*restitution)) / ((1.0 + e) * (1.0 + e));
                }
            }
        }
        Ok(())
    }

    /// Back through a system at the end of a step that is none of its stages, at the time that this end has.
    fn through_apart(
        &mut self,
        (record, dropped, kept): (&SolveRecord<f64>, &[usize], &[(usize, f64)]),
        p: &[f64],
        seeds: &[SolutionSeed],
        back: &mut [Backward],
    ) -> Result<(), RunError> {
        let place = match self.impacts.iter().position(|own| own.system.options.dropped == dropped) {
            Some(place) => place,
            None => {
                let system = self.method.system(self.problem.model, dropped);
                self.impacts.push(TransposedSolver::new(system, self.method, self.active)?);
                self.impacts.len() - 1
            }
        };
        // its numbers do not depend on the impacts before
        let mut solver = self.impacts[place].clone_analysis()?;
        solver.is_apart = true;
        let bases = solver.through(record, p, seeds, back, &mut self.counters)?;
        carry(bases, back);
        if !kept.is_empty() {
            let (bases, of_shares) = solver.through_kept(record, p, (seeds, kept), back);
            carry(bases, back);
            self.of_shares = of_shares;
        }
        Ok(())
    }

    /// Back through an impact, by which velocities change by (1 + e) x.
    fn impact_back(&mut self, impact: &ImpactRecord<f64>, back: &mut [Backward]) -> Result<(), RunError> {
        let (factor, Unknowns { x, mu, .. }) = (impact.factor(&self.p), &impact.solve.unknowns);
        let mut seeds = Vec::new();
        for back in &mut *back {
            let mut seed = SolutionSeed::zeros(x.len(), mu.len());
            add(&mut seed.x, factor, &back.carried[1]);
            impact.go_back(&back.carried[1], &self.p, &mut seed.mu, &mut back.p);
            seeds.push(seed);
        }
        // at other times nothing is kept
        let kept = self.problem.model.frictions.iter().flat_map(|own| own.kept.clone());
        kept.for_each(|place| back.iter_mut().for_each(|back| back.p[place] = 0.0));
        self.through_impact(impact, &seeds, back)?;
        self.kept_back(impact, back);
        Ok(())
    }

    /// Back through the slip that an impact keeps, e / (1 + e) of that before.
    fn kept_back(&mut self, impact: &ImpactRecord<f64>, back: &mut [Backward]) {
        let Some(place) = impact.restitution else { return };
        let e = self.p[place];
        let ([v, q], t) = ([&impact.solve.base.v[..], &impact.solve.base.q], impact.solve.t);
        for SlipBefore { friction, slip } in &impact.kept {
            let places = self.problem.model.frictions[*friction].kept.clone();
            for back in &mut *back {
                let bars: Vec<f64> = places.clone().map(|place| std::mem::take(&mut back.p[place])).collect();
                back.p[place] += bars.iter().zip(slip).map(|(bar, slip)| bar * slip).sum::<f64>() / ((1.0 + e) * (1.0 + e));
                let bars: Vec<f64> = bars.iter().map(|bar| bar * e / (1.0 + e)).collect();
                let [q_bar, v_bar, ..] = &mut back.carried[..] else { unreachable!("q and v are carried first") };
                let seeds = [&mut v_bar[..], q_bar, &mut back.p];
                back.moves[1] += self.events.slip_back(*friction, [v, q], (t, &self.p), &bars, seeds);
            }
        }
    }

    /// Velocities and accelerations between two steps are carried into the time of one, or out of it: (1 + s) times as large for each of their
    /// derivatives, for a length of the step that grows by a share s.
    fn pace(&self, carried: &[Vec<f64>], sign: f64, back: &mut [Backward]) {
        for Backward { carried: bars, moves, span, .. } in back {
            let Some([start, end]) = *span else { continue };
            let of_kind = |((kind, values), bars): ((&Carried, &Vec<f64>), &Vec<f64>)| {
                f64::from(kind.order()) * values.iter().zip(bars).map(|(value, bar)| value * bar).sum::<f64>()
            };
            let all: f64 = self.method.table.carried.iter().zip(carried).zip(&*bars).map(of_kind).sum();
            let rate = sign * all / (end - start);
            moves[0] -= rate;
            moves[1] += rate;
        }
    }

    fn step_through(
        &mut self,
        step: &StepRecord<f64>,
        place: &StepPlace,
        weights: &[StageWeight],
        back: &mut [Backward],
        solvers: &mut StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let last_step = !place.is_before_another;
        back.iter_mut().for_each(Backward::drop_negligible);
        let table = self.method.table.scheme(step.scheme);
        let mut stages = std::mem::take(&mut self.stages);
        let multipliers = self.system.multipliers();
        stages.resize_with(table.stages.len(), Vec::new);
        for stage in &mut stages {
            set_zero_bars(stage, back.len(), (self.problem.model.dofs, multipliers));
        }
        let last = table.stages.len() - 1;
        // what the next step's explicit first stage took over from this step's last one
        for (stage, back) in stages[last].iter_mut().zip(back.iter_mut()) {
            add(&mut stage.mu, 1.0, &back.mu);
            back.mu.fill(0.0);
        }
        if !place.events_end.is_empty() {
            for (k, seed) in self.ending.drain(..) {
                add(&mut stages[last][k].x, 1.0, &seed.x);
                add(&mut stages[last][k].mu, 1.0, &seed.mu);
            }
        } else if last_step && (0..back.len()).any(|k| self.times(k) == Times::End) {
            let mut sample = Sample::empty();
            sample.set_terminal(step);
            self.share(&mut sample);
            for (k, (stage, back)) in stages[last].iter_mut().zip(back.iter_mut()).enumerate() {
                if self.times(k) == Times::End {
                    self.read_state(k, &sample, step.stages[last].solve.equations.residual.gamma, stage, back);
                    self.add_moves(k, &sample, 1.0, back);
                }
            }
        }
        self.projections(step, back, &mut stages[last], solvers)?;

        // the update
        for (k, back) in back.iter_mut().enumerate() {
            self.updated.resize_with(back.carried.len(), Vec::new);
            for (updated, bar) in self.updated.iter_mut().zip(&mut back.carried) {
                updated.clone_from(bar);
                bar.fill(0.0);
            }
            for ((bar, kind), combination) in self.updated.iter().zip(&table.carried).zip(&table.update) {
                distribute(table, kind.order(), combination, step.h, bar, &mut back.carried, &mut stages, k);
            }
        }
        for (stage, &weight) in weights.iter().enumerate().rev() {
            self.stage(step, (stage, weight), back, &mut stages, solvers)?;
        }
        if let Some(restart) = &step.restart {
            let seeds = take_carried_acceleration(table, back);
            let bases = solvers.plain().through(restart, &self.p, &seeds, back, &mut self.counters)?;
            carry(bases, back);
        }
        self.stages = stages;
        Ok(())
    }

    /// Back through the projections at the end of a step, whose last stage has these adjoints.
    fn projections(
        &mut self,
        step: &StepRecord<f64>,
        back: &mut [Backward],
        last: &mut [SolutionSeed],
        solvers: &mut StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let multipliers = self.system.multipliers();
        for (solve, carried) in [(&step.velocity_projection, 1), (&step.position_projection, 0)] {
            let Some(record) = solve else { continue };
            let shift = record.equations.constraint;
            let factor = if carried == 1 { shift.beta } else { shift.alpha };
            set_zero_bars(&mut self.projected, back.len(), (self.problem.model.dofs, multipliers));
            for (bar, back) in self.projected.iter_mut().zip(&*back) {
                add(&mut bar.x, factor, &back.carried[carried]);
            }
            let solver = solvers.plain();
            let bases = solver.through(record, &self.p, &self.projected, back, &mut self.counters)?;
            carry(bases, back);
            for (last, base) in last.iter_mut().zip(bases) {
                add(&mut last.x, 1.0, &base.a);
            }
        }
        Ok(())
    }

    fn stage(
        &mut self,
        step: &StepRecord<f64>,
        (stage, weight): (usize, StageWeight),
        back: &mut [Backward],
        stages: &mut [Vec<SolutionSeed>],
        solvers: &mut StepSolvers<'m>,
    ) -> Result<(), RunError> {
        let table = self.method.table.scheme(step.scheme);
        let record = &step.stages[stage];
        let shift = record.solve.equations.residual;
        let (earlier, own) = stages.split_at_mut(stage);
        let own = &mut own[0];
        let mut measured = std::mem::take(&mut self.measured);
        measured.resize_with(back.len(), Measured::default);
        // functionals read (a, v, q) of the stage: the base directly, x through the shift
        let weights: SmallVec<[f64; 8]> =
            self.functionals.iter().map(|own| own.functional.over.time_weight(weight)).collect();
        let reads = weights.iter().enumerate().map(|(k, &weight)| weight != 0.0 && self.times(k) == Times::Run);
        let reads: SmallVec<[bool; 8]> = reads.chain((weights.len()..back.len()).map(|_| false)).collect();
        if reads.contains(&true) {
            let mut sample = std::mem::replace(&mut self.sample, Sample::empty());
            sample.set_stage(step, stage);
            self.share(&mut sample);
            for (k, (back, own)) in back.iter_mut().zip(&mut *own).enumerate().filter(|(k, _)| reads[*k]) {
                self.measure(k, &sample, weights[k], &mut measured[k], &mut back.p);
                self.add_moves(k, &sample, weights[k], back);
                let Measured { at, mu } = &measured[k];
                add(&mut own.mu, 1.0, mu);
                // mostly one of these
                let parts = [(shift.gamma, &at.a), (shift.beta, &at.v), (shift.alpha, &at.q)];
                let read = parts.into_iter().filter(|(_, part)| part.iter().any(|&bar| bar != 0.0));
                read.for_each(|(factor, part)| add(&mut own.x, factor, part));
            }
            self.sample = sample;
        }
        let mut solved: &[VectorsAvq<f64>] = &[];
        if let Some(place) = record.known {
            for (back, own) in back.iter_mut().zip(own) {
                add(&mut back.carried[place], 1.0, &own.x);
                add(&mut back.mu, 1.0, &own.mu);
            }
        } else {
            solved = solvers.stage(stage).through(&record.solve, &self.p, own, back, &mut self.counters)?;
        }
        for ((Measured { at, .. }, base), _) in measured.iter_mut().zip(solved).zip(&reads).filter(|(_, reads)| **reads) {
            add(&mut at.a, 1.0, &base.a);
            add(&mut at.v, 1.0, &base.v);
            add(&mut at.q, 1.0, &base.q);
        }
        let relation = &table.stages[stage];
        for (k, back) in back.iter_mut().enumerate() {
            let base = if reads[k] { Some(&measured[k].at) } else { solved.get(k) };
            let Some(base) = base else { continue };
            for (order, combination, bar) in [
                (Carried::A.order(), &relation.a, &base.a),
                (Carried::V.order(), &relation.v, &base.v),
                (Carried::Q.order(), &relation.q, &base.q),
            ] {
                distribute(table, order, combination, step.h, bar, &mut back.carried, earlier, k);
            }
        }
        self.measured = measured;
        Ok(())
    }
}

/// Share of its terms below which the rate of a number that passes zero is none.
const GRAZING: f64 = 1e-6;

/// Longest time that a thread waits awake for another one: waking it up takes about as long as the factors of a small step.
const AWAKE: Duration = Duration::from_micros(200);

/// Does both on two threads, if another one is free: of these, which have a short piece of work after the other, none falls asleep in between.
fn join_awake<A: Send, B: Send>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B + Send) -> (A, B) {
    let (second_begun, first_done, second_done): (AtomicBool, AtomicBool, AtomicBool) = Default::default();
    let wait = |begun: &AtomicBool, done: &AtomicBool| {
        let start = Instant::now();
        while begun.load(Ordering::Acquire) && !done.load(Ordering::Acquire) && start.elapsed() < AWAKE {
            std::hint::spin_loop();
        }
    };
    rayon::join(
        || {
            let result = first();
            first_done.store(true, Ordering::Release);
            wait(&second_begun, &second_done);
            result
        },
        || {
            second_begun.store(true, Ordering::Release);
            let result = second();
            second_done.store(true, Ordering::Release);
            wait(&second_begun, &first_done);
            result
        },
    )
}

/// Where a step stands in a run.
struct StepPlace {
    index: usize,
    is_before_another: bool,
    /// Sides that change at its end, the one first whose number ended it.
    events_end: Vec<SideChange>,
    /// Whether that is so: at a breakpoint its time is given.
    is_located: bool,
    /// How its start and its end move, the latter where no event is; breakpoints are numbered among those that move.
    moves: [EndMoves; 2],
}

impl StepPlace {
    fn last(grid: &TimeGrid, moving: &[usize]) -> Self {
        let ends = grid.changes_at(grid.steps()).cloned();
        Self::of(grid.steps().saturating_sub(1), ends.unwrap_or_default(), (grid, moving))
    }

    fn of(index: usize, events_end: Vec<SideChange>, (grid, moving): (&TimeGrid, &[usize])) -> Self {
        let is_before_another = index + 1 < grid.steps();
        let is_located = grid.events.contains_key(&(index + 1));
        let mut moves = [EndMoves::default(); 2];
        if !(moving.is_empty() && grid.events.is_empty()) {
            moves = [index, index + 1].map(|place| grid.moves_of(place));
            for (place, share) in moves.iter_mut().flat_map(|own| &mut own.by_breakpoints) {
                (*place, *share) = moving.binary_search(place).map_or((0, 0.0), |number| (number, *share));
            }
            if is_located {
                moves[1] = EndMoves::default();
            }
        }
        StepPlace { index, is_before_another, events_end, is_located, moves }
    }
}

fn reads_time(model: &Model, functionals: &[&Functional]) -> bool {
    let mut reads = false;
    let mut look = |formula: &Arc<Formula>, places: &dyn Fn() -> Vec<Place>| {
        reads |= places().iter().zip(formula.values().reads()).any(|(place, reads)| *place == Place::Time && reads);
    };
    each_formula(model, |_, _, formula, places| look(formula, places));
    functionals.iter().for_each(|own| own.each_formula(model, |formula, _, places| look(formula, places)));
    reads
}

#[derive(Default)]
struct Measured {
    at: VectorsAvq<f64>,
    mu: Vec<f64>,
}

fn keep(own: &mut Option<StepRecord<f64>>, step: Option<&StepRecord<f64>>) {
    match (own.as_mut(), step) {
        (Some(own), Some(step)) => own.clone_from(step),
        (_, step) => *own = step.cloned(),
    }
}

/// So many adjoints of solutions, all zero, in the memory that is there.
fn set_zero_bars(seeds: &mut Vec<SolutionSeed>, count: usize, (dofs, multipliers): (usize, usize)) {
    seeds.resize_with(count, SolutionSeed::default);
    for SolutionSeed { x, mu } in seeds {
        set_zeros(x, dofs);
        set_zeros(mu, multipliers);
    }
}

/// Adds the adjoints of a state (q, v) to those that are carried on.
fn carry(bases: &[VectorsAvq<f64>], back: &mut [Backward]) {
    for (back, base) in back.iter_mut().zip(bases) {
        add(&mut back.carried[0], 1.0, &base.q);
        add(&mut back.carried[1], 1.0, &base.v);
    }
}

/// Takes out the adjoints of the accelerations and multipliers that were carried into a step and solved for at its start.
fn take_carried_acceleration(table: &Table, back: &mut [Backward]) -> Vec<SolutionSeed> {
    back.iter_mut()
        .map(|back| {
            let mut x = vec![0.0; back.carried[0].len()];
            for (bar, _) in back.carried.iter_mut().zip(&table.carried).filter(|(_, kind)| **kind == Carried::A) {
                add(&mut x, 1.0, bar);
                bar.fill(0.0);
            }
            let mu = std::mem::take(&mut back.mu);
            back.mu = vec![0.0; mu.len()];
            SolutionSeed { x, mu }
        })
        .collect()
}
