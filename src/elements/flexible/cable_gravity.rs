use super::hermite::NODES;
use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::Scalar;

/// Weight of a cable element, integrated exactly: V = -m l g . (r_1 / 2 + l r_1x / 12 + r_2 / 2 - l r_2x / 12) \[J\].
///
/// * `length`  l \[m\], greater than 0
/// * `mass`  m, for each length [kg/m], 0 or greater
/// * `gravity x, y, z`  g [m/s2]
///
/// Source: Ebrahimi et al., eq. (35).
#[derive(Hash)]
pub struct CableGravity;

/// Weights of (r_1, r_1x, r_2, r_2x) in the integral of r.
#[inline(always)]
fn shares<S: Scalar>(p: &[S]) -> [S; 4] {
    let (half, twelfth) = (p[0] * p[1] * 0.5, p[0] * p[0] * p[1] / 12.0);
    [half, twelfth, half, -twelfth]
}

impl Element for CableGravity {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Slope; NODES]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::positive("length", "m"), Parameter::non_negative("mass", "kg/m")];
        own.into_iter().chain(Parameter::vectors(&["gravity"], "m/s2")).collect()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let shares = shares(p);
        let mut energy = S::zero();
        for i in 0..4 {
            for k in 0..3 {
                energy -= shares[i] * p[2 + k] * q[3 * i + k];
            }
        }
        energy
    }
}
