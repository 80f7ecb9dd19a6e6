use super::load_frame::{FRAME, LoadFrame, SIZE, size};
use crate::elements::entries::{AT, Entry, Example, Given, HEADING, Key, ONE_BODY, PLACE, Type, need};
use crate::elements::{Element, Frame, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A force F = d f(t) \[N\] at a point of a body or at a point mass.
///
/// * `direction x, y, z`  d, in the world or, for a follower force, in the body frame [-]
/// * `point x, y, z`  in the body frame \[m\]; ignored for a point
/// * parameters of f(t) \[N\]
#[derive(Hash)]
pub struct AppliedForce {
    /// What the force acts on.
    pub on: NodeKind,
    /// Dead or follower load; a point has no frame to follow.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

impl Element for AppliedForce {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.on]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let geometry = [Parameter::vectors(&["direction"], "-"), Parameter::vectors(&["point"], "m")].concat();
        [geometry, self.size.parameters("N")].concat()
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, _v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let mut direction = Vector3::first_three(p);
        if self.frame == LoadFrame::Body && self.on.has_axes() {
            direction = Frame::of(self.on, q).direction(p);
        }
        self.on.add_force(q, Vector3::first_three(&p[3..]), direction * self.size.value(t, &p[6..]), force);
    }
}

impl Entry for AppliedForce {
    type Law = Self;
    const NAME: &'static str = "force";
    const DOC: &'static str = "A force at a point of a node: direction times size.";
    const KEYS: &'static [Key] = &[
        need("on", Type::NodeSet, "node; of an edge, an end or a node set of a mesh each node takes an equal share"),
        PLACE,
        FRAME,
        need("direction", Type::Vector("-"), "direction in the world at the start; its length counts"),
        size("N"),
    ];
    const EXAMPLE: Example = (ONE_BODY, &[AT, HEADING, SIZE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (on, frame) = (given.in_space(0), LoadFrame::given(given, LoadFrame::World));
        let (direction, point) = (frame.kept(given, "direction"), given.point("point", 0));
        let (size, values) = given.function("size");
        let point = given.node(0).local_point(point).components();
        (AppliedForce { on, frame, size }, [&direction[..], &point, &values].concat())
    }
}
