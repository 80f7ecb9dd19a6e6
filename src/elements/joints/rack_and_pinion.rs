use super::{ANGLE, POINTS, angle_between, vectors};
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
        POINTS.into_iter().chain(ANGLE).chain(vectors(&["direction"])).chain([radius]).collect()
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
