use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A mass at a point node: R = m a \[N\], T = m v . v / 2.
///
/// * `mass`  m \[kg\], greater than 0
#[derive(Hash)]
pub struct PointMass;

impl Element for PointMass {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg").as_size()];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point]
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        let velocity = Vector3::first_three(v);
        velocity.dot(&velocity) * p[0] * 0.5
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }
}
