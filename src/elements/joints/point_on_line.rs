use super::{Surfaces, components, gap, points, vectors};
use crate::elements::entries::{ALONG, AT, AXIS, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A point of b on a line of a: g = (u_a . d, w_a . d) with d = x_b - x_a \[m\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the line
#[derive(Hash)]
pub struct PointOnLine(pub NodePair);

impl Constraint for PointOnLine {
    const EQUATIONS: usize = 2;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["normal u", "normal w"])).collect()
    }
    fn surfaces(&self) -> Option<Surfaces> {
        Some(Surfaces::Slide)
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        components(&Frame::of(self.0[0], q), &p[6..], gap(self.0, q, p), g);
    }
}

impl Entry for PointOnLine {
    type Law = Self;
    const NAME: &'static str = "point_on_line";
    const DOC: &'static str = "a point of b on a line of a";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.body_and_guided();
        let (point, axis) = (given.point("point", 1), given.unit("axis"));
        let normals = given.local_directions(0, axis.perpendiculars());
        (PointOnLine(nodes), [given.local_points([0, 1], [point; 2]), normals].concat())
    }
}
