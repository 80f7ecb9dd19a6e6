use crate::elements::{NodeKind, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Squared distance of a point from a target: |x - x*|^2 \[m2\].
///
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point node
/// * `target x, y, z`  x*, in the world \[m\]
pub struct TargetDistance {
    /// What the point belongs to.
    pub of: NodeKind,
}

impl Quantity for TargetDistance {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("point x", "m"),
        Parameter::new("point y", "m"),
        Parameter::new("point z", "m"),
        Parameter::new("target x", "m"),
        Parameter::new("target y", "m"),
        Parameter::new("target z", "m"),
    ];

    fn dofs(&self) -> usize {
        self.of.dofs()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let miss = self.of.position(s.q, Vector3::first_three(p)) - Vector3::first_three(&p[3..]);
        miss.dot(&miss)
    }
}
