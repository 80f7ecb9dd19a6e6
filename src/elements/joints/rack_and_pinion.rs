use super::{angle, angle_between, points, vectors};
use crate::elements::entries::{ALONG, AXIS, Entry, Example, ExampleValue, Given, Key, Type, exactly, need};
use crate::elements::{Constraint, Frame, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A rack that rolls on a pinion, both on a common carrier: r theta - s = 0 \[m\].
///
/// theta is the angle of the pinion against the carrier, s = n_c . (x_rack - x_carrier). Whole turns are left out, so that any
/// number of them is exact. It only couples; a revolute and a prismatic joint beside it guide pinion and rack. The multiplier is the
/// force on the rack along n_c \[N\].
///
/// Nodes: carrier, pinion, rack.
///
/// * `point a`, `point b`  of the carrier and of the rack, in their frames \[m\]: s = 0 where they meet
/// * `axis`, `reference a`  unit vectors in the frame of the carrier, at right angles
/// * `reference b`  unit vector in the frame of the pinion
/// * `direction`  n_c, unit vector in the frame of the carrier
/// * `pitch radius`  r \[m\], greater than 0
#[derive(Hash)]
pub struct RackAndPinion {
    /// Carrier, pinion and rack.
    pub nodes: [NodeKind; 3],
}

impl Constraint for RackAndPinion {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.nodes.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let radius = Parameter::positive("pitch radius", "m");
        points().into_iter().chain(angle()).chain(vectors(&["direction"])).chain([radius]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [carrier, pinion, rack] = self.nodes;
        let behind = carrier.dofs() + pinion.dofs();
        let (frame, radius) = (Frame::of(carrier, q), p[18]);
        let between = rack.position(&q[behind..], Vector3::first_three(&p[3..])) - frame.point(p);
        let path = frame.direction(&p[15..]).dot(&between);
        g[0] = angle_between([carrier, pinion], q, &p[6..], path / radius) * radius;
    }
}

impl Entry for RackAndPinion {
    type Law = Self;
    const NAME: &'static str = "rack_and_pinion";
    const DOC: &'static str = "a rack on a pinion";
    const KEYS: &'static [Key] = &[
        need("between", exactly(3, &Type::Node), "carrier, pinion, rack"),
        need("centre", Type::Vector("m"), "a point of the pinion's axis"),
        need("contact", Type::Vector("m"), "where the pitch circle touches the rack"),
        AXIS,
    ];
    const EXAMPLE: Example = (
        &[NodeKind::Body, NodeKind::Body, NodeKind::Body],
        &[("centre", ExampleValue::Point([0.0, 0.0, 0.0])), ("contact", ExampleValue::Point([0.24, 0.0, -0.18])), ALONG],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = [0, 1, 2].map(|node| given.body(node));
        let [centre, contact] = ["centre", "contact"].map(|place| given.vector(place));
        let axis = given.unit("axis");
        let arm = contact - centre;
        let arm = arm - axis * axis.dot(&arm);
        let radius = arm.length();
        let points = given.local_points([0, 2], [contact; 2]);
        let along = given.unit_of(arm);
        let direction = given.local_directions(0, [axis.cross(&along)]);
        (RackAndPinion { nodes }, [&points[..], &given.angle_frame(axis), &direction, &[radius]].concat())
    }
}
