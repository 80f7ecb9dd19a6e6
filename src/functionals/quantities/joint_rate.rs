use crate::elements::entries::{ALONG, AXIS, BETWEEN, Entry, Example, Given, Key, TWO_BODIES};
use crate::elements::{Frame, NodePair, Parameter, State, dofs_of};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Angular velocity of body b against body a along an axis of a: n_a . (omega_b - omega_a) [rad/s].
///
/// * `axis`  n_a, unit vector in the frame of a
#[derive(Hash)]
pub struct JointRate(pub NodePair);

impl Quantity for JointRate {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("axis x", "-"), Parameter::new("axis y", "-"), Parameter::new("axis z", "-")];

    fn dofs(&self) -> usize {
        dofs_of(&self.0)
    }
    fn unit(&self) -> &'static str {
        "rad/s"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let split = self.0[0].dofs();
        let relative = self.0[1].angular_velocity(&s.v[split..], &s.q[split..]) - self.0[0].angular_velocity(s.v, s.q);
        Frame::of(self.0[0], s.q).direction(p).dot(&relative)
    }
}

impl Entry for JointRate {
    type Law = Self;
    const NAME: &'static str = "joint_rate";
    const DOC: &'static str = "angular velocity of b against a along an axis of a [rad/s]";
    const KEYS: &'static [Key] = &[BETWEEN, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (nodes, axis) = (given.bodies(), given.unit("axis"));
        (JointRate(nodes), given.local_directions(0, [axis]))
    }
}
