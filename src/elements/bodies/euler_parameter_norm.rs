use crate::elements::{Constraint, NodeKind};
use crate::scalar::{Quaternion, Scalar};

/// Unit length of a body node's Euler parameters: g = (e . e - 1) / 2 [-].
///
/// It belongs to one node and is eliminated there: 6 unknowns per rigid body reach the system matrix.
#[derive(Hash)]
pub struct EulerParameterNorm;

impl Constraint for EulerParameterNorm {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body]
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, g: &mut [S]) {
        g[0] = (Quaternion::from_slice(&q[3..]).norm_squared() - 1.0) * 0.5;
    }
}
