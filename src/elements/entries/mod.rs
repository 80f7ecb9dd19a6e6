//! Parts as entries: all that is said of a part beside its formula stands in the part's own file, and everything that speaks of it follows.
//!
//! An entry states its name, a sentence, its keys with units and meanings, how the parameters of the formula follow from these keys and
//! the places of its nodes, and an example. From the lists of entries ([`JOINTS`](super::joints::JOINTS),
//! [`DRIVERS`](super::joints::DRIVERS), [`SPRINGS`](super::forces::SPRINGS), [`DAMPERS`](super::forces::DAMPERS)) follow calls of the builder, forms of scene files with their checks and messages, the JSON schema, the
//! reference page, soft versions, and what tests and studies go through.

mod example;
mod functions;
mod given;
mod keys;
mod part;
mod placed;

pub use super::time_function::FUNCTION;
pub use example::{ACROSS, ALONG, AT, Example, ExampleValue, FROM_TO, HEADING, ONE_BODY, TWO_BODIES};
pub(crate) use example::{DAMPED, DRIVE, REST_ANGLE, STIFF};
pub use functions::{CHARACTERISTIC, ORIENTATION};
pub(crate) use functions::{COLUMNS, FILE, INTERPOLATION, VALUES};
pub use given::{Given, GivenValue, Values};
pub use keys::{
    AXIS, BETWEEN, DIRECTION, ENDS, Form, Forms, INDEX, Key, Kind, NORMAL, ON, PLACE, POINT, Range, Type, may, need,
};
pub(crate) use keys::{at_least, exactly, forms};
pub use part::{Entry, JointPart, JointVisitor, Law, MadeEntry, Part, SpringPart, SpringVisitor, WithParameters, forms_of};
pub(crate) use part::{Erase, entries, joined, named, names_of};
pub use placed::Placed;
