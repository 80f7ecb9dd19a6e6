use crate::elements::entries::{AT, Entry, Example, ExampleValue, Given, Key, ON, ONE_BODY, PLACE, Type, may};
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Squared distance of a point from a target: |x - x*|^2 \[m2\].
///
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point node
/// * `target x, y, z`  x*, in the world \[m\]
#[derive(Hash)]
pub struct TargetDistance {
    /// What the point belongs to.
    pub of: NodeKind,
}

impl Quantity for TargetDistance {
    fn dofs(&self) -> usize {
        self.of.dofs()
    }
    fn unit(&self) -> &'static str {
        "m2"
    }
    fn parameters(&self) -> Vec<Parameter> {
        Parameter::vectors(&["point", "target"], "m")
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let miss = self.of.position(s.q, Vector3::first_three(p)) - Vector3::first_three(&p[3..]);
        miss.dot(&miss)
    }
}

impl Entry for TargetDistance {
    type Law = Self;
    const NAME: &'static str = "target";
    const DOC: &'static str = "squared distance of a point from a target in the world [m2]";
    const KEYS: &'static [Key] = &[ON, PLACE, may("target", Type::Vector("m"), "target; where the point starts")];
    const EXAMPLE: Example = (ONE_BODY, &[AT, ("target", ExampleValue::Point([0.4, 0.9, -0.3]))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (of, point) = (given.in_space(0), given.point("point", 0));
        let target = given.vector_or("target", point);
        (TargetDistance { of }, [given.node(0).local_point(point).components(), target.components()].concat())
    }
}
