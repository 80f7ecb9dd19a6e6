use crate::elements::{Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Quaternion, Scalar, Vec3};

/// Angular velocity of body b against body a along an axis of a: n_a . (omega_b - omega_a) [rad/s].
///
/// * `axis`  n_a, unit vector in the frame of a
pub struct JointRate;

impl Quantity for JointRate {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("axis x", "-"), Parameter::new("axis y", "-"), Parameter::new("axis z", "-")];

    fn dofs(&self) -> usize {
        14
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let [ea, eb] = [3, 10].map(|i| Quaternion::from_slice(&s.q[i..]));
        let [wa, wb] = [(ea, 3), (eb, 10)].map(|(e, i)| e.rotate(e.g_times(Quaternion::from_slice(&s.v[i..]))));
        ea.rotate(Vec3::from_slice(p)).dot(wb - wa) * 2.0
    }
}
