use crate::elements::joints::{POINTS, components, gap, vectors};
use crate::elements::{Anchor, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Dual, Scalar};
use smallvec::SmallVec;

/// Displacement of a point of b along an axis of body a: s = n_a . (x_b - x_a) [m].
///
/// * `point a`, `point b`  in the frames of the bodies [m]: s = 0 where they meet
/// * `axis`  n_a, unit vector in the frame of a
pub struct JointDisplacement {
    /// What slides.
    pub b: Anchor,
}

impl Quantity for JointDisplacement {
    fn dofs(&self) -> usize {
        Anchor::Body.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["axis"])).collect()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let mut displacement = [S::zero()];
        components(s.q, &p[6..], gap([Anchor::Body, self.b], s.q, p), &mut displacement);
        displacement[0]
    }
}

/// Its rate ds/dt [m/s], with the same parameters.
pub struct JointSpeed {
    /// What slides.
    pub b: Anchor,
}

impl Quantity for JointSpeed {
    fn dofs(&self) -> usize {
        JointDisplacement { b: self.b }.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        JointDisplacement { b: self.b }.parameters()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], t: S) -> S {
        // one dual direction along the motion
        let q: SmallVec<[Dual<S, 1>; 14]> = s.q.iter().zip(s.v).map(|(&re, &v)| Dual { re, eps: [v] }).collect();
        let p: SmallVec<[Dual<S, 1>; 9]> = p.iter().map(|&p| Dual::constant(p)).collect();
        let along = State { a: &[], v: &[], q: &q };
        JointDisplacement { b: self.b }.value(along, &[], &p, Dual::constant(t)).eps[0]
    }
}
