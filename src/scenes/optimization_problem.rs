// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::design::DesignVariable;

/// Whether an objective is to become small or large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Small.
    Minimize,
    /// Large.
    Maximize,
}

impl Sense {
    /// `minimize` or `maximize`.
    pub fn name(self) -> &'static str {
        match self {
            Sense::Minimize => "minimize",
            Sense::Maximize => "maximize",
        }
    }
}

/// What a constrained quantity must be, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
    /// Exactly this.
    Equal(f64),
}

impl Limit {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            Limit::AtMost(value) | Limit::AtLeast(value) | Limit::Equal(value) => value,
        }
    }
    /// As people write it: `<=`, `>=`, `=`.
    pub fn sign(self) -> &'static str {
        match self {
            Limit::AtMost(_) => "<=",
            Limit::AtLeast(_) => ">=",
            Limit::Equal(_) => "=",
        }
    }
}

/// A functional that must keep a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionalConstraint {
    /// Name of the functional.
    pub functional: String,
    /// What it must be.
    pub limit: Limit,
    /// A violation of this size is of the order of 1; without it the size of the limit or, where that is zero, of the start.
    pub scale: Option<f64>,
}

/// A weighted sum of design variables that must keep a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearConstraint {
    /// What it is for.
    pub name: String,
    /// Names of design variables and their coefficients.
    pub coefficients: Vec<(String, f64)>,
    /// What the sum must be.
    pub limit: Limit,
}

/// What a scene wants: an objective, constraints, and the design variables that may change, within their bounds.
///
/// ```
/// use costate::scenes::{Limit, OptimizationProblem};
/// let problem = OptimizationProblem::minimize("mass")
///     .subject_to("largest moment", Limit::AtMost(120.0))
///     .linear("slope of the rod", &[("rod length", 1.0), ("crank length", -2.5)], Limit::AtLeast(0.0))
///     .varying(&["rod length", "crank length", "side"]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OptimizationProblem {
    /// Small or large.
    pub sense: Sense,
    /// Names of functionals and their weights; the objective is the sum.
    pub objective: Vec<(String, f64)>,
    /// An objective of this size is of the order of 1; without it the size at the start.
    pub scale: Option<f64>,
    /// Limits of functionals.
    pub constraints: Vec<FunctionalConstraint>,
    /// Limits of sums of design variables.
    pub linear: Vec<LinearConstraint>,
    /// Names of the variables that may change; without it all.
    pub varying: Option<Vec<String>>,
    /// Limits of functionals that are kept by more than this, in their scale, count as constant: see [`OptimizationProblem::screened`].
    pub screening: Option<f64>,
}

impl OptimizationProblem {
    fn new(sense: Sense, objective: Vec<(String, f64)>) -> Self {
        let (constraints, linear) = (Vec::new(), Vec::new());
        OptimizationProblem { sense, objective, scale: None, constraints, linear, varying: None, screening: None }
    }

    /// A functional is to become small.
    pub fn minimize(functional: &str) -> Self {
        Self::new(Sense::Minimize, vec![(functional.into(), 1.0)])
    }

    /// A functional is to become large.
    pub fn maximize(functional: &str) -> Self {
        Self::new(Sense::Maximize, vec![(functional.into(), 1.0)])
    }

    /// A weighted sum of functionals is to become small or large.
    pub fn weighted(sense: Sense, objective: &[(&str, f64)]) -> Self {
        Self::new(sense, objective.iter().map(|&(name, weight)| (name.into(), weight)).collect())
    }

    /// The objective in words: `psi`, or `2 mass + 0.5 psi`.
    #[doc(hidden)]
    pub fn objective_name(&self) -> String {
        let term = |(name, weight): &(String, f64)| if *weight == 1.0 { name.clone() } else { format!("{weight} {name}") };
        self.objective.iter().map(term).collect::<Vec<_>>().join(" + ")
    }

    /// A functional must keep a limit.
    #[must_use]
    pub fn subject_to(mut self, functional: &str, limit: Limit) -> Self {
        self.constraints.push(FunctionalConstraint { functional: functional.into(), limit, scale: None });
        self
    }

    /// A weighted sum of design variables must keep a limit.
    #[must_use]
    pub fn linear(mut self, name: &str, coefficients: &[(&str, f64)], limit: Limit) -> Self {
        let coefficients = coefficients.iter().map(|&(name, coefficient)| (name.into(), coefficient)).collect();
        self.linear.push(LinearConstraint { name: name.into(), coefficients, limit });
        self
    }

    /// Only these variables may change.
    #[must_use]
    pub fn varying(mut self, variables: &[&str]) -> Self {
        self.varying = Some(variables.iter().map(|&name| name.into()).collect());
        self
    }

    /// Limits of functionals that are kept by more than `margin` times their scale count as constant: their gradients are not computed, but
    /// taken as zero. A design that comes nearer to them gets them back, and an optimizer that sees one violated steps back.
    ///
    /// With many limits of which few matter, the adjoint costs what those few cost.
    ///
    /// Source: the deletion of constraints in Haftka & Gürdal, Elements of Structural Optimization.
    #[must_use]
    pub fn screened(mut self, margin: f64) -> Self {
        self.screening = Some(margin);
        self
    }

    /// Checks names and numbers against what the scene has; numbers of modes are among its functionals.
    ///
    /// # Errors
    /// The first name that does not exist, with the list of those that do, or the first number that makes no sense.
    pub fn check(&self, variables: &[DesignVariable], functionals: &[&str]) -> Result<(), String> {
        let variables: Vec<&str> = variables.iter().map(|variable| variable.name.as_str()).collect();
        let unknown = |kind: &str, place: &str, name: &str, known: &[&str]| {
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            Err(format!("{place} names the {kind} \"{name}\", which the scene has not; it has: {known}"))
        };
        let weights = self.objective.iter().map(|(name, weight)| ("the objective".to_string(), name, *weight));
        let limits = self.constraints.iter();
        let limits = limits
            .map(|c| (format!("a constraint ({} {})", c.limit.sign(), c.limit.value()), &c.functional, c.limit.value()));
        for (place, name, number) in weights.chain(limits) {
            if !functionals.contains(&name.as_str()) {
                return unknown("functional", &place, name, functionals);
            }
            if !number.is_finite() {
                return Err(format!("{place} of \"{name}\" has the number {number}; it must be finite"));
            }
        }
        if self.objective.iter().all(|(_, weight)| *weight == 0.0) {
            return Err("the objective has no functional with a weight other than 0".into());
        }
        let scales = self.constraints.iter().map(|c| (c.functional.as_str(), c.scale));
        for (name, scale) in scales.chain([("the objective", self.scale)]) {
            if let Some(scale) = scale.filter(|scale| !(*scale > 0.0 && scale.is_finite())) {
                return Err(format!("the scale of {name} is {scale}; it must be a number above 0"));
            }
        }
        if let Some(margin) = self.screening.filter(|margin| !(*margin > 0.0)) {
            return Err(format!("the margin of screening is {margin}; it must be above 0"));
        }
        for constraint in &self.linear {
            let place = format!("the linear constraint \"{}\"", constraint.name);
            for (name, coefficient) in &constraint.coefficients {
                if !variables.contains(&name.as_str()) {
                    return unknown("design variable", &place, name, &variables);
                }
                if !coefficient.is_finite() {
                    return Err(format!("{place} gives \"{name}\" the coefficient {coefficient}; it must be finite"));
                }
            }
            if !constraint.limit.value().is_finite() {
                return Err(format!("{place} has the limit {}; it must be finite", constraint.limit.value()));
            }
        }
        let Some(varying) = &self.varying else {
            return if variables.is_empty() { Err("the scene has no design variable".into()) } else { Ok(()) };
        };
        match varying.iter().find(|name| !variables.contains(&name.as_str())) {
            Some(name) => unknown("design variable", "the list of what varies", name, &variables),
            None if varying.is_empty() => Err("the list of what varies is empty".into()),
            None => Ok(()),
        }
    }
}
