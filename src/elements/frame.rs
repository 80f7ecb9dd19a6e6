use super::NodeKind;
use crate::scalar::{Scalar, SpatialVector, Vector3, combine_columns};

/// Where the frame of a node stands in the world, whatever the coordinates of the node are: joints between axes see no more of it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    /// Position r of the origin \[m\].
    pub origin: Vector3<S>,
    /// Columns of R: they take components in the frame to the world.
    pub axes: [Vector3<S>; 3],
}

impl<S: Scalar> Frame<S> {
    /// The frame of a node with the coordinates `q`.
    #[inline(always)]
    pub fn of(anchor: NodeKind, q: &[S]) -> Self {
        Frame { origin: Vector3::first_three(q), axes: anchor.axes(q) }
    }

    /// The frames of two nodes whose coordinates follow each other.
    #[inline(always)]
    pub fn pair([a, b]: [NodeKind; 2], q: &[S]) -> [Self; 2] {
        let (qa, qb) = q.split_at(a.dofs());
        [Frame::of(a, qa), Frame::of(b, qb)]
    }

    /// World position r + R s of the point `s` \[m\].
    #[inline(always)]
    pub fn point(&self, s: &[S]) -> Vector3<S> {
        self.origin + self.direction(s)
    }

    /// World direction R s of the vector `s`.
    #[inline(always)]
    pub fn direction(&self, s: &[S]) -> Vector3<S> {
        combine_columns(&self.axes, Vector3::first_three(s))
    }

    /// Components R^T x of a world vector in the frame.
    #[inline(always)]
    pub fn seen(&self, x: Vector3<S>) -> Vector3<S> {
        Vector3::new(self.axes[0].dot(&x), self.axes[1].dot(&x), self.axes[2].dot(&x))
    }
}
