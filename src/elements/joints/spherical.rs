use super::{POINTS, add_pair, gap};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Two points held together: g = x_b - x_a [m]. The multipliers are the force of b on a, in world components [N].
///
/// * `point a`, `point b`  in the frames of the bodies [m]
pub struct SphericalJoint {
    /// First end.
    pub a: Anchor,
    /// Second end.
    pub b: Anchor,
}

impl Constraint for SphericalJoint {
    const DOFS: usize = 24;
    const EQUATIONS: usize = 3;
    const PARAMETERS: &'static [Parameter] = &POINTS;
    const SEPARABLE: bool = true;
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g.copy_from_slice(&gap([self.a, self.b], q, p).components());
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        add_pair([self.a, self.b], q, p, Vector3::first_three(mu), r);
    }
}
