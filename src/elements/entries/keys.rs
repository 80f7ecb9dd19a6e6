//! What tables of keys are made of: one description serves the reader of scene files, its messages, the JSON schema and the reference page.

/// Which numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Every finite number.
    Any,
    /// Greater than 0.
    Positive,
    /// 0 or greater.
    AtLeastZero,
    /// From 0 to 1.
    Share,
}

impl Range {
    /// Whether it allows a number.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Range::Any => true,
            Range::Positive => value > 0.0,
            Range::AtLeastZero => value >= 0.0,
            Range::Share => (0.0..=1.0).contains(&value),
        }
    }
    /// In words, for messages.
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
pub enum Type {
    /// A number or a formula; unit and range.
    Number(&'static str, Range),
    /// A number or a formula without design variables; unit and range.
    Fixed(&'static str, Range),
    /// Three numbers or formulas, or a formula that gives a vector; unit.
    Vector(&'static str),
    /// As many numbers or formulas as one of these; unit and range.
    Numbers(&'static [usize], &'static str, Range),
    /// A list of values that are alike; the least and the largest number of them.
    List(&'static Type, usize, usize),
    /// One, or a list of them.
    OneOrMore(&'static Type),
    /// A whole number, from and to.
    Count(usize, usize),
    /// True or false.
    Flag,
    /// A text.
    Text,
    /// A file in STL: a surface of triangles.
    Stl,
    /// Two columns of a file, by their names or numbers.
    Columns,
    /// Numbers without design variables by name.
    Weights,
    Choice(&'static [&'static str]),
    /// One node.
    Node,
    /// A node, or those of an edge or end.
    NodeSet,
    /// Something of one of these sections.
    Item(&'static [&'static str]),
    /// A number or a formula, which may use variables of the faces and nodes of this mesh; unit and range.
    OfMesh(&'static str, Range),
    /// Lists of whole numbers from 0 on.
    Lists,
    /// Nodes or faces by name: lists of their numbers, or conditions on their places.
    Selections,
    /// A table.
    Table(&'static Forms),
    /// A number or formula, which stands for a constant, or a table; unit.
    Function(&'static str, &'static Forms),
    /// One or more numbers or formulas, those of strips: one may use the place `share`.
    Strips(&'static Type),
    /// Nodes by the names that formulas give them, or tables that say which point of a node.
    NamedNodes(&'static Forms),
    /// Names for formulas of what is known of nodes, which the other formulas of the entry may use.
    Definitions,
    /// Tables by the names by which the other formulas of the entry call them.
    NamedTables(&'static Forms),
    /// A formula of what is known of these nodes, a number; unit.
    OfNodes(&'static str),
    /// Formulas of what is known of nodes, by names; unit.
    NamedFormulas(&'static str),
    /// A formula of time.
    OfTime,
    /// A formula of s, v and t or a table of s; unit.
    Law(&'static str, &'static Forms),
    /// A formula or a table of s; unit.
    Energy(&'static str, &'static Forms),
    /// One of some words, or a table.
    Over(&'static [&'static str], &'static Forms),
}

impl Type {
    /// Whether it says on which nodes a part is: these, or those of the elements of a member.
    pub(crate) fn is_nodes(&self) -> bool {
        matches!(self, Type::Node | Type::List(Type::Node, ..) | Type::NodeSet | Type::Item(_))
    }
}

/// A list of as many values.
pub(crate) const fn exactly(count: usize, each: &'static Type) -> Type {
    Type::List(each, count, count)
}

/// A list of as many values or more.
pub(crate) const fn at_least(count: usize, each: &'static Type) -> Type {
    Type::List(each, count, usize::MAX)
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As it is written.
    pub name: &'static str,
    /// What it takes.
    pub takes: Type,
    /// Whether it must be there.
    pub is_needed: bool,
    /// What it is, and what it is without being given.
    pub doc: &'static str,
}

/// A key that must be there.
pub const fn need(name: &'static str, takes: Type, doc: &'static str) -> Key {
    Key { name, takes, is_needed: true, doc }
}

/// A key that may be left out.
pub const fn may(name: &'static str, takes: Type, doc: &'static str) -> Key {
    Key { name, takes, is_needed: false, doc }
}

/// One of the forms that a table may have, by its key `type`.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// Empty if there is no choice.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// Kinds of parts that a user's own program may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Joints.
    Joint,
    /// Springs, dampers, and any other element on one or two nodes.
    Spring,
    /// What is measured.
    Functional,
}

/// All forms of a table, and the keys that all of them have.
#[derive(Clone, Copy, Debug)]
pub struct Forms {
    /// Keys that all forms have.
    pub common: &'static [Key],
    /// The forms.
    pub forms: &'static [Form],
    /// Which parts of a user's own are forms of it, too.
    pub own: Option<Kind>,
}

impl Forms {
    /// The keys of a form.
    pub(crate) fn keys(&self, form: &str) -> impl Iterator<Item = &'static Key> {
        let own = self.forms.iter().filter(move |own| own.name == form).flat_map(|own| own.keys);
        self.common.iter().chain(own)
    }

    /// True if a key `type` says which.
    pub(crate) fn have_types(&self) -> bool {
        self.forms.len() > 1
    }
}

/// Both nodes of a joint or spring.
pub const BETWEEN: Key = need("between", exactly(2, &Type::Node), "both nodes, a and b");
/// The node of what has one.
pub const ON: Key = need("on", Type::Node, "node");
/// Which coordinate of a node.
pub const INDEX: Key = may("index", Type::Count(0, 1000), "which coordinate of the node, from 0; 0");
/// A point of the node.
pub const PLACE: Key = may("point", Type::Vector("m"), "point of the node, in the world at the start; the node's place");
/// Along what is measured, or a load acts.
pub const DIRECTION: Key = need("direction", Type::Vector("-"), "direction in the world");
/// Where a joint stands.
pub const POINT: Key = may("point", Type::Vector("m"), "place in the world at the start; that of b");
/// Along or about what it moves.
pub const AXIS: Key = need("axis", Type::Vector("-"), "axis in the world at the start, of any length");
/// Across what it moves.
pub const NORMAL: Key = need("normal", Type::Vector("-"), "normal in the world at the start, of any length");
/// Where a link or spring takes hold.
pub const ENDS: Key = may("points", at_least(2, &Type::Vector("m")), "where it takes hold of a and b; both nodes");

/// A table whose key `type` chooses a form.
macro_rules! forms {
    ([$($common:expr),* $(,)?] $($name:literal $doc:literal [$($key:expr),* $(,)?])*) => {
        $crate::elements::entries::Forms { common: &[$($common),*], forms: &[$($crate::elements::entries::Form { name: $name, doc: $doc, keys: &[$($key),*] }),*], own: None }
    };
}
pub(crate) use forms;
