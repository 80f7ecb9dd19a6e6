use crate::elements::State;
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Length of the first three multipliers of one constraint: for a joint that holds points together the force between them \[N\].
///
/// With fewer equations, of all of them. It has no derivative where it is zero.
pub struct ReactionNorm;

impl Quantity for ReactionNorm {
    fn dofs(&self) -> usize {
        0
    }
    fn value<S: Scalar>(&self, _s: State<S>, mu: &[S], _p: &[S], _t: S) -> S {
        mu.iter().take(3).map(|&mu| mu * mu).sum::<S>().sqrt()
    }
}
