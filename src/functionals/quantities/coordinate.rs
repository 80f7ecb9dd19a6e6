use crate::elements::State;
use crate::elements::entries::{Entry, Example, Given, INDEX, Key, ON, ONE_BODY};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// One coordinate of a node, as it is.
#[derive(Hash)]
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
    fn unit(&self) -> &'static str {
        "-"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.q[self.index]
    }
}

impl Entry for Coordinate {
    type Law = Self;
    const NAME: &'static str = "coordinate";
    const DOC: &'static str = "one coordinate of a node, such as a joint angle";
    const KEYS: &'static [Key] = &[ON, INDEX];
    const EXAMPLE: Example = (ONE_BODY, &[]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (kind, index) = given.coordinate();
        (Coordinate { of: kind.dofs(), index }, Vec::new())
    }
}
