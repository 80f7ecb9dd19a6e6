//! Values of the keys of an entry, in the scalar of the mechanism.

use super::fields::{Each, Fields, Item, NodePlace, Per, Value};
use super::formula::{Quantity, SHARE_PLACE};
use super::mistake::Mistake;
use super::own_parts::OwnParts;
use crate::assembly::{ConstraintId, ElementId, NodeId};
use crate::design::shortest;
use crate::elements::Characteristic;
use crate::elements::TimeFunction;
use crate::elements::entries::{FUNCTION, Range, Type};
use crate::elements::flexible::Shape;
use crate::elements::flexible::{Laminate, Material, PlyStrength};
use crate::functionals::ElementGroup;
use crate::scalar::{Interpolant, Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamMember, CableMember, Edge, MechanismBuilder, MeshedShell, ShellMember, Signal, ThinWalls};
use std::cell::Cell;
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

/// What an entry became.
pub(super) enum Made<S> {
    Nothing,
    Node(NodeId),
    Joint(ConstraintId),
    /// Springs and dampers, without multipliers.
    SoftJoint,
    Beam(BeamMember),
    Cable(CableMember),
    Shell(Box<ShellMember>),
    Mesh(Box<MeshedShell>),
    Walls(ThinWalls),
    Sphere(Vec<ShellMember>),
    Group(ElementGroup),
    Material(Material<S>),
    Shape(Material<S>, Shape<S>),
    Laminate(Laminate<S>, Vec<PlyStrength<S>>),
}

impl<S> Made<S> {
    /// The shells of which it consists.
    pub fn shells(&self) -> Vec<&MeshedShell> {
        match self {
            Made::Shell(shell) => vec![shell],
            Made::Mesh(shell) => vec![shell],
            Made::Walls(walls) => walls.walls.iter().map(|wall| &**wall).collect(),
            Made::Sphere(faces) => faces.iter().map(|face| &**face).collect(),
            _ => Vec::new(),
        }
    }
}

/// Values at the points of a table.
enum TableValues<S> {
    /// No design variable changes them.
    Fixed(Vec<f64>),
    OfDesign(Vec<S>),
}

/// Values of names, and what was made so far.
pub(super) struct Known<'f, S> {
    /// Parts beside those of the library.
    pub own: &'f OwnParts,
    /// All entries.
    pub items: &'f [Item],
    /// Numbers that formulas take.
    pub numbers: Vec<S>,
    /// Place along a beam for whose sections numbers are wanted.
    pub share: Cell<S>,
    /// Variables with values for faces or nodes of a mesh: their places among the names, and these values.
    pub each: Vec<(usize, &'f Each, Vec<S>)>,
    pub made: Vec<Made<S>>,
    /// The elements of each.
    pub elements: Vec<Vec<ElementId>>,
}

pub(super) type Builder<S> = MechanismBuilder<S>;

/// A result, or what is wrong and where.
pub(super) type Found<T> = Result<T, Mistake>;

pub(super) fn missing<T>(fields: &Fields, key: &str) -> Found<T> {
    Err(Mistake::new(fields.at, format!("the key {key} is needed here")))
}

impl<S: Scalar> Known<'_, S> {
    fn value(&self, key: &str, given: (usize, &Value)) -> Found<Quantity<S>> {
        self.value_of(key, given, |place| if place == SHARE_PLACE { self.share.get() } else { self.numbers[place] })
    }

    fn value_of(&self, key: &str, (at, value): (usize, &Value), known: impl Fn(usize) -> S) -> Found<Quantity<S>> {
        let Value::Formula(formula, range) = value else { return Err(Mistake::new(at, "this is no formula")) };
        let value = formula.value(known);
        let range = *range;
        match value.components().iter().map(|own| own.value()).find(|own| !(own.is_finite() && range.holds(*own))) {
            None => Ok(value),
            Some(own) => {
                let (own, wanted) = (shortest(own), if range == Range::Any { "finite" } else { range.words() });
                Err(Mistake::new(at, format!("{key}: at this design the value is {own}; it must be {wanted}")))
            }
        }
    }

    fn scalar(&self, key: &str, given: (usize, &Value)) -> Found<S> {
        match self.value(key, given)? {
            Quantity::Number(own) => Ok(own),
            Quantity::Vector(_) => Err(Mistake::new(given.0, "a number is wanted, and this is a vector")),
        }
    }

    fn spatial(&self, key: &str, given: (usize, &Value)) -> Found<Vector3<S>> {
        match self.value(key, given)? {
            Quantity::Vector(own) => Ok(own),
            Quantity::Number(_) => Err(Mistake::new(given.0, "a vector is wanted, and this is a number")),
        }
    }

    pub fn number(&self, fields: &Fields, key: &str) -> Found<S> {
        fields.get(key).map_or_else(|| missing(fields, key), |given| self.scalar(key, given))
    }

    /// A number at a point of a face of a mesh, for which some variables have values of their own; what the face is called, for messages.
    pub fn number_at(&self, fields: &Fields, key: &str, [mesh, face, point]: [usize; 3], called: &str) -> Found<S> {
        let given = fields.get(key).map_or_else(|| missing(fields, key), Ok)?;
        let mut own = Vec::new();
        for (place, each, values) in self.each.iter().filter(|own| own.1.mesh == mesh) {
            let wanted = if each.per == Per::Face { face } else { point };
            match each.places.binary_search(&wanted).ok().and_then(|own| values.get(own)) {
                Some(&value) => own.push((*place, value)),
                None if matches!(given.1, Value::Formula(formula, _) if formula.taken().contains(place)) => {
                    let text = format!(
                        "{key}: a design variable of some faces or nodes has no value for {called}; name those in per_face or per_node, or give \
                         the others a part of their own"
                    );
                    return Err(Mistake::new(given.0, text));
                }
                None => {}
            }
        }
        let known = |place| own.iter().find(|own| own.0 == place).map_or_else(|| self.numbers[place], |own| own.1);
        match self.value_of(key, given, known) {
            Ok(Quantity::Number(own)) => Ok(own),
            Ok(Quantity::Vector(_)) => Err(Mistake::new(given.0, "a number is wanted, and this is a vector")),
            Err(Mistake { at, what }) => Err(Mistake::new(at, format!("{called}, {what}"))),
        }
    }

    pub fn number_or(&self, fields: &Fields, key: &str, default: f64) -> Found<S> {
        fields.get(key).map_or(Ok(S::from(default)), |given| self.scalar(key, given))
    }

    pub fn vector(&self, fields: &Fields, key: &str) -> Found<Vector3<S>> {
        fields.get(key).map_or_else(|| missing(fields, key), |given| self.spatial(key, given))
    }

    pub fn vector_or(&self, fields: &Fields, key: &str, default: Vector3<S>) -> Found<Vector3<S>> {
        fields.get(key).map_or(Ok(default), |given| self.spatial(key, given))
    }

    /// All numbers of a list, none if the key is not given.
    pub fn series(&self, fields: &Fields, key: &str) -> Found<Vec<S>> {
        list(fields, key).map(|given| self.scalar(key, given)).collect()
    }

    /// The numbers of strips: where one formula uses [`SHARE_PLACE`], those at the middles of so many.
    pub fn strips(&self, fields: &Fields, key: &str, count: usize) -> Found<Vec<S>> {
        let uses_share =
            |(_, own): (usize, &Value)| matches!(own, Value::Formula(own, _) if own.taken().contains(&SHARE_PLACE));
        let given: Vec<_> = list(fields, key).collect();
        let [one] = given[..] else {
            return match given.iter().copied().find(|own| uses_share(*own)) {
                Some((at, _)) => Err(Mistake::new(at, "share is the place along all strips: give one formula of it")),
                None => self.series(fields, key),
            };
        };
        if !uses_share(one) {
            return self.series(fields, key);
        }
        let at_middle = |strip: usize| {
            self.share.set(S::from((strip as f64 + 0.5) / count as f64));
            self.scalar(key, one)
        };
        let all = (0..count).map(at_middle).collect();
        self.share.set(S::zero());
        all
    }

    pub fn numbers<const N: usize>(&self, fields: &Fields, key: &str) -> Found<[S; N]> {
        self.series(fields, key)?.try_into().or_else(|_| missing(fields, key))
    }

    /// Two numbers of a list.
    pub fn pair(&self, (at, value): (usize, &Value)) -> Found<[S; 2]> {
        let Value::List(own) = value else { return Err(Mistake::new(at, "this is no pair")) };
        let numbers: Vec<S> =
            own.iter().map(|(at, own)| self.scalar("a number of a pair", (*at, own))).collect::<Found<_>>()?;
        numbers.try_into().map_err(|_| Mistake::new(at, "a pair has two numbers"))
    }

    pub fn points(&self, fields: &Fields, key: &str) -> Found<Vec<Vector3<S>>> {
        list(fields, key).map(|given| self.spatial(key, given)).collect()
    }

    /// Nodes at a place: one, or those of an edge or end.
    pub fn nodes_at(&self, at: usize, place: &NodePlace, m: &mut MechanismBuilder<S>) -> Found<Vec<NodeId>> {
        let Some(item) = place.item else { return Ok(vec![m.ground()]) };
        let index = |count: usize| match place.index.first() {
            Some(&own) if own < count => Ok(own),
            Some(own) => Err(Mistake::new(at, format!("there is no node {own}: there are {count}, from 0 on"))),
            None => Err(Mistake::new(at, "the number of the node is missing")),
        };
        let on_line = |nodes: &[NodeId]| match place.edge {
            Some("start") => Ok(nodes[0]),
            Some(_) => Ok(nodes[nodes.len() - 1]),
            None => index(nodes.len()).map(|own| nodes[own]),
        };
        let some = |nodes: Vec<NodeId>| match place.index.len() {
            0 => Ok(nodes),
            _ => index(nodes.len()).map(|own| vec![nodes[own]]),
        };
        let on_grid = |shell: &ShellMember, index: &[usize]| {
            let [columns, rows] = shell.counts.map(|count| 2 * count + 1);
            match index {
                &[i, j] if i < columns && j < rows => Ok(vec![shell.node(i, j)]),
                _ => Err(Mistake::new(at, format!("the grid has {columns} x {rows} nodes, counted from 0"))),
            }
        };
        match &self.made[item] {
            Made::Node(node) => Ok(vec![*node]),
            Made::Beam(beam) => on_line(&beam.nodes).map(|node| vec![node]),
            Made::Cable(cable) => on_line(&cable.nodes).map(|node| vec![node]),
            Made::Walls(walls) => some(if place.edge == Some("start") { walls.start() } else { walls.end() }),
            Made::Shell(shell) => match place.edge {
                Some(edge) => some(shell.edge(Edge::named(edge))),
                None => on_grid(shell, &place.index),
            },
            Made::Mesh(shell) => {
                let node = |&point: &usize| shell.node(point).ok_or_else(|| Mistake::new(at, "this is no node"));
                place.points.iter().map(node).collect()
            }
            Made::Sphere(faces) => on_grid(&faces[index(faces.len())?], &place.index[1..]),
            _ => Err(Mistake::new(at, "this is no node")),
        }
    }

    /// All nodes of the key `nodes`.
    pub fn node_sets(&self, fields: &Fields, m: &mut MechanismBuilder<S>) -> Found<Vec<NodeId>> {
        let mut nodes = Vec::new();
        for (at, value) in list(fields, "nodes") {
            if let Value::Node(place) = value {
                nodes.extend(self.nodes_at(at, place, m)?);
            }
        }
        Ok(nodes)
    }

    /// What a spring, damper or load acts on: its nodes, each that a load names, or those of each element of a member, with names.
    pub fn carriers(&self, name: &str, fields: &Fields, m: &mut MechanismBuilder<S>) -> Found<Vec<(String, Vec<NodeId>)>> {
        let (at, value) = ["between", "on", "beam", "shell"]
            .into_iter()
            .find_map(|key| fields.get(key))
            .map_or_else(|| missing(fields, "on"), Ok)?;
        let item = match value {
            Value::Node(place) => {
                let nodes = self.nodes_at(at, place, m)?;
                let (count, point) = (nodes.len(), fields.get("point"));
                if let Some((at, _)) = point.filter(|_| count > 1) {
                    let text = format!("a force on {count} nodes has no point of its own: each takes its share where it is");
                    return Err(Mistake::new(at, text));
                }
                let named =
                    |(i, node)| (if count == 1 { name.into() } else { format!("{name}, node {}", i + 1) }, vec![node]);
                return Ok(nodes.into_iter().enumerate().map(named).collect());
            }
            Value::Item(item) | Value::Group(item, _) => *item,
            _ => return Ok(vec![(name.into(), self.different_nodes_of_part(fields, m)?)]),
        };
        match (&self.made[item], value) {
            (Made::Beam(beam), _) => Ok(beam.carriers(name)),
            (Made::Mesh(shell), Value::Group(_, group)) => {
                Ok(shell.carriers(name, &shell.group_named(group).map_err(|why| Mistake::new(at, why))?))
            }
            (made, _) => Ok(made.shells().into_iter().flat_map(|own| own.carriers(name, &own.group())).collect()),
        }
    }

    fn one_node(&self, (at, value): (usize, &Value), m: &mut MechanismBuilder<S>) -> Found<NodeId> {
        let Value::Node(place) = value else { return Err(Mistake::new(at, "this is no node")) };
        match self.nodes_at(at, place, m)?.as_slice() {
            [node] => Ok(*node),
            other => Err(Mistake::new(at, format!("these are {} nodes, and one is wanted", other.len()))),
        }
    }

    pub fn node(&self, fields: &Fields, key: &str, m: &mut MechanismBuilder<S>) -> Found<NodeId> {
        fields.get(key).map_or_else(|| missing(fields, key), |given| self.one_node(given, m))
    }

    fn list_of_nodes(&self, fields: &Fields, key: &str, m: &mut MechanismBuilder<S>) -> Found<Vec<NodeId>> {
        list(fields, key).map(|given| self.one_node(given, m)).collect()
    }

    /// What the keys `between`, or else `on`, name.
    pub fn nodes_of_part(&self, fields: &Fields, m: &mut MechanismBuilder<S>) -> Found<Vec<NodeId>> {
        match fields.get("between") {
            Some(_) => self.list_of_nodes(fields, "between", m),
            None => self.node(fields, "on", m).map(|node| vec![node]),
        }
    }

    /// The same for what connects nodes, which are all different.
    pub fn different_nodes_of_part(&self, fields: &Fields, m: &mut MechanismBuilder<S>) -> Found<Vec<NodeId>> {
        let nodes = self.nodes_of_part(fields, m)?;
        let is_twice = |place: usize| nodes[..place].contains(&nodes[place]);
        match (0..nodes.len()).any(is_twice) {
            true => Err(Mistake::new(
                fields.get("between").map_or(fields.at, |own| own.0),
                "two of between are the same node; give different ones",
            )),
            false => Ok(nodes),
        }
    }

    /// Two nodes that are different.
    pub fn different_nodes(&self, fields: &Fields, m: &mut MechanismBuilder<S>) -> Found<[NodeId; 2]> {
        self.different_nodes_of_part(fields, m)?.try_into().or_else(|_| missing(fields, "between"))
    }

    /// What another entry became.
    pub fn made<'m>(&'m self, fields: &Fields, key: &str) -> Found<&'m Made<S>> {
        match fields.get(key) {
            Some((_, Value::Item(item) | Value::Group(item, _))) => Ok(&self.made[*item]),
            _ => missing(fields, key),
        }
    }

    pub fn joint(&self, fields: &Fields) -> Found<ConstraintId> {
        match self.made(fields, "joint")? {
            Made::Joint(joint) => Ok(*joint),
            Made::SoftJoint => {
                let at = fields.get("joint").map_or(fields.at, |own| own.0);
                Err(Mistake::new(
                    at,
                    "this joint is soft: springs have no multipliers; leave out its stiffness to measure them",
                ))
            }
            _ => missing(fields, "joint"),
        }
    }

    pub fn material(&self, fields: &Fields) -> Found<Material<S>> {
        match self.made(fields, "material")? {
            Made::Material(material) => Ok(*material),
            _ => missing(fields, "material"),
        }
    }

    /// The laminate that an entry names, with the strengths of its plies.
    pub fn laminate(&self, fields: &Fields) -> Found<(&Laminate<S>, &[PlyStrength<S>])> {
        match self.made(fields, "laminate")? {
            Made::Laminate(laminate, strengths) => Ok((laminate, strengths)),
            _ => Err(Mistake::new(fields.at, "laminate must name a laminate")),
        }
    }

    /// Elements of everything that a key names.
    pub fn group(&self, fields: &Fields, key: &str) -> Found<ElementGroup> {
        let mut groups = Vec::new();
        for (at, value) in list(fields, key) {
            if let Value::Group(item, name) = value
                && let Made::Mesh(shell) = &self.made[*item]
            {
                groups.push(shell.group_named(name).map_err(|why| Mistake::new(at, why))?);
            }
            let Value::Item(item) = value else { continue };
            groups.extend(match &self.made[*item] {
                Made::Beam(beam) => vec![beam.group()],
                Made::Cable(cable) => vec![cable.group()],
                Made::Group(group) => vec![group.clone()],
                shells => shells.shells().into_iter().map(MeshedShell::group).collect(),
            });
        }
        match groups.len() {
            1 => Ok(groups.remove(0)),
            _ => Ok(ElementGroup::of_groups("of all that are named", &groups)),
        }
    }

    /// The elements of entries of any kind, and of groups.
    pub fn parts(&self, fields: &Fields, key: &str) -> Found<ElementGroup> {
        let own = list(fields, key).flat_map(|(_, value)| match value {
            Value::Item(item) => &self.elements[*item][..],
            _ => &[],
        });
        let elements = self.group(fields, key)?.elements.into_iter().chain(own.copied());
        Ok(ElementGroup::new("of all that are named", elements))
    }

    /// Axes of a frame.
    pub fn orientation(&self, fields: &Fields) -> Found<Quaternion<S>> {
        let Some((_, Value::Fields(own))) = fields.get("orientation") else { return Ok(Quaternion::identity()) };
        let direction = |key: &str| -> Found<Vector3<S>> {
            let vector = self.vector(own, key)?;
            let components = vector.components();
            match components.iter().any(|own| own.value() != 0.0) {
                true => Ok(vector.unit()),
                false => Err(Mistake::new(own.at, format!("{key} is zero; give a vector of any length but zero"))),
            }
        };
        match own.form {
            "angle" => Ok(Quaternion::about(direction("axis")?, self.number(own, "angle")?)),
            "x_axis" => Ok(Quaternion::x_axis_to(direction("along")?)),
            _ => {
                let values: [S; 4] = self.numbers(own, "values")?;
                let norm = values.iter().map(|own| own.value() * own.value()).sum::<f64>().sqrt();
                if (norm - 1.0).abs() > 1e-9 {
                    let text = format!("these Euler parameters have length {}; it must be 1", shortest(norm));
                    return Err(Mistake::new(own.at, text));
                }
                Ok(Quaternion(values))
            }
        }
    }

    /// A formula of time.
    fn formula_of_time(&self, own: &Fields) -> Found<Signal<S>> {
        let Some((at, Value::Formula(formula, _))) = own.get("value") else { return missing(own, "value") };
        own.get("breakpoints");
        let (function, parameters) = formula.law(&self.numbers);
        if !function.at(&[S::zero()], &parameters).number().value().is_finite() {
            return Err(Mistake::new(at, "at t = 0 s the value is not finite"));
        }
        Signal::own(function, &parameters).map_err(|why| Mistake::new(own.at, why))
    }

    /// Points of a table and the values there.
    fn points_and_values(&self, own: &Fields, points: &str) -> Found<(Vec<f64>, TableValues<S>)> {
        if let Some((_, Value::Columns(columns))) = own.get("file") {
            own.get("columns");
            return Ok((columns[0].clone(), TableValues::Fixed(columns[1].clone())));
        }
        let needed = |key| own.get(key).map_or_else(|| missing(own, key).map(|()| 0), |_| Ok(list(own, key).count()));
        let counts = [needed(points)?, needed("values")?];
        if counts[0] != counts[1] {
            let text = format!("there are {} {points}, but {} values; give one for each", counts[0], counts[1]);
            return Err(Mistake::new(own.at, text));
        }
        let fixed = |(_, value): (usize, &Value)| match value {
            Value::Formula(formula, _) => formula.constant_number(),
            _ => None,
        };
        let values = match list(own, "values").map(fixed).collect() {
            Some(fixed) => TableValues::Fixed(fixed),
            None => TableValues::OfDesign(self.series(own, "values")?),
        };
        Ok((fixed_list(own, points), values))
    }

    /// A law of s, its rate and the time.
    pub fn law(&self, fields: &Fields, key: &str) -> Found<(Characteristic, Vec<S>)> {
        match fields.get(key) {
            Some((at, Value::Formula(formula, _))) => {
                let (law, numbers) = formula.law(&self.numbers);
                Ok((Characteristic::of(law).map_err(|why| Mistake::new(at, why))?, numbers))
            }
            Some((_, Value::Fields(own))) => {
                let law = match self.points_and_values(own, "points")? {
                    (points, TableValues::Fixed(fixed)) => {
                        Characteristic::curve(&points, &fixed, way(own)).map(|law| (law, Vec::new()))
                    }
                    (points, TableValues::OfDesign(values)) => Characteristic::table(&points, &values, way(own)),
                };
                law.map_err(|why| Mistake::new(own.at, why))
            }
            _ => missing(fields, key),
        }
    }

    /// A function of time with its numbers.
    pub fn function(&self, fields: &Fields, key: &str) -> Found<Signal<S>> {
        let own = match fields.get(key) {
            Some((_, Value::Fields(own))) => own,
            Some(given) => return Ok(Signal::Constant(self.scalar(key, given)?)),
            None => return missing(fields, key),
        };
        let numbers = FUNCTION.keys(own.form).skip(FUNCTION.common.len());
        let numbers = numbers.filter(|key| matches!(key.takes, Type::Number(..)));
        let numbers = numbers.map(|key| self.number_or(own, key.name, 0.0)).collect::<Found<Vec<S>>>()?;
        let signal = match (own.form, TimeFunction::of_form(own.form, fixed(own, "at"))) {
            (_, Some(function)) => Signal::of(function, &numbers),
            ("formula", _) => {
                // files from when formulas were splines may keep it
                own.get("intervals");
                self.formula_of_time(own)?
            }
            _ => match self.points_and_values(own, "times")? {
                (times, TableValues::Fixed(fixed)) => {
                    let curve = TimeFunction::curve(&times, &fixed, way(own)).map_err(|why| Mistake::new(own.at, why))?;
                    Signal::of(curve, &[])
                }
                (times, TableValues::OfDesign(values)) => Signal::Table { times, values, interpolant: way(own) },
            },
        };
        if own.get("smooth_start").is_none() {
            return Ok(signal);
        }
        Ok(Signal::SmoothStart { of: Box::new(signal), duration: self.number(own, "smooth_start")? })
    }
}

/// The way between the points of a table.
pub(super) fn way(own: &Fields) -> Interpolant {
    match text(own, "interpolation") {
        Some("smooth") => Interpolant::Smooth,
        Some("lines") => Interpolant::Lines,
        Some("steps") => Interpolant::Steps,
        _ if own.form == "lines" => Interpolant::Lines,
        _ => Interpolant::Monotone,
    }
}

/// Entries of a list.
pub(super) fn list<'f>(fields: &'f Fields, key: &str) -> impl Iterator<Item = (usize, &'f Value)> + use<'f> {
    let list: &[(usize, Value)] = match fields.get(key) {
        Some((_, Value::List(list))) => list,
        _ => &[],
    };
    list.iter().map(|(at, value)| (*at, value))
}

pub(super) fn fixed(fields: &Fields, key: &str) -> Option<f64> {
    match fields.get(key) {
        Some((_, Value::Fixed(value))) => Some(*value),
        _ => None,
    }
}

pub(super) fn fixed_list(fields: &Fields, key: &str) -> Vec<f64> {
    let number = |(_, value): (usize, &Value)| if let Value::Fixed(own) = value { Some(*own) } else { None };
    list(fields, key).filter_map(number).collect()
}

pub(super) fn count(fields: &Fields, key: &str) -> usize {
    match fields.get(key) {
        Some((_, Value::Count(count))) => *count,
        _ => 0,
    }
}

pub(super) fn counts(fields: &Fields, key: &str) -> Option<[usize; 2]> {
    let number = |(_, value): (usize, &Value)| if let Value::Count(own) = value { Some(*own) } else { None };
    list(fields, key).filter_map(number).collect::<Vec<_>>().try_into().ok()
}

pub(super) fn flag(fields: &Fields, key: &str, default: bool) -> bool {
    match fields.get(key) {
        Some((_, Value::Flag(flag))) => *flag,
        _ => default,
    }
}

pub(super) fn text<'f>(fields: &'f Fields, key: &str) -> Option<&'f str> {
    match fields.get(key) {
        Some((_, Value::Text(text))) => Some(text),
        _ => None,
    }
}

pub(super) fn texts(fields: &Fields, key: &str) -> Vec<String> {
    let own = |(_, value): (usize, &Value)| if let Value::Text(own) = value { Some(own.clone()) } else { None };
    list(fields, key).filter_map(own).collect()
}

/// A text that stays for the life of the program: each is kept once.
pub(super) fn kept(text: &str) -> &'static str {
    static TEXTS: Mutex<Option<HashSet<&'static str>>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    let texts = texts.get_or_insert_default();
    if let Some(own) = texts.get(text) {
        return own;
    }
    let own: &'static str = Box::leak(text.into());
    texts.insert(own);
    own
}
