use super::shape::{AT_GAUSS_POINTS, NODES, THREE, THREE_WEIGHTS, slopes, weighed};
use crate::elements::entries::{Entry, Example, Given, HEADING, Key, Type, may, need};
use crate::elements::forces::load_frame::{FRAMES, LoadFrame, SIZE, size};
use crate::elements::{Field, Flexible, Interpolation, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// A force for each length of a beam's reference line, d f(t) [N/m], at three Gauss points.
///
/// Parameters of each point:
/// * `length`  its share of the reference length \[m\]
/// * `direction x, y, z`  d, in the world or, for a follower load, in the frame of the nodes, turning with the sections [-]
/// * parameters of f(t) [N/m]
#[derive(Hash)]
pub struct DistributedLoadField {
    /// Dead or follower load.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

/// The load as an element.
pub type DistributedLoad = Flexible<DistributedLoadField>;

const GEOMETRY: usize = 4;

impl DistributedLoadField {
    fn numbers(&self) -> usize {
        GEOMETRY + self.size.parameters("N/m").len()
    }
}

impl Field for DistributedLoadField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = &[&AT_GAUSS_POINTS[0], &AT_GAUSS_POINTS[1], &AT_GAUSS_POINTS[2]];

    fn parameters(&self) -> Vec<Parameter> {
        let mut numbers = vec![Parameter::new("length", "m")];
        numbers.extend(["direction x", "direction y", "direction z"].map(|name| Parameter::new(name, "-")));
        numbers.extend(self.size.parameters("N/m"));
        let named = |point: usize, number: &Parameter| {
            Parameter::named(format!("Gauss point {point}: {}", number.name), number.unit)
        };
        (1..=3).flat_map(|point| numbers.iter().map(move |number| named(point, number))).collect()
    }
    fn parameters_of(&self, point: usize) -> Range<usize> {
        let own = self.numbers();
        point * own..(point + 1) * own
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, _point: usize, _v: &[S], h: &[S], p: &[S], t: S, force: &mut [S]) {
        let mut direction = Vector3::first_three(&p[1..]);
        if self.frame == LoadFrame::Body {
            let e = Quaternion::from_slice(&h[3..]);
            direction = e.rotate(direction) * e.norm_squared().recip();
        }
        let size = self.size.value(t, &p[GEOMETRY..]) * p[0];
        for i in 0..3 {
            force[i] += direction[i] * size;
        }
    }
}

impl Entry for DistributedLoad {
    type Law = Self;
    const NAME: &'static str = "distributed_load";
    const DOC: &'static str = "A force for each length of a beam: direction times size.";
    const KEYS: &'static [Key] = &[
        need("beam", Type::Item(&["beam"]), "name of a beam"),
        may("frame", FRAMES, "direction fixed in the world, or turning with the sections; world"),
        need("direction", Type::Vector("-"), "direction in the world at the start; its length counts"),
        size("N/m"),
    ];
    const EXAMPLE: Example = (&[NodeKind::Body; NODES], &[HEADING, SIZE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        given.all_are(NodeKind::Body, "an element of a beam");
        let frame = LoadFrame::given(given, LoadFrame::World);
        let (direction, (size, values)) = (frame.kept(given, "direction"), given.function("size"));
        let length = |(xi, weight)| weighed(&given.positions(), &slopes(xi)).length() * weight;
        let lengths = THREE.into_iter().zip(THREE_WEIGHTS).map(length);
        let p = lengths.flat_map(|length| [&[length], &direction[..], &values].concat()).collect();
        (Flexible(DistributedLoadField { frame, size }), p)
    }
}
