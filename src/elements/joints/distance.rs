use super::{gap, points};
use crate::elements::entries::{BETWEEN, ENDS, Entry, Example, FROM_TO, Given, Key, TWO_BODIES};
use crate::elements::{Constraint, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A massless link of given length between two points: g = (|x_b - x_a|^2 - l^2) / (2 l) \[m\].
///
/// The multiplier is the tension for a link at its length \[N\], negative in compression.
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `length`  l \[m\], greater than 0
#[derive(Clone, Hash)]
pub struct DistanceJoint(pub NodePair);

impl Constraint for DistanceJoint {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain([Parameter::positive("length", "m")]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let between = gap(self.0, q, p);
        g[0] = (between.dot(&between) - p[6] * p[6]) / (p[6] * 2.0);
    }
}

impl Entry for DistanceJoint {
    type Law = Self;
    const NAME: &'static str = "distance";
    const DOC: &'static str = "a massless link between points";
    const KEYS: &'static [Key] = &[BETWEEN, ENDS];
    const EXAMPLE: Example = (TWO_BODIES, &[FROM_TO]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = [given.in_space(0), given.in_space(1)];
        let ends = given.points("points");
        let length = (ends[1] - ends[0]).length();
        (DistanceJoint(nodes), [&given.local_points([0, 1], ends)[..], &[length]].concat())
    }
}
