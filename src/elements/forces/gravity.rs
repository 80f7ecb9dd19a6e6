use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Weight of a body or point mass: V = -m g . x_c \[J\].
///
/// * `mass`  m \[kg\], 0 or greater
/// * `gravity x, y, z`  g [m/s2]
/// * `centre x, y, z`  mass centre in the body frame \[m\]; ignored for a point
#[derive(Hash)]
pub struct Gravity {
    /// What the weight hangs on.
    pub on: NodeKind,
}

impl Element for Gravity {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.on]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let (mass, gravity) = (Parameter::non_negative("mass", "kg").as_size(), Parameter::vectors(&["gravity"], "m/s2"));
        [mass].into_iter().chain(gravity).chain(Parameter::vectors(&["centre"], "m")).collect()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let position = self.on.position(q, Vector3::first_three(&p[4..]));
        -(position.dot(&Vector3::first_three(&p[1..])) * p[0])
    }
}
