use super::point_and_direction;
use crate::elements::entries::{AT, DIRECTION, Entry, Example, Given, HEADING, Key, ON, ONE_BODY, PLACE};
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Velocity of a point along a direction: d . dx/dt [m/s].
///
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point node
/// * `direction x, y, z`  d, in the world [-]
#[derive(Hash)]
pub struct Velocity {
    /// What the point belongs to.
    pub of: NodeKind,
}

impl Quantity for Velocity {
    fn dofs(&self) -> usize {
        self.of.dofs()
    }
    fn unit(&self) -> &'static str {
        "m/s"
    }
    fn parameters(&self) -> Vec<Parameter> {
        point_and_direction()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        self.of.velocity(s.v, s.q, Vector3::first_three(p)).dot(&Vector3::first_three(&p[3..]))
    }
}

impl Entry for Velocity {
    type Law = Self;
    const NAME: &'static str = "velocity";
    const DOC: &'static str = "velocity of a point along a direction [m/s]";
    const KEYS: &'static [Key] = &[ON, PLACE, DIRECTION];
    const EXAMPLE: Example = (ONE_BODY, &[AT, HEADING]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (of, point) = (given.in_space(0), given.point("point", 0));
        let p = [given.node(0).local_point(point).components(), given.vector("direction").components()].concat();
        (Velocity { of }, p)
    }
}
