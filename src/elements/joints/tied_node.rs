use super::{RELATIVE_ROTATION, remaining_rotation};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use smallvec::SmallVec;

/// A node b carried along by the nodes i of a face or edge, with weights w_i whose sum is 1: its place \[m\] and, if it is a body, its
/// orientation \[rad\] follow what is interpolated between theirs.
///
/// g = (x_b - sum w_i (x_i + R_i o), 2 vec(e* e_b e_ib*)) with the mean e = sum w_i e_i of Euler parameters, which turns as the nodes do: for
/// small angles the second is the difference between the rotation of b and the mean of those of the nodes. It is there only for a
/// body: 3 or 6 equations. The first three multipliers are the force of b on the other nodes, in world components \[N\].
///
/// * `weight 1..`  w_i
/// * `offset x, y, z`  o, place of b beyond the mean of the nodes, in their frames, which start alike \[m\]
/// * `e0..e3`  e_ib, Euler parameters of b relative to these frames; only for a body
#[derive(Hash)]
pub struct TiedNode {
    /// Number of nodes that carry it: bodies, as those of shells are.
    pub carriers: usize,
    /// What is carried along, the last node.
    pub b: NodeKind,
}

impl Constraint for TiedNode {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        let mut nodes = vec![NodeKind::Body; self.carriers];
        nodes.push(self.b);
        nodes
    }
    fn equations(&self) -> usize {
        if self.b.has_axes() { 6 } else { 3 }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let weights = (1..=self.carriers).map(|number| Parameter::named(format!("weight {number}"), "-"));
        let offset = Parameter::vectors(&["offset"], "m");
        let rotation = if self.b.has_axes() { &RELATIVE_ROTATION[..] } else { &[] };
        weights.chain(offset).chain(rotation.iter().cloned()).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (weights, place) = p.split_at(self.carriers);
        let (carriers, own) = q.split_at(self.carriers * NodeKind::Body.dofs());
        let (mut carried, mut mean) = (Vector3::zeros(), [S::zero(); 4]);
        for (q, &weight) in carriers.chunks_exact(NodeKind::Body.dofs()).zip(weights) {
            carried += NodeKind::Body.position(q, Vector3::first_three(place)) * weight;
            mean.iter_mut().zip(&q[3..]).for_each(|(sum, &e)| *sum += e * weight);
        }
        g[..3].copy_from_slice(&(Vector3::first_three(own) - carried).components());
        if self.b.has_axes() {
            let carrier = carried.components().into_iter().chain(mean);
            let both: SmallVec<[S; 19]> = carrier.chain(own.iter().copied()).collect();
            g[3..].copy_from_slice(&remaining_rotation([NodeKind::Body, self.b], &both, &place[3..]).components());
        }
    }
}
