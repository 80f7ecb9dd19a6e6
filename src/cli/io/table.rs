//! Numbers as text: CSV for programs, aligned columns for people.

use super::file::{Aside, IoError};
use costate::exchange::is_first;
use serde_json::{Value, json};
use std::fmt;
use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

/// Writes a CSV file; see `CsvFile`.
///
/// # Errors
/// Those of `CsvFile`; no file is left then.
pub fn write_csv(path: &Path, header: &[String], rows: impl Iterator<Item = Vec<f64>>) -> Result<(), IoError> {
    let mut file = CsvFile::create(path, header)?;
    for row in rows {
        file.row(&row)?;
    }
    file.finish()
}

/// A CSV file that is written row by row: one header line, then one line per row with 17 significant digits, so that reading gives
/// the same bits. It appears under its name when it is finished, and not at all if it is dropped before; while it is written it is called
/// `NAME.unfinished.csv` and is locked. Rows behind one that could not be written are refused; those before it remain.
///
/// Header names that contain a comma, a quote or a line break are quoted. Numbers read `NaN`, `inf` and `-inf` where they are.
pub struct CsvFile {
    path: PathBuf,
    aside: Aside,
    out: File,
    /// Lines that are not in the file yet.
    text: Vec<u8>,
    /// Where each of these lines ends.
    ends: Vec<usize>,
    columns: usize,
    /// Rows that came, written or refused.
    rows: usize,
    /// A row could not be written.
    is_cut: bool,
}

/// Bytes that are written at once.
const AT_ONCE: usize = 1 << 16;

impl CsvFile {
    /// Begins a file with its header, creating missing folders.
    ///
    /// # Errors
    /// A folder that cannot be created, or a file that cannot be written.
    pub fn create(path: &Path, header: &[String]) -> Result<Self, IoError> {
        let aside = Aside::unfinished(path)?;
        let open = || -> io::Result<File> {
            let out = File::options().write(true).create(true).truncate(false).open(&aside.part)?;
            if is_first() {
                out.try_lock()
                    .map_err(|cause| io::Error::other(format!("{} is being written: {cause}", aside.part.display())))?;
            }
            // of a device there is nothing to be cut off
            let _ = out.set_len(0);
            Ok(out)
        };
        let out = match open() {
            Ok(out) => out,
            Err(cause) => {
                // another's is not removed
                std::mem::forget(aside);
                return Err(IoError::new(path, cause));
            }
        };
        let names: Vec<_> = header.iter().map(|name| quoted(name)).collect();
        let text = format!("{}\n", names.join(",")).into_bytes();
        let (path, ends, columns) = (path.to_path_buf(), vec![text.len()], header.len());
        let mut own = CsvFile { path, aside, out, text, ends, columns, rows: 0, is_cut: false };
        let written = own.write();
        own.checked(written)?;
        Ok(own)
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A row whose length is not that of the header, or a file that cannot be written.
    pub fn row(&mut self, row: &[f64]) -> Result<(), IoError> {
        let written = self.add(row);
        self.rows += 1;
        self.checked(written)
    }

    fn add(&mut self, row: &[f64]) -> io::Result<()> {
        if self.is_cut {
            return Err(io::Error::other("an earlier row could not be written"));
        }
        let (index, found, expected) = (self.rows, row.len(), self.columns);
        if found != expected {
            return Err(io::Error::other(format!("row {index} has {found} numbers, the header has {expected} names")));
        }
        for (column, value) in row.iter().enumerate() {
            let comma = if column == 0 { "" } else { "," };
            write!(self.text, "{comma}{value:.16e}")?;
        }
        self.text.push(b'\n');
        self.ends.push(self.text.len());
        if self.text.len() < AT_ONCE { Ok(()) } else { self.write() }
    }

    /// Writes whole lines: where that fails, as many as there is room for.
    fn write(&mut self) -> io::Result<()> {
        let begin = self.out.stream_position()?;
        let Err(cause) = self.out.write_all(&self.text) else {
            self.text.clear();
            self.ends.clear();
            return Ok(());
        };
        self.is_cut = true;
        let there = self.out.stream_position()?.saturating_sub(begin);
        let whole = self.ends.iter().rev().find(|&&end| end as u64 <= there).map_or(0, |&end| end as u64);
        let _ = self.out.set_len(begin + whole);
        self.text.clear();
        Err(cause)
    }

    fn checked(&self, written: io::Result<()>) -> Result<(), IoError> {
        written.map_err(|cause| IoError::new(&self.path, cause))
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written or renamed.
    pub fn finish(mut self) -> Result<(), IoError> {
        let written = self.write();
        self.checked(written)?;
        self.aside.publish()
    }

    /// Gives the file its name with the rows that could be written.
    ///
    /// # Errors
    /// As for [`CsvFile::finish`], but for a row that was refused already.
    pub fn finish_cut(mut self) -> Result<(), IoError> {
        let written = if self.is_cut { Ok(()) } else { self.write() };
        let checked = self.checked(written);
        self.aside.publish().and(checked)
    }
}

/// What stands in a field of a CSV file.
pub(crate) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// Up to six significant digits: `0`, `12`, `0.125`, `3.14159`, `1.2e-9`, `nan`.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string().to_lowercase();
    }
    if value == 0.0 {
        return "0".into();
    }
    let scientific = format!("{value:.5e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        trimmed(&format!("{value:.*}", (5 - exponent) as usize)).to_owned()
    } else {
        format!("{}e{exponent}", trimmed(digits))
    }
}

fn trimmed(decimal: &str) -> &str {
    if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal }
}

/// Thirteen digits, all of which a gradient deserves: ` 5.864291303063e+01`; zero as 0.
pub fn long_number(value: f64) -> String {
    if value == 0.0 {
        return format!("{:>19}", 0);
    }
    let text = format!("{value:.12e}");
    match text.split_once('e') {
        Some((digits, exponent)) => {
            let (sign, size) = exponent.strip_prefix('-').map_or(('+', exponent), |size| ('-', size));
            format!("{digits:>15}e{sign}{size:0>2}")
        }
        None => format!("{text:>19}"),
    }
}

/// One entry of a [`Table`]: its words for people, set flush left, or flush right where it is a number, and its value for programs.
#[derive(Debug, Clone, Default)]
pub struct Cell {
    words: String,
    value: Value,
    is_number: bool,
}

impl Cell {
    /// Words for what is something else in JSON.
    pub fn of(words: impl Into<String>, value: impl Into<Value>) -> Self {
        Cell { words: words.into(), value: value.into(), is_number: false }
    }

    /// A whole number.
    pub fn count(number: &Value) -> Self {
        Cell { is_number: true, ..Cell::of(number.to_string(), number.clone()) }
    }

    /// A number in the digits of [`long_number`].
    pub fn long(value: f64) -> Self {
        Cell::of(long_number(value), value)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::of(text, text)
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Self {
        Cell::of(text, text.as_str())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::from(&text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell { is_number: true, ..Cell::of(number(value), value) }
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Cell::count(&count.into())
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(own: Option<T>) -> Self {
        own.map_or_else(Cell::default, Into::into)
    }
}

/// Cells of what can be one.
macro_rules! cells {
    ($($own:expr),* $(,)?) => { [$($crate::io::Cell::from($own)),*] };
}
pub(crate) use cells;

/// A table, for the console, where `println!("{table}")` prints it with aligned columns, for JSON, and for pages.
#[derive(Debug, Clone, Default)]
pub struct Table {
    header: Vec<String>,
    keys: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table with the given column names, which are keys in JSON, too.
    pub fn new(header: &[impl AsRef<str>]) -> Self {
        let header: Vec<String> = header.iter().map(|name| name.as_ref().to_owned()).collect();
        Self { keys: header.clone(), header, rows: Vec::new() }
    }

    /// With other keys: none for a column that is for people only, `a.b` for one in an object.
    #[must_use]
    pub fn keyed(mut self, keys: &[&str]) -> Self {
        self.keys = keys.iter().map(|&key| key.to_owned()).collect();
        self
    }

    /// Adds a row; missing cells stay empty, and cells beyond the header get a column without a name.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) -> &mut Self {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// Whether it has no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// A list of its rows, each an object.
    pub fn json(&self) -> Vec<Value> {
        let object = |row: &Vec<Cell>| {
            let mut object = json!({});
            for (keys, cell) in self.keys.iter().zip(row).filter(|(key, _)| !key.is_empty()) {
                *keys.split('.').fold(&mut object, |own, key| &mut own[key]) = cell.value.clone();
            }
            object
        };
        self.rows.iter().map(object).collect()
    }

    /// What a page shows: it has its own words for numbers.
    pub(crate) fn for_page(&self, heading: &str) -> Value {
        let cell = |own: &Cell| if own.is_number { own.value.clone() } else { own.words.trim().into() };
        let rows: Vec<Vec<Value>> = self.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
        json!({"heading": heading, "columns": self.header, "rows": rows})
    }

    /// As a table of Markdown.
    pub fn markdown(&self) -> String {
        let line = |words: Vec<String>| format!("| {} |\n", words.join(" | "));
        let marks = self.header.iter().enumerate();
        let marks = marks.map(|(column, _)| if self.has_numbers(column) { "---:" } else { "---" });
        let rows = self.rows.iter().map(|row| line(row.iter().map(|cell| cell.words.replace('|', "\\|")).collect()));
        let head = [line(self.header.clone()), format!("|{}|\n", marks.collect::<Vec<_>>().join("|"))];
        head.into_iter().chain(rows).collect()
    }

    /// Whether a column is set flush right, header included.
    fn has_numbers(&self, column: usize) -> bool {
        self.rows.iter().any(|row| row.get(column).is_some_and(|cell| cell.is_number))
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).chain([self.header.len()]).max().unwrap_or(0);
        let text = |row: &[Cell], column: usize| row.get(column).map_or_else(String::new, |cell| cell.words.clone());
        let name = |column| self.header.get(column).cloned().unwrap_or_default();
        let width = |column| {
            let cells = self.rows.iter().map(|row| text(row, column).chars().count());
            cells.chain([name(column).chars().count()]).max().unwrap_or(0)
        };
        let layout: Vec<_> = (0..columns).map(|column| (width(column), self.has_numbers(column))).collect();
        let line = |cells: Vec<String>| {
            let padded: Vec<_> = cells
                .iter()
                .zip(&layout)
                .map(|(cell, &(width, right))| if right { format!("{cell:>width$}") } else { format!("{cell:<width$}") })
                .collect();
            padded.join("  ").trim_end().to_owned()
        };
        writeln!(f, "{}", line((0..columns).map(name).collect()))?;
        write!(f, "{}", layout.iter().map(|&(width, _)| "-".repeat(width)).collect::<Vec<_>>().join("  "))?;
        for row in &self.rows {
            write!(f, "\n{}", line((0..columns).map(|column| text(row, column)).collect()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::file::tests::Folder;
    use super::*;

    #[test]
    fn a_ragged_row_is_an_error_and_leaves_no_file() {
        let folder = Folder::new("ragged");
        let header = ["a".into(), "b".into()];
        let rows = [vec![1.0, 2.0], vec![3.0]].into_iter();
        let error = write_csv(&folder.0.join("r.csv"), &header, rows).unwrap_err().to_string();
        assert!(error.contains("r.csv: row 1 has 1 numbers, the header has 2 names"), "{error}");
        assert!(folder.names().is_empty());
    }

    #[test]
    fn numbers_have_a_sensible_width() {
        let cases = [(0.0, "0"), (12.0, "12"), (0.125, "0.125"), (std::f64::consts::PI, "3.14159"), (1.2e-9, "1.2e-9")];
        let more = [(999_999.7, "1e6"), (123_456.4, "123456"), (0.0001, "0.0001"), (-2.5e12, "-2.5e12"), (f64::NAN, "nan")];
        for (value, text) in cases.into_iter().chain(more) {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["name", "value"]);
        table.row(cells!["order", 3.98]).row(cells!["error, largest", 1.5e-12]).row(cells!["none", None::<f64>]);
        let expected = "\
name              value
--------------  -------
order              3.98
error, largest  1.5e-12
none";
        assert_eq!(table.to_string(), expected);
    }
}
