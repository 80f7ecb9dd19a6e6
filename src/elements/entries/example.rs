use super::GivenValue;
use crate::elements::TimeFunction;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};

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
    /// offset + amplitude sin(angular_frequency t + phase), in this order.
    Sine([f64; 4]),
}

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
            ExampleValue::Sine(own) => GivenValue::Function(TimeFunction::Sine, own.map(S::from).to_vec()),
        }
    }
}
