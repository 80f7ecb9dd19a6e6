use super::Soft;
use super::soft::as_soft_joint;
use crate::elements::entries::{
    ALONG, AXIS, BETWEEN, DAMPED, Entry, Example, ExampleValue, Given, Key, POINT, REST_ANGLE, Range, STIFF, TWO_BODIES,
    Type, may, need,
};
use crate::elements::joints::{components, gap, points, vectors};
use crate::elements::{Constraint, Element, Frame, NodeKind, NodePair, Output, Parameter};
use crate::scalar::Scalar;

/// A spring and damper along an axis of body a: F = k (s - s0) + c ds/dt \[N\], s = n_a . (x_b - x_a).
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `damping`  c [N s/m], 0 or greater
/// * `rest displacement`  s0 \[m\]
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `axis`  n_a, unit vector in the frame of a
#[derive(Hash)]
pub struct SlideSpringDamper(pub NodePair);

/// s - s0 with the parameters (s0, points, axis).
#[derive(Hash)]
struct Slide(NodePair);

impl Constraint for Slide {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        [Parameter::new("rest displacement", "m")].into_iter().chain(points()).chain(vectors(&["axis"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        components(&Frame::of(self.0[0], q), &p[7..], gap(self.0, q, &p[1..]), g);
        g[0] -= p[0];
    }
}

impl SlideSpringDamper {
    fn soft(&self) -> Soft<Slide> {
        Soft(Slide(self.0))
    }
}

impl Element for SlideSpringDamper {
    as_soft_joint!();

    fn outputs(&self) -> Vec<Output> {
        Output::of_strain([("displacement from rest", "m"), ("rate", "m/s"), ("force", "N")])
    }

    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::non_negative("stiffness", "N/m").as_size(), Parameter::non_negative("damping", "N s/m")];
        own.into_iter().chain(self.soft().0.parameters()).collect()
    }
}

impl Entry for SlideSpringDamper {
    type Law = Self;
    const NAME: &'static str = "slide";
    const DOC: &'static str = "along an axis of a, with a damper";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        may("origin", Type::Vector("m"), "where the displacement is zero; the place of a"),
        POINT,
        AXIS,
        need("stiffness", Type::Number("N/m", Range::AtLeastZero), "stiffness"),
        may("damping", Type::Number("N s/m", Range::AtLeastZero), "damping; 0"),
        may("rest_displacement", Type::Number("m", Range::Any), "displacement without force; 0"),
    ];
    const EXAMPLE: Example = (
        TWO_BODIES,
        &[
            ("origin", ExampleValue::Point([0.1, 0.2, -0.3])),
            ("point", ExampleValue::Point([0.8, -0.4, 0.5])),
            ALONG,
            STIFF,
            DAMPED,
            ("rest_displacement", REST_ANGLE.1),
        ],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.body_and_guided();
        let places = [given.point("origin", 0), given.point("point", 1)];
        let axis = given.unit("axis");
        let own = [given.spring_damper("rest_displacement"), given.local_points([0, 1], places)].concat();
        (SlideSpringDamper(nodes), [own, given.local_directions(0, [axis])].concat())
    }
}
