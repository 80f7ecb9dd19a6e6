//! Values by what their keys take.

use super::fields::{NamedNode, Value};
use super::formula::{Formula, OF_LAW, TIME, names_in};
use super::raw::{KeyValue, Raw, RawValue};
use super::reader::Reader;
use super::reference::many;
use crate::elements::entries::{Forms, Range, Type};
use crate::scenes::unknown;

fn uses(text: &str, name: &str) -> bool {
    names_in(text).iter().any(|own| own == name)
}

/// Largest number of a point or face of a mesh.
const MOST_POINTS: usize = 10_000_000;

impl Reader {
    /// Tells that a value is not what its key takes.
    pub(super) fn not<T>(&mut self, raw: &Raw, what: &str, wanted: &str) -> Option<T> {
        self.refuse(raw.at, format!("{what} must be {wanted}; it is {}", raw.words()))
    }

    /// The value of a key, where it is what the key takes; every mistake in it is told.
    pub(super) fn value(&mut self, raw: &Raw, takes: &Type, what: &str) -> Option<Value> {
        if let Some(array) = self.array(raw, takes) {
            return Some(array);
        }
        match *takes {
            Type::Number(_, range) => self.number(raw, what, range),
            Type::OfNodes(_) => self.number(raw, what, Range::Any),
            Type::OfMesh(_, range) => {
                self.scope.of_mesh = self.current;
                let own = self.number(raw, what, range);
                self.scope.of_mesh = None;
                own
            }
            Type::Strips(each) => {
                let of_section = std::mem::replace(&mut self.scope.of_section, true);
                let own = self.value(raw, &Type::OneOrMore(each), what);
                self.scope.of_section = of_section;
                own
            }
            Type::Fixed(_, range) => self.fixed(raw, what, range).map(Value::Fixed),
            Type::Count(least, most) => self.count(raw, what, [least, most]).map(Value::Count),
            Type::Vector(_) => Some(Value::Formula(self.vector(raw, what)?, Range::Any)),
            Type::Flag => match raw.value {
                RawValue::Flag(flag) => Some(Value::Flag(flag)),
                _ => self.not(raw, what, "true or false"),
            },
            Type::Text => self.text(raw, what),
            Type::Stl => self.surface(raw, what).map(Value::Surface),
            Type::Choice(words) => self.choice(raw, what, words),
            Type::Node => self.node(raw, what, false).map(Value::Node),
            Type::NodeSet => self.node(raw, what, true).map(Value::Node),
            Type::Item(sections) => self.item_or_group(raw, what, sections),
            Type::OneOrMore(Type::Number(..) | Type::Fixed(..)) if raw.list().is_some_and(<[Raw]>::is_empty) => {
                self.not(raw, what, "a number or a list of numbers")
            }
            Type::OneOrMore(each) => self.values(raw.one_or_more(), each, what),
            Type::Numbers(..) | Type::List(..) => self.list(raw, takes, what),
            Type::Columns => self.columns(raw, what),
            Type::Lists => self.lists(raw, what),
            Type::Table(forms) => Some(Value::Fields(self.fields(raw, forms, what))),
            Type::Over(_, forms) if raw.table().is_some() => Some(Value::Fields(self.fields(raw, forms, what))),
            Type::Over(words, forms) => self.over(raw, what, words, forms),
            Type::Function(_, forms) | Type::Law(_, forms) | Type::Energy(_, forms) if raw.table().is_some() => {
                let fields = self.fields(raw, forms, what);
                Some(Value::Fields(self.with_columns(fields)))
            }
            Type::Function(..) => self.number(raw, what, Range::Any),
            Type::Law(..) => self.formula_of(raw, what, &OF_LAW),
            Type::Energy(..) => self.formula_of(raw, what, &OF_LAW[..1]),
            Type::OfTime => self.formula_of(raw, what, &[TIME]),
            Type::Weights => self.weights(raw, what),
            Type::Selections => self.selections(raw, what),
            Type::NamedNodes(forms) => self.named_nodes(raw, forms, what),
            Type::NamedFormulas(_) => self.named_formulas(raw, what),
            // read with the names that formulas of the entry know
            Type::Definitions | Type::NamedTables(_) => Some(Value::List(Vec::new())),
        }
    }

    /// A list of values that are alike, as many as its type wants.
    fn list(&mut self, raw: &Raw, takes: &Type, what: &str) -> Option<Value> {
        let list = raw.list();
        let (each, is_right, words) = many(takes, list.map_or(0, <[Raw]>::len));
        let example = match each {
            Type::Node => ", as in [\"ground\", \"crank\"]",
            Type::NodeSet => ", as in [\"plate.first_start\"]",
            Type::Numbers(..) => ", as in [[0, 0], [1, 0]]",
            _ => "",
        };
        match list.filter(|_| is_right) {
            Some(list) => self.values(list, &each, what),
            None => self.not(raw, what, &format!("a list of {words}{example}")),
        }
    }

    fn values(&mut self, list: &[Raw], takes: &Type, what: &str) -> Option<Value> {
        self.all(list, |reader, own| Some((own.at, reader.value(own, takes, what)?))).map(Value::List)
    }

    /// What is read of each: of all of them, also after one that is wrong, so that every mistake is told.
    fn all<I, T>(&mut self, list: &[I], of: impl Fn(&mut Reader, &I) -> Option<T>) -> Option<Vec<T>> {
        let own: Vec<Option<T>> = list.iter().map(|own| of(self, own)).collect();
        own.into_iter().collect()
    }

    fn text(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        match raw.text() {
            Some("") => self.refuse(raw.at, format!("{what} is empty; give it some letters")),
            Some(text) => Some(Value::Text(text.into())),
            None => self.not(raw, what, "a text"),
        }
    }

    fn columns(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        let column = |own: &Raw| match &own.value {
            RawValue::Number { value, whole: true } if *value >= 1.0 => Some((own.at, Value::Count(*value as usize))),
            _ => own.text().map(|name| (own.at, Value::Text(name.into()))),
        };
        let list = raw.list().filter(|list| list.len() == 2);
        let columns = list.and_then(|list| list.iter().map(column).collect());
        let wanted = "two names or numbers of columns, as in [\"time\", \"height\"] or [1, 3]";
        columns.map(Value::List).or_else(|| self.not(raw, what, wanted))
    }

    fn lists(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        let Some(list) = raw.list().filter(|list| !list.is_empty()) else {
            return self.not(raw, what, "a list of lists of whole numbers, as in [[0, 1, 2, 3]]");
        };
        let of = |reader: &mut Reader, own: &Raw| {
            let numbers = reader.whole_numbers(own, what)?.into_iter();
            Some((own.at, Value::List(numbers.map(|number| (own.at, Value::Count(number))).collect())))
        };
        self.all(list, of).map(Value::List)
    }

    /// What is read of the entries of a table of names, which has some.
    pub(super) fn named<T>(
        &mut self,
        raw: &Raw,
        what: &str,
        wanted: &str,
        of: impl Fn(&mut Reader, &KeyValue) -> Option<T>,
    ) -> Option<Vec<T>> {
        let entries = raw.table().filter(|entries| !entries.is_empty());
        let entries = entries.or_else(|| self.not(raw, what, &format!("a table of names {wanted}")))?;
        self.all(entries, of)
    }

    fn weights(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        let wanted = "with numbers, as in { mass = 1.0, \"largest moment\" = 0.5 }";
        let of = |reader: &mut Reader, own: &KeyValue| Some((own.key.clone(), reader.fixed(&own.value, what, Range::Any)?));
        self.named(raw, what, wanted, of).map(Value::Weights)
    }

    fn named_formulas(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        let wanted = "with formulas, as in { tip = \"-c * tip.velocity\" }";
        let of = |reader: &mut Reader, own: &KeyValue| {
            Some((own.key.clone(), own.at, reader.number_or_vector(&own.value, what)?))
        };
        self.named(raw, what, wanted, of).map(Value::Formulas)
    }

    fn named_nodes(&mut self, raw: &Raw, forms: &'static Forms, what: &str) -> Option<Value> {
        let entries = raw.key_values();
        entries.iter().for_each(|own| self.check_name(&own.key, own.at));
        let wanted = "for formulas with nodes, as in { hub = \"rotor\", tip = \"blade.end\" }";
        let mut nodes = self.named(raw, what, wanted, |reader, own| reader.named_node(own, what, forms))?;
        let brought = std::mem::take(&mut self.brought);
        nodes.extend(self.all(&brought, |reader, own| reader.named_node(own, what, forms))?);
        Some(Value::NamedNodes(nodes))
    }

    /// Of selections by numbers; what they select was read with the mesh.
    fn selections(&mut self, raw: &Raw, what: &str) -> Option<Value> {
        let wanted =
            "a table of names with lists of whole numbers or conditions, as in { rim = [0, 1, 2], root = \"x < 1e-6\" }";
        let entries = raw.table().or_else(|| self.not(raw, what, wanted))?;
        self.all(entries, |reader, own| match own.value.text() {
            Some(_) => Some(()),
            None => reader.whole_numbers(&own.value, what).map(drop),
        })?;
        Some(Value::List(Vec::new()))
    }

    /// All numbers of a design variable that has several, where a list is wanted and its name stands.
    fn array(&self, raw: &Raw, takes: &Type) -> Option<Value> {
        let range = match *takes {
            Type::List(Type::Number(_, range), ..) | Type::OneOrMore(Type::Number(_, range)) => *range,
            _ => return None,
        };
        let places = self.scope.array(raw.text()?.trim())?;
        Some(Value::List(places.map(|place| (raw.at, Value::Formula(Formula::number(place), range))).collect()))
    }

    /// A node by the name that formulas give it, or a point of one.
    fn named_node(&mut self, own: &KeyValue, what: &str, forms: &'static Forms) -> Option<NamedNode> {
        let (name, at) = (own.key.clone(), own.at);
        if own.value.table().is_none() {
            return Some(NamedNode { name, at, place: self.node(&own.value, what, false)?, point: None });
        }
        let fields = self.fields(&own.value, forms, &format!("{what}, {name}"));
        match (fields.get("on"), fields.get("point")) {
            (Some((_, Value::Node(place))), Some((_, Value::Formula(point, _)))) => {
                Some(NamedNode { name, at, place: place.clone(), point: Some(point.clone()) })
            }
            _ => None,
        }
    }

    /// A formula of a number or of a vector, which may be a list of three.
    pub(super) fn number_or_vector(&mut self, raw: &Raw, what: &str) -> Option<Formula> {
        match raw.value {
            RawValue::List(_) => self.vector(raw, what),
            _ => self.formula(raw, what, None),
        }
    }

    /// A formula of some names beside those of the file.
    fn formula_of(&mut self, raw: &Raw, what: &str, names: &[&str]) -> Option<Value> {
        let hidden =
            names.iter().find(|&&name| self.scope.find(name).is_some() && raw.text().is_some_and(|text| uses(text, name)));
        if let Some(name) = hidden {
            let text = format!("{what}: {name} is what it depends on, and a name of this file, too: give that another name");
            return self.refuse(raw.at, text);
        }
        let scope = self.scope.with(names);
        let own = std::mem::replace(&mut self.scope, scope);
        let formula = self.number(raw, what, Range::Any);
        self.scope = own;
        formula
    }

    fn whole_numbers(&mut self, raw: &Raw, what: &str) -> Option<Vec<usize>> {
        let Some(list) = raw.list() else {
            return self.refuse(raw.at, format!("{what} must have lists of whole numbers; there is {}", raw.words()));
        };
        self.all(list, |reader, own| reader.count(own, what, [0, MOST_POINTS]))
    }

    fn number(&mut self, raw: &Raw, what: &str, range: Range) -> Option<Value> {
        Some(Value::Formula(self.formula(raw, what, Some(range))?, range))
    }

    /// A number or formula; of a number where a range is given.
    pub(super) fn formula(&mut self, raw: &Raw, what: &str, range: Option<Range>) -> Option<Formula> {
        let formula = match &raw.value {
            RawValue::Number { value, .. } if value.is_finite() => Formula::literal(*value),
            RawValue::Number { value, .. } => return self.refuse(raw.at, format!("{what} is {value}; it must be finite")),
            RawValue::Text(text, origin) => match origin.formula(text).and_then(|own| Formula::parse(own, &self.scope)) {
                Ok(formula) => formula,
                Err((inside, why)) => {
                    let at = origin.place().map_or(raw.at, |at| at + inside);
                    return self.refuse(at, format!("{what}, \"{text}\": {why}"));
                }
            },
            _ => return self.not(raw, what, "a number or a formula"),
        };
        let Some(range) = range else { return Some(formula) };
        if formula.is_vector() {
            return self.refuse(raw.at, format!("{what} must be a number; {} is a vector", raw.words()));
        }
        match formula.constant_number() {
            Some(value) if !(range.holds(value) && value.is_finite()) => {
                self.refuse(raw.at, format!("{what} is {value}; it must be {}", range.words()))
            }
            _ => Some(formula),
        }
    }

    pub(super) fn vector(&mut self, raw: &Raw, what: &str) -> Option<Formula> {
        match &raw.value {
            RawValue::List(list) if list.len() == 3 => {
                let own = self.all(list, |reader, own| reader.formula(own, what, Some(Range::Any)))?;
                own.try_into().ok().map(|own| Formula::vector(&own))
            }
            RawValue::Text(text, _) => {
                let formula = self.formula(raw, what, None)?;
                if !formula.is_vector() {
                    let text = format!("{what} must be a vector; the formula \"{text}\" gives a number");
                    return self.refuse(raw.at, text);
                }
                Some(formula)
            }
            _ => self.not(raw, what, "a vector [x, y, z] or a formula that gives one"),
        }
    }

    fn fixed(&mut self, raw: &Raw, what: &str, range: Range) -> Option<f64> {
        self.formula(raw, what, Some(range))?.constant_number().or_else(|| {
            let text = format!("{what} depends on a design variable by {}; it must be a number that stays", raw.words());
            self.refuse(raw.at, text)
        })
    }

    fn count(&mut self, raw: &Raw, what: &str, [least, most]: [usize; 2]) -> Option<usize> {
        let value = match &raw.value {
            RawValue::Number { value, whole: true } => Some(*value),
            RawValue::Text(..) => {
                let value = raw.formula().and_then(|own| Formula::parse(own, &self.scope).ok()?.constant_number());
                value.filter(|value| value.fract() == 0.0)
            }
            _ => None,
        };
        match value.filter(|value| (least as f64..=most as f64).contains(value)) {
            Some(value) => Some(value as usize),
            None if least == most => self.not(raw, what, &least.to_string()),
            None => self.not(raw, what, &format!("a whole number from {least} to {most}")),
        }
    }

    /// A word for what is made over time; who writes another is told the aggregates, which are tables.
    fn over(&mut self, raw: &Raw, what: &str, words: &[&str], forms: &'static Forms) -> Option<Value> {
        let text = raw.text().filter(|text| !words.contains(text));
        let Some(text) = text else { return self.choice(raw, what, words) };
        let kinds = forms.forms.iter().flat_map(|form| form.keys).find_map(|key| match key.takes {
            Type::Choice(kinds) if key.name == "aggregate" => Some(kinds.join(", ")),
            _ => None,
        });
        let text = format!(
            "{what}: value \"{text}\" is not known; known: {}, and for values near the largest a table, over = {{ aggregate = \
             \"upper_maximum\", sharpness = 50, size = 0.1 }} with the size of what is measured; its aggregates: {}",
            words.join(", "),
            kinds.unwrap_or_default()
        );
        self.refuse(raw.at, text)
    }

    fn choice(&mut self, raw: &Raw, what: &str, words: &[&str]) -> Option<Value> {
        let known: Vec<String> = words.iter().map(ToString::to_string).collect();
        let text = raw.text().or_else(|| self.not(raw, what, &format!("one of {}", known.join(", "))))?;
        match words.contains(&text) {
            true => Some(Value::Text(text.into())),
            false => self.refuse(raw.at, format!("{what}: {}", unknown("value", text, &known))),
        }
    }
}
