use super::{POINTS, components, gap, vectors};
use crate::elements::{Constraint, Frame, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A point of b on a line of a: g = (u_a . d, w_a . d) with d = x_b - x_a \[m\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the line
pub struct PointOnLine {
    /// What guides: a body.
    pub a: NodeKind,
    /// What slides.
    pub b: NodeKind,
}

impl Constraint for PointOnLine {
    const EQUATIONS: usize = 2;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal u", "normal w"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let ends = [self.a, self.b];
        components(&Frame::of(self.a, q), &p[6..], gap(ends, q, p), g);
    }
}
