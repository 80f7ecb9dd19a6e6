use crate::elements::{Anchor, Constraint, Parameter};
use crate::scalar::{Scalar, Vec3};

/// Two cables welded to each other at an angle: one place, and the angle phi between the slopes r_x.
///
/// g = (r_b - r_a [m], (cos phi - r_ax . r_bx / (|r_ax| |r_bx|)) / sin phi [rad]), the last one the angle in excess of phi as long as that is
/// small. The stretch of the slopes stays free, and a cable has no torsion: the angle is all that a weld can hold. Its multiplier is
/// the moment that opens the corner [N m].
///
/// * `angle`  phi [rad], between 0 and pi; cables that go straight on share a node instead
///
/// Source: the weld of Ebrahimi et al., section 6.3, in its least number of equations.
pub struct CableCorner;

impl Constraint for CableCorner {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("angle", "rad")];
    const DOFS: usize = 12;
    const EQUATIONS: usize = 4;
    const STEADY: bool = true;
    const REACTION: bool = true;

    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (a, b) = q.split_at(Anchor::Slope.dofs());
        g[..3].copy_from_slice(&(Vec3::from_slice(b) - Vec3::from_slice(a)).0);
        let [slope_a, slope_b] = [a, b].map(|node| Vec3::from_slice(&node[3..]).normalized());
        let (sine, cosine) = p[0].sin_cos();
        g[3] = (cosine - slope_a.dot(slope_b)) / sine;
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let n = Anchor::Slope.dofs();
        let slopes = [3, n + 3].map(|first| Vec3::from_slice(&q[first..]));
        let inverses = slopes.map(|slope| slope.norm().recip());
        let units = [slopes[0] * inverses[0], slopes[1] * inverses[1]];
        let cosine = units[0].dot(units[1]);
        let moment = mu[3] / p[0].sin();
        for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
            // d(a . b)/dr_x for unit vectors a, b along the slopes
            let turning = (units[1 - k] - units[k] * cosine) * (-(moment * inverses[k]));
            for i in 0..3 {
                r[n * k + i] += mu[i] * sign;
                r[n * k + 3 + i] += turning.0[i];
            }
        }
    }
}
