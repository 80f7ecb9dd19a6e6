use super::{POINTS, PairGradient, RELATIVE_ROTATION, combination, components, remaining_rotation, vectors};
use crate::elements::{Anchor, Constraint, Frame, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A slider without rotation: the point of b stays on a line of a [m], and twice the vector part of the remaining rotation is
/// zero [rad].
///
/// g = (u_a . d, w_a . d, 2 vec(e_a* e_b e_ab*)) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the line
/// * `e0..e3`  e_ab, Euler parameters of b relative to a
pub struct PrismaticJoint {
    /// First body.
    pub a: Anchor,
    /// Second body.
    pub b: Anchor,
}

impl Constraint for PrismaticJoint {
    const DOFS: usize = 24;
    const EQUATIONS: usize = 5;
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal u", "normal w"])).chain(RELATIVE_ROTATION).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair([self.a, self.b], q);
        components(&a, &p[6..12], b.point(&p[3..]) - a.point(p), &mut g[..2]);
        g[2..].copy_from_slice(&remaining_rotation([self.a, self.b], q, &p[12..]).components());
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let mut towards = PairGradient::new([self.a, self.b], q);
        towards.add_component(p, combination(&p[6..], mu));
        towards.add_remaining_rotation(&p[12..], Vector3::first_three(&mu[2..]), q, r);
        towards.write(q, r);
    }
}
