use super::{angle, angle_between};
use crate::elements::entries::{ALONG, AXIS, BETWEEN, DRIVE, Entry, Example, FUNCTION, Given, Key, TWO_BODIES, Type, need};
use crate::elements::{Constraint, NodeKind, NodePair, Parameter, TimeFunction};
use crate::scalar::Scalar;

/// Drives the angle between two bodies about an axis of body a: theta - f(t) = 0 \[rad\].
///
/// g lies in [-pi, pi], so any number of turns can be driven and a start half a turn off is seen. It only drives; a revolute joint
/// beside it holds the axis. The multiplier is minus the driving moment on b [N m].
///
/// * `axis`, `reference a`  unit vectors in the frame of a, at right angles
/// * `reference b`  unit vector in the frame of b
/// * parameters of f(t) \[rad\]
#[derive(Hash)]
pub struct PrescribedRotation {
    /// What guides, a body, and what is driven.
    pub nodes: NodePair,
    /// Angle over time.
    pub angle: TimeFunction,
}

impl Constraint for PrescribedRotation {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.nodes.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        angle().into_iter().chain(self.angle.parameters("rad")).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        g[0] = angle_between(self.nodes, q, p, self.angle.value(t, &p[9..]));
    }
    fn is_driver(&self) -> bool {
        true
    }
}

impl Entry for PrescribedRotation {
    type Law = Self;
    const NAME: &'static str = "rotation";
    const DOC: &'static str = "the angle of b against a about an axis, zero as they stand";
    const KEYS: &'static [Key] = &[BETWEEN, AXIS, need("angle", Type::Function("rad", &FUNCTION), "angle over time")];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG, ("angle", DRIVE)]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (angle, numbers) = given.function("angle");
        let nodes = given.bodies();
        let axis = given.unit("axis");
        (PrescribedRotation { nodes, angle }, [given.angle_frame(axis), numbers].concat())
    }
}
