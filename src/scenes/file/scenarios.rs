//! Scenarios of a file: the same mechanism with other numbers, loads, drives, settings.

use super::extended::EXTENDS;
use super::mistake::Mistake;
use super::raw::{Entry, Raw, RawValue};
use crate::scenes::unknown;

/// The section of scenarios.
pub(super) const SCENARIO: &str = "scenario";
/// Sections that all scenarios share.
const SHARED: [&str; 5] = ["version", EXTENDS, "name", "variable", "optimization"];

/// Takes the scenarios out of a file: their names, and the whole file as each makes it.
///
/// # Errors
/// What no scenario can say.
pub(super) fn take_scenarios(root: &mut Raw) -> Result<Vec<(String, Raw)>, Vec<Mistake>> {
    let RawValue::Table(entries) = &mut root.value else { return Ok(Vec::new()) };
    let Some(place) = entries.iter().position(|entry| entry.key == SCENARIO) else { return Ok(Vec::new()) };
    let Entry { at, value, .. } = entries.remove(place);
    let RawValue::List(list) = value.value else {
        return Err(vec![Mistake::new(at, "scenario must be written as [[scenario]]")]);
    };
    let mut scenarios: Vec<(String, Raw)> = Vec::new();
    let mut mistakes = Vec::new();
    for own in list {
        match scenario(root, &own) {
            Ok((name, _)) if scenarios.iter().any(|other| other.0 == name) => {
                mistakes.push(Mistake::new(own.at, format!("two scenarios are named \"{name}\"")));
            }
            Ok(made) => scenarios.push(made),
            Err(mistake) => mistakes.push(mistake),
        }
    }
    if mistakes.is_empty() { Ok(scenarios) } else { Err(mistakes) }
}

/// A file without its problem, which speaks of all scenarios.
pub(super) fn without_problem(root: &Raw) -> Raw {
    let mut whole = root.clone();
    if let RawValue::Table(entries) = &mut whole.value {
        entries.retain(|entry| entry.key != "optimization");
    }
    whole
}

/// The name of a scenario and the file that it makes of the one without scenarios.
fn scenario(root: &Raw, own: &Raw) -> Result<(String, Raw), Mistake> {
    let entries = own.entries().ok_or_else(|| Mistake::new(own.at, "a scenario is a table"))?;
    let name = own.get("name").and_then(Raw::text).filter(|name| !name.is_empty());
    let name = name.ok_or_else(|| Mistake::new(own.at, "[[scenario]] needs the key name, a text"))?;
    if name.contains(['/', '\\', '[', ']']) {
        return Err(Mistake::new(own.at, format!("the name \"{name}\" of a scenario cannot have / \\ [ ] in it")));
    }
    let mut whole = without_problem(root);
    for entry in entries.iter().filter(|entry| entry.key != "name") {
        if SHARED.contains(&entry.key.as_str()) {
            return Err(Mistake::new(entry.at, format!("{} is the same in all scenarios", entry.key)));
        }
        put(&mut whole, entry, &entry.key)?;
    }
    Ok((name.into(), whole))
}

/// Puts a key into a table: tables into tables key by key, tables into lists by the names of their entries, entries of lists into those of
/// their names or behind them; all else, and a table with another type, in the place of what was there.
pub(super) fn put(into: &mut Raw, entry: &Entry, path: &str) -> Result<(), Mistake> {
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
        (RawValue::List(list), RawValue::List(more)) if list.iter().all(|own| own.entries().is_some()) => {
            more.iter().try_for_each(|own| change_or_add(list, own, path))
        }
        _ => {
            *own = entry.clone();
            Ok(())
        }
    }
}

/// Changes the entry of a list that has this name.
fn change_named(list: &mut [Raw], change: &Entry, path: &str) -> Result<(), Mistake> {
    let Some(place) = list.iter().position(|own| name_of(own) == change.key) else {
        let known: Vec<String> = list.iter().map(|own| name_of(own).into()).collect();
        return Err(Mistake::new(change.at, unknown(path, &change.key, &known)));
    };
    let Some(changes) = change.value.entries() else {
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
    change_named(list, &Entry { key: name.into(), at: own.at, value: own.clone() }, path)
}

fn name_of(own: &Raw) -> &str {
    own.get("name").and_then(Raw::text).unwrap_or_default()
}
