use super::{POINTS, gap};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// Two points held together: g = x_b - x_a \[m\]. The multipliers are the force of b on a, in world components \[N\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
pub struct SphericalJoint {
    /// First end.
    pub a: NodeKind,
    /// Second end.
    pub b: NodeKind,
}

impl Constraint for SphericalJoint {
    const EQUATIONS: usize = 3;
    const PARAMETERS: &'static [Parameter] = &POINTS;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g.copy_from_slice(&gap([self.a, self.b], q, p).components());
    }
}
