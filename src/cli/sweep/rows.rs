//! sweep.csv: a row for each design, added when it is finished, read again by `--resume`, sorted at the end; with the feature `arrow` its numbers
//! as sweep.arrow, too.

use super::variation::Variation;
use crate::earlier::keep_earlier;
use crate::failure::Failure;
use crate::io::{IoError, fields, quoted, write_file};
use costate::exchange::sent_by_fields;
use costate::history::check_place;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What came of one design.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Values of the functionals, and their derivatives if these are asked for; NaN where the design failed.
    pub values: Vec<f64>,
    /// A whole number for what these follow from: laws, numbers, method, settings; NaN for a design that cannot be built.
    pub fingerprint: f64,
    pub failed: bool,
    /// Why, or warnings about the run.
    pub message: String,
}

sent_by_fields!(Outcome { values, fingerprint, failed, message });

/// What came of each design, where it is finished.
pub type Outcomes = Vec<Option<Outcome>>;

/// The file while a sweep goes on. It is locked: a second sweep does not write into it.
pub struct Rows {
    path: PathBuf,
    header: String,
    file: File,
    /// Length of its whole rows.
    end: usize,
}

const STATES: [&str; 2] = ["done", "failed"];

/// The first line: number, variables, functionals and derivatives by their names, fingerprint, state, message.
fn header(numbers: &[String]) -> String {
    let names: Vec<String> = numbers.iter().map(|name| quoted(name)).collect();
    format!("number,{},fingerprint,status,message\n", names.join(","))
}

/// The row of a design, numbered from 1 on, with its values of the variables that vary.
pub fn row(number: usize, point: &[f64], Outcome { values, fingerprint, failed, message }: &Outcome) -> String {
    let numbers: String = point.iter().chain(values).chain([fingerprint]).map(|value| format!("{value:.16e},")).collect();
    format!("{number},{numbers}{},{}\n", STATES[usize::from(*failed)], quoted(&message.replace(['\n', '\r'], " ")))
}

fn locked(path: &Path, options: &OpenOptions) -> io::Result<File> {
    check_place(path)?;
    let file = options.open(path)?;
    file.try_lock().map_err(|cause| io::Error::other(format!("another sweep is writing it: {cause}")))?;
    Ok(file)
}

impl Rows {
    /// Begins a file with the names of its numbers; an earlier one keeps its rows under another name.
    pub fn begin(path: &Path, names: &[String]) -> Result<Self, Failure> {
        let cannot = |cause: io::Error| Failure::input(format!("cannot write {}: {cause}", path.display()));
        if path.is_file() {
            locked(path, File::options().read(true)).map_err(cannot)?;
        }
        keep_earlier(path)?;
        let file = locked(path, File::options().write(true).create_new(true)).map_err(cannot)?;
        Ok(Rows { path: path.to_path_buf(), header: header(names), file, end: 0 })
    }

    /// Goes on with a file: its rows are what is finished. A last line that was not written whole counts as not there.
    pub fn resume(path: &Path, names: &[String], variation: &Variation) -> Result<(Self, Outcomes), Failure> {
        let refused = |message: String| Failure::input(format!("--resume {}: {message}", path.display()));
        let header = header(names);
        let mut file = locked(path, File::options().read(true).write(true)).map_err(|cause| refused(cause.to_string()))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|cause| refused(cause.to_string()))?;
        let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        if end == 0 && !header.as_bytes().starts_with(&bytes) {
            return Err(refused("it is no table of a sweep".into()));
        }
        bytes.truncate(end);
        let text = String::from_utf8(bytes).map_err(|cause| refused(cause.to_string()))?;
        let outcomes = outcomes(&text, &header, variation).map_err(refused)?;
        Ok((Rows { path: path.to_path_buf(), header, file, end: text.len() }, outcomes))
    }

    /// Cuts off what is no whole row, once it is known that the file is of this sweep.
    pub fn cut(&mut self) -> Result<(), IoError> {
        let mut cut = || {
            self.file.set_len(self.end as u64)?;
            self.file.seek(SeekFrom::End(0))?;
            self.file.write_all(if self.end == 0 { self.header.as_bytes() } else { b"" })
        };
        cut().map_err(|cause: io::Error| IoError::new(&self.path, cause))
    }

    pub fn add(&mut self, row: &str) -> Result<(), IoError> {
        self.file.write_all(row.as_bytes()).map_err(|cause| IoError::new(&self.path, cause))
    }

    /// Puts the rows in the order of their numbers.
    pub fn sort(self, outcomes: &[Option<Outcome>], variation: &Variation) -> Result<(), IoError> {
        let rows = outcomes.iter().zip(&variation.points).enumerate();
        let rows = rows.filter_map(|(place, (outcome, point))| Some(row(place + 1, point, outcome.as_ref()?)));
        write_file(&self.path, (self.header + &rows.collect::<String>()).as_bytes())
    }
}

/// The numbers of the finished rows as columns, with 1 where a design failed and 0 where it did not.
#[cfg(feature = "arrow")]
pub fn write_columns(path: &Path, names: &[String], outcomes: &Outcomes, variation: &Variation) -> Result<(), IoError> {
    let names = [&["number".to_string()], names, &["fingerprint".to_string(), "failed".to_string()]].concat();
    let mut file = crate::io::ArrowFile::create(path, &names)?;
    for (place, (outcome, point)) in outcomes.iter().zip(&variation.points).enumerate() {
        if let Some(Outcome { values, fingerprint, failed, .. }) = outcome {
            file.row(&[&[(place + 1) as f64], &point[..], values, &[*fingerprint, f64::from(*failed)]].concat())?;
        }
    }
    file.finish()
}

/// What the lines of a file say.
fn outcomes(text: &str, header: &str, variation: &Variation) -> Result<Outcomes, String> {
    let mut outcomes = vec![None; variation.points.len()];
    let mut lines = text.lines().zip(1..);
    let Some((names, _)) = lines.next() else { return Ok(outcomes) };
    if names != header.trim_end() {
        return Err(format!(
            "its columns are {names}, but those of this sweep are {}: it is of another scene or variation; without --resume \
             it is kept under another name",
            header.trim_end()
        ));
    }
    let columns = fields(header.trim_end()).map_or(0, |fields| fields.len());
    for (line, number) in lines {
        let (place, outcome) = read(line, columns, variation).map_err(|message| format!("line {number}: {message}"))?;
        if outcomes[place].replace(outcome).is_some() {
            return Err(format!("line {number}: the design {} stands there twice", place + 1));
        }
    }
    Ok(outcomes)
}

/// A row as [`row`] writes it.
fn read(line: &str, columns: usize, variation: &Variation) -> Result<(usize, Outcome), String> {
    let no_row = || format!("\"{line}\" is no row of a sweep");
    let words = fields(line).filter(|words| words.len() == columns).ok_or_else(no_row)?;
    let (numbers, words) = words.split_at(columns - 2);
    let number = numbers[0].parse::<usize>().map_err(|_| no_row())?;
    let numbers: Vec<f64> = numbers[1..].iter().map(|word| word.parse()).collect::<Result<_, _>>().map_err(|_| no_row())?;
    let failed = STATES.iter().position(|state| *state == words[0]).ok_or_else(no_row)? == 1;
    let (design, values) = numbers.split_at(variation.axes.len());
    let (&fingerprint, values) = values.split_last().ok_or_else(no_row)?;
    let place = number.wrapping_sub(1);
    let point = variation.points.get(place).ok_or_else(|| {
        format!("there is a design {number}, but this sweep has {}: it is of another variation", variation.points.len())
    })?;
    if point != design {
        return Err(format!("design {number} is {design:?}, but {point:?} in this sweep: it is of another variation"));
    }
    Ok((place, Outcome { values: values.to_vec(), fingerprint, failed, message: words[1].clone() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let variation = Variation { axes: Vec::new(), points: vec![Vec::new(); 3], words: String::new() };
        let (values, message) = (vec![0.1, 1.0 / 3.0], "a, \"b\"\nc".into());
        let outcome = Outcome { values, fingerprint: 9007199254740991.0, failed: true, message };
        let (place, read) = read(row(3, &[], &outcome).trim_end(), 6, &variation).expect("a row");
        assert_eq!((place, &read.message[..], read.failed), (2, "a, \"b\" c", true));
        assert_eq!((read.values, read.fingerprint), (outcome.values, 9007199254740991.0));
    }
}
