use super::{POINTS, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// A universal (Cardan, Hooke) joint: points held together [m] and the two pins of the cross at right angles [-].
///
/// g = (x_b - x_a, n_a . n_b)
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `pin a`  n_a, unit vector in the frame of a
/// * `pin b`  n_b, unit vector in the frame of b
pub struct UniversalJoint;

impl Constraint for UniversalJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 4;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["pin a", "pin b"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let pin = Quaternion::from_slice(&q[10..]).rotate(Vec3::from_slice(&p[9..]));
        g[..3].copy_from_slice(&gap([Anchor::Body; 2], q, p).0);
        components(q, &p[6..9], pin, &mut g[3..]);
    }
}
