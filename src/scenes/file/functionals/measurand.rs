//! What a functional of a scene file is described by, and keys that several have.

use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_ELEMENTS;

/// What is measured of a joint, elements or everything, all in one place: name, sentence, keys, and what an entry adds.
pub(super) trait Measurand {
    /// Name, sentence and keys.
    const FORM: Form;
    /// Adds the functional of an entry.
    fn add<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<()>;
}

/// Elements.
pub(super) const GROUP: Key = need(
    "of",
    Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them",
);
/// A section of a beam or cable.
pub(super) const AT_SHARE: Key = need("share", Fixed("-", Range::Share), "place along its length, from 0 to 1");
