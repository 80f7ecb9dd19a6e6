//! What happens at instants: conditions that pass zero, and what is set there.

use super::{Attached, Model, NodeId};
use crate::elements::{NodeKind, split_arguments};
use crate::program::ArgumentKind::{self, Coordinate, Multiplier, Parameter, Time, Velocity};
use crate::program::{Digest, Formula, Reads, Recorded};
use crate::scalar::Scalar;
use std::ops::Range;
use std::sync::Arc;

/// Rates and coordinates of some nodes, parameters and the time \[s\], as formulas of an event see them. The value z of a state of first order
/// stands among the rates.
pub struct EventArguments<'x> {
    /// Rates of the coordinates, values of states.
    pub v: &'x [Recorded],
    /// Coordinates.
    pub q: &'x [Recorded],
    /// Multipliers of the joints whose forces are looked at.
    pub mu: &'x [Recorded],
    /// Parameters.
    pub p: &'x [Recorded],
    /// Time \[s\].
    pub t: Recorded,
}

/// An instant at which the number of a condition passes zero, and what happens there. Steps end at it, g(q, v, p, t) = 0.
#[derive(Clone)]
pub struct Event {
    /// Its formula of (v, q, mu, p, side, t): 1 where the number is below zero on the side that is told.
    pub condition: Attached<Arc<Formula>>,
    /// Equations whose multipliers it reads.
    pub multipliers: Vec<usize>,
    /// Whether it happens where the number rises through zero, and where it falls.
    pub directions: [bool; 2],
    /// Whether it happens no second time.
    pub once: bool,
    /// Whether the run ends there.
    pub ends_run: bool,
    /// A joint, and whether it must be there or not for the event to happen.
    pub while_joint: Option<(usize, bool)>,
    /// What is set, one after the other.
    pub resets: Vec<Reset>,
    /// Joints that are removed.
    pub opens: Vec<usize>,
    /// Joints that are added, by an impact where their equations move.
    pub closes: Vec<Closing>,
}

/// A joint of [`Model::constraints`] that an event closes: velocities jump by dv with M dv + A^T L = 0 under all joints, so that what was the rate r
/// of its equations becomes -e r.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Closing {
    /// The joint.
    pub joint: usize,
    /// How it is hit, where it is a stop; what is locked stays closed.
    pub stop: Option<Stop>,
    /// Place in v of a state to which the size of its impulses is added.
    pub impulse: Option<usize>,
}

impl Closing {
    /// Whether it hits a joint as a stop.
    pub(crate) fn is_stop(&self, joint: usize) -> bool {
        self.joint == joint && self.stop.is_some()
    }
}

/// A stop, g <= 0 or g >= 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stop {
    /// Places of its restitution e and of the speed below which it is hit with e = 0, in p.
    pub parameters: [usize; 2],
    /// Whether g <= 0.
    pub is_upper: bool,
}

impl Stop {
    /// Whether it pushes with a multiplier, of which its force on g is -mu.
    pub fn pushes(&self, mu: f64) -> bool {
        if self.is_upper { mu > 0.0 } else { mu < 0.0 }
    }
}

/// Friction of a joint: its surfaces slip in a direction d that events choose, or a second joint holds them.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct JointFriction {
    /// The joint with friction, and the one that sticks.
    pub joints: [usize; 2],
    /// Events at which slip ends, and at which it begins.
    pub events: [usize; 2],
    /// Places in p of d, as the joint and the event at which slip ends read it; of two velocities two speeds beside it.
    pub direction: [Range<usize>; 2],
    /// Places in p of the slip that an impact keeps.
    pub kept: Range<usize>,
    /// Places in p of the direction of the first equation of what sticks, of two velocities.
    pub axis: Range<usize>,
    /// Places in p of what is 1 but in impacts, where limits without a load count for nothing.
    pub forces: [usize; 2],
}

impl JointFriction {
    /// Number of its sides: d, whether others hold it, and its axis.
    pub fn sides(&self) -> usize {
        self.held() + 1 + self.axis.len()
    }

    /// Place among them of whether others hold it.
    pub fn held(&self) -> usize {
        self.direction[0].len()
    }
}

/// Coordinates and rates that get other values, all of them from those before.
#[derive(Clone)]
pub struct Reset {
    /// Its formula of (v, q, p, t): the new values.
    pub values: Attached<Arc<Formula>>,
    /// What gets them.
    pub targets: Vec<Target>,
}

/// A number of the state of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// A coordinate, by its place in q.
    Coordinate(usize),
    /// A rate or the value of a state, by its place in v.
    Rate(usize),
}

impl Target {
    /// It in the rates and coordinates of a state.
    pub fn of<S>(self, [v, q]: [&mut [S]; 2]) -> &mut S {
        match self {
            Target::Coordinate(dof) => &mut q[dof],
            Target::Rate(dof) => &mut v[dof],
        }
    }
}

fn kinds(n: usize, k: usize, m: usize) -> [(ArgumentKind, usize); 5] {
    [(Velocity, n), (Coordinate, n), (Multiplier, k), (Parameter, m), (Time, 1)]
}

impl Model {
    /// Says of a joint that events add or remove it, and whether it is there at the start.
    pub(crate) fn set_presence(&mut self, joint: usize, is_there: bool) {
        match self.presence.iter_mut().find(|own| own.0 == joint) {
            Some(own) => own.1 = is_there,
            None => self.presence.push((joint, is_there)),
        }
    }

    /// Whether events add or remove the joint of an equation.
    pub(crate) fn comes_and_goes(&self, equation: usize) -> bool {
        self.presence.iter().any(|(joint, _)| self.constraints[*joint].equations.contains(&equation))
    }

    /// Whether a joint is there at the start.
    pub(crate) fn is_there_at_start(&self, joint: usize) -> bool {
        self.presence.iter().all(|(own, is_there)| *own != joint || *is_there)
    }

    /// Equations that are not there at the start.
    pub(crate) fn absent_at_start(&self) -> Vec<usize> {
        let absent = self.presence.iter().filter(|own| !own.1);
        let mut rows: Vec<usize> = absent.flat_map(|own| self.constraints[own.0].equations.clone()).collect();
        rows.sort_unstable();
        rows
    }

    /// The formula of `origin`, which tells it from all others of such nodes and as many arguments; recorded anew without one.
    fn record_instant(
        &self,
        nodes: &[NodeId],
        [multipliers, parameters]: [usize; 2],
        origin: Option<Digest>,
        formula: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) -> Result<Arc<Formula>, String> {
        let (n, k, m) = (self.dof_count(nodes), multipliers, parameters);
        let record = || {
            Formula::record(kinds(n, k, m), |x| {
                let [v, q, mu, p, t] = split_arguments(x, [n, n, k, m, 1]);
                formula(EventArguments { v, q, mu, p, t: t[0] })
            })
        };
        let Some(origin) = origin else { return record() };
        let nodes: Vec<NodeKind> = nodes.iter().map(|&node| self.node(node).kind).collect();
        Formula::once(&("instant", nodes, [n, k, m], origin), record)
    }

    /// Adds an event whose number is a formula of some nodes, of the multipliers of some joints and of `parameters` numbers; its own side stands
    /// behind these. Its `origin` tells it from all other formulas; without one it is recorded anew.
    ///
    /// # Errors
    /// A formula that cannot be recorded.
    pub(crate) fn add_event(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        joints: &[usize],
        parameters: usize,
        origin: Option<Digest>,
        number: impl FnOnce(EventArguments) -> Recorded,
    ) -> Result<&mut Event, String> {
        let multipliers: Vec<usize> = joints.iter().flat_map(|&joint| self.constraints[joint].equations.clone()).collect();
        let below = |all: EventArguments| vec![number(all).less(Recorded::default())];
        let origin = origin.map(|own| Digest::of(&("number", own)));
        let own = self.record_instant(nodes, [multipliers.len(), parameters], origin, below)?;
        let physics = Formula::once(&("with its side", own.digest()), || own.with_side_of_result())?;
        let places = self.add_parameters(parameters + 1);
        let condition = Attached { name: name.into(), nodes: nodes.into(), parameters: places, equations: 0..0, physics };
        let (directions, resets, opens, closes) = ([true; 2], Vec::new(), Vec::new(), Vec::new());
        let (once, ends_run, while_joint) = (false, false, None);
        self.events.push(Event { condition, multipliers, directions, once, ends_run, while_joint, resets, opens, closes });
        let last = self.events.len() - 1;
        Ok(&mut self.events[last])
    }

    /// Adds the limits of a friction with the parameters of the part that sticks; of which formulas of the motion none may compare anything.
    ///
    /// # Errors
    /// Formulas that cannot be recorded, or that do.
    pub(crate) fn add_limits(
        &mut self,
        sticking: usize,
        origin: Option<Digest>,
        limits: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) -> Result<(), String> {
        let Attached { name, nodes, parameters, .. } = self.constraints[sticking].clone();
        let origin = origin.map(|own| Digest::of(&("limits", own)));
        let physics = self.record_instant(&nodes, [0, parameters.len()], origin, limits)?;
        if physics.switches(Reads::Motion, false).is_some_and(|own| own.count() > 0) {
            return Err("its limits compare what moves: write them smooth, or let an [[event]] set a [[number]]".into());
        }
        self.limits_of_friction.push(Attached { name, nodes, parameters, equations: 0..0, physics });
        Ok(())
    }

    /// Adds what an event sets, by formulas of some nodes and of `parameters` numbers.
    ///
    /// # Errors
    /// Formulas that cannot be recorded.
    pub(crate) fn add_reset(
        &mut self,
        event: usize,
        nodes: &[NodeId],
        parameters: usize,
        targets: Vec<Target>,
        origin: Option<Digest>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) -> Result<(), String> {
        let origin = origin.map(|own| Digest::of(&("values", own)));
        let physics = self.record_instant(nodes, [0, parameters], origin, values)?;
        let (given, taken) = (physics.outputs.len(), targets.len());
        if given != taken {
            return Err(format!("{given} values are set at {taken} places: there is one for each"));
        }
        let parameters = self.add_parameters(parameters);
        let name = self.events[event].condition.name.clone();
        let values = Attached { name, nodes: nodes.into(), parameters, equations: 0..0, physics };
        self.events[event].resets.push(Reset { values, targets });
        Ok(())
    }
}
