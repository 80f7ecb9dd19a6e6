use super::{angle, angle_between};
use crate::elements::{Constraint, NodeKind, NodePair, Parameter, dofs_of};
use crate::scalar::Scalar;

/// A coordinate phi that counts the turns of b against a about an axis of body a: theta - phi = 0 \[rad\].
///
/// An angle read from two orientations is known up to whole turns, and so is g; phi itself goes on beyond them. The coordinate needs
/// no inertia. A joint beside it holds the axis.
///
/// Nodes: a, b, and one coordinate.
///
/// * `axis`, `reference a`  unit vectors in the frame of a, at right angles
/// * `reference b`  unit vector in the frame of b
#[derive(Hash)]
pub struct AngleCoordinate(pub NodePair);

impl Constraint for AngleCoordinate {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        [&self.0[..], &[NodeKind::Coordinates(1)]].concat()
    }
    fn parameters(&self) -> Vec<Parameter> {
        angle()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g[0] = angle_between(self.0, q, p, q[dofs_of(&self.0)]);
    }
}
