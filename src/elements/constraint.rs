use super::Parameter;
use crate::scalar::Scalar;

/// A holonomic constraint g(q, p, t) = 0: nothing but g is written.
///
/// The reaction A^T mu with A = dg/dq, the velocity level dg/dt = 0, the acceleration level d2g/dt2 = 0, projections and
/// all their derivatives follow by differentiation.
pub trait Constraint: Send + Sync + 'static {
    /// Number of coordinates of all its nodes together; the largest if [`dofs`](Constraint::dofs) chooses.
    const DOFS: usize;
    /// Number of equations; the largest if [`equations`](Constraint::equations) chooses.
    const EQUATIONS: usize;
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];
    /// True if g is a sum of functions of one node each (and p, t): then the reaction on one node does not depend on the others,
    /// and the matrix has no entries between them. The contract tests hold it against g.
    const SEPARABLE: bool = false;
    /// True if g does not depend on time: a soft version of it then has an energy. The contract tests hold it against g.
    const STEADY: bool = false;
    /// True if [`reaction`](Constraint::reaction) is written out as well.
    const REACTION: bool = false;

    /// Number of coordinates of this instance.
    fn dofs(&self) -> usize {
        Self::DOFS
    }
    /// Number of equations of this instance.
    fn equations(&self) -> usize {
        Self::EQUATIONS
    }
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Writes g(q, p, t) to `g`; scale the rows so that they are lengths or angles.
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]);
    /// Adds A^T mu to `r`: the forces with which the constraint acts on its nodes.
    ///
    /// Not needed: it follows from g. A constraint of which scenes have many may write it out, some three times as fast as by
    /// differentiation, and set [`REACTION`](Constraint::REACTION); the contract tests then hold the two together.
    fn reaction<S: Scalar>(&self, _q: &[S], _mu: &[S], _p: &[S], _t: S, _r: &mut [S]) {}
    /// Times at which the motion it prescribes is not smooth: steps end there.
    fn kinks(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}
