use crate::elements::joints::{POINTS, gap};
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector};

/// Distance of two points: |x_b - x_a| \[m\]; where they meet its derivative is taken as zero.
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]; ignored for nodes without axes
pub struct Distance {
    /// First end.
    pub a: NodeKind,
    /// Second end.
    pub b: NodeKind,
}

impl Quantity for Distance {
    const PARAMETERS: &'static [Parameter] = &POINTS;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        gap([self.a, self.b], s.q, p).length()
    }
}
