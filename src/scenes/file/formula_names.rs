//! Names that formulas of an entry know: its nodes, its own states, the time, outputs of states among the nodes, and what it defines.

use super::formula::{Meaning, Scope, TIME, words_of};
use super::formula_parts::OF_BODY;
use super::raw::{KeyValue, Raw};
use super::reader::Reader;
use super::state_laws::{Formulas, names_of, unnamed};

fn nodes_of(raw: &Raw) -> Vec<KeyValue> {
    raw.get("nodes").and_then(Raw::table).map(<[KeyValue]>::to_vec).unwrap_or_default()
}

/// Nodes by the names that formulas give them.
#[derive(Default)]
struct FormulaNodes {
    /// Those of the entry, then those that its outputs bring with them: c.a of an output of c that depends on a.
    all: Vec<KeyValue>,
    given: usize,
}

impl FormulaNodes {
    /// The name under which formulas have a node: the first of those that stand for the same.
    fn name<'n>(&'n self, name: &'n str) -> &'n str {
        let Some(place) = self.all.iter().position(|own| own.key == name).filter(|&place| place >= self.given) else {
            return name;
        };
        let text = self.all[place].value.text();
        self.all.iter().find(|own| text.is_some() && own.value.text() == text).map_or(name, |own| &own.key)
    }
    /// Those that outputs bring and that are not there already.
    fn brought(&self) -> Vec<KeyValue> {
        self.all[self.given..].iter().filter(|own| self.name(&own.key) == own.key).cloned().collect()
    }
}

impl Reader {
    /// Adds what the formulas of an entry know, and returns the scope without it.
    pub(super) fn scope_with_nodes(&mut self, item: usize, raw: &Raw) -> Option<Scope> {
        self.brought = Vec::new();
        let needs_no_nodes = matches!(self.declared[item].section.name, "state" | "event" | "clutch");
        if !needs_no_nodes && raw.get("nodes").and_then(Raw::table).is_none() {
            return None;
        }
        let before = self.scope.clone();
        self.brought = self.add_names(&before, item, raw, &mut vec![item]);
        self.take_definitions(&before, raw);
        Some(before)
    }

    /// The entry of a node that formulas of another name; what is wrong with it is told where its key is read.
    fn item_of(&mut self, node: &KeyValue) -> Option<usize> {
        let before = self.mistakes.len();
        let place = self.node(node.value.get("on").unwrap_or(&node.value), "", false);
        self.mistakes.truncate(before);
        place?.item
    }

    /// The state that a node is.
    fn state_at(&mut self, node: &KeyValue) -> Option<usize> {
        self.item_of(node).filter(|&item| self.declared[item].section.name == "state")
    }

    /// States among the nodes of an entry whose outputs it reads, by their names; not those that are being read.
    fn read_states(&mut self, raw: &Raw, path: &[usize]) -> Vec<(String, usize)> {
        let words: Vec<&str> = raw.texts().into_iter().flat_map(words_of).collect();
        let mut read = Vec::new();
        for node in nodes_of(raw) {
            let Some(state) = self.state_at(&node).filter(|own| !path.contains(own)) else { continue };
            let (states, _, outputs) = names_of(&self.raws[state]);
            // also where the name of an output is not spelled right: the message lists them
            let is_no_state = |word: &&str| {
                let what = word
                    .strip_prefix(&node.key)
                    .and_then(|rest| rest.strip_prefix('.'))
                    .and_then(|rest| rest.split('.').next());
                what.is_some_and(|what| states.iter().all(|state| state.0 != what))
            };
            if !outputs.is_empty() && words.iter().any(is_no_state) {
                read.push((node.key, state));
            }
        }
        read
    }

    fn formula_nodes(&mut self, raw: &Raw, path: &mut Vec<usize>) -> FormulaNodes {
        let mut all = nodes_of(raw);
        let given = all.len();
        for (name, state) in self.read_states(raw, path) {
            let of = self.raws[state].clone();
            path.push(state);
            let inner = self.formula_nodes(&of, path).all;
            path.pop();
            all.extend(inner.into_iter().map(|own| KeyValue { key: format!("{name}.{}", own.key), ..own }));
        }
        FormulaNodes { all, given }
    }

    /// Adds to the scope of the file what formulas of an entry know but its definitions, and returns the nodes that outputs bring.
    fn add_names(&mut self, file: &Scope, item: usize, raw: &Raw, path: &mut Vec<usize>) -> Vec<KeyValue> {
        let nodes = self.formula_nodes(raw, path);
        let brought = nodes.brought();
        for own in nodes.all[..nodes.given].iter().chain(&brought) {
            // of one that is not there, as of a body: that is told, and not what follows
            let item = self.item_of(own);
            let section = item.map(|item| self.declared[item].section);
            for (what, is_vector, _) in section.and_then(|own| own.nodes).map_or(OF_BODY, |own| own.known) {
                self.scope.add_known(&format!("{}.{what}", own.key), *is_vector);
            }
            let states =
                item.filter(|_| section.is_some_and(|own| own.name == "state")).map(|item| names_of(&self.raws[item]).0);
            for (state, _) in states.unwrap_or_default() {
                self.scope.add_known(&format!("{}.{state}", own.key), false);
            }
        }
        if self.declared[item].section.name == "state" {
            let (states, are_named, _) = names_of(raw);
            for (state, at) in states {
                if !are_named {
                    self.scope.add_known(&unnamed(&state), false);
                    continue;
                }
                self.check_name(&state, at);
                if self.scope.knows_beside(file, &state) {
                    self.wrong(at, format!("\"{state}\" is a name here already: take another one"));
                }
                self.scope.add_known(&state, false);
            }
        }
        self.scope.add_known(TIME, false);
        for (name, state) in self.read_states(raw, path) {
            let (outputs, of_state) = self.outputs(file, state, path);
            for (output, _, formula) in outputs {
                let place = |own: usize| match of_state.name_at(own) {
                    Some((of, which)) if own >= file.count => {
                        let here = match of.rsplit_once('.') {
                            _ if of == TIME => TIME.into(),
                            Some((node, what)) if !node.is_empty() => {
                                format!("{}.{what}", nodes.name(&format!("{name}.{node}")))
                            }
                            _ => format!("{name}.{}", of.trim_start_matches('.')),
                        };
                        self.scope.place(&here).map_or(own, |first| first + which)
                    }
                    _ => own,
                };
                let formula = formula.moved(place);
                self.scope.add(&format!("{name}.{output}"), Meaning::Formula(formula));
            }
        }
        brought
    }

    /// Outputs of a state as formulas in the scope of its own, which is returned with them; what is wrong in it is told where it is read.
    fn outputs(&mut self, file: &Scope, state: usize, path: &mut Vec<usize>) -> (Formulas, Scope) {
        let (raw, before) = (self.raws[state].clone(), self.mistakes.len());
        let outer = std::mem::replace(&mut self.scope, file.clone());
        path.push(state);
        self.add_names(file, state, &raw, path);
        path.pop();
        self.take_definitions(file, &raw);
        let outputs = self.outputs_of(&raw);
        self.mistakes.truncate(before);
        (outputs, std::mem::replace(&mut self.scope, outer))
    }

    /// Adds to the scope of the file the names that an entry gives to formulas of its nodes.
    fn take_definitions(&mut self, file: &Scope, raw: &Raw) {
        self.take_own_tables(raw);
        let Some(given) = raw.get("define") else { return };
        let wanted = "with formulas, as in { speed = \"norm(tip.velocity)\" }";
        self.named(given, "define", wanted, |reader, own| {
            reader.check_name(&own.key, own.at);
            if reader.scope.knows_beside(file, &own.key) {
                reader.wrong(own.at, format!("\"{}\" is a name here already: take another one", own.key));
            }
            let formula = reader.number_or_vector(&own.value, &format!("define: {}", own.key))?;
            reader.scope.add(&own.key, Meaning::Formula(formula));
            Some(())
        });
    }
}
