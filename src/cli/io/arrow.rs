//! Tables of numbers as files of Apache Arrow: columns side by side, which other programs map into memory.

use super::file::{Aside, IoError};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Numbers that are kept before they are written.
const AT_ONCE: usize = 1 << 20;

/// A file of the Arrow IPC format (Feather version 2) that is written row by row. It appears under its name when it is finished, and not at
/// all if it is dropped before; while it is written it is called `NAME.unfinished.arrow`.
pub struct ArrowFile {
    path: PathBuf,
    aside: Aside,
    schema: Arc<Schema>,
    writer: FileWriter<BufWriter<File>>,
    columns: Vec<Vec<f64>>,
}

impl ArrowFile {
    /// Begins a file with the names of its columns, creating missing folders.
    ///
    /// # Errors
    /// A folder that cannot be created, or a file that cannot be written.
    pub fn create(path: &Path, names: &[String]) -> Result<Self, IoError> {
        let aside = Aside::unfinished(path)?;
        let file = File::create(&aside.part).map_err(|cause| IoError::new(path, cause))?;
        let fields: Vec<Field> = names.iter().map(|name| Field::new(name, DataType::Float64, false)).collect();
        let schema = Arc::new(Schema::new(fields));
        let writer = FileWriter::try_new(BufWriter::new(file), &schema).map_err(|cause| IoError::new(path, cause))?;
        Ok(ArrowFile { path: path.to_path_buf(), aside, schema, writer, columns: vec![Vec::new(); names.len()] })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A row whose length is not the number of columns, or a file that cannot be written.
    pub fn row(&mut self, row: &[f64]) -> Result<(), IoError> {
        if row.len() != self.columns.len() {
            let cause = format!("a row has {} numbers, but there are {} columns", row.len(), self.columns.len());
            return Err(IoError::new(&self.path, cause));
        }
        self.columns.iter_mut().zip(row).for_each(|(column, &number)| column.push(number));
        let numbers = self.columns.len() * self.columns.first().map_or(0, Vec::len);
        if numbers < AT_ONCE { Ok(()) } else { self.checked(Self::write) }
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), IoError> {
        self.checked(|own| {
            own.write()?;
            own.writer.finish()
        })?;
        drop(self.writer);
        self.aside.publish()
    }

    fn write(&mut self) -> Result<(), ArrowError> {
        let column = |numbers: &mut Vec<f64>| Arc::new(Float64Array::from(std::mem::take(numbers))) as ArrayRef;
        let columns: Vec<ArrayRef> = self.columns.iter_mut().map(column).collect();
        self.writer.write(&RecordBatch::try_new(self.schema.clone(), columns)?)
    }

    fn checked(&mut self, act: impl FnOnce(&mut Self) -> Result<(), ArrowError>) -> Result<(), IoError> {
        act(self).map_err(|cause| IoError::new(&self.path, cause))
    }
}

#[cfg(test)]
mod tests {
    use super::super::file::tests::Folder;
    use super::*;
    use arrow_ipc::reader::FileReader;

    #[test]
    fn columns_are_read_back_bit_for_bit_over_several_batches() {
        let folder = Folder::new("arrow");
        let path = folder.0.join("t.arrow");
        let mut file = ArrowFile::create(&path, &["t [s]".into(), "x, \"y\"".into()]).unwrap();
        let rows = AT_ONCE / 2 + 3;
        let number = |row: usize| if row == 7 { f64::NAN } else { row as f64 / 3.0 };
        (0..rows).for_each(|row| file.row(&[row as f64, number(row)]).unwrap());
        assert!(file.row(&[1.0]).unwrap_err().to_string().contains("1 numbers, but there are 2 columns"));
        file.finish().unwrap();
        assert_eq!(folder.names(), ["t.arrow"]);
        let reader = FileReader::try_new(File::open(&path).unwrap(), None).unwrap();
        let names: Vec<String> = reader.schema().fields().iter().map(|field| field.name().clone()).collect();
        assert_eq!(names, ["t [s]", "x, \"y\""]);
        let batches: Vec<RecordBatch> = reader.map(Result::unwrap).collect();
        assert_eq!(batches.len(), 2);
        let read: Vec<u64> = batches
            .iter()
            .flat_map(|batch| {
                batch.column(1).as_any().downcast_ref::<Float64Array>().unwrap().values().iter().map(|x| x.to_bits())
            })
            .collect();
        assert!(read.len() == rows && read.iter().enumerate().all(|(row, bits)| *bits == number(row).to_bits()));
    }
}
