use super::{components, vectors};
use crate::elements::entries::{AXIS, BETWEEN, Entry, Example, ExampleValue, Given, Key, Type, may};
use crate::elements::{Constraint, Frame, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// What a body holds of the slope r_x of a cable's node, beside its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HeldSlope {
    /// The direction: u_a . r_x = 0, w_a . r_x = 0. The stretch |r_x| stays free, so that the strain at the end is what the load makes it.
    Direction,
    /// The whole vector: R_a^T r_x = s. It keeps the stretch at the end, too, which adds a layer of stress where the end is loaded along
    /// the cable.
    Vector,
    /// A plane: n_a . r_x = 0. The end turns about the normal as on a hinge, and tilts no other way.
    Plane,
}

/// The end b of a cable held by a body a: the place \[m\], and the slope [-].
///
/// g = (r_b - x_a, (u_a . r_x, w_a . r_x) or R_a^T r_x - s or n_a . r_x). A cable has no torsion, so none of them holds it.
///
/// * `point a`  in the frame of the body \[m\]
/// * `normal u`, `normal w`  unit vectors in the frame of a at right angles to the slope, or `slope` s in that frame, or the `normal` n
///
/// Source: Ebrahimi et al., eqs. (41), (42).
#[derive(Hash)]
pub struct CableEnd {
    /// The body.
    pub a: NodeKind,
    /// What it holds of the slope.
    pub held: HeldSlope,
}

impl Constraint for CableEnd {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, NodeKind::Slope]
    }
    fn equations(&self) -> usize {
        match self.held {
            HeldSlope::Direction => 5,
            HeldSlope::Vector => 6,
            HeldSlope::Plane => 4,
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let held = match self.held {
            HeldSlope::Direction => vectors(&["normal u", "normal w"]),
            HeldSlope::Vector => vectors(&["slope"]),
            HeldSlope::Plane => vectors(&["normal"]),
        };
        [Parameter::vectors(&["point a"], "m"), held].concat()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let (frame, end) = (Frame::of(self.a, q), &q[self.a.dofs()..]);
        g[..3].copy_from_slice(&(Vector3::first_three(end) - frame.point(p)).components());
        let slope = Vector3::first_three(&end[3..]);
        if self.held == HeldSlope::Vector {
            g[3..].copy_from_slice(&(frame.seen(slope) - Vector3::first_three(&p[3..])).components());
        } else {
            components(&frame, &p[3..], slope, &mut g[3..]);
        }
    }
}

/// The body that holds, and the slope of the cable at the start.
fn ends<S: Scalar>(given: &mut Given<S>) -> (NodeKind, Vector3<S>) {
    let a = given.body(0);
    if given.node(1).kind == NodeKind::Slope {
        return (a, given.node(1).slope());
    }
    given.wrong(format!(
        "\"{}\" needs a cable's node as the second, but \"{}\" is none: name the body first, then the node",
        given.owner(),
        given.name(1)
    ));
    (a, Vector3::from_f64([1.0, 0.0, 0.0]))
}

/// A cable's node in the frame of the body, and directions there.
fn held<S: Scalar, const N: usize>(given: &Given<S>, directions: [Vector3<S>; N]) -> Vec<S> {
    let place = given.node(0).local_point(given.node(1).position()).components();
    [&place[..], &given.local_directions(0, directions)].concat()
}

/// A cable welded to a body.
pub struct CableWeld;

impl Entry for CableWeld {
    type Law = CableEnd;
    const NAME: &'static str = "cable_weld";
    const DOC: &'static str = "b, a cable's node, welded to body a";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        may("holds", Type::Choice(&["direction", "vector"]), "the direction of its slope, or its stretch, too; direction"),
    ];
    const EXAMPLE: Example = (&[NodeKind::Body, NodeKind::Slope], &[]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (CableEnd, Vec<S>) {
        let (a, slope) = ends(given);
        match given.says("holds", "vector") {
            true => (CableEnd { a, held: HeldSlope::Vector }, held(given, [slope])),
            false => (CableEnd { a, held: HeldSlope::Direction }, held(given, slope.unit().perpendiculars())),
        }
    }
}

/// A cable on a hinge of a body.
pub struct CableHinge;

impl Entry for CableHinge {
    type Law = CableEnd;
    const NAME: &'static str = "cable_hinge";
    const DOC: &'static str = "b, a cable's node, on a hinge of body a";
    const KEYS: &'static [Key] = &[BETWEEN, AXIS];
    const EXAMPLE: Example = (&[NodeKind::Body, NodeKind::Slope], &[("axis", ExampleValue::Direction([0.0, 1.0, 0.0]))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (CableEnd, Vec<S>) {
        let axis = given.unit("axis");
        let (a, slope) = ends(given);
        if let Some(angle) = Given::angle_if_not_right(axis, slope.unit()) {
            given.wrong(format!(
                "the axis of \"{}\" is at {angle:.6} degrees to the cable; it must be at 90: a cable cannot be told to turn about itself",
                given.owner()
            ));
        }
        (CableEnd { a, held: HeldSlope::Plane }, held(given, [axis]))
    }
}
