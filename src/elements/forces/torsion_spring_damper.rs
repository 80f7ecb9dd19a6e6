use super::spring_law::ANGLE;
use crate::elements::entries::{
    ALONG, AXIS, BETWEEN, DAMPED, Entry, Example, Given, Key, REST_ANGLE, Range, STIFF, TWO_BODIES, Type, may, need,
};
use crate::elements::joints::angle;
use crate::elements::{Element, Frame, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Scalar, angle_about};

/// A torsion spring and damper about an axis between two bodies: M = k (theta - theta0) + c dtheta/dt [N m].
///
/// theta is the angle in (-pi, pi] from the reference direction of body a to that of body b about the axis, which is fixed in
/// body a. Keep |theta| below pi: turns are not counted.
///
/// * `stiffness`  k [N m/rad], 0 or greater
/// * `damping`  c [N m s/rad], 0 or greater
/// * `rest angle`  theta0 \[rad\]
/// * `axis`, `reference a`  unit vectors in the frame of body a, at right angles
/// * `reference b`  unit vector in the frame of body b
#[derive(Hash)]
pub struct TorsionSpringDamper(pub NodePair);

impl Element for TorsionSpringDamper {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let stiffness = Parameter::non_negative("stiffness", "N m/rad").as_size();
        let own = [stiffness, Parameter::non_negative("damping", "N m s/rad"), Parameter::new("rest angle", "rad")];
        own.into_iter().chain(angle()).collect()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        e[0] = angle_about(a.direction(&p[3..]), a.direction(&p[6..]), b.direction(&p[9..]));
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain(ANGLE)
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let twist = e[0] - p[2];
        twist * twist * p[0] * 0.5
    }
    fn damping<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        s[0] = p[1] * rate[0];
    }
}

impl Entry for TorsionSpringDamper {
    type Law = Self;
    const NAME: &'static str = "torsion";
    const DOC: &'static str = "about an axis, with a damper";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        AXIS,
        need("stiffness", Type::Number("N m/rad", Range::AtLeastZero), "stiffness"),
        may("damping", Type::Number("N m s/rad", Range::AtLeastZero), "damping; 0"),
        may("rest_angle", Type::Number("rad", Range::Any), "angle without moment, zero as they stand; 0"),
    ];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG, STIFF, DAMPED, REST_ANGLE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let axis = given.unit("axis");
        (TorsionSpringDamper(nodes), [given.spring_damper("rest_angle"), given.angle_frame(axis)].concat())
    }
}
