//! One step of any table at any constraint level: stages, update, projections.

use super::Counters;
use super::checkpoint::{Checkpoint, StepState};
use super::crossings::Place;
use super::events::{Choice, Directions, Events, Hit, Moment, SideChange};
use super::grid::{Clocks, beside, clock_at};
use super::initial_guess::{InitialGuess, solve};
use super::march::{Method, Problem, Run, add_scaled, embedded_difference};
use super::newton::{Newton, NewtonTolerance};
use super::record::{SolveRecord, StageRecord, StartRecord, StepRecord};
use super::redundancy::{KEPT, Watch, dependent_equations, violated};
use super::resolution::{Measures, Resolution, StepErrors, is_smooth};
use super::resting_start::RestingStart;
use super::slipping::set;
use super::start::check_velocities;
use super::steady_turn;
use super::step_points::StepRule;
use super::{
    Carried, ConstraintLevel, InitialState, Pause, RestingPlan, RunError, Scheme, Stability, StabilityCourse, StartPlan,
    StepSizeState, Table, TimeGrid, Verdict, unit_part,
};
use crate::assembly::{
    Clock, Closing, ConstraintRows, Equations, Residual, StageSystem, Stop, System, Unknowns, VectorsAvq,
};
use crate::design::shortest;
use crate::elements::{RunScalar, State};
use crate::linalg::sign_of_determinant;
use crate::program::Excess;
use crate::tolerances::CONSISTENT;
use std::sync::Arc;

/// A run that is taken step by step, and can go on from a [`Checkpoint`].
pub struct Stepper<'m, S> {
    pub(super) problem: &'m Problem<'m, S>,
    pub(super) method: &'m Method,
    /// Parameters, with the sides of switches.
    pub(super) p: Vec<S>,
    /// Switches at which steps end, if there are any.
    pub(super) events: Option<Box<Events>>,
    constrained: bool,
    /// How often in a row a switch has passed shortly behind itself.
    pub(super) close_by: usize,
    /// What the step made last would have lasted without an event \[s\].
    pub(super) planned: f64,
    /// Time that is left to the next breakpoint \[s\].
    pub(super) stretch: f64,
    /// Multipliers at the start of the step made last.
    mu_before: Vec<f64>,
    /// Forces of contacts that slip, when they were looked into last.
    pub(super) watched: Vec<f64>,
    /// Directions in which surfaces slip, of two velocities, with their derivative parts.
    pub(super) directions: Vec<Directions<S>>,
    /// Time just behind the end of the step made last, where forces jump at a breakpoint there \[s\].
    behind: Option<f64>,
    /// Multipliers by which events at the end of the step made last happen.
    pub(super) forces: Vec<f64>,
    /// Which stops hold behind the step made last, as far as it is known.
    choice: Choice,
    /// Solvers that were not used, without some equations each.
    analyses: Vec<(Vec<usize>, Newton<'m, S>)>,
    acceleration: Newton<'m, S>,
    stage: Newton<'m, S>,
    start: Newton<'m, S>,
    /// Whether other redundant equations may be chosen.
    chooses: bool,
    /// Before the step, where that may happen.
    before: StepState<S>,
    watch: Watch<S>,
    /// Work done with other choices of redundant equations.
    earlier: Counters,
    pub(super) between: StepState<S>,
    pub(super) record: StepRecord<S>,
    resolution: Resolution<S>,
    drives: Option<RealDrives>,
    difference: Vec<S>,
    /// How time goes, where derivative parts move the ends of steps, and the clock by which what is carried is measured; that of the next step, where
    /// it starts or ends at an event.
    pub(super) clocks: Clocks<S>,
    pub(super) clock: Option<Clock<S>>,
    pub(super) own_clock: Option<Clock<S>>,
    /// Derivative parts of the length of the next step, where it is Euler's.
    pub(super) lengthened: Option<S>,
}

struct RealDrives {
    rows: ConstraintRows,
    q: Vec<f64>,
    p: Vec<f64>,
    /// Pose and time before the step made last, if its side is not known.
    before: Option<(Vec<f64>, f64)>,
    determinants: usize,
}

impl RealDrives {
    /// The side on which the mechanism is in a pose.
    fn side<S: RunScalar>(&mut self, system: &System, q: &[S], t: f64) -> f64 {
        self.determinants += 1;
        self.q.clear();
        self.q.extend(q.iter().map(|q| q.value()));
        sign_of_determinant(self.rows.evaluate(system, (&self.q, &self.p), t))
    }
}

/// Steps from one look at the choice of redundant equations to the next.
const WATCHED_EVERY: usize = 5;
/// Takes off a list of changes what stands behind the first mark in it, with that.
fn behind_mark(changes: &mut Vec<SideChange>) -> Vec<SideChange> {
    let mark = changes.iter().skip(1).position(SideChange::is_mark).map_or(changes.len(), |place| place + 1);
    changes.split_off(mark)
}

/// Most events that follow each other at one time.
const MOST_AT_ONCE: usize = 100;
/// Most stops that begin to hold, or let go, one after the other by their forces at one time.
const MOST_EXCHANGED: usize = 1000;
/// Share of the force that makes an impact within a step, below which what is hit is not pushed away from.
pub(super) const NO_FORCE: f64 = 1e-9;
/// Share of the estimated error of a step that its systems may leave, where round-off is not asked for.
const LEFT: f64 = 1e-2;
/// Share of a step within which a stop that is hit and hit again comes to rest: infinitely many hits follow within a multiple of it.
const LAST_HIT: f64 = 1e-4;
/// Largest coefficient with which dropped equations may follow from the kept ones.
const WEAK: f64 = 10.0;

/// Whether the error of a step is estimated: not of methods of higher order than the trapezoidal rule without an embedded solution.
fn is_estimated(table: &Table) -> bool {
    !table.is_static() && (table.embedded.is_some() || table.order <= 2)
}

/// What the systems of a step of size `h` may leave in coordinates, velocities and projected coordinates: less than those of a longer step
/// before. Equations that are left out are watched by the violation of the others.
fn allowed<S>(table: &Table, state: &StepState<S>, h: f64, length: f64) -> Option<[f64; 3]> {
    let [q, v, of] = state.allowed?;
    let order = table.embedded.as_ref().map_or(3, |embedded| embedded.order as i32 + 1);
    let shorter = (h / of).min(1.0).powi(order);
    let watched = if state.dropped.is_empty() { f64::INFINITY } else { KEPT * length };
    Some([q * shorter, v * shorter, (q * shorter).min(watched)])
}

#[derive(Clone, Copy)]
struct StepStart {
    /// At a breakpoint: earlier steps do not foretell this one.
    breakpoint: bool,
    /// With the acceleration solved anew.
    solves: bool,
}

/// Gives back the memory of a solver before the next one is used: it may be large.
fn release<S: RunScalar>(newton: &mut Newton<S>) -> Result<(), RunError> {
    newton.release().map_err(|singular| RunError::of_pattern("start", singular))
}

/// Largest of some numbers, or one.
pub(super) fn size<S: RunScalar>(values: &[S]) -> f64 {
    values.iter().fold(1.0, |size: f64, own| size.max(own.value().abs()))
}

pub(super) fn real<S: RunScalar>(values: &[S]) -> Vec<f64> {
    values.iter().map(|value| value.value()).collect()
}

fn solvers<'m, S: RunScalar>(method: &Method, system: &Arc<System<'m>>) -> Result<[Newton<'m, S>; 3], RunError> {
    let acceleration = newton(method, system)?;
    let clone = || acceleration.clone_analysis().map_err(|singular| RunError::of_pattern("start", singular));
    let (stage, start) = (clone()?, clone()?);
    let mut all = [acceleration, stage, start];
    all.iter_mut().for_each(|newton| newton.counters = Counters::measuring(method.measures_phases));
    Ok(all)
}

pub(super) fn newton<'m, S: RunScalar>(method: &Method, system: &Arc<System<'m>>) -> Result<Newton<'m, S>, RunError> {
    let newton = Newton::new(system.clone(), method.tolerance, method.backend).map(Newton::divided);
    newton.map_err(|singular| RunError::of_pattern("start", singular))
}

impl<'m, S: RunScalar> Stepper<'m, S> {
    pub fn new(
        problem: &'m Problem<'m, S>,
        method: &'m Method,
        system: &Arc<System<'m>>,
        plan: &StartPlan,
    ) -> Result<Self, RunError> {
        let [acceleration, stage, start] = solvers(method, system)?;
        let dropped = system.options.dropped.clone();
        let events =
            method.ends_at_switches(problem.model).then(|| Events::new(problem.model)).filter(|events| !events.is_empty());
        Ok(Stepper {
            problem,
            method,
            p: problem.p.clone(),
            events: events.map(Box::new),
            constrained: system.is_constrained(),
            close_by: 0,
            planned: 0.0,
            stretch: 0.0,
            mu_before: Vec::new(),
            watched: Vec::new(),
            behind: None,
            directions: vec![Directions::default(); problem.model.frictions.len()],
            forces: Vec::new(),
            choice: Choice::default(),
            analyses: Vec::new(),
            acceleration,
            stage,
            start,
            chooses: plan.choose_again,
            before: StepState::default(),
            watch: Watch::default(),
            earlier: Counters::default(),
            between: StepState { dropped, ..StepState::default() },
            record: StepRecord::default(),
            resolution: Resolution::default(),
            drives: None,
            difference: Vec::new(),
            clocks: Vec::new(),
            clock: None,
            own_clock: None,
            lengthened: None,
        })
    }

    pub fn counters(&self) -> Counters {
        let mut counters = self.earlier;
        for newton in [&self.acceleration, &self.stage, &self.start] {
            counters += newton.counters;
        }
        counters
    }

    pub fn next_step(&self) -> usize {
        self.between.step
    }

    pub fn checkpoint(&self) -> Checkpoint<S> {
        let mut checkpoint = Checkpoint::default();
        self.checkpoint_in(&mut checkpoint);
        checkpoint
    }

    pub fn checkpoint_in(&self, checkpoint: &mut Checkpoint<S>) {
        checkpoint.between.clone_from(&self.between);
        for (newton, kept) in [&self.acceleration, &self.stage].into_iter().zip(&mut checkpoint.kept) {
            newton.keep_in(kept);
        }
    }

    /// Goes on from a checkpoint: the steps that follow are those of the run that left it, bit by bit.
    pub fn resume(&mut self, checkpoint: &Checkpoint<S>) -> Result<(), RunError> {
        self.between.clone_from(&checkpoint.between);
        self.write_sides();
        if self.between.chosen_anew {
            // nothing is kept from systems without other equations
            return self.renew(&checkpoint.between.dropped);
        }
        self.select(&checkpoint.between.dropped)?;
        let newtons = [&mut self.acceleration, &mut self.stage];
        for (newton, kept) in newtons.into_iter().zip(&checkpoint.kept) {
            newton.resume(kept, &self.p).map_err(|singular| {
                let place = format!("checkpoint before step {}", checkpoint.between.step + 1);
                let unknown = newton.system.unknown_name(singular.unknown, &newton.jacobian);
                RunError::singular(place, &unknown, "the checkpoint belongs to another problem")
            })?;
        }
        Ok(())
    }

    /// All that it takes to go on from the end of a step at a time [s].
    pub(super) fn pause(&self, t: f64, step_size: StepSizeState) -> Pause<S> {
        Pause {
            checkpoint: self.checkpoint(),
            t,
            step_size,
            errors: self.resolution.errors.clone(),
            counters: self.counters(),
        }
    }

    pub(super) fn take_up(&mut self, pause: &Pause<S>) -> Result<(), RunError> {
        self.resume(&pause.checkpoint)?;
        self.resolution.errors.clone_from(&pause.errors);
        for newton in [&mut self.acceleration, &mut self.stage, &mut self.start] {
            newton.counters = Counters::measuring(self.method.measures_phases);
        }
        self.earlier = pause.counters;
        Ok(())
    }

    /// Projects the start if the plan says so and solves for the first acceleration; before equilibria neither is needed: the first
    /// load step closes the joints, and what it starts from has no reactions yet.
    pub fn start(&mut self, t: f64, plan: &StartPlan, guide: Option<&StartRecord<f64>>) -> Result<StartRecord<S>, RunError> {
        let model = self.problem.model;
        let InitialState { mut q, mut v } = self.problem.start.clone();
        let is_static = self.method.table.is_static();
        let equilibrium = match &plan.equilibrium {
            Some(resting) => Some(self.come_to_rest(resting, t, [&mut q, &mut v], guide)?),
            None => None,
        };
        if equilibrium.is_some() {
            model.spin_velocities(&q, &self.p, &mut v);
        }
        let mut projections = [None, None];
        if plan.project && self.constrained && !is_static {
            projections = self.project_start([&mut q, &mut v], equilibrium.is_some(), guide)?;
        }
        if equilibrium.is_some() && guide.is_none() {
            self.check_velocities(&q, &v)?;
        }
        self.clock = clock_at(&self.clocks, 0);
        if let Some(clock) = self.clock {
            v.iter_mut().for_each(|v| *v *= clock.length());
        }
        let mut sides = match (&mut self.events, guide) {
            (Some(_), Some(guide)) => guide.sides.clone(),
            (Some(events), None) => {
                let [q, v, p] = [&q, &v, &self.p].map(|values| real(values));
                events.sides(Moment { a: &vec![0.0; q.len()], v: &v, q: &q, mu: [&[]; 2], t }, &p)
            }
            (None, _) => Vec::new(),
        };
        let dropped = match guide {
            Some(guide) => guide.dropped.clone(),
            None => self.held_at_start((&q, &v), t, plan, &mut sides)?,
        };
        self.select(&dropped)?;
        self.between.sides.clone_from(&sides);
        let axes = self.axes_at_start((&q, &v), &dropped);
        self.write_sides();
        let mut first = SolveRecord::default();
        let mut guessed = Vec::new();
        if is_static {
            first.t = t;
            first.base = VectorsAvq { a: vec![S::zero(); model.dofs], v: v.clone(), q: q.clone() };
            Residual::shape(&self.acceleration.system, &mut first.unknowns, true);
            if guide.is_none() {
                guessed = self.start.reactions_at_release(&first.base, &self.p, t).mu;
                release(&mut self.start)?;
            }
        } else {
            let from = InitialGuess::guided(guide.map(|start| &start.acceleration));
            self.solve_acceleration((&q, &v), t, 0, from, &mut first)?;
            if guide.is_none() && self.passes_at_start((&first, &q, &v), t, &mut sides)? {
                self.between.sides.clone_from(&sides);
                self.write_sides();
                self.solve_acceleration((&q, &v), t, 0, InitialGuess::Zero, &mut first)?;
            }
        }
        release(&mut self.acceleration)?;
        let kinds = &self.method.table.carried;
        // older vectors are read only after as many steps have written them
        let mut carried = vec![q, v];
        carried.resize_with(kinds.len(), || vec![S::zero(); model.dofs]);
        let mut last = Unknowns::default();
        Residual::shape(&self.stage.system, &mut last, true);
        self.between = StepState { dropped: dropped.clone(), sides: sides.clone(), carried, last, ..StepState::default() };
        self.between.set_acceleration(kinds, &first);
        self.resolution.begin(t, &first.unknowns.x);
        let watched = guide.is_none() && !is_static;
        let (rows, is_driven) = ConstraintRows::new(&self.acceleration.system);
        let p = || self.p.iter().map(|p| p.value()).collect();
        self.drives =
            (is_driven && watched).then(|| RealDrives { rows, q: Vec::new(), p: p(), before: None, determinants: 0 });
        if let Some(drives) = &mut self.drives {
            self.resolution.errors.orientation = drives.side(&self.acceleration.system, &first.base.q, t);
        }
        if !guessed.is_empty() {
            self.between.last.mu = guessed;
        }
        let [position_projection, velocity_projection] = projections;
        let clock = self.clock;
        Ok(StartRecord {
            dropped,
            sides,
            clock,
            equilibrium,
            position_projection,
            velocity_projection,
            acceleration: first,
            axes,
        })
    }

    /// Changes sides whose numbers are zero at the start and leave it by the first accelerations; whether there are any.
    fn passes_at_start(
        &mut self,
        (first, q, v): (&SolveRecord<S>, &[S], &[S]),
        t: f64,
        sides: &mut [f64],
    ) -> Result<bool, RunError> {
        let Some(mut events) = self.events.take() else { return Ok(false) };
        let [a, mu] = [&first.unknowns.x, &first.unknowns.mu].map(|values| real(values));
        let [q, v, p] = [q, v, &self.p].map(real);
        let moment = Moment { a: &a, v: &v, q: &q, mu: [&mu, &[]], t };
        let excesses = events.excesses(moment, &p, sides);
        // which way surfaces slip is known
        let own = excesses.into_iter().enumerate().filter(|(switch, _)| !events.is_end_of_slip(*switch));
        let passed = own.filter(|(_, own)| own.by.abs() <= own.noise(t) && own.rate > 0.0);
        let passed: Vec<(usize, f64)> = passed.map(|(switch, own)| (switch, own.other)).collect();
        passed.iter().for_each(|(switch, other)| sides[*switch] = *other);
        if let Some(own) = events.released((sides, sides), moment, &p, NO_FORCE * size(&first.unknowns.mu)) {
            let name = events.part_of(own.switch);
            return Err(RunError::Input(format!("the {name} is due at the start: its force is beyond the strength there")));
        }
        self.events = Some(events);
        Ok(!passed.is_empty())
    }

    /// Closes the stops at which the motion begins at rest and that push there; returns the equations that are left out then.
    fn held_at_start(
        &mut self,
        (q, v): (&[S], &[S]),
        t: f64,
        plan: &StartPlan,
        sides: &mut [f64],
    ) -> Result<Vec<usize>, RunError> {
        let Some(events) = self.events.take() else { return Ok(plan.dropped.clone()) };
        self.check_frictions(&events, plan)?;
        let mut closed = Vec::new();
        for (event, joint, stop) in events.stops() {
            let [g, rate, _] = self.equations_of(joint, (&[], v, q), t)[0];
            let is_there = g.abs() <= CONSISTENT * size(q);
            if is_there {
                events.free(event, stop, sides).into_iter().for_each(|own| sides[own.switch] = own.sides[1]);
            } else if events.is_beyond(event, stop, sides) {
                let name = events.name(event);
                return Err(RunError::Input(format!(
                    "the start lies beyond the limit of the stop \"{name}\", by {:.3e}: start on the side that it leaves free",
                    g.abs()
                )));
            }
            let is_outwards = if stop.is_upper { rate > 0.0 } else { rate < 0.0 };
            if is_there && is_outwards && rate.abs() > CONSISTENT * size(v) {
                let name = events.name(event);
                return Err(RunError::Input(format!(
                    "the motion begins at the limit of the stop \"{name}\" and moves on beyond it, by {rate:.3e} 1/s: start before the hit, or with what \
                     follows from it"
                )));
            }
            if is_there && rate.abs() <= CONSISTENT * size(v) && sides[events.presence(joint)] == 0.0 {
                closed.push((joint, stop));
            }
        }
        if let Some(joint) = events.latches().find(|joint| {
            let is_at = |own: &[f64; 3]| own[0].abs() <= CONSISTENT * size(q);
            sides[events.presence(*joint)] == 0.0 && self.equations_of(*joint, (&[], v, q), t).iter().all(is_at)
        }) {
            let name = &self.problem.model.constraints[joint].name;
            return Err(RunError::Input(format!(
                "the motion begins where the latch \"{name}\" holds: start beside it, or hold it by a [[joint]] that an [[event]] removes"
            )));
        }
        self.between.dropped.clone_from(&plan.dropped);
        self.between.carried = vec![q.to_vec(), v.to_vec()];
        let mut sticking = self.frictions_at_start(&events, (q, v), t, (sides, &closed))?;
        let dropped = loop {
            let rows = |joint: usize| self.problem.model.constraints[joint].equations.clone();
            let held = closed.iter().map(|own| own.0).chain(sticking.iter().map(|own| events.friction(*own).joints[1]));
            let held: Vec<usize> = held.flat_map(rows).collect();
            let mut dropped = plan.dropped.clone();
            dropped.retain(|row| !held.contains(row));
            let without = dropped.clone();
            if held.is_empty() {
                break dropped;
            }
            let rows = |joint: usize| self.problem.model.constraints[joint].equations.clone();
            let own: Vec<usize> = sticking.iter().flat_map(|own| rows(events.friction(*own).joints[1])).collect();
            let mut dropped = self.left_out_of(&dropped, (q, v), t, &own);
            events.write_directions(sides, &mut self.p);
            let axes = self.axes(&events, sides, &dropped);
            let aligned = self.align(&events, &axes, sides);
            if !aligned.is_empty() {
                set(&aligned, sides);
                events.write_directions(sides, &mut self.p);
                dropped = self.left_out_of(&without, (q, v), t, &own);
            }
            if let Some(place) = sticking.iter().position(|own| self.is_driven(&events, *own, &dropped, ((q, v), t))) {
                let friction = sticking.remove(place);
                set(&self.turns(&events, friction, (vec![1.0], [0.0; 2]), sides), sides);
                continue;
            }
            let mu = self.forces_at((q, v), t, &dropped)?;
            let rows = |joint: usize| self.problem.model.constraints[joint].equations.clone();
            if let Some(place) = closed.iter().position(|(joint, stop)| !stop.pushes(mu[rows(*joint).start])) {
                let (joint, _) = closed.remove(place);
                for friction in (0..events.frictions().len()).filter(|own| events.friction(*own).joints[0] == joint) {
                    sticking.retain(|own| *own != friction);
                    set(&self.stands(&events, friction, sides), sides);
                }
                continue;
            }
            let state = [real(v), real(q)];
            let p = real(&self.p);
            let moment = Moment { a: &[], v: &state[0], q: &state[1], mu: [&mu, &[]], t };
            let exceeds = |own: &usize| events.exceeds(*own, moment, &p, 0.0);
            match sticking.iter().position(exceeds) {
                Some(place) => {
                    let friction = sticking.remove(place);
                    set(&self.slips(&events, friction, &mu, sides), sides);
                }
                None => break dropped,
            }
        };
        for (joint, stop) in closed {
            sides[events.presence(joint)] = 1.0;
            events.pushing(joint, stop, sides).into_iter().for_each(|own| sides[own.switch] = own.sides[1]);
        }
        for friction in sticking {
            set(&self.sticks(&events, friction, sides), sides);
        }
        events.write_directions(sides, &mut self.p);
        let held = self.held_by_others(&events, sides, (q, v), t)?;
        set(&held, sides);
        events.write_directions(sides, &mut self.p);
        self.check_contacts(&events, sides, (q, v), t)?;
        self.events = Some(events);
        Ok(dropped)
    }

    /// Moves coordinates and velocities to where the constraints hold; the joints of an equilibrium are closed.
    fn project_start(
        &mut self,
        [q, v]: [&mut Vec<S>; 2],
        is_closed: bool,
        guide: Option<&StartRecord<f64>>,
    ) -> Result<[Option<SolveRecord<S>>; 2], RunError> {
        let (zeros, mut made) = (vec![S::zero(); self.problem.model.dofs], [None, None]);
        let kinds = [Equations::initial_position_projection(), Equations::initial_velocity_projection()];
        for (order, equations) in kinds.into_iter().enumerate().skip(usize::from(is_closed)) {
            let velocities = if order == 0 { &zeros } else { &*v };
            let own = made[order].insert(SolveRecord::default());
            own.equations = equations;
            own.base = VectorsAvq { a: zeros.clone(), v: velocities.clone(), q: q.clone() };
            let guides = guide.map(|start| [&start.position_projection, &start.velocity_projection]);
            let from = InitialGuess::guided(guides.and_then(|guides| guides[order].as_ref()));
            solve(&mut self.start, own, from, &self.p, &|| "projection of the start (t = 0 s)".into())?;
            add_scaled(if order == 0 { &mut *q } else { &mut *v }, &own.unknowns.x, 1.0);
        }
        release(&mut self.start)?;
        Ok(made)
    }

    fn come_to_rest(
        &mut self,
        plan: &RestingPlan,
        t: f64,
        [q, v]: [&mut [S]; 2],
        guide: Option<&StartRecord<f64>>,
    ) -> Result<SolveRecord<S>, RunError> {
        let guide = guide.and_then(|start| start.equilibrium.as_ref());
        let RestingStart { record, stability, counters } = RestingStart::find(self.problem, self.method, plan, t, guide)?;
        self.earlier += counters;
        self.resolution.errors.stability = stability.map(|end| StabilityCourse { end, lost: None });
        self.problem.model.at_rest(&plan.stays).set_motion(&record.point().q, q, v);
        Ok(record)
    }

    /// Velocities were given for other coordinates than those of the equilibrium.
    fn check_velocities(&self, q: &[S], v: &[S]) -> Result<(), RunError> {
        let start = InitialState { q: real(q), v: real(v) };
        let problem = Problem { model: self.problem.model, p: real(&self.p), start };
        check_velocities(&problem, &self.method.table)?;
        steady_turn::check(problem.model, &problem.p, [&problem.start.q, &problem.start.v])
    }

    pub(super) fn end(self, rejected: usize) -> Run<S> {
        let counters = self.counters();
        let q = self.between.carried.into_iter().next().unwrap_or_default();
        let determinants = self.drives.map_or(0, |drives| drives.determinants);
        let StepErrors { leap, stability, .. } = self.resolution.errors;
        Run { q, rejected, counters, error: self.resolution.worst(), leap, determinants, stability }
    }

    pub(super) fn note_error(&mut self) {
        let (stage, round_off) = (&self.stage, self.stage.measured_round_off());
        let measures = Measures { scales: &stage.coordinate_scales, length: stage.length, round_off };
        self.resolution.note(&self.method.table, self.between.step, &self.record, &measures);
        self.note_side(self.record.t + self.record.h);
    }

    /// Whether the equilibrium at the end of the step made last stands; `None` of motions.
    pub(super) fn stability(&mut self) -> Option<Stability> {
        (self.method.table.is_static() && S::PARTS == 0).then(|| self.stage.stability())
    }

    /// Whether such an equilibrium leads away in more directions than the one before: it may lie on another branch than the path.
    pub(super) fn loses(&self, stability: Option<Stability>) -> bool {
        let before = self.resolution.errors.stability.map_or(0, |course| course.end.negative);
        stability.is_some_and(|end| end.verdict() == Verdict::Unstable && end.negative > before)
    }

    pub(super) fn note_stability(&mut self, stability: Option<Stability>) {
        let Some(end) = stability else { return };
        let here = ([self.record.t, self.record.t + self.record.h], self.between.step);
        let course = &mut self.resolution.errors.stability;
        let lost = course.and_then(|course| course.lost);
        let is_unstable = end.verdict() == Verdict::Unstable;
        *course = Some(StabilityCourse { end, lost: lost.or(is_unstable.then_some(here)) });
    }

    /// Takes note of the branch on which a driven mechanism is, where the step made last may have left it.
    fn note_side(&mut self, end: f64) {
        if self.between.chosen_anew || self.method.table.is_static() {
            return self.resolution.forget_side();
        }
        let Some(drives) = &mut self.drives else { return };
        let (before, after) = (&self.record.carried, &self.between.carried);
        let StepRecord { t, h, .. } = self.record;
        if is_smooth([&before[0], &before[1]], [&after[0], &after[1]], h, &self.stage.coordinate_scales) {
            let (mut pose, _) = drives.before.take().unwrap_or_default();
            pose.clear();
            pose.extend(before[0].iter().map(|q| q.value()));
            drives.before = Some((pose, t));
            return;
        }
        let system = &self.acceleration.system;
        let mut start = drives.side(system, &before[0], t);
        // behind a pose that is singular the side before it is the one to compare with
        if let Some((pose, t)) = drives.before.take().filter(|_| start == 0.0) {
            start = drives.side(system, &pose, t);
        }
        let end = drives.side(system, &after[0], end);
        self.resolution.note_sides([start, end], (t, self.between.step));
    }

    pub fn record(&self) -> &StepRecord<S> {
        &self.record
    }

    pub fn step(&mut self, grid: &TimeGrid, guided: Option<&StepRecord<f64>>) -> Result<&StepRecord<S>, RunError> {
        let index = self.between.step;
        let scheme = self.method.table.scheme_at(grid, index);
        self.step_over(scheme, grid.span(index), grid.is_interrupted(index), guided)?;
        if let Some(changes) = grid.events.get(&(index + 1)) {
            self.pass(changes.clone(), true)?;
        } else if let Some(jumps) = grid.jumps.get(&(index + 1)) {
            self.pass_at(grid.times[index + 1], jumps.clone(), true)?;
        }
        Ok(&self.record)
    }

    /// Makes the next step from the first to the second time; at a breakpoint an acceleration that is carried is solved anew before it.
    ///
    /// Where redundant equations are left out and the step fails, or those equations are violated after it, others are left out from
    /// its beginning on. After an error only [`Stepper::resume`] is of use.
    pub(super) fn step_over(
        &mut self,
        scheme: Scheme,
        span: (f64, f64),
        breakpoint: bool,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<(), RunError> {
        if let Some(step) = guided {
            self.select(&step.dropped)?;
            self.between.dropped.clone_from(&step.dropped);
        }
        let chosen_anew = std::mem::take(&mut self.between.chosen_anew);
        let absent = self.absent();
        let start = StepStart {
            breakpoint,
            solves: guided.map_or(chosen_anew || breakpoint && self.carries_acceleration(), |step| step.restart.is_some()),
        };
        if chosen_anew {
            let dropped = self.between.dropped.clone();
            self.select(&dropped)?;
        }
        if guided.is_some() || !self.chooses || self.between.dropped == absent {
            return self.try_step(scheme, span, start, guided);
        }
        let mut before = std::mem::take(&mut self.before);
        before.clone_from(&self.between);
        let mut result = self.try_step(scheme, span, start, None).and_then(|()| self.check_dropped(span.1));
        if result.is_err() {
            let (q, v, count) = (&before.carried[0], &before.carried[1], before.dropped.len());
            let dropped = dependent_equations(self.problem, &absent, (q, v), span.0, Some(count));
            if dropped != before.dropped {
                self.select(&dropped)?;
                self.earlier.choices += 1;
                self.between.clone_from(&before);
                self.between.dropped = dropped;
                result = self
                    .try_step(scheme, span, StepStart { solves: true, ..start }, None)
                    .and_then(|()| self.check_dropped(span.1));
            }
        }
        self.before = before;
        result.and_then(|()| self.exchange(span.1))
    }

    /// Leaves out another equation where a dropped one follows from the kept ones with a coefficient above [`WEAK`]: these are then
    /// nearly dependent, and errors of the stages grow by it. Exchanging the two makes them more independent by this factor.
    fn exchange(&mut self, t: f64) -> Result<(), RunError> {
        let absent = self.absent();
        let StepState { step, dropped, carried, chosen_anew, .. } = &mut self.between;
        if !step.is_multiple_of(WATCHED_EVERY) {
            return Ok(());
        }
        if self.start.system.options.dropped != *dropped {
            self.start = newton(self.method, &self.method.system(self.problem.model, dropped))?;
        }
        let (q, v) = (&carried[0], &carried[1]);
        let p = &self.p;
        if self.start.factor_accelerations((q, v), p, t).is_err() {
            let others = dependent_equations(self.problem, &absent, (q, v), t, Some(dropped.len()));
            (*chosen_anew, *dropped) = (others != *dropped, others);
            self.earlier.choices += usize::from(self.between.chosen_anew);
            return Ok(());
        }
        let start = &mut self.start;
        let are_there = dropped.iter().enumerate().filter(|(_, row)| absent.binary_search(row).is_err());
        let weakest = are_there.filter_map(|(place, &equation)| {
            let (kept, coefficient) = start.largest_coefficient(equation, q, p, t)?;
            Some((place, kept, coefficient.abs()))
        });
        if let Some((place, kept, coefficient)) = weakest.max_by(|a, b| a.2.total_cmp(&b.2))
            && coefficient > WEAK
        {
            dropped[place] = kept;
            dropped.sort_unstable();
            *chosen_anew = true;
            self.earlier.choices += 1;
        }
        Ok(())
    }

    fn check_dropped(&mut self, t: f64) -> Result<(), RunError> {
        let absent = self.absent();
        let StepState { step, dropped, carried, .. } = &self.between;
        let worst = self.watch.worst(self.problem.model, &self.p, [dropped, &absent], &carried[0], t);
        worst
            .map_or(Ok(()), |worst| Err(violated(self.problem.model, format!("step {step} (t = {} s)", shortest(t)), worst)))
    }

    fn select(&mut self, dropped: &[usize]) -> Result<(), RunError> {
        if self.acceleration.system.options.dropped == dropped { Ok(()) } else { self.renew(dropped) }
    }

    fn renew(&mut self, dropped: &[usize]) -> Result<(), RunError> {
        self.earlier = self.counters();
        let sizes = std::mem::take(&mut self.stage.run_sizes);
        [self.acceleration, self.stage, self.start] =
            [self.analysis(dropped)?, self.analysis(dropped)?, self.analysis(dropped)?];
        if S::PARTS > 0 {
            // what a derivative has come to be round-off of
            self.stage.run_sizes = sizes;
        }
        Ok(())
    }

    /// Equations of joints that are not there, and those of what sticks that hold by all others: none of these takes the place of another one.
    fn absent(&self) -> Vec<usize> {
        let model = self.problem.model;
        let Some(events) = &self.events else { return Vec::new() };
        let mut absent = events.absent(&self.between.sides);
        let sticks =
            |row: &usize| model.frictions.iter().any(|own| model.constraints[own.joints[1]].equations.contains(row));
        let left_out: Vec<usize> =
            self.between.dropped.iter().copied().filter(|row| sticks(row) && !absent.contains(row)).collect();
        absent.extend(left_out);
        absent.sort_unstable();
        absent
    }

    fn write_sides(&mut self) {
        if let Some(events) = &self.events {
            events.write(&self.between.sides, &mut self.p);
            events.write_turned(&self.directions, &mut self.p);
        }
    }

    /// Goes over to other sides of switches at the end of the step made last, and lets events happen: returns all sides that change, and whether the
    /// run ends there. What events set may change more of them, unless the changes are those of a run that is made again.
    pub(super) fn pass(
        &mut self,
        changes: Vec<SideChange>,
        is_made_again: bool,
    ) -> Result<(Vec<SideChange>, bool), RunError> {
        let Some(mut events) = self.events.take() else { return Ok((changes, false)) };
        let before = self.between.sides.clone();
        let axes: Vec<Vec<S>> = (0..self.directions.len()).map(|own| self.axis(&events, own, &before)).collect();
        let made = self.pass_with(&mut events, changes, is_made_again);
        if S::PARTS > 0 {
            self.follow_directions(&events, &before, &axes);
        }
        self.events = Some(events);
        self.write_sides();
        if made.as_ref().is_ok_and(|(changes, _)| !changes.is_empty()) {
            // matrices of the other sides are of no use
            [&mut self.acceleration, &mut self.stage].into_iter().for_each(Newton::forget_factors);
        }
        made
    }

    /// Whether changes are those by which a force lets go, or a driver goes on another way.
    pub(super) fn is_jump(&self, changes: &[SideChange]) -> bool {
        let (Some(events), Some(first)) = (&self.events, changes.first()) else { return false };
        (0..events.frictions().len()).any(|own| events.is_of(own, first.switch)) || events.is_release(first.switch)
    }

    /// Whether a joint is there that a force may remove.
    pub(super) fn may_release(&self) -> bool {
        self.events
            .as_ref()
            .is_some_and(|events| events.frictions().len() > 0 || events.release_of(&self.between.sides).is_some())
    }

    /// Whether a switch is one of a force that is none.
    pub(super) fn has_no_force(&self, switch: usize, own: &Excess) -> bool {
        let is_release = self.events.as_ref().is_some_and(|events| events.is_event(switch) && events.is_release(switch));
        is_release && own.by.abs() <= NO_FORCE * size(&self.between.forces)
    }

    /// Forces that tell no event at the end of the step made last are of no use to the way back.
    pub(super) fn forget_forces(&mut self) {
        self.record.forces = None;
    }

    /// Lets happen at a breakpoint, where forces jump, what these forces do just behind it; returns the sides that change.
    pub(super) fn pass_at(
        &mut self,
        t: f64,
        changes: Vec<SideChange>,
        is_made_again: bool,
    ) -> Result<Vec<SideChange>, RunError> {
        self.behind = Some(t);
        let made = self.pass(changes, is_made_again);
        self.behind = None;
        Ok(made?.0)
    }

    fn pass_with(
        &mut self,
        events: &mut Events,
        mut changes: Vec<SideChange>,
        is_made_again: bool,
    ) -> Result<(Vec<SideChange>, bool), RunError> {
        let before = self.between.sides.clone();
        self.choice = Choice::default();
        self.forces = real(&self.between.forces);
        // joints as far as it has come
        let mut present = before.clone();
        let (switch, located) = match self.behind {
            Some(t) => {
                let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
                self.forces = self.forces_at((&q, &v), t, &self.between.dropped.clone())?;
                (usize::MAX, 0.0)
            }
            None => self.located_number(events, &changes),
        };
        if !is_made_again {
            self.add_dependent(events, &mut changes);
        }
        if S::PARTS > 0 && self.behind.is_none() {
            self.check_together(events, &changes)?;
        }
        let (mut happened, mut ends_run, mut known) = (Vec::new(), false, 0);
        // forces are asked for until they change nothing
        let (mut settles, mut exchanged, mut holds) = (false, 0, false);
        let mut later = if is_made_again { behind_mark(&mut changes) } else { Vec::new() };
        loop {
            let ended = std::mem::replace(&mut known, changes.len());
            self.end_slips(events, ended, (&mut present, &mut changes), is_made_again);
            changes.iter().for_each(|own| self.between.sides[own.switch] = own.sides[1]);
            let switches = events.switches();
            present[..switches].copy_from_slice(&self.between.sides[..switches]);
            let all = events.happening(&changes, &before);
            let next = all.get(happened.len()..).unwrap_or_default().to_vec();
            if next.is_empty() && !later.is_empty() {
                set(&changes, &mut present);
                let behind = behind_mark(&mut later);
                changes.append(&mut later);
                later = behind;
                continue;
            }
            if next.is_empty() {
                // forces may jump where formulas pass to other pieces
                let is_first = happened.is_empty() && !is_made_again;
                let released = match is_first || settles {
                    true => self.released(events, (&mut present, &changes))?,
                    false => Vec::new(),
                };
                settles = !released.is_empty() && !is_made_again;
                exchanged += 1;
                if released.is_empty() {
                    break;
                } else if exchanged > MOST_EXCHANGED {
                    return Err(self.no_forces(&released, events));
                }
                holds |= released.iter().any(|own| own.switch >= switches);
                changes.extend(released);
                continue;
            }
            if happened.len() > MOST_AT_ONCE {
                let mut names: Vec<&str> = next.iter().map(|&event| events.name(event)).collect();
                names.dedup();
                return Err(RunError::Input(format!(
                    "at t = {} s events follow each other at once without end: \"{}\"; let what they set lead away from their conditions",
                    shortest(self.record.end),
                    names.join("\", \"")
                )));
            }
            let mut unhit = next.clone();
            for &event in &next {
                if !is_made_again && self.slips_after_all(events, event, (&mut present, &mut changes)) {
                    continue;
                }
                happened.push(event);
                ends_run |= events.ends_run(event);
                let mut left = present.clone();
                let removed =
                    events.joints_of(event).0.iter().filter_map(|&joint| events.presence_change(joint, false, &left));
                let removed: Vec<SideChange> = removed.collect();
                set(&removed, &mut left);
                let absent = events.absent(&left);
                let before = (!is_made_again && events.sets(event)).then(|| self.violations(&absent));
                self.reset(events, (event, happened.len() - 1)).map_err(RunError::Input)?;
                if let Some(before) = before {
                    self.check_joints(&absent, &before, events.name(event))?;
                }
                let number = happened.len() - 1;
                self.change_joints(events, (event, number), (&mut present, &mut changes), &mut unhit, is_made_again)?;
            }
            if !is_made_again {
                let released = self.released(events, (&mut present, &changes))?;
                settles = !released.is_empty();
                holds |= released.iter().any(|own| own.switch >= switches);
                changes.extend(released);
                changes.extend(next.iter().filter_map(|&event| events.has_happened(event)));
                for &event in &next {
                    let stops = events.stops_changed(event, &self.between.sides);
                    set(&stops, &mut self.between.sides);
                    changes.extend(stops);
                    self.check_brought(events, event)?;
                }
                let mut now = self.between.sides.clone();
                set(&changes, &mut now);
                let (sides, end) = (&self.between.sides, self.record.end);
                let passed = self.excesses_of(events, false).into_iter().enumerate();
                // the number that ended the step is zero, whatever location has left of it
                let is_zero = |own: &Excess| (own.by - located).abs() <= own.round_off(end);
                // what touches a stop hits it if it moves on, and rests there otherwise
                let is_passed = |place: usize, own: &Excess| {
                    let is_first = place == switch && is_zero(own);
                    match events.stop_hit_by(place) {
                        Some((joint, stop)) if is_first || own.by.abs() <= own.noise(end) => self.moves_on(joint, stop),
                        // forces are those before what has just come to hold
                        _ if settles && events.is_event(place) && events.is_release(place) => false,
                        _ if is_first => own.rate > 0.0,
                        _ => own.is_passed(end),
                    }
                };
                // of what has been opened nothing else happens
                let passed = passed.filter(|(place, own)| {
                    let may = (*place == switch && is_zero(own)) || !events.is_off(*place, &now) && !self.waits(*place);
                    may && is_passed(*place, own)
                });
                let passed = passed.map(|(switch, own)| SideChange { switch, sides: [sides[switch], own.other] });
                let passed: Vec<SideChange> = passed.collect();
                if !passed.is_empty() && std::mem::take(&mut holds) {
                    // a run that is made again holds by then what holds here
                    changes.push(events.mark(&now));
                }
                changes.extend(passed);
            }
        }
        // at a breakpoint drivers may go on another way
        if !is_made_again && (!happened.is_empty() || self.behind.is_some()) && events.frictions().len() > 0 {
            let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
            let directed = self.directed(events, &before, &self.between.sides);
            set(&directed, &mut self.between.sides);
            changes.extend(directed);
            let sides = self.between.sides.clone();
            changes.extend(self.held_by_others(events, &sides, (&q, &v), self.record.end)?);
            set(&changes, &mut self.between.sides);
        }
        if !happened.is_empty() && events.frictions().len() > 0 {
            let sides = self.between.sides.clone();
            let aligned = self.align_behind(events, &sides);
            changes.extend(aligned.into_iter().filter(|_| !is_made_again));
            set(&changes, &mut self.between.sides);
            events.write_directions(&self.between.sides, &mut self.p);
        }
        self.between.switched.clone_from(&changes);
        if !is_made_again && !happened.is_empty() && events.frictions().len() > 0 {
            let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
            let sides = self.between.sides.clone();
            events.write(&sides, &mut self.p);
            self.check_limits(events, (&q, &v), self.record.end)?;
            self.check_contacts(events, &sides, (&q, &v), self.record.end)?;
        }
        let now = events.absent(&self.between.sides);
        if events.absent(&before) != now {
            self.between.dropped = self.dropped_behind(&now);
            self.between.chosen_anew = true;
            // a mechanism with other joints is another one
            self.drives = None;
            self.resolution.forget_side();
        }
        Ok((changes, ends_run))
    }

    /// Changes at the end of the step made last that happen at the same time as the first one without being changed by it: their numbers have the rate
    /// that they had.
    pub(super) fn independent(&mut self, changes: &[SideChange]) -> Result<Vec<SideChange>, RunError> {
        let (Some(first), Some(events)) = (changes.first(), &self.events) else { return Ok(Vec::new()) };
        let [q, v] = [0, 1].map(|order| real(&self.between.carried[order]));
        let a = vec![0.0; q.len()];
        let (moment, p) = (Moment { a: &a, v: &v, q: &q, mu: [&[]; 2], t: self.record.end }, real(&self.p));
        let (alone, others): (Vec<SideChange>, Vec<SideChange>) =
            changes.iter().partition(|own| events.passes_with([first.switch, own.switch], moment, &p));
        if others.is_empty() {
            return Ok(others);
        }
        let all: Vec<SideChange> = [&alone[..1], &others].concat();
        let before = self.rates_behind(&all)?;
        let stays = |own: f64, after: f64| (after - own).abs() <= CONSISTENT * own.abs();
        let Some(after) = self.rates_if(&alone, &others, &others) else { return Ok(Vec::new()) };
        let stay = others.into_iter().zip(before[1..].iter().zip(after));
        let others: Vec<SideChange> = stay.filter(|(_, (own, after))| stays(**own, *after)).map(|own| own.0).collect();
        // nor do these change the first one
        let after = if others.is_empty() { None } else { self.rates_if(&others, &alone, &all[..1]) };
        Ok(if after.is_some_and(|after| stays(before[0], after[0])) { others } else { Vec::new() })
    }

    /// Rates behind some changes at the end of the step made last, while others wait; `None` if these cannot happen alone.
    fn rates_if(&mut self, changes: &[SideChange], waiting: &[SideChange], of: &[SideChange]) -> Option<Vec<f64>> {
        let kept = (self.between.clone(), self.record.clone(), self.p.clone(), self.directions.clone());
        self.between.waiting = waiting.to_vec();
        let rates = self.pass(changes.to_vec(), false).and_then(|_| self.rates_behind(of));
        (self.between, self.record, self.p, self.directions) = kept;
        rates.ok()
    }

    /// Whether a switch changes in the next step.
    fn waits(&self, switch: usize) -> bool {
        self.between.waiting.iter().any(|own| own.switch == switch)
    }

    /// Rates of the numbers of switches behind the step made last, as far as it has come; not a number of forces.
    fn rates_behind(&mut self, switches: &[SideChange]) -> Result<Vec<f64>, RunError> {
        let Some(mut events) = self.events.take() else { return Ok(Vec::new()) };
        events.write(&self.between.sides, &mut self.p);
        let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
        let dropped = self.dropped_behind(&events.absent(&self.between.sides));
        let solved = self.accelerations_at((&q, &v), self.record.end, &dropped);
        let rates = solved.map(|solved| {
            let [a, v, q] = [&solved.x, &v, &q].map(|own| real(own));
            let moment = Moment { a: &a, v: &v, q: &q, mu: [&[]; 2], t: self.record.end };
            let all = events.excesses(moment, &real(&self.p), &self.between.sides);
            let rate = |own: &SideChange| if events.is_release(own.switch) { f64::NAN } else { all[own.switch].rate };
            switches.iter().map(rate).collect()
        });
        self.events = Some(events);
        rates
    }

    /// Removes and adds the joints of an event at the end of the step made last, by the sides that hold as far as it has come; stops that events hit
    /// together are hit in one impact.
    fn change_joints(
        &mut self,
        events: &Events,
        (event, number): (usize, usize),
        (sides, changes): (&mut [f64], &mut Vec<SideChange>),
        unhit: &mut Vec<usize>,
        is_made_again: bool,
    ) -> Result<(), RunError> {
        let (opens, closes) = events.joints_of(event);
        for &joint in opens {
            if let Some(own) = events.presence_change(joint, false, sides) {
                sides[own.switch] = own.sides[1];
                changes.extend(Some(own).filter(|_| !is_made_again));
                self.opened(events, joint, (sides, changes), is_made_again)?;
            }
        }
        for own in closes {
            let mut all = vec![(event, own)];
            if own.stop.is_some() {
                let closing = |&event: &usize| events.joints_of(event).1.iter().map(move |own| (event, own));
                if !unhit.contains(&event) {
                    continue;
                }
                let others = unhit.iter().filter(|own| **own != event).flat_map(closing);
                all.extend(others.filter(|(_, own)| own.stop.as_ref().is_some_and(|stop| self.moves_on(own.joint, stop))));
                unhit.retain(|own| all.iter().all(|(event, _)| own != event));
            }
            let hit = |(event, own): (usize, &Closing)| self.hit_of(events, (event, own), (sides, changes), is_made_again);
            let hits: Vec<Hit> = all.into_iter().filter_map(hit).collect();
            if hits.is_empty() {
                continue;
            }
            let (impact, let_go) = self.close(events, &hits, number, (sides, changes), is_made_again)?;
            if own.stop.is_none() && !is_made_again {
                self.check_closing(own.joint)?;
            }
            let pace = self.clock.map_or(S::one(), |clock| clock.length());
            impact.add_to(&mut self.between.carried[1], &self.p, pace);
            for Hit { event, closing, joint, stop, restitution, .. } in hits {
                let is_held = restitution.is_none() && !let_go.contains(&joint);
                if !is_made_again {
                    changes.extend(Some(closing).filter(|own| is_held && !changes.contains(own)));
                    if restitution.is_none() && !is_held {
                        // it tells a run that is made again that it was hit without restitution
                        changes.extend([closing, SideChange { sides: [1.0, 0.0], ..closing }]);
                    }
                    if let Some(stop) = &stop {
                        changes.extend(events.free(event, stop, &self.between.sides));
                        changes.extend(events.pushing(joint, stop, &self.between.sides).filter(|_| is_held));
                    }
                }
                sides[closing.switch] = f64::from(u8::from(is_held));
            }
            self.record.impacts.push(impact);
        }
        Ok(())
    }

    /// Whether what passes at once at the end of the step made last does so in other designs, too.
    fn check_together(&self, events: &mut Events, changes: &[SideChange]) -> Result<(), RunError> {
        let [q, v, ..] = &self.between.carried[..] else { unreachable!("q and v are carried first") };
        let end = self.record.end;
        let (real_q, real_v, real_a, real_p) = (real(q), real(v), real(&self.between.last.x), real(&self.p));
        let [mu, rates] = self.multipliers(false);
        let at = Moment { a: &real_a, v: &real_v, q: &real_q, mu: [&mu, &rates], t: end };
        let t = self.clock.map_or(S::from(end), |clock| clock.time(end));
        let parts = |own: S| (0..S::PARTS).fold(0.0, |most: f64, part| most.max(own.part(part).abs()));
        let of = |values: &[S], place: usize| values.get(place).copied().map_or(0.0, parts);
        let by_time = |rates: &[f64], place: usize| rates.get(place).map_or(0.0, |rate| rate.abs() * parts(t));
        for switch in events.passing_with_first(changes, at, &real_p, &self.between.sides) {
            let moved = parts(self.number_of(events, switch));
            let mut terms = 0.0;
            events.number_by_arguments(switch, at, &real_p, |place, rate| {
                // what each has moved, and what it would have in the time by which the event moves
                terms += rate.abs()
                    * match place {
                        Place::Q(dof) => of(q, dof) + by_time(&real_v, dof),
                        Place::V(dof) => of(v, dof) + by_time(&real_a, dof),
                        Place::Mu(row) => of(&self.between.forces, row) + by_time(&rates, row),
                        Place::P(index) => parts(self.p[index]),
                        Place::Time => parts(t),
                        Place::A(_) => 0.0,
                    };
            });
            if moved > CONSISTENT * terms {
                let [first, other] = [changes[0].switch, switch].map(|own| events.part_of(own));
                let names =
                    if first == other { format!("parts of \"{first}\"") } else { format!("\"{first}\" and \"{other}\"") };
                return Err(RunError::Input(format!(
                    "{names} pass at once at t = {} s and act on each other, and the design moves them apart: which one is first decides what follows, \
                     so that there is no derivative; take a design in which they are apart",
                    shortest(end)
                )));
            }
        }
        Ok(())
    }

    /// Whether the motion goes on beyond a stop.
    fn moves_on(&self, joint: usize, stop: &Stop) -> bool {
        let rate = self.approach(joint);
        (if stop.is_upper { rate } else { -rate }) > self.no_speed()
    }

    /// How a joint is hit that is not there.
    fn hit_of(
        &self,
        events: &Events,
        (event, Closing { joint, stop, impulse }): (usize, &Closing),
        (sides, changes): (&[f64], &[SideChange]),
        is_made_again: bool,
    ) -> Option<Hit> {
        let closing = events.presence_change(*joint, true, sides)?;
        let is_plastic = |[e, least]: [usize; 2]| {
            let [own, least_speed] = [e, least].map(|place| self.p[place].value());
            match is_made_again {
                true => changes.iter().any(|change| change.switch == closing.switch),
                false => own == 0.0 || self.approach(*joint).abs() < least_speed || self.is_last_hit(*joint, own),
            }
        };
        let restitution = stop.as_ref().filter(|own| !is_plastic(own.parameters)).map(|own| own.parameters[0]);
        let first = self.problem.model.constraints[*joint].equations.start;
        let impulse = impulse.map(|dof| [first, dof]);
        Some(Hit { event, joint: *joint, stop: stop.clone(), closing, row: first, restitution, impulse })
    }

    /// The changes by which a force lets go behind what has happened, of a joint that is there then, or by which a stop that lets go would move back at once
    /// and holds: of stops without friction one after the other, until all forces push and nothing moves beyond, see [`Events::torn`].
    fn released(
        &mut self,
        events: &mut Events,
        (present, changes): (&mut [f64], &[SideChange]),
    ) -> Result<Vec<SideChange>, RunError> {
        if events.release_of(present).is_none() {
            return Ok(Vec::new());
        }
        let mut sides = self.between.sides.clone();
        set(changes, &mut sides);
        let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
        let t = self.behind.unwrap_or(self.record.end);
        let dropped = self.dropped_with(&events.absent(present), (&q, &v), self.record.end);
        let Unknowns { x: a, mu, .. } = self.accelerations_at((&q, &v), t, &dropped)?;
        let mu = real(&mu);
        let impulses = self.record.impacts.iter().flat_map(|own| real(&own.solve.unknowns.mu));
        let time = self.time_of_impulses();
        let forces = impulses.map(|own| own / time).chain(mu.iter().copied()).chain(real(&self.between.forces));
        let none = NO_FORCE * forces.fold(0.0, |most: f64, own| most.max(own.abs()));
        let (mut all, mut choice) = (Vec::new(), std::mem::take(&mut self.choice));
        if events.frictions().len() == 0 {
            let sizes = [CONSISTENT * size(&q), self.no_speed(), CONSISTENT * size(&a)];
            let beyond = |(event, joint, stop): (usize, usize, &'_ Stop)| {
                let [g, rate, towards] = self.equations_of(joint, (&a, &v, &q), t)[0];
                let towards = if stop.is_upper { towards } else { -towards };
                let moves_back = g.abs() <= sizes[0] && rate.abs() <= sizes[1] && towards > sizes[2];
                (moves_back && events.can_be_hit(event, &sides)).then_some(towards)
            };
            if let Some(joint) = events.torn(present, (None, &mu), none, &mut choice) {
                all.extend(events.letting_go(joint, &sides));
            } else {
                let open = events.stops().filter(|own| present[events.presence(own.1)] == 0.0 && choice.may_hold(own.1));
                let back = open.filter_map(|own| Some((own, beyond(own)?)));
                if let Some(((event, joint, stop), _)) = back.max_by(|one, other| one.1.total_cmp(&other.1)) {
                    choice.hold(joint);
                    all.extend(events.presence_change(joint, true, present));
                    set(&all, present);
                    all.extend(events.free(event, stop, &sides));
                    all.extend(events.pushing(joint, stop, &sides));
                }
            }
            self.choice = choice;
        }
        if all.is_empty() {
            let [v, q] = [&v, &q].map(|own| real(own));
            let moment = Moment { a: &[], v: &v, q: &q, mu: [&mu, &[]], t: self.record.end };
            all.extend(events.released((&sides, present), moment, &real(&self.p), none));
        }
        self.forces = mu;
        Ok(all)
    }

    /// Adds the switches of formulas whose numbers are beyond their sides once others have changed, on which they depend.
    fn add_dependent(&mut self, events: &mut Events, changes: &mut Vec<SideChange>) {
        let mut known = 0;
        while known < changes.len() && !changes.iter().all(|own| events.is_event(own.switch)) {
            known = changes.len();
            changes.iter().for_each(|own| self.between.sides[own.switch] = own.sides[1]);
            events.write(&self.between.sides, &mut self.p);
            for (switch, own) in self.excesses_of(events, false).into_iter().enumerate() {
                let is_known = events.is_event(switch) || changes[..known].iter().any(|own| own.switch == switch);
                if !is_known && !self.waits(switch) && own.by > own.noise(self.record.end) {
                    changes.push(SideChange { switch, sides: [self.between.sides[switch], own.other] });
                }
            }
        }
    }

    /// Number of the switch that ended the step made last, and what is left of its number there, beyond the side to which it changes.
    fn located_number(&self, events: &mut Events, changes: &[SideChange]) -> (usize, f64) {
        let Some(SideChange { switch, .. }) = changes.first() else { return (usize::MAX, 0.0) };
        (*switch, self.excesses_of(events, false).get(*switch).map_or(0.0, |own| -own.by))
    }

    fn no_forces(&self, changes: &[SideChange], events: &Events) -> RunError {
        let name = changes.first().filter(|own| own.switch < events.switches()).map_or("", |own| events.part_of(own.switch));
        RunError::Input(format!(
            "no forces are found at t = {} s by which all that touches pushes and nothing moves beyond its limit, as by \"{name}\"",
            shortest(self.record.end)
        ))
    }

    /// Values and rates of the equations of joints behind the step made last, zero of those that are not there.
    fn violations(&self, absent: &[usize]) -> Vec<[f64; 2]> {
        let joints = self.problem.model.constraints.iter().enumerate();
        let all = joints.flat_map(|(joint, own)| own.equations.clone().zip(self.equations_behind(joint)));
        all.map(|(row, [g, rate, _])| if absent.binary_search(&row).is_err() { [g, rate] } else { [0.0; 2] }).collect()
    }

    /// Whether these are what they were before an event has set something.
    fn check_joints(&self, absent: &[usize], before: &[[f64; 2]], event: &str) -> Result<(), RunError> {
        let sizes = [0, 1].map(|order| CONSISTENT * size(&self.between.carried[order]));
        let holds = |own: f64, before: f64, size: f64| own.abs() <= before.abs() + size;
        let mut all = self.violations(absent).into_iter().zip(before).enumerate();
        let violated = all.find(|(_, (now, before))| (0..2).any(|k| !holds(now[k], before[k], sizes[k])));
        let Some((row, ([g, rate], _))) = violated else { return Ok(()) };
        let joints = &self.problem.model.constraints;
        let name = joints.iter().find(|own| own.equations.contains(&row)).map_or("", |own| &own.name);
        Err(RunError::Input(format!(
            "what event \"{event}\" sets at t = {} s violates joint \"{name}\", by {g:.3e} and {rate:.3e} 1/s: set coordinates and rates that its \
             joints allow",
            shortest(self.record.end)
        )))
    }

    /// That the motion is on the free side of the stops that an event brings back.
    fn check_brought(&self, events: &mut Events, event: usize) -> Result<(), RunError> {
        let switches: Vec<usize> = events.stops_brought(event).collect();
        if switches.is_empty() {
            return Ok(());
        }
        let all = self.excesses_of(events, false);
        let beyond = switches.into_iter().find(|&switch| all[switch].by > all[switch].round_off(self.record.end));
        let Some(switch) = beyond else { return Ok(()) };
        let (name, t) = (events.part_of(switch), shortest(self.record.end));
        Err(RunError::Input(format!(
            "\"{name}\" cannot be locked at t = {t} s: the motion is beyond it by {:.3e} there; bring it back where it is not",
            all[switch].by
        )))
    }

    /// Whether what is to be held by a joint is where it holds it.
    fn check_closing(&self, joint: usize) -> Result<(), RunError> {
        let off = self.equations_behind(joint).iter().fold(0.0, |most: f64, [g, ..]| most.max(g.abs()));
        if off <= CONSISTENT * size(&self.between.carried[0]) {
            return Ok(());
        }
        let (t, name) = (shortest(self.record.end), &self.problem.model.constraints[joint].name);
        Err(RunError::Input(format!(
            "\"{name}\" cannot be locked at t = {t} s: its equations are off by {off:.3e} there; lock it where they hold, by an event whose formula they are"
        )))
    }

    /// Equations that are left out where these are not there, at a state: those are among them that hold by all others what sticks.
    pub(super) fn dropped_with(&self, absent: &[usize], state: (&[S], &[S]), t: f64) -> Vec<usize> {
        let model = self.problem.model;
        let mut dropped = self.between.dropped.clone();
        dropped.retain(|row| !model.comes_and_goes(*row));
        dropped.extend(absent);
        dropped.sort_unstable();
        let sticking = model.frictions.iter().flat_map(|own| model.constraints[own.joints[1]].equations.clone());
        let sticking: Vec<usize> = sticking.filter(|row| absent.binary_search(row).is_err()).collect();
        self.left_out_of(&dropped, state, t, &sticking)
    }

    /// The same at the end of the step made last.
    pub(super) fn dropped_behind(&self, absent: &[usize]) -> Vec<usize> {
        let carried = &self.between.carried;
        self.dropped_with(absent, (&carried[0], &carried[1]), self.record.end)
    }

    /// The impact by which the equations of a joint come to rest, without some: M x + A^T mu = 0, A (v + x) + g_t = 0, where some rows keep a share of their
    /// rate A v + g_t; it is looked for from a first guess.
    pub(super) fn impact(
        &mut self,
        joint: usize,
        (dropped, shares): (&[usize], &[(usize, S)]),
        mut first: Unknowns<S>,
    ) -> Result<SolveRecord<S>, RunError> {
        let end = self.record.end;
        let mut newton = self.analysis(dropped)?;
        newton.residual.clock = self.clock.map(|clock| Clock::shifted(clock.time(end) - end));
        let pace = self.clock.map_or(S::one(), |clock| clock.pace());
        let [q, v, ..] = &self.between.carried[..] else { unreachable!("q and v are carried first") };
        let v = v.iter().map(|&v| v * pace).collect();
        let mut own = SolveRecord { t: end, equations: Equations::impact(), ..SolveRecord::default() };
        own.base = VectorsAvq { a: vec![S::zero(); q.len()], v, q: q.clone() };
        first
            .mu
            .iter_mut()
            .enumerate()
            .filter(|(row, _)| dropped.binary_search(row).is_ok())
            .for_each(|own| *own.1 = S::zero());
        own.unknowns = first;
        if !shares.is_empty() {
            let mut still = Residual::unknowns(&newton.system);
            let stage = StageSystem { equations: &own.equations, base: &own.base, p: &self.p, t: end };
            newton.residual.start(&newton.system, stage);
            newton.residual.evaluate(&newton.system, stage, &mut still);
            let rates = &newton.residual.g;
            newton.residual.kept = shares.iter().map(|&(row, share)| (row, share * rates[row])).collect();
            // of what is not there nothing is kept
            newton.residual.kept.retain(|own| dropped.binary_search(&own.0).is_err());
        }
        let name = &self.problem.model.constraints[joint].name;
        let place = || format!("impact of \"{name}\" (t = {} s)", shortest(end));
        solve(&mut newton, &mut own, InitialGuess::Given, &self.p, &place)?;
        if S::PARTS > 0 {
            // the search ends with the values, and their derivatives follow in a step of its own
            let Unknowns { x, mu, local_mu } = &own.unknowns;
            let known = Unknowns { x: real(x), mu: real(mu), local_mu: real(local_mu) };
            solve(&mut newton, &mut own, InitialGuess::Solved(&known), &self.p, &place)?;
        }
        self.earlier += newton.counters;
        Ok(own)
    }

    /// Multipliers of the accelerations of a state, without some equations.
    pub(super) fn forces_at(&mut self, state: (&[S], &[S]), t: f64, dropped: &[usize]) -> Result<Vec<f64>, RunError> {
        Ok(real(&self.accelerations_at(state, t, dropped)?.mu))
    }

    /// The accelerations of a state with their multipliers, without some equations.
    pub(super) fn accelerations_at(
        &mut self,
        (q, v): (&[S], &[S]),
        t: f64,
        dropped: &[usize],
    ) -> Result<Unknowns<S>, RunError> {
        let mut newton = self.analysis(dropped)?;
        let mut own = SolveRecord { t, equations: Equations::acceleration(), ..SolveRecord::default() };
        own.base = VectorsAvq { a: vec![S::zero(); q.len()], v: v.to_vec(), q: q.to_vec() };
        let place = || format!("forces at stops (t = {} s)", shortest(t));
        solve(&mut newton, &mut own, InitialGuess::Zero, &self.p, &place)?;
        self.earlier += newton.counters;
        Ok(own.unknowns)
    }

    /// Rate of the equation of a stop.
    pub(super) fn approach(&self, joint: usize) -> f64 {
        self.equations_behind(joint)[0][1]
    }

    /// Whether a stop that is hit with restitution e would be hit again within [`LAST_HIT`] of a step, as what bounces ever faster is.
    fn is_last_hit(&self, joint: usize, e: f64) -> bool {
        let Some(last) = self.record.stages.last() else { return false };
        let mut a = Vec::new();
        last.solve.write_acceleration(&mut a);
        let [_, rate, towards] =
            self.equations_of(joint, (&a, &self.between.carried[1], &self.between.carried[0]), self.record.end)[0];
        2.0 * e * rate.abs() <= LAST_HIT * self.planned * (towards * rate.signum())
    }

    /// Values and rates of the equations of a joint behind the step made last.
    fn equations_behind(&self, joint: usize) -> Vec<[f64; 3]> {
        let carried = &self.between.carried;
        self.equations_of(joint, (&[], &carried[1], &carried[0]), self.record.end)
    }

    /// Of a state without accelerations, or with them.
    pub(super) fn equations_of(&self, joint: usize, (a, v, q): (&[S], &[S], &[S]), t: f64) -> Vec<[f64; 3]> {
        let own = &self.problem.model.constraints[joint];
        let gather = |values: &[S]| -> Vec<f64> {
            let dofs = own.nodes.iter().flat_map(|node| self.problem.model.nodes[node.0].dofs.clone());
            dofs.map(|dof| values.get(dof).map_or(0.0, |own| own.value())).collect()
        };
        let [a, v, q] = [a, v, q].map(gather);
        let p: Vec<f64> = self.p[own.parameters.clone()].iter().map(|p| p.value()).collect();
        own.physics.motion(State { a: &a, v: &v, q: &q }, &p, t)
    }

    /// A solver without those equations, whose pattern was analysed once.
    pub(super) fn analysis(&mut self, dropped: &[usize]) -> Result<Newton<'m, S>, RunError> {
        let known = self.analyses.iter().position(|own| own.0 == dropped);
        let place = match known {
            Some(place) => place,
            None => {
                let made = newton(self.method, &self.method.system(self.problem.model, dropped))?;
                self.analyses.push((dropped.to_vec(), made));
                self.analyses.len() - 1
            }
        };
        let mut own = self.analyses[place].1.clone_analysis().map_err(|singular| RunError::of_pattern("event", singular))?;
        own.counters = Counters::measuring(self.method.measures_phases);
        Ok(own)
    }

    /// Sets what an event sets at the end of the step made last.
    fn reset(&mut self, events: &Events, event: (usize, usize)) -> Result<(), String> {
        let [q, v, ..] = &mut self.between.carried[..] else { unreachable!("q and v are carried first") };
        let (end, clock) = (self.record.end, self.clock);
        clock.iter().for_each(|clock| v.iter_mut().for_each(|v| *v *= clock.pace()));
        let t = clock.map_or(S::from(end), |clock| clock.time(end));
        events.reset(event, [v, q], t, &self.p, &mut self.record.set)?;
        clock.iter().for_each(|clock| v.iter_mut().for_each(|v| *v *= clock.length()));
        Ok(())
    }

    /// How far the switches are beyond the ends of their sides at the start of the step made last, and at its end.
    pub(super) fn excesses(&mut self, at_start: bool) -> Vec<Excess> {
        let Some(mut events) = self.events.take() else { return Vec::new() };
        let all = self.excesses_of(&mut events, at_start);
        self.events = Some(events);
        all
    }

    fn excesses_of(&self, events: &mut Events, at_start: bool) -> Vec<Excess> {
        let (state, t) = match at_start {
            true => (&self.record.carried, self.record.t),
            false => (&self.between.carried, self.record.end),
        };
        let a = self.method.table.carried.iter().position(|kind| *kind == Carried::A);
        let a = a.map_or_else(|| real(&self.between.last.x), |place| real(&state[place]));
        let [q, v, p] = [&state[0], &state[1], &self.p].map(|values| real(values));
        let [mu, rates] = match self.behind {
            Some(_) => [self.forces.clone(), vec![0.0; self.forces.len()]],
            None => self.multipliers(at_start),
        };
        events.excesses(Moment { a: &a, v: &v, q: &q, mu: [&mu, &rates], t }, &p, &self.between.sides)
    }

    /// Multipliers in the step made last, at its start or end, and their changes by time.
    fn multipliers(&self, at_start: bool) -> [Vec<f64>; 2] {
        let (start, end) = (&self.mu_before, real(&self.between.forces));
        // over so short a step their change is round-off
        let share = if self.record.scheme == Scheme::Euler { 0.0 } else { 1.0 / self.record.h };
        let rates = end.iter().zip(start).map(|(end, start)| (end - start) * share).collect();
        [if at_start { start.clone() } else { end }, rates]
    }

    /// Derivative part of a laid time.
    pub(super) fn moved(&self, t: f64) -> S {
        clock_at(&self.clocks, self.between.step).map_or(S::zero(), |clock| clock.time(t) - t)
    }

    /// Makes a step that ends at an event, g = 0, as `make` does it for a derivative part of its end; returns that for which those of g vanish, which
    /// depend on it linearly.
    pub(super) fn move_event(
        &mut self,
        switch: usize,
        before: &Checkpoint<S>,
        make: impl Fn(&mut Self, S) -> Result<(), RunError>,
    ) -> Result<S, RunError> {
        let mut unit = S::zero();
        unit.add_to_part(0, unit_part::<S>());
        let (mut numbers, clock) = ([S::zero(); 2], self.clock);
        for (number, part) in numbers.iter_mut().zip([S::zero(), unit]) {
            make(self, part)?;
            *number = self.number(switch);
            self.between.clone_from(&before.between);
            // what is carried into the step is measured by it
            self.clock = clock;
            [&mut self.acceleration, &mut self.stage].into_iter().for_each(Newton::forget_factors);
        }
        let rate = (numbers[1].part(0) - numbers[0].part(0)) / unit_part::<S>();
        let mut part = S::zero();
        (0..S::PARTS).for_each(|own| part.add_to_part(own, -numbers[0].part(own) / rate));
        make(self, part)?;
        Ok(part)
    }

    /// The number of a switch at the end of the step made last.
    pub(super) fn number(&self, switch: usize) -> S {
        self.events.as_ref().map_or_else(S::zero, |events| self.number_of(events, switch))
    }

    fn number_of(&self, events: &Events, switch: usize) -> S {
        let carried = &self.between.carried;
        let mut at = VectorsAvq { a: vec![S::zero(); carried[0].len()], v: carried[1].clone(), q: carried[0].clone() };
        let t = self.clock.map_or(S::from(self.record.end), |clock| clock.time(self.record.end));
        self.clock.iter().for_each(|clock| clock.set_pace(&mut at));
        let mu = [&self.between.forces[..], &[]];
        events.number(switch, Moment { a: &at.a, v: &at.v, q: &at.q, mu, t }, &self.p)
    }

    /// Whether steps take over an acceleration: others begin with coordinates and velocities alone.
    fn carries_acceleration(&self) -> bool {
        !self.method.table.is_static() && self.method.table.carried.contains(&Carried::A)
    }

    /// Goes over to the clock of the next step: within a stretch it is the same one.
    fn change_clock(&mut self, state: &mut StepState<S>) {
        let clock = self.own_clock.or_else(|| clock_at(&self.clocks, state.step));
        if self.clock.is_some() || clock.is_some() {
            let factor = self.clock.map_or(S::one(), |before| before.pace()) * clock.map_or(S::one(), |own| own.length());
            for (values, kind) in state.carried.iter_mut().zip(&self.method.table.carried) {
                (0..kind.order()).for_each(|_| values.iter_mut().for_each(|value| *value *= factor));
            }
        }
        self.clock = clock;
    }

    /// Makes a step with the equations that are kept now.
    fn try_step(
        &mut self,
        scheme: Scheme,
        (t, end): (f64, f64),
        StepStart { breakpoint, solves }: StepStart,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<(), RunError> {
        let method = self.method;
        let mut state = std::mem::take(&mut self.between);
        let mut record = std::mem::take(&mut self.record);
        let index = state.step;
        self.change_clock(&mut state);
        self.stage.residual.clock = self.clock;
        let table = method.table.scheme(scheme);
        let h = end - t;
        (record.t, record.h, record.end, record.scheme) = (t, h, end, scheme);
        record.dropped.clone_from(&state.dropped);
        record.switched = std::mem::take(&mut state.switched);
        record.clock = self.clock;
        let is_euler = scheme == Scheme::Euler;
        record.lengthened = self.lengthened.filter(|_| is_euler);
        (record.restart, record.forces) = (None, None);
        record.set.clear();
        record.impacts.clear();
        record.axes.clear();
        if table.is_static() {
            state.expect_in_proportion(t, h, breakpoint);
        } else if solves && !is_euler {
            let first = InitialGuess::guided(guided.and_then(|step| step.restart.as_ref()));
            let mut solved = SolveRecord::default();
            let behind = if breakpoint { beside(t, 1.0) } else { t };
            self.solve_acceleration((&state.carried[0], &state.carried[1]), behind, index, first, &mut solved)?;
            state.set_acceleration(&table.carried, &solved);
            record.restart = Some(solved);
        } else if breakpoint {
            state.forget_course();
        }
        self.mu_before = real(&state.forces);
        state.prepare_guesses(scheme, table.stages.len());
        // from one step no change is known
        let is_known = table.embedded.is_some() || state.prediction.tracks.iter().any(|track| !track.times.is_empty());
        self.stage.allowed = allowed(table, &state, h, self.stage.length);
        std::mem::swap(&mut state.carried, &mut record.carried);
        let change = self.solve_stages(&mut state, &mut record, table, guided)?;
        state.carried.resize_with(table.carried.len(), Vec::new);
        record.update(self.rule(), &mut state.carried);
        if let Some(part) = record.lengthened {
            let ([q, v, ..], x) = (&mut state.carried[..], &record.stages[0].solve.unknowns.x) else {
                unreachable!("q and v are carried first")
            };
            q.iter_mut().zip(&record.carried[1]).for_each(|(q, &v)| *q += v * part);
            v.iter_mut().zip(x).for_each(|(v, &x)| *v += x * part);
            // what follows is at its end
            let moved = self.clock.map_or(S::zero(), |clock| clock.time(end) - end);
            self.clock = Some(Clock::shifted(moved + part));
        }
        self.project(&mut state, &mut record, guided)?;
        record.q.clone_from(&state.carried[0]);
        record.v.clone_from(&state.carried[1]);
        state.allowed = None;
        if method.tolerance == NewtonTolerance::Scaled && is_known && is_estimated(table) {
            let [q, v] = self.estimated_error(table, &record, change);
            state.allowed = Some([LEFT * q, LEFT * v, h]);
        }
        state.step += 1;
        state.forces.clear();
        let asks = match guided {
            Some(step) => step.forces.is_some(),
            None => self.events.as_ref().is_some_and(|events| events.release_of(&state.sides).is_some()),
        };
        if asks {
            let first = InitialGuess::guided(guided.and_then(|step| step.forces.as_ref()));
            let forces = record.forces.insert(SolveRecord::default());
            self.solve_forces(&state, end, first, forces)?;
            state.forces.clone_from(&forces.unknowns.mu);
        }
        self.between = state;
        self.record = record;
        Ok(())
    }

    /// Accelerations of the state at the end of a step, with the forces that they take.
    fn solve_forces(
        &mut self,
        state: &StepState<S>,
        end: f64,
        first: InitialGuess,
        record: &mut SolveRecord<S>,
    ) -> Result<(), RunError> {
        let clock = self.clock;
        let pace = clock.map_or(S::one(), |clock| clock.pace());
        let v: Vec<S> = state.carried[1].iter().map(|&v| v * pace).collect();
        self.clock = clock.map(|clock| Clock::shifted(clock.time(end) - end));
        let solved = self.solve_acceleration((&state.carried[0], &v), end, state.step, first, record);
        self.clock = clock;
        solved
    }

    /// Estimated error of the step just made, in coordinates \[m\] and velocities \[m/s\]: that of an embedded solution; where the method has
    /// none, that of the trapezoidal rule, h2/12 times the change of the acceleration.
    fn estimated_error(&mut self, table: &Table, step: &StepRecord<S>, change: f64) -> [f64; 2] {
        let Some(embedded) = &table.embedded else {
            let error = step.h * step.h / 12.0 * change;
            return [error, error / step.h];
        };
        let Stepper { difference, stage, .. } = self;
        [0, 1].map(|order| {
            embedded_difference((table, embedded), order, step, difference);
            stage.size(difference)
        })
    }

    /// The acceleration for given (q, v), at acceleration level whatever the level of the run.
    pub(super) fn solve_acceleration(
        &mut self,
        (q, v): (&[S], &[S]),
        t: f64,
        step: usize,
        first: InitialGuess,
        record: &mut SolveRecord<S>,
    ) -> Result<(), RunError> {
        self.acceleration.residual.clock = self.clock;
        self.acceleration.run_sizes.join(&self.stage.run_sizes);
        record.t = t;
        record.equations = Equations::acceleration();
        record.base = VectorsAvq { a: vec![S::zero(); q.len()], v: v.to_vec(), q: q.to_vec() };
        let place = || format!("acceleration before step {} (t = {} s)", step + 1, shortest(t));
        solve(&mut self.acceleration, record, first, &self.p, &place)
    }

    /// Solves for the stages. Returns the change of the acceleration over the step, where it is asked for.
    fn solve_stages(
        &mut self,
        state: &mut StepState<S>,
        record: &mut StepRecord<S>,
        table: &Table,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<f64, RunError> {
        let (t, h, step, rule) = (record.t, record.h, state.step, self.rule());
        let asks_for_change = self.method.tolerance == NewtonTolerance::Scaled && table.embedded.is_none();
        let mut change = 0.0;
        let first = table.stages.iter().position(|stage| stage.known.is_none());
        if let Some(first) = first.filter(|_| guided.is_none() && !table.is_static()) {
            self.stage.begin_step(&self.method.stage_equations(table, first, h, self.constrained));
        }
        self.stage.trusted.clear();
        self.stage.trusted.extend(record.carried[0].iter().map(|q| q.value()));
        record.stages.resize_with(table.stages.len(), StageRecord::default);
        for index in 0..table.stages.len() {
            record.begin_stage(rule, index);
            let StageRecord { solve: own, known } = &mut record.stages[index];
            if known.is_some() {
                own.unknowns.mu.clone_from(&state.last.mu);
                continue;
            }
            let time = own.t;
            let place = || format!("step {}, stage {} (t = {} s)", step + 1, index + 1, shortest(time));
            let track = &mut state.prediction.tracks[index];
            let first = if let Some(step) = guided {
                InitialGuess::Solved(&step.stages[index].solve.unknowns)
            } else {
                own.unknowns.set(&state.last);
                track.add_expected(t, h, &mut own.unknowns);
                InitialGuess::Given
            };
            solve(&mut self.stage, own, first, &self.p, &place)?;
            if guided.is_none() {
                track.learn((t, h), Some(&state.last), &own.unknowns, &self.stage.coordinate_scales);
            }
            if asks_for_change {
                change += self.stage.distance(&state.last.x, &own.unknowns.x);
            }
            state.last.set(&own.unknowns);
        }
        Ok(change)
    }

    pub(super) fn rule(&self) -> StepRule<'m> {
        StepRule { method: self.method, constrained: self.constrained }
    }

    /// At acceleration level: (q, v) back onto g = 0 and dg/dt = 0, each as one more system.
    fn project(
        &mut self,
        state: &mut StepState<S>,
        record: &mut StepRecord<S>,
        guided: Option<&StepRecord<f64>>,
    ) -> Result<(), RunError> {
        let is_at_accelerations = self.method.constraint_level() == ConstraintLevel::Acceleration;
        if !self.constrained || !is_at_accelerations || record.scheme == Scheme::Euler {
            (record.position_projection, record.velocity_projection) = (None, None);
            return Ok(());
        }
        let (rule, t, stages) = (self.rule(), record.t, record.stages.len());
        let StepState { carried, prediction, step, .. } = state;
        let [q, v, ..] = &mut carried[..] else { unreachable!("q and v are carried first") };
        let end = record.end;
        let place = || format!("step {}, projection (t = {} s)", *step + 1, shortest(end));
        let guides = guided.map(|step| [&step.position_projection, &step.velocity_projection]);
        for order in 0..2 {
            let own = record.begin_projection(rule, order, [q, v]);
            let track = &mut prediction.tracks[stages + order];
            let first = if let Some(guides) = guides {
                InitialGuess::guided(guides[order].as_ref())
            } else {
                Residual::shape(&self.stage.system, &mut own.unknowns, true);
                track.add_expected(t, 1.0, &mut own.unknowns);
                InitialGuess::Given
            };
            solve(&mut self.stage, own, first, &self.p, &place)?;
            if guided.is_none() {
                track.learn((t, 1.0), None, &own.unknowns, &self.stage.coordinate_scales);
            }
            StepRecord::end_projection(own, order, [q, v]);
        }
        Ok(())
    }
}
