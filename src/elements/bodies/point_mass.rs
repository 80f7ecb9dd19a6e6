use crate::elements::{Element, Parameter, State};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A mass at a point node: R = m a [N], T = m v . v / 2.
///
/// * `mass`  m [kg], greater than 0
pub struct PointMass;

impl Element for PointMass {
    const DOFS: usize = 3;
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg")];
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn is_linear(&self) -> bool {
        true
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        let velocity = Vector3::first_three(v);
        velocity.dot(&velocity) * p[0] * 0.5
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        for (r, &a) in r.iter_mut().zip(s.a) {
            *r += p[0] * a;
        }
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }
}
