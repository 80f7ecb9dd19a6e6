use super::{RELATIVE_ROTATION, gap, points, remaining_rotation};
use crate::elements::entries::{AT, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// Two bodies welded together: points held together \[m\], and twice the vector part of the remaining rotation is zero \[rad\].
///
/// g = (x_b - x_a, 2 vec(e_a* e_b e_ab*))
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `e0..e3`  e_ab, Euler parameters of b relative to a
#[derive(Hash)]
pub struct FixedJoint(pub NodePair);

impl Constraint for FixedJoint {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(RELATIVE_ROTATION).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g[..3].copy_from_slice(&gap(self.0, q, p).components());
        g[3..].copy_from_slice(&remaining_rotation(self.0, q, &p[6..]).components());
    }
}

impl Entry for FixedJoint {
    type Law = Self;
    const NAME: &'static str = "fixed";
    const DOC: &'static str = "two bodies welded together";
    const KEYS: &'static [Key] = &[BETWEEN, POINT];
    const EXAMPLE: Example = (TWO_BODIES, &[AT]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let point = given.point("point", 1);
        let relative = given.relative_rotation().0;
        (FixedJoint(nodes), [&given.local_points([0, 1], [point; 2])[..], &relative].concat())
    }
}
