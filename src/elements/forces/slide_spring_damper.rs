use super::Soft;
use crate::elements::joints::{POINTS, PairGradient, components, gap, vectors};
use crate::elements::{Anchor, Constraint, Element, Frame, Parameter, State};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A spring and damper along an axis of body a: F = k (s - s0) + c ds/dt [N], s = n_a . (x_b - x_a).
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `damping`  c [N s/m], 0 or greater
/// * `rest displacement`  s0 [m]
/// * `point a`, `point b`  in the frames of the bodies [m]
/// * `axis`  n_a, unit vector in the frame of a
pub struct SlideSpringDamper {
    /// What guides: a body.
    pub a: Anchor,
    /// What slides.
    pub b: Anchor,
}

/// s - s0 with the parameters (s0, points, axis).
struct Slide {
    a: Anchor,
    b: Anchor,
}

impl Constraint for Slide {
    const DOFS: usize = 24;
    const EQUATIONS: usize = 1;
    const REACTION: bool = true;
    const STEADY: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        [Parameter::new("rest displacement", "m")].into_iter().chain(POINTS).chain(vectors(&["axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        components(&Frame::of(self.a, q), &p[7..], gap([self.a, self.b], q, &p[1..]), g);
        g[0] -= p[0];
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let mut towards = PairGradient::new([self.a, self.b], q);
        towards.add_component(&p[1..], Vector3::first_three(&p[7..]) * mu[0]);
        towards.write(q, r);
    }
}

impl SlideSpringDamper {
    fn soft(&self) -> Soft<Slide> {
        Soft(Slide { a: self.a, b: self.b })
    }
}

impl Element for SlideSpringDamper {
    const DOFS: usize = 24;
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn dofs(&self) -> usize {
        self.soft().dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::non_negative("stiffness", "N/m"), Parameter::non_negative("damping", "N s/m")];
        own.into_iter().chain(self.soft().0.parameters()).collect()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.soft().potential(q, p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        self.soft().add_force(v, q, p, t, force);
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        self.soft().residual(s, p, t, r);
    }
}
