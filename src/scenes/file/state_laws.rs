//! What entries of states make of a file: what it would write of their keys, and read as such.

use super::fields::{Fields, Value};
use super::formula::{Formula, Meaning, Scope};
use super::raw::{KeyValue, Raw};
use super::reader::Reader;
use super::state_entries::{Law, MADE, STATE_ENTRIES, StateEntry};
use crate::elements::entries::Range;

/// Formulas by names, with their places in the file.
pub(super) type Formulas = Vec<(String, usize, Formula)>;

/// The entry of states that a table is of, where it is of one.
fn entry_of(raw: &Raw) -> Option<&'static StateEntry> {
    let form = raw.get("type").and_then(Raw::text)?;
    STATE_ENTRIES.iter().find(|own| own.form.name == form)
}

/// The law of an entry whose keys are given so; that of one that is wrong is told where it is read.
fn law_of(entry: &StateEntry, raw: &Raw) -> Result<Law, &'static str> {
    (entry.law)(&|key| raw.get(key).is_some())
}

/// Names of the states of a table with their places, whether a file gives them, and names of its outputs.
pub(super) fn names_of(raw: &Raw) -> (Vec<(String, usize)>, bool, Vec<String>) {
    match entry_of(raw) {
        Some(entry) => {
            let law = law_of(entry, raw).unwrap_or_default();
            let states = law.states.iter().map(|own| (own[0].into(), raw.at)).collect();
            (states, false, law.outputs.iter().map(|own| own[0].into()).collect())
        }
        None => {
            let entries = |key| raw.get(key).and_then(Raw::table).unwrap_or_default();
            let states = entries("initial").iter().map(|own| (own.key.clone(), own.at)).collect();
            (states, true, entries("output").iter().map(|own| own.key.clone()).collect())
        }
    }
}

/// The name in a scope of a state that no formula of the file calls by its name.
pub(super) fn unnamed(state: &str) -> String {
    format!(".{state}")
}

impl Reader {
    /// What the outputs of a state stand for, where the scope is that of its formulas.
    pub(super) fn outputs_of(&mut self, raw: &Raw) -> Formulas {
        match entry_of(raw) {
            Some(entry) => self.formulas_of(entry, raw).map(|[_, _, own]| own).unwrap_or_default(),
            None => {
                let entries = raw.get("output").and_then(Raw::table).unwrap_or_default();
                let mut formula =
                    |own: &KeyValue| Some((own.key.clone(), own.at, self.number_or_vector(&own.value, &own.key)?));
                entries.iter().filter_map(&mut formula).collect()
            }
        }
    }

    /// Adds the starts and rates of the states of an entry, and its outputs, to its fields.
    pub(super) fn take_law(&mut self, raw: &Raw, fields: &mut Fields) {
        let Some(entry) = entry_of(raw) else {
            let (states, _, _) = names_of(raw);
            for own in raw.get("output").and_then(Raw::table).unwrap_or_default() {
                self.check_name(&own.key, own.at);
                if states.iter().any(|state| state.0 == own.key) {
                    self.wrong(own.at, format!("\"{}\" is a value of this state, which others know already", own.key));
                }
            }
            return;
        };
        if let Err(what) = law_of(entry, raw) {
            self.wrong(raw.at, what);
        }
        // what is wrong with a key was told where it was read
        let before = self.mistakes.len();
        let made = self.formulas_of(entry, raw);
        self.mistakes.truncate(before);
        let Some(made) = made else { return };
        fields.values.extend(MADE.into_iter().zip(made).map(|(key, own)| (key, raw.at, Value::Formulas(own))));
    }

    /// Starts, rates and outputs of an entry: formulas of its keys, whose own formulas stand where their names do.
    fn formulas_of(&mut self, entry: &StateEntry, raw: &Raw) -> Option<[Formulas; 3]> {
        let law = law_of(entry, raw).ok()?;
        let mut scope = Scope::default();
        for [key, text] in entry.defaults.iter().filter(|own| raw.get(own[0]).is_none()) {
            let default = Formula::parse(text, &scope).ok()?;
            scope.add(key, Meaning::Formula(default));
        }
        for key in entry.form.keys {
            if let Some(given) = raw.get(key.name) {
                let formula = self.formula(given, key.name, Some(Range::Any))?;
                scope.add(key.name, Meaning::Formula(formula));
            }
        }
        for [state, ..] in &law.states {
            scope.add(state, Meaning::Formula(Formula::number(self.scope.place(&unnamed(state))?)));
        }
        for [name, text] in &law.definitions {
            let formula = Formula::parse(text, &scope).ok()?;
            scope.add(name, Meaning::Formula(formula));
        }
        let read = |name: &str, text| Some((name.to_string(), raw.at, Formula::parse(text, &scope).ok()?));
        let starts: Option<Formulas> = law.states.iter().map(|[name, start, _]| read(name, start)).collect();
        let rates: Option<Formulas> = law.states.iter().map(|[name, _, rate]| read(name, rate)).collect();
        let outputs: Option<Formulas> = law.outputs.iter().map(|[name, text]| read(name, text)).collect();
        Some([starts?, rates?, outputs?])
    }
}
