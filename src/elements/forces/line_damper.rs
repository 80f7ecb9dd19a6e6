use super::spring_law::LENGTH;
use crate::elements::entries::{
    BETWEEN, ENDS, Entry, Example, ExampleValue, FROM_TO, Given, Key, Range, TWO_BODIES, Type, need,
};
use crate::elements::joints::{gap, points};
use crate::elements::{Element, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A damper along the line between two points: tension c dl/dt \[N\], l = |x_b - x_a|.
///
/// * `damping`  c [N s/m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]
#[derive(Hash)]
pub struct LineDamper(pub NodePair);

/// Parameters shared by the dampers between two points.
pub(super) fn damper_parameters() -> Vec<Parameter> {
    [Parameter::non_negative("damping", "N s/m")].into_iter().chain(points()).collect()
}

impl Element for LineDamper {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        damper_parameters()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = gap(self.0, q, &p[1..]).length();
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain(LENGTH)
    }
    fn damping<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        s[0] = p[0] * rate[0];
    }
}

pub(super) const DAMPER_KEYS: &[Key] =
    &[BETWEEN, ENDS, need("damping", Type::Number("N s/m", Range::AtLeastZero), "damping")];
pub(super) const DAMPER_EXAMPLE: Example = (TWO_BODIES, &[FROM_TO, ("damping", ExampleValue::Number(2.3))]);

/// Kinds of both nodes, and the parameters of a damper between points of them.
pub(super) fn held<S: Scalar>(given: &mut Given<S>) -> ([NodeKind; 2], Vec<S>) {
    let nodes = [given.in_space(0), given.in_space(1)];
    let points = given.points("points");
    (nodes, [&[given.number("damping")][..], &given.local_points([0, 1], points)].concat())
}

impl Entry for LineDamper {
    type Law = Self;
    const NAME: &'static str = "line";
    const DOC: &'static str = "on the rate of the distance of two points";
    const KEYS: &'static [Key] = DAMPER_KEYS;
    const EXAMPLE: Example = DAMPER_EXAMPLE;

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (nodes, p) = held(given);
        (LineDamper(nodes), p)
    }
}
