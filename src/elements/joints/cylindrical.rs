use super::{POINTS, PairGradient, combination, components, vectors};
use crate::elements::{Anchor, Constraint, Frame, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A slider that may turn: the point of b stays on an axis of a [m], and the axis of b parallel to it [-].
///
/// g = (u_a . d, w_a . d, u_a . n_b, w_a . n_b) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the axis
/// * `axis`  n_b, unit vector in the frame of b
pub struct CylindricalJoint {
    /// First body.
    pub a: Anchor,
    /// Second body.
    pub b: Anchor,
}

impl Constraint for CylindricalJoint {
    const DOFS: usize = 24;
    const EQUATIONS: usize = 4;
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal u", "normal w", "axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair([self.a, self.b], q);
        components(&a, &p[6..12], b.point(&p[3..]) - a.point(p), &mut g[..2]);
        components(&a, &p[6..12], b.direction(&p[12..]), &mut g[2..]);
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let mut towards = PairGradient::new([self.a, self.b], q);
        let (normal, normal_to_axis) = (combination(&p[6..], mu), combination(&p[6..], &mu[2..]));
        towards.add_component(p, normal);
        towards.add_product(normal_to_axis, Vector3::first_three(&p[12..]));
        towards.write(q, r);
    }
}
