use super::{POINTS, components, vectors};
use crate::elements::{Constraint, Frame, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A universal (Cardan, Hooke) joint: points held together \[m\] and the two pins of the cross at right angles [-].
///
/// g = (x_b - x_a, n_a . n_b)
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `pin a`  n_a, unit vector in the frame of a
/// * `pin b`  n_b, unit vector in the frame of b
pub struct UniversalJoint {
    /// First body.
    pub a: NodeKind,
    /// Second body.
    pub b: NodeKind,
}

impl Constraint for UniversalJoint {
    const EQUATIONS: usize = 4;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["pin a", "pin b"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair([self.a, self.b], q);
        g[..3].copy_from_slice(&(b.point(&p[3..]) - a.point(p)).components());
        components(&a, &p[6..9], b.direction(&p[9..]), &mut g[3..]);
    }
}
