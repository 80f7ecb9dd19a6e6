use super::{RELATIVE_ROTATION, Surfaces, components, points, remaining_rotation, vectors};
use crate::elements::entries::{ALONG, AT, AXIS, BETWEEN, Entry, Example, Given, Key, POINT, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A slider without rotation: the point of b stays on a line of a \[m\], and twice the vector part of the remaining rotation is
/// zero \[rad\].
///
/// g = (u_a . d, w_a . d, 2 vec(e_a* e_b e_ab*)) with d = x_b - x_a
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a, both at right angles to the line
/// * `e0..e3`  e_ab, Euler parameters of b relative to a
#[derive(Hash)]
pub struct PrismaticJoint(pub NodePair);

impl Constraint for PrismaticJoint {
    const EQUATIONS: usize = 5;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["normal u", "normal w"])).chain(RELATIVE_ROTATION).collect()
    }
    fn surfaces(&self) -> Option<Surfaces> {
        Some(Surfaces::Slide)
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        components(&a, &p[6..12], b.point(&p[3..]) - a.point(p), &mut g[..2]);
        g[2..].copy_from_slice(&remaining_rotation(self.0, q, &p[12..]).components());
    }
}

impl Entry for PrismaticJoint {
    type Law = Self;
    const NAME: &'static str = "prismatic";
    const DOC: &'static str = "b slides along an axis without turning";
    const KEYS: &'static [Key] = &[BETWEEN, POINT, AXIS];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let (point, axis) = (given.point("point", 1), given.unit("axis"));
        let (points, normals) = (given.local_points([0, 1], [point; 2]), given.local_directions(0, axis.perpendiculars()));
        (PrismaticJoint(nodes), [&points[..], &normals, &given.relative_rotation().0].concat())
    }
}
