use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Deflection of a cable's node b seen from its node a, across the tangent there: (n x t) . (r_b - r_a) \[m\] with t = r_x / |r_x| at a.
///
/// * `normal x, y, z`  n, unit vector in the world: of the plane in which the cable bends
///
/// Source: Ebrahimi et al., section 6.1.
pub struct CableDeflection;

impl Quantity for CableDeflection {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("normal x", "-"), Parameter::new("normal y", "-"), Parameter::new("normal z", "-")];

    fn dofs(&self) -> usize {
        2 * NodeKind::Slope.dofs()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let slope = Vector3::first_three(&s.q[3..]);
        let across = Vector3::first_three(p).cross(&slope);
        across.dot(&(Vector3::first_three(&s.q[6..]) - Vector3::first_three(s.q))) / slope.length()
    }
}
