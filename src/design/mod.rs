//! Design variables and the map from them to the numbers of a model.
//!
//! The chain (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar is one reverse sweep over the recorded map, whatever the
//! number of variables.

use crate::scalar::{Complex64, Lanes, Rev, Scalar, Tape};

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
            return Err(format!(
                "design variable \"{name}\" is {value} {unit}; it must lie between {lower} and {upper} {unit}"
            ));
        }
    }
    Ok(())
}

/// The numbers of a model: parameters and initial state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelNumbers<S> {
    /// Parameters.
    pub p: Vec<S>,
    /// Initial coordinates.
    pub q: Vec<S>,
    /// Initial velocities.
    pub v: Vec<S>,
}

/// The map x -> (p, q0, v0), in every scalar in which it is needed.
///
/// Topology must not depend on x; implementations check it and report what changed.
pub trait DesignMap {
    /// In real numbers.
    fn real(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String>;
    /// With a complex step.
    fn complex(&self, x: &[Complex64]) -> Result<ModelNumbers<Complex64>, String>;
    /// With derivative lanes.
    fn lanes(&self, x: &[Lanes]) -> Result<ModelNumbers<Lanes>, String>;
    /// Recorded for the reverse sweep.
    fn recorded(&self, x: &[Rev]) -> Result<ModelNumbers<Rev>, String>;
}

/// The recorded map at one design.
pub struct DesignChain {
    tape: Tape,
    numbers: ModelNumbers<Rev>,
}

impl DesignChain {
    /// Records the map once.
    ///
    /// # Errors
    /// Those of the map.
    pub fn record(map: &dyn DesignMap, x: &[f64]) -> Result<Self, String> {
        let (tape, numbers) = Tape::record(x, |x| map.recorded(x));
        Ok(DesignChain { tape, numbers: numbers? })
    }

    /// Which parameters depend on any variable: the adjoint sweep leaves the others alone.
    pub fn active_parameters(&self) -> Vec<bool> {
        self.numbers.p.iter().map(|p| !p.is_constant()).collect()
    }

    /// (dp/dx)^T p_bar + (dq0/dx)^T q_bar + (dv0/dx)^T v_bar.
    pub fn gradient(&self, bar: &ModelNumbers<f64>) -> Vec<f64> {
        let pairs = |numbers: &[Rev], bars: &[f64]| numbers.iter().copied().zip(bars.iter().copied()).collect::<Vec<_>>();
        let ModelNumbers { p, q, v } = &self.numbers;
        self.tape.gradient([pairs(p, &bar.p), pairs(q, &bar.q), pairs(v, &bar.v)].concat())
    }
}
