use crate::elements::{Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// A combination of the multipliers of one constraint: sum w_i mu_i.
///
/// The first three multipliers of a joint that holds points together are the force of b on a in world components \[N\].
///
/// * `weight i`  w_i for each equation of the constraint
#[derive(Hash)]
pub struct Reaction {
    /// Number of equations of the constraint.
    pub equations: usize,
    /// "N" of forces, "N m" of moments.
    pub unit: &'static str,
}

impl Quantity for Reaction {
    fn dofs(&self) -> usize {
        0
    }
    fn unit(&self) -> &'static str {
        self.unit
    }
    fn parameters(&self) -> Vec<Parameter> {
        (1..=self.equations).map(|i| Parameter::named(format!("weight {i}"), "-")).collect()
    }
    fn value<S: Scalar>(&self, _s: State<S>, mu: &[S], p: &[S], _t: S) -> S {
        mu.iter().zip(p).map(|(&mu, &weight)| mu * weight).sum()
    }
}
