//! Tables from files: columns of numbers in a text (CSV).

use super::fields::{Columns, Fields, Value};
use super::reader::Reader;
use crate::scenes::file_bytes;
use std::path::Path;
use std::sync::Arc;

/// Largest file in bytes.
const LARGEST: u64 = 100_000_000;

impl Reader {
    /// Puts the numbers of a file in its place, and says what is missing where there is none.
    pub(super) fn with_columns(&mut self, mut fields: Fields) -> Fields {
        if !matches!(fields.form, "table" | "lines" | "") {
            return fields;
        }
        let own_place = |key: &str| fields.values.iter().find(|own| own.0 == key).map(|own| own.1);
        let (file, given) = (own_place("file"), own_place("times").or(own_place("points")));
        if file.is_none() {
            if let Some(at) = own_place("columns") {
                self.wrong(at, "columns are those of a file: give the key file, too");
            }
            return fields;
        }
        if let Some(at) = given.or(own_place("values")) {
            self.wrong(at, "a file gives the points and the values: leave either these or the file out");
            return fields;
        }
        let mut columns: Vec<Value> = fields.list("columns").map(|own| own.1.clone()).collect();
        if columns.is_empty() {
            columns = vec![Value::Count(1), Value::Count(2)];
        }
        columns.extend(fields.text("deviations").map(|name| Value::Text(name.into())));
        if let Some((_, at, value)) = fields.values.iter_mut().find(|own| own.0 == "file")
            && let Value::Text(file) = value
        {
            match read(&self.folder.join(&file), &columns) {
                Ok(columns) => *value = Value::Columns(Arc::new(columns)),
                Err(why) => {
                    let text = format!("file, \"{file}\": {why}");
                    self.wrong(*at, text);
                }
            }
        }
        fields
    }
}

/// Numbers of columns, each by the name that the first line gives it, or by its number from 1 on.
fn read(path: &Path, columns: &[Value]) -> Result<Columns, String> {
    let bytes = file_bytes(path, "a table", LARGEST)?;
    parse(std::str::from_utf8(&bytes).map_err(|error| format!("cannot be read: it is no text: {error}"))?, columns)
}

/// What stands between numbers: what the first line has of these.
fn separator(line: &str) -> Option<char> {
    [';', '\t', ','].into_iter().find(|&own| line.contains(own))
}

/// The cells of a line, without blanks and quotation marks around them.
fn cells(line: &str, separator: Option<char>) -> Vec<&str> {
    match separator {
        Some(separator) => line.split(separator).map(|cell| cell.trim().trim_matches('"')).collect(),
        None => line.split_whitespace().map(|cell| cell.trim_matches('"')).collect(),
    }
}

/// The name of a column, and the unit in brackets behind it.
fn name_and_unit(head: &str) -> (&str, Option<&str>) {
    let inside = |open: char, close: char| head.strip_suffix(close)?.split_once(open);
    match inside('[', ']').or_else(|| inside('(', ')')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (head, None),
    }
}

fn parse(text: &str, columns: &[Value]) -> Result<Columns, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_filled = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
    let mut lines = (1..).zip(text.lines()).filter(is_filled).peekable();
    let Some(&(_, first)) = lines.peek() else { return Err("it has no lines with numbers".into()) };
    let separator = separator(first);
    let head = cells(first, separator);
    let has_names = head.iter().all(|cell| cell.parse::<f64>().is_err());
    if has_names {
        lines.next();
    }
    let place = |column: &Value| match column {
        Value::Count(number) if (1..=head.len()).contains(number) => Ok(number - 1),
        Value::Count(number) => Err(format!("there is no column {number}: its first line has {}", head.len())),
        Value::Text(name) if !has_names => Err(format!(
            "its first line, \"{first}\", does not name columns, so that none is \"{name}\": give their numbers"
        )),
        Value::Text(name) => head
            .iter()
            .position(|own| own == name)
            .or_else(|| head.iter().position(|own| name_and_unit(own).0 == name))
            .ok_or_else(|| format!("its first line names no column \"{name}\"; there are {}", head.join(", "))),
        _ => unreachable!("a column has a name or a number"),
    };
    let places = columns.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let called =
        |place: usize| if has_names { format!("column \"{}\"", head[place]) } else { format!("column {}", place + 1) };
    let mut numbers = vec![Vec::new(); places.len()];
    for (line, own) in lines {
        let cells = cells(own, separator);
        for (list, place) in numbers.iter_mut().zip(&places) {
            let Some(cell) = cells.get(*place) else {
                return Err(format!("line {line} ends before {}", called(*place)));
            };
            match cell.parse::<f64>() {
                Ok(number) if number.is_finite() => list.push(number),
                _ => return Err(format!("line {line}, {}: \"{cell}\" is no finite number", called(*place))),
            }
        }
        if let [.., before, last] = numbers[0][..]
            && last <= before
        {
            return Err(format!("line {line}, {}: {last} does not increase after {before}", called(places[0])));
        }
    }
    match numbers[0].len() {
        0 | 1 => Err(format!("it has {} lines of numbers, and a table needs 2 or more", numbers[0].len())),
        _ => {
            let unit = |&place: &usize| name_and_unit(head[place]).1.filter(|_| has_names).map(String::from);
            Ok(Columns { units: places.iter().map(unit).collect(), numbers })
        }
    }
}
