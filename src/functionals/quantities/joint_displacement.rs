use crate::elements::entries::{ALONG, AT, AXIS, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::joints::{components, gap, points, vectors};
use crate::elements::{Frame, NodePair, Parameter, State, dofs_of};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Displacement of a point of b along an axis of body a: s = n_a . (x_b - x_a) \[m\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]: s = 0 where they meet
/// * `axis`  n_a, unit vector in the frame of a
#[derive(Hash)]
pub struct JointDisplacement(pub NodePair);

impl Quantity for JointDisplacement {
    fn dofs(&self) -> usize {
        dofs_of(&self.0)
    }
    fn unit(&self) -> &'static str {
        "m"
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["axis"])).collect()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let mut displacement = [S::zero()];
        components(&Frame::of(self.0[0], s.q), &p[6..], gap(self.0, s.q, p), &mut displacement);
        displacement[0]
    }
}

/// Its rate ds/dt [m/s], with the same parameters.
#[derive(Hash)]
pub struct JointSpeed(pub NodePair);

impl Quantity for JointSpeed {
    fn dofs(&self) -> usize {
        dofs_of(&self.0)
    }
    fn unit(&self) -> &'static str {
        "m/s"
    }
    fn parameters(&self) -> Vec<Parameter> {
        JointDisplacement(self.0).parameters()
    }
    fn rated_count(&self) -> usize {
        1
    }
    fn rated<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        components(&Frame::of(self.0[0], q), &p[6..], gap(self.0, q, p), e);
    }
    fn value_with_rates<S: Scalar>(&self, _e: &[S], rate: &[S], _p: &[S]) -> S {
        rate[0]
    }
}

impl Entry for JointDisplacement {
    type Law = Self;
    const NAME: &'static str = "joint_displacement";
    const DOC: &'static str = "displacement of a point of b along an axis of a since the start [m]";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (JointDisplacement(given.body_and_guided()), given.point_and_direction("axis"))
    }
}

impl Entry for JointSpeed {
    type Law = Self;
    const NAME: &'static str = "joint_speed";
    const DOC: &'static str = "its rate [m/s]";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (JointSpeed(given.body_and_guided()), given.point_and_direction("axis"))
    }
}
