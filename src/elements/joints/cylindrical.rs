use super::{POINTS, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// A slider that may turn: the point of b stays on an axis of a [m], and the axis of b parallel to it [-].
///
/// g = (u_a . d, w_a . d, u_a . n_b, w_a . n_b) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the axis
/// * `axis`  n_b, unit vector in the frame of b
pub struct CylindricalJoint;

impl Constraint for CylindricalJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 4;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal u", "normal w", "axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let axis = Quaternion::from_slice(&q[10..]).rotate(Vec3::from_slice(&p[12..]));
        components(q, &p[6..12], gap([Anchor::Body; 2], q, p), &mut g[..2]);
        components(q, &p[6..12], axis, &mut g[2..]);
    }
}
