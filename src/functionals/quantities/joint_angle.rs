use crate::elements::entries::{ALONG, AXIS, BETWEEN, Entry, Example, Given, Key, TWO_BODIES};
use crate::elements::joints::{angle, angle_between};
use crate::elements::{NodePair, Parameter, State, dofs_of};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Angle of body b against body a about an axis of a, in (-pi, pi] \[rad\].
///
/// Over several turns measure the coordinate of [`AngleCoordinate`](crate::elements::joints::AngleCoordinate) instead.
///
/// * `axis`, `reference a`  unit vectors in the frame of a, at right angles
/// * `reference b`  unit vector in the frame of b
#[derive(Hash)]
pub struct JointAngle(pub NodePair);

impl Quantity for JointAngle {
    fn dofs(&self) -> usize {
        dofs_of(&self.0)
    }
    fn unit(&self) -> &'static str {
        "rad"
    }
    fn parameters(&self) -> Vec<Parameter> {
        angle()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        angle_between(self.0, s.q, p, S::zero())
    }
}

impl Entry for JointAngle {
    type Law = Self;
    const NAME: &'static str = "joint_angle";
    const DOC: &'static str = "angle of b against a about an axis, in (-pi, pi] [rad]";
    const KEYS: &'static [Key] = &[BETWEEN, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (nodes, axis) = (given.bodies(), given.unit("axis"));
        (JointAngle(nodes), given.angle_frame(axis))
    }
}
