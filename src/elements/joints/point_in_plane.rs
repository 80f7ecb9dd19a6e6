use super::{components, gap, points, vectors};
use crate::elements::entries::{ACROSS, AT, BETWEEN, Entry, Example, Given, Key, NORMAL, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::Scalar;

/// A point of b in a plane of a: g = n_a . (x_b - x_a) \[m\]. The multiplier is minus the force on b along the normal \[N\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal`  n_a, unit vector in the frame of a
#[derive(Clone, Hash)]
pub struct PointInPlane(pub NodePair);

impl Constraint for PointInPlane {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["normal"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        components(&Frame::of(self.0[0], q), &p[6..], gap(self.0, q, p), g);
    }
}

impl Entry for PointInPlane {
    type Law = Self;
    const NAME: &'static str = "point_in_plane";
    const DOC: &'static str = "a point of b in a plane of a";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, NORMAL];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ACROSS]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (PointInPlane(given.body_and_guided()), given.point_and_direction("normal"))
    }
}
