use super::{Surfaces, points, vectors};
use crate::elements::entries::{ALONG, AT, AXIS, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A hinge between two bodies: points held together \[m\] and the axis of b at right angles to two vectors of a [-].
///
/// g = (x_b - x_a, u_a . n_b, w_a . n_b)
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the axis
/// * `axis`  n_b, unit vector in the frame of b
#[derive(Hash)]
pub struct RevoluteJoint(pub NodePair);

impl Constraint for RevoluteJoint {
    const EQUATIONS: usize = 5;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["normal u", "normal w", "axis"])).collect()
    }
    fn surfaces(&self) -> Option<Surfaces> {
        Some(Surfaces::Bearing)
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        let axis = b.direction(&p[12..]);
        g[..3].copy_from_slice(&(b.point(&p[3..]) - a.point(p)).components());
        g[3] = a.direction(&p[6..]).dot(&axis);
        g[4] = a.direction(&p[9..]).dot(&axis);
    }
}

impl Entry for RevoluteJoint {
    type Law = Self;
    const NAME: &'static str = "revolute";
    const DOC: &'static str = "a common point and axis";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (RevoluteJoint(given.bodies()), given.point_and_guide("axis"))
    }
}
