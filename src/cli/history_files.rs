//! The histories as files: CSV, and with the feature `arrow` an Arrow IPC file beside it.

use crate::io::{CsvFile, IoError};
use std::path::{Path, PathBuf};

/// Name of the table of states.
pub const HISTORIES: &str = "histories.csv";
/// The same as columns.
#[cfg(feature = "arrow")]
const COLUMNS: &str = "histories.arrow";

/// Files that get the same rows.
pub struct HistoryFiles {
    folder: PathBuf,
    csv: CsvFile,
    #[cfg(feature = "arrow")]
    arrow: crate::io::ArrowFile,
}

impl HistoryFiles {
    /// Begins the files in a folder.
    pub fn create(folder: &Path, names: &[String]) -> Result<Self, IoError> {
        Ok(HistoryFiles {
            folder: folder.to_path_buf(),
            csv: CsvFile::create(&folder.join(HISTORIES), names)?,
            #[cfg(feature = "arrow")]
            arrow: crate::io::ArrowFile::create(&folder.join(COLUMNS), names)?,
        })
    }

    /// Adds a row.
    pub fn row(&mut self, row: &[f64]) -> Result<(), IoError> {
        self.csv.row(row)?;
        #[cfg(feature = "arrow")]
        self.arrow.row(row)?;
        Ok(())
    }

    /// Finishes each file, and says which one it was or why it could not be written.
    pub fn finish(self) -> Vec<(PathBuf, Result<(), IoError>)> {
        vec![
            (self.folder.join(HISTORIES), self.csv.finish_cut()),
            #[cfg(feature = "arrow")]
            (self.folder.join(COLUMNS), self.arrow.finish()),
        ]
    }
}
