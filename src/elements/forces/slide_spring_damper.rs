use super::Soft;
use super::soft::as_soft_joint;
use crate::elements::joints::{POINTS, components, gap, vectors};
use crate::elements::{Constraint, Element, Frame, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A spring and damper along an axis of body a: F = k (s - s0) + c ds/dt \[N\], s = n_a . (x_b - x_a).
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `damping`  c [N s/m], 0 or greater
/// * `rest displacement`  s0 \[m\]
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `axis`  n_a, unit vector in the frame of a
pub struct SlideSpringDamper {
    /// What guides: a body.
    pub a: NodeKind,
    /// What slides.
    pub b: NodeKind,
}

/// s - s0 with the parameters (s0, points, axis).
struct Slide {
    a: NodeKind,
    b: NodeKind,
}

impl Constraint for Slide {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        [Parameter::new("rest displacement", "m")].into_iter().chain(POINTS).chain(vectors(&["axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        components(&Frame::of(self.a, q), &p[7..], gap([self.a, self.b], q, &p[1..]), g);
        g[0] -= p[0];
    }
}

impl SlideSpringDamper {
    fn soft(&self) -> Soft<Slide> {
        Soft(Slide { a: self.a, b: self.b })
    }
}

impl Element for SlideSpringDamper {
    as_soft_joint!();

    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::non_negative("stiffness", "N/m").as_size(), Parameter::non_negative("damping", "N s/m")];
        own.into_iter().chain(self.soft().0.parameters()).collect()
    }
}
