//! Sections of a file.

use crate::elements::entries::Forms;

/// How often a section occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// `[settings]`
    Once,
    /// `[material.steel]`
    Named,
    /// `[[body]]` with a key `name`
    Listed,
}

/// A section of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    pub name: &'static str,
    pub shape: Shape,
    pub doc: &'static str,
    pub forms: Forms,
}

impl Section {
    /// As it is written in a file.
    pub fn header(&self) -> String {
        match self.shape {
            Shape::Once => format!("[{}]", self.name),
            Shape::Named => format!("[{}.NAME]", self.name),
            Shape::Listed => format!("[[{}]]", self.name),
        }
    }
}
