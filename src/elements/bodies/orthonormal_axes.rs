use crate::elements::{Constraint, NodeKind};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Axes u, v, w of a body in natural coordinates, of unit length and at right angles:
/// g = ((u . u - 1) / 2, (v . v - 1) / 2, (w . w - 1) / 2, u . v, u . w, v . w) [-].
///
/// They belong to one node and are eliminated there: of 12 coordinates and 6 equations, 6 unknowns reach the system matrix.
///
/// Source: Ebrahimi et al., eq. (38).
#[derive(Hash)]
pub struct OrthonormalAxes;

impl Constraint for OrthonormalAxes {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Natural]
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, g: &mut [S]) {
        let [u, v, w] = [3, 6, 9].map(|first| Vector3::first_three(&q[first..]));
        let half = S::from(0.5);
        g[0] = (u.dot(&u) - 1.0) * half;
        g[1] = (v.dot(&v) - 1.0) * half;
        g[2] = (w.dot(&w) - 1.0) * half;
        g[3] = u.dot(&v);
        g[4] = u.dot(&w);
        g[5] = v.dot(&w);
    }
}
