use crate::elements::entries::{BETWEEN, ENDS, Entry, Example, FROM_TO, Given, Key, TWO_BODIES};
use crate::elements::joints::{gap, points};
use crate::elements::{NodePair, Parameter, State, dofs_of};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector};

/// Distance of two points: |x_b - x_a| \[m\]; where they meet its derivative is taken as zero.
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]; ignored for nodes without axes
#[derive(Hash)]
pub struct Distance(pub NodePair);

impl Quantity for Distance {
    fn dofs(&self) -> usize {
        dofs_of(&self.0)
    }
    fn unit(&self) -> &'static str {
        "m"
    }
    fn parameters(&self) -> Vec<Parameter> {
        points()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        gap(self.0, s.q, p).length()
    }
}

impl Entry for Distance {
    type Law = Self;
    const NAME: &'static str = "distance";
    const DOC: &'static str = "distance of two points [m]";
    const KEYS: &'static [Key] = &[BETWEEN, ENDS];
    const EXAMPLE: Example = (TWO_BODIES, &[FROM_TO]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = [given.in_space(0), given.in_space(1)];
        let ends = given.points("points");
        (Distance(nodes), given.local_points([0, 1], ends))
    }
}
