use super::{RELATIVE_ROTATION, remaining_rotation};
use crate::elements::entries::{BETWEEN, Entry, Example, Given, Key, TWO_BODIES};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A rigid connection between two nodes: b keeps its place in the frame of a \[m\] and, if it is a body, its orientation \[rad\].
///
/// g = (r_b - r_a - R_a c, 2 vec(e_a* e_b e_ab*)), the second only for a body: 3 or 6 equations. The first three multipliers are
/// the force of b on a, in world components \[N\].
///
/// * `offset`  c, place of the node b in the frame of a \[m\]
/// * `e0..e3`  e_ab, Euler parameters of b relative to a; only for a body
#[derive(Hash)]
pub struct RigidLink(pub NodePair);

impl Constraint for RigidLink {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn equations(&self) -> usize {
        if self.0[1].has_axes() { 6 } else { 3 }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let rotation = if self.0[1].has_axes() { &RELATIVE_ROTATION[..] } else { &[] };
        [&Parameter::vectors(&["offset"], "m")[..], rotation].concat()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let carried = Frame::of(self.0[0], q).point(p);
        g[..3].copy_from_slice(&(Vector3::first_three(&q[self.0[0].dofs()..]) - carried).components());
        if self.0[1].has_axes() {
            g[3..].copy_from_slice(&remaining_rotation(self.0, q, &p[3..]).components());
        }
    }
}

impl Entry for RigidLink {
    type Law = Self;
    const NAME: &'static str = "rigid_link";
    const DOC: &'static str = "b carried along by a as it stands";
    const KEYS: &'static [Key] = &[BETWEEN];
    const EXAMPLE: Example = (TWO_BODIES, &[]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.body_and_guided();
        let mut p = given.node(0).local_point(given.node(1).position()).components().to_vec();
        if nodes[1].has_axes() {
            p.extend(given.relative_rotation().0);
        }
        (RigidLink(nodes), p)
    }
}
