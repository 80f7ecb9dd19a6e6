use crate::elements::{Constraint, Parameter, TimeFunction};
use crate::scalar::{Quaternion, Scalar, Vec3, angle_about};

/// Drives the angle between two bodies about an axis of body a: theta - f(t) = 0 [rad].
///
/// g = atan2(sin(theta - f), cos(theta - f)), so any number of turns can be driven and a start half a turn off is seen. It only
/// drives; a revolute joint beside it holds the axis. The multiplier is minus the driving moment on b [N m].
///
/// * `axis`, `reference a`  unit vectors in the frame of a, at right angles
/// * `reference b`  unit vector in the frame of b
/// * parameters of f(t) [rad]
pub struct PrescribedRotation {
    /// Angle over time.
    pub angle: TimeFunction,
}

impl Constraint for PrescribedRotation {
    const DOFS: usize = 14;
    const EQUATIONS: usize = 1;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("axis x", "-"),
        Parameter::new("axis y", "-"),
        Parameter::new("axis z", "-"),
        Parameter::new("reference a x", "-"),
        Parameter::new("reference a y", "-"),
        Parameter::new("reference a z", "-"),
        Parameter::new("reference b x", "-"),
        Parameter::new("reference b y", "-"),
        Parameter::new("reference b z", "-"),
    ];

    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.iter().cloned().chain(self.angle.parameters("rad")).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        let axis = ea.rotate(Vec3::from_slice(p));
        let from = ea.rotate(Vec3::from_slice(&p[3..]));
        // the reference of a turned by f, so that only the small rest goes through the arctangent
        let (sine, cosine) = self.angle.value(t, &p[9..]).sin_cos();
        let target = from * cosine + axis.cross(from) * sine;
        g[0] = angle_about(axis, target, eb.rotate(Vec3::from_slice(&p[6..])));
    }
    fn kinks(&self, p: &[f64]) -> Vec<f64> {
        self.angle.kinks(&p[9..])
    }
}
