use crate::elements::entries::{Entry, Example, ExampleValue, Given, INDEX, Key, Range, Type, may, need};
use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A spring and damper on one coordinate of a node: F = k (q - q0) + c dq/dt.
///
/// On a joint angle that counts turns it is a torsion spring over any number of turns.
///
/// * `stiffness`  k [N/m, or N m/rad for an angle], 0 or greater
/// * `damping`  c [N s/m, or N m s/rad], 0 or greater
/// * `rest`  q0 [m, or rad]
pub struct CoordinateSpringDamper {
    /// Kind of the node.
    pub of: NodeKind,
    /// Which one, from 0.
    pub index: usize,
}

impl Element for CoordinateSpringDamper {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness", "N/m, N m/rad").as_size(),
        Parameter::non_negative("damping", "N s/m, N m s/rad"),
        Parameter::new("rest", "m, rad"),
    ];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.of]
    }
    #[inline(always)]
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let stretch = q[self.index] - p[2];
        p[0] * stretch * stretch * 0.5
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S], _t: S, force: &mut [S]) {
        force[self.index] -= p[1] * v[self.index];
    }
}

impl Entry for CoordinateSpringDamper {
    type Law = Self;
    const NAME: &'static str = "angle";
    const DOC: &'static str = "on a joint angle, with a damper";
    const KEYS: &'static [Key] = &[
        need("on", Type::Node, "joint angle"),
        INDEX,
        need("stiffness", Type::Number("N m/rad", Range::AtLeastZero), "stiffness"),
        may("damping", Type::Number("N m s/rad", Range::AtLeastZero), "damping; 0"),
        may("rest_angle", Type::Number("rad", Range::Any), "angle without moment; 0"),
    ];
    const EXAMPLE: Example = (
        &[NodeKind::Coordinates(1)],
        &[
            ("stiffness", ExampleValue::Number(3.1)),
            ("damping", ExampleValue::Number(0.7)),
            ("rest_angle", ExampleValue::Number(0.2)),
        ],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (of, index) = given.coordinate();
        (CoordinateSpringDamper { of, index }, given.spring_damper("rest_angle"))
    }
}
