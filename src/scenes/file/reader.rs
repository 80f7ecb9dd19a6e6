//! From the tree of a TOML text, by the tables of keys, to entries with checked values.

use super::expression::{Expression, Quantity, Scope, is_name, is_reserved, names_in};
use super::keys::{Form, Forms, Key, Range, Section, Shape, Type};
use super::mistake::Mistake;
use super::raw::{Entry, Raw, RawValue, repeated_entries, repeated_named};
use super::sections::{DEFINE, SECTIONS, TOP, WITH_NODES};
use super::unknown::unknown;
use std::collections::HashMap;

/// What a key was given.
#[derive(Clone, Debug)]
pub(super) enum Value {
    /// A formula of a number or a vector, with the range of its value.
    Formula(Expression, Range),
    Fixed(f64),
    Count(usize),
    Flag(bool),
    Text(String),
    Node(NodePlace),
    Item(usize),
    Weights(Vec<(String, f64)>),
    Fields(Fields),
    List(Vec<(usize, Value)>),
}

/// Where a node is to be found: `crank`, `beam.end`, `plate[2, 3]`, `tube.start[0]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NodePlace {
    /// The entry; without it the ground.
    pub item: Option<usize>,
    pub edge: Option<&'static str>,
    pub index: Vec<usize>,
}

/// The values of a table.
#[derive(Clone, Debug)]
pub(super) struct Fields {
    pub at: usize,
    /// Its type.
    pub form: &'static str,
    pub values: Vec<(&'static str, usize, Value)>,
}

impl Fields {
    /// A value and its place.
    pub fn get(&self, key: &str) -> Option<(usize, &Value)> {
        self.values.iter().find(|own| own.0 == key).map(|(_, at, value)| (*at, value))
    }
}

/// An entry of a section.
#[derive(Clone, Debug)]
pub(super) struct Item {
    pub section: &'static str,
    pub name: String,
    pub fields: Fields,
}

/// A design variable: how formulas call it is its place.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub fields: Fields,
    pub name: String,
}

/// A file that was read.
#[derive(Clone, Debug)]
pub(super) struct Contents {
    pub top: Fields,
    pub variables: Vec<Variable>,
    /// After the variables, in an order in which each depends on others before it only, with their places and names.
    pub definitions: Vec<(usize, String, Expression)>,
    pub items: Vec<Item>,
    /// Sections that occur once.
    pub single: Vec<(&'static str, Fields)>,
    /// Entries in the order of the file, but what others refer to before these.
    pub order: Vec<usize>,
}

/// A name that an entry has.
struct Declared {
    section: &'static Section,
    name: String,
    at: usize,
    raw: Raw,
}

struct Reader {
    scope: Scope,
    declared: Vec<Declared>,
    by_name: HashMap<(String, &'static str), usize>,
    mistakes: Vec<Mistake>,
}

/// Sections whose names may be the same, as nobody takes one for the other, have different words here.
fn name_space(section: &str) -> &'static str {
    match section {
        "variable" | "material" | "section" | "laminate" | "drawing" => {
            SECTIONS.iter().find(|own| own.name == section).map_or("", |own| own.name)
        }
        "joint" | "driver" | "rigid_interface" => "joint",
        "spring" | "damper" | "force" | "torque" | "distributed_load" | "pressure" => "force",
        "functional" => "functional",
        _ => "member",
    }
}

/// Reads a whole file.
pub(super) fn read(root: &Raw) -> Result<Contents, Vec<Mistake>> {
    let mut reader = Reader { scope: Scope::default(), declared: Vec::new(), by_name: HashMap::new(), mistakes: Vec::new() };
    let contents = reader.contents(root);
    if reader.mistakes.is_empty() { Ok(contents) } else { Err(reader.mistakes) }
}

impl Reader {
    fn wrong(&mut self, at: usize, what: impl Into<String>) {
        self.mistakes.push(Mistake::new(at, what));
    }

    fn contents(&mut self, root: &Raw) -> Contents {
        let entries = root.entries().unwrap_or_default();
        let top_keys = TOP.forms[0].keys;
        let mut known: Vec<String> = top_keys.iter().map(|key| key.name.into()).collect();
        known.push(DEFINE.0.into());
        known.extend(SECTIONS.iter().map(|section| section.name.into()));
        let mut top = Vec::new();
        let mut definitions: &[Entry] = &[];
        let mut singles: Vec<(&'static Section, &Raw)> = Vec::new();
        for entry in entries {
            if let Some(key) = top_keys.iter().find(|key| key.name == entry.key) {
                top.push((key, entry));
            } else if entry.key == DEFINE.0 {
                match entry.value.entries() {
                    Some(own) => definitions = own,
                    None => self.wrong(entry.value.at, format!("[define] must be a table; it is {}", entry.value.words())),
                }
            } else if let Some(section) = SECTIONS.iter().find(|section| section.name == entry.key) {
                if section.shape == Shape::Once {
                    singles.push((section, &entry.value));
                } else {
                    self.declare(section, entry);
                }
            } else {
                self.wrong(entry.at, unknown("key", &entry.key, &known));
            }
        }
        let variables = self.variables();
        let definitions = self.define(definitions);
        let top_entries: Vec<Entry> = top.iter().map(|(_, entry)| (*entry).clone()).collect();
        let top = self.fields(&Raw { at: 0, value: RawValue::Table(top_entries) }, &TOP, "the file");
        let single: Vec<(&'static str, Fields)> = singles
            .into_iter()
            .map(|(section, raw)| (section.name, self.fields(raw, &section.forms, &section.header())))
            .collect();
        if self.declared.iter().all(|own| !WITH_NODES.contains(&own.section.name)) {
            self.wrong(0, "the file has no [[body]], [[point]], [[beam]], [[cable]] or [[shell]]: nothing moves");
        }
        let mut items = Vec::new();
        for place in 0..self.declared.len() {
            let Declared { section, name, raw, .. } = &self.declared[place];
            let (section, name, raw) = (*section, name.clone(), raw.clone());
            let owner = match section.shape {
                Shape::Listed => format!("[[{}]] \"{name}\"", section.name),
                _ => format!("[{}.{name}]", section.name),
            };
            let fields = self.fields(&raw, &section.forms, &owner);
            items.push(Item { section: section.name, name, fields });
        }
        let variables =
            variables.into_iter().map(|(index, name)| Variable { fields: items[index].fields.clone(), name }).collect();
        let order = self.order(&items);
        Contents { top, variables, definitions, items, single, order }
    }

    /// Takes down the entries of a section with their names.
    fn declare(&mut self, section: &'static Section, entry: &Entry) {
        let entries: Result<Vec<(Raw, String)>, Mistake> = match (section.shape, &entry.value.value) {
            (Shape::Listed, RawValue::List(list)) if list.iter().all(|own| own.entries().is_some()) => {
                let name = |own: &Raw| own.get("name").and_then(|name| name.text()).unwrap_or_default().to_string();
                let all: Result<Vec<Vec<Raw>>, Mistake> = list.iter().map(repeated_entries).collect();
                all.map(|all| {
                    all.into_iter()
                        .flatten()
                        .map(|own| {
                            let name = name(&own);
                            (own, name)
                        })
                        .collect()
                })
            }
            (Shape::Named, RawValue::Table(named)) if named.iter().all(|own| own.value.entries().is_some()) => {
                let all: Result<Vec<Vec<Entry>>, Mistake> = named.iter().map(repeated_named).collect();
                let of_key = |own: Entry| (Raw { at: own.at, value: own.value.value }, own.key);
                all.map(|all| all.into_iter().flatten().map(of_key).collect())
            }
            _ => {
                let header = section.header();
                let text = format!("{} must be written as {header}; it is {}", section.name, entry.value.words());
                Err(Mistake::new(entry.at, text))
            }
        };
        let entries = match entries {
            Ok(entries) => entries,
            Err(mistake) => return self.mistakes.push(mistake),
        };
        for (raw, name) in entries {
            let at = raw.get("name").map_or(raw.at, |name| name.at);
            let space = name_space(section.name);
            if space != "drawing" && !name.is_empty() {
                if name == "ground" && space == "member" {
                    self.wrong(at, "the name \"ground\" belongs to the body that never moves and is there already");
                }
                if let Some(before) = self.by_name.insert((name.clone(), space), self.declared.len()) {
                    let other = self.declared[before].section.name;
                    self.wrong(at, format!("the name \"{name}\" is taken: there is a {other} with this name"));
                }
            }
            self.declared.push(Declared { section, name, at, raw });
        }
    }

    /// Design variables: their places among the entries, and their names for users.
    fn variables(&mut self) -> Vec<(usize, String)> {
        let mut list: Vec<(usize, String)> = Vec::new();
        for place in 0..self.declared.len() {
            let Declared { section, name, at, raw, .. } = &self.declared[place];
            if section.name != "variable" {
                continue;
            }
            let (own, at) = (name.clone(), *at);
            let shown = raw.get("name").and_then(|name| name.text()).unwrap_or(name).to_string();
            self.check_name(&own, at);
            if list.iter().any(|(_, other)| *other == shown) {
                self.wrong(at, format!("two design variables are named \"{shown}\""));
            }
            self.scope.add_variable(&own);
            list.push((place, shown));
        }
        list
    }

    fn check_name(&mut self, name: &str, at: usize) {
        if !is_name(name) {
            self.wrong(
                at,
                format!("\"{name}\" cannot be used in formulas: names there are letters, digits and _, and begin with no digit; a key `name` says what people read"),
            );
        } else if is_reserved(name) {
            self.wrong(at, format!("\"{name}\" means a function or constant in formulas; take another name"));
        }
    }

    /// Definitions in an order in which each depends on earlier ones only.
    fn define(&mut self, entries: &[Entry]) -> Vec<(usize, String, Expression)> {
        for (place, entry) in entries.iter().enumerate() {
            self.check_name(&entry.key, entry.at);
            let is_variable = self.by_name.contains_key(&(entry.key.clone(), "variable"));
            if is_variable || entries[..place].iter().any(|other| other.key == entry.key) {
                self.wrong(entry.at, format!("the name \"{}\" is taken by a design variable", entry.key));
            }
        }
        let places: HashMap<&str, usize> = entries.iter().enumerate().map(|(place, own)| (&*own.key, place)).collect();
        let needs: Vec<Vec<usize>> = entries
            .iter()
            .map(|entry| {
                let mut names = Vec::new();
                collect_names(&entry.value, &mut names);
                names.iter().filter_map(|name| places.get(&**name).copied()).collect()
            })
            .collect();
        let (order, circle) = ordered(&needs);
        if let Some(circle) = circle {
            let names: Vec<&str> = circle.iter().map(|&place| &*entries[place].key).collect();
            let at = entries[circle[0]].value.at;
            self.wrong(at, format!("the definition of \"{}\" leads back to itself: {}", names[0], names.join(" -> ")));
            return Vec::new();
        }
        let mut definitions = Vec::new();
        for place in order {
            let Entry { key, value, .. } = &entries[place];
            let what = format!("{key} of [define]");
            let formula = match &value.value {
                RawValue::List(_) => self.vector(value, &what),
                RawValue::Text(..) | RawValue::Number { .. } => self.formula(value, &what, None),
                _ => {
                    let words = value.words();
                    self.wrong(value.at, format!("{what} must be a number, a formula or a vector; it is {words}"));
                    None
                }
            };
            // what is wrong is told once, not by all that use it
            let formula = formula.unwrap_or_else(|| match &value.value {
                RawValue::List(_) => Expression::vector([1.0, 0.0, 0.0].map(Expression::literal)),
                _ => Expression::literal(1.0),
            });
            self.scope.add_formula(key, &formula);
            definitions.push((value.at, key.clone(), formula));
        }
        definitions
    }

    /// The values of a table.
    fn fields(&mut self, raw: &Raw, forms: &'static Forms, owner: &str) -> Fields {
        let mut fields = Fields { at: raw.at, form: "", values: Vec::new() };
        let Some(entries) = raw.entries() else {
            self.wrong(raw.at, format!("{owner} must be a table; it is {}", raw.words()));
            return fields;
        };
        let form = if forms.have_types() { self.form(raw, forms, owner) } else { forms.forms.first() };
        let Some(form) = form else { return fields };
        fields.form = form.name;
        let keys = || forms.common.iter().chain(form.keys);
        for entry in entries {
            let is_type = forms.have_types() && entry.key == "type";
            if is_type {
                continue;
            }
            let Some(key) = keys().find(|key| key.name == entry.key) else {
                let mut known: Vec<String> = keys().map(|key| key.name.into()).collect();
                if forms.have_types() {
                    known.insert(0, "type".into());
                }
                let of = if form.name.is_empty() { owner.to_string() } else { format!("{owner} of type {}", form.name) };
                let text = unknown("key", &entry.key, &known);
                self.wrong(entry.at, format!("{of}: {text}"));
                continue;
            };
            if let Some(value) = self.value(&entry.value, key, &key.takes, owner) {
                fields.values.push((key.name, entry.value.at, value));
            }
        }
        for key in keys().filter(|key| key.is_needed && !entries.iter().any(|entry| entry.key == key.name)) {
            self.wrong(raw.at, format!("{owner} needs the key {}: {}", key.name, key.doc));
        }
        fields
    }

    fn form(&mut self, raw: &Raw, forms: &'static Forms, owner: &str) -> Option<&'static Form> {
        let known = || forms.forms.iter().map(|form| form.name.to_string()).collect::<Vec<_>>();
        let Some(given) = raw.get("type") else {
            self.wrong(raw.at, format!("{owner} needs the key type: one of {}", known().join(", ")));
            return None;
        };
        let Some(name) = given.text() else {
            self.wrong(given.at, format!("type of {owner} must be a text; it is {}", given.words()));
            return None;
        };
        let form = forms.forms.iter().find(|form| form.name == name);
        if form.is_none() {
            let text = unknown("type", name, &known());
            self.wrong(given.at, format!("{owner}: {text}"));
        }
        form
    }

    fn not(&mut self, raw: &Raw, key: &Key, owner: &str, wanted: &str) {
        self.wrong(raw.at, format!("{} of {owner} must be {wanted}; it is {}", key.name, raw.words()));
    }

    fn value(&mut self, raw: &Raw, key: &Key, takes: &Type, owner: &str) -> Option<Value> {
        let what = format!("{} of {owner}", key.name);
        let list = || match &raw.value {
            RawValue::List(list) => Some(list.as_slice()),
            _ => None,
        };
        match *takes {
            Type::Number(_, range) => Some(Value::Formula(self.formula(raw, &what, Some(range))?, range)),
            Type::Fixed(_, range) => self.fixed(raw, &what, range).map(Value::Fixed),
            Type::Vector(_) => Some(Value::Formula(self.vector(raw, &what)?, Range::Any)),
            Type::Numbers(counts, _, range) => {
                let words: Vec<String> = counts.iter().map(ToString::to_string).collect();
                match list().filter(|list| counts.contains(&list.len())) {
                    Some(list) => self.numbers(list, &what, range),
                    None => {
                        self.not(raw, key, owner, &format!("a list of {} numbers or formulas", words.join(" or ")));
                        None
                    }
                }
            }
            Type::Series(_) => match list().filter(|list| !list.is_empty()) {
                Some(list) => self.numbers(list, &what, Range::Any),
                None => {
                    self.not(raw, key, owner, "a list of numbers or formulas");
                    None
                }
            },
            Type::OneOrMore(_, range) => match list() {
                Some([]) => {
                    self.not(raw, key, owner, "a number or a list of numbers");
                    None
                }
                Some(list) => self.numbers(list, &what, range),
                None => {
                    let formula = self.formula(raw, &what, Some(range))?;
                    Some(Value::List(vec![(raw.at, Value::Formula(formula, range))]))
                }
            },
            Type::Fixeds(count, _) => {
                match list().filter(|list| if count == 0 { list.len() > 1 } else { list.len() == count }) {
                    Some(list) => {
                        let own: Vec<_> = list.iter().map(|raw| (raw.at, self.fixed(raw, &what, Range::Any))).collect();
                        own.into_iter()
                            .map(|(at, value)| Some((at, Value::Fixed(value?))))
                            .collect::<Option<_>>()
                            .map(Value::List)
                    }
                    None => {
                        let number = if count == 0 { "two or more".into() } else { count.to_string() };
                        self.not(raw, key, owner, &format!("a list of {number} numbers"));
                        None
                    }
                }
            }
            Type::Points => match list().filter(|list| list.len() > 1) {
                Some(list) => {
                    let own: Vec<_> = list.iter().map(|raw| (raw.at, self.vector(raw, &what))).collect();
                    let value =
                        |(at, formula): (usize, Option<Expression>)| Some((at, Value::Formula(formula?, Range::Any)));
                    own.into_iter().map(value).collect::<Option<_>>().map(Value::List)
                }
                None => {
                    self.not(raw, key, owner, "a list of two or more vectors");
                    None
                }
            },
            Type::Count(least, most) => self.count(raw, &what, [least, most]).map(Value::Count),
            Type::Counts(count, least, most) => match list().filter(|list| list.len() == count) {
                Some(list) => {
                    let own: Vec<_> = list.iter().map(|raw| (raw.at, self.count(raw, &what, [least, most]))).collect();
                    own.into_iter()
                        .map(|(at, value)| Some((at, Value::Count(value?))))
                        .collect::<Option<_>>()
                        .map(Value::List)
                }
                None => {
                    self.not(raw, key, owner, &format!("a list of {count} whole numbers"));
                    None
                }
            },
            Type::Flag => match raw.value {
                RawValue::Flag(flag) => Some(Value::Flag(flag)),
                _ => {
                    self.not(raw, key, owner, "true or false");
                    None
                }
            },
            Type::Text => match raw.text() {
                Some("") => {
                    self.wrong(raw.at, format!("{what} is empty; give it some letters"));
                    None
                }
                Some(text) => Some(Value::Text(text.into())),
                None => {
                    self.not(raw, key, owner, "a text");
                    None
                }
            },
            Type::Texts => match list().filter(|list| list.iter().all(|own| own.text().is_some())) {
                Some(list) => {
                    let texts = list.iter().map(|own| (own.at, Value::Text(own.text().unwrap_or_default().into())));
                    Some(Value::List(texts.collect()))
                }
                None => {
                    self.not(raw, key, owner, "a list of texts");
                    None
                }
            },
            Type::Weights => match raw.entries().filter(|entries| !entries.is_empty()) {
                Some(entries) => {
                    let own: Vec<_> = entries
                        .iter()
                        .map(|own| Some((own.key.clone(), self.fixed(&own.value, &what, Range::Any)?)))
                        .collect();
                    own.into_iter().collect::<Option<_>>().map(Value::Weights)
                }
                None => {
                    self.not(
                        raw,
                        key,
                        owner,
                        "a table of names with numbers, as in { mass = 1.0, \"largest moment\" = 0.5 }",
                    );
                    None
                }
            },
            Type::Choice(words) => self.choice(raw, &what, words).map(|word| Value::Text(word.into())),
            Type::Choices(words) => {
                let own = std::slice::from_ref(raw);
                let list = list().unwrap_or(own);
                let chosen: Vec<_> = list.iter().map(|own| (own.at, self.choice(own, &what, words))).collect();
                chosen
                    .into_iter()
                    .map(|(at, word)| Some((at, Value::Text(word?.into()))))
                    .collect::<Option<_>>()
                    .map(Value::List)
            }
            Type::Node => self.node(raw, &what, false).map(Value::Node),
            Type::Nodes(count) => match list().filter(|list| list.len() == count) {
                Some(list) => self.node_list(list, &what, false),
                None => {
                    self.not(raw, key, owner, &format!("a list of {count} nodes, as in [\"ground\", \"crank\"]"));
                    None
                }
            },
            Type::NodeSets => match list() {
                Some(list) => self.node_list(list, &what, true),
                None => {
                    self.not(raw, key, owner, "a list of nodes, edges and ends, as in [\"plate.first_start\"]");
                    None
                }
            },
            Type::Item(sections) => self.item(raw, &what, sections).map(Value::Item),
            Type::Items(sections) => {
                let own = std::slice::from_ref(raw);
                let list = list().unwrap_or(own);
                let found: Vec<_> = list.iter().map(|own| (own.at, self.item(own, &what, sections))).collect();
                found.into_iter().map(|(at, item)| Some((at, Value::Item(item?)))).collect::<Option<_>>().map(Value::List)
            }
            Type::Table(forms) => Some(Value::Fields(self.fields(raw, forms, &what))),
            Type::Tables(forms) => match list() {
                Some(list) => Some(Value::List(
                    list.iter().map(|own| (own.at, Value::Fields(self.fields(own, forms, &what)))).collect(),
                )),
                None => {
                    self.not(raw, key, owner, "a list of tables");
                    None
                }
            },
            Type::Function(_, forms) => match raw.value {
                RawValue::Table(_) => Some(Value::Fields(self.fields(raw, forms, &what))),
                _ => Some(Value::Formula(self.formula(raw, &what, Some(Range::Any))?, Range::Any)),
            },
            Type::OfTime => {
                let scope = self.scope.with_time();
                let own = std::mem::replace(&mut self.scope, scope);
                let formula = self.formula(raw, &what, Some(Range::Any));
                self.scope = own;
                Some(Value::Formula(formula?, Range::Any))
            }
            Type::Over(words, forms) => match raw.value {
                RawValue::Table(_) => Some(Value::Fields(self.fields(raw, forms, &what))),
                _ => self.choice(raw, &what, words).map(|word| Value::Text(word.into())),
            },
        }
    }

    fn numbers(&mut self, list: &[Raw], what: &str, range: Range) -> Option<Value> {
        let own: Vec<_> = list.iter().map(|raw| (raw.at, self.formula(raw, what, Some(range)))).collect();
        own.into_iter()
            .map(|(at, formula)| Some((at, Value::Formula(formula?, range))))
            .collect::<Option<_>>()
            .map(Value::List)
    }

    /// A number or formula; of a number where a range is given.
    fn formula(&mut self, raw: &Raw, what: &str, range: Option<Range>) -> Option<Expression> {
        let formula = match &raw.value {
            RawValue::Number { value, .. } if value.is_finite() => Expression::literal(*value),
            RawValue::Number { value, .. } => {
                self.wrong(raw.at, format!("{what} is {value}; it must be finite"));
                return None;
            }
            RawValue::Text(text, place) => match Expression::parse(text, &self.scope) {
                Ok(formula) => formula,
                Err((inside, why)) => {
                    self.wrong(place.map_or(raw.at, |at| at + inside), format!("{what}, \"{text}\": {why}"));
                    return None;
                }
            },
            _ => {
                self.wrong(raw.at, format!("{what} must be a number or a formula; it is {}", raw.words()));
                return None;
            }
        };
        let Some(range) = range else { return Some(formula) };
        if formula.is_vector {
            self.wrong(raw.at, format!("{what} must be a number; {} is a vector", raw.words()));
            return None;
        }
        if let Some(Quantity::Number(value)) = formula.constant(&self.scope)
            && !(range.holds(value) && value.is_finite())
        {
            self.wrong(raw.at, format!("{what} is {value}; it must be {}", range.words()));
            return None;
        }
        Some(formula)
    }

    fn vector(&mut self, raw: &Raw, what: &str) -> Option<Expression> {
        match &raw.value {
            RawValue::List(list) if list.len() == 3 => {
                let own: Vec<_> = list.iter().map(|raw| self.formula(raw, what, Some(Range::Any))).collect();
                let own: Vec<Expression> = own.into_iter().collect::<Option<_>>()?;
                own.try_into().ok().map(Expression::vector)
            }
            RawValue::Text(text, _) => {
                let formula = self.formula(raw, what, None)?;
                if !formula.is_vector {
                    self.wrong(raw.at, format!("{what} must be a vector; the formula \"{text}\" gives a number"));
                    return None;
                }
                Some(formula)
            }
            _ => {
                self.wrong(
                    raw.at,
                    format!("{what} must be a vector [x, y, z] or a formula that gives one; it is {}", raw.words()),
                );
                None
            }
        }
    }

    fn fixed(&mut self, raw: &Raw, what: &str, range: Range) -> Option<f64> {
        let formula = self.formula(raw, what, Some(range))?;
        match formula.constant(&self.scope) {
            Some(Quantity::Number(value)) => Some(value),
            _ => {
                self.wrong(
                    raw.at,
                    format!("{what} depends on a design variable by {}; it must be a number that stays", raw.words()),
                );
                None
            }
        }
    }

    fn count(&mut self, raw: &Raw, what: &str, [least, most]: [usize; 2]) -> Option<usize> {
        let value = match &raw.value {
            RawValue::Number { value, whole: true } => Some(*value),
            // a loop leaves digits
            RawValue::Text(text, None) => text.parse().ok(),
            _ => None,
        };
        let allowed = if least == most { format!("{least}") } else { format!("a whole number from {least} to {most}") };
        match value.filter(|value| (least as f64..=most as f64).contains(value)) {
            Some(value) => Some(value as usize),
            None => {
                self.wrong(raw.at, format!("{what} must be {allowed}; it is {}", raw.words()));
                None
            }
        }
    }

    fn choice(&mut self, raw: &Raw, what: &str, words: &'static [&'static str]) -> Option<&'static str> {
        let known: Vec<String> = words.iter().map(ToString::to_string).collect();
        let Some(text) = raw.text() else {
            self.wrong(raw.at, format!("{what} must be one of {}; it is {}", known.join(", "), raw.words()));
            return None;
        };
        let found = words.iter().copied().find(|word| *word == text);
        if found.is_none() {
            let text = unknown("value", text, &known);
            self.wrong(raw.at, format!("{what}: {text}"));
        }
        found
    }

    /// Names of the entries of some sections.
    fn names_of(&self, sections: &[&str]) -> Vec<String> {
        let own = self.declared.iter().filter(|own| sections.contains(&own.section.name) && !own.name.is_empty());
        own.map(|own| own.name.clone()).collect()
    }

    fn find(&self, name: &str, sections: &[&str]) -> Option<usize> {
        sections.iter().find_map(|section| {
            let place = self.by_name.get(&(name.to_string(), name_space(section)))?;
            (self.declared[*place].section.name == *section).then_some(*place)
        })
    }

    fn item(&mut self, raw: &Raw, what: &str, sections: &[&str]) -> Option<usize> {
        let wanted = sections.join(", ");
        let Some(name) = raw.text() else {
            self.wrong(raw.at, format!("{what} must be the name of a {wanted}; it is {}", raw.words()));
            return None;
        };
        let found = self.find(name, sections);
        if found.is_none() {
            let known = unknown(sections[0], name, &self.names_of(sections));
            let other = self.declared.iter().find(|own| own.name == name);
            let text = match other {
                Some(other) => {
                    let names = self.names_of(sections);
                    let there =
                        if names.is_empty() { "there is none".into() } else { format!("there are: {}", names.join(", ")) };
                    format!(
                        "\"{name}\" is a {}, and a {} is wanted here; {there}",
                        other.section.name,
                        sections.join(" or ")
                    )
                }
                None => known,
            };
            self.wrong(raw.at, format!("{what}: {text}"));
        }
        found
    }

    fn node_list(&mut self, list: &[Raw], what: &str, sets: bool) -> Option<Value> {
        let own: Vec<_> = list.iter().map(|raw| (raw.at, self.node(raw, what, sets))).collect();
        own.into_iter().map(|(at, node)| Some((at, Value::Node(node?)))).collect::<Option<_>>().map(Value::List)
    }

    fn node(&mut self, raw: &Raw, what: &str, sets: bool) -> Option<NodePlace> {
        let Some(text) = raw.text() else {
            self.wrong(raw.at, format!("{what} must be the name of a node; it is {}", raw.words()));
            return None;
        };
        if text == "ground" {
            return Some(NodePlace { item: None, edge: None, index: Vec::new() });
        }
        let (name, edge, index) = match self.find(text, WITH_NODES) {
            Some(_) => (text, None, Vec::new()),
            None => {
                let (front, index) = divided(text);
                match self.find(front, WITH_NODES) {
                    Some(_) => (front, None, index),
                    None => match front.rsplit_once('.') {
                        Some((name, edge)) if self.find(name, WITH_NODES).is_some() => (name, Some(edge), index),
                        _ => (front, None, index),
                    },
                }
            }
        };
        let Some(place) = self.find(name, WITH_NODES) else {
            let mut known = self.names_of(WITH_NODES);
            known.push("ground".into());
            let text = match self.declared.iter().find(|own| own.name == name) {
                Some(other) => {
                    format!("\"{name}\" is a {}, which is no node; known: {}", other.section.name, known.join(", "))
                }
                None => unknown("node", name, &known),
            };
            self.wrong(raw.at, format!("{what}: {text}"));
            return None;
        };
        let section = self.declared[place].section.name;
        // names of ends and edges, and how many numbers stand behind the name and behind them
        let (edges, own, of_edge): (&[&'static str], usize, usize) = match section {
            "beam" | "cable" => (&["start", "end"], 1, 0),
            "shell" => (&["first_start", "first_end", "second_start", "second_end"], 2, 1),
            "thin_walls" => (&["start", "end"], 0, 1),
            "sphere" => (&[], 3, 0),
            _ => (&[], 0, 0),
        };
        let found = edge.map(|edge| edges.iter().copied().find(|own| *own == edge));
        let right = match (found, index.len()) {
            (None, count) => count == own && (count > 0 || edges.is_empty()),
            (Some(None), _) => false,
            (Some(Some(_)), 0) => sets || of_edge == 0,
            (Some(Some(_)), count) => count == of_edge,
        };
        if !right {
            let numbers = |count| ["", "[i]", "[i, j]", "[face, i, j]"][count];
            let mut ways: Vec<String> = Vec::new();
            if own > 0 || edges.is_empty() {
                ways.push(format!("{name}{}", numbers(own)));
            }
            for edge in edges {
                if sets && of_edge > 0 {
                    ways.push(format!("{name}.{edge}"));
                }
                ways.push(format!("{name}.{edge}{}", numbers(of_edge)));
            }
            self.wrong(
                raw.at,
                format!("{what}: \"{text}\" is no node of the {section} \"{name}\"; there are: {}", ways.join(", ")),
            );
            return None;
        }
        Some(NodePlace { item: Some(place), edge: found.flatten(), index })
    }

    /// What others refer to comes before these, and otherwise the order of the file is kept.
    fn order(&mut self, items: &[Item]) -> Vec<usize> {
        let needs: Vec<Vec<usize>> = items
            .iter()
            .map(|item| {
                let mut needs = Vec::new();
                item.fields.values.iter().for_each(|(_, _, value)| collect_items(value, &mut needs));
                needs
            })
            .collect();
        let mut by_file: Vec<usize> = (0..items.len()).collect();
        // entries of a loop stand at one place
        by_file.sort_by_key(|&place| items[place].fields.at);
        let renumbered: Vec<usize> = {
            let mut places = vec![0; items.len()];
            by_file.iter().enumerate().for_each(|(rank, &place)| places[place] = rank);
            places
        };
        let ranked: Vec<Vec<usize>> =
            by_file.iter().map(|&place| needs[place].iter().map(|&need| renumbered[need]).collect()).collect();
        let (order, circle) = ordered(&ranked);
        if let Some(circle) = circle {
            let names: Vec<&str> = circle.iter().map(|&rank| &*items[by_file[rank]].name).collect();
            let at = items[by_file[circle[0]]].fields.at;
            self.wrong(at, format!("\"{}\" needs itself to be there: {}", names[0], names.join(" -> ")));
        }
        order.into_iter().map(|rank| by_file[rank]).collect()
    }
}

/// `plate[2, 3]` as `plate` and its numbers; what is no such thing stays as it is.
fn divided(text: &str) -> (&str, Vec<usize>) {
    let inside = text.strip_suffix(']').and_then(|front| front.rsplit_once('['));
    let numbers =
        inside.and_then(|(_, list)| list.split(',').map(|own| own.trim().parse().ok()).collect::<Option<Vec<_>>>());
    match (inside, numbers) {
        (Some((name, _)), Some(numbers)) => (name.trim_end(), numbers),
        _ => (text, Vec::new()),
    }
}

fn collect_names(raw: &Raw, names: &mut Vec<String>) {
    match &raw.value {
        RawValue::Text(text, _) => names.extend(names_in(text)),
        RawValue::List(list) => list.iter().for_each(|own| collect_names(own, names)),
        _ => {}
    }
}

fn collect_items(value: &Value, items: &mut Vec<usize>) {
    match value {
        Value::Item(item) => items.push(*item),
        Value::Node(NodePlace { item: Some(item), .. }) => items.push(*item),
        Value::Fields(fields) => fields.values.iter().for_each(|(_, _, own)| collect_items(own, items)),
        Value::List(list) => list.iter().for_each(|(_, own)| collect_items(own, items)),
        _ => {}
    }
}

/// An order in which each comes after what it needs, else by number, and a circle if there is one.
fn ordered(needs: &[Vec<usize>]) -> (Vec<usize>, Option<Vec<usize>>) {
    let (mut order, mut done) = (Vec::new(), vec![false; needs.len()]);
    // a place and how many of its needs have been looked at
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut on_path = vec![false; needs.len()];
    for first in 0..needs.len() {
        if done[first] {
            continue;
        }
        path.push((first, 0));
        on_path[first] = true;
        while let Some((place, looked)) = path.last_mut() {
            let place = *place;
            match needs[place].get(*looked) {
                Some(&need) => {
                    *looked += 1;
                    if on_path[need] {
                        let from = path.iter().position(|own| own.0 == need).unwrap_or(0);
                        let mut circle: Vec<usize> = path[from..].iter().map(|own| own.0).collect();
                        circle.push(need);
                        return (order, Some(circle));
                    }
                    if !done[need] {
                        on_path[need] = true;
                        path.push((need, 0));
                    }
                }
                None => {
                    done[place] = true;
                    on_path[place] = false;
                    order.push(place);
                    path.pop();
                }
            }
        }
    }
    (order, None)
}
