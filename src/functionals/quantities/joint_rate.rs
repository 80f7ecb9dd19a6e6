use crate::elements::{Frame, NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Angular velocity of body b against body a along an axis of a: n_a . (omega_b - omega_a) [rad/s].
///
/// * `axis`  n_a, unit vector in the frame of a
pub struct JointRate {
    /// First body.
    pub a: NodeKind,
    /// Second body.
    pub b: NodeKind,
}

impl Quantity for JointRate {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("axis x", "-"), Parameter::new("axis y", "-"), Parameter::new("axis z", "-")];

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let split = self.a.dofs();
        let relative = self.b.angular_velocity(&s.v[split..], &s.q[split..]) - self.a.angular_velocity(s.v, s.q);
        Frame::of(self.a, s.q).direction(p).dot(&relative)
    }
}
