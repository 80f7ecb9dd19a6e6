use crate::elements::entries::{AT, DIRECTION, Entry, Example, Given, HEADING, Key, ON, ONE_BODY, PLACE, Type, may};
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Acceleration of a point along a direction that turns with its body, less gravity: (R d) . (d2x/dt2 - g) [m/s2], as a sensor that is fixed there shows
/// it.
///
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point node
/// * `direction x, y, z`  d, in the body frame; in the world for a point node [-]
/// * `gravity x, y, z`  g, in the world [m/s2]
#[derive(Hash)]
pub struct Acceleration {
    /// What the point belongs to.
    pub of: NodeKind,
}

impl Quantity for Acceleration {
    fn dofs(&self) -> usize {
        self.of.dofs()
    }
    fn unit(&self) -> &'static str {
        "m/s2"
    }
    fn parameters(&self) -> Vec<Parameter> {
        let gravity = Parameter::vectors(&["gravity"], "m/s2");
        [super::point_and_direction(), gravity].concat()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let [point, direction, gravity] = [0, 3, 6].map(|first| Vector3::first_three(&p[first..]));
        (self.of.acceleration([s.a, s.v, s.q], point) - gravity).dot(&self.of.turned(s.q, direction))
    }
}

impl Entry for Acceleration {
    type Law = Self;
    const NAME: &'static str = "acceleration";
    const DOC: &'static str =
        "acceleration of a point along a direction that turns with its body, less gravity, as a sensor shows it [m/s2]";
    const KEYS: &'static [Key] =
        &[ON, PLACE, DIRECTION, may("gravity", Type::Vector("m/s2"), "gravity, which a sensor at rest shows upwards; none")];
    const EXAMPLE: Example = (ONE_BODY, &[AT, HEADING]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (of, point) = (given.in_space(0), given.point("point", 0));
        let (direction, gravity) = (given.vector("direction"), given.vector_or("gravity", Vector3::zeros()));
        let node = given.node(0);
        let p = [node.local_point(point), node.local_direction(direction), gravity].map(|own| own.components()).concat();
        (Acceleration { of }, p)
    }
}
