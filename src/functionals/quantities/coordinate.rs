use crate::elements::State;
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// One coordinate of a node, as it is.
pub struct Coordinate {
    /// Number of coordinates of the node.
    pub of: usize,
    /// Which one, from 0.
    pub index: usize,
}

impl Quantity for Coordinate {
    fn dofs(&self) -> usize {
        self.of
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.q[self.index]
    }
}
