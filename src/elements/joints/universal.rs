use super::{components, points, vectors};
use crate::elements::entries::{AT, BETWEEN, Entry, Example, ExampleValue, Given, Key, POINT, TWO_BODIES, Type, need};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A universal (Cardan, Hooke) joint: points held together \[m\] and the two pins of the cross at right angles [-].
///
/// g = (x_b - x_a, n_a . n_b)
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `pin a`  n_a, unit vector in the frame of a
/// * `pin b`  n_b, unit vector in the frame of b
#[derive(Hash)]
pub struct UniversalJoint(pub NodePair);

impl Constraint for UniversalJoint {
    const EQUATIONS: usize = 4;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["pin a", "pin b"])).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [a, b] = Frame::pair(self.0, q);
        g[..3].copy_from_slice(&(b.point(&p[3..]) - a.point(p)).components());
        components(&a, &p[6..9], b.direction(&p[9..]), &mut g[3..]);
    }
}

impl Entry for UniversalJoint {
    type Law = Self;
    const NAME: &'static str = "universal";
    const DOC: &'static str = "a cross with one pin in a and one in b";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        POINT,
        need("pin_a", Type::Vector("-"), "pin in a, at right angles to the other"),
        need("pin_b", Type::Vector("-"), "pin in b"),
    ];
    const EXAMPLE: Example = (
        TWO_BODIES,
        &[AT, ("pin_a", ExampleValue::Direction([0.6, 0.0, 0.8])), ("pin_b", ExampleValue::Direction([0.8, 0.0, -0.6]))],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let point = given.point("point", 1);
        let [pin_a, pin_b] = ["pin_a", "pin_b"].map(|pin| given.unit(pin));
        if let Some(angle) = Given::angle_if_not_right(pin_a, pin_b) {
            given.wrong(format!(
                "the pins of universal joint \"{}\" are at {angle:.6} degrees; \
                 they must be at 90: take from one of them its part along the other",
                given.owner()
            ));
        }
        let pins = [given.local_directions(0, [pin_a]), given.local_directions(1, [pin_b])].concat();
        (UniversalJoint(nodes), [given.local_points([0, 1], [point; 2]), pins].concat())
    }
}
