use crate::elements::entries::{ACROSS, BETWEEN, Entry, Example, Given, Key, NORMAL};
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Deflection of a cable's node b seen from its node a, across the tangent there: (n x t) . (r_b - r_a) \[m\] with t = r_x / |r_x| at a.
///
/// * `normal x, y, z`  n, unit vector in the world: of the plane in which the cable bends
///
/// Source: Ebrahimi et al., section 6.1.
#[derive(Hash)]
pub struct CableDeflection;

impl Quantity for CableDeflection {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("normal x", "-"), Parameter::new("normal y", "-"), Parameter::new("normal z", "-")];

    fn dofs(&self) -> usize {
        2 * NodeKind::Slope.dofs()
    }
    fn unit(&self) -> &'static str {
        "m"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let slope = Vector3::first_three(&s.q[3..]);
        let across = Vector3::first_three(p).cross(&slope);
        across.dot(&(Vector3::first_three(&s.q[6..]) - Vector3::first_three(s.q))) / slope.length()
    }
}

impl Entry for CableDeflection {
    type Law = Self;
    const NAME: &'static str = "cable_deflection";
    const DOC: &'static str = "deflection of b, a cable's node, from the tangent at a [m]";
    const KEYS: &'static [Key] = &[BETWEEN, NORMAL];
    const EXAMPLE: Example = (&[NodeKind::Slope, NodeKind::Slope], &[ACROSS]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        given.all_are(NodeKind::Slope, "a cable");
        (CableDeflection, given.unit("normal").components().to_vec())
    }
}
