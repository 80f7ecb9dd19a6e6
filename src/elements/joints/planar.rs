use super::{components, points, vectors};
use crate::elements::entries::{ACROSS, AT, BETWEEN, Entry, Example, Given, Key, NORMAL, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::Scalar;

/// Two faces that slide on each other: the points stay at one height \[m\] and the normals parallel [-].
///
/// g = (n_b . d, u_a . n_b, w_a . n_b) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `tangent u`, `tangent w`  unit vectors of the plane in the frame of a, not parallel
/// * `normal`  n_b, unit vector in the frame of b
#[derive(Hash)]
pub struct PlanarJoint(pub NodePair);

impl Constraint for PlanarJoint {
    const EQUATIONS: usize = 3;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["tangent u", "tangent w", "normal"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        let normal = b.direction(&p[12..]);
        g[0] = normal.dot(&(b.point(&p[3..]) - a.point(p)));
        components(&a, &p[6..12], normal, &mut g[1..]);
    }
}

impl Entry for PlanarJoint {
    type Law = Self;
    const NAME: &'static str = "planar";
    const DOC: &'static str = "b slides on a plane and turns about its normal";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, NORMAL];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ACROSS]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (PlanarJoint(given.bodies()), given.point_and_guide("normal"))
    }
}
