use super::{PointInPlane, vectors};
use crate::elements::entries::Range::Positive;
use crate::elements::entries::Type::{Number, Vector};
use crate::elements::entries::{AXIS, BETWEEN, Forms, Given, NORMAL, WithParameters, forms, may, need};
use crate::elements::{
    AnyConstraint, Constraint, Frame, Friction, NodeKind, NodePair, Nonholonomic, NonholonomicConstraint, Parameter, State,
};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Velocity of the material point of a body that is at the world point `place` now [m/s]: v + omega x (place - r).
#[inline(always)]
pub(in crate::elements) fn velocity_at<S: Scalar>(body: NodeKind, v: &[S], q: &[S], place: Vector3<S>) -> Vector3<S> {
    Vector3::first_three(v) + body.angular_velocity(v, q).cross(&(place - Vector3::first_three(q)))
}

/// The sliding velocity of b on a plane of a at their point of contact, along two directions u and w of the plane.
#[inline(always)]
fn sliding<S: Scalar>([a, b]: [NodeKind; 2], v: &[S], q: &[S], [u, w]: [&[S]; 2], contact: Vector3<S>, h: &mut [S]) {
    let split = a.dofs();
    let velocity = velocity_at(b, &v[split..], &q[split..], contact) - velocity_at(a, v, q, contact);
    let frame = Frame::of(a, q);
    (h[0], h[1]) = (frame.direction(u).dot(&velocity), frame.direction(w).dot(&velocity));
}

/// A sphere b rolls without sliding on a plane of a: h = (u . dv, w . dv) [m/s] with the relative velocity dv of the two bodies at
/// the point of contact x_c - r n.
///
/// It keeps nothing but the rolling: a [`PointInPlane`](super::PointInPlane) beside it keeps the centre at the distance r.
///
/// * `centre`  of the sphere, in the frame of b \[m\]
/// * `u`, `w`, `normal`  unit vectors in the frame of a, at right angles
/// * `radius`  r \[m\], greater than 0
///
/// Source: Bloch (2015), Nonholonomic Mechanics and Control, section 1.
#[derive(Hash)]
pub struct RollingSphere(pub NodePair);

impl NonholonomicConstraint for RollingSphere {
    const EQUATIONS: usize = 2;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let (centre, vectors) = (Parameter::vectors(&["centre"], "m"), vectors(&["u", "w", "normal"]));
        [centre, vectors, vec![Parameter::positive("radius", "m")]].concat()
    }
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, h: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        let contact = b.point(p) - a.direction(&p[9..]) * p[12];
        sliding(self.0, v, q, [&p[3..], &p[6..]], contact, h);
    }
}

/// Place of the radius among the parameters of [`RollingSphere`].
const RADIUS: usize = 12;

/// Coulomb friction of a sphere on a plane, or of a point, a sphere of radius 0: s is the slip of [`RollingSphere`], the load the force of the contact.
///
/// * `centre` .. `radius`  of [`RollingSphere`], the radius at least 0
/// * `sliding`, `static`  coefficients mu [-]
#[derive(Hash)]
pub struct SphereFriction(pub NodePair);

impl Friction for SphereFriction {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let mut all = RollingSphere(self.0).parameters();
        // that of a point is zero
        all[RADIUS] = Parameter::new("radius", "m");
        all.into_iter().chain(["sliding", "static"].map(|name| Parameter::new(name, "-"))).collect()
    }
    fn directions(&self) -> usize {
        2
    }
    fn slip<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, s: &mut [S]) {
        RollingSphere(self.0).h(v, q, p, t, s);
    }
    fn load<S: Scalar>(&self, mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
        // the multiplier pushes where it is below zero
        -mu[0]
    }
    fn limits<S: Scalar>(&self, load: S, _state: State<S>, p: &[S], _t: S) -> [S; 2] {
        [p[RADIUS + 1] * load, p[RADIUS + 2] * load]
    }
}

/// Coulomb friction of two spheres: s = (u' . dv, w' . dv) [m/s] with the relative velocity dv of their surfaces where the line between the centres,
/// of direction n, meets these. u' and w' are u and w turned as n_0 into n on the shortest way, u' = u - (u . n) / (1 + n_0 . n) (n_0 + n).
///
/// * `centre a`, `centre b`  in the frames of the bodies \[m\]
/// * `u`, `w`, `normal`  unit vectors in the world, at right angles: n_0 is the direction from a to b at the start; it is never reversed
/// * `radius a`, `radius b`  at least 0 \[m\]
/// * `sliding`, `static`  coefficients mu [-]
#[derive(Hash)]
pub struct SpheresFriction(pub NodePair);

impl Friction for SpheresFriction {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let radii = ["radius a", "radius b"].map(|name| Parameter::new(name, "m"));
        let numbers = ["sliding", "static"].map(|name| Parameter::new(name, "-"));
        [Parameter::vectors(&["centre a", "centre b"], "m"), vectors(&["u", "w", "normal"]), [radii, numbers].concat()]
            .concat()
    }
    fn directions(&self) -> usize {
        2
    }
    fn slip<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, s: &mut [S]) {
        let ([a, b], split) = (Frame::pair(self.0, q), self.0[0].dofs());
        let centres = [a.point(p), b.point(&p[3..])];
        let between = centres[1] - centres[0];
        let n = between * (S::one() / between.length());
        let surfaces = [centres[0] + n * p[15], centres[1] - n * p[16]];
        let velocity =
            velocity_at(self.0[1], &v[split..], &q[split..], surfaces[1]) - velocity_at(self.0[0], v, q, surfaces[0]);
        let [u, w, normal] = [6, 9, 12].map(|place| Vector3::first_three(&p[place..]));
        let turn = |own: Vector3<S>| own - (normal + n) * (own.dot(&n) / (S::one() + normal.dot(&n)));
        (s[0], s[1]) = (turn(u).dot(&velocity), turn(w).dot(&velocity));
    }
    fn load<S: Scalar>(&self, mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
        -mu[0]
    }
    fn limits<S: Scalar>(&self, load: S, _state: State<S>, p: &[S], _t: S) -> [S; 2] {
        [p[17] * load, p[18] * load]
    }
}

/// Centre, axis, normal and radius of a disc.
fn disc_parameters() -> Vec<Parameter> {
    let (centre, vectors) = (Parameter::vectors(&["centre"], "m"), vectors(&["axis", "normal"]));
    [centre, vectors, vec![Parameter::positive("radius", "m")]].concat()
}

/// Centre of the disc, and the vector from it to the lowest point of its edge: -r (n - (n . b) b) / |n - (n . b) b|.
#[inline(always)]
fn disc<S: Scalar>([a, b]: [Frame<S>; 2], p: &[S]) -> (Vector3<S>, Vector3<S>) {
    let (axis, normal) = (b.direction(&p[3..]), a.direction(&p[6..]));
    let up = normal - axis * normal.dot(&axis);
    (b.point(p), up * (-p[9] / up.length()))
}

/// The edge of a thin disc b touches a plane of a: g = n . (x_c + c - x_a) \[m\] with the vector c from the centre to the lowest point.
///
/// * `centre`  of the disc, in the frame of b \[m\]
/// * `axis`  of the disc, unit vector in the frame of b
/// * `normal`  n, unit vector in the frame of a
/// * `radius`  r \[m\], greater than 0
/// * `point`  x_a, of the plane, in the frame of a \[m\]
#[derive(Hash)]
pub struct DiscOnPlane(pub NodePair);

impl Constraint for DiscOnPlane {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        [disc_parameters(), Parameter::vectors(&["point"], "m")].concat()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        let (centre, lowest) = disc([a, b], p);
        g[0] = a.direction(&p[6..]).dot(&(centre + lowest - a.point(&p[10..])));
    }
}

/// The edge of a thin disc b rolls without sliding on a plane of a: h = (u . dv, w . dv) [m/s] with the relative velocity dv of the two
/// bodies at the lowest point of the disc.
///
/// It keeps nothing but the rolling: a [`DiscOnPlane`] beside it keeps the contact.
///
/// * `centre`, `axis`, `normal`, `radius`  as for [`DiscOnPlane`]
/// * `u`, `w`  unit vectors of the plane in the frame of a, at right angles
///
/// Source: Bloch (2015), Nonholonomic Mechanics and Control, section 1.
#[derive(Hash)]
pub struct RollingDisc(pub NodePair);

impl NonholonomicConstraint for RollingDisc {
    const EQUATIONS: usize = 2;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        [disc_parameters(), vectors(&["u", "w"])].concat()
    }
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, h: &mut [S]) {
        let (centre, lowest) = disc(Frame::pair(self.0, q), p);
        sliding(self.0, v, q, [&p[10..], &p[13..]], centre + lowest, h);
    }
}

/// What rolls, by the names that scene files use: each is two constraints.
pub(crate) const ROLLING: Forms = forms!([]
"rolling_sphere" "b, a sphere, rolls on a plane of a" [
    BETWEEN,
    may("centre", Vector("m"), "centre of the sphere; the place of b"),
    NORMAL,
    need("radius", Number("m", Positive), "radius"),
]
"rolling_disc" "b, a thin disc, rolls on a plane of a" [
    BETWEEN,
    may("centre", Vector("m"), "centre of the disc; the place of b"),
    AXIS,
    may("point", Vector("m"), "point of the plane; the place of a"),
    NORMAL,
    need("radius", Number("m", Positive), "radius"),
]);

/// The contact and the rolling of a form of [`ROLLING`].
pub(crate) fn contact_and_rolling<S: Scalar>(form: &str, given: &mut Given<S>) -> [WithParameters<dyn AnyConstraint, S>; 2] {
    let nodes = given.bodies();
    let (centre, normal) = (given.point("centre", 1), given.unit("normal"));
    let of_centre = given.node(1).local_point(centre).components().to_vec();
    let ([u, w], radius) = (normal.perpendiculars(), vec![given.number("radius")]);
    if form == "rolling_sphere" {
        let plane = [given.local_points([0, 1], [centre; 2]), given.local_directions(0, [normal.unit()])].concat();
        let rolling = [of_centre, given.local_directions(0, [u, w, normal]), radius].concat();
        return [(PointInPlane(nodes).into(), plane), (Nonholonomic(RollingSphere(nodes)).into(), rolling)];
    }
    let (axis, point) = (given.unit("axis"), given.point("point", 0));
    let disc = [of_centre, given.local_directions(1, [axis]), given.local_directions(0, [normal]), radius].concat();
    let plane = [&disc[..], &given.node(0).local_point(point).components()].concat();
    let rolling = [disc, given.local_directions(0, [u, w])].concat();
    [(DiscOnPlane(nodes).into(), plane), (Nonholonomic(RollingDisc(nodes)).into(), rolling)]
}
