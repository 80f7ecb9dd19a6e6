use super::spring_law::LENGTH;
use crate::elements::entries::{
    BETWEEN, ENDS, Entry, Example, ExampleValue, FROM_TO, Given, Key, Range, TWO_BODIES, Type, may, need,
};
use crate::elements::joints::{gap, points};
use crate::elements::{Element, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A spring along the line between two points: V = k (l - l0)^2 / 2 \[J\], l = |x_b - x_a|.
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `rest length`  l0 \[m\], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]
#[derive(Hash)]
pub struct LineSpring(pub NodePair);

impl Element for LineSpring {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::non_negative("stiffness", "N/m").as_size(), Parameter::non_negative("rest length", "m")];
        own.into_iter().chain(points()).collect()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = gap(self.0, q, &p[2..]).length();
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain(LENGTH)
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let stretch = e[0] - p[1];
        stretch * stretch * p[0] * 0.5
    }
}

impl Entry for LineSpring {
    type Law = Self;
    const NAME: &'static str = "line";
    const DOC: &'static str = "along the line between two points";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        ENDS,
        need("stiffness", Type::Number("N/m", Range::AtLeastZero), "stiffness"),
        may("rest_length", Type::Number("m", Range::AtLeastZero), "length without force; the length at the start"),
    ];
    const EXAMPLE: Example =
        (TWO_BODIES, &[FROM_TO, ("stiffness", ExampleValue::Number(5.0)), ("rest_length", ExampleValue::Number(0.7))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = [given.in_space(0), given.in_space(1)];
        let ends = given.points("points");
        let rest = given.number_or("rest_length", (ends[1] - ends[0]).length());
        (LineSpring(nodes), [&[given.number("stiffness"), rest][..], &given.local_points([0, 1], ends)].concat())
    }
}
