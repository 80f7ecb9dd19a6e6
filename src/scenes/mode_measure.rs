use super::ModeGradient;
use crate::functionals::Functional;
use crate::integrators::{Mode, RunError};

/// A number of a mode of small vibrations about the start of a scene or its equilibrium: runs and sweeps measure it beside their functionals, and
/// the objective and limits of optimizations may name it as they do these.
///
/// The mode is the one that has this number at each design, with those that topple counted first: where two cross, a limit has a kink, and none on
/// the first frequency is met by the second. Of several modes with one value the gradient is that of their mean.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeMeasure {
    /// What it is called.
    pub name: String,
    /// Which mode, from 1: as `costate modes` numbers them, rigid motions and unstable ones among them.
    pub number: usize,
    /// Its growth [1/s] instead of its omega [rad/s], for which of one that topples minus its growth stands: -sqrt(-omega^2).
    pub growth: bool,
    /// With dampers, states of first order and what else depends on velocities; about a steady turn that is always so.
    pub damped: bool,
}

impl ModeMeasure {
    /// omega \[rad/s\] of a mode without damping.
    pub fn frequency(name: &str, number: usize) -> Self {
        ModeMeasure { name: name.into(), number, growth: false, damped: false }
    }

    /// The number of a mode.
    pub(crate) fn value(&self, mode: &Mode) -> f64 {
        match (self.growth, mode.topples()) {
            (true, _) => mode.growth,
            (false, true) => -mode.growth,
            (false, false) => mode.frequency,
        }
    }

    /// Its derivatives by all design variables.
    pub(super) fn rates(&self, mode: &Mode, gradient: &ModeGradient) -> Vec<f64> {
        match (self.growth, mode.topples()) {
            (true, _) => gradient.growth.clone(),
            (false, true) => gradient.growth.iter().map(|own| -own).collect(),
            (false, false) => gradient.frequency.clone(),
        }
    }

    /// Its unit.
    #[doc(hidden)]
    pub fn unit(&self) -> &'static str {
        if self.growth { "1/s" } else { "rad/s" }
    }
}

/// Refuses names that functionals have, or that are there twice, and modes without a number.
pub fn check_modes(measures: &[ModeMeasure], functionals: &[Functional]) -> Result<(), RunError> {
    let mut names: Vec<&str> = functionals.iter().map(|own| own.name.as_str()).collect();
    for ModeMeasure { name, number, .. } in measures {
        if *number == 0 {
            return Err(RunError::Input(format!("\"{name}\" is of mode 0; modes count from 1")));
        }
        if names.contains(&name.as_str()) {
            let words = format!("\"{name}\" is the name of a mode and of something else that is measured");
            return Err(RunError::Input(words));
        }
        names.push(name);
    }
    Ok(())
}
