use super::{POINTS, components, gap, vectors};
use crate::elements::{Constraint, Frame, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A point of b in a plane of a: g = n_a . (x_b - x_a) \[m\]. The multiplier is minus the force on b along the normal \[N\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal`  n_a, unit vector in the frame of a
pub struct PointInPlane {
    /// What guides: a body.
    pub a: NodeKind,
    /// What slides.
    pub b: NodeKind,
}

impl Constraint for PointInPlane {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let ends = [self.a, self.b];
        components(&Frame::of(self.a, q), &p[6..], gap(ends, q, p), g);
    }
}
