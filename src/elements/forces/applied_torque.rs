use super::load_frame::{FRAME, LoadFrame, SIZE, size};
use crate::elements::entries::{ALONG, Entry, Example, Given, Key, ON, ONE_BODY, Type, need};
use crate::elements::{Element, Frame, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A torque M = d f(t) [N m] on a rigid body.
///
/// * `axis x, y, z`  d, in the world or, for a follower torque, in the body frame [-]
/// * parameters of f(t) [N m]
#[derive(Hash)]
pub struct AppliedTorque {
    /// The body.
    pub on: NodeKind,
    /// Fixed in the world or turning with the body.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

impl Element for AppliedTorque {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.on]
    }
    fn parameters(&self) -> Vec<Parameter> {
        [Parameter::vectors(&["axis"], "-"), self.size.parameters("N m")].concat()
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, _v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let axis = match self.frame {
            LoadFrame::World => Vector3::first_three(p),
            LoadFrame::Body => Frame::of(self.on, q).direction(p),
        };
        self.on.add_moment(q, axis * self.size.value(t, &p[3..]), force);
    }
}

impl Entry for AppliedTorque {
    type Law = Self;
    const NAME: &'static str = "torque";
    const DOC: &'static str = "A torque on a body: axis times size.";
    const KEYS: &'static [Key] =
        &[ON, FRAME, need("axis", Type::Vector("-"), "axis in the world at the start; its length counts"), size("N m")];
    const EXAMPLE: Example = (ONE_BODY, &[ALONG, SIZE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (on, frame) = (given.body(0), LoadFrame::given(given, LoadFrame::World));
        let (axis, (size, values)) = (frame.kept(given, "axis"), given.function("size"));
        (AppliedTorque { on, frame, size }, [axis, values].concat())
    }
}
