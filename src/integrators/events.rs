//! Switches of elements at which steps end.
//!
//! The residual of an element uses, in a step, the sides of its switches that hold at the start of the step, whatever its numbers tell: the step is
//! a smooth map of its length. Where the number g(q, v, t, p) of a switch passes the end of its side at the end of a step, that step is made again
//! with the length h for which g = 0 but for round-off; the next one goes on with the other side. The time of the event is thus a property of the
//! discrete run, with derivatives by g = 0.
//!
//! Source: Hairer, Norsett, Wanner, Solving ODEs I, II.6; Galan, Feehery, Barton, Appl. Numer. Math. 31 (1999), for the derivatives.

use super::crossings::Place;
use crate::assembly::Model;
use crate::elements::RunScalar;
use crate::program::{Excess, Formula, ProgramWork, Reads, Switches};
use std::collections::HashMap;
use std::sync::Arc;

/// A side that changes between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideChange {
    /// Number of the switch among all of the model.
    pub switch: usize,
    /// The side before, and behind.
    pub sides: [f64; 2],
}

/// A state between two steps.
#[derive(Clone, Copy)]
pub struct Moment<'s, S> {
    pub a: &'s [S],
    pub v: &'s [S],
    pub q: &'s [S],
    pub t: S,
}

/// An element with switches.
struct Part {
    name: String,
    switches: Switches,
    places: Vec<Place>,
    /// Number of its first switch.
    first: usize,
    count: usize,
}

/// All switches of a model that are located.
#[derive(Default)]
pub struct Events {
    parts: Vec<Part>,
    /// Where the sides stand in p.
    places: Vec<usize>,
    work: ProgramWork<f64>,
    numbers: Vec<f64>,
}

impl Events {
    pub fn new(model: &Model) -> Self {
        let mut events = Events::default();
        let mut known: HashMap<*const Formula, Option<Switches>> = HashMap::new();
        for own in model.elements.iter().filter(|own| own.physics.sides() > 0) {
            let formula = own.physics.residual();
            let switches = known.entry(Arc::as_ptr(formula)).or_insert_with(|| formula.switches(Reads::Located, false));
            let Some(switches) = switches.clone() else { continue };
            let (first, count) = (events.places.len(), own.physics.sides());
            assert_eq!(switches.count(), count, "each switch of \"{}\" has one side", own.name);
            events.places.extend(own.parameters.end - count..own.parameters.end);
            let lists: &[fn(usize) -> Place] = &[Place::A, Place::V, Place::Q];
            let places = super::crossings::places(model, lists, &own.nodes, &own.parameters);
            events.parts.push(Part { name: own.name.clone(), switches, places, first, count });
        }
        events
    }

    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Writes sides to where they stand in p.
    pub fn write<S: RunScalar>(&self, sides: &[f64], p: &mut [S]) {
        self.places.iter().zip(sides).for_each(|(&place, &side)| p[place] = S::from(side));
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
        sides
    }

    /// How far all switches are beyond the ends of their sides.
    pub fn excesses(&mut self, moment: Moment<f64>, p: &[f64], sides: &[f64]) -> Vec<Excess> {
        let Events { parts, numbers, work, .. } = self;
        let mut all = Vec::with_capacity(sides.len());
        for part in parts {
            let inputs = part.inputs(&moment, p);
            part.switches.evaluate(&inputs, numbers, work);
            let rates = part.switches.rates(&inputs, &part.direction(&moment), work);
            all.extend(part.switches.excesses(&sides[part.first..part.first + part.count], numbers, &rates));
        }
        all
    }

    fn part(&self, switch: usize) -> &Part {
        &self.parts[self.parts.partition_point(|part| part.first + part.count <= switch)]
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

impl Part {
    fn inputs<S: RunScalar>(&self, moment: &Moment<S>, p: &[S]) -> Vec<S> {
        let value = |place: &Place| match *place {
            Place::A(dof) => moment.a[dof],
            Place::V(dof) => moment.v[dof],
            Place::Q(dof) => moment.q[dof],
            Place::P(index) => p[index],
            Place::Time => moment.t,
            Place::Mu(_) => S::zero(),
        };
        self.places.iter().map(value).collect()
    }

    /// Rates of the arguments along the motion.
    fn direction(&self, moment: &Moment<f64>) -> Vec<f64> {
        let rate = |place: &Place| match *place {
            Place::V(dof) => moment.a[dof],
            Place::Q(dof) => moment.v[dof],
            Place::Time => 1.0,
            Place::A(_) | Place::P(_) | Place::Mu(_) => 0.0,
        };
        self.places.iter().map(rate).collect()
    }
}
