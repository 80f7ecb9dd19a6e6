use super::GivenValue;
use crate::elements::{Characteristic, NodeKind, TimeFunction};
use crate::scalar::{Interpolant, Quaternion, Scalar, SpatialVector, Vector3};

/// A value of the example of an entry, in a frame that whoever uses it places.
#[derive(Clone, Copy, Debug)]
pub enum ExampleValue {
    /// A number.
    Number(f64),
    /// Several numbers.
    Numbers(&'static [f64]),
    /// A place \[m\].
    Point([f64; 3]),
    /// Places \[m\].
    Points(&'static [[f64; 3]]),
    /// A direction [-].
    Direction([f64; 3]),
    /// A spline of s through values at some points.
    Table(&'static [f64], &'static [f64]),
    /// offset + amplitude sin(angular_frequency t + phase), in this order.
    Sine([f64; 4]),
}

/// Nodes, and the values of keys but the nodes.
pub type Example = (&'static [NodeKind], &'static [(&'static str, ExampleValue)]);

/// Two bodies.
pub const TWO_BODIES: &[NodeKind] = &[NodeKind::Body, NodeKind::Body];
/// One body.
pub const ONE_BODY: &[NodeKind] = &[NodeKind::Body];
/// A point of a joint in its example.
pub const AT: (&str, ExampleValue) = ("point", ExampleValue::Point([0.3, -0.2, 0.5]));
/// A direction in an example, of any length.
pub const HEADING: (&str, ExampleValue) = ("direction", ExampleValue::Direction([0.5, -0.6, 0.4]));
/// An axis of a joint or spring in its example.
pub const ALONG: (&str, ExampleValue) = ("axis", ExampleValue::Direction([0.6, 0.0, 0.8]));
/// A normal of a joint in its example.
pub const ACROSS: (&str, ExampleValue) = ("normal", ExampleValue::Direction([0.6, 0.0, 0.8]));
/// Ends of a link or spring in its example.
pub const FROM_TO: (&str, ExampleValue) = ("points", ExampleValue::Points(&[[0.1, 0.2, -0.3], [0.8, -0.4, 0.5]]));

/// Numbers of a spring and damper in its example.
pub(crate) const STIFF: (&str, ExampleValue) = ("stiffness", ExampleValue::Number(3.1));
pub(crate) const DAMPED: (&str, ExampleValue) = ("damping", ExampleValue::Number(0.7));
pub(crate) const REST_ANGLE: (&str, ExampleValue) = ("rest_angle", ExampleValue::Number(0.2));
/// What a driver follows in its example.
pub(crate) const DRIVE: ExampleValue = ExampleValue::Sine([0.0, 0.3, 2.0, 0.0]);

impl ExampleValue {
    /// The value with the frame at a place \[m\] and turned.
    pub fn placed<S: Scalar>(self, origin: Vector3<S>, turn: Quaternion<S>) -> GivenValue<S> {
        let point = |own: [f64; 3]| origin + turn.rotate(Vector3::from_f64(own));
        match self {
            ExampleValue::Number(own) => GivenValue::Number(own.into()),
            ExampleValue::Numbers(own) => GivenValue::Numbers(own.iter().map(|&own| own.into()).collect()),
            ExampleValue::Point(own) => GivenValue::Vector(point(own)),
            ExampleValue::Points(own) => GivenValue::Vectors(own.iter().map(|&own| point(own)).collect()),
            ExampleValue::Direction(own) => GivenValue::Vector(turn.rotate(Vector3::from_f64(own))),
            ExampleValue::Table(points, values) => {
                let values: Vec<S> = values.iter().map(|&own| own.into()).collect();
                let law = Characteristic::table(points, &values, Interpolant::Smooth);
                let (law, numbers) = law.unwrap_or_else(|why| unreachable!("{why}"));
                GivenValue::Law(law, numbers)
            }
            ExampleValue::Sine(own) => GivenValue::Function(TimeFunction::Sine, own.map(S::from).to_vec()),
        }
    }
}
