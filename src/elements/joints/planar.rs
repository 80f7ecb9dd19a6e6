use super::{POINTS, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// Two faces that slide on each other: the points stay at one height [m] and the normals parallel [-].
///
/// g = (n_b . d, u_a . n_b, w_a . n_b) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `tangent u`, `tangent w`  unit vectors of the plane in the frame of a, not parallel
/// * `normal`  n_b, unit vector in the frame of b
pub struct PlanarJoint;

impl Constraint for PlanarJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 3;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["tangent u", "tangent w", "normal"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let normal = Quaternion::from_slice(&q[10..]).rotate(Vec3::from_slice(&p[12..]));
        g[0] = normal.dot(gap([Anchor::Body; 2], q, p));
        components(q, &p[6..12], normal, &mut g[1..]);
    }
}
