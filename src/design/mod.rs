//! Design variables and the map from them to the numbers of a model.
//!
//! The chain (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar is one reverse sweep over the recorded map, whatever the
//! number of variables.

mod sampling;

pub use sampling::{latin_hypercube, sobol};

use crate::program::{Graph, Node, Recorded, Recording, record};
use crate::scalar::Scalar;
use std::collections::HashSet;
use std::sync::OnceLock;

/// A named number that may be changed by design.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignVariable {
    /// Name.
    pub name: String,
    /// Value of the initial design.
    pub initial: f64,
    /// Least admissible value.
    pub lower: f64,
    /// Largest admissible value.
    pub upper: f64,
    /// Unit.
    pub unit: &'static str,
}

impl DesignVariable {
    /// A variable with bounds.
    pub fn new(name: impl Into<String>, initial: f64, (lower, upper): (f64, f64), unit: &'static str) -> Self {
        DesignVariable { name: name.into(), initial, lower, upper, unit }
    }

    /// By what changes of its value `x` are measured: its size, or its range where it is zero.
    pub fn size(&self, x: f64) -> f64 {
        let range = self.upper - self.lower;
        match x.abs() {
            0.0 if range.is_finite() && range > 0.0 => range,
            0.0 => 1.0,
            size => size,
        }
    }
}

/// The shortest digits that read back as the same number: `0.25`, `12`; with an exponent beyond `1e6` and below `1e-4`.
pub fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-4..1e6).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// The first name that is given twice: results are asked for by name.
pub fn repeated<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let mut seen = HashSet::new();
    names.find(|name| !seen.insert(*name))
}

/// Why a design is refused.
///
/// # Errors
/// The variable, its value and the bounds, for the first that is out of them or not a number; or both counts.
pub fn check_design(variables: &[DesignVariable], x: &[f64]) -> Result<(), String> {
    if variables.len() != x.len() {
        return Err(format!("the scene has {} design variables, but {} values were given", variables.len(), x.len()));
    }
    for (variable, &value) in variables.iter().zip(x) {
        if !(value >= variable.lower && value <= variable.upper) {
            let DesignVariable { name, lower, upper, unit, .. } = variable;
            let [value, lower, upper] = [value, *lower, *upper].map(shortest);
            return Err(format!(
                "design variable \"{name}\" is {value} {unit}; it must lie between {lower} and {upper} {unit}"
            ));
        }
    }
    Ok(())
}

/// The numbers of a model: parameters and initial state.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelNumbers<S> {
    /// Parameters.
    pub p: Vec<S>,
    /// Initial coordinates.
    pub q: Vec<S>,
    /// Initial velocities.
    pub v: Vec<S>,
}

/// A list of [`ModelNumbers`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberList {
    /// p.
    Parameters,
    /// q.
    Coordinates,
    /// v.
    Velocities,
}

impl NumberList {
    /// One of its numbers.
    pub fn word(self) -> &'static str {
        match self {
            NumberList::Parameters => "parameter",
            NumberList::Coordinates => "initial coordinate",
            NumberList::Velocities => "initial velocity",
        }
    }
}

impl<S> Default for ModelNumbers<S> {
    fn default() -> Self {
        ModelNumbers { p: Vec::new(), q: Vec::new(), v: Vec::new() }
    }
}

/// A design with its numbers.
pub type Beside = (Vec<f64>, ModelNumbers<f64>);

/// The map x -> (p, q0, v0).
///
/// Topology must not depend on x; implementations check it and report what changed.
pub trait DesignMap {
    /// In real numbers.
    fn real(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String>;
    /// The same beside a design that is within the bounds, which a difference quotient may leave.
    ///
    /// # Errors
    /// As for [`DesignMap::real`], but for the bounds.
    fn nearby(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String> {
        self.real(x)
    }
    /// A design beside one, each variable moved by a share of itself, with its numbers; `None` where it cannot be built, which tells nothing.
    ///
    /// # Errors
    /// What depends on the design beside numbers.
    fn beside(&self, x: &[f64], share: f64) -> Result<Option<Beside>, String> {
        let moved: Vec<f64> = x.iter().map(|&x| x + share * if x == 0.0 { 1.0 } else { x.abs() }).collect();
        Ok(self.nearby(&moved).ok().map(|numbers| (moved, numbers)))
    }
    /// What messages call a variable: its name, or its place from 1 on where none is known.
    fn variable_name(&self, place: usize) -> String {
        format!("{}", place + 1)
    }
    /// What messages call a number of the model: one of a list of numbers, by its place there.
    fn number_name(&self, list: NumberList, place: usize) -> String {
        format!("{} {} of the model", list.word(), place + 1)
    }
    /// In recorded ones, which have values: the map may choose by them, and is recorded anew for each design.
    fn recorded(&self, x: &[Recorded]) -> Result<ModelNumbers<Recorded>, String>;
}

/// Distance of a design at which the map is compared with its derivatives, as a share of each variable.
const BESIDE: f64 = 1e-7;
/// Multiples of it at which what is off must be as many times as large.
const FURTHER: [f64; 2] = [3.7, 1e3];
/// Share of a change by which it may be off from what the derivatives say, and of a number.
const MAP_SHARE: f64 = 1e-3;
const MAP_NOISE: f64 = 1e-13;
/// Share of the change of the largest coordinate that is the round-off of a number that vanishes.
const MAP_NOUGHT: f64 = 1e-9;

/// The recorded map at one design.
pub struct DesignChain {
    x: Vec<f64>,
    real: ModelNumbers<f64>,
    active: Vec<bool>,
    recording: Graph,
    /// p, q0 and v0, one behind the other.
    outputs: Vec<Node>,
    /// Values of the recording at the design.
    values: Vec<f64>,
    tangent: OnceLock<Derivative>,
    transposed: OnceLock<Derivative>,
}

/// The recording with a derivative behind it.
struct Derivative {
    graph: Graph,
    results: Vec<Node>,
}

impl DesignChain {
    /// Records the map once.
    ///
    /// # Errors
    /// Those of the map.
    pub fn record(map: &dyn DesignMap, x: &[f64]) -> Result<Self, String> {
        let (numbers, Recording { graph: mut recording, .. }) = record(x, |x| map.recorded(x));
        let ModelNumbers { p, q, v } = numbers?;
        let active = p.iter().map(|p| !p.is_constant()).collect();
        let numbers = |list: &[Recorded]| list.iter().map(|number| number.number()).collect();
        let real = ModelNumbers { p: numbers(&p), q: numbers(&q), v: numbers(&v) };
        let outputs = p.into_iter().chain(q).chain(v).map(|number| number.node(&mut recording)).collect();
        let mut values = Vec::new();
        recording.evaluate(x, &mut values);
        let (tangent, transposed) = (OnceLock::new(), OnceLock::new());
        Ok(DesignChain { x: x.to_vec(), real, active, recording, outputs, values, tangent, transposed })
    }

    /// Whether the recorded map changes as its numbers do beside the design: a map that goes through the value of a variable has numbers that
    /// follow it and derivatives that do not, and complex steps would agree with them.
    ///
    /// # Errors
    /// What depends on the design beside numbers; a number that does not change as its derivatives say.
    pub fn check(&self, map: &dyn DesignMap) -> Result<(), String> {
        let Some(apart) = self.apart(map, BESIDE)?.filter(|apart| apart.iter().any(|apart| *apart != 0.0)) else {
            return Ok(());
        };
        // round-off and jumps of the numbers do not grow with the distance
        let mut places: Vec<usize> = (0..apart.len()).filter(|&place| apart[place] != 0.0).collect();
        let mut change = 0.0;
        for times in FURTHER {
            let Some(further) = self.apart(map, times * BESIDE)? else { return Ok(()) };
            places.retain(|&place| (further[place] / apart[place] / times - 1.0).abs() < 0.05);
            change = places.first().map_or(0.0, |&place| further[place]);
        }
        let Some(&place) = places.first() else { return Ok(()) };
        let [p, q] = [self.real.p.len(), self.real.q.len()];
        let what = match place {
            place if place < p => map.number_name(NumberList::Parameters, place),
            place if place < p + q => map.number_name(NumberList::Coordinates, place - p),
            place => map.number_name(NumberList::Velocities, place - p - q),
        };
        let share = FURTHER[FURTHER.len() - 1] * BESIDE;
        Err(format!(
            "{what} changes by {change:.3e} more than its derivatives say where all variables change by {share:.0e} of themselves: it \
             follows the value of a variable (Scalar::value) instead of the variable"
        ))
    }

    /// By how much numbers beside the design are off from what the derivatives say, where that is a good part of what they change by.
    fn apart(&self, map: &dyn DesignMap, share: f64) -> Result<Option<Vec<f64>>, String> {
        let Some((moved, numbers)) = map.beside(&self.x, share)? else { return Ok(None) };
        let direction: Vec<f64> = moved.iter().zip(&self.x).map(|(moved, x)| moved - x).collect();
        let all = |numbers: &ModelNumbers<f64>| [&numbers.p[..], &numbers.q, &numbers.v].concat();
        let (before, after, rates) = (all(&self.real), all(&numbers), all(&self.tangent(&direction)));
        let length = self.real.q.iter().fold(0.0, |length: f64, q| length.max(q.abs()));
        let apart = (0..before.len()).map(|k| {
            let (change, apart) = (after[k] - before[k], after[k] - before[k] - rates[k]);
            // what vanishes may do so by terms that cancel
            let noise = if before[k] == 0.0 { MAP_NOUGHT * share * length } else { MAP_NOISE * before[k].abs() };
            if apart.abs() > noise + MAP_SHARE * (change.abs() + rates[k].abs()) { apart } else { 0.0 }
        });
        Ok(Some(apart.collect()))
    }

    /// (p, q0, v0) at the design.
    pub fn real(&self) -> &ModelNumbers<f64> {
        &self.real
    }

    /// Which parameters depend on any variable: the adjoint sweep leaves the others alone.
    pub fn active_parameters(&self) -> Vec<bool> {
        self.active.clone()
    }

    /// (p, q0, v0) at a design with derivative parts.
    pub fn numbers<S: Scalar>(&self, x: &[S]) -> ModelNumbers<S> {
        let mut values = Vec::new();
        self.recording.evaluate(x, &mut values);
        self.divided(self.outputs.iter().map(|output| values[output.0 as usize]).collect())
    }

    /// Derivatives of (p, q0, v0) along a direction.
    pub fn tangent(&self, direction: &[f64]) -> ModelNumbers<f64> {
        let derivative = self.tangent.get_or_init(|| {
            let mut graph = self.recording.clone();
            let [x, directions] = [0, self.x.len()].map(|first| inputs(&mut graph, first, self.x.len()));
            let seeds: Vec<(Node, Node)> = x.into_iter().zip(directions).collect();
            Derivative { results: graph.forward(&self.outputs, &seeds), graph }
        });
        self.divided(self.results(derivative, &[&self.x[..], direction].concat()))
    }

    /// (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar.
    pub fn gradient(&self, bar: &ModelNumbers<f64>) -> Vec<f64> {
        let derivative = self.transposed.get_or_init(|| {
            let mut graph = self.recording.clone();
            let (x, weights) = (inputs(&mut graph, 0, self.x.len()), inputs(&mut graph, self.x.len(), self.outputs.len()));
            // what does not depend on the design is not asked for
            let all = self.outputs.iter().copied().zip(weights);
            let (moving, weights): (Vec<Node>, Vec<Node>) =
                all.filter(|(output, _)| graph.constant_of(*output).is_none()).unzip();
            Derivative { results: graph.reverse(&moving, &weights, &x), graph }
        });
        self.results(derivative, &[&self.x[..], &bar.p, &bar.q, &bar.v].concat())
    }

    fn results(&self, derivative: &Derivative, inputs: &[f64]) -> Vec<f64> {
        let mut values = self.values.clone();
        derivative.graph.evaluate(inputs, &mut values);
        derivative.results.iter().map(|result| values[result.0 as usize]).collect()
    }

    fn divided<S>(&self, mut all: Vec<S>) -> ModelNumbers<S> {
        let ModelNumbers { p, q, .. } = &self.real;
        let v = all.split_off(p.len() + q.len());
        let q = all.split_off(p.len());
        ModelNumbers { p: all, q, v }
    }
}

fn inputs(graph: &mut Graph, first: usize, count: usize) -> Vec<Node> {
    (first..first + count).map(|input| graph.input(input)).collect()
}
