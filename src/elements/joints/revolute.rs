use super::{POINTS, gap};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// A hinge between two bodies: points held together [m] and the axis of b at right angles to two vectors of a [-].
///
/// g = (x_b - x_a, u_a . n_b, w_a . n_b)
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the axis
/// * `axis`  n_b, unit vector in the frame of b
pub struct RevoluteJoint;

impl Constraint for RevoluteJoint {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 5;

    fn parameters(&self) -> Vec<Parameter> {
        let vectors = ["u x", "u y", "u z", "w x", "w y", "w z", "axis x", "axis y", "axis z"];
        POINTS.iter().cloned().chain(vectors.map(|name| Parameter::new(name, "-"))).collect()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        let axis = eb.rotate(Vec3::from_slice(&p[12..]));
        g[..3].copy_from_slice(&gap([Anchor::Body; 2], q, p).0);
        g[3] = ea.rotate(Vec3::from_slice(&p[6..])).dot(axis);
        g[4] = ea.rotate(Vec3::from_slice(&p[9..])).dot(axis);
    }
}
