use super::{POINTS, add_pair, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3, combine_columns, rotation_gradient_transposed};

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
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal u", "normal w", "axis"])).collect()
    }
    #[inline(always)]
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
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        add_pair([Anchor::Body, Anchor::Body], q, p, Vec3::from_slice(mu), r);
        let (a, b) = q.split_at(7);
        let (ea, eb) = (Quaternion::from_slice(&a[3..]), Quaternion::from_slice(&b[3..]));
        let vector = |i: usize| Vec3::from_slice(&p[i..]);
        // mu_4 u + mu_5 w turns with a, the axis with b
        let normal = vector(6) * mu[3] + vector(9) * mu[4];
        let moments = [
            rotation_gradient_transposed(ea, normal, eb.rotate(vector(12))),
            rotation_gradient_transposed(eb, vector(12), ea.rotate(normal)),
        ];
        for (first, moment) in [3, 10].into_iter().zip(moments) {
            for (r, moment) in r[first..].iter_mut().zip(moment) {
                *r += moment;
            }
        }
    }
}
