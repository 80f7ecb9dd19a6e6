//! Design variables and the map from them to the numbers of a model.
//!
//! The chain (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar is one reverse sweep over the recorded map, whatever the
//! number of variables.

use crate::program::{Listing, Node, Program, ProgramWork, Recorded, Recording, record};
use crate::scalar::Scalar;
use std::collections::HashSet;

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

impl<S> Default for ModelNumbers<S> {
    fn default() -> Self {
        ModelNumbers { p: Vec::new(), q: Vec::new(), v: Vec::new() }
    }
}

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
    /// In recorded ones, which have values: the map may choose by them, and is recorded anew for each design.
    fn recorded(&self, x: &[Recorded]) -> Result<ModelNumbers<Recorded>, String>;
}

/// The recorded map at one design.
pub struct DesignChain {
    x: Vec<f64>,
    /// Lengths of p, q and v.
    lengths: [usize; 3],
    active: Vec<bool>,
    values: Program,
    tangent: Program,
    transposed: Program,
}

impl DesignChain {
    /// Records the map once.
    ///
    /// # Errors
    /// Those of the map.
    pub fn record(map: &dyn DesignMap, x: &[f64]) -> Result<Self, String> {
        let (numbers, Recording { mut graph, .. }) = record(x, |x| map.recorded(x));
        let ModelNumbers { p, q, v } = numbers?;
        let (lengths, active) = ([p.len(), q.len(), v.len()], p.iter().map(|p| !p.is_constant()).collect());
        let outputs: Vec<Node> = p.into_iter().chain(q).chain(v).map(|number| number.node(&mut graph)).collect();
        let inputs: Vec<Node> = (0..x.len() + outputs.len()).map(|input| graph.input(input)).collect();
        let (towards, weights) = inputs.split_at(x.len());
        let values = Program::new(Listing::of(&graph, &outputs, x.len()), Vec::new());
        let directions: Vec<Node> = (0..x.len()).map(|input| graph.input(x.len() + input)).collect();
        let seeds: Vec<(Node, Node)> = towards.iter().copied().zip(directions).collect();
        let moved = graph.forward(&outputs, &seeds);
        let tangent = Program::new(Listing::of(&graph, &moved, 2 * x.len()), Vec::new());
        // what does not depend on the design is not asked for
        let moving = |place: &usize| graph.constant_of(outputs[*place]).is_none();
        let (moving, weights): (Vec<Node>, Vec<Node>) =
            (0..outputs.len()).filter(moving).map(|place| (outputs[place], weights[place])).unzip();
        let gradient = graph.reverse(&moving, &weights, towards);
        let transposed = Program::new(Listing::of(&graph, &gradient, inputs.len()), Vec::new());
        Ok(DesignChain { x: x.to_vec(), lengths, active, values, tangent, transposed })
    }

    /// Which parameters depend on any variable: the adjoint sweep leaves the others alone.
    pub fn active_parameters(&self) -> Vec<bool> {
        self.active.clone()
    }

    /// (p, q0, v0) at a design with derivative parts.
    pub fn numbers<S: Scalar>(&self, x: &[S]) -> ModelNumbers<S> {
        let mut all = vec![S::zero(); self.lengths.iter().sum()];
        self.values.run_in(x, &mut all, &mut ProgramWork::default());
        self.divided(all)
    }

    /// Derivatives of (p, q0, v0) along a direction.
    pub fn tangent(&self, direction: &[f64]) -> ModelNumbers<f64> {
        let mut all = vec![0.0; self.lengths.iter().sum()];
        self.tangent.run_in(&[&self.x[..], direction].concat(), &mut all, &mut ProgramWork::default());
        self.divided(all)
    }

    fn divided<S>(&self, mut all: Vec<S>) -> ModelNumbers<S> {
        let v = all.split_off(self.lengths[0] + self.lengths[1]);
        let q = all.split_off(self.lengths[0]);
        ModelNumbers { p: all, q, v }
    }

    /// (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar.
    pub fn gradient(&self, bar: &ModelNumbers<f64>) -> Vec<f64> {
        let inputs = [&self.x[..], &bar.p, &bar.q, &bar.v].concat();
        let mut gradient = vec![0.0; self.x.len()];
        self.transposed.run_in(&inputs, &mut gradient, &mut ProgramWork::default());
        gradient
    }
}
