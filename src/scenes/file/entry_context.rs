//! An entry while it is built: the values of its keys as numbers, and what other entries became.

use super::fields::{Each, Fields, Item, NodePlace, Per, Value};
use super::formula::{Formula, Quantity, SHARE_PLACE};
use super::mistake::Mistake;
use super::own_parts::OwnParts;
use super::parts::Shape;
use crate::assembly::{ConstraintId, ElementId, NodeId};
use crate::design::shortest;
use crate::elements::entries::{FUNCTION, Range, Type};
use crate::elements::flexible::{Laminate, Material, PlyStrength};
use crate::elements::{Characteristic, TimeFunction};
use crate::functionals::ElementGroup;
use crate::program::Recorded;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamMember, CableMember, Edge, MechanismBuilder, MeshedShell, ShellMember, Signal, ThinWalls};
use std::cell::Cell;
use std::collections::HashSet;
use std::ops::Deref;
use std::sync::{Mutex, PoisonError};

/// What an entry became.
pub(super) enum Built {
    Nothing,
    Node(NodeId),
    Joint(ConstraintId),
    /// Its number.
    Event(usize),
    /// Stops or a latch, each with the number of the event that hits it.
    Stops(Vec<(ConstraintId, usize)>),
    Shape(Shape),
    /// A contact, with the number of the event that hits it, and of those at which it sticks and slips.
    Contact(ConstraintId, usize, Option<[usize; 2]>),
    /// Friction, with the numbers of the events at which it sticks and slips.
    Friction([usize; 2]),
    /// Springs and dampers, without multipliers.
    SoftJoint,
    Beam(BeamMember),
    Cable(CableMember),
    Shell(Box<ShellMember>),
    Mesh(Box<MeshedShell>),
    Walls(ThinWalls),
    Sphere(Vec<ShellMember>),
    Group(ElementGroup),
    Material(Material<Recorded>),
    Laminate(Laminate<Recorded>, Vec<PlyStrength<Recorded>>),
}

impl Built {
    /// The shells of which it consists.
    pub fn shells(&self) -> Vec<&MeshedShell> {
        match self {
            Built::Shell(shell) => vec![shell],
            Built::Mesh(shell) => vec![shell],
            Built::Walls(walls) => walls.walls.iter().map(|wall| &**wall).collect(),
            Built::Sphere(faces) => faces.iter().map(|face| &**face).collect(),
            _ => Vec::new(),
        }
    }
}

/// What is known of a scene while it is built at a design.
pub(super) struct EntryContext<'f> {
    /// Parts beside those of the library.
    pub own: &'f OwnParts,
    pub items: &'f [Item],
    /// Numbers that formulas take.
    pub numbers: Vec<Recorded>,
    /// Place along a beam for whose sections numbers are wanted.
    pub share: Cell<Recorded>,
    /// Variables with values for faces or nodes of a mesh: their places among the numbers, and these values.
    pub each: Vec<(usize, &'f Each, Vec<Recorded>)>,
    /// What entries became so far.
    pub built: Vec<Built>,
    /// The elements of each.
    pub elements: Vec<Vec<ElementId>>,
}

impl EntryContext<'_> {
    pub fn entry(&self, place: usize) -> Entry<'_> {
        let item = &self.items[place];
        Entry { context: self, item, fields: &item.fields }
    }
}

pub(super) type Builder = MechanismBuilder<Recorded>;

/// A result, or what is wrong and where.
pub(super) type Result<T, E = Mistake> = std::result::Result<T, E>;

/// An entry, or a table in it, that is built.
#[derive(Clone, Copy)]
pub(super) struct Entry<'k> {
    pub context: &'k EntryContext<'k>,
    pub item: &'k Item,
    pub fields: &'k Fields,
}

impl Deref for Entry<'_> {
    type Target = Fields;
    fn deref(&self) -> &Fields {
        self.fields
    }
}

impl<'k> Entry<'k> {
    pub fn name(&self) -> &'k str {
        &self.item.name
    }

    pub fn wrong<T>(&self, what: impl Into<String>) -> Result<T> {
        Err(Mistake::new(self.at, what))
    }

    pub fn wrong_key<T>(&self, key: &str, what: impl Into<String>) -> Result<T> {
        Err(Mistake::new(self.place(key), what))
    }

    fn missing<T>(&self, key: &str) -> Result<T> {
        self.wrong(format!("the key {key} is needed here"))
    }

    fn needed(&self, key: &str) -> Result<(usize, &'k Value)> {
        self.fields.get(key).map_or_else(|| self.missing(key), Ok)
    }

    /// What is read of a key where it is given.
    pub fn given<T>(&self, key: &str, read: impl FnOnce(&Self, &str) -> Result<T>) -> Result<Option<T>> {
        self.has(key).then(|| read(self, key)).transpose()
    }

    pub fn table(&self, key: &str) -> Option<Entry<'k>> {
        match self.fields.get(key) {
            Some((_, Value::Fields(fields))) => Some(Entry { fields, ..*self }),
            _ => None,
        }
    }

    pub fn tables(&self, key: &str) -> impl Iterator<Item = Entry<'k>> + use<'k> {
        let own = *self;
        own.fields.tables(key).map(move |fields| Entry { fields, ..own })
    }

    fn quantity(&self, key: &str, given: (usize, &Value)) -> Result<Quantity<Recorded>> {
        let EntryContext { share, numbers, .. } = self.context;
        self.value_of(key, given, |place| if place == SHARE_PLACE { share.get() } else { numbers[place] })
    }

    fn value_of(
        &self,
        key: &str,
        (at, value): (usize, &Value),
        known: impl Fn(usize) -> Recorded,
    ) -> Result<Quantity<Recorded>> {
        let Value::Formula(formula, range) = value else { return Err(Mistake::new(at, "this is no formula")) };
        let value = formula.value(known);
        let is_wrong = |own: &f64| !(own.is_finite() && range.holds(*own));
        value.components().iter().map(|own| own.value()).find(is_wrong).map_or(Ok(value), |own| {
            let (own, wanted) = (shortest(own), if *range == Range::Any { "finite" } else { range.words() });
            Err(Mistake::new(at, format!("{key}: at this design the value is {own}; it must be {wanted}")))
        })
    }

    pub fn number(&self, key: &str) -> Result<Recorded> {
        self.quantity(key, self.needed(key)?).map(|own| own.number())
    }

    /// A number at a point of a face of a mesh, for which some variables have values of their own; what the face is called, for messages.
    pub fn number_at(&self, key: &str, [mesh, face, point]: [usize; 3], called: &str) -> Result<Recorded> {
        let given = self.needed(key)?;
        let mut own = Vec::new();
        for (place, each, values) in self.context.each.iter().filter(|own| own.1.mesh == mesh) {
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
        let known = |place| own.iter().find(|own| own.0 == place).map_or_else(|| self.context.numbers[place], |own| own.1);
        let value = self.value_of(key, given, known).map(|own| own.number());
        value.map_err(|Mistake { at, what }| Mistake::new(at, format!("{called}, {what}")))
    }

    pub fn number_or(&self, key: &str, default: f64) -> Result<Recorded> {
        Ok(self.given(key, Entry::number)?.unwrap_or(default.into()))
    }

    pub fn vector(&self, key: &str) -> Result<Vector3<Recorded>> {
        self.quantity(key, self.needed(key)?).map(|own| own.vector())
    }

    pub fn vector_or(&self, key: &str, default: Vector3<Recorded>) -> Result<Vector3<Recorded>> {
        Ok(self.given(key, Entry::vector)?.unwrap_or(default))
    }

    /// All numbers of a list, none if the key is not given.
    pub fn series(&self, key: &str) -> Result<Vec<Recorded>> {
        self.list(key).map(|given| Ok(self.quantity(key, given)?.number())).collect()
    }

    /// The numbers of strips: where one formula uses [`SHARE_PLACE`], those at the middles of so many.
    pub fn strips(&self, key: &str, count: usize) -> Result<Vec<Recorded>> {
        let uses_share =
            |(_, own): (usize, &Value)| matches!(own, Value::Formula(own, _) if own.taken().contains(&SHARE_PLACE));
        let given: Vec<_> = self.list(key).collect();
        let Some((at, _)) = given.iter().copied().find(|own| uses_share(*own)) else { return self.series(key) };
        let [one] = given[..] else {
            return Err(Mistake::new(at, "share is the place along all strips: give one formula of it"));
        };
        let at_middle = |strip: usize| {
            self.context.share.set(Recorded::from((strip as f64 + 0.5) / count as f64));
            Ok(self.quantity(key, one)?.number())
        };
        let all = (0..count).map(at_middle).collect();
        self.context.share.set(Recorded::default());
        all
    }

    pub fn numbers<const N: usize>(&self, key: &str) -> Result<[Recorded; N]> {
        self.series(key)?.try_into().or_else(|_| self.missing(key))
    }

    pub fn pairs(&self, key: &str) -> Result<Vec<[Recorded; 2]>> {
        let number = |(at, own): &(usize, Value)| Ok(self.quantity("a number of a pair", (*at, own))?.number());
        let pair = |(_, own): (usize, &Value)| {
            let Value::List(own) = own else { return self.missing(key) };
            own.iter().map(number).collect::<Result<Vec<_>>>()?.try_into().or_else(|_| self.missing(key))
        };
        self.list(key).map(pair).collect()
    }

    pub fn points(&self, key: &str) -> Result<Vec<Vector3<Recorded>>> {
        self.list(key).map(|given| Ok(self.quantity(key, given)?.vector())).collect()
    }

    /// Nodes at a place: one, or those of an edge or end.
    pub fn nodes_at(&self, at: usize, place: &NodePlace, m: &mut Builder) -> Result<Vec<NodeId>> {
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
        match &self.context.built[item] {
            Built::Node(node) => Ok(vec![*node]),
            Built::Beam(beam) => on_line(&beam.nodes).map(|node| vec![node]),
            Built::Cable(cable) => on_line(&cable.nodes).map(|node| vec![node]),
            Built::Walls(walls) => some(if place.edge == Some("start") { walls.start() } else { walls.end() }),
            Built::Shell(shell) => match place.edge {
                Some(edge) => some(shell.edge(Edge::named(edge))),
                None => on_grid(shell, &place.index),
            },
            Built::Mesh(shell) => {
                let node = |&point: &usize| shell.node(point).ok_or_else(|| Mistake::new(at, "this is no node"));
                place.points.iter().map(node).collect()
            }
            Built::Sphere(faces) => on_grid(&faces[index(faces.len())?], &place.index[1..]),
            _ => Err(Mistake::new(at, "this is no node")),
        }
    }

    pub fn node_sets(&self, key: &str, m: &mut Builder) -> Result<Vec<NodeId>> {
        let mut nodes = Vec::new();
        for (at, value) in self.list(key) {
            if let Value::Node(place) = value {
                nodes.extend(self.nodes_at(at, place, m)?);
            }
        }
        Ok(nodes)
    }

    /// What a spring, damper or load acts on: its nodes, each that a load names, or those of each element of a member, with names.
    pub fn carriers(&self, m: &mut Builder) -> Result<Vec<(String, Vec<NodeId>)>> {
        let given = ["between", "on", "beam", "shell"].into_iter().find_map(|key| self.fields.get(key));
        let (at, value) = given.map_or_else(|| self.missing("on"), Ok)?;
        let name = self.name();
        let item = match value {
            Value::Node(place) => {
                let nodes = self.nodes_at(at, place, m)?;
                let (count, point) = (nodes.len(), self.fields.get("point"));
                if let Some((at, _)) = point.filter(|_| count > 1) {
                    let text = format!("a force on {count} nodes has no point of its own: each takes its share where it is");
                    return Err(Mistake::new(at, text));
                }
                let named =
                    |(i, node)| (if count == 1 { name.into() } else { format!("{name}, node {}", i + 1) }, vec![node]);
                return Ok(nodes.into_iter().enumerate().map(named).collect());
            }
            Value::Item(item, group) => (&self.context.built[*item], group),
            _ => return Ok(vec![(name.into(), self.different_nodes_of_part(m)?)]),
        };
        match item {
            (Built::Beam(beam), _) => Ok(beam.carriers(name)),
            (Built::Mesh(shell), Some(group)) => {
                Ok(shell.carriers(name, &shell.group_named(group).map_err(|why| Mistake::new(at, why))?))
            }
            (built, _) => Ok(built.shells().into_iter().flat_map(|own| own.carriers(name, &own.group())).collect()),
        }
    }

    fn one_node(&self, (at, value): (usize, &Value), m: &mut Builder) -> Result<NodeId> {
        let Value::Node(place) = value else { return Err(Mistake::new(at, "this is no node")) };
        match self.nodes_at(at, place, m)?.as_slice() {
            [node] => Ok(*node),
            other => Err(Mistake::new(at, format!("these are {} nodes, and one is wanted", other.len()))),
        }
    }

    pub fn node(&self, key: &str, m: &mut Builder) -> Result<NodeId> {
        self.one_node(self.needed(key)?, m)
    }

    /// What the keys `between`, or else `on`, name.
    pub fn nodes_of_part(&self, m: &mut Builder) -> Result<Vec<NodeId>> {
        match self.has("between") {
            true => self.list("between").map(|given| self.one_node(given, m)).collect(),
            false => self.node("on", m).map(|node| vec![node]),
        }
    }

    /// The same for what connects nodes, which are all different.
    pub fn different_nodes_of_part(&self, m: &mut Builder) -> Result<Vec<NodeId>> {
        let nodes = self.nodes_of_part(m)?;
        match (0..nodes.len()).any(|place| nodes[..place].contains(&nodes[place])) {
            true => self.wrong_key("between", "two of between are the same node; give different ones"),
            false => Ok(nodes),
        }
    }

    pub fn different_nodes(&self, m: &mut Builder) -> Result<[NodeId; 2]> {
        self.different_nodes_of_part(m)?.try_into().or_else(|_| self.missing("between"))
    }

    /// What another entry became.
    pub fn built(&self, key: &str) -> Result<&'k Built> {
        match self.fields.get(key) {
            Some((_, Value::Item(item, _))) => Ok(&self.context.built[*item]),
            _ => self.missing(key),
        }
    }

    pub fn joint(&self) -> Result<ConstraintId> {
        match self.built("joint")? {
            Built::Joint(joint) | Built::Contact(joint, ..) => Ok(*joint),
            Built::Stops(own) if own.len() == 1 => Ok(own[0].0),
            Built::Stops(_) => {
                let text =
                    "this stop has two limits, each with a reaction of its own: write one stop for each to measure it";
                self.wrong_key("joint", text)
            }
            Built::SoftJoint => {
                let text = "this joint is soft: springs have no multipliers; leave out its stiffness to measure them";
                self.wrong_key("joint", text)
            }
            _ => self.missing("joint"),
        }
    }

    pub fn material(&self) -> Result<Material<Recorded>> {
        match self.built("material")? {
            Built::Material(material) => Ok(*material),
            _ => self.missing("material"),
        }
    }

    /// The laminate that an entry names, with the strengths of its plies.
    pub fn laminate(&self) -> Result<(&'k Laminate<Recorded>, &'k [PlyStrength<Recorded>])> {
        match self.built("laminate")? {
            Built::Laminate(laminate, strengths) => Ok((laminate, strengths)),
            _ => self.missing("laminate"),
        }
    }

    /// Shells that a key names, a list of those of each entry.
    pub fn shells(&self, key: &str) -> Vec<Vec<&'k MeshedShell>> {
        let built = &self.context.built;
        let shells = |(_, value): (usize, &Value)| match value {
            Value::Item(item, _) => Some(built[*item].shells()),
            _ => None,
        };
        self.list(key).filter_map(shells).collect()
    }

    /// Elements of everything that a key names.
    pub fn group(&self, key: &str) -> Result<ElementGroup> {
        let mut groups = Vec::new();
        for (at, value) in self.list(key) {
            let Value::Item(item, name) = value else { continue };
            groups.extend(match (&self.context.built[*item], name) {
                (Built::Mesh(shell), Some(name)) => vec![shell.group_named(name).map_err(|why| Mistake::new(at, why))?],
                (Built::Beam(beam), _) => vec![beam.group()],
                (Built::Cable(cable), _) => vec![cable.group()],
                (Built::Group(group), _) => vec![group.clone()],
                (shells, _) => shells.shells().into_iter().map(MeshedShell::group).collect(),
            });
        }
        match groups.len() {
            1 => Ok(groups.remove(0)),
            _ => Ok(ElementGroup::of_groups("of all that are named", &groups)),
        }
    }

    /// The elements of entries of any kind, and of groups.
    pub fn parts(&self, key: &str) -> Result<ElementGroup> {
        let own = self.list(key).flat_map(|(_, value)| match value {
            Value::Item(item, None) => &self.context.elements[*item][..],
            _ => &[],
        });
        let elements = self.group(key)?.elements.into_iter().chain(own.copied());
        Ok(ElementGroup::new("of all that are named", elements))
    }

    pub fn orientation(&self) -> Result<Quaternion<Recorded>> {
        let Some(own) = self.table("orientation") else { return Ok(Quaternion::identity()) };
        let direction = |key: &str| -> Result<Vector3<Recorded>> {
            let vector = own.vector(key)?;
            match vector.iter().any(|own| own.value() != 0.0) {
                true => Ok(vector.unit()),
                false => own.wrong(format!("{key} is zero; give a vector of any length but zero")),
            }
        };
        match own.form {
            "angle" => Ok(Quaternion::about(direction("axis")?, own.number("angle")?)),
            "x_axis" => Ok(Quaternion::x_axis_to(direction("along")?)),
            _ => {
                let values: [Recorded; 4] = own.numbers("values")?;
                let norm = values.iter().map(|own| own.value() * own.value()).sum::<f64>().sqrt();
                if (norm - 1.0).abs() > crate::tolerances::CONSISTENT {
                    return own.wrong(format!("these Euler parameters have length {}; it must be 1", shortest(norm)));
                }
                Ok(Quaternion(values))
            }
        }
    }

    fn formula_of_time(&self) -> Result<Signal<Recorded>> {
        let (at, Value::Formula(formula, _)) = self.needed("value")? else { return self.missing("value") };
        let (function, parameters) = formula.law(&self.context.numbers);
        if !function.at(&[Recorded::default()], &parameters).number().value().is_finite() {
            return Err(Mistake::new(at, "at t = 0 s the value is not finite"));
        }
        Signal::own(function, &parameters).or_else(|why| self.wrong(why))
    }

    /// Points of a table, and the values there if no design variable changes them.
    fn points_and_values(&self, points: &str) -> Result<(Vec<f64>, Option<Vec<f64>>)> {
        if !self.has("file") {
            self.needed(points)?;
            self.needed("values")?;
        }
        let (points, values) = self.fields.points_and_values(points).or_else(|why| self.wrong(why))?;
        Ok((points, values.iter().map(Formula::constant_number).collect()))
    }

    /// A law of s, its rate and the time.
    pub fn law(&self, key: &str) -> Result<(Characteristic, Vec<Recorded>)> {
        if let Some(own) = self.table(key) {
            let law = match own.points_and_values("points")? {
                (points, Some(fixed)) => Characteristic::curve(&points, &fixed, own.way()).map(|law| (law, Vec::new())),
                (points, None) => Characteristic::table(&points, &own.series("values")?, own.way()),
            };
            return law.or_else(|why| own.wrong(why));
        }
        let (at, Value::Formula(formula, _)) = self.needed(key)? else { return self.missing(key) };
        let (law, numbers) = formula.law(&self.context.numbers);
        Ok((Characteristic::of(law).map_err(|why| Mistake::new(at, why))?, numbers))
    }

    /// A function of time with its numbers.
    pub fn function(&self, key: &str) -> Result<Signal<Recorded>> {
        let Some(own) = self.table(key) else { return Ok(Signal::Constant(self.number(key)?)) };
        let numbers = FUNCTION.keys(own.form).skip(FUNCTION.common.len());
        let numbers = numbers.filter(|key| matches!(key.takes, Type::Number(..)));
        let numbers = numbers.map(|key| own.number_or(key.name, 0.0)).collect::<Result<Vec<Recorded>>>()?;
        let signal = match (own.form, TimeFunction::of_form(own.form, own.fixed("at"))) {
            (_, Some(function)) => Signal::of(function, &numbers),
            ("formula", _) => {
                // files from when formulas were splines may keep them
                ["breakpoints", "intervals"].iter().for_each(|key| _ = own.get(key));
                own.formula_of_time()?
            }
            _ => match own.points_and_values("times")? {
                (times, Some(fixed)) => {
                    Signal::of(TimeFunction::curve(&times, &fixed, own.way()).or_else(|why| own.wrong(why))?, &[])
                }
                (times, None) => Signal::Table { times, values: own.series("values")?, interpolant: own.way() },
            },
        };
        Ok(match own.given("smooth_start", Entry::number)? {
            Some(duration) => Signal::SmoothStart { of: Box::new(signal), duration },
            None => signal,
        })
    }
}

/// A text that stays for the life of the program: each is kept once.
pub(super) fn kept(text: &str) -> &'static str {
    static TEXTS: Mutex<Option<HashSet<&'static str>>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    let texts = texts.get_or_insert_default();
    let own: &'static str = texts.get(text).copied().unwrap_or_else(|| Box::leak(Box::<str>::from(text)));
    texts.insert(own);
    own
}
