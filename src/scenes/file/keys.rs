//! Keys that several sections have, and what they name.

use crate::elements::entries::{Key, Type, need};

pub(super) const NAME: Key = need("name", Type::Text, "name, by which others refer to it");

/// How many numbers a design variable may have that has several.
pub(super) const MANY: std::ops::RangeInclusive<usize> = 2..=10_000;

/// Most elements along a line.
pub(super) const MOST: usize = 10_000;

/// Sections whose entries have elements.
pub(super) const WITH_ELEMENTS: &[&str] = &["beam", "cable", "shell", "mesh", "thin_walls", "sphere", "group"];
/// Sections whose entries are joints.
pub(super) const WITH_MULTIPLIERS: &[&str] = &["joint", "driver", "stop", "latch", "contact"];
/// Sections whose entries have mass: weight follows them.
pub(super) const WITH_MASS: &[&str] = &["body", "point", "beam", "cable", "shell", "mesh", "thin_walls", "sphere"];
/// Sections whose entries are shells with faces and edges to which others are joined.
pub(super) const SHELLS: &[&str] = &["shell", "mesh", "thin_walls"];

/// A table without a choice of forms.
macro_rules! one_form {
    ($($key:expr),* $(,)?) => {
        $crate::elements::entries::Forms {
            common: &[],
            forms: &[$crate::elements::entries::Form { name: "", doc: "", keys: &[$($key),*] }],
            own: None,
        }
    };
}
pub(super) use one_form;
