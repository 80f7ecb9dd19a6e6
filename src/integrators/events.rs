//! Switches of elements, and conditions of events, at which steps end.
//!
//! The residual of an element uses, in a step, the sides of its switches that hold at the start of the step, whatever its numbers tell: the step is
//! a smooth map of its length. Where the number g(q, v, t, p) of a switch passes the end of its side at the end of a step, that step is made again
//! with the length h for which g = 0 but for round-off; the next one goes on with the other side. The time of the event is thus a property of the
//! discrete run, with derivatives by g = 0. Where an event happens, what it sets gets its values from the state at the end of the step, from which the
//! next one then starts.
//!
//! Source: Hairer, Norsett, Wanner, Solving ODEs I, II.6; Galan, Feehery, Barton, Appl. Numer. Math. 31 (1999), for the derivatives.

use super::crossings::Place;
use crate::assembly::{Attached, Closing, Event, JointFriction, Model, Reset, Stop, Target};
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::program::{Excess, Formula, ProgramWork, Reads, Switches};
use crate::tolerances::CONSISTENT;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// A side that changes between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideChange {
    /// Number of the switch among all of the model; behind these one for each event, 1 where it has happened and does so no second time, or hits a stop
    /// that was taken away, one for each
    /// joint that comes and goes, 1 where it is there, and of each friction the direction in which it slips, 0 where it does not, with a 1 behind it where
    /// others hold it at its limit, and of two velocities the direction along which the first equation of what sticks is.
    pub switch: usize,
    /// The side before, and behind.
    pub sides: [f64; 2],
}

impl SideChange {
    /// Whether nothing changes: what stands before it in a list has happened, with all that holds, when what stands behind it happens.
    pub fn is_mark(&self) -> bool {
        self.sides[0] == self.sides[1]
    }
}

/// Directions of a friction of two velocities with their derivative parts: of its slip, and of the first equation of what sticks.
#[derive(Clone, Copy)]
pub struct Directions<S> {
    pub slip: Option<[S; 2]>,
    pub axis: Option<[S; 2]>,
}

crate::assembly::empty_fields!(Directions { slip, axis });

/// A joint that is closed by an impact.
pub struct Hit {
    /// The event that closes it.
    pub event: usize,
    pub joint: usize,
    pub stop: Option<Stop>,
    /// The change by which it is there.
    pub closing: SideChange,
    /// Its first equation.
    pub row: usize,
    /// Place in p of its restitution.
    pub restitution: Option<usize>,
    /// Places in mu and in v of an impulse, and of the state to which its size is added.
    pub impulse: Option<[usize; 2]>,
}

/// A state between two steps.
#[derive(Clone, Copy)]
pub struct Moment<'s, S> {
    pub a: &'s [S],
    pub v: &'s [S],
    pub q: &'s [S],
    /// Multipliers, and their changes by time.
    pub mu: [&'s [S]; 2],
    pub t: S,
}

/// A number that an event has set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetNumber<S> {
    /// Number of the event, among those that happen there.
    pub event: usize,
    pub target: Target,
    pub value: S,
}

/// An element or event with switches.
struct Part {
    name: String,
    switches: Switches,
    places: Vec<Place>,
    /// Number of the event, if it is one.
    event: Option<usize>,
    /// Number of its first switch.
    first: usize,
    count: usize,
}

/// All switches of a model that are located.
#[derive(Default)]
pub struct Events {
    parts: Vec<Part>,
    events: Vec<Happening>,
    /// Joints that come and go, their equations, and whether they are there at the start.
    joints: Vec<(usize, Range<usize>, bool)>,
    frictions: Vec<Slip>,
    /// Where the sides stand in p.
    places: Vec<usize>,
    known: Known,
    work: ProgramWork<f64>,
    numbers: Vec<f64>,
}

/// What is asked for again and again, by number.
#[derive(Default)]
struct Known {
    /// The part that tells an event.
    conditions: Vec<Option<usize>>,
    /// Parts that tell events by forces.
    releases: Vec<usize>,
    /// Of a joint its place among those that come and go, and the part that tells of the event which removes it by a force.
    of_joints: HashMap<usize, (usize, Option<usize>)>,
    /// The friction whose slip ends with an event.
    ends_of_slip: HashMap<usize, usize>,
    /// Events that hit stops, with the place of the stop among what they close.
    stops: Vec<(usize, usize)>,
}

/// An event of the model.
struct Happening {
    directions: [bool; 2],
    once: bool,
    ends_run: bool,
    /// Which side of a joint's presence must hold.
    condition: Option<(usize, f64)>,
    resets: Vec<(Reset, Vec<Place>)>,
    opens: Vec<usize>,
    closes: Vec<Closing>,
    /// Events that hit stops which it takes away, and which it brings back.
    stops: [Vec<usize>; 2],
}

/// Which stops hold, on the way to those that do.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// Multipliers by which all push, by their size.
    pushing: Vec<f64>,
    /// The joint of the stop that was the last to be held.
    last: Option<usize>,
    /// Those that pulled as soon as they were held.
    at_limit: Vec<usize>,
}

impl Choice {
    /// Whether a stop beyond whose limit the motion goes is to hold.
    pub fn may_hold(&self, joint: usize) -> bool {
        !self.at_limit.contains(&joint)
    }

    /// That it does.
    pub fn hold(&mut self, joint: usize) {
        self.last = Some(joint);
    }
}

/// How a joint with friction slips.
struct Slip {
    own: JointFriction,
    /// Place of its direction among all sides.
    first: usize,
    /// Its slip as a formula, and places of the arguments.
    formula: Arc<Formula>,
    places: Vec<Place>,
}

/// Which vectors of a state a formula reads, in the order of its arguments.
type Lists<'l> = &'l [fn(usize) -> Place];

/// A part before its switches are known.
type Switching<'m, P> = (&'m Attached<P>, &'m Arc<Formula>, usize);

impl Events {
    pub fn new(model: &Model) -> Self {
        let mut events = Events::default();
        let mut known = HashMap::new();
        for own in model.elements.iter().filter(|own| own.physics.sides() > 0) {
            events.add(model, &mut known, (own, own.physics.residual(), own.physics.sides()), (OF_ELEMENT, &[]), None);
        }
        for own in &model.measured {
            events.add(model, &mut known, (own, &own.physics, own.physics.sides()), (OF_ELEMENT, &[]), None);
        }
        let equations = |joint: usize| model.constraints[joint].equations.clone();
        events.joints = model.presence.iter().map(|&(joint, is_there)| (joint, equations(joint), is_there)).collect();
        for (number, own) in model.events.iter().enumerate() {
            let Event { condition, multipliers, directions, once, ends_run, while_joint, resets, opens, closes } =
                own.clone();
            let condition = &condition;
            events.add(model, &mut known, (condition, &condition.physics, 1), (OF_EVENT, &multipliers), Some(number));
            let place = |joint: usize| model.presence.iter().position(|own| own.0 == joint);
            let places = |own: &Reset| super::crossings::places(model, OF_EVENT, &own.values.nodes, &own.values.parameters);
            let resets = resets
                .into_iter()
                .map(|own| {
                    let places = places(&own);
                    (own, places)
                })
                .collect();
            // what holds at a stop lets go by itself, and the stop stays
            let is_own = |joint: usize| while_joint == Some((joint, true));
            let hit_of =
                |joint: &usize| model.events.iter().position(|own| own.closes.iter().any(|own| own.is_stop(*joint)));
            let taken = opens.iter().filter(|joint| !is_own(**joint)).filter_map(hit_of).collect();
            let (closes, brought): (Vec<Closing>, Vec<Closing>) =
                closes.into_iter().partition(|own| own.stop.is_some() || hit_of(&own.joint).is_none());
            let stops = [taken, brought.iter().filter_map(|own| hit_of(&own.joint)).collect()];
            let condition = while_joint.and_then(|(joint, is_there)| Some((place(joint)?, f64::from(u8::from(is_there)))));
            events.events.push(Happening { directions, once, ends_run, condition, resets, opens, closes, stops });
        }
        let mut first = events.switches() + events.events.len() + events.joints.len();
        for own in &model.frictions {
            let sticking = &model.constraints[own.joints[1]];
            let places = super::crossings::places(model, OF_EVENT, &sticking.nodes, &sticking.parameters);
            events.frictions.push(Slip { own: own.clone(), first, formula: Arc::clone(sticking.physics.formula()), places });
            first += own.sides();
        }
        events.known = events.find_all();
        events
    }

    fn find_all(&self) -> Known {
        let Events { parts, events, joints, frictions, .. } = self;
        let mut known = Known { conditions: vec![None; events.len()], ..Known::default() };
        known.of_joints = joints.iter().enumerate().map(|(place, own)| (own.0, (place, None))).collect();
        for (number, part) in parts.iter().enumerate() {
            let Some(event) = part.event else { continue };
            known.conditions[event] = Some(number);
            if part.is_by_force() {
                known.releases.push(number);
                for joint in &events[event].opens {
                    known.of_joints.entry(*joint).and_modify(|own| own.1 = own.1.or(Some(number)));
                }
            }
        }
        known.ends_of_slip = frictions.iter().enumerate().map(|(friction, own)| (own.own.events[0], friction)).collect();
        for (event, own) in events.iter().enumerate() {
            known.stops.extend((0..own.closes.len()).filter(|&k| own.closes[k].stop.is_some()).map(|k| (event, k)));
        }
        known
    }

    fn add<P>(
        &mut self,
        model: &Model,
        known: &mut HashMap<*const Formula, Option<Switches>>,
        (own, formula, count): Switching<P>,
        (lists, multipliers): (Lists, &[usize]),
        event: Option<usize>,
    ) {
        let switches = known.entry(Arc::as_ptr(formula)).or_insert_with(|| formula.switches(Reads::Located, false));
        let Some(switches) = switches.clone() else { return };
        assert_eq!(switches.count(), count, "each switch of \"{}\" has one side", own.name);
        let first = self.places.len();
        self.places.extend(own.parameters.end - count..own.parameters.end);
        let mut places = super::crossings::places(model, lists, &own.nodes, &own.parameters);
        let state = places.len() - own.parameters.len() - 1;
        places.splice(state..state, multipliers.iter().copied().map(Place::Mu));
        self.parts.push(Part { name: own.name.clone(), switches, places, event, first, count });
    }

    /// Number of switches.
    pub fn switches(&self) -> usize {
        self.places.len()
    }

    /// Number of all sides: of switches, of events that have happened, of joints, and of frictions.
    pub fn sides_count(&self) -> usize {
        let directions: usize = self.frictions.iter().map(|own| own.own.sides()).sum();
        self.switches() + self.events.len() + self.joints.len() + directions
    }

    /// The frictions of all joints.
    pub fn frictions(&self) -> impl ExactSizeIterator<Item = &JointFriction> {
        self.frictions.iter().map(|own| &own.own)
    }

    /// One of them.
    pub fn friction(&self, friction: usize) -> &JointFriction {
        &self.frictions[friction].own
    }

    /// Whether a joint is there, if it comes and goes.
    pub fn presence_of(&self, joint: usize, sides: &[f64]) -> Option<bool> {
        let (place, _) = self.known.of_joints.get(&joint)?;
        Some(sides[self.switches() + self.events.len() + place] > 0.0)
    }

    /// A mark between changes, where these sides hold.
    pub fn mark(&self, sides: &[f64]) -> SideChange {
        let switch = self.switches() + self.events.len();
        SideChange { switch, sides: [sides[switch]; 2] }
    }

    /// Parameters of all frictions in an impact, by their places.
    pub fn set_in_impact(&self, sides: &[f64]) -> Vec<(usize, f64)> {
        let mut all = Vec::new();
        for Slip { own, first, .. } in &self.frictions {
            all.extend(own.forces.map(|place| (place, 0.0)));
            all.extend(own.direction.iter().flat_map(|places| places.clone().zip(sides[*first..].iter().copied())));
            all.extend(own.axis.clone().zip(sides[*first + own.held() + 1..].iter().copied()));
        }
        all
    }

    /// The same where nothing rubs, whatever slips.
    pub fn set_without_friction(&self, sides: &[f64]) -> Vec<(usize, f64)> {
        let directions = self.frictions().flat_map(|own| &own.direction).flat_map(Range::clone);
        self.set_in_impact(sides).into_iter().chain(directions.map(|place| (place, 0.0))).collect()
    }

    /// Which way the surfaces of a friction slip; zero where they stick or are apart.
    pub fn direction<'s>(&self, friction: usize, sides: &'s [f64]) -> &'s [f64] {
        let Slip { own, first, .. } = &self.frictions[friction];
        &sides[*first..first + own.kept.len()]
    }

    /// Whether slip in two directions is given another direction where it has fallen to some speed, before it ends.
    pub fn has_least_slip(&self, friction: usize, sides: &[f64]) -> bool {
        let Slip { own, first, .. } = &self.frictions[friction];
        sides[first + own.held() - 1] > 0.0
    }

    /// Whether a side is one of a friction.
    pub fn is_of(&self, friction: usize, switch: usize) -> bool {
        let Slip { own, first, .. } = &self.frictions[friction];
        (*first..first + own.sides()).contains(&switch)
    }

    /// The changes to another direction of slip, and in two directions to the speeds within which it is given, and to which slip falls before another is.
    pub fn turn(&self, friction: usize, direction: &[f64], speeds: [f64; 2], sides: &[f64]) -> Vec<SideChange> {
        let Slip { own, first, .. } = &self.frictions[friction];
        let values = direction.iter().copied().chain(speeds).take(own.direction[0].len()).enumerate();
        let changes = values.map(|(k, value)| SideChange { switch: first + k, sides: [sides[first + k], value] });
        changes.filter(|own| own.sides[0] != own.sides[1]).collect()
    }

    /// Whether surfaces do not move, at the limit of their friction, as others hold them.
    pub fn is_held(&self, friction: usize, sides: &[f64]) -> bool {
        let Slip { own, first, .. } = &self.frictions[friction];
        sides[first + own.held()] > 0.0
    }

    /// The change of surfaces that do not move, at the limit of their friction, as others hold them: their slip does not end.
    pub fn held(&self, friction: usize, is_held: bool, sides: &[f64]) -> Option<SideChange> {
        let Slip { own, first, .. } = &self.frictions[friction];
        let switch = first + own.held();
        let change = SideChange { switch, sides: [sides[switch], f64::from(u8::from(is_held))] };
        (change.sides[0] != change.sides[1]).then_some(change)
    }

    /// The changes to equations of what sticks along a direction and at right angles to it, of two velocities.
    pub fn align(&self, friction: usize, direction: &[f64], sides: &[f64]) -> Vec<SideChange> {
        let Slip { own, first, .. } = &self.frictions[friction];
        let places = (first + own.held() + 1..).zip(direction);
        let changes = places.map(|(switch, &value)| SideChange { switch, sides: [sides[switch], value] });
        changes.filter(|own| (own.sides[0] - own.sides[1]).abs() > CONSISTENT).collect()
    }

    /// The direction of the first equation of what sticks, of two velocities.
    pub fn axis<'s>(&self, friction: usize, sides: &'s [f64]) -> &'s [f64] {
        let Slip { own, first, .. } = &self.frictions[friction];
        &sides[first + own.held() + 1..][..own.axis.len()]
    }

    /// Frictions of two velocities that slip in another direction than before.
    pub fn turned(&self, before: &[f64], sides: &[f64]) -> Vec<usize> {
        let is_turned = |friction: &usize| {
            let [old, new] = [before, sides].map(|sides| self.direction(*friction, sides));
            new.len() == 2 && new != old && new.iter().any(|own| *own != 0.0)
        };
        (0..self.frictions.len()).filter(is_turned).collect()
    }

    /// Writes the derivative parts of directions, of slip and of what sticks, to where these stand in p.
    pub fn write_turned<S: RunScalar>(&self, directions: &[Directions<S>], p: &mut [S]) {
        for (Slip { own, .. }, Directions { slip, axis }) in self.frictions.iter().zip(directions) {
            if let Some(slip) = slip {
                own.direction.iter().for_each(|places| p[places.start..][..2].copy_from_slice(slip));
            }
            if let Some(axis) = axis {
                p[own.axis.clone()].iter_mut().zip(axis).for_each(|(p, &own)| *p += own - S::from(own.value()));
            }
        }
    }

    /// The change to the side on which surfaces slip, of the switch at which slip ends; or on which they stick, of that at which it begins.
    pub fn rubbing(&self, friction: usize, sticks: bool, sides: &[f64]) -> Option<SideChange> {
        let switch = self.condition(self.frictions[friction].own.events[usize::from(sticks)])?.first;
        // 1: below zero
        let side = if sticks { 1.0 } else { -1.0 };
        (sides[switch] != side).then_some(SideChange { switch, sides: [sides[switch], side] })
    }

    /// The velocities of slip.
    pub fn slip<S: RunScalar>(&self, friction: usize, [v, q]: [&[S]; 2], t: S, p: &[S]) -> Vec<S> {
        let Slip { formula, places, own, .. } = &self.frictions[friction];
        let mut slip = vec![S::zero(); formula.outputs.len()];
        let inputs = inputs(places, &Moment { a: &[], v, q, mu: [&[]; 2], t }, p);
        S::run(formula.values(), &inputs, &mut slip, &mut ProgramWork::default());
        from_axis(&slip, &p[own.axis.clone()])
    }

    /// Goes back through these, by their adjoints: to those of rates, coordinates and parameters, and the one of the time, which is returned.
    pub fn slip_back(
        &self,
        friction: usize,
        [v, q]: [&[f64]; 2],
        (t, p): (f64, &[f64]),
        bars: &[f64],
        seeds: [&mut [f64]; 3],
    ) -> f64 {
        let Slip { formula, places, own, .. } = &self.frictions[friction];
        let inputs = inputs(places, &Moment { a: &[], v, q, mu: [&[]; 2], t }, p);
        let bars = along_axis(bars, &p[own.axis.clone()]);
        let [v_bar, q_bar, p_bar] = seeds;
        // an axis turns the equations of what sticks, not the slip
        let of_axis = p_bar[own.axis.clone()].to_vec();
        let t_bar = results_back(formula, places, &inputs, bars.into_iter().enumerate(), [v_bar, q_bar, p_bar]);
        p_bar[own.axis.clone()].copy_from_slice(&of_axis);
        t_bar
    }

    /// Whether what surfaces that stick would have to hold is more than friction can, by multipliers of which so much is none.
    pub fn exceeds(&self, friction: usize, moment: Moment<f64>, p: &[f64], none: f64) -> bool {
        let (number, none) = self.beyond_limit(friction, moment, p, none);
        number > none
    }

    /// Whether friction has no limit worth the name, by multipliers without those of what sticks.
    pub fn is_unloaded(&self, friction: usize, moment: Moment<f64>, p: &[f64], none: f64) -> bool {
        let (number, none) = self.beyond_limit(friction, moment, p, none);
        number.abs() <= none
    }

    fn beyond_limit(&self, friction: usize, moment: Moment<f64>, p: &[f64], none: f64) -> (f64, f64) {
        let JointFriction { events, kept, .. } = &self.frictions[friction].own;
        let none = none.max(NOTHING * largest(moment.mu[0])).powi(kept.len() as i32);
        let number = self.condition(events[1]).map(|part| part.switches.number_in(0, &part.inputs(&moment, p)));
        (number.unwrap_or_default(), none)
    }

    /// The joint that the event of a switch closes.
    pub fn joint_closed_by(&self, switch: usize) -> Option<usize> {
        let event = self.part(switch).event?;
        self.events[event].closes.first().map(|own| own.joint)
    }

    /// Place of the side of a joint that comes and goes.
    pub fn presence(&self, joint: usize) -> usize {
        let place = self.known.of_joints.get(&joint).map(|own| own.0);
        self.switches() + self.events.len() + place.unwrap_or_else(|| unreachable!("a joint of an event comes and goes"))
    }

    /// The change of a joint that comes or goes; `None` where it is there or gone already.
    pub fn presence_change(&self, joint: usize, is_there: bool, sides: &[f64]) -> Option<SideChange> {
        let switch = self.presence(joint);
        let change = SideChange { switch, sides: [sides[switch], f64::from(u8::from(is_there))] };
        (change.sides[0] != change.sides[1]).then_some(change)
    }

    /// Joints of latches.
    pub fn latches(&self) -> impl Iterator<Item = usize> + '_ {
        let latches = self.events.iter().filter(|own| own.once && own.condition.is_some());
        latches.flat_map(|own| own.closes.iter().filter(|own| own.stop.is_none()).map(|own| own.joint))
    }

    fn release(&self, joint: usize) -> Option<&Part> {
        self.known.of_joints.get(&joint)?.1.map(|part| &self.parts[part])
    }

    /// Conditions by forces of joints.
    fn releases(&self) -> impl Iterator<Item = &Part> {
        self.known.releases.iter().map(|&part| &self.parts[part])
    }

    /// An event that happens by a force of a joint that is there.
    pub fn release_of(&self, sides: &[f64]) -> Option<&str> {
        self.releases().find(|part| self.may_happen(part, sides)).map(|part| &*part.name)
    }

    /// Whether an event may happen, by the joints that are there and by whether it has which does so once.
    fn may_happen(&self, part: &Part, sides: &[f64]) -> bool {
        let Some(event) = part.event else { return true };
        let first = self.switches() + self.events.len();
        let is_there = |(joint, side): (usize, f64)| sides.get(first + joint).is_none_or(|own| *own == side);
        let is_still = |own: &Slip| {
            let held = own.first + own.own.held();
            let direction = sides.get(own.first..own.first + own.own.kept.len());
            let is_still = direction.is_some_and(|own| own.iter().all(|d| *d == 0.0));
            is_still || sides.get(held).is_some_and(|held| *held > 0.0)
        };
        if self.known.ends_of_slip.get(&event).is_some_and(|&own| is_still(&self.frictions[own])) {
            return false;
        }
        let has_been = sides.get(self.switches() + event).is_some_and(|own| *own > 0.0);
        !has_been && self.events[event].condition.is_none_or(is_there)
    }

    /// The joint that a force removes first behind what has happened, as the change of the switch at which it does, by the multipliers there; `present`
    /// are the joints there, `no_force` is what counts as none.
    pub fn released(
        &self,
        (sides, present): (&[f64], &[f64]),
        moment: Moment<f64>,
        p: &[f64],
        no_force: f64,
    ) -> Option<SideChange> {
        let held = self.releases().filter(|part| self.may_happen(part, present));
        // 1: below zero
        let beyond = |part: &Part| sides[part.first] * part.switches.number_in(0, &part.inputs(&moment, p));
        let first = held.map(|part| (part.first, beyond(part))).max_by(|one, other| one.1.total_cmp(&other.1))?;
        (first.1 > no_force).then(|| SideChange { switch: first.0, sides: [sides[first.0], -sides[first.0]] })
    }

    /// The change of the switch at which the force of a joint removes it.
    pub fn letting_go(&self, joint: usize, sides: &[f64]) -> Option<SideChange> {
        let switch = self.release(joint)?.first;
        Some(SideChange { switch, sides: [sides[switch], -sides[switch]] })
    }

    /// Whether the stop that an event hits is there, as far as it was not taken away.
    pub fn can_be_hit(&self, event: usize, sides: &[f64]) -> bool {
        sides[self.switches() + event] == 0.0
    }

    /// Equations of joints that are not there.
    pub fn absent(&self, sides: &[f64]) -> Vec<usize> {
        let first = self.switches() + self.events.len();
        let gone = self.joints.iter().zip(&sides[first..]).filter(|(_, side)| **side == 0.0);
        let mut rows: Vec<usize> = gone.flat_map(|(own, _)| own.1.clone()).collect();
        rows.sort_unstable();
        rows
    }

    /// Of the stops at which the motion is held, but of one, that which pulls first on the way from the multipliers by which all push to these, of which
    /// so much is none; the former are then those up to where it does, and without it these.
    ///
    /// Source: Lawson, Hanson, Solving Least Squares Problems (1974), 23.3: sets of stops that are found so do not depend on each other.
    pub fn torn(
        &self,
        sides: &[f64],
        (alone, mu): (Option<usize>, &[f64]),
        none: f64,
        choice: &mut Choice,
    ) -> Option<usize> {
        let Choice { pushing, last, at_limit } = choice;
        pushing.resize(mu.len(), 0.0);
        let held = || self.stops().filter(|(_, own, _)| sides[self.presence(*own)] > 0.0);
        let row = |joint: usize| self.joints[self.known.of_joints[&joint].0].1.start;
        let none = none.max(NOTHING * largest(mu));
        let pulls = |stop: &Stop, mu: f64| mu != 0.0 && !stop.pushes(mu) && mu.abs() > none;
        let torn = held().filter(|(_, own, stop)| Some(*own) != alone && pulls(stop, mu[row(*own)]));
        let shares = torn.map(|(_, own, _)| (own, pushing[row(own)] / (pushing[row(own)] + mu[row(own)].abs())));
        let first = shares.min_by(|one, other| one.1.total_cmp(&other.1));
        let share = first.map_or(1.0, |own| own.1);
        for (_, own, stop) in held() {
            let row = row(own);
            let push = if stop.pushes(mu[row]) { mu[row].abs() } else { -mu[row].abs() };
            pushing[row] = (pushing[row] + share * (push - pushing[row])).max(0.0);
        }
        match (first, last.take()) {
            (Some((torn, _)), held) => {
                pushing[row(torn)] = 0.0;
                // whether it moves beyond or pulls is round-off
                at_limit.extend(held.filter(|held| *held == torn));
            }
            (None, Some(_)) => at_limit.clear(),
            (None, None) => {}
        }
        first.map(|own| own.0)
    }

    /// Stops, with the event that hits each and its joint.
    pub fn stops(&self) -> impl Iterator<Item = (usize, usize, &Stop)> {
        self.known.stops.iter().filter_map(|&(event, k)| {
            let Closing { joint, stop, .. } = &self.events[event].closes[k];
            Some((event, *joint, stop.as_ref()?))
        })
    }

    /// Whether the side of the switch at which an event hits a stop is not the free one.
    pub fn is_beyond(&self, event: usize, stop: &Stop, sides: &[f64]) -> bool {
        self.free(event, stop, sides).is_some()
    }

    /// Whether a switch is the condition of an event.
    pub fn is_event(&self, switch: usize) -> bool {
        self.part(switch).event.is_some()
    }

    /// Whether a switch is the condition of an event that may not happen.
    pub fn is_off(&self, switch: usize, sides: &[f64]) -> bool {
        !self.may_happen(self.part(switch), sides)
    }

    /// Whether a switch is the condition of this event.
    pub fn is_condition(&self, switch: usize, event: usize) -> bool {
        self.part(switch).event == Some(event)
    }

    /// Whether it is that at which slip ends.
    pub fn is_end_of_slip(&self, switch: usize) -> bool {
        self.slip_ended_by(switch).is_some()
    }

    /// The friction whose slip ends where a switch changes its side.
    pub fn slip_ended_by(&self, switch: usize) -> Option<usize> {
        self.slip_ended_at((switch < self.switches()).then(|| self.part(switch).event).flatten()?)
    }

    /// The friction whose slip ends with an event.
    pub fn slip_ended_at(&self, event: usize) -> Option<usize> {
        self.known.ends_of_slip.get(&event).copied()
    }

    /// Whether surfaces stick by such changes.
    pub fn sticks_by(&self, friction: usize, changes: &[SideChange]) -> bool {
        let stick = self.presence(self.frictions[friction].own.joints[1]);
        changes.iter().any(|own| own.switch == stick && own.sides[1] > 0.0)
    }

    /// Whether a switch is the condition of an event by a force.
    pub fn is_release(&self, switch: usize) -> bool {
        self.part(switch).is_by_force()
    }

    /// The stop that is hit where a switch passes, and its joint.
    pub fn stop_hit_by(&self, switch: usize) -> Option<(usize, &Stop)> {
        let event = self.part(switch).event?;
        self.events[event].closes.iter().find_map(|own| Some((own.joint, own.stop.as_ref()?)))
    }

    fn condition(&self, event: usize) -> Option<&Part> {
        self.known.conditions[event].map(|part| &self.parts[part])
    }

    /// Name of an event.
    pub fn name(&self, event: usize) -> &str {
        self.condition(event).map_or("", |part| &part.name)
    }

    /// Joints that an event removes, and that it adds.
    pub fn joints_of(&self, event: usize) -> (&[usize], &[Closing]) {
        let Happening { opens, closes, .. } = &self.events[event];
        (opens, closes)
    }

    /// The change back to the side of the motion that is free of a stop, of the switch at which an event hits it.
    pub fn free(&self, event: usize, Stop { is_upper, .. }: &Stop, sides: &[f64]) -> Option<SideChange> {
        let switch = self.condition(event)?.first;
        let side = if *is_upper { 1.0 } else { -1.0 };
        (sides[switch] != side).then_some(SideChange { switch, sides: [sides[switch], side] })
    }

    /// The change to the side on which a stop pushes, of the switch at which it lets go.
    pub fn pushing(&self, joint: usize, Stop { is_upper, .. }: &Stop, sides: &[f64]) -> Option<SideChange> {
        let switch = self.release(joint)?.first;
        // 1: below zero
        let side = if *is_upper { -1.0 } else { 1.0 };
        (sides[switch] != side).then_some(SideChange { switch, sides: [sides[switch], side] })
    }

    /// Which events happen where sides change so, one after the other; `sides` are those before. One that happens in both directions does so once, as
    /// what it sets may turn its number back.
    pub fn happening(&self, changes: &[SideChange], sides: &[f64]) -> Vec<usize> {
        let mut all = Vec::new();
        for SideChange { switch, sides: [before, _] } in changes.iter().filter(|own| own.switch < self.switches()) {
            let Some(event) = self.part(*switch).event else { continue };
            let Happening { directions: [rising, falling], once, .. } = self.events[event];
            // surfaces may slip on in another direction
            let goes_on = self.slip_ended_by(*switch).is_some_and(|friction| !self.sticks_by(friction, changes));
            let is_wanted = if *before > 0.0 { rising } else { falling } && !goes_on;
            let has_been = sides.get(self.switches() + event).is_some_and(|has_been| *has_been > 0.0);
            let is_over = once && (has_been || all.contains(&event)) || rising && falling && all.contains(&event);
            if is_wanted && !is_over {
                all.push(event);
            }
        }
        all
    }

    /// The change that keeps in mind that an event has happened which does so once.
    pub fn has_happened(&self, event: usize) -> Option<SideChange> {
        let switch = self.switches() + event;
        self.events[event].once.then_some(SideChange { switch, sides: [0.0, 1.0] })
    }

    /// The changes by which stops are there no more, or are there again.
    pub fn stops_changed(&self, event: usize, sides: &[f64]) -> Vec<SideChange> {
        let gone =
            self.events[event].stops.iter().zip([1.0, 0.0]).flat_map(|(own, side)| own.iter().map(move |&hit| (hit, side)));
        let changes = gone.map(|(hit, side)| {
            let switch = self.switches() + hit;
            SideChange { switch, sides: [sides[switch], side] }
        });
        changes.filter(|own| own.sides[0] != own.sides[1]).collect()
    }

    /// Switches at which stops are hit that an event brings back.
    pub fn stops_brought(&self, event: usize) -> impl Iterator<Item = usize> + '_ {
        self.events[event].stops[1].iter().filter_map(|&hit| Some(self.condition(hit)?.first))
    }

    /// Whether an event sets anything.
    pub fn sets(&self, event: usize) -> bool {
        !self.events[event].resets.is_empty()
    }

    /// Whether an event ends the run.
    pub fn ends_run(&self, event: usize) -> bool {
        self.events[event].ends_run
    }

    /// Writes what an event sets into the rates and coordinates of a state, and appends it to a list.
    pub fn reset<S: RunScalar>(
        &self,
        (event, number): (usize, usize),
        [v, q]: [&mut Vec<S>; 2],
        t: S,
        p: &[S],
        list: &mut Vec<SetNumber<S>>,
    ) -> Result<(), String> {
        for (reset, places) in &self.events[event].resets {
            let values = values_of(reset, places, [v, q], t, p);
            if values.iter().any(|value| !value.value().is_finite()) {
                let (name, t) = (&reset.values.name, shortest(t.value()));
                return Err(format!("event \"{name}\" at t = {t} s: what it sets is not a number there"));
            }
            for (&target, value) in reset.targets.iter().zip(values) {
                *target.of([&mut *v, &mut *q]) = value;
                list.push(SetNumber { event: number, target, value });
            }
        }
        Ok(())
    }

    /// Goes back through what an event sets: from the adjoints of rates and coordinates behind it to those before, those of parameters, and the one of
    /// the time, which is returned.
    pub fn reset_back(
        &self,
        event: usize,
        [v, q]: [&[f64]; 2],
        (t, p): (f64, &[f64]),
        [v_bar, q_bar, p_bar]: [&mut [f64]; 3],
    ) -> f64 {
        // the states before each
        let mut states = vec![[v.to_vec(), q.to_vec()]];
        for (reset, places) in &self.events[event].resets {
            let [mut v, mut q] = states[states.len() - 1].clone();
            let values = values_of(reset, places, [&v, &q], t, p);
            reset.targets.iter().zip(values).for_each(|(target, value)| *target.of([&mut v, &mut q]) = value);
            states.push([v, q]);
        }
        let mut t_bar = 0.0;
        for ((reset, places), [v, q]) in self.events[event].resets.iter().zip(&states).rev() {
            let take = |target: &Target| std::mem::take(target.of([&mut *v_bar, &mut *q_bar]));
            let bars: Vec<f64> = reset.targets.iter().map(take).collect();
            let inputs = inputs(places, &Moment { a: &[], v, q, mu: [&[]; 2], t }, p);
            let (bars, seeds) = (bars.into_iter().enumerate(), [&mut *v_bar, &mut *q_bar, &mut *p_bar]);
            t_bar += results_back(&reset.values.physics, places, &inputs, bars, seeds);
        }
        t_bar
    }

    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Writes sides to where they stand in p.
    pub fn write<S: RunScalar>(&self, sides: &[f64], p: &mut [S]) {
        self.places.iter().zip(sides).for_each(|(&place, &side)| p[place] = S::from(side));
        self.write_directions(sides, p);
    }

    /// Writes directions of slip to where they stand in p.
    pub fn write_directions<S: RunScalar>(&self, sides: &[f64], p: &mut [S]) {
        for Slip { own, first, .. } in &self.frictions {
            for places in &own.direction {
                p[places.clone()].iter_mut().zip(&sides[*first..]).for_each(|(p, &side)| *p = S::from(side));
            }
            p[own.axis.clone()].iter_mut().zip(&sides[first + own.held() + 1..]).for_each(|(p, &side)| *p = S::from(side));
        }
    }

    /// The sides at a moment: by the numbers, and where these are at the end of a side by their rates.
    pub fn sides(&mut self, moment: Moment<f64>, p: &[f64]) -> Vec<f64> {
        let Events { parts, numbers, work, .. } = self;
        let mut sides = Vec::new();
        for part in parts {
            part.switches.evaluate(&part.inputs(&moment, p), numbers, work);
            sides.extend(part.switches.told_by(numbers));
        }
        let at_end: Vec<(usize, Excess)> = self.excesses(moment, p, &sides).into_iter().enumerate().collect();
        for (switch, own) in at_end.into_iter().filter(|(_, own)| own.by.abs() <= own.round_off(moment.t) && own.rate > 0.0)
        {
            sides[switch] = own.other;
        }
        sides.extend(self.events.iter().map(|_| 0.0));
        sides.extend(self.joints.iter().map(|own| f64::from(u8::from(own.2))));
        sides.resize(self.sides_count(), 0.0);
        for Slip { own, first, .. } in self.frictions.iter().filter(|own| !own.own.axis.is_empty()) {
            sides[first + own.held() + 1] = 1.0;
        }
        sides
    }

    /// How far all switches are beyond the ends of their sides.
    pub fn excesses(&mut self, moment: Moment<f64>, p: &[f64], sides: &[f64]) -> Vec<Excess> {
        let are_off: Vec<bool> = self.parts.iter().map(|part| !self.may_happen(part, sides)).collect();
        let Events { parts, numbers, work, .. } = self;
        let mut all = Vec::with_capacity(sides.len());
        let (speed, force) = (largest(moment.v), largest(moment.mu[0]));
        for (part, is_off) in parts.iter().zip(are_off) {
            let inputs = part.inputs(&moment, p);
            part.switches.evaluate(&inputs, numbers, work);
            let rates = part.switches.rates(&inputs, &part.direction(&moment), work);
            all.extend(part.switches.excesses(&sides[part.first..part.first + part.count], numbers, &rates));
            let own = all.len() - part.count;
            if is_off {
                // it stays on its side
                all[own..].iter_mut().for_each(|own| (own.by, own.rate, own.terms) = (-1.0, 0.0, 1.0));
                continue;
            }
            // what holds velocities at zero leaves a share of those of the model, and what solves for forces one of the largest
            let size = |(place, input): (&Place, &f64)| match place {
                Place::Mu(_) => force,
                _ if part.event.is_some() => input.abs(),
                Place::V(_) => speed,
                _ => 0.0,
            };
            let sizes: Vec<f64> = part.places.iter().zip(&inputs).map(size).collect();
            let largest = largest(&sizes);
            for (place, own) in all[own..].iter_mut().enumerate().filter(|(_, own)| own.by.abs() <= CLOSE * largest) {
                let gradient = part.switches.number_by_arguments(place, &inputs);
                own.size = gradient.iter().zip(&sizes).map(|(own, size)| (own * size).abs()).sum();
            }
        }
        all
    }

    fn part(&self, switch: usize) -> &Part {
        &self.parts[self.parts.partition_point(|part| part.first + part.count <= switch)]
    }

    /// Whether two switches that pass at once have one number: those of one part do if its gradients are parallel, an element and an event, which may set what
    /// the element reads, if those by the state are.
    pub fn is_same_number(&self, switches: [usize; 2], moment: Moment<f64>, p: &[f64]) -> bool {
        let [one, other] = switches.map(|own| self.part(own));
        let is_same_part = one.first == other.first;
        if switches[0] == switches[1] || !is_same_part && one.event.is_some() == other.event.is_some() {
            return switches[0] == switches[1];
        }
        let [one, other] = switches.map(|own| {
            let mut gradient: Vec<(Place, f64)> = Vec::new();
            self.number_by_arguments(own, moment, p, |place, rate| {
                if rate == 0.0 || !is_same_part && matches!(place, Place::P(_)) {
                    return;
                }
                match gradient.iter_mut().find(|own| own.0 == place) {
                    Some(own) => own.1 += rate,
                    None => gradient.push((place, rate)),
                }
            });
            gradient
        });
        let product = |one: &[(Place, f64)], other: &[(Place, f64)]| -> f64 {
            let rate = |place: Place| other.iter().find(|own| own.0 == place).map_or(0.0, |own| own.1);
            one.iter().map(|own| own.1 * rate(own.0)).sum()
        };
        let (along, squares) = (product(&one, &other), product(&one, &one) * product(&other, &other));
        squares - along * along <= CONSISTENT * squares
    }

    /// Whether two switches that pass at once do so together: those of one part, whose formula may have no value between both, and those with one number.
    pub fn passes_with(&self, switches: [usize; 2], moment: Moment<f64>, p: &[f64]) -> bool {
        let [one, other] = switches.map(|own| self.part(own).first);
        one == other || self.is_same_number(switches, moment, p)
    }

    /// Switches of elements and events that pass where the first of the changes does, with numbers of their own.
    pub fn passing_with_first(
        &mut self,
        changes: &[SideChange],
        moment: Moment<f64>,
        p: &[f64],
        sides: &[f64],
    ) -> Vec<usize> {
        let Some((first, others)) = changes.split_first() else { return Vec::new() };
        let is_other = |own: &&SideChange| own.switch < self.switches() && own.switch != first.switch;
        let mut others: Vec<usize> = others.iter().filter(is_other).map(|own| own.switch).collect();
        if others.is_empty() || first.switch >= self.switches() {
            return Vec::new();
        }
        let numbers = self.excesses(moment, p, sides);
        let is_same_part = |switch: usize| self.part(first.switch).first == self.part(switch).first;
        others.retain(|&own| {
            let is_same = is_same_part(own) && self.is_same_number([first.switch, own], moment, p);
            numbers[own].by.abs() <= numbers[own].noise(moment.t) && !is_same
        });
        others
    }

    /// Name of the element that has a switch.
    pub fn part_of(&self, switch: usize) -> &str {
        &self.part(switch).name
    }

    /// The number of a switch, which is zero at an end of a side but for a whole number.
    pub fn number<S: RunScalar>(&self, switch: usize, moment: Moment<S>, p: &[S]) -> S {
        let part = self.part(switch);
        part.switches.number_in(switch - part.first, &part.inputs(&moment, p))
    }

    /// Gradient of that number: calls `add` with the place of each argument.
    pub fn number_by_arguments(&self, switch: usize, moment: Moment<f64>, p: &[f64], mut add: impl FnMut(Place, f64)) {
        let part = self.part(switch);
        let gradient = part.switches.number_by_arguments(switch - part.first, &part.inputs(&moment, p));
        part.places.iter().zip(gradient).for_each(|(&place, own)| add(place, own));
    }
}

/// The components along an axis c and at right angles to it of two velocities, or of their adjoints; of one velocity itself.
pub(crate) fn along_axis(both: &[f64], axis: &[f64]) -> Vec<f64> {
    match (both, axis) {
        (&[first, second], &[x, y]) => vec![x * first + y * second, x * second - y * first],
        _ => both.to_vec(),
    }
}

/// Two velocities, or forces, of such components.
pub(crate) fn from_axis<S: RunScalar>(components: &[S], axis: &[S]) -> Vec<S> {
    match (components, axis) {
        (&[along, across], &[x, y]) => vec![along * x - across * y, along * y + across * x],
        _ => components.to_vec(),
    }
}

/// Share of the largest argument below which the terms of a number are looked at.
const CLOSE: f64 = 1e-6;
/// Share of the largest impulse that is none.
const NOTHING: f64 = 1e-12;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, own| most.max(own.abs()))
}

/// Lists of the arguments of the formulas of elements and functionals.
const OF_ELEMENT: Lists = &[Place::A, Place::V, Place::Q];
/// Lists of those of an event's formulas.
const OF_EVENT: Lists = &[Place::V, Place::Q];

fn inputs<S: RunScalar>(places: &[Place], moment: &Moment<S>, p: &[S]) -> Vec<S> {
    let value = |place: &Place| match *place {
        Place::A(dof) => moment.a[dof],
        Place::V(dof) => moment.v[dof],
        Place::Q(dof) => moment.q[dof],
        Place::P(index) => p[index],
        Place::Time => moment.t,
        Place::Mu(row) => moment.mu[0].get(row).copied().unwrap_or_else(S::zero),
    };
    places.iter().map(value).collect()
}

/// Goes back through a formula from adjoints of its results to those of rates, coordinates and parameters, and the one of the time, which is returned.
fn results_back(
    formula: &Formula,
    places: &[Place],
    inputs: &[f64],
    bars: impl Iterator<Item = (usize, f64)>,
    [v_bar, q_bar, p_bar]: [&mut [f64]; 3],
) -> f64 {
    let mut t_bar = 0.0;
    for (result, bar) in bars.filter(|(_, bar)| *bar != 0.0) {
        let program = formula.gradient(&[result]);
        let mut entries = vec![0.0; program.outputs()];
        program.run(inputs, &mut entries, &mut ProgramWork::default());
        for (&label, &entry) in program.labels().iter().zip(&entries) {
            match places[label as usize] {
                Place::V(dof) => v_bar[dof] += bar * entry,
                Place::Q(dof) => q_bar[dof] += bar * entry,
                Place::P(index) => p_bar[index] += bar * entry,
                Place::Time => t_bar += bar * entry,
                Place::A(_) | Place::Mu(_) => {}
            }
        }
    }
    t_bar
}

/// Values that a reset gives to its targets.
fn values_of<S: RunScalar>(reset: &Reset, places: &[Place], [v, q]: [&[S]; 2], t: S, p: &[S]) -> Vec<S> {
    let formula = &reset.values.physics;
    let mut values = vec![S::zero(); formula.outputs.len()];
    let inputs = inputs(places, &Moment { a: &[], v, q, mu: [&[]; 2], t }, p);
    S::run(formula.values(), &inputs, &mut values, &mut ProgramWork::default());
    values
}

impl Part {
    fn is_by_force(&self) -> bool {
        self.event.is_some() && self.places.iter().any(|place| matches!(place, Place::Mu(_)))
    }

    fn inputs<S: RunScalar>(&self, moment: &Moment<S>, p: &[S]) -> Vec<S> {
        inputs(&self.places, moment, p)
    }

    /// Rates of the arguments along the motion.
    fn direction(&self, moment: &Moment<f64>) -> Vec<f64> {
        let rate = |place: &Place| match *place {
            Place::V(dof) => moment.a[dof],
            Place::Q(dof) => moment.v[dof],
            Place::Time => 1.0,
            Place::Mu(row) => moment.mu[1].get(row).copied().unwrap_or(0.0),
            Place::A(_) | Place::P(_) => 0.0,
        };
        self.places.iter().map(rate).collect()
    }
}
