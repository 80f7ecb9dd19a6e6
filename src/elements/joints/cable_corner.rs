use crate::elements::entries::{BETWEEN, Entry, Example, Given, Key};
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
#[derive(Hash)]
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

/// Least sine of the angle of a corner.
const LEAST_SINE: f64 = 1e-3;

impl Entry for CableCorner {
    type Law = Self;
    const NAME: &'static str = "cable_corner";
    const DOC: &'static str = "nodes of two cables welded to each other";
    const KEYS: &'static [Key] = &[BETWEEN];
    const EXAMPLE: Example = (&[NodeKind::Slope, NodeKind::Slope], &[]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let name = given.owner();
        if [0, 1].map(|node| given.node(node).kind) != [NodeKind::Slope; 2] {
            given.wrong(format!(
                "\"{name}\" needs nodes of two cables, but got \"{}\" and \"{}\": a cable is welded to a body by cable_weld",
                given.name(0),
                given.name(1)
            ));
            return (CableCorner, vec![S::one()]);
        }
        let [a, b] = [0, 1].map(|node| given.node(node).slope());
        let angle = a.cross(&b).length().atan2(a.dot(&b));
        if angle.sin().value() < LEAST_SINE {
            let degrees = angle.value().to_degrees();
            given.wrong(format!(
                "\"{name}\" joins cables at {degrees:.3} degrees; cables that go straight on share a node (from_node, to_node)"
            ));
        }
        (CableCorner, vec![angle])
    }
}
