use super::{POINTS, gap};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A massless link of given length between two points: g = (|x_b - x_a|^2 - l^2) / (2 l) \[m\].
///
/// The multiplier is the tension for a link at its length \[N\], negative in compression.
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `length`  l \[m\], greater than 0
pub struct DistanceJoint {
    /// First end.
    pub a: NodeKind,
    /// Second end.
    pub b: NodeKind,
}

impl Constraint for DistanceJoint {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn parameters(&self) -> Vec<Parameter> {
        POINTS.into_iter().chain([Parameter::positive("length", "m")]).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let between = gap([self.a, self.b], q, p);
        g[0] = (between.dot(&between) - p[6] * p[6]) / (p[6] * 2.0);
    }
}
