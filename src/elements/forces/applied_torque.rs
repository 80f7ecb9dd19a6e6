use super::LoadFrame;
use crate::elements::{Element, Parameter, TimeFunction};
use crate::scalar::{Quaternion, Scalar, Vec3};

/// A torque M = d f(t) [N m] on a rigid body.
///
/// * `axis x, y, z`  d, in the world or, for a follower torque, in the body frame [-]
/// * parameters of f(t) [N m]
pub struct AppliedTorque {
    /// Fixed in the world or turning with the body.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

impl Element for AppliedTorque {
    const DOFS: usize = 7;
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("axis x", "-"), Parameter::new("axis y", "-"), Parameter::new("axis z", "-")];
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.iter().cloned().chain(self.size.parameters("N m")).collect()
    }
    fn add_force<S: Scalar>(&self, _v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let e = Quaternion::from_slice(&q[3..]);
        let mut moment = Vec3::from_slice(p) * self.size.value(t, &p[3..]);
        if self.frame == LoadFrame::World {
            moment = e.rotate_back(moment);
        }
        // omega = 2 G de/dt, so a body-frame moment acts on e as 2 G^T m
        for (f, m) in force[3..].iter_mut().zip(e.g_transposed_times(moment * S::from(2.0))) {
            *f += m;
        }
    }
    fn kinks(&self, p: &[f64]) -> Vec<f64> {
        self.size.kinks(&p[3..])
    }
}
