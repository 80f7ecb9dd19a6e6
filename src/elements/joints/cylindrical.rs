use super::{components, points, vectors};
use crate::elements::entries::{ALONG, AT, AXIS, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::Scalar;

/// A slider that may turn: the point of b stays on an axis of a \[m\], and the axis of b parallel to it [-].
///
/// g = (u_a . d, w_a . d, u_a . n_b, w_a . n_b) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the axis
/// * `axis`  n_b, unit vector in the frame of b
#[derive(Hash)]
pub struct CylindricalJoint(pub NodePair);

impl Constraint for CylindricalJoint {
    const EQUATIONS: usize = 4;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["normal u", "normal w", "axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        components(&a, &p[6..12], b.point(&p[3..]) - a.point(p), &mut g[..2]);
        components(&a, &p[6..12], b.direction(&p[12..]), &mut g[2..]);
    }
}

impl Entry for CylindricalJoint {
    type Law = Self;
    const NAME: &'static str = "cylindrical";
    const DOC: &'static str = "b slides along and turns about an axis";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (CylindricalJoint(given.bodies()), given.point_and_guide("axis"))
    }
}
