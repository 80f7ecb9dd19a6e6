//! What happens at instants: conditions that pass zero, and what is set there.

use super::{Attached, Model, NodeId};
use crate::elements::split_arguments;
use crate::program::ArgumentKind::{self, Coordinate, Parameter, Time, Velocity};
use crate::program::{Formula, Recorded};
use crate::scalar::Scalar;
use std::sync::Arc;

/// Rates and coordinates of some nodes, parameters and the time \[s\], as formulas of an event see them. The value z of a state of first order
/// stands among the rates.
pub struct EventArguments<'x> {
    /// Rates of the coordinates, values of states.
    pub v: &'x [Recorded],
    /// Coordinates.
    pub q: &'x [Recorded],
    /// Parameters.
    pub p: &'x [Recorded],
    /// Time \[s\].
    pub t: Recorded,
}

/// An instant at which the number of a condition passes zero, and what happens there. Steps end at it, g(q, v, p, t) = 0.
#[derive(Clone)]
pub struct Event {
    /// Its formula of (v, q, p, side, t): 1 where the number is below zero on the side that is told.
    pub condition: Attached<Arc<Formula>>,
    /// Whether it happens where the number rises through zero, and where it falls.
    pub directions: [bool; 2],
    /// Whether it happens no second time.
    pub once: bool,
    /// Whether the run ends there.
    pub ends_run: bool,
    /// What is set, one after the other.
    pub resets: Vec<Reset>,
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
    /// Order of the time derivative, and place in its list.
    pub fn place(self) -> (usize, usize) {
        match self {
            Target::Coordinate(dof) => (0, dof),
            Target::Rate(dof) => (1, dof),
        }
    }
}

fn kinds(n: usize, m: usize) -> [(ArgumentKind, usize); 4] {
    [(Velocity, n), (Coordinate, n), (Parameter, m), (Time, 1)]
}

impl Model {
    fn record_instant(
        &self,
        nodes: &[NodeId],
        parameters: usize,
        formula: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) -> Result<Arc<Formula>, String> {
        let (n, m) = (self.dof_count(nodes), parameters);
        Formula::record(kinds(n, m), |x| {
            let [v, q, p, t] = split_arguments(x, [n, n, m, 1]);
            formula(EventArguments { v, q, p, t: t[0] })
        })
    }

    /// Adds an event whose number is a formula of some nodes and of `parameters` numbers; its own side stands behind these.
    ///
    /// # Errors
    /// A formula that cannot be recorded.
    pub(crate) fn add_event(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        parameters: usize,
        number: impl FnOnce(EventArguments) -> Recorded,
    ) -> Result<&mut Event, String> {
        let less = self.record_instant(nodes, parameters, |all| vec![number(all).less(Recorded::default())])?;
        let physics = less.with_side_of_result()?;
        let places = self.add_parameters(parameters + 1);
        let condition =
            Attached { name: name.into(), nodes: nodes.into(), parameters: places, equations: 0..0, physics };
        self.events.push(Event { condition, directions: [true; 2], once: false, ends_run: false, resets: Vec::new() });
        let last = self.events.len() - 1;
        Ok(&mut self.events[last])
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
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) -> Result<(), String> {
        let physics = self.record_instant(nodes, parameters, values)?;
        let parameters = self.add_parameters(parameters);
        let name = self.events[event].condition.name.clone();
        let values = Attached { name, nodes: nodes.into(), parameters, equations: 0..0, physics };
        self.events[event].resets.push(Reset { values, targets });
        Ok(())
    }
}
