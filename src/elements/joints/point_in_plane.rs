use super::{POINTS, PairGradient, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Frame, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A point of b in a plane of a: g = n_a . (x_b - x_a) [m]. The multiplier is minus the force on b along the normal [N].
///
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `normal`  n_a, unit vector in the frame of a
pub struct PointInPlane {
    /// What guides: a body.
    pub a: Anchor,
    /// What slides.
    pub b: Anchor,
}

impl Constraint for PointInPlane {
    const DOFS: usize = 24;
    const EQUATIONS: usize = 1;
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["normal"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let ends = [self.a, self.b];
        components(&Frame::of(self.a, q), &p[6..], gap(ends, q, p), g);
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let mut towards = PairGradient::new([self.a, self.b], q);
        towards.add_component(p, Vector3::first_three(&p[6..]) * mu[0]);
        towards.write(q, r);
    }
}
