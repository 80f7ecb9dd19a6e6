use crate::elements::{Anchor, Element, Parameter, State};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A damper along the line between two points: tension c dl/dt [N], l = |x_b - x_a|.
///
/// * `damping`  c [N s/m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies [m]
pub struct LineDamper {
    /// First end.
    pub a: Anchor,
    /// Second end.
    pub b: Anchor,
}

/// Parameters shared by the dampers between two points.
pub(super) const DAMPER_PARAMETERS: &[Parameter] = &[
    Parameter::non_negative("damping", "N s/m"),
    Parameter::new("point a x", "m"),
    Parameter::new("point a y", "m"),
    Parameter::new("point a z", "m"),
    Parameter::new("point b x", "m"),
    Parameter::new("point b y", "m"),
    Parameter::new("point b z", "m"),
];

/// Adds the force pair c (D dx/dt) between two points, `direct` being the operator D on the relative velocity, given
/// the vector between the points.
#[inline(always)]
pub(super) fn add_damping<S: Scalar>(
    [a, b]: [Anchor; 2],
    v: &[S],
    q: &[S],
    p: &[S],
    force: &mut [S],
    direct: impl Fn(Vector3<S>, Vector3<S>) -> Vector3<S>,
) {
    let (point_a, point_b) = (Vector3::first_three(&p[1..]), Vector3::first_three(&p[4..]));
    let split = a.dofs();
    let ((qa, qb), (va, vb)) = (q.split_at(split), v.split_at(split));
    let between = b.position(qb, point_b) - a.position(qa, point_a);
    let velocity = b.velocity(vb, qb, point_b) - a.velocity(va, qa, point_a);
    let tension = direct(between, velocity) * p[0];
    let (force_a, force_b) = force.split_at_mut(split);
    a.add_force(qa, point_a, tension, force_a);
    b.add_force(qb, point_b, -tension, force_b);
}

/// The part of a velocity along a line.
#[inline(always)]
fn along<S: Scalar>(line: Vector3<S>, velocity: Vector3<S>) -> Vector3<S> {
    line * (line.dot(&velocity) / line.dot(&line))
}

impl Element for LineDamper {
    const DOFS: usize = 24;
    const PARAMETERS: &'static [Parameter] = DAMPER_PARAMETERS;
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        add_damping([self.a, self.b], v, q, p, force, along);
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        add_damping([self.a, self.b], s.v, s.q, p, r, |between, velocity| -along(between, velocity));
    }
}
