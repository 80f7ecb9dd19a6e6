use super::{gap, points, vectors};
use crate::elements::entries::{
    ALONG, AT, AXIS, BETWEEN, DRIVE, Entry, Example, FUNCTION, Given, Key, POINT, TWO_BODIES, Type, may, need,
};
use crate::elements::{Constraint, Frame, NodeKind, NodePair, Parameter, TimeFunction};
use crate::scalar::Scalar;

/// Drives a point of b along an axis of body a: n_a . (x_b - x_a) - f(t) = 0 \[m\].
///
/// The multiplier is minus the driving force on b along the axis \[N\].
///
/// * `point a`, `point b`  in the frames of the bodies \[m\]
/// * `axis`  n_a, unit vector in the frame of a
/// * parameters of f(t) \[m\]
#[derive(Hash)]
pub struct PrescribedTranslation {
    /// What guides, a body, and what is driven.
    pub nodes: NodePair,
    /// Displacement over time.
    pub displacement: TimeFunction,
}

impl Constraint for PrescribedTranslation {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.nodes.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        points().into_iter().chain(vectors(&["axis"])).chain(self.displacement.parameters("m")).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        let axis = Frame::of(self.nodes[0], q).direction(&p[6..]);
        g[0] = axis.dot(&gap(self.nodes, q, p)) - self.displacement.value(t, &p[9..]);
    }
    fn is_driver(&self) -> bool {
        true
    }
}

impl Entry for PrescribedTranslation {
    type Law = Self;
    const NAME: &'static str = "translation";
    const DOC: &'static str = "a point of b along an axis of a";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        AXIS,
        may("origin", Type::Vector("m"), "where the displacement is zero; the place of a"),
        POINT,
        need("displacement", Type::Function("m", &FUNCTION), "displacement over time"),
    ];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG, ("origin", AT.1), AT, ("displacement", DRIVE)]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (displacement, numbers) = given.function("displacement");
        let nodes = given.body_and_guided();
        let places = [given.point("origin", 0), given.point("point", 1)];
        let axis = given.unit("axis");
        let axis = given.local_directions(0, [axis]);
        (PrescribedTranslation { nodes, displacement }, [given.local_points([0, 1], places), axis, numbers].concat())
    }
}
