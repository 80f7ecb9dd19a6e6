use super::POINTS;
use crate::elements::{Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3, combine_columns};

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
        let (a, b) = q.split_at(7);
        // three vectors of a and two of b are rotated: the matrices are formed once
        let (ra, rb) = (Quaternion::from_slice(&a[3..]).columns(), Quaternion::from_slice(&b[3..]).columns());
        let vector = |i: usize| Vec3::from_slice(&p[i..]);
        let axis = combine_columns(&rb, vector(12));
        let point_a = Vec3::from_slice(a) + combine_columns(&ra, vector(0));
        let point_b = Vec3::from_slice(b) + combine_columns(&rb, vector(3));
        g[..3].copy_from_slice(&(point_b - point_a).0);
        g[3] = combine_columns(&ra, vector(6)).dot(axis);
        g[4] = combine_columns(&ra, vector(9)).dot(axis);
    }
}
