//! Values by what their keys take.

use super::expression::{Expression, OF_LAW, Quantity, TIME, names_in};
use super::raw::{Entry, Raw, RawValue, repeated_entries};
use super::reader::{NamedNode, Reader, Value};
use crate::elements::entries::{Forms, Key, Range, Type};
use crate::scenes::unknown;

/// Whether a text mentions a name.
fn uses(text: &str, name: &str) -> bool {
    names_in(text).iter().any(|own| own == name)
}

/// Largest number of a point or face of a mesh.
const MOST_POINTS: usize = 10_000_000;

impl Reader {
    fn not(&mut self, raw: &Raw, key: &Key, owner: &str, wanted: &str) {
        self.wrong(raw.at, format!("{} of {owner} must be {wanted}; it is {}", key.name, raw.words()));
    }

    pub(super) fn value(&mut self, raw: &Raw, key: &Key, takes: &Type, owner: &str) -> Option<Value> {
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
            _ if self.array(raw, takes).is_some() => self.array(raw, takes),
            Type::Series(_) => match list().filter(|list| !list.is_empty()) {
                Some(list) => self.numbers(list, &what, Range::Any).map(|own| self.with_known(own)),
                None => {
                    self.not(raw, key, owner, "a list of numbers or formulas");
                    None
                }
            },
            Type::Strips(unit, range) => {
                let of_section = std::mem::replace(&mut self.scope.of_section, true);
                let own = self.value(raw, key, &Type::OneOrMore(unit, range), owner);
                self.scope.of_section = of_section;
                own
            }
            Type::FixedOrMore(_) => {
                let one = [raw.clone()];
                let own: Vec<_> =
                    list().unwrap_or(&one).iter().map(|raw| (raw.at, self.fixed(raw, &what, Range::Any))).collect();
                let value = |(at, value): (usize, Option<f64>)| Some((at, Value::Fixed(value?)));
                own.into_iter().map(value).collect::<Option<_>>().map(Value::List)
            }
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
            Type::Fixeds(count, _) => match list().filter(|list| count == 0 || list.len() == count) {
                Some(list) => {
                    let own: Vec<_> = list.iter().map(|raw| (raw.at, self.fixed(raw, &what, Range::Any))).collect();
                    own.into_iter()
                        .map(|(at, value)| Some((at, Value::Fixed(value?))))
                        .collect::<Option<_>>()
                        .map(Value::List)
                }
                None => {
                    let number = if count == 0 { String::new() } else { format!("{count} ") };
                    self.not(raw, key, owner, &format!("a list of {number}numbers"));
                    None
                }
            },
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
            Type::Pairs(_) => {
                let pairs = list().filter(|list| list.len() > 1);
                let pair = |own: &Raw| match &own.value {
                    RawValue::List(list) if list.len() == 2 => Some((own.at, list.clone())),
                    _ => None,
                };
                match pairs.and_then(|list| list.iter().map(pair).collect::<Option<Vec<_>>>()) {
                    Some(pairs) => {
                        let own: Vec<_> =
                            pairs.iter().map(|(at, pair)| (*at, self.numbers(pair, &what, Range::Any))).collect();
                        own.into_iter().map(|(at, pair)| Some((at, pair?))).collect::<Option<_>>().map(Value::List)
                    }
                    None => {
                        self.not(
                            raw,
                            key,
                            owner,
                            "a list of two or more pairs of numbers or formulas, as in [[0, 0], [1, 0]]",
                        );
                        None
                    }
                }
            }
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
            Type::Stl => self.surface(raw, &what).map(Value::Surface),
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
            Type::Columns => {
                let of = |own: &Raw| match &own.value {
                    RawValue::Number { value, whole: true } if *value >= 1.0 => Some(Value::Count(*value as usize)),
                    _ => own.text().map(|name| Value::Text(name.into())),
                };
                let columns = list().filter(|list| list.len() == 2);
                let columns = columns.and_then(|list| list.iter().map(|own| Some((own.at, of(own)?))).collect());
                if columns.is_none() {
                    self.not(raw, key, owner, "two names or numbers of columns, as in [\"time\", \"height\"] or [1, 3]");
                }
                columns.map(Value::List)
            }
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
            Type::NodeSet => self.node(raw, &what, true).map(Value::Node),
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
            Type::Item(sections) => self.item_or_group(raw, &what, sections),
            Type::Items(sections) => {
                let own = std::slice::from_ref(raw);
                let list = list().unwrap_or(own);
                let found: Vec<_> = list.iter().map(|own| (own.at, self.item_or_group(own, &what, sections))).collect();
                found.into_iter().map(|(at, item)| Some((at, item?))).collect::<Option<_>>().map(Value::List)
            }
            Type::OfMesh(_, range) => {
                self.scope.of_mesh = self.current;
                let formula = self.formula(raw, &what, Some(range));
                self.scope.of_mesh = None;
                Some(Value::Formula(formula?, range))
            }
            Type::Lists => match list().filter(|list| !list.is_empty()) {
                Some(list) => {
                    let own: Vec<_> = list.iter().map(|own| (own.at, self.whole_numbers(own, &what))).collect();
                    let value = |(at, numbers): (usize, Option<Vec<usize>>)| {
                        Some((at, Value::List(numbers?.into_iter().map(|own| (at, Value::Count(own))).collect())))
                    };
                    own.into_iter().map(value).collect::<Option<_>>().map(Value::List)
                }
                None => {
                    self.not(raw, key, owner, "a list of lists of whole numbers, as in [[0, 1, 2, 3]]");
                    None
                }
            },
            Type::Selections => match raw.entries() {
                Some(entries) => {
                    let listed = entries.iter().filter(|own| own.value.text().is_none());
                    let own: Vec<_> = listed.map(|own| self.whole_numbers(&own.value, &what)).collect();
                    // what they select was read with the mesh
                    own.into_iter().collect::<Option<Vec<_>>>().map(|_| Value::List(Vec::new()))
                }
                None => {
                    let wanted = "a table of names with lists of whole numbers or conditions, as in { rim = [0, 1, 2], root = \"x < 1e-6\" }";
                    self.not(raw, key, owner, wanted);
                    None
                }
            },
            Type::Table(forms) => Some(Value::Fields(self.fields(raw, forms, &what))),
            Type::Tables(forms) => match list() {
                Some(list) => {
                    let mut all = Vec::new();
                    for own in list {
                        match repeated_entries(own) {
                            Ok(own) => all.extend(own),
                            Err(mistake) => self.mistakes.push(mistake),
                        }
                    }
                    let fields = |own: &Raw| (own.at, Value::Fields(self.fields(own, forms, &what)));
                    Some(Value::List(all.iter().map(fields).collect()))
                }
                None => {
                    self.not(raw, key, owner, "a list of tables");
                    None
                }
            },
            Type::Function(_, forms) => match raw.value {
                RawValue::Table(_) => Some(self.function_fields(raw, forms, &what)),
                _ => Some(Value::Formula(self.formula(raw, &what, Some(Range::Any))?, Range::Any)),
            },
            Type::OfTime => self.formula_of(raw, &what, &[TIME]),
            Type::OfNodes(_) => Some(Value::Formula(self.formula(raw, &what, Some(Range::Any))?, Range::Any)),
            Type::SeriesOfNodes(_) => match list().filter(|list| !list.is_empty()) {
                Some(list) => self.numbers(list, &what, Range::Any),
                None => {
                    self.not(raw, key, owner, "a list of formulas");
                    None
                }
            },
            // read with the names that formulas of the entry know
            Type::Definitions => Some(Value::List(Vec::new())),
            Type::NamedNodes(forms) => match raw.entries().filter(|entries| !entries.is_empty()) {
                Some(entries) => {
                    entries.iter().for_each(|own| self.check_name(&own.key, own.at));
                    let hidden = entries.iter().find(|own| self.scope.knows(&own.key));
                    if let Some(own) = hidden {
                        let text = format!("{what}: \"{}\" is a name of this file, too: take another one", own.key);
                        self.wrong(own.at, text);
                    }
                    let nodes: Vec<_> = entries.iter().map(|own| self.named_node(own, &what, forms)).collect();
                    nodes.into_iter().collect::<Option<_>>().map(Value::NamedNodes)
                }
                None => {
                    self.not(
                        raw,
                        key,
                        owner,
                        "a table of names for formulas with nodes, as in { hub = \"rotor\", tip = \"blade.end\" }",
                    );
                    None
                }
            },
            Type::NamedFormulas(_) => match raw.entries().filter(|entries| !entries.is_empty()) {
                Some(entries) => {
                    let formula = |own: &Entry| Some((own.key.clone(), own.at, self.number_or_vector(&own.value, &what)?));
                    let formulas: Vec<_> = entries.iter().map(formula).collect();
                    formulas.into_iter().collect::<Option<_>>().map(Value::Formulas)
                }
                None => {
                    self.not(raw, key, owner, "a table of names with formulas, as in { tip = \"-c * tip.velocity\" }");
                    None
                }
            },
            Type::Law(_, forms) | Type::Energy(_, forms) => match raw.value {
                RawValue::Table(_) => Some(self.function_fields(raw, forms, &what)),
                _ if matches!(takes, Type::Law(..)) => self.formula_of(raw, &what, &OF_LAW),
                _ => self.formula_of(raw, &what, &OF_LAW[..1]),
            },
            Type::Over(words, forms) => match raw.value {
                RawValue::Table(_) => Some(Value::Fields(self.fields(raw, forms, &what))),
                _ => self.choice(raw, &what, words).map(|word| Value::Text(word.into())),
            },
        }
    }

    /// All numbers of a design variable that has several, where a list is wanted and its name stands.
    fn array(&self, raw: &Raw, takes: &Type) -> Option<Value> {
        let range = match *takes {
            Type::Series(_) => Range::Any,
            Type::OneOrMore(_, range) => range,
            _ => return None,
        };
        let places = self.scope.array(raw.text()?.trim())?;
        Some(Value::List(places.map(|place| (raw.at, Value::Formula(Expression::name(place), range))).collect()))
    }

    /// A node by the name that formulas give it, or a point of one.
    fn named_node(&mut self, own: &Entry, what: &str, forms: &'static Forms) -> Option<NamedNode> {
        let (name, at) = (own.key.clone(), own.at);
        if own.value.entries().is_none() {
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
    pub(super) fn number_or_vector(&mut self, raw: &Raw, what: &str) -> Option<Expression> {
        match raw.value {
            RawValue::List(_) => self.vector(raw, what),
            _ => self.formula(raw, what, None),
        }
    }

    /// A function or law by its form.
    fn function_fields(&mut self, raw: &Raw, forms: &'static Forms, owner: &str) -> Value {
        let fields = self.fields(raw, forms, owner);
        Value::Fields(self.with_columns(fields))
    }

    /// Formulas that no design variable changes as numbers.
    fn with_known(&self, value: Value) -> Value {
        let known = |(at, own): (usize, Value)| match own {
            Value::Formula(formula, range) => match formula.constant(&self.scope) {
                Some(Quantity::Number(number)) => (at, Value::Formula(Expression::literal(number), range)),
                _ => (at, Value::Formula(formula, range)),
            },
            other => (at, other),
        };
        match value {
            Value::List(list) => Value::List(list.into_iter().map(known).collect()),
            other => other,
        }
    }

    /// A formula of some names beside those of the file.
    fn formula_of(&mut self, raw: &Raw, what: &str, names: &[&str]) -> Option<Value> {
        let hidden =
            names.iter().find(|&&name| self.scope.find(name).is_some() && raw.text().is_some_and(|text| uses(text, name)));
        if let Some(name) = hidden {
            let text = format!("{what}: {name} is what it depends on, and a name of this file, too: give that another name");
            self.wrong(raw.at, text);
            return None;
        }
        let scope = self.scope.with(names);
        let own = std::mem::replace(&mut self.scope, scope);
        let formula = self.formula(raw, what, Some(Range::Any));
        self.scope = own;
        Some(Value::Formula(formula?, Range::Any))
    }

    fn whole_numbers(&mut self, raw: &Raw, what: &str) -> Option<Vec<usize>> {
        let RawValue::List(list) = &raw.value else {
            self.wrong(raw.at, format!("{what} must have lists of whole numbers; there is {}", raw.words()));
            return None;
        };
        let own: Vec<Option<usize>> = list.iter().map(|own| self.count(own, what, [0, MOST_POINTS])).collect();
        own.into_iter().collect()
    }

    fn numbers(&mut self, list: &[Raw], what: &str, range: Range) -> Option<Value> {
        let own: Vec<_> = list.iter().map(|raw| (raw.at, self.formula(raw, what, Some(range)))).collect();
        own.into_iter()
            .map(|(at, formula)| Some((at, Value::Formula(formula?, range))))
            .collect::<Option<_>>()
            .map(Value::List)
    }

    /// A number or formula; of a number where a range is given.
    pub(super) fn formula(&mut self, raw: &Raw, what: &str, range: Option<Range>) -> Option<Expression> {
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

    pub(super) fn vector(&mut self, raw: &Raw, what: &str) -> Option<Expression> {
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
            RawValue::Text(text, _) => {
                text.parse().ok().or_else(|| match Expression::parse(text, &self.scope).ok()?.constant(&self.scope)? {
                    Quantity::Number(value) if value.fract() == 0.0 => Some(value),
                    _ => None,
                })
            }
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
}
