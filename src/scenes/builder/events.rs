//! Events, and numbers that they alone change.

use super::MechanismBuilder;
use crate::assembly::{Event, EventArguments, NodeId, Target};
use crate::elements::{Element, NodeKind, Parameter, State};
use crate::functionals::{Over, Quantity};
use crate::program::Recorded;
use crate::scalar::Scalar;

/// States that do not change by themselves, dz/dt = 0.
struct Kept(usize);

impl Element for Kept {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::States(self.0)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        r.iter_mut().zip(s.a).for_each(|(r, &a)| *r += a);
    }
}

/// Time at which an event happened for the k-th time, of how often it has and of that time; not a number before.
struct EventTime(usize);

impl Quantity for EventTime {
    fn dofs(&self) -> usize {
        2
    }
    fn unit(&self) -> &'static str {
        "s"
    }
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        let [count, time] = [s.v[0], s.v[1]];
        count.less(S::from(self.0 as f64 - 0.5)).select(S::from(f64::NAN), time)
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A number z with its value at the start, which only events change: a state with dz/dt = 0.
    pub fn number(&mut self, name: &str, initial: S) -> NodeId {
        self.kept(name, &[initial])
    }

    fn kept(&mut self, name: &str, initial: &[S]) -> NodeId {
        let node = self.states(name, initial);
        self.element(name, &[node], Kept(initial.len()), &[]);
        node
    }

    /// Where `number` passes zero, a formula of the coordinates and rates of nodes, of parameters and of the time: the event, whose direction and what
    /// happens there may be set.
    pub fn event(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        p: &[S],
        number: impl FnOnce(EventArguments) -> Recorded,
    ) -> Option<&mut Event> {
        if nodes.iter().any(|&node| self.kind_of(name, node).is_none()) {
            return None;
        }
        // its side is that which the numbers tell
        self.numbers.p.extend_from_slice(p);
        self.numbers.p.push(S::zero());
        match self.model.add_event(name, nodes, p.len(), number) {
            Ok(event) => Some(event),
            Err(why) => {
                self.mistakes.push(format!("event \"{name}\": {why}"));
                None
            }
        }
    }

    /// What the event made last sets, all of it from the values before: formulas of the coordinates and rates of nodes, of parameters and of the time.
    pub fn event_sets(
        &mut self,
        nodes: &[NodeId],
        p: &[S],
        targets: Vec<Target>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) {
        let Some(last) = self.model.events.len().checked_sub(1) else { return };
        self.add_reset(last, nodes, p, targets, values);
    }

    fn add_reset(
        &mut self,
        event: usize,
        nodes: &[NodeId],
        p: &[S],
        targets: Vec<Target>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) {
        self.numbers.p.extend_from_slice(p);
        if let Err(why) = self.model.add_reset(event, nodes, p.len(), targets, values) {
            let name = &self.model.events[event].condition.name;
            self.mistakes.push(format!("event \"{name}\": {why}"));
        }
    }

    /// The time \[s\] at which an event happens for the `number`-th time, counted from 1.
    pub fn event_time_functional(&mut self, name: &str, event: usize, number: usize) {
        let node = self.kept(&format!("time of {name}"), &[S::zero(); 2]);
        let first = self.model.nodes[node.0].dofs.start;
        let targets = vec![Target::Rate(first), Target::Rate(first + 1)];
        self.add_reset(event, &[node], &[], targets, |EventArguments { v, t, .. }| {
            let count = v[0] + Recorded::from(1.0);
            let is_it = (count - Recorded::from(number as f64)).abs().less(Recorded::from(0.5));
            vec![count, is_it.select(t, v[1])]
        });
        self.functional(name, Over::Terminal, (&[node], &[]), EventTime(number), &[]);
    }
}
