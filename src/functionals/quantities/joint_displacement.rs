use crate::elements::joints::{POINTS, components, gap, vectors};
use crate::elements::{Frame, NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Displacement of a point of b along an axis of body a: s = n_a . (x_b - x_a) \[m\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]: s = 0 where they meet
/// * `axis`  n_a, unit vector in the frame of a
pub struct JointDisplacement {
    /// The body with the axis.
    pub a: NodeKind,
    /// What slides.
    pub b: NodeKind,
}

impl Quantity for JointDisplacement {
    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain(vectors(&["axis"])).collect()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let mut displacement = [S::zero()];
        components(&Frame::of(self.a, s.q), &p[6..], gap([self.a, self.b], s.q, p), &mut displacement);
        displacement[0]
    }
}

/// Its rate ds/dt [m/s], with the same parameters.
pub struct JointSpeed {
    /// The body with the axis.
    pub a: NodeKind,
    /// What slides.
    pub b: NodeKind,
}

impl Quantity for JointSpeed {
    fn dofs(&self) -> usize {
        JointDisplacement { a: self.a, b: self.b }.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        JointDisplacement { a: self.a, b: self.b }.parameters()
    }
    fn rated_count(&self) -> usize {
        1
    }
    fn rated<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        components(&Frame::of(self.a, q), &p[6..], gap([self.a, self.b], q, p), e);
    }
    fn value_with_rates<S: Scalar>(&self, _e: &[S], rate: &[S], _p: &[S]) -> S {
        rate[0]
    }
}
