use super::POINT_AND_DIRECTION;
use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Position of a point along a direction: d . x \[m\].
///
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point node
/// * `direction x, y, z`  d, in the world [-]
pub struct Position {
    /// What the point belongs to.
    pub of: NodeKind,
}

impl Quantity for Position {
    const PARAMETERS: &'static [Parameter] = &POINT_AND_DIRECTION;

    fn dofs(&self) -> usize {
        self.of.dofs()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        self.of.position(s.q, Vector3::first_three(p)).dot(&Vector3::first_three(&p[3..]))
    }
}
