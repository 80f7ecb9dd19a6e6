//! What files that describe a section or a functional use: keys and their types, what an entry says and becomes.

pub(super) use super::fields::{Fields, Item, NodePlace, Value};
pub(super) use super::formula_parts::{OF_BODY, OF_COORDINATE, OF_POINT};
pub(super) use super::keys::{NAME, one_form};
pub(super) use super::known::{Builder, Entry, Found, Known, Made, kept};
pub(super) use super::mistake::Mistake;
pub(super) use super::section::{Nodes, Section};
pub(super) use crate::elements::entries::Range::{Any, AtLeastZero, Positive};
pub(super) use crate::elements::entries::Type::{
    Choice, Choices, Count, Counts, Fixed, FixedOrMore, Fixeds, Flag, Items, Lists, Node, NodeSets, Number, Numbers, OfMesh,
    OneOrMore, Pairs, Points, Selections, SeriesOfNodes, Stl, Strips, Table, Tables, Text, Texts, Vector,
};
pub(super) use crate::elements::entries::{Form, Forms, Key, Range, Type, forms, forms_of, joined, may, named, need};
pub(super) use crate::program::Recorded;
pub(super) use crate::scalar::{Scalar, SpatialVector, Vector3};
