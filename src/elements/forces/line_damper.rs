use super::spring_law::LENGTH;
use crate::elements::entries::{
    BETWEEN, ENDS, Entry, Example, ExampleValue, FROM_TO, Given, Key, Range, TWO_BODIES, Type, need,
};
use crate::elements::joints::{gap, points};
use crate::elements::{Element, NodeKind, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A damper along the line between two points: tension c dl/dt \[N\], l = |x_b - x_a|.
///
/// * `damping`  c [N s/m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]
pub struct LineDamper {
    /// First end.
    pub a: NodeKind,
    /// Second end.
    pub b: NodeKind,
}

/// Parameters shared by the dampers between two points.
pub(super) fn damper_parameters() -> Vec<Parameter> {
    [Parameter::non_negative("damping", "N s/m")].into_iter().chain(points()).collect()
}

/// x_b - x_a for the points of [`damper_parameters`] \[m\].
pub(super) fn between<S: Scalar>([a, b]: [NodeKind; 2], q: &[S], p: &[S]) -> Vector3<S> {
    gap([a, b], q, &p[1..])
}

impl Element for LineDamper {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        damper_parameters()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = between([self.a, self.b], q, p).length();
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
    let ends = [given.in_space(0), given.in_space(1)];
    let points = given.points("points");
    (ends, [&[given.number("damping")][..], &given.local_points([0, 1], points)].concat())
}

impl Entry for LineDamper {
    type Law = Self;
    const NAME: &'static str = "line";
    const DOC: &'static str = "on the rate of the distance of two points";
    const KEYS: &'static [Key] = DAMPER_KEYS;
    const EXAMPLE: Example = DAMPER_EXAMPLE;

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let ([a, b], p) = held(given);
        (LineDamper { a, b }, p)
    }
}
