use super::{POINTS, gap};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar};

/// Two bodies welded together: points held together [m], and twice the vector part of the remaining rotation is zero [rad].
///
/// g = (x_b - x_a, 2 vec(e_a* e_b e_ab*))
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `e0..e3`  e_ab, Euler parameters of b relative to a
pub struct FixedJoint;

impl Constraint for FixedJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 6;

    fn parameters(&self) -> Vec<Parameter> {
        POINTS.iter().cloned().chain(["e0", "e1", "e2", "e3"].map(|name| Parameter::new(name, "-"))).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        let remaining = ea.conjugate().times(eb).times(Quaternion::from_slice(&p[6..]).conjugate());
        g[..3].copy_from_slice(&gap([Anchor::Body; 2], q, p).0);
        g[3..].copy_from_slice(&(remaining.parts().1 * S::from(2.0)).0);
    }
}
