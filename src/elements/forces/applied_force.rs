use super::LoadFrame;
use crate::elements::{Element, Frame, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A force F = d f(t) \[N\] at a point of a body or at a point mass.
///
/// * `direction x, y, z`  d, in the world or, for a follower force, in the body frame [-]
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point
/// * parameters of f(t) \[N\]
pub struct AppliedForce {
    /// What the force acts on.
    pub on: NodeKind,
    /// Dead or follower load; a point has no frame to follow.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

impl Element for AppliedForce {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("direction x", "-"),
        Parameter::new("direction y", "-"),
        Parameter::new("direction z", "-"),
        Parameter::new("point x", "m"),
        Parameter::new("point y", "m"),
        Parameter::new("point z", "m"),
    ];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.on]
    }
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.iter().cloned().chain(self.size.parameters("N")).collect()
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, _v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let mut direction = Vector3::first_three(p);
        if self.frame == LoadFrame::Body && self.on.has_axes() {
            direction = Frame::of(self.on, q).direction(p);
        }
        self.on.add_force(q, Vector3::first_three(&p[3..]), direction * self.size.value(t, &p[6..]), force);
    }
    fn breakpoints<S: Scalar>(&self, p: &[S]) -> Vec<S> {
        self.size.breakpoints(&p[6..])
    }
}
