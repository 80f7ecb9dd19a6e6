use crate::elements::{Element, Parameter};
use crate::scalar::{Quaternion, Scalar, Vec3, angle_about};

/// A torsion spring and damper about an axis between two bodies: M = k (theta - theta0) + c dtheta/dt [N m].
///
/// theta is the angle in (-pi, pi] from the reference direction of body a to that of body b about the axis, which is fixed in
/// body a; dtheta/dt is the relative angular velocity along it. Keep |theta| below pi: turns are not counted.
///
/// * `stiffness`  k [N m/rad], 0 or greater
/// * `damping`  c [N m s/rad], 0 or greater
/// * `rest angle`  theta0 [rad]
/// * `axis`, `reference a`  unit vectors in the frame of body a, at right angles
/// * `reference b`  unit vector in the frame of body b
pub struct TorsionSpringDamper;

impl TorsionSpringDamper {
    fn angle<S: Scalar>(q: &[S], p: &[S]) -> S {
        let (ea, eb) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&q[10..]));
        let vector = |i: usize| Vec3::from_slice(&p[i..]);
        angle_about(ea.rotate(vector(3)), ea.rotate(vector(6)), eb.rotate(vector(9)))
    }
}

impl Element for TorsionSpringDamper {
    const DOFS: usize = 14;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness", "N m/rad"),
        Parameter::non_negative("damping", "N m s/rad"),
        Parameter::new("rest angle", "rad"),
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
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let twist = Self::angle(q, p) - p[2];
        twist * twist * p[0] * 0.5
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        let [(ea, wa), (eb, wb)] = [3, 10].map(|i| {
            let e = Quaternion::from_slice(&q[i..]);
            (e, e.g_times(Quaternion::from_slice(&v[i..])) * S::from(2.0))
        });
        let axis = ea.rotate(Vec3::from_slice(&p[3..]));
        let rate = axis.dot(eb.rotate(wb) - ea.rotate(wa));
        let moment = axis * (rate * p[1] * 2.0);
        let (on_a, on_b) = (ea.g_transposed_times(ea.rotate_back(moment)), eb.g_transposed_times(eb.rotate_back(moment)));
        for i in 0..4 {
            force[3 + i] += on_a[i];
            force[10 + i] -= on_b[i];
        }
    }
}
