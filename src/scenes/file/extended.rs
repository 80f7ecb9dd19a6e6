//! A file that extends another: what it says is put into what the other says, as a scenario's is.

use super::mistake::{Mistake, Source};
use super::raw::{KeyValue, Raw, RawValue, put};
use crate::scenes::file_bytes;
use std::path::Path;

/// The key that names the other file.
pub(super) const EXTENDS: &str = "extends";
/// What a file says of itself alone.
const OWN: [&str; 2] = ["name", "summary"];
/// Largest scene file in bytes.
const LARGEST: u64 = 50_000_000;

/// The text of a file.
pub(super) fn text_of(path: &Path) -> Result<String, String> {
    let name = path.display().to_string();
    let bytes = file_bytes(path, "a scene file", LARGEST).map_err(|why| format!("{name}: {why}"))?;
    String::from_utf8(bytes.into_owned()).map_err(|error| {
        let before = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
        let at = before.len();
        Source::new(name, before).told(&Mistake::new(at, "this is no text in UTF-8"))
    })
}

/// The tree of a file: what it says put into what that says which it extends, and so on.
pub(super) fn whole_tree(source: &mut Source) -> Result<Raw, String> {
    let parse = |source: &Source| Raw::parse(&source.first().text).map_err(|mistake| source.told(&mistake));
    let mut whole = parse(source)?;
    let mut changes = Vec::new();
    while let Some((name, text)) = extended(source, &whole)? {
        source.extend(name, text);
        changes.push(std::mem::replace(&mut whole, parse(source)?));
    }
    for (mut own, from) in changes.into_iter().rev().zip(source.starts().skip(1)) {
        own.move_by(from);
        if let RawValue::Table(entries) = &mut whole.value {
            entries.retain(|entry| !OWN.contains(&entry.key.as_str()));
        }
        let entries: &[KeyValue] = own.key_values();
        entries.iter().try_for_each(|entry| put(&mut whole, entry, &entry.key)).map_err(|mistake| source.told(&mistake))?;
        whole.at = own.at;
    }
    Ok(whole)
}

/// Name and text of what the first file of a source extends, whose tree this is.
fn extended(source: &Source, tree: &Raw) -> Result<Option<(String, String)>, String> {
    let Some(named) = tree.get(EXTENDS) else { return Ok(None) };
    let wrong = |what: String| source.told(&Mistake::new(named.at, what));
    let Some(file) = named.text().filter(|file| !file.is_empty() && !file.contains(['/', '\\'])) else {
        return Err(wrong(format!("{EXTENDS} is {}; it names a scene file in the same folder", named.words())));
    };
    let path = Path::new(&source.first().name).with_file_name(file);
    let name = path.display().to_string();
    if source.has(&name) {
        return Err(wrong(format!("{EXTENDS} = \"{file}\": the file extends itself")));
    }
    let text = text_of(&path).map_err(|why| wrong(format!("{EXTENDS} = \"{file}\": {why}")))?;
    Ok(Some((name, text)))
}
