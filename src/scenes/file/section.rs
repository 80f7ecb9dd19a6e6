//! Sections of a file: how they are written, what their entries offer to others, and what builds them.

use super::entry_context::{Builder, Built, Entry, Result};
use crate::elements::entries::Forms;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// `[settings]`
    Once,
    /// `[material.steel]`
    Named,
    /// `[[body]]` with a key `name`
    Listed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    pub name: &'static str,
    pub shape: Shape,
    pub doc: &'static str,
    pub forms: Forms,
    /// Names of entries of one space are all different, as one may be taken for the other; those of none may be the same.
    pub space: &'static str,
    /// How others name the nodes that an entry is or has.
    pub nodes: Option<Nodes>,
    /// Histories have columns of it.
    pub has_columns: bool,
    /// What becomes of an entry.
    pub build: fn(Entry, &mut Builder) -> Result<Built>,
}

/// What formulas know of a node: a name, whether it is a vector, whether it is a rate.
pub(super) type OfNode = (&'static str, bool, bool);

/// How nodes of an entry are called: its ends and edges, how many numbers stand behind its name and behind these, and what formulas know of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nodes {
    pub edges: &'static [&'static str],
    pub own: usize,
    pub of_edge: usize,
    pub known: &'static [OfNode],
}

impl Nodes {
    /// An entry that is a node.
    pub const fn one(known: &'static [OfNode]) -> Self {
        Nodes { edges: &[], own: 0, of_edge: 0, known }
    }

    /// All ways to name nodes, or also sets of them.
    pub fn ways(&self, name: &str, sets: bool) -> Vec<String> {
        let numbers = |count| ["", "[i]", "[i, j]", "[face, i, j]"][count];
        let mut ways: Vec<String> = Vec::new();
        if self.own > 0 || self.edges.is_empty() {
            ways.push(format!("{name}{}", numbers(self.own)));
        }
        for edge in self.edges {
            if sets && self.of_edge > 0 {
                ways.push(format!("{name}.{edge}"));
            }
            ways.push(format!("{name}.{edge}{}", numbers(self.of_edge)));
        }
        ways
    }
}

impl Section {
    const fn new(name: &'static str, doc: &'static str, shape: Shape) -> Self {
        let build = |_: Entry, _: &mut Builder| Ok(Built::Nothing);
        let forms = Forms { common: &[], forms: &[], own: None };
        Section { name, shape, doc, forms, space: name, nodes: None, has_columns: false, build }
    }
    /// One that occurs once.
    pub const fn once(name: &'static str, doc: &'static str) -> Self {
        Self::new(name, doc, Shape::Once)
    }
    /// Entries by their names.
    pub const fn named(name: &'static str, doc: &'static str) -> Self {
        Self::new(name, doc, Shape::Named)
    }
    /// A list of entries, whose names are those of members.
    pub const fn listed(name: &'static str, doc: &'static str) -> Self {
        Section { space: "member", ..Self::new(name, doc, Shape::Listed) }
    }
    /// One of entries that are nodes or have them.
    pub const fn with_nodes(name: &'static str, doc: &'static str, nodes: Nodes) -> Self {
        Section { nodes: Some(nodes), has_columns: true, ..Self::listed(name, doc) }
    }

    /// Weight follows its entries: their nodes stand in space.
    pub fn has_mass(&self) -> bool {
        self.nodes.is_some_and(|own| own.known.iter().any(|known| known.0 == "position"))
    }

    /// As it is written in a file.
    pub fn header(&self) -> String {
        match self.shape {
            Shape::Once => format!("[{}]", self.name),
            Shape::Named => format!("[{}.NAME]", self.name),
            Shape::Listed => format!("[[{}]]", self.name),
        }
    }
}
