use super::line_damper::{DAMPER_PARAMETERS, add_damping};
use crate::elements::{Anchor, Element, Parameter, State};
use crate::scalar::Scalar;

/// A damper on the whole relative velocity of two points: force c (dx_b/dt - dx_a/dt) [N].
///
/// * `damping`  c [N s/m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies [m]
///
/// Source: Ebrahimi et al., eq. (65). [`LineDamper`](super::LineDamper) acts along the line only.
pub struct VectorDamper {
    /// First end.
    pub a: Anchor,
    /// Second end.
    pub b: Anchor,
}

impl Element for VectorDamper {
    const DOFS: usize = 24;
    const PARAMETERS: &'static [Parameter] = DAMPER_PARAMETERS;
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn is_linear(&self) -> bool {
        [self.a, self.b].iter().all(|end| *end != Anchor::Body)
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        add_damping([self.a, self.b], v, q, p, force, |_, velocity| velocity);
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        add_damping([self.a, self.b], s.v, s.q, p, r, |_, velocity| -velocity);
    }
}
