use super::{POINTS, angle_beyond, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};
use std::f64::consts::TAU;

/// A screw: like a cylindrical joint, and b advances along the axis of a by the pitch with every turn [m].
///
/// g = (u_a . d, w_a . d, u_a . n_b, w_a . n_b, (pitch / 2 pi) theta - s) with d = x_b - x_a, s = (u_a x w_a) . d, and theta the
/// angle from u_a to the reference of b. Whole pitches are left out, so that any number of turns is exact.
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal u`, `normal w`  unit vectors in the frame of a that make a right-handed triad with the axis
/// * `axis`  n_b, unit vector in the frame of b
/// * `reference b`  unit vector in the frame of b at right angles to the axis: it stands along u_a where d = 0
/// * `pitch`  [m per turn], not 0; negative for a left-handed thread
pub struct HelicalJoint;

impl Constraint for HelicalJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 5;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        let vectors = vectors(&["normal u", "normal w", "axis", "reference b"]);
        POINTS.into_iter().chain(vectors).chain([Parameter::non_zero("pitch", "m")]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        let vector = |i: usize| Vec3::from_slice(&p[i..]);
        let (u, pitch) = (ea.rotate(vector(6)), p[18]);
        let axis = ea.rotate(vector(6).cross(vector(9)));
        let between = gap([Anchor::Body; 2], q, p);
        components(q, &p[6..12], between, &mut g[..2]);
        components(q, &p[6..12], eb.rotate(vector(12)), &mut g[2..4]);
        let beyond = angle_beyond(axis, u, eb.rotate(vector(15)), axis.dot(between) * TAU / pitch);
        g[4] = beyond * pitch / TAU;
    }
}
