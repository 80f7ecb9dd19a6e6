//! Surfaces that slip and stick: in impacts, at the start, and where events change between both.
//!
//! Surfaces stick by a joint of their own, s = 0, and slip by forces along a direction that events choose: where they stick and its multipliers are
//! beyond the static limit, they slip in the direction in which these pull; where slip comes to zero they stick. In impacts impulses keep the same law.
//!
//! Source: Pfeiffer, Glocker (1996), Multibody Dynamics with Unilateral Contacts, chapters 5 and 8.

use super::events::{Choice, Events, Hit, Moment, SideChange, from_axis};
use super::march::add_scaled;
use super::record::{AxisRecord, ImpactRecord, OtherHit, SlipBefore};
use super::redundancy::dependent_among;
use super::step::{NO_FORCE, Stepper, real, size};
use super::{ConstraintLevel, RunError, StartPlan};
use crate::assembly::{JointFriction, Stop, Unknowns};
use crate::design::shortest;
use crate::elements::{LEAST_SPEED, RunScalar};
use crate::tolerances::CONSISTENT;

/// Share of a slip in two directions within which friction has a direction that is given: its square is an error of directions.
const GIVEN: f64 = 1e-7;
/// Share of a slip in two directions to which it falls before another direction is given: friction turns the faster the slower slip is.
const LEAST: f64 = 1.0 / 64.0;
/// Shares of the speeds of the model, and of what accelerations make of them in [`BEFORE_LONG`] of the run, from which slip in two directions goes on along
/// a line to its end: if it has been straight, and whether it has or not, as nearer to the end its direction, and more so the derivative of that, is
/// round-off of the speeds.
const ENDS: [f64; 2] = [1e-4, 1e-6];
/// Angle by which slip is turned that is straight.
const STRAIGHT: f64 = 1e-4;
const BEFORE_LONG: f64 = 1e-3;
/// Multiple of the slip within which friction has one direction then.
const ALONG_A_LINE: f64 = 1e3;
/// Share of the speeds of the model within which friction has the direction of the force that breaks surfaces away.
const STILL: f64 = 1e-4;
/// Share of a slip behind an impact within which friction has its direction before restitution.
const SHARP: f64 = 1e-8;
/// Multiple of the speeds of the model to which it ends in impacts at first: friction has the direction that it is given.
const BLUNT: f64 = 1e3;
/// Shares of the slip near which it ends, one after the other, from there on to that: friction turns from the direction that it is given to its own.
const AIMS: [f64; 4] = [10.0, 1.0, 0.1, 0.01];
/// Share of what is left to the next breakpoint after which is looked where a driver moves surfaces that it has at rest.
const AHEAD: f64 = 1e-2;
/// Share of coordinates, and of how far the model moves until then, that joints leave of what a driver has at rest.
const STANDS: f64 = 1e-11;
/// Multiple, or share, to which the force of a contact that slips has come before it is looked into again.
const GROWS: f64 = 1.5;
/// How many times as large as without friction a force is that a step behind it ends in none.
const JAMS: f64 = 100.0;
/// Changes between slipping and sticking in one impact behind which no law is found that all surfaces keep.
const MOST_CHANGES: usize = 60;

fn length(values: &[f64]) -> f64 {
    values.iter().map(|own| own * own).sum::<f64>().sqrt()
}

/// A speed near which slip ends, as a power of 2: it stays what it is in designs beside.
fn near(speed: f64) -> f64 {
    speed.max(LEAST_SPEED).log2().round().exp2()
}

/// Speeds of a model at the end of a step, or what accelerations make of them in it.
pub(crate) fn speed_of(v: &[f64], a: &[f64], h: f64) -> f64 {
    let largest = |own: &[f64]| own.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
    largest(v).max(h * largest(a))
}

/// Whether surfaces slip, so that their friction has the direction of that; otherwise it has that of the force which broke them away.
pub(crate) fn moves(slip: &[f64], speed: f64) -> bool {
    length(slip) > CONSISTENT * speed
}

/// Directions of a slip, and of two the speeds within which they are given, and to which slip falls before others are.
type Course = (Vec<f64>, [f64; 2]);

/// That of a slip as it is.
fn along(slip: &[f64]) -> Course {
    (unit(slip), [GIVEN, LEAST].map(|share| near(share * length(slip))))
}

/// Some numbers by their length; of none the first direction.
fn unit(values: &[f64]) -> Vec<f64> {
    let length = length(values);
    let first = |k: usize| if k == 0 { 1.0 } else { 0.0 };
    values.iter().enumerate().map(|(k, own)| if length > 0.0 { own / length } else { first(k) }).collect()
}

impl<S: RunScalar> AxisRecord<S> {
    /// The slip along it, in both impacts at a state.
    pub(crate) fn slip(&self, events: &Events, [v, q]: [&[S]; 2], t: S, p: &[S]) -> [S; 2] {
        let [none, some] = self.impacts.each_ref().map(|own| {
            let mut v = v.to_vec();
            add_scaled(&mut v, &own.solve.unknowns.x, 1.0);
            events.slip(self.friction, [&v, q], t, p)
        });
        [0, 1].map(|k| some[k] - none[k])
    }
}

/// Carries changes out.
pub(super) fn set(changes: &[SideChange], sides: &mut [f64]) {
    changes.iter().for_each(|own| sides[own.switch] = own.sides[1]);
}

/// Surfaces whose state an impact has changed: those that stick no more, and those whose direction is that of their slip.
#[derive(Default)]
struct Treated {
    broken: Vec<usize>,
    /// With the speed near which the given direction counts.
    aimed: Vec<(usize, f64)>,
    sharp: Vec<usize>,
}

impl Treated {
    /// What begins to slip anew has no direction of its own yet.
    fn forget(&mut self, friction: usize) {
        self.aimed.retain(|own| own.0 != friction);
        self.sharp.retain(|own| *own != friction);
    }
}

/// Sides as far as what happens has come, and all that change.
type Sides<'s> = (&'s mut [f64], &'s mut Vec<SideChange>);

fn no_solution(what: &str, how_many: &str, t: f64) -> RunError {
    RunError::Input(format!(
        "{what} has {how_many} solution by Coulomb's law at t = {} s, as Painleve's rod: the friction there is too large for rigid bodies; take less, or a \
         soft contact",
        shortest(t)
    ))
}

impl<S: RunScalar> Stepper<'_, S> {
    /// Rates and coordinates at the end of the step made last, and its time.
    fn state(&self) -> ([Vec<S>; 2], S) {
        let [q, v, ..] = &self.between.carried[..] else { unreachable!("q and v are carried first") };
        let pace = self.clock.map_or(S::one(), |clock| clock.pace());
        let t = self.clock.map_or(S::from(self.record.end), |clock| clock.time(self.record.end));
        ([v.iter().map(|&v| v * pace).collect(), q.clone()], t)
    }

    fn slip(&self, events: &Events, friction: usize) -> Vec<S> {
        let ([v, q], t) = self.state();
        events.slip(friction, [&v, &q], t, &self.p)
    }

    /// Speeds of the model at the end of the step made last, or what accelerations make of them in it.
    fn speed(&self) -> f64 {
        let v = self.between.carried.get(1).map_or_else(Vec::new, |v| real(v));
        speed_of(&v, &real(&self.between.last.x), self.record.h)
    }

    /// What is no speed between surfaces that touch: a share of those of the model, or of what its accelerations make over its size, however short the step
    /// is.
    pub(super) fn no_speed(&self) -> f64 {
        let fall = (size(&self.between.carried[0]) * size(&self.between.last.x)).sqrt();
        CONSISTENT * self.speed().max(fall)
    }

    /// Speeds of slip in two directions that begins.
    fn still(&self) -> [f64; 2] {
        [near(STILL * self.speed()), 0.0]
    }

    /// Speeds of slip in two directions in an impact whose friction has a given direction.
    fn blunt(&self) -> [f64; 2] {
        [near(BLUNT * self.speed()), 0.0]
    }

    /// The changes by which surfaces that begin to slip, or are turned, do so in the direction of their slip, if they have any.
    pub(super) fn directed(&self, events: &Events, before: &[f64], sides: &[f64]) -> Vec<SideChange> {
        let mut all = Vec::new();
        for friction in events.turned(before, sides) {
            let slip = real(&self.slip(events, friction));
            if moves(&slip, self.speed()) {
                all.extend(events.turn(friction, &unit(&slip), along(&slip).1, sides));
            }
        }
        all
    }

    /// Directions with their derivative parts: of the slip, or of the force that broke surfaces away.
    pub(super) fn follow_directions(&mut self, events: &Events, before: &[f64], axes: &[Vec<S>]) {
        for friction in 0..events.frictions().len() {
            if events.direction(friction, &self.between.sides).iter().all(|own| *own == 0.0) {
                self.directions[friction].slip = None;
            }
        }
        for friction in events.turned(before, &self.between.sides) {
            let slip = self.slip(events, friction);
            let rows = self.problem.model.constraints[events.friction(friction).joints[1]].equations.clone();
            let own = match moves(&real(&slip), self.speed()) {
                true => slip,
                false => from_axis(&self.between.forces[rows], &axes[friction]),
            };
            let length = own.iter().map(|&own| own * own).fold(S::zero(), |sum, own| sum + own).sqrt();
            self.directions[friction].slip = Some([own[0] / length, own[1] / length]);
        }
    }

    /// The changes by which surfaces that stuck slip, as their multipliers pull them.
    pub(super) fn slips(&self, events: &Events, friction: usize, mu: &[f64], sides: &[f64]) -> Vec<SideChange> {
        let joint = events.friction(friction).joints[1];
        let own = &mu[self.problem.model.constraints[joint].equations.clone()];
        let direction = unit(&from_axis(own, events.axis(friction, sides)));
        self.turns(events, friction, (direction, self.still()), sides)
    }

    /// The changes by which surfaces slip in a direction.
    pub(super) fn turns(
        &self,
        events: &Events,
        friction: usize,
        (direction, speeds): Course,
        sides: &[f64],
    ) -> Vec<SideChange> {
        let turn = events.turn(friction, &direction, speeds, sides);
        turn.into_iter().chain(events.rubbing(friction, false, sides)).collect()
    }

    /// The changes by which surfaces stick.
    pub(super) fn sticks(&self, events: &Events, friction: usize, sides: &[f64]) -> Vec<SideChange> {
        let mut all = self.stands(events, friction, sides);
        all.extend(events.presence_change(events.friction(friction).joints[1], true, sides));
        all.extend(events.rubbing(friction, true, sides));
        all
    }

    /// The changes by which surfaces do not slip.
    pub(super) fn stands(&self, events: &Events, friction: usize, sides: &[f64]) -> Vec<SideChange> {
        events.turn(friction, &vec![0.0; events.friction(friction).kept.len()], [0.0; 2], sides)
    }

    /// The equations that are left out at a state, those of some rows of what sticks among them that hold by all others.
    pub(super) fn left_out_of(&self, dropped: &[usize], (q, v): (&[S], &[S]), t: f64, rows: &[usize]) -> Vec<usize> {
        dependent_among((self.problem.model, &real(&self.p)), dropped, [&real(q), &real(v)], t, rows)
    }

    /// The direction of the first equation of what sticks, of two velocities, with its derivative parts.
    pub(super) fn axis(&self, events: &Events, friction: usize, sides: &[f64]) -> Vec<S> {
        let own = events.axis(friction, sides).iter().map(|&own| S::from(own));
        match self.directions[friction].axis {
            Some(axis) => own.zip(axis).map(|(own, axis)| own + (axis - S::from(axis.value()))).collect(),
            None => own.collect(),
        }
    }

    /// The directions along which joints alone let surfaces slip that stick, of two: these stick by an equation along that line, whose multiplier is then
    /// the force that friction has to have at least.
    pub(super) fn axes(&mut self, events: &Events, sides: &[f64], dropped: &[usize]) -> Vec<AxisRecord<S>> {
        let mut all = Vec::new();
        for (friction, own) in events.frictions().enumerate().filter(|(_, own)| own.kept.len() == 2) {
            let rows = self.problem.model.constraints[own.joints[1]].equations.clone();
            let is_kept = |row: &usize| dropped.binary_search(row).is_err();
            let Some(kept) =
                rows.clone().position(|row| is_kept(&row)).filter(|_| rows.clone().filter(is_kept).count() == 1)
            else {
                continue;
            };
            // it moves on that line alone, whatever moves it
            let standing = events.set_without_friction(sides);
            let axis = events.axis(friction, sides);
            let along = [[axis[0], axis[1]], [-axis[1], axis[0]]][kept];
            let impacts = [0.0, 1.0].map(|speed| {
                let slip = own.kept.clone().zip(along.map(|own| speed * own));
                let set = standing.iter().copied().chain(slip).collect();
                let mut impact = ImpactRecord { set, dropped: dropped.to_vec(), ..ImpactRecord::default() };
                let p = self.p.clone();
                impact.set_parameters(&[], &mut self.p);
                let solved = self.impact(own.joints[0], (dropped, &[]), Unknowns::default());
                self.p = p;
                impact.solve = solved.ok()?;
                Some(impact)
            });
            if let [Some(none), Some(some)] = impacts {
                all.push(AxisRecord { friction, impacts: [none, some] });
            }
        }
        all
    }

    /// Takes over the derivative parts of such directions; returns the changes to them.
    pub(super) fn align(&mut self, events: &Events, axes: &[AxisRecord<S>], sides: &[f64]) -> Vec<SideChange> {
        let mut all = Vec::new();
        for own in axes {
            let ([v, q], t) = self.state();
            let slip = own.slip(events, [&v, &q], t, &self.p);
            let length = slip.iter().map(|&own| own * own).fold(S::zero(), |sum, own| sum + own).sqrt();
            let axis = [slip[0] / length, slip[1] / length];
            self.directions[own.friction].axis = Some(axis);
            all.extend(events.align(own.friction, &real(&axis), sides));
        }
        all
    }

    /// Those at the start, with the derivative parts that they have from there on.
    pub(super) fn axes_at_start(&mut self, (q, v): (&[S], &[S]), dropped: &[usize]) -> Vec<AxisRecord<S>> {
        let Some(events) = self.events.take() else { return Vec::new() };
        self.between.carried = vec![q.to_vec(), v.to_vec()];
        let sides = self.between.sides.clone();
        let axes = self.axes(&events, &sides, dropped);
        self.align(&events, &axes, &sides);
        self.events = Some(events);
        axes
    }

    /// The same at the end of the step made last, where these begin to hold.
    pub(super) fn align_behind(&mut self, events: &Events, sides: &[f64]) -> Vec<SideChange> {
        let dropped = self.dropped_behind(&events.absent(sides));
        let axes = self.axes(events, sides, &dropped);
        let aligned = self.align(events, &axes, sides);
        self.record.axes = axes;
        aligned
    }

    /// Whether drivers move surfaces against each other, so that these never stick: of one direction, whose equation is left out for theirs.
    pub(super) fn is_driven(
        &self,
        events: &Events,
        friction: usize,
        dropped: &[usize],
        (state, t): ((&[S], &[S]), f64),
    ) -> bool {
        let constraints = &self.problem.model.constraints;
        let rows = constraints[events.friction(friction).joints[1]].equations.clone();
        let drivers = constraints.iter().filter(|own| own.physics.is_driver()).flat_map(|own| own.equations.clone());
        let drivers: Vec<usize> = drivers.collect();
        if drivers.is_empty() || rows.len() > 1 || dropped.binary_search(&rows.start).is_err() {
            return false;
        }
        let mut without: Vec<usize> = dropped.iter().copied().filter(|own| *own != rows.start).chain(drivers).collect();
        without.sort_unstable();
        without.dedup();
        self.left_out_of(&without, state, t, &[rows.start]).binary_search(&rows.start).is_err()
    }

    /// That a run can have the frictions of its model.
    pub(super) fn check_frictions(&self, events: &Events, plan: &StartPlan) -> Result<(), RunError> {
        let constraints = &self.problem.model.constraints;
        let is_redundant = plan.dropped.iter().any(|row| !self.problem.model.comes_and_goes(*row));
        for own in events.frictions() {
            let joint = &constraints[own.joints[0]];
            if self.method.constraint_level() == ConstraintLevel::Position {
                return Err(RunError::Input(format!(
                    "friction of \"{}\" takes constraints at acceleration level: what sticks is held by its velocity",
                    joint.name
                )));
            }
            if is_redundant && !joint.equations.is_empty() {
                return Err(RunError::Input(format!(
                    "friction of \"{}\" is not determined where joints are redundant: they may share their forces in many ways; leave out what is \
                     redundant",
                    joint.name
                )));
            }
        }
        Ok(())
    }

    /// The changes of surfaces that begin, or end, to be held by others while they pull at their limit; and of those that a driver has at rest to the
    /// direction in which it will move them.
    pub(super) fn held_by_others(
        &mut self,
        events: &Events,
        sides: &[f64],
        state: (&[S], &[S]),
        t: f64,
    ) -> Result<Vec<SideChange>, RunError> {
        let dropped = self.dropped_with(&events.absent(sides), state, t);
        let mut all = Vec::new();
        for (friction, own) in events.frictions().enumerate() {
            let slip = real(&events.slip(friction, [state.1, state.0], t.into(), &self.p));
            let direction = events.direction(friction, sides);
            let pulls = direction.iter().any(|own| *own != 0.0);
            let mut is_held = false;
            if pulls && length(&slip) <= CONSISTENT * self.speed().max(size(state.1)) {
                let rows: Vec<usize> = self.problem.model.constraints[own.joints[1]].equations.clone().collect();
                let without: Vec<usize> = dropped.iter().copied().filter(|row| !rows.contains(row)).collect();
                is_held = self.left_out_of(&without, state, t, &rows) == dropped;
                if is_held && self.is_driven(events, friction, &dropped, (state, t)) {
                    let soon = self.slip_soon(events, friction, (sides, &dropped), t)?;
                    is_held = length(&soon) * self.stretch <= STANDS * (size(state.0) + self.speed() * self.stretch);
                    if !is_held && soon[0] * direction[0] < 0.0 {
                        all.extend(self.turns(events, friction, (unit(&soon), [0.0; 2]), sides));
                    }
                }
            }
            all.extend(events.held(friction, is_held, sides));
        }
        Ok(all)
    }

    /// How joints and drivers have surfaces slip a little later.
    fn slip_soon(
        &mut self,
        events: &Events,
        friction: usize,
        (sides, dropped): (&[f64], &[usize]),
        t: f64,
    ) -> Result<Vec<f64>, RunError> {
        let set = events.set_without_friction(sides);
        let (p, end, soon) = (self.p.clone(), self.record.end, t + AHEAD * self.stretch);
        ImpactRecord { set, ..ImpactRecord::default() }.set_parameters(&[], &mut self.p);
        self.record.end = soon;
        let solved = self.impact(events.friction(friction).joints[0], (dropped, &[]), Unknowns::default());
        (self.p, self.record.end) = (p, end);
        let ([mut v, q], _) = self.state();
        add_scaled(&mut v, &solved?.unknowns.x, 1.0);
        Ok(real(&events.slip(friction, [&v, &q], soon.into(), &self.p)))
    }

    /// That no limit of friction is below zero.
    pub(super) fn check_limits(&self, events: &Events, (q, v): (&[S], &[S]), t: f64) -> Result<(), RunError> {
        let [q, v, p] = [q, v, &self.p].map(real);
        let none = vec![0.0; self.problem.model.equations];
        let moment = Moment { a: &[], v: &v, q: &q, mu: [&none, &[]], t };
        let negative = |own: &usize| events.friction(*own).kept.len() == 1 && events.exceeds(*own, moment, &p, 0.0);
        let Some(friction) = (0..events.frictions().len()).find(negative) else { return Ok(()) };
        let name = &self.problem.model.constraints[events.friction(friction).joints[0]].name;
        let t = shortest(t);
        Err(RunError::Input(format!(
            "the limit of the friction of \"{name}\" is below zero at t = {t} s: friction never drives a motion"
        )))
    }

    /// Of surfaces that are together at the start, those that stick if they can; the others slip.
    pub(super) fn frictions_at_start(
        &mut self,
        events: &Events,
        (q, v): (&[S], &[S]),
        t: f64,
        (sides, closed): (&mut [f64], &[(usize, &Stop)]),
    ) -> Result<Vec<usize>, RunError> {
        let mut sticking = Vec::new();
        self.check_limits(events, (q, v), t)?;
        for (friction, own) in events.frictions().enumerate() {
            let joint = own.joints[0];
            let is_closed = closed.iter().any(|own| own.0 == joint);
            if !is_closed && events.presence_of(joint, sides) == Some(false) {
                continue;
            }
            let slip = real(&events.slip(friction, [v, q], t.into(), &self.p));
            if length(&slip) <= CONSISTENT * size(v) {
                sticking.push(friction);
            } else {
                set(&self.turns(events, friction, along(&slip), sides), sides);
            }
        }
        Ok(sticking)
    }

    /// What becomes of surfaces whose joint, or what made them stick, has been opened; and of those that what sticks no more has held so far: these
    /// stick, as far as they can, where they would begin to slip against their friction.
    pub(super) fn opened(
        &mut self,
        events: &Events,
        joint: usize,
        (sides, changes): Sides,
        is_made_again: bool,
    ) -> Result<(), RunError> {
        for (friction, own) in events.frictions().enumerate() {
            let mut all = Vec::new();
            if own.joints[0] == joint {
                all.extend(events.presence_change(own.joints[1], false, sides));
                all.extend(self.stands(events, friction, sides));
            } else if own.joints[1] == joint {
                all = match is_made_again {
                    // the forces were those behind all that happened before it
                    true => changes.iter().copied().filter(|change| events.is_of(friction, change.switch)).collect(),
                    false => self.slips(events, friction, &self.forces, sides),
                };
            }
            self.change(events, &all, (sides, changes), is_made_again);
        }
        let Some(breaks_away) = events.frictions().position(|own| own.joints[1] == joint) else { return Ok(()) };
        for (friction, own) in events.frictions().enumerate() {
            if friction == breaks_away || !events.is_held(friction, sides) {
                continue;
            }
            let stick = events.presence(own.joints[1]);
            let is_its = |own: &SideChange| events.is_of(friction, own.switch) || own.switch == stick;
            let all = match is_made_again {
                true => changes.iter().copied().filter(is_its).collect(),
                false if self.is_against(events, friction, breaks_away, sides)? => self.sticks(events, friction, sides),
                false => Vec::new(),
            };
            self.change(events, &all, (sides, changes), is_made_again);
        }
        Ok(())
    }

    /// Whether surfaces at rest begin to slip where their friction pushes them, and not against it, where others break away: what pulls these decides, as
    /// their own friction balances it at first.
    fn is_against(&mut self, events: &Events, friction: usize, breaks_away: usize, sides: &[f64]) -> Result<bool, RunError> {
        let [q, v] = [0, 1].map(|order| self.between.carried[order].clone());
        let mut free = sides.to_vec();
        set(&self.stands(events, breaks_away, sides), &mut free);
        let a = self.accelerations_with(events, &free, (&q, &v), self.record.end)?.x;
        let none = vec![S::zero(); a.len()];
        let rates = [&a, &none].map(|v| real(&events.slip(friction, [v, &q], self.record.end.into(), &self.p)));
        let direction = events.direction(friction, sides).iter();
        Ok(direction.zip(&rates[0]).zip(&rates[1]).map(|((d, rate), none)| d * (rate - none)).sum::<f64>() < 0.0)
    }

    fn change(&mut self, events: &Events, all: &[SideChange], (sides, changes): Sides, is_made_again: bool) {
        set(all, sides);
        events.write_directions(sides, &mut self.p);
        if !is_made_again {
            changes.extend(all);
        }
    }

    /// Where slip along a direction has come to its end: surfaces stick, or slip on in another direction. Each is told by changes, from a place in their
    /// list on.
    pub(super) fn end_slips(&mut self, events: &Events, first: usize, (sides, changes): Sides, is_made_again: bool) {
        for place in first..changes.len() {
            let change = changes[place];
            let Some(friction) = events.slip_ended_by(change.switch).filter(|_| change.sides[0] < 0.0) else { continue };
            set(&[change], sides);
            let goes_on = match is_made_again {
                true if events.sticks_by(friction, changes) => None,
                true => Some(changes.iter().copied().filter(|own| events.is_of(friction, own.switch)).collect()),
                false => self.slip_on(events, friction, sides),
            };
            match goes_on {
                Some(all) => self.change(events, &all, (sides, changes), is_made_again),
                None if is_made_again => {}
                None => changes.extend(events.presence_change(events.friction(friction).joints[1], true, sides)),
            }
        }
    }

    /// Whether surfaces do not stick after all where an event was to tell that they do, as what happened before it at the same time has moved them.
    pub(super) fn slips_after_all(&mut self, events: &Events, event: usize, (sides, changes): Sides) -> bool {
        let Some(friction) = events.slip_ended_at(event) else { return false };
        let Some(all) = self.slip_on(events, friction, sides) else { return false };
        let stick = events.presence(events.friction(friction).joints[1]);
        changes.retain(|own| own.switch != stick || own.sides[1] == 0.0);
        self.change(events, &all, (sides, changes), false);
        true
    }

    /// The changes by which surfaces slip on in another direction where their slip along one has come to its end; `None` where they stick.
    fn slip_on(&mut self, events: &Events, friction: usize, sides: &[f64]) -> Option<Vec<SideChange>> {
        let direction = events.direction(friction, sides).to_vec();
        let mut there = sides.to_vec();
        there[events.presence(events.friction(friction).joints[1])] = 1.0;
        let dropped = self.dropped_behind(&events.absent(&there));
        let [q, v] = [0, 1].map(|order| &self.between.carried[order][..]);
        if self.is_driven(events, friction, &dropped, ((q, v), self.record.end)) {
            // it passes the place where it stands without force
            let turned: Vec<f64> = direction.iter().map(|own| -own).collect();
            return Some(self.turns(events, friction, (turned, [0.0; 2]), sides));
        }
        let slip = real(&self.slip(events, friction));
        let v = size(&self.record.carried[1]);
        if slip.len() == 1 {
            // what is set, or an impact elsewhere, may turn it round
            return (length(&slip) > CONSISTENT * v).then(|| self.turns(events, friction, along(&slip), sides));
        }
        let speed = v.max(BEFORE_LONG * self.stretch * size(&self.between.last.x)).max(LEAST_SPEED);
        let across = (direction[0] * slip[1] - direction[1] * slip[0]).abs();
        let is_straight = across <= STRAIGHT * length(&slip);
        if length(&slip) > ENDS[usize::from(!is_straight)] * speed {
            return Some(self.turns(events, friction, along(&slip), sides));
        }
        let on_a_line = (unit(&slip), [near(ALONG_A_LINE * length(&slip)), 0.0]);
        events.has_least_slip(friction, sides).then(|| self.turns(events, friction, on_a_line, sides))
    }

    /// The impact by which joints are closed that are hit together: what is held at stops may be torn off, surfaces stick as far as friction lets them. Of
    /// several stops some may be let go, which others move away: these are returned, too.
    pub(super) fn close(
        &mut self,
        events: &Events,
        hits: &[Hit],
        number: usize,
        (sides, changes): Sides,
        is_made_again: bool,
    ) -> Result<(ImpactRecord<S>, Vec<usize>), RunError> {
        let model = self.problem.model;
        let (joint, alone) = (hits[0].joint, Some(hits[0].joint).filter(|_| hits.len() == 1));
        let others = hits[1..].iter().map(|own| OtherHit { row: own.row, restitution: own.restitution }).collect();
        let impulses = hits.iter().filter_map(|own| own.impulse).collect();
        let mut impact =
            ImpactRecord { event: number, restitution: hits[0].restitution, others, impulses, ..ImpactRecord::default() };
        let shares = impact.shares(&self.p);
        let before = sides.to_vec();
        let mut now = before.clone();
        // others that are hit are held as far as they would still move on
        now[events.presence(joint)] = 1.0;
        if let Some(friction) = events.frictions().position(|own| own.joints.contains(&joint)) {
            set(&self.sticks(events, friction, &now), &mut now);
        }
        let slipping = |sides: &[f64]| -> Vec<usize> {
            let slips = |friction: &usize| events.direction(*friction, sides).iter().any(|own| *own != 0.0);
            (0..model.frictions.len()).filter(|own| model.frictions[*own].kept.len() == 2).filter(slips).collect()
        };
        for friction in slipping(&now) {
            let direction = events.direction(friction, &now).to_vec();
            set(&events.turn(friction, &direction, self.blunt(), &now), &mut now);
        }
        let (mut treated, mut choice) = (Treated::default(), Choice::default());
        for _ in 0..MOST_CHANGES + events.stops().count() {
            impact.dropped = self.dropped_behind(&events.absent(&now));
            impact.axes = self.axes(events, &now, &impact.dropped);
            let aligned = self.align(events, &impact.axes, &now);
            if !aligned.is_empty() {
                set(&aligned, &mut now);
                events.write_directions(&now, &mut self.p);
                impact.dropped = self.dropped_behind(&events.absent(&now));
            }
            impact.set = events.set_in_impact(&now);
            // what comes to stand does so behind its restitution
            let comes_to_stand = |own: &usize| {
                let stick = events.presence(events.friction(*own).joints[1]);
                impact.restitution.is_some() && now[stick] > 0.0 && before[stick] == 0.0
            };
            let slip = |friction| SlipBefore { friction, slip: self.slip(events, friction) };
            let kept = (0..model.frictions.len()).filter(comes_to_stand).map(slip).collect();
            impact.kept = kept;
            let p = self.p.clone();
            impact.set_parameters(&model.frictions, &mut self.p);
            // those that an impact leaves as they are have derivatives
            let mut directions = self.directions.clone();
            events.turned(&self.between.sides, &now).into_iter().for_each(|own| directions[own].slip = None);
            let stands = |friction: &usize| events.direction(*friction, &now).iter().all(|own| *own == 0.0);
            (0..directions.len()).filter(stands).for_each(|own| directions[own].slip = None);
            events.write_turned(&directions, &mut self.p);
            let all = slipping(&now);
            let are_near = !all.is_empty() && all.iter().all(|own| treated.aimed.iter().any(|aimed| aimed.0 == *own));
            let first = match are_near {
                // from the last one, whose surfaces slipped in a direction near by
                true => Ok(std::mem::take(&mut impact.solve.unknowns)),
                false => self.impact_without_friction(events, joint, (&now, &impact.dropped, &shares)),
            };
            let solved = first.and_then(|first| self.impact(joint, (&impact.dropped, &shares), first));
            let of_impact = std::mem::replace(&mut self.p, p);
            impact.solve = solved?;
            let mu = real(&impact.solve.unknowns.mu);
            if let Some(torn) = events.torn(&now, (alone, &mu), self.no_impulse(), &mut choice) {
                now[events.presence(torn)] = 0.0;
                for friction in (0..model.frictions.len()).filter(|own| model.frictions[*own].joints[0] == torn) {
                    now[events.presence(model.frictions[friction].joints[1])] = 0.0;
                    set(&self.stands(events, friction, &now), &mut now);
                }
                continue;
            }
            match self.violated_friction(events, (hits, &impact), &of_impact, &now, &mut treated) {
                None => {
                    if let Some(held) = self.hit_again(events, (hits, &impact, &of_impact), [&before, &now], &choice) {
                        choice.hold(held);
                        now[events.presence(held)] = 1.0;
                        if let Some(friction) = events.frictions().position(|own| own.joints[0] == held) {
                            let slip = self.slip_behind(events, friction, (&impact, &of_impact));
                            let again = match moves(&slip, self.speed()) {
                                true => self.turns(events, friction, (unit(&slip), self.blunt()), &now),
                                false => self.sticks(events, friction, &now),
                            };
                            set(&again, &mut now);
                        }
                        continue;
                    }
                    for Hit { joint, stop, row, restitution, .. } in hits {
                        let own = events.frictions().position(|own| own.joints[0] == *joint);
                        let pushes = |stop: &Stop| stop.pushes(mu[*row]);
                        if alone.is_some() && own.is_some() && !stop.as_ref().is_none_or(pushes) {
                            return Err(self.no_law(*joint));
                        }
                        // what bounces neither sticks nor slips behind it
                        if let Some(own) = own.filter(|_| restitution.is_some()) {
                            now[events.presence(model.frictions[own].joints[1])] = 0.0;
                            set(&self.stands(events, own, &now), &mut now);
                        }
                    }
                    for friction in slipping(&now).into_iter().filter(|own| !treated.sharp.contains(own)) {
                        let direction = events.direction(friction, &now).to_vec();
                        set(&events.turn(friction, &direction, self.still(), &now), &mut now);
                    }
                    for (hit, own, stop) in events.stops() {
                        let presence = events.presence(own);
                        let is_hit = hits.iter().any(|hit| hit.joint == own);
                        if !is_hit && now[presence] > 0.0 && before[presence] == 0.0 {
                            let holds: Vec<SideChange> =
                                events.free(hit, stop, &now).into_iter().chain(events.pushing(own, stop, &now)).collect();
                            set(&holds, &mut now);
                        }
                    }
                    let mut let_go = Vec::new();
                    for Hit { joint, .. } in hits {
                        let presence = events.presence(*joint);
                        let_go.extend(Some(*joint).filter(|_| now[presence] == 0.0));
                        now[presence] = before[presence];
                    }
                    let changed = (0..now.len()).filter(|&switch| now[switch] != before[switch]);
                    let all: Vec<SideChange> =
                        changed.map(|switch| SideChange { switch, sides: [before[switch], now[switch]] }).collect();
                    self.change(events, &all, (sides, changes), is_made_again);
                    return Ok((impact, let_go));
                }
                Some(all) => set(&all, &mut now),
            }
        }
        Err(self.no_law(joint))
    }

    /// The impact of a joint whose surfaces slip without friction, from which one with it is found: limits are convex in the impulses, so that of several
    /// solutions of Coulomb's law Newton's method then comes to that with the least friction, the one that follows from none.
    fn impact_without_friction(
        &mut self,
        events: &Events,
        joint: usize,
        (sides, dropped, shares): (&[f64], &[usize], &[(usize, S)]),
    ) -> Result<Unknowns<S>, RunError> {
        if (0..events.frictions().len()).all(|own| events.direction(own, sides).iter().all(|d| *d == 0.0)) {
            return Ok(Unknowns::default());
        }
        let p = self.p.clone();
        events.set_without_friction(sides).into_iter().for_each(|(place, own)| self.p[place] = S::from(own));
        let solved = self.impact(joint, (dropped, shares), Unknowns::default());
        self.p = p;
        Ok(solved?.unknowns)
    }

    /// How surfaces slip behind an impact.
    fn slip_behind(&self, events: &Events, friction: usize, (impact, p): (&ImpactRecord<S>, &[S])) -> Vec<f64> {
        let ([mut v, q], t) = self.state();
        impact.add_to(&mut v, p, S::one());
        events.slip(friction, [&real(&v), &real(&q)], t.value(), &real(&self.p))
    }

    /// Of the stops that an impact was to tear off or let go, or that are touched at rest, that which moves on most beyond its limit behind the impact.
    fn hit_again(
        &self,
        events: &Events,
        (hits, impact, p): (&[Hit], &ImpactRecord<S>, &[S]),
        [before, now]: [&[f64]; 2],
        choice: &Choice,
    ) -> Option<usize> {
        let ([v, q], t) = self.state();
        let mut behind = v.clone();
        impact.add_to(&mut behind, p, S::one());
        let (nowhere, nothing) = (CONSISTENT * size(&q), self.no_speed());
        let beyond = |(hit, own, stop): (usize, usize, &Stop)| {
            let motion = |v: &[S]| self.equations_of(own, (&[], v, &q), t.value())[0];
            let [g, rate, _] = motion(&behind);
            let is_touched = || g.abs() <= nowhere && motion(&v)[1].abs() <= nothing && events.can_be_hit(hit, before);
            let was_held = before[events.presence(own)] > 0.0;
            let hit = hits.iter().find(|hit| hit.joint == own);
            // it would come back more slowly than by its restitution
            let e = hit.and_then(|own| own.restitution).map_or(0.0, |place| p[place].value());
            let rate = if hit.is_some() { rate + e * motion(&v)[1] } else { rate };
            let rate = if stop.is_upper { rate } else { -rate };
            (rate > nothing && (hit.is_some() || was_held || is_touched())).then_some((own, rate))
        };
        let open = events.stops().filter(|own| now[events.presence(own.1)] == 0.0 && choice.may_hold(own.1));
        let all = open.filter_map(beyond);
        all.max_by(|one, other| one.1.total_cmp(&other.1)).map(|own| own.0)
    }

    fn no_law(&self, joint: usize) -> RunError {
        let what = format!("the impact of \"{}\"", self.problem.model.constraints[joint].name);
        no_solution(&what, "no", self.record.end)
    }

    /// Whether surfaces that are together at stops keep Coulomb's law by these forces alone: those that slip would part without their contact or be
    /// held by it as well, or would not part without it and cannot be held.
    pub(super) fn check_contacts(
        &mut self,
        events: &Events,
        sides: &[f64],
        (q, v): (&[S], &[S]),
        t: f64,
    ) -> Result<(), RunError> {
        let sizes = [size(q), size(v)];
        for (friction, own) in events.frictions().enumerate() {
            let [joint, stick] = own.joints;
            let Some((_, _, stop)) = events.stops().find(|stop| stop.1 == joint) else { continue };
            let (is_closed, sticks) = (sides[events.presence(joint)] > 0.0, sides[events.presence(stick)] > 0.0);
            let [g, rate, _] = self.equations_of(joint, (&[], v, q), t)[0];
            if sticks || g.abs() > CONSISTENT * sizes[0] || rate.abs() > CONSISTENT * sizes[1] {
                continue;
            }
            let [parting, nothing] = self.parting(events, friction, stop, (sides, q, v), t)?;
            let what = format!("the contact \"{}\", which slips,", self.problem.model.constraints[joint].name);
            if is_closed && parting > nothing {
                return Err(no_solution(&what, "more than one", t));
            } else if !is_closed && parting < -nothing {
                return Err(no_solution(&what, "no", t));
            }
        }
        Ok(())
    }

    /// Accelerations of a state with other sides: without joints, or with other directions of slip.
    fn accelerations_with(
        &mut self,
        events: &Events,
        sides: &[f64],
        state: (&[S], &[S]),
        t: f64,
    ) -> Result<Unknowns<S>, RunError> {
        let p = self.p.clone();
        events.write_directions(sides, &mut self.p);
        let dropped = self.dropped_with(&events.absent(sides), state, t);
        let made = self.accelerations_at(state, t, &dropped);
        self.p = p;
        made
    }

    /// How fast surfaces would begin to part without their contact, and how much of that is none.
    fn parting(
        &mut self,
        events: &Events,
        friction: usize,
        stop: &Stop,
        (sides, q, v): (&[f64], &[S], &[S]),
        t: f64,
    ) -> Result<[f64; 2], RunError> {
        let joint = events.friction(friction).joints[0];
        let mut without = sides.to_vec();
        without[events.presence(joint)] = 0.0;
        set(&self.stands(events, friction, sides), &mut without);
        let a = self.accelerations_with(events, &without, (q, v), t)?.x;
        let [_, _, parting] = self.equations_of(joint, (&a, v, q), t)[0];
        Ok([if stop.is_upper { -parting } else { parting }, CONSISTENT * size(&a)])
    }

    /// Whether surfaces that slip at stops have come to where no force, or more than one, keeps Coulomb's law: a force that grows without bound before
    /// and pulls behind it, though without it they would not part.
    pub(super) fn check_slip(&mut self) -> Result<(), RunError> {
        let Some(events) = self.events.take() else { return Ok(()) };
        let checked = self.check_slip_with(&events);
        self.events = Some(events);
        checked
    }

    fn check_slip_with(&mut self, events: &Events) -> Result<(), RunError> {
        let (sides, t) = (self.between.sides.clone(), self.record.end);
        if sides.is_empty() {
            // nothing is left of a step that failed
            return Ok(());
        }
        for (friction, own) in events.frictions().enumerate() {
            let joint = own.joints[0];
            let slips = events.direction(friction, &sides).iter().any(|own| *own != 0.0);
            let Some((_, _, stop)) = events.stops().find(|own| own.1 == joint).filter(|_| slips) else { continue };
            let row = self.problem.model.constraints[joint].equations.start;
            let Some(force) = self.between.forces.get(row).map(|own| own.value()) else { continue };
            self.watched.resize(events.frictions().len(), force);
            let share = force / self.watched[friction];
            if (1.0 / GROWS..GROWS).contains(&share) && stop.pushes(force) {
                continue;
            }
            let ([v, q], _) = self.state();
            let [parting, nothing] = self.parting(events, friction, stop, (&sides, &q, &v), t)?;
            let how_many = match stop.pushes(force) {
                true if parting > nothing => "more than one",
                false if parting < -nothing => "no",
                _ => {
                    self.watched[friction] = force;
                    continue;
                }
            };
            let what = format!("the contact \"{}\", which slips,", self.problem.model.constraints[joint].name);
            return Err(no_solution(&what, how_many, t));
        }
        Ok(())
    }

    /// Why a step from the state that is carried fails, if surfaces slip at stops and friction has made their force many times what it would be without.
    pub(super) fn check_jamming(&mut self, t: f64) -> Result<(), RunError> {
        let Some(events) = self.events.take() else { return Ok(()) };
        let checked = self.check_jamming_with(&events, t);
        self.events = Some(events);
        checked
    }

    fn check_jamming_with(&mut self, events: &Events, t: f64) -> Result<(), RunError> {
        let sides = self.between.sides.clone();
        let ([v, q], _) = self.state();
        for (friction, own) in events.frictions().enumerate() {
            let slips = events.direction(friction, &sides).iter().any(|own| *own != 0.0);
            if !slips || !events.stops().any(|stop| stop.1 == own.joints[0]) {
                continue;
            }
            let mut smooth = sides.clone();
            set(&self.stands(events, friction, &sides), &mut smooth);
            let row = self.problem.model.constraints[own.joints[0]].equations.start;
            let forces = [&sides, &smooth].map(|sides| {
                let made = self.accelerations_with(events, sides, (&q, &v), t);
                made.map(|own| own.mu[row].value().abs())
            });
            let joint = &self.problem.model.constraints[own.joints[0]];
            if let [Ok(rough), Ok(smooth)] = forces
                && rough > JAMS * smooth
            {
                return Err(no_solution(&format!("the contact \"{}\", which slips,", joint.name), "no", t));
            }
        }
        Ok(())
    }

    /// A time within which forces are as good as impulses: that of the step made last, or [`BEFORE_LONG`] of the run where an event cut it.
    pub(super) fn time_of_impulses(&self) -> f64 {
        self.record.h.max(BEFORE_LONG * self.stretch)
    }

    /// What counts as no impulse: a share of that of the forces within this time.
    fn no_impulse(&self) -> f64 {
        NO_FORCE * self.time_of_impulses() * self.forces.iter().fold(0.0, |most: f64, own| most.max(own.abs()))
    }

    /// Surfaces that an impact treats otherwise than friction does, as the changes that mend it: what sticks by more than friction can hold, which is
    /// added to those that did, what slips against it, and what others keep from sticking or slipping.
    fn violated_friction(
        &self,
        events: &Events,
        (hits, impact): (&[Hit], &ImpactRecord<S>),
        p: &[S],
        now: &[f64],
        treated: &mut Treated,
    ) -> Option<Vec<SideChange>> {
        let (mut state, t) = self.state();
        let mut in_impact = real(&state[0]);
        add_scaled(&mut in_impact, &real(&impact.solve.unknowns.x), 1.0);
        impact.add_to(&mut state[0], p, S::one());
        let ([v, q], mu, p) = (state.each_ref().map(|own| real(own)), real(&impact.solve.unknowns.mu), real(p));
        // of the slip that it keeps nothing is left
        let (none, behind) = (self.no_impulse(), real(&self.p));
        let moment = Moment { a: &[], v: &v, q: &q, mu: [&mu, &[]], t: t.value() };
        let turns = |friction: usize, direction: Vec<f64>| self.turns(events, friction, (direction, self.blunt()), now);
        let slip_of = |friction: usize| events.slip(friction, [&v[..], &q], t.value(), &behind);
        let stick_of = |own: &JointFriction| events.presence(own.joints[1]);
        // what bounces is apart behind it
        let is_hit = |joint: usize| hits.iter().find(|own| own.joint == joint);
        let bounces = |own: &JointFriction| is_hit(own.joints[0]).is_some_and(|own| own.restitution.is_some());
        for (friction, own) in events.frictions().enumerate().filter(|(_, own)| now[stick_of(own)] > 0.0 && !bounces(own)) {
            let slip = slip_of(friction);
            if moves(&slip, self.speed()) {
                // others hold it, and do not let it stick
                treated.forget(friction);
                let mut all = turns(friction, unit(&slip));
                all.extend(events.presence_change(own.joints[1], false, now));
                return Some(all);
            }
        }
        for (friction, own) in events.frictions().enumerate() {
            let stick = stick_of(own);
            let (direction, slip) = (events.direction(friction, now), slip_of(friction));
            // what has come to stand needs no impulse
            let stands = is_hit(own.joints[1]).is_some();
            if now[stick] > 0.0 && !stands && events.exceeds(friction, moment, &p, none) {
                treated.broken.push(friction);
                treated.forget(friction);
                let pull = &mu[self.problem.model.constraints[own.joints[1]].equations.clone()];
                let mut all = turns(friction, unit(&from_axis(pull, events.axis(friction, now))));
                all.extend(events.presence_change(own.joints[1], false, now));
                return Some(all);
            }
            if direction.iter().all(|own| *own == 0.0) {
                continue;
            }
            if !moves(&slip, self.speed()) && is_hit(own.joints[0]).is_none() && !treated.broken.contains(&friction) {
                return Some(self.sticks(events, friction, now));
            }
            // two directions are those of the slip before restitution
            let slip =
                if direction.len() < 2 { slip } else { events.slip(friction, [&in_impact[..], &q], t.value(), &behind) };
            let forth: f64 = slip.iter().zip(direction).map(|(slip, own)| slip * own).sum();
            let steps: Vec<f64> = treated.aimed.iter().filter(|own| own.0 == friction).map(|own| own.1).collect();
            // what broke away may turn from the direction that it is given to its own, but not if nothing is left of it then
            let is_left = steps.len() < AIMS.len() || steps.last().is_some_and(|near| length(&slip) > *near);
            let is_turning = treated.broken.contains(&friction) || !steps.is_empty();
            let may_turn = direction.len() == 2 && is_turning && is_left && !treated.sharp.contains(&friction);
            if forth < -CONSISTENT * size(&v) && !may_turn {
                // without a load it goes the way it is sent
                return Some(match events.is_unloaded(friction, moment, &p, none) {
                    true => {
                        treated.forget(friction);
                        turns(friction, unit(&slip))
                    }
                    false => self.sticks(events, friction, now),
                });
            }
            // the direction of friction is that of the slip, not of the force that broke it away
            let sharp = near(SHARP * length(&slip));
            if direction.len() < 2 || sharp <= 2.0 * LEAST_SPEED || treated.sharp.contains(&friction) {
                continue;
            }
            if let Some(share) = AIMS.get(steps.len()) {
                treated.aimed.push((friction, share * length(&slip)));
                return Some(self.turns(events, friction, (direction.to_vec(), [near(share * length(&slip)), 0.0]), now));
            }
            treated.sharp.push(friction);
            return Some(self.turns(events, friction, (unit(&slip), [sharp, 0.0]), now));
        }
        None
    }
}
