//! Tables that were written as CSV, read back.

use std::path::Path;

/// Reads a CSV file of numbers behind a line of names, as [`write_csv`](super::write_csv) writes it.
///
/// # Errors
/// The file, and the line that cannot be read.
pub fn read_csv(path: &Path) -> Result<(Vec<String>, Vec<Vec<f64>>), String> {
    let failed = |cause: String| format!("cannot read {}: {cause}", path.display());
    let text = std::fs::read_to_string(path).map_err(|cause| failed(cause.to_string()))?;
    let mut lines = text.lines().enumerate();
    let header =
        lines.next().and_then(|(_, line)| fields(line)).ok_or_else(|| failed("line 1 is no list of names".into()))?;
    let mut rows = Vec::new();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let numbers: Result<Vec<f64>, &str> = line.split(',').map(|word| word.trim().parse().map_err(|_| word)).collect();
        let row = numbers.map_err(|word| failed(format!("line {}: \"{word}\" is not a number", index + 1)))?;
        if row.len() != header.len() {
            let (found, expected) = (row.len(), header.len());
            return Err(failed(format!("line {} has {found} numbers, but there are {expected} names", index + 1)));
        }
        rows.push(row);
    }
    Ok((header, rows))
}

/// What stands between the commas of a line, some of it quoted; `None` for a quote without its end, and for nothing at all.
pub(crate) fn fields(line: &str) -> Option<Vec<String>> {
    let (mut fields, mut field, mut quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => field.extend(letters.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(std::mem::take(&mut field)),
            letter => field.push(letter),
        }
    }
    fields.push(field);
    (!quoted && fields.iter().any(|field| !field.is_empty())).then_some(fields)
}

#[cfg(test)]
mod tests {
    use super::super::file::tests::Folder;
    use super::super::{write_csv, write_file};
    use super::*;

    #[test]
    fn what_was_written_is_read_bit_for_bit() {
        let folder = Folder::new("read");
        let path = folder.0.join("table.csv");
        let header = vec!["t [s]".to_string(), "x, \"y\"".into()];
        let rows = vec![vec![0.1, 1.0 / 3.0], vec![f64::MIN_POSITIVE / 8.0, f64::NEG_INFINITY], vec![-0.0, 1e300]];
        write_csv(&path, &header, rows.clone().into_iter()).unwrap();
        assert_eq!(read_csv(&path).unwrap(), (header, rows));
    }

    #[test]
    fn a_file_that_is_no_table_is_refused_with_its_line() {
        let folder = Folder::new("no-table");
        let path = folder.0.join("t.csv");
        for (text, part) in [
            ("", "line 1"),
            ("a,\"b\n", "line 1"),
            ("a,b\n1,2\n3\n", "line 3 has 1 numbers, but there are 2 names"),
            ("a,b\n1,two\n", "line 2: \"two\" is not a number"),
        ] {
            write_file(&path, text.as_bytes()).unwrap();
            let message = read_csv(&path).unwrap_err();
            assert!(message.contains(part) && message.contains("t.csv"), "{message}");
        }
        assert!(read_csv(&folder.0.join("missing.csv")).unwrap_err().contains("missing.csv"));
    }
}
