//! What files that describe a section or a functional use: keys and their types, what an entry says and becomes.

pub(super) use super::build_parts::{built_from, given, located, values};
pub(super) use super::entry_context::{Builder, Built, Entry, EntryContext, Result, kept};
pub(super) use super::fields::{Fields, Item, NodePlace, Value};
pub(super) use super::formula_parts::{
    BREAKPOINTS, DEFINITIONS, Formulas, KnownNode, NAMED_NODES, NODES, OF_BODY, OF_COORDINATE, OF_POINT, OWN_TABLES,
    Reading, outputs_of,
};
pub(super) use super::keys::{MANY, MOST, NAME, SHELLS, WITH_ELEMENTS, WITH_MASS, WITH_MULTIPLIERS, one_form};
pub(super) use super::mistake::Mistake;
pub(super) use super::section::{Nodes, Section};
pub(super) use crate::elements::entries::Range::{Any, AtLeastZero, Positive};
pub(super) use crate::elements::entries::Type::{
    Choice, Count, Fixed, Flag, Lists, Node, NodeSet, Number, Numbers, OfMesh, OfNodes, OneOrMore, Selections, Stl, Strips,
    Table, Text, Vector,
};
pub(super) use crate::elements::entries::{
    Form, Forms, Key, Range, Type, at_least, exactly, forms, forms_of, joined, may, named, need,
};
pub(super) use crate::program::Recorded;
pub(super) use crate::scalar::{Scalar, SpatialVector, Vector3};
