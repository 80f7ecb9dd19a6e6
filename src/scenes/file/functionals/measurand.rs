//! What a functional of a scene file is described by, and keys that several have.

use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_ELEMENTS;

/// What is measured of a joint, elements or everything, all in one place: name, sentence, keys, and what an entry adds.
pub(super) struct Measurand {
    pub form: Form,
    /// Adds the functional of an entry.
    pub add: fn(Entry, &mut Builder) -> Found<()>,
}

/// Elements.
pub(super) const GROUP: Key = need(
    "of",
    Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them",
);
/// A section of a beam or cable.
pub(super) const AT_SHARE: Key = need("share", Fixed("-", Range::Share), "place along its length, from 0 to 1");
