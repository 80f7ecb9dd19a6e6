//! What the entries of a file say, by their keys.

use super::formula::Formula;
use super::section::Section;
use crate::elements::entries::Range;
use crate::scalar::Interpolant;
use crate::scenes::{MeshData, TriangleSurface};
use std::collections::HashSet;
use std::sync::{Arc, Mutex, PoisonError};

/// The numbers of some columns; those of the first one increase.
#[derive(Debug)]
pub(super) struct Columns {
    pub numbers: Vec<Vec<f64>>,
    /// What stands in brackets behind their names.
    pub units: Vec<Option<String>>,
}

/// A design variable that has a value for each face, or each point, of some of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Each {
    /// The entry of the mesh.
    pub mesh: usize,
    pub per: Per,
    /// Places of the faces or points in the order of the values.
    pub places: Vec<usize>,
    /// The same by their numbers in the file.
    pub numbers: Vec<usize>,
}

/// What a variable has a value for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Per {
    Face,
    Node,
}

/// What a key was given.
#[derive(Clone, Debug)]
pub(super) enum Value {
    /// A formula of a number or a vector, with the range of its value.
    Formula(Formula, Range),
    Fixed(f64),
    Count(usize),
    Flag(bool),
    Text(String),
    Node(NodePlace),
    /// An entry, or a group of the faces of one that is a mesh.
    Item(usize, Option<String>),
    /// Numbers of a file.
    Columns(Arc<Columns>),
    Surface(Arc<TriangleSurface>),
    Weights(Vec<(String, f64)>),
    NamedNodes(Vec<NamedNode>),
    /// Formulas by names, with their places.
    Formulas(Vec<(String, usize, Formula)>),
    Fields(Fields),
    List(Vec<(usize, Value)>),
}

/// A node by the name that formulas give it, or a point of it in the world at the start, where one is given.
#[derive(Clone, Debug)]
pub(super) struct NamedNode {
    pub name: String,
    pub at: usize,
    pub place: NodePlace,
    pub point: Option<Formula>,
}

/// Where a node is to be found: `crank`, `beam.end`, `plate[2, 3]`, `tube.start[0]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct NodePlace {
    /// The entry; without it the ground.
    pub item: Option<usize>,
    pub edge: Option<&'static str>,
    pub index: Vec<usize>,
    /// Of a mesh: its points.
    pub points: Vec<usize>,
}

#[derive(Clone, Debug)]
pub(super) struct Fields {
    pub at: usize,
    /// Its type.
    pub form: &'static str,
    pub values: Vec<(&'static str, usize, Value)>,
    /// Keys that were asked for.
    read: Arc<Mutex<HashSet<&'static str>>>,
}

impl Fields {
    /// A table without values.
    pub fn none(at: usize) -> Self {
        Fields { at, form: "", values: Vec::new(), read: Arc::default() }
    }
    /// A value and its place.
    pub fn get(&self, key: &str) -> Option<(usize, &Value)> {
        let (own, at, value) = self.values.iter().find(|own| own.0 == key)?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(own);
        Some((*at, value))
    }
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }
    /// Where a key was given its value, or the table stands where it was not.
    pub fn place(&self, key: &str) -> usize {
        self.get(key).map_or(self.at, |given| given.0)
    }
    /// Entries of a list.
    pub fn list(&self, key: &str) -> impl Iterator<Item = (usize, &Value)> + use<'_> {
        let list: &[_] = if let Some((_, Value::List(list))) = self.get(key) { list } else { &[] };
        list.iter().map(|(at, value)| (*at, value))
    }
    pub fn tables(&self, key: &str) -> impl Iterator<Item = &Fields> + use<'_> {
        self.list(key).filter_map(|(_, own)| if let Value::Fields(own) = own { Some(own) } else { None })
    }
    pub fn fixed(&self, key: &str) -> Option<f64> {
        if let (_, Value::Fixed(value)) = self.get(key)? { Some(*value) } else { None }
    }
    pub fn fixed_list(&self, key: &str) -> Vec<f64> {
        self.list(key).filter_map(|(_, value)| if let Value::Fixed(own) = value { Some(*own) } else { None }).collect()
    }
    /// A whole number, 0 where it is not given.
    pub fn count(&self, key: &str) -> usize {
        if let Some((_, Value::Count(count))) = self.get(key) { *count } else { 0 }
    }
    pub fn counts(&self, key: &str) -> Option<[usize; 2]> {
        let number = |(_, value): (usize, &Value)| if let Value::Count(own) = value { Some(*own) } else { None };
        self.list(key).filter_map(number).collect::<Vec<_>>().try_into().ok()
    }
    pub fn flag(&self, key: &str) -> bool {
        matches!(self.get(key), Some((_, Value::Flag(true))))
    }
    pub fn text(&self, key: &str) -> Option<&str> {
        if let (_, Value::Text(text)) = self.get(key)? { Some(text) } else { None }
    }
    pub fn texts(&self, key: &str) -> impl Iterator<Item = &str> + use<'_> {
        self.list(key).filter_map(|(_, value)| if let Value::Text(own) = value { Some(own.as_str()) } else { None })
    }
    /// Points of a table, which one of its keys has, and formulas of the values there.
    pub fn points_and_values(&self, points: &str) -> Result<(Vec<f64>, Vec<Formula>), String> {
        let formula = |(_, own): (usize, &Value)| if let Value::Formula(own, _) = own { Some(own.clone()) } else { None };
        let (places, values): (_, Vec<Formula>) = match self.get("file") {
            Some((_, Value::Columns(columns))) => {
                self.has("columns");
                let [points, values] = [0, 1].map(|place| &columns.numbers[place]);
                (points.clone(), values.iter().copied().map(Formula::literal).collect())
            }
            _ => (self.fixed_list(points), self.list("values").filter_map(formula).collect()),
        };
        let counts = [places.len(), values.len()];
        match counts[0] == counts[1] {
            true => Ok((places, values)),
            false => Err(format!("there are {} {points}, but {} values; give one for each", counts[0], counts[1])),
        }
    }
    /// The way between the points of a table.
    pub fn way(&self) -> Interpolant {
        match self.text("interpolation") {
            Some("smooth") => Interpolant::Smooth,
            Some("lines") => Interpolant::Lines,
            Some("steps") => Interpolant::Steps,
            _ if self.form == "lines" => Interpolant::Lines,
            _ => Interpolant::Monotone,
        }
    }
    /// Entries that its values name.
    pub fn items(&self) -> Vec<usize> {
        let mut items = Vec::new();
        self.values.iter().for_each(|own| own.2.collect_items(&mut items));
        items
    }
    /// Keys that nobody has asked for, here and in tables that are values, with their places: they change nothing.
    pub fn unread(&self) -> Vec<(&'static str, usize)> {
        fn inside(value: &Value) -> Vec<(&'static str, usize)> {
            match value {
                Value::Fields(own) => own.unread(),
                Value::List(list) => list.iter().flat_map(|(_, own)| inside(own)).collect(),
                _ => Vec::new(),
            }
        }
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let of_key = |(key, at, value): &(&'static str, usize, Value)| match read.contains(key) || *key == "name" {
            true => inside(value),
            false => vec![(*key, *at)],
        };
        self.values.iter().flat_map(of_key).collect()
    }
}

impl Value {
    fn collect_items(&self, items: &mut Vec<usize>) {
        match self {
            Value::Item(item, _) => items.push(*item),
            Value::Node(place) => items.extend(place.item),
            Value::Fields(fields) => items.extend(fields.items()),
            Value::NamedNodes(nodes) => items.extend(nodes.iter().filter_map(|own| own.place.item)),
            Value::List(list) => list.iter().for_each(|(_, own)| own.collect_items(items)),
            _ => {}
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Item {
    /// Its place among all entries.
    pub place: usize,
    pub section: &'static Section,
    pub name: String,
    pub fields: Fields,
    /// Of an entry that is a mesh, if it could be read.
    pub mesh: Option<Arc<MeshData>>,
}
