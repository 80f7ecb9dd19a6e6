use crate::elements::{Anchor, Element, Frame, Parameter};
use crate::scalar::{Scalar, angle_about};

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
pub struct TorsionSpringDamper {
    /// First body.
    pub a: Anchor,
    /// Second body.
    pub b: Anchor,
}

impl TorsionSpringDamper {
    #[inline(always)]
    fn angle<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let [a, b] = Frame::pair([self.a, self.b], q);
        angle_about(a.direction(&p[3..]), a.direction(&p[6..]), b.direction(&p[9..]))
    }
}

impl Element for TorsionSpringDamper {
    const DOFS: usize = 24;
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

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let twist = self.angle(q, p) - p[2];
        twist * twist * p[0] * 0.5
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        let split = self.a.dofs();
        let ((qa, qb), (va, vb)) = (q.split_at(split), v.split_at(split));
        let axis = Frame::of(self.a, qa).direction(&p[3..]);
        let rate = axis.dot(&(self.b.angular_velocity(vb, qb) - self.a.angular_velocity(va, qa)));
        let moment = axis * (rate * p[1]);
        let (force_a, force_b) = force.split_at_mut(split);
        self.a.add_moment(qa, moment, force_a);
        self.b.add_moment(qb, -moment, force_b);
    }
}
