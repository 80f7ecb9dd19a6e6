use super::{angle_beyond, components, points, vectors};
use crate::elements::entries::{
    ALONG, AT, AXIS, BETWEEN, Entry, Example, ExampleValue, Given, Key, POINT, Range, TWO_BODIES, Type, need,
};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::f64::consts::TAU;

/// A screw: like a cylindrical joint, and b advances along the axis of a by the pitch with every turn \[m\].
///
/// g = (u_a . d, w_a . d, u_a . n_b, w_a . n_b, (pitch / 2 pi) theta - s) with d = x_b - x_a, s = (u_a x w_a) . d, and theta the
/// angle from u_a to the reference of b. Whole pitches are left out, so that any number of turns is exact.
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a that make a right-handed triad with the axis
/// * `axis`  n_b, unit vector in the frame of b
/// * `reference b`  unit vector in the frame of b at right angles to the axis: it stands along u_a where d = 0
/// * `pitch`  [m per turn], not 0; negative for a left-handed thread
#[derive(Hash)]
pub struct HelicalJoint(pub NodePair);

impl Constraint for HelicalJoint {
    const EQUATIONS: usize = 5;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let vectors = vectors(&["normal u", "normal w", "axis", "reference b"]);
        points().into_iter().chain(vectors).chain([Parameter::non_zero("pitch", "m")]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        let pitch = p[18];
        let axis_of_a = Vector3::first_three(&p[6..]).cross(&Vector3::first_three(&p[9..]));
        let between = b.point(&p[3..]) - a.point(p);
        components(&a, &p[6..12], between, &mut g[..2]);
        components(&a, &p[6..12], b.direction(&p[12..]), &mut g[2..4]);
        let turn = a.seen(between).dot(&axis_of_a) * TAU / pitch;
        g[4] = angle_beyond([&a, &b], [&axis_of_a.components(), &p[6..], &p[15..]], turn) * pitch / TAU;
    }
}

impl Entry for HelicalJoint {
    type Law = Self;
    const NAME: &'static str = "helical";
    const DOC: &'static str = "a screw";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        POINT,
        AXIS,
        need("pitch", Type::Number("m", Range::Any), "advance with each turn; negative for a left-handed thread"),
    ];
    const EXAMPLE: Example = (TWO_BODIES, &[AT, ALONG, ("pitch", ExampleValue::Number(0.8))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let (point, axis) = (given.point("point", 1), given.unit("axis"));
        let points = given.local_points([0, 1], [point; 2]);
        let mark = given.local_directions(1, [axis.perpendiculars()[0]]);
        (HelicalJoint(nodes), [&points[..], &given.guide(axis), &mark, &[given.number("pitch")]].concat())
    }
}
