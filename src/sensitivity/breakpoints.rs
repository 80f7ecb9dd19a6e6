//! Times at which formulas of a model jump or bend whatever its motion is: steps end there.

use crate::assembly::Model;
use crate::design::ModelNumbers;
use crate::elements::RunScalar;
use crate::functionals::Functional;
use crate::integrators::{Place, each_formula};
use crate::program::{Formula, Reads, SwitchKind, SwitchTime, Switches};
use std::collections::HashMap;
use std::sync::Arc;

/// Breakpoints of a model and its functionals for given parameters, each with its derivatives by these.
///
/// They are the zeros g(t, p) = 0 of the numbers that tell the sides of switches, for switches that read the time and no state.
pub(crate) struct Breakpoints(Vec<Breakpoint>);

/// Share of a run before its start from which on switches are looked for, so that one at the start is found, too.
const BEFORE: f64 = 1e-3;

/// A time at which a formula passes from one piece to another.
pub(crate) struct Breakpoint {
    /// When, with dt/dp.
    pub at: SwitchTime,
    /// What the formula does there, in the state of the start; `None` where it goes on smoothly.
    pub kind: Option<SwitchKind>,
    pub part: String,
    pub is_constraint: bool,
}

impl Breakpoints {
    /// Those within a run from 0 to `end`, and at both.
    pub fn of(model: &Model, functionals: &[Functional], numbers: &ModelNumbers<f64>, end: f64) -> Result<Self, String> {
        let (switches, known) = (HashMap::new(), HashMap::new());
        let mut search = Search { numbers, end, switches, known, found: Vec::new(), failed: None };
        each_formula(model, |name, is_constraint, formula, places| search.add((name, is_constraint), formula, places));
        for functional in functionals.iter().filter(|own| own.refused(model).is_none()) {
            functional.each_formula(model, |formula, _, places| search.add((&functional.name, false), formula, places));
        }
        search.failed.map_or(Ok(Breakpoints(search.found)), Err)
    }

    pub fn all(&self) -> &[Breakpoint] {
        &self.0
    }

    pub fn times(&self) -> Vec<f64> {
        self.0.iter().map(|own| own.at.t).collect()
    }

    /// Their derivative parts, without values, for parameters with parts.
    pub fn parts<S: RunScalar>(&self, p: &[S]) -> Vec<S> {
        let part = |(place, rate): &(usize, f64)| (p[*place] - p[*place].value()) * *rate;
        self.0.iter().map(|own| own.at.gradient.iter().map(part).fold(S::zero(), |sum, part| sum + part)).collect()
    }

    /// Adds the gradient of the sum of some of them, by their numbers, times their weights to that of the parameters.
    pub fn add_transposed(&self, weights: impl IntoIterator<Item = (usize, f64)>, p_bar: &mut [f64]) {
        for (number, weight) in weights {
            self.0[number].at.gradient.iter().for_each(|(place, rate)| p_bar[*place] += weight * rate);
        }
    }
}

impl Breakpoint {
    /// Whether it depends on one of the `active` parameters.
    pub fn reads(&self, active: &[bool]) -> bool {
        self.at.gradient.iter().any(|(place, _)| active[*place])
    }
}

struct Search<'n> {
    numbers: &'n ModelNumbers<f64>,
    end: f64,
    switches: HashMap<*const Formula, Option<Switches>>,
    /// Times of formulas for the bits of all that their switches read, by the arguments of the formula.
    known: HashMap<(*const Formula, Vec<u64>), Vec<SwitchTime>>,
    found: Vec<Breakpoint>,
    failed: Option<String>,
}

impl Search<'_> {
    fn add(&mut self, (name, is_constraint): (&str, bool), formula: &Arc<Formula>, places: &dyn Fn() -> Vec<Place>) {
        let address = Arc::as_ptr(formula);
        let switches = self.switches.entry(address).or_insert_with(|| formula.switches(Reads::TimeAlone, true));
        let Some(switches) = switches.as_ref().filter(|_| self.failed.is_none()) else { return };
        let (places, ModelNumbers { p, q, v }) = (places(), self.numbers);
        let number = |place: &Place| match *place {
            Place::P(index) => p[index],
            Place::Q(dof) => q[dof],
            Place::V(dof) => v[dof],
            Place::A(_) | Place::Mu(_) | Place::Time => 0.0,
        };
        let inputs: Vec<f64> = places.iter().map(number).collect();
        let read = inputs.iter().zip(switches.reads()).filter(|(_, reads)| *reads).map(|(input, _)| input.to_bits());
        let of_time: Vec<usize> = (0..places.len()).filter(|&place| places[place] == Place::Time).collect();
        let key = (address, read.collect());
        if !self.known.contains_key(&key) {
            match switches.times(&inputs, &of_time, [-BEFORE * self.end, self.end]) {
                Ok(mut times) => {
                    times.retain(|own| own.t >= 0.0);
                    self.known.insert(key.clone(), times);
                }
                Err(why) => {
                    self.failed = Some(format!("the formula of \"{name}\" {why}"));
                    return;
                }
            }
        }
        let place_of = |&(input, rate): &(usize, f64)| match places[input] {
            Place::P(index) => Some((index, rate)),
            _ => None,
        };
        self.found.extend(self.known[&key].iter().map(|SwitchTime { t, gradient }| Breakpoint {
            at: SwitchTime { t: *t, gradient: gradient.iter().filter_map(place_of).collect() },
            kind: switches.kind_at_time(&inputs, &of_time, (*t, self.end)),
            part: name.into(),
            is_constraint,
        }));
    }
}
