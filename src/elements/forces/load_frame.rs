use crate::elements::entries::{ExampleValue, FUNCTION, Given, Key, Type, may, need};
use crate::scalar::{Scalar, SpatialVector};

/// The frame in which a load keeps its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LoadFrame {
    /// Dead load: constant direction in the world.
    World,
    /// Follower load: turns with the body.
    Body,
}

/// Words for a frame.
pub(crate) const FRAMES: Type = Type::Choice(&WORDS);
const WORDS: [&str; 2] = ["world", "body"];
/// The frame of a direction on a node.
pub(crate) const FRAME: Key = may("frame", FRAMES, "direction fixed in the world, or turning with the node; world");
/// Size of a load in its example.
pub(crate) const SIZE: (&str, ExampleValue) = ("size", ExampleValue::Sine([0.2, 1.4, 2.3, 0.6]));

/// The size of a load over time.
pub(crate) const fn size(unit: &'static str) -> Key {
    need("size", Type::Function(unit, &FUNCTION), "size over time")
}

impl LoadFrame {
    /// What the key `frame` says, or what it is without the key.
    pub(crate) fn given<S: Scalar>(given: &mut Given<S>, without: LoadFrame) -> LoadFrame {
        let all = [LoadFrame::World, LoadFrame::Body];
        all.into_iter().find(|frame| given.says("frame", frame.word())).unwrap_or(without)
    }

    /// The world direction of a key as the load keeps it.
    pub(crate) fn kept<S: Scalar>(self, given: &mut Given<S>, key: &'static str) -> Vec<S> {
        let direction = given.vector(key);
        match self {
            LoadFrame::World => direction.components().to_vec(),
            LoadFrame::Body => given.local_directions(0, [direction]),
        }
    }

    /// As it is written.
    pub(crate) fn word(self) -> &'static str {
        WORDS[self as usize]
    }
}
