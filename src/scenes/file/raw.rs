//! The tree of a TOML text with the place of everything in it, and entries that stand for many.

use super::formula::{Formula, Scope, SyntaxError, continues_name, meaning, starts_name};
use super::mistake::Mistake;
use crate::scenes::unknown;
use toml::de::{DeTable, DeValue};

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub at: usize,
    pub value: RawValue,
}

/// A TOML value; the entries of a table stand in the order of the file.
#[derive(Clone, Debug)]
pub(super) enum RawValue {
    Text(String, Origin),
    /// As written: whole or not.
    Number {
        value: f64,
        whole: bool,
    },
    Flag(bool),
    Date,
    List(Vec<Raw>),
    Table(Vec<KeyValue>),
}

/// How a text came to be.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// As it stands in the file, from this place on.
    Written(usize),
    /// The same, with characters that the file writes otherwise.
    Escaped,
    /// Braces were filled: how it reads as a formula, where a value stays a value, or why it is none.
    Filled(Result<String, String>),
}

impl Origin {
    /// The place of the first character, if characters of the text and the file are the same.
    pub fn place(&self) -> Option<usize> {
        match self {
            Origin::Written(at) => Some(*at),
            _ => None,
        }
    }

    /// What a text of this origin says as a formula.
    pub fn formula<'t>(&'t self, text: &'t str) -> Result<&'t str, SyntaxError> {
        match self {
            Origin::Filled(filled) => filled.as_deref().map_err(|why| (0, why.clone())),
            _ => Ok(text),
        }
    }
}

/// A key of a table with its value, and where the key stands.
#[derive(Clone, Debug)]
pub(super) struct KeyValue {
    pub key: String,
    pub at: usize,
    pub value: Raw,
}

impl Raw {
    pub fn parse(text: &str) -> Result<Raw, Mistake> {
        let table = DeTable::parse(text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            Mistake::new(at, format!("this is no TOML: {}", error.message().trim().replace('\n', ", ")))
        })?;
        Ok(Raw { at: 0, value: raw_table(text, table.get_ref()) })
    }

    /// The tree of entries of a program, with the numbers of their places.
    pub fn of_entries(entries: &serde_json::Value, at: usize) -> Raw {
        use serde_json::Value::{Array, Bool, Null, Number, Object, String};
        let value = match entries {
            String(text) => RawValue::Text(text.clone(), Origin::Escaped),
            Number(own) => RawValue::Number { value: own.as_f64().unwrap_or(f64::NAN), whole: !own.is_f64() },
            Bool(flag) => RawValue::Flag(*flag),
            Null => RawValue::List(Vec::new()),
            Array(list) => RawValue::List(list.iter().map(|own| Raw::of_entries(own, at)).collect()),
            Object(own) => {
                let at = own.get("").and_then(serde_json::Value::as_u64).map_or(at, |at| at as usize);
                if let Some(value) = own.get("=") {
                    return Raw::of_entries(value, at);
                }
                let entry = |(key, own): (&std::string::String, _)| {
                    let value = Raw::of_entries(own, at);
                    KeyValue { key: key.clone(), at: value.at, value }
                };
                let entries = own.iter().filter(|own| !own.0.is_empty()).map(entry).collect();
                return Raw { at, value: RawValue::Table(entries) };
            }
        };
        Raw { at, value }
    }

    /// The text of a file that says the same.
    pub fn written(&self) -> String {
        let lines = |own: &Raw| own.key_values().iter().map(KeyValue::written).collect::<String>();
        let (mut top, mut sections) = (String::new(), String::new());
        for own in self.key_values() {
            let (key, tables) = (written_key(&own.key), own.value.one_or_more());
            if tables.is_empty() || tables.iter().any(|own| own.table().is_none()) {
                top += &own.written();
            } else if own.value.list().is_some() {
                sections.extend(tables.iter().map(|own| format!("\n[[{key}]]\n{}", lines(own))));
            } else if tables[0].table().is_some_and(|own| own.iter().all(|own| own.value.table().is_some())) {
                let named = tables[0].key_values().iter();
                sections.extend(named.map(|own| format!("\n[{key}.{}]\n{}", written_key(&own.key), lines(&own.value))));
            } else {
                sections += &format!("\n[{key}]\n{}", lines(&own.value));
            }
        }
        top + &sections
    }

    /// As a value in a line.
    fn inline(&self) -> String {
        match &self.value {
            RawValue::Text(text, _) => serde_json::Value::from(text.as_str()).to_string(),
            RawValue::Number { value, whole: true } => format!("{value}"),
            RawValue::Number { value, .. } => format!("{value:?}"),
            RawValue::Flag(flag) => flag.to_string(),
            RawValue::Date => String::new(),
            RawValue::List(list) => format!("[{}]", list.iter().map(Raw::inline).collect::<Vec<_>>().join(", ")),
            RawValue::Table(entries) => {
                let own = |own: &KeyValue| format!("{} = {}", written_key(&own.key), own.value.inline());
                format!("{{ {} }}", entries.iter().map(own).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// Moves its places to those of a text that stands behind another one.
    pub fn move_by(&mut self, by: usize) {
        self.at += by;
        match &mut self.value {
            RawValue::Text(_, Origin::Written(place)) => *place += by,
            RawValue::List(list) => list.iter_mut().for_each(|own| own.move_by(by)),
            RawValue::Table(entries) => entries.iter_mut().for_each(|own| {
                own.at += by;
                own.value.move_by(by);
            }),
            _ => {}
        }
    }

    /// What it is, for messages.
    pub fn words(&self) -> String {
        match &self.value {
            RawValue::Text(text, _) => format!("the text \"{text}\""),
            RawValue::Number { value, .. } => format!("the number {value}"),
            RawValue::Flag(flag) => format!("{flag}"),
            RawValue::Date => "a date".into(),
            RawValue::List(list) => format!("a list of {}", list.len()),
            RawValue::Table(_) => "a table".into(),
        }
    }

    pub fn table(&self) -> Option<&[KeyValue]> {
        match &self.value {
            RawValue::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Those of a table; none of anything else.
    pub fn key_values(&self) -> &[KeyValue] {
        self.table().unwrap_or_default()
    }

    pub fn get(&self, key: &str) -> Option<&Raw> {
        Some(&self.table()?.iter().find(|entry| entry.key == key)?.value)
    }

    pub fn list(&self) -> Option<&[Raw]> {
        match &self.value {
            RawValue::List(list) => Some(list),
            _ => None,
        }
    }

    /// The same, or itself where it is none.
    pub fn one_or_more(&self) -> &[Raw] {
        self.list().unwrap_or(std::slice::from_ref(self))
    }

    pub fn text(&self) -> Option<&str> {
        match &self.value {
            RawValue::Text(text, _) => Some(text),
            _ => None,
        }
    }

    pub fn texts(&self) -> Vec<&str> {
        match &self.value {
            RawValue::Text(text, _) => vec![text],
            RawValue::List(list) => list.iter().flat_map(Raw::texts).collect(),
            RawValue::Table(entries) => entries.iter().flat_map(|own| own.value.texts()).collect(),
            _ => Vec::new(),
        }
    }

    pub fn formula(&self) -> Option<&str> {
        match &self.value {
            RawValue::Text(text, origin) => origin.formula(text).ok(),
            _ => None,
        }
    }

    pub fn whole(&self) -> Option<i64> {
        match self.value {
            RawValue::Number { value, whole: true } => Some(value as i64),
            _ => None,
        }
    }
}

impl KeyValue {
    /// The same key with another value.
    pub fn with(&self, value: Raw) -> KeyValue {
        KeyValue { key: self.key.clone(), at: self.at, value }
    }

    fn written(&self) -> String {
        format!("{} = {}\n", written_key(&self.key), self.value.inline())
    }
}

fn written_key(key: &str) -> String {
    let is_bare = !key.is_empty() && key.chars().all(|own| own.is_ascii_alphanumeric() || matches!(own, '_' | '-'));
    if is_bare { key.into() } else { serde_json::Value::from(key).to_string() }
}

fn raw_table(text: &str, table: &DeTable) -> RawValue {
    let mut entries: Vec<KeyValue> = table
        .iter()
        .map(|(key, value)| KeyValue {
            key: key.get_ref().to_string(),
            at: key.span().start,
            value: raw(text, value.get_ref(), value.span().start),
        })
        .collect();
    entries.sort_by_key(|entry| entry.at);
    RawValue::Table(entries)
}

fn raw(text: &str, value: &DeValue, at: usize) -> Raw {
    let number = |digits: &str, whole| RawValue::Number { value: digits.parse().unwrap_or(f64::NAN), whole };
    let value = match value {
        DeValue::String(own) => {
            let is_plain = text.get(at + 1..).is_some_and(|rest| rest.starts_with(&**own));
            RawValue::Text(own.to_string(), if is_plain { Origin::Written(at + 1) } else { Origin::Escaped })
        }
        DeValue::Integer(own) if own.radix() == 10 => number(&own.as_str().replace('_', ""), true),
        DeValue::Integer(own) => {
            let value = i64::from_str_radix(&own.as_str().replace('_', ""), own.radix());
            RawValue::Number { value: value.map_or(f64::NAN, |value| value as f64), whole: true }
        }
        DeValue::Float(own) => number(&own.as_str().replace('_', ""), false),
        DeValue::Boolean(flag) => RawValue::Flag(*flag),
        DeValue::Datetime(_) => RawValue::Date,
        DeValue::Array(list) => RawValue::List(list.iter().map(|own| raw(text, own.get_ref(), own.span().start)).collect()),
        DeValue::Table(table) => raw_table(text, table),
    };
    Raw { at, value }
}

/// Most entries that one stands for.
const MOST_ENTRIES: usize = 10_000;

/// A name of a loop with one of its values.
pub(super) type Turn = (String, Step);

#[derive(Clone)]
pub(super) enum Step {
    Whole(i64),
    Word(String),
}

/// What a name of a loop may be given.
const FOR_WANTED: &str = "each has a range { from = 1, to = 5 }, or a list of whole numbers or of texts";

/// Whole numbers that `[define]` names, which loops and counts may use.
#[derive(Clone, Debug, Default)]
pub(super) struct Wholes(Vec<(String, i64)>);

impl Wholes {
    /// Those of a file: numbers, and formulas of those before them.
    pub fn of(root: &Raw) -> Self {
        let mut wholes = Wholes::default();
        for entry in root.get("define").and_then(Raw::table).unwrap_or_default() {
            if let Some(value) = wholes.value(&entry.value, &[]) {
                wholes.0.push((entry.key.clone(), value));
            }
        }
        wholes
    }

    /// A whole number, or a formula that gives one, which knows names of loops.
    pub fn value(&self, raw: &Raw, turn: &[Turn]) -> Option<i64> {
        raw.whole().or_else(|| whole_number(raw.formula()?, &self.scope(turn)).ok())
    }

    /// What braces know: these, and the names of loops, which stand in front of them.
    fn scope(&self, turn: &[Turn]) -> Scope {
        let mut scope = Scope::default();
        let own = self.0.iter().filter(|own| turn.iter().all(|(name, _)| *name != own.0));
        let loops = turn.iter().filter_map(|(name, step)| match step {
            Step::Whole(value) => Some((name, *value)),
            Step::Word(_) => None,
        });
        for (name, value) in own.map(|(name, value)| (name, *value)).chain(loops) {
            scope.add_value(name, &Formula::literal(value as f64));
        }
        scope
    }
}

fn whole_number(text: &str, scope: &Scope) -> Result<i64, String> {
    match Formula::parse(text, scope).map_err(|(_, what)| what)?.constant_number() {
        Some(value) if value.fract() == 0.0 && value.abs() < 1e15 => Ok(value as i64),
        _ => Err(format!("{{{text}}} must be a whole number")),
    }
}

/// The values of a name, whose range knows those of the names before it: where these make it end just before it begins, it has none.
fn steps_of(own: &KeyValue, turn: &[Turn], wholes: &Wholes) -> Result<Vec<Step>, Mistake> {
    let wrong = |what: String| Mistake::new(own.value.at, what);
    let number = |key: &str| own.value.get(key).and_then(|own| wholes.value(own, turn));
    let steps = match own.value.table() {
        None => listed(&own.value),
        Some([only]) if only.key == "values" => listed(&only.value),
        Some(entries) => match (entries.len(), number("from"), number("to")) {
            (2, Some(from), Some(to)) if from > to + i64::from(!turn.is_empty()) => {
                let text = "which makes nothing: the smaller number comes first";
                return Err(wrong(format!("for: {} goes from {from} to {to}, {text}", own.key)));
            }
            (2, Some(from), Some(to)) if (from..=to).nth(MOST_ENTRIES).is_some() => {
                return Err(wrong(format!("for: {} takes more than {MOST_ENTRIES} values", own.key)));
            }
            (2, Some(from), Some(to)) => Some((from..=to).map(Step::Whole).collect()),
            _ => None,
        },
    };
    steps.ok_or_else(|| wrong(format!("for: {} is {}; {FOR_WANTED}", own.key, own.value.words())))
}

/// Whole numbers or texts of a list that is not empty.
fn listed(raw: &Raw) -> Option<Vec<Step>> {
    let list = raw.list()?;
    let numbers: Option<Vec<Step>> = list.iter().map(|own| own.whole().map(Step::Whole)).collect();
    let words = || list.iter().map(|own| own.text().map(|word| Step::Word(word.into()))).collect();
    numbers.or_else(words).filter(|own: &Vec<Step>| !own.is_empty())
}

/// Names over which entries anywhere in a file are repeated.
pub(super) fn loop_names(raw: &Raw) -> Vec<String> {
    match &raw.value {
        RawValue::List(list) => list.iter().flat_map(loop_names).collect(),
        RawValue::Table(entries) => {
            let own = entries.iter().filter(|own| own.key == "for").filter_map(|own| own.value.table());
            let own = own.flatten().map(|named| named.key.clone());
            own.chain(entries.iter().flat_map(|own| loop_names(&own.value))).collect()
        }
        _ => Vec::new(),
    }
}

impl Raw {
    /// The same with all that entries of lists stand for which have a key `for`, and those of a table with names; of what is wrong, which is
    /// told, nothing.
    ///
    /// In all their texts `{i}`, `{i+1}` and the like are filled with their values.
    pub fn repeated(&self, has_names: bool, wholes: &Wholes, mistakes: &mut Vec<Mistake>) -> Raw {
        let value = match &self.value {
            RawValue::List(list) => {
                RawValue::List(list.iter().flat_map(|own| told(repeated(own, &[], wholes), mistakes)).collect())
            }
            RawValue::Table(entries) => RawValue::Table(
                entries
                    .iter()
                    .flat_map(|own| match own.value.get("for") {
                        Some(_) if has_names => told(repeated_named(own, wholes), mistakes),
                        _ => vec![own.with(own.value.repeated(false, wholes, mistakes))],
                    })
                    .collect(),
            ),
            other => other.clone(),
        };
        Raw { at: self.at, value }
    }
}

fn told<T>(made: Result<Vec<T>, Mistake>, mistakes: &mut Vec<Mistake>) -> Vec<T> {
    made.unwrap_or_else(|mistake| {
        mistakes.push(mistake);
        Vec::new()
    })
}

/// The entries that an entry stands for within loops around it.
fn repeated(entry: &Raw, around: &[Turn], wholes: &Wholes) -> Result<Vec<Raw>, Mistake> {
    let Some(loops) = entry.get("for") else {
        return Ok(vec![replaced(entry, around, wholes)?]);
    };
    let named = loops.table().filter(|named| !named.is_empty());
    let named = named.ok_or_else(|| Mistake::new(loops.at, format!("for must be a table of names; {FOR_WANTED}")))?;
    let mut turns: Vec<Vec<Turn>> = vec![around.to_vec()];
    for own in named {
        if let Some(meaning) = meaning(&own.key) {
            return Err(Mistake::new(own.at, format!("\"{}\" means {meaning}; take another name", own.key)));
        }
        if around.iter().any(|turn| turn.0 == own.key) {
            return Err(Mistake::new(own.at, format!("for: {} is a name of the loop around this one", own.key)));
        }
        let mut longer = Vec::new();
        for turn in &turns {
            let steps = steps_of(own, turn, wholes)?;
            if longer.len() + steps.len() > MOST_ENTRIES {
                return Err(Mistake::new(loops.at, format!("for makes more than {MOST_ENTRIES} entries")));
            }
            longer.extend(steps.into_iter().map(|step| [&turn[..], &[(own.key.clone(), step)]].concat()));
        }
        turns = longer;
    }
    let once = without_for(entry);
    turns.iter().map(|turn| replaced(&once, turn, wholes)).collect()
}

fn without_for(entry: &Raw) -> Raw {
    let kept = entry.key_values().iter().filter(|own| own.key != "for").cloned();
    Raw { at: entry.at, value: RawValue::Table(kept.collect()) }
}

/// The same for an entry with a key of its own, which is replaced, too.
fn repeated_named(entry: &KeyValue, wholes: &Wholes) -> Result<Vec<KeyValue>, Mistake> {
    let loops = entry.value.key_values().iter().filter(|own| own.key == "for").cloned();
    let once = entry.with(without_for(&entry.value));
    let both = Raw { at: entry.at, value: RawValue::Table(loops.chain([once]).collect()) };
    let all = repeated(&both, &[], wholes)?;
    Ok(all.iter().flat_map(|own| own.key_values().to_vec()).collect())
}

fn replaced(raw: &Raw, turn: &[Turn], wholes: &Wholes) -> Result<Raw, Mistake> {
    let value = match &raw.value {
        RawValue::Text(text, _) if text.contains('{') => {
            let Filled { name, formula } = filled(text, turn, wholes).map_err(|what| Mistake::new(raw.at, what))?;
            RawValue::Text(name, Origin::Filled(formula))
        }
        RawValue::List(list) => {
            let all: Vec<Vec<Raw>> = list.iter().map(|own| repeated(own, turn, wholes)).collect::<Result<_, _>>()?;
            RawValue::List(all.into_iter().flatten().collect())
        }
        RawValue::Table(entries) => {
            let own = entries.iter().map(|entry| {
                let key = filled(&entry.key, turn, wholes).map_err(|what| Mistake::new(entry.at, what))?.name;
                Ok(KeyValue { key, at: entry.at, value: replaced(&entry.value, turn, wholes)? })
            });
            RawValue::Table(own.collect::<Result<_, _>>()?)
        }
        other => other.clone(),
    };
    Ok(Raw { at: raw.at, value })
}

/// A text whose braces were filled.
struct Filled {
    /// As a name: the values as they are written.
    name: String,
    /// As a formula: the values as values, in brackets where they are not a name or a number by themselves; why it is none
    /// where one touches a number, or has a sign and continues a name.
    formula: Result<String, String>,
}

fn filled(text: &str, turn: &[Turn], wholes: &Wholes) -> Result<Filled, String> {
    let scope = wholes.scope(turn);
    let (mut name, mut formula, mut refused, mut rest) = (String::new(), String::new(), None, text);
    while let Some((before, after)) = rest.split_once('{') {
        let Some((inside, behind)) = after.split_once('}') else {
            return Err(format!("\"{text}\" has a brace {{ without its }}"));
        };
        let word = turn.iter().find_map(|(name, step)| match step {
            Step::Word(word) if name == inside.trim() => Some(word.clone()),
            _ => None,
        });
        let value = || whole_number(inside, &scope).map(|value| value.to_string());
        let own = word.map_or_else(value, Ok).map_err(|what| format!("in \"{text}\": {what}"))?;
        name.push_str(before);
        formula.push_str(before);
        let belongs = |letter: char| continues_name(letter) || letter == '.';
        let is_all = text.len() == inside.len() + 2;
        let touches = name.ends_with(belongs) || behind.starts_with(|next| belongs(next) || "{(".contains(next));
        let is_word = own.chars().all(belongs);
        let is_operator = own.chars().all(|letter| "+-*/^ ".contains(letter));
        let token = name.trim_end_matches(belongs).len();
        let continues_a_name = is_word && name[token..].chars().chain(own.chars()).next().is_some_and(starts_name);
        match touches {
            true if !continues_a_name => {
                refused.get_or_insert_with(|| {
                    format!(
                        "{{{inside}}} is {own} here and touches what stands beside it: in a formula it is a value, or continues a name by \
                         letters and digits; write what is to be done with it, as in 2 * {{{inside}}}"
                    )
                });
            }
            false if !(is_word || is_all || is_operator) => formula.push_str(&format!("({own})")),
            _ => formula.push_str(&own),
        }
        name.push_str(&own);
        rest = behind;
    }
    name.push_str(rest);
    formula.push_str(rest);
    Ok(Filled { name, formula: refused.map_or(Ok(formula), Err) })
}

/// Puts a key into a table: tables into tables key by key, tables into lists by the names of their entries, entries of lists into those of
/// their names or behind them; all else, and a table with another type, in the place of what was there.
pub(super) fn put(into: &mut Raw, entry: &KeyValue, path: &str) -> Result<(), Mistake> {
    let RawValue::Table(entries) = &mut into.value else { return Ok(()) };
    let Some(own) = entries.iter_mut().find(|own| own.key == entry.key) else {
        entries.push(entry.clone());
        return Ok(());
    };
    match (&mut own.value.value, &entry.value.value) {
        (RawValue::Table(_), RawValue::Table(changes)) if entry.value.get("type").is_none() => {
            changes.iter().try_for_each(|change| put(&mut own.value, change, &format!("{path}.{}", change.key)))
        }
        (RawValue::List(list), RawValue::Table(changes)) => {
            changes.iter().try_for_each(|change| change_named(list, change, path))
        }
        (RawValue::List(list), RawValue::List(more)) if list.iter().all(|own| own.table().is_some()) => {
            more.iter().try_for_each(|own| change_or_add(list, own, path))
        }
        _ => {
            *own = entry.clone();
            Ok(())
        }
    }
}

fn change_named(list: &mut [Raw], change: &KeyValue, path: &str) -> Result<(), Mistake> {
    let Some(place) = list.iter().position(|own| name_of(own) == change.key) else {
        let known: Vec<String> = list.iter().map(|own| name_of(own).into()).collect();
        return Err(Mistake::new(change.at, unknown(path, &change.key, &known)));
    };
    let Some(changes) = change.value.table() else {
        let text = format!("what is changed of {path} \"{}\" is a table of its keys", change.key);
        return Err(Mistake::new(change.at, text));
    };
    let path = format!("{path} \"{}\"", change.key);
    changes.iter().try_for_each(|own| put(&mut list[place], own, &format!("{path}, {}", own.key)))
}

/// Changes the entry of a list that has the name of this one, or adds it.
fn change_or_add(list: &mut Vec<Raw>, own: &Raw, path: &str) -> Result<(), Mistake> {
    let name = name_of(own);
    if name.is_empty() || list.iter().all(|other| name_of(other) != name) {
        list.push(own.clone());
        return Ok(());
    }
    change_named(list, &KeyValue { key: name.into(), at: own.at, value: own.clone() }, path)
}

fn name_of(own: &Raw) -> &str {
    own.get("name").and_then(Raw::text).unwrap_or_default()
}
