use super::spring_law::ANGLE;
use crate::elements::entries::{DAMPED, Entry, Example, Given, INDEX, Key, REST_ANGLE, Range, STIFF, Type, may, need};
use crate::elements::{Element, NodeKind, Output, Parameter};
use crate::scalar::Scalar;

/// A spring and damper on one coordinate of a node: F = k (q - q0) + c dq/dt.
///
/// On a joint angle that counts turns it is a torsion spring over any number of turns.
///
/// * `stiffness`  k [N/m, or N m/rad for an angle], 0 or greater
/// * `damping`  c [N s/m, or N m s/rad], 0 or greater
/// * `rest`  q0 [m, or rad]
#[derive(Hash)]
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
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, e: &mut [S]) {
        e[0] = q[self.index];
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain(ANGLE)
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let stretch = e[0] - p[2];
        p[0] * stretch * stretch * 0.5
    }
    fn damping<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        s[0] = p[1] * rate[0];
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
    const EXAMPLE: Example = (&[NodeKind::Coordinates(1)], &[STIFF, DAMPED, REST_ANGLE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (of, index) = given.coordinate();
        (CoordinateSpringDamper { of, index }, given.spring_damper("rest_angle"))
    }
}
