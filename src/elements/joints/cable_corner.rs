use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Two cables welded to each other at an angle: one place, and the angle phi between the slopes r_x.
///
/// g = (r_b - r_a \[m\], (cos phi - r_ax . r_bx / (|r_ax| |r_bx|)) / sin phi \[rad\]), the last one the angle in excess of phi as long as that is
/// small. The stretch of the slopes stays free, and a cable has no torsion: the angle is all that a weld can hold. Its multiplier is
/// the moment that opens the corner [N m].
///
/// * `angle`  phi \[rad\], between 0 and pi; cables that go straight on share a node instead
///
/// Source: the weld of Ebrahimi et al., section 6.3, in its least number of equations.
pub struct CableCorner;

impl Constraint for CableCorner {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("angle", "rad")];
    const EQUATIONS: usize = 4;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Slope; 2]
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (a, b) = q.split_at(NodeKind::Slope.dofs());
        g[..3].copy_from_slice(&(Vector3::first_three(b) - Vector3::first_three(a)).components());
        let [slope_a, slope_b] = [a, b].map(|node| Vector3::first_three(&node[3..]).unit());
        let (sine, cosine) = p[0].sin_cos();
        g[3] = (cosine - slope_a.dot(&slope_b)) / sine;
    }
}
