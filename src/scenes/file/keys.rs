//! What the tables of keys are made of: one description serves the reader, its messages, the JSON schema and the reference page.

/// Which numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    Any,
    Positive,
    AtLeastZero,
    /// From 0 to 1.
    Share,
}

impl Range {
    pub fn holds(self, value: f64) -> bool {
        match self {
            Range::Any => true,
            Range::Positive => value > 0.0,
            Range::AtLeastZero => value >= 0.0,
            Range::Share => (0.0..=1.0).contains(&value),
        }
    }
    pub fn words(self) -> &'static str {
        match self {
            Range::Any => "any finite number",
            Range::Positive => "greater than 0",
            Range::AtLeastZero => "at least 0",
            Range::Share => "from 0 to 1",
        }
    }
}

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Type {
    /// A number or a formula; unit and range.
    Number(&'static str, Range),
    /// A number or a formula without design variables; unit and range.
    Fixed(&'static str, Range),
    /// Three numbers or formulas, or a formula that gives a vector; unit.
    Vector(&'static str),
    /// As many numbers or formulas as one of these; unit and range.
    Numbers(&'static [usize], &'static str, Range),
    /// As many numbers without design variables, or any number of them where it is 0.
    Fixeds(usize, &'static str),
    /// Any number of numbers or formulas; unit.
    Series(&'static str),
    /// A number, or a list of them; unit and range.
    OneOrMore(&'static str, Range),
    /// Two vectors or more, in metres.
    Points,
    /// Two pairs of numbers or formulas or more; unit.
    Pairs(&'static str),
    /// A whole number, from and to.
    Count(usize, usize),
    /// As many whole numbers, each from and to.
    Counts(usize, usize, usize),
    Flag,
    Text,
    /// Names of anything.
    Texts,
    /// Numbers without design variables by name.
    Weights,
    Choice(&'static [&'static str]),
    /// Any of these, each once.
    Choices(&'static [&'static str]),
    /// One node.
    Node,
    /// As many nodes.
    Nodes(usize),
    /// Nodes, edges and ends.
    NodeSets,
    /// One of them.
    NodeSet,
    /// Something of one of these sections.
    Item(&'static [&'static str]),
    /// Any number of them.
    Items(&'static [&'static str]),
    /// A number or a formula, which may use variables of the faces and nodes of this mesh; unit and range.
    OfMesh(&'static str, Range),
    /// Lists of whole numbers from 0 on.
    Lists,
    /// Lists of whole numbers from 0 on by name.
    NamedLists,
    /// A table.
    Table(&'static Forms),
    /// A list of tables.
    Tables(&'static Forms),
    /// A number or formula, which stands for a constant, or a table; unit.
    Function(&'static str, &'static Forms),
    /// A formula of time.
    OfTime,
    /// One of some words, or a table.
    Over(&'static [&'static str], &'static Forms),
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub name: &'static str,
    pub takes: Type,
    pub is_needed: bool,
    /// What it is, and what it is without being given.
    pub doc: &'static str,
}

/// A key that must be there.
pub(super) const fn need(name: &'static str, takes: Type, doc: &'static str) -> Key {
    Key { name, takes, is_needed: true, doc }
}

/// A key that may be left out.
pub(super) const fn may(name: &'static str, takes: Type, doc: &'static str) -> Key {
    Key { name, takes, is_needed: false, doc }
}

/// One of the forms that a table may have, by its key `type`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    /// Empty if there is no choice.
    pub name: &'static str,
    pub doc: &'static str,
    pub keys: &'static [Key],
}

/// All forms of a table, and the keys that all of them have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forms {
    pub common: &'static [Key],
    pub forms: &'static [Form],
}

impl Forms {
    /// True if a key `type` says which.
    pub fn have_types(&self) -> bool {
        self.forms.iter().any(|form| !form.name.is_empty())
    }
}

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
