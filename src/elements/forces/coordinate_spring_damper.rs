use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A spring and damper on one coordinate of a node: F = k (q - q0) + c dq/dt.
///
/// On a joint angle that counts turns it is a torsion spring over any number of turns.
///
/// * `stiffness`  k [N/m, or N m/rad for an angle], 0 or greater
/// * `damping`  c [N s/m, or N m s/rad], 0 or greater
/// * `rest`  q0 [m, or rad]
pub struct CoordinateSpringDamper {
    /// Kind of the node.
    pub of: NodeKind,
    /// Which one, from 0.
    pub index: usize,
}

impl Element for CoordinateSpringDamper {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness", "N/m, N m/rad").as_size(),
        Parameter::non_negative("damping", "N s/m, N m s/rad"),
        Parameter::new("rest", "m, rad"),
    ];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.of]
    }
    #[inline(always)]
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let stretch = q[self.index] - p[2];
        p[0] * stretch * stretch * 0.5
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S], _t: S, force: &mut [S]) {
        force[self.index] -= p[1] * v[self.index];
    }
}
