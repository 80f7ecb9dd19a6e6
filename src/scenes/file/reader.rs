//! From the tree of a TOML text, by the tables of keys, to entries with checked values.

use super::elsewhere::unknown_or_elsewhere;
use super::fields::{Each, Fields, Item};
use super::formula::{Formula, Scope, is_name, meaning, names_in};
use super::keys::MANY;
use super::mistake::Mistake;
use super::order::ordered;
use super::own_parts::{OwnParts, all_forms};
use super::raw::{KeyValue, Raw, RawValue, Wholes, loop_names};
use super::section::{Section, Shape};
use super::sections::{DEFINE, SECTIONS, TOP};
use super::tables::TABLES;
use crate::elements::entries::{Form, Forms};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, Debug)]
pub(super) struct Variable {
    /// Its entry.
    pub item: usize,
    /// What users call it.
    pub name: String,
    /// Of one that has several numbers of the design: those behind its name, NAME\[0\] and so on.
    pub numbers: Vec<usize>,
    /// Of one that has a number for each face or node of a mesh.
    pub each: Option<Each>,
}

#[derive(Clone, Debug)]
pub(super) struct Contents {
    pub top: Fields,
    pub variables: Vec<Variable>,
    /// After the variables, in an order in which each depends on others before it only, with their places and names.
    pub definitions: Vec<(usize, String, Formula)>,
    pub items: Vec<Item>,
    /// Sections that occur once.
    pub single: Vec<(&'static str, Fields)>,
    /// Entries in the order of the file, but what others refer to before these.
    pub order: Vec<usize>,
    /// Parts beside those of the library.
    pub own: Arc<OwnParts>,
}

/// A file while it is read.
#[derive(Default)]
pub(super) struct Reader {
    /// Where files stand whose paths are not absolute.
    pub folder: PathBuf,
    /// The entry that is read.
    pub current: Option<usize>,
    /// Whole numbers that counts may use.
    pub wholes: Wholes,
    /// Nodes of its formulas that outputs of its nodes bring with them.
    pub brought: Vec<KeyValue>,
    pub scope: Scope,
    /// Entries, whose values are read when all their names are known.
    pub declared: Vec<Item>,
    pub raws: Vec<Raw>,
    /// Entries by their names, one of each space.
    pub by_name: HashMap<String, Vec<usize>>,
    /// An entry could not be read, so that its names are not known: those who use them would only repeat it.
    pub names_are_missing: bool,
    /// Parts beside those of the library.
    pub own: Arc<OwnParts>,
    pub mistakes: Vec<Mistake>,
}

/// Reads a whole file; paths in it begin at a folder. Parts of one's own are known by their names.
pub(super) fn read(root: &Raw, folder: &Path, own: &OwnParts) -> Result<Contents, Vec<Mistake>> {
    let mut reader =
        Reader { folder: folder.into(), scope: Scope::of_file(), own: Arc::new(own.clone()), ..Reader::default() };
    let contents = reader.contents(root);
    if reader.mistakes.is_empty() { Ok(contents) } else { Err(reader.mistakes) }
}

impl Contents {
    pub fn functionals(&self) -> impl Iterator<Item = &str> {
        self.items.iter().filter(|item| item.section.name == "functional").map(|item| item.name.as_str())
    }
}

impl Reader {
    pub(super) fn wrong(&mut self, at: usize, what: impl Into<String>) {
        self.mistakes.push(Mistake::new(at, what));
    }

    /// The same where a value was wanted.
    pub(super) fn refuse<T>(&mut self, at: usize, what: impl Into<String>) -> Option<T> {
        self.wrong(at, what);
        None
    }

    fn contents(&mut self, root: &Raw) -> Contents {
        self.scope.loops = loop_names(root);
        self.wholes = Wholes::of(root);
        let has_names =
            |key: &str| key == DEFINE.0 || SECTIONS.iter().any(|own| own.name == key && own.shape == Shape::Named);
        let repeated = root
            .table()
            .unwrap_or_default()
            .iter()
            .map(|own| own.with(own.value.repeated(has_names(&own.key), &self.wholes, &mut self.mistakes)));
        let entries: &[KeyValue] = &repeated.collect::<Vec<_>>();
        self.names_are_missing = !self.mistakes.is_empty();
        let (mut top, mut singles): (Vec<KeyValue>, Vec<(&'static Section, &Raw)>) = (Vec::new(), Vec::new());
        let (mut definitions, mut tables): (&[KeyValue], &[KeyValue]) = (&[], &[]);
        for entry in entries {
            match SECTIONS.iter().find(|section| section.name == entry.key) {
                None if TOP.keys("").any(|key| key.name == entry.key) => top.push(entry.clone()),
                None if entry.key == DEFINE.0 => {
                    let own = entry.value.table().or_else(|| self.not(&entry.value, "[define]", "a table"));
                    definitions = own.unwrap_or_default();
                }
                None => {
                    let known =
                        TOP.keys("").map(|key| key.name).chain([DEFINE.0]).chain(SECTIONS.iter().map(|own| own.name));
                    let known: Vec<String> = known.map(String::from).collect();
                    self.wrong(entry.at, unknown_or_elsewhere("key", &entry.key, &known));
                }
                Some(section) if section.name == TABLES.name => {
                    let own = entry.value.table().or_else(|| self.not(&entry.value, "[table.NAME]", "tables with names"));
                    tables = own.unwrap_or_default();
                }
                Some(section) if section.shape == Shape::Once => singles.push((section, &entry.value)),
                Some(section) => self.declare(section, entry),
            }
        }
        self.meshes();
        let variables = self.variables();
        let definitions = self.define(definitions, tables);
        let top = self.fields(&Raw { at: root.at, value: RawValue::Table(top) }, &TOP, "the file");
        let single: Vec<(&'static str, Fields)> = singles
            .into_iter()
            .map(|(section, raw)| (section.name, self.fields(raw, &section.forms, &section.header())))
            .collect();
        if !self.names_are_missing && self.declared.iter().all(|own| own.section.nodes.is_none()) {
            self.wrong(
                root.at,
                "the file has no [[body]], [[point]], [[beam]], [[cable]], [[shell]] or [[mesh]]: nothing moves",
            );
        }
        for place in 0..self.declared.len() {
            let (raw, Item { section, name, .. }) = (self.raws[place].clone(), &self.declared[place]);
            let owner = match section.shape {
                Shape::Listed => format!("[[{}]] \"{name}\"", section.name),
                _ => format!("[{}.{name}]", section.name),
            };
            let section = *section;
            self.current = Some(place);
            self.scope.of_section = section.name == "section";
            let scope = self.scope_with_nodes(place, &raw);
            let mut fields = self.fields(&raw, &section.forms, &owner);
            if section.name == "state" {
                self.take_law(&raw, &mut fields);
            }
            if section.name == "measurement" {
                fields = self.with_columns(fields);
            }
            self.scope = scope.unwrap_or_else(|| std::mem::take(&mut self.scope));
            self.declared[place].fields = fields;
        }
        let items = std::mem::take(&mut self.declared);
        let order = self.order(&items);
        Contents { top, variables, definitions, items, single, order, own: self.own.clone() }
    }

    /// Takes down the entries of a section with their names.
    fn declare(&mut self, section: &'static Section, entry: &KeyValue) {
        let entries: Vec<(String, Raw)> = match (section.shape, &entry.value.value) {
            (Shape::Listed, RawValue::List(list)) if list.iter().all(|own| own.table().is_some()) => {
                let name = |own: &Raw| own.get("name").and_then(Raw::text).unwrap_or_default().to_string();
                list.iter().map(|own| (name(own), own.clone())).collect()
            }
            (Shape::Named, RawValue::Table(named)) if named.iter().all(|own| own.value.table().is_some()) => {
                named.iter().map(|own| (own.key.clone(), Raw { at: own.at, value: own.value.value.clone() })).collect()
            }
            _ => {
                let (header, is) = (section.header(), entry.value.words());
                self.names_are_missing = true;
                return self.wrong(entry.at, format!("{} must be written as {header}; it is {is}", section.name));
            }
        };
        for (name, raw) in entries {
            let at = raw.get("name").map_or(raw.at, |name| name.at);
            if name.contains(char::is_control) {
                let text =
                    "has a line break or another control character, which tables and pictures cannot show; leave it out";
                self.wrong(at, format!("the name {name:?} {text}"));
            }
            let space = section.space;
            if !space.is_empty() && !name.is_empty() {
                if name == "ground" && space == "member" {
                    self.wrong(at, "the name \"ground\" belongs to the body that never moves and is there already");
                }
                let named = self.by_name.entry(name.clone()).or_default();
                let before = named.iter().position(|&place| self.declared[place].section.space == space);
                if let Some(before) = before.map(|before| named.remove(before)) {
                    let other = self.declared[before].section.name;
                    self.wrong(at, format!("the name \"{name}\" is taken: there is a {other} with this name"));
                }
                self.by_name.entry(name.clone()).or_default().push(self.declared.len());
            }
            let (place, fields) = (self.declared.len(), Fields::none(at));
            self.declared.push(Item { place, section, name, fields, mesh: None });
            self.raws.push(raw);
        }
    }

    /// Design variables, which formulas know from here on.
    fn variables(&mut self) -> Vec<Variable> {
        let mut list: Vec<Variable> = Vec::new();
        for place in 0..self.declared.len() {
            let Item { section, name, fields, .. } = &self.declared[place];
            if section.name != "variable" {
                continue;
            }
            let (own, at, raw) = (name.clone(), fields.at, self.raws[place].clone());
            let shown = raw.get("name").and_then(|name| name.text()).unwrap_or(name).to_string();
            self.check_name(&own, at);
            if list.iter().any(|other| other.name == shown) {
                self.wrong(at, format!("two design variables are named \"{shown}\""));
            }
            let mut each = self.each(&raw);
            let count = raw.get("count");
            if let (Some(_), Some(count)) = (&each, count) {
                self.wrong(count.at, "a design variable has count, or per_face, or per_node");
                each = None;
            }
            // what is no such number is told where values are checked
            let count = count.and_then(|own| self.wholes.value(own, &[])?.try_into().ok()).filter(|own| MANY.contains(own));
            match (&each, count) {
                (Some(each), _) => self.scope.add_each(&own, each.mesh, &self.declared[each.mesh].name),
                (None, Some(count)) => self.scope.add_array(&own, count),
                (None, None) => self.scope.add_known(&own, false),
            }
            let numbers = each.as_ref().map_or((0..count.unwrap_or(0)).collect(), |each| each.numbers.clone());
            list.push(Variable { item: place, name: shown, numbers, each });
        }
        list
    }

    pub(super) fn check_name(&mut self, name: &str, at: usize) {
        if !is_name(name) {
            self.wrong(
                at,
                format!("\"{name}\" cannot be used in formulas: names there are letters, digits and _, and begin with no digit; a key `name` says what people read"),
            );
        } else if let Some(meaning) = meaning(name) {
            self.wrong(at, format!("\"{name}\" means {meaning}; take another name"));
        }
    }

    /// Definitions and tables in an order in which each depends on earlier ones only.
    fn define(&mut self, entries: &[KeyValue], tables: &[KeyValue]) -> Vec<(usize, String, Formula)> {
        // `"corner{k}" = { for = { k = [0, 1] }, value = .. }` stands for two
        let value = |own: &KeyValue| match own.value.table() {
            Some([only]) if only.key == "value" => only.value.clone(),
            _ => own.value.clone(),
        };
        let defined = entries.iter().map(|own| own.with(value(own)));
        let (first_table, entries): (usize, Vec<KeyValue>) =
            (entries.len(), defined.chain(tables.iter().cloned()).collect());
        for (place, entry) in entries.iter().enumerate() {
            self.check_name(&entry.key, entry.at);
            let by = match self.find(&entry.key, &["variable"]).is_some() {
                true => "a design variable",
                false if entries[..place].iter().any(|other| other.key == entry.key) => "another definition",
                false => continue,
            };
            self.wrong(entry.at, format!("the name \"{}\" is taken by {by}", entry.key));
        }
        let places: HashMap<&str, usize> = entries.iter().enumerate().map(|(place, own)| (&*own.key, place)).collect();
        let needs: Vec<Vec<usize>> = entries
            .iter()
            .map(|KeyValue { value, .. }| {
                let texts = value.get("values").or(value.table().is_none().then_some(value)).map(Raw::texts);
                let names = texts.into_iter().flatten().flat_map(names_in);
                names.filter_map(|name| places.get(&*name).copied()).collect()
            })
            .collect();
        let (order, circle) = ordered(0..needs.len(), &needs);
        if let Some(circle) = circle {
            let names: Vec<&str> = circle.iter().map(|&place| &*entries[place].key).collect();
            let at = entries[circle[0]].value.at;
            self.wrong(at, format!("the definition of \"{}\" leads back to itself: {}", names[0], names.join(" -> ")));
            return Vec::new();
        }
        let mut definitions = Vec::new();
        for place in order {
            if place >= first_table {
                self.take_table(&entries[place]);
                continue;
            }
            let KeyValue { key, value, .. } = &entries[place];
            let what = format!("{key} of [define]");
            let formula = match &value.value {
                RawValue::List(_) | RawValue::Text(..) | RawValue::Number { .. } => self.number_or_vector(value, &what),
                _ => self.not(value, &what, "a number, a formula, a vector, or { for = .., value = .. }"),
            };
            // what is wrong is told once, not by all that use it
            let formula = formula.unwrap_or_else(|| match &value.value {
                RawValue::List(_) => Formula::vector(&[1.0, 0.0, 0.0].map(Formula::literal)),
                _ => Formula::literal(1.0),
            });
            self.scope.add_value(key, &formula);
            definitions.push((value.at, key.clone(), formula));
        }
        definitions
    }

    pub(super) fn fields(&mut self, raw: &Raw, forms: &'static Forms, owner: &str) -> Fields {
        let mut fields = Fields::none(raw.at);
        let Some(entries) = raw.table().or_else(|| self.not(raw, owner, "a table")) else { return fields };
        let form = if forms.have_types() { self.form(raw, forms, owner) } else { forms.forms.first().copied() };
        let Some(form) = form else { return fields };
        fields.form = form.name;
        let keys = || forms.common.iter().chain(form.keys);
        for entry in entries.iter().filter(|entry| !(forms.have_types() && entry.key == "type")) {
            let Some(key) = keys().find(|key| key.name == entry.key) else {
                let mut known: Vec<String> = keys().map(|key| key.name.into()).collect();
                if forms.have_types() {
                    known.insert(0, "type".into());
                }
                let of = if forms.have_types() { format!("{owner} of type {}", form.name) } else { owner.to_string() };
                let text = unknown_or_elsewhere("key", &entry.key, &known);
                self.wrong(entry.at, format!("{of}: {text}"));
                continue;
            };
            if let Some(value) = self.value(&entry.value, &key.takes, &format!("{} of {owner}", key.name)) {
                fields.values.push((key.name, entry.value.at, value));
            }
        }
        for key in keys().filter(|key| key.is_needed && !entries.iter().any(|entry| entry.key == key.name)) {
            self.wrong(raw.at, format!("{owner} needs the key {}: {}", key.name, key.doc));
        }
        fields
    }

    fn form(&mut self, raw: &Raw, forms: &'static Forms, owner: &str) -> Option<Form> {
        let known = all_forms(forms, &self.own);
        let names = || known.iter().map(|form| form.name.to_string()).collect::<Vec<_>>();
        let Some(given) = raw.get("type") else {
            return self.refuse(raw.at, format!("{owner} needs the key type: one of {}", names().join(", ")));
        };
        let name = given.text().or_else(|| self.not(given, &format!("type of {owner}"), "a text"))?;
        let form = known.iter().find(|form| form.name == name).copied();
        form.or_else(|| self.refuse(given.at, format!("{owner}: {}", unknown_or_elsewhere("type", name, &names()))))
    }
}
