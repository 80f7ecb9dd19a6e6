use crate::elements::joints::gap;
use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A spring along the line between two points: V = k (l - l0)^2 / 2 \[J\], l = |x_b - x_a|.
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `rest length`  l0 \[m\], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]
pub struct LineSpring {
    /// First end.
    pub a: NodeKind,
    /// Second end.
    pub b: NodeKind,
}

impl Element for LineSpring {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness", "N/m").as_size(),
        Parameter::non_negative("rest length", "m"),
        Parameter::new("point a x", "m"),
        Parameter::new("point a y", "m"),
        Parameter::new("point a z", "m"),
        Parameter::new("point b x", "m"),
        Parameter::new("point b y", "m"),
        Parameter::new("point b z", "m"),
    ];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = gap([self.a, self.b], q, &p[2..]).length();
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let stretch = e[0] - p[1];
        stretch * stretch * p[0] * 0.5
    }
}
