use super::{gap, points};
use crate::elements::entries::{AT, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// Two points held together: g = x_b - x_a \[m\]. The multipliers are the force of b on a, in world components \[N\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
#[derive(Hash)]
pub struct SphericalJoint(pub NodePair);

impl Constraint for SphericalJoint {
    const EQUATIONS: usize = 3;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g.copy_from_slice(&gap(self.0, q, p).components());
    }
}

impl Entry for SphericalJoint {
    type Law = Self;
    const NAME: &'static str = "spherical";
    const DOC: &'static str = "a common point";
    const KEYS: &'static [Key] = &[BETWEEN, POINT];
    const EXAMPLE: Example = (TWO_BODIES, &[AT]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = [given.in_space(0), given.in_space(1)];
        let point = given.point("point", 1);
        (SphericalJoint(nodes), given.local_points([0, 1], [point; 2]))
    }
}
