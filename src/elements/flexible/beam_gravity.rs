use super::shape::{AT_GAUSS_POINTS, NODES};
use crate::elements::{Field, Flexible, Interpolation, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// Weight of a beam: V = -g . (m r + R s) at three Gauss points \[J\].
///
/// Parameters of each point, for its share of the length:
/// * `mass`  m \[kg\]
/// * `first moment x, y, z`  s in the frame of the nodes [kg m]; ignored unless [`eccentric`](BeamGravityField::eccentric)
/// * `gravity x, y, z`  g [m/s2]
#[derive(Hash)]
pub struct BeamGravityField {
    /// The mass centre of the sections lies beside the reference line.
    pub eccentric: bool,
}

/// The weight as an element.
pub type BeamGravity = Flexible<BeamGravityField>;

const NUMBERS: usize = 7;

impl Field for BeamGravityField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = &[&AT_GAUSS_POINTS[0], &AT_GAUSS_POINTS[1], &AT_GAUSS_POINTS[2]];

    fn parameters(&self) -> Vec<Parameter> {
        let numbers = [
            ("mass", "kg"),
            ("first moment x", "kg m"),
            ("first moment y", "kg m"),
            ("first moment z", "kg m"),
            ("gravity x", "m/s2"),
            ("gravity y", "m/s2"),
            ("gravity z", "m/s2"),
        ];
        let name = |point: usize, name: &str| format!("Gauss point {point}: {name}");
        (1..=3).flat_map(|point| numbers.map(|(number, unit)| Parameter::named(name(point, number), unit))).collect()
    }
    fn parameters_of(&self, point: usize) -> Range<usize> {
        point * NUMBERS..(point + 1) * NUMBERS
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, _point: usize, h: &[S], p: &[S]) -> S {
        let mut moment = Vector3::first_three(h) * p[0];
        if self.eccentric {
            let e = Quaternion::from_slice(&h[3..]);
            moment += e.rotate(Vector3::first_three(&p[1..])) * e.norm_squared().recip();
        }
        -moment.dot(&Vector3::first_three(&p[4..]))
    }
}
