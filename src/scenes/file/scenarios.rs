//! Scenarios of a file: the same mechanism with other numbers, loads, drives, settings.

use super::extended::EXTENDS;
use super::mistake::Mistake;
use super::raw::{KeyValue, Raw, RawValue, put};
use crate::scenes::check_folders;

/// The section of scenarios.
pub(super) const SCENARIO: &str = "scenario";
/// Sections that all scenarios share.
const SHARED: [&str; 7] = ["version", EXTENDS, "name", "variable", "optimization", "measurement", "fit"];
/// Those that speak of all scenarios.
const OF_ALL: [&str; 3] = ["optimization", "measurement", "fit"];

/// Takes the scenarios out of a file: their names, and the whole file as each makes it.
pub(super) fn take_scenarios(root: &mut Raw) -> Result<Vec<(String, Raw)>, Vec<Mistake>> {
    let RawValue::Table(entries) = &mut root.value else { return Ok(Vec::new()) };
    let Some(place) = entries.iter().position(|entry| entry.key == SCENARIO) else { return Ok(Vec::new()) };
    let KeyValue { at, value, .. } = entries.remove(place);
    let RawValue::List(list) = value.value else {
        return Err(vec![Mistake::new(at, "scenario must be written as [[scenario]]")]);
    };
    let mut scenarios: Vec<(String, Raw)> = Vec::new();
    let mut mistakes = Vec::new();
    for own in list {
        match scenario(root, &own) {
            Ok(made) => {
                scenarios.push(made);
                if let Err((_, why)) = check_folders(scenarios.iter().map(|own| &*own.0)) {
                    mistakes.push(Mistake::new(own.at, format!("scenario: {why}")));
                    scenarios.pop();
                }
            }
            Err(mistake) => mistakes.push(mistake),
        }
    }
    if mistakes.is_empty() { Ok(scenarios) } else { Err(mistakes) }
}

/// A file without its problem and its measurements, which speak of all scenarios.
pub(super) fn without_problem(root: &Raw) -> Raw {
    let mut whole = root.clone();
    if let RawValue::Table(entries) = &mut whole.value {
        entries.retain(|entry| !OF_ALL.contains(&entry.key.as_str()));
    }
    whole
}

/// The name of a scenario and the file that it makes of the one without scenarios.
fn scenario(root: &Raw, own: &Raw) -> Result<(String, Raw), Mistake> {
    let entries = own.table().ok_or_else(|| Mistake::new(own.at, "a scenario is a table"))?;
    let name = own.get("name").and_then(Raw::text);
    let name = name.ok_or_else(|| Mistake::new(own.at, "[[scenario]] needs the key name, a text"))?;
    if name.contains(['[', ']']) {
        let text =
            format!("the name {name:?} of a scenario cannot have [ ] in it, between which it stands behind functionals");
        return Err(Mistake::new(own.at, text));
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
