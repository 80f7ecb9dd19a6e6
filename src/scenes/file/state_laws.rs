//! States of first order by entries: an entry is what a file would write of its keys, and read as such.

use super::expression::{Expression, Scope};
use super::raw::{Entry, Raw};
use super::reader::{Fields, Reader, Value};
use crate::elements::entries::{Form, Key, Range, Type, may, need};

/// Formulas of a state by its keys, definitions and states.
#[derive(Default)]
struct Law {
    /// Names for formulas, each of those before it.
    definitions: Vec<[&'static str; 2]>,
    /// Names, starts and rates of the states.
    states: Vec<[&'static str; 3]>,
    /// Names and formulas of what others read beside the states.
    outputs: Vec<[&'static str; 2]>,
}

/// What a law makes of the keys that are given, or what is wrong with them.
type ByKeys = fn(given: &dyn Fn(&str) -> bool) -> Result<Law, &'static str>;

/// The entry of a state.
struct StateEntry {
    form: Form,
    /// Formulas for keys that are left out.
    defaults: &'static [[&'static str; 2]],
    law: ByKeys,
}

/// All entries of states.
const STATE_ENTRIES: [StateEntry; 2] = [LAG, PID];

/// A lag of first order: T z' = k u - z.
const LAG: StateEntry = StateEntry {
    form: Form {
        name: "lag",
        doc: "a lag of first order, as of an actuator or a sensor: T z' = k u - z; others know z as NAME.value, z' as NAME.rate",
        keys: &[
            need("input", Type::OfNodes("-"), "u"),
            need("time_constant", Type::Number("s", Range::Positive), "T"),
            may("gain", Type::OfNodes("-"), "k; 1"),
            may("initial", Type::Number("-", Range::Any), "z at the start; 0"),
        ],
    },
    defaults: &[["gain", "1"], ["initial", "0"]],
    law: |_| {
        Ok(Law {
            definitions: vec![["slope", "(gain * input - value) / time_constant"]],
            states: vec![["value", "initial", "slope"]],
            outputs: vec![["rate", "slope"]],
        })
    },
};

/// A PID controller: u = kp e + I + kd e', I' = ki e.
const PID: StateEntry = StateEntry {
    form: Form {
        name: "pid",
        doc: "a PID controller of the error e = set_point - measured: u = kp e + I + kd d, I' = ki e, where d is e', filtered (d = (e - z) / T, \
              z' = d) or as it is given; others know u as NAME.output, e as NAME.error, I as NAME.integral_term. With limits u is held within \
              them, and I' = ki e + (u - kp e - I - kd d) / tracking_time (no windup)",
        keys: &[
            need("measured", Type::OfNodes("-"), "what is controlled"),
            need("set_point", Type::OfNodes("-"), "what it should be"),
            may("proportional", Type::OfNodes("-"), "kp; 0"),
            may("integral", Type::OfNodes("1/s"), "ki; 0"),
            may("derivative", Type::OfNodes("s"), "kd, with filter_time or error_rate; 0"),
            may("filter_time", Type::Number("s", Range::Positive), "T of the filter of the derivative"),
            may("error_rate", Type::OfNodes("1/s"), "e' where the mechanism knows it, as of rates of joints; filtered"),
            may("initial", Type::Number("-", Range::Any), "I at the start; 0"),
            may("initial_error", Type::Number("-", Range::Any), "z at the start, e for a start without a kick; 0"),
            may("least", Type::OfNodes("-"), "lower limit of u; none"),
            may("most", Type::OfNodes("-"), "upper limit of u; none"),
            may(
                "tracking_time",
                Type::Number("s", Range::Positive),
                "time in which I follows u at a limit; needed with one",
            ),
        ],
    },
    defaults: &[["proportional", "0"], ["integral", "0"], ["initial", "0"], ["initial_error", "0"]],
    law: |given| {
        let [filtered, is_rate] = ["filter_time", "error_rate"].map(given);
        let bounds = ["least", "most"].map(given);
        if given("derivative") != (filtered || is_rate) || (filtered && is_rate) {
            return Err("derivative needs one of filter_time and error_rate, and these need it");
        }
        if given("initial_error") && !filtered {
            return Err("initial_error is a start of the filter of the derivative: give filter_time, too, or leave it out");
        }
        if given("tracking_time") != bounds.contains(&true) {
            return Err("limits least and most need tracking_time, and it needs one of them");
        }
        let mut own = Law { definitions: vec![["e", "set_point - measured"]], ..Law::default() };
        own.definitions.push(match (filtered, is_rate) {
            (false, false) => ["free", "proportional * e + integral_term"],
            (true, _) => ["d", "(e - filtered_error) / filter_time"],
            _ => ["d", "error_rate"],
        });
        if filtered || is_rate {
            own.definitions.push(["free", "proportional * e + integral_term + derivative * d"]);
        }
        own.definitions.push([
            "u",
            match bounds {
                [false, false] => "free",
                [true, false] => "max(free, least)",
                [false, true] => "min(free, most)",
                [true, true] => "min(max(free, least), most)",
            },
        ]);
        let is_limited = bounds.contains(&true);
        let rate = if is_limited { "integral * e + (u - free) / tracking_time" } else { "integral * e" };
        own.states.push(["integral_term", "initial", rate]);
        own.states.extend(filtered.then_some(["filtered_error", "initial_error", "d"]));
        own.outputs = vec![["output", "u"], ["error", "e"]];
        Ok(own)
    },
};

/// A state that a file writes itself.
const WRITTEN: Form = Form {
    name: "formula",
    doc: "by its rates, whose formulas know its own values by their names",
    keys: &[
        need("initial", Type::NamedFormulas("-"), "values at the start by their names"),
        need("rate", Type::NamedFormulas("1/s"), "rates of all of them by the same names"),
        may(
            "output",
            Type::NamedFormulas("-"),
            "numbers or vectors that others know beside the values, by their names; none",
        ),
    ],
};

/// All forms of a state.
pub(super) const STATE_FORMS: [Form; STATE_ENTRIES.len() + 1] = {
    let mut forms = [WRITTEN; STATE_ENTRIES.len() + 1];
    let mut place = 0;
    while place < STATE_ENTRIES.len() {
        forms[place + 1] = STATE_ENTRIES[place].form;
        place += 1;
    }
    forms
};

/// Formulas by names, with their places in the file.
pub(super) type Formulas = Vec<(String, usize, Expression)>;

/// Keys under which the fields of an entry have the starts and the rates of its states.
pub(super) const MADE: [&str; 2] = ["starts of states", "rates of states"];

/// Keys of a form of a state.
pub(super) fn keys_of(form: &str) -> &'static [Key] {
    STATE_FORMS.iter().find(|own| own.name == form).map_or(&[], |own| own.keys)
}

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
            let entries = |key| raw.get(key).and_then(Raw::entries).unwrap_or_default();
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
                let entries = raw.get("output").and_then(Raw::entries).unwrap_or_default();
                let mut formula =
                    |own: &Entry| Some((own.key.clone(), own.at, self.number_or_vector(&own.value, &own.key)?));
                entries.iter().filter_map(&mut formula).collect()
            }
        }
    }

    /// Adds the starts and rates of the states of an entry to its fields.
    pub(super) fn take_law(&mut self, raw: &Raw, fields: &mut Fields) {
        let Some(entry) = entry_of(raw) else {
            let (states, _, _) = names_of(raw);
            for own in raw.get("output").and_then(Raw::entries).unwrap_or_default() {
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
        let Some([starts, rates, _]) = made else { return };
        fields.values.extend(MADE.into_iter().zip([starts, rates]).map(|(key, own)| (key, raw.at, Value::Formulas(own))));
    }

    /// Starts, rates and outputs of an entry: formulas of its keys, whose own formulas stand where their names do.
    fn formulas_of(&mut self, entry: &StateEntry, raw: &Raw) -> Option<[Formulas; 3]> {
        let law = law_of(entry, raw).ok()?;
        let mut scope = Scope::default();
        for [key, text] in entry.defaults.iter().filter(|own| raw.get(own[0]).is_none()) {
            scope.add_definition(key, Expression::parse(text, &scope).ok()?);
        }
        for key in entry.form.keys {
            if let Some(given) = raw.get(key.name) {
                let formula = self.formula(given, key.name, Some(Range::Any))?;
                scope.add_definition(key.name, formula);
            }
        }
        for [state, ..] in &law.states {
            scope.add_definition(state, Expression::name(self.scope.find(&unnamed(state))?.0));
        }
        for [name, text] in &law.definitions {
            let formula = Expression::parse(text, &scope).ok()?;
            scope.add_definition(name, formula);
        }
        let read = |name: &str, text| Some((name.to_string(), raw.at, Expression::parse(text, &scope).ok()?));
        let starts: Option<Formulas> = law.states.iter().map(|[name, start, _]| read(name, start)).collect();
        let rates: Option<Formulas> = law.states.iter().map(|[name, _, rate]| read(name, rate)).collect();
        let outputs: Option<Formulas> = law.outputs.iter().map(|[name, text]| read(name, text)).collect();
        Some([starts?, rates?, outputs?])
    }
}
