use super::{ANGLE, POINTS, angle_between, vectors};
use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// A rack that rolls on a pinion, both on a common carrier: r theta - s = 0 [m].
///
/// theta is the angle of the pinion against the carrier, s = n_c . (x_rack - x_carrier). Whole turns are left out, so that any
/// number of them is exact. It only couples; a revolute and a prismatic joint beside it guide pinion and rack. The multiplier is the
/// force on the rack along n_c [N].
///
/// Nodes: carrier, pinion, rack.
///
/// * `point a`, `point b`  of the carrier and of the rack, in their frames [m]: s = 0 where they meet
/// * `axis`, `reference a`  unit vectors in the frame of the carrier, at right angles
/// * `reference b`  unit vector in the frame of the pinion
/// * `direction`  n_c, unit vector in the frame of the carrier
/// * `pitch radius`  r [m], greater than 0
pub struct RackAndPinion;

impl Constraint for RackAndPinion {
    const DOFS: usize = 21;
    const EQUATIONS: usize = 1;
    const STEADY: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        let radius = Parameter::positive("pitch radius", "m");
        POINTS.into_iter().chain(ANGLE).chain(vectors(&["direction"])).chain([radius]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (carrier, rack, radius) = (&q[..7], &q[14..], p[18]);
        let position = |q, point: &[S]| Anchor::Body.position(q, Vec3::from_slice(point));
        let direction = Quaternion::from_slice(&carrier[3..]).rotate(Vec3::from_slice(&p[15..]));
        let path = direction.dot(position(rack, &p[3..]) - position(carrier, p));
        g[0] = angle_between(q, &p[6..], path / radius) * radius;
    }
}
