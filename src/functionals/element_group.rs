use crate::assembly::ElementId;
use std::collections::HashSet;

/// Elements with a name, over which functionals are taken.
///
/// A member of a mechanism gives that of all its elements or of a part of them; several make one together. What some of the elements do
/// not have, the stress of a shell in a group with rigid bodies, is taken over the others.
#[derive(Clone, Debug)]
pub struct ElementGroup {
    /// What messages call it.
    pub name: String,
    /// Its elements, each of them once.
    pub elements: Vec<ElementId>,
}

impl ElementGroup {
    /// A group of some elements.
    pub fn new(name: &str, elements: impl IntoIterator<Item = ElementId>) -> Self {
        let mut known = HashSet::new();
        let elements = elements.into_iter().filter(|&element| known.insert(element)).collect();
        ElementGroup { name: name.into(), elements }
    }

    /// All elements of several groups.
    pub fn of_groups<'g>(name: &str, groups: impl IntoIterator<Item = &'g ElementGroup>) -> Self {
        Self::new(name, groups.into_iter().flat_map(|group| group.elements.iter().copied()))
    }
}
